use super::*;
use crate::data::Log;

fn of(text: &str) -> Draft {
    draft(Path::new("log.csv"), text.as_bytes()).unwrap()
}
#[test]
fn tmp() {
    for n in ["nile", "uav_gps", "tum_fr2_desk", "robot", "radar_ekf"] {
        let p = format!("/work/shared/data/{n}.csv");
        let d = draft(Path::new(&p), std::fs::File::open(&p).unwrap()).unwrap();
        println!("{}", d.text);
        let log = Log::open(&d.data, Path::new("")).unwrap();
        println!("{}\n=======", crate::data::Summary::of(&log));
    }
    println!(
        "{}",
        of("id,when,a b,b,c,d,e\nx,2024-01-01,1,5,2,3,4\ny,2024-01-01,2,5,3,4,1\nx,2024-01-02,2,5,5,6,6\n").text
    );
}
