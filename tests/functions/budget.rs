//! The recorded findings: worst errors of every function and format.

use crate::table::Errors;
use std::collections::BTreeMap;
use std::fs;
use std::path::PathBuf;
use std::sync::Mutex;

/// Set, it writes the file anew from this run.
const RECORD: &str = "KFGPU_FUNCTIONS_RECORD";

/// How much worse than its record a function may be: nothing changes on lanes but the last digit of the record; adapters differ.
fn slack(format: &str) -> f64 {
    if format == "wgsl" { 4.0 } else { 1.02 }
}

static FILE: Mutex<()> = Mutex::new(());

type Findings = BTreeMap<(String, String), (f64, f64)>;

fn path() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("tests/functions/budget.csv")
}

fn read() -> Findings {
    let Ok(mut reader) = csv::Reader::from_path(path()) else { return Findings::new() };
    let rows = reader.deserialize::<(String, String, f64, f64)>().map(|row| row.expect("function,format,ulp,absolute"));
    rows.map(|(name, format, ulp, absolute)| ((name, format), (ulp, absolute))).collect()
}

fn write(findings: &Findings) {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(["function", "format", "ulp", "absolute"]).unwrap();
    for ((name, format), (ulp, absolute)) in findings {
        writer.write_record([name, format, &format!("{ulp:.3}"), &format!("{absolute:.2e}")]).unwrap();
    }
    fs::write(path(), writer.into_inner().unwrap()).unwrap();
}

/// Compares errors with their record, or records them; sentences about what is wrong.
pub(crate) fn compare(formats: &[&str], measured: &[(String, &str, Errors)]) -> Vec<String> {
    let _guard = FILE.lock().unwrap();
    let mut findings = read();
    for (name, format, Errors { ulp, absolute }) in measured {
        println!("{name} {format}: {ulp:.3} ulp, {absolute:.1e}");
    }
    if std::env::var_os(RECORD).is_some() {
        findings.retain(|(_, format), _| !formats.contains(&format.as_str()));
        let new = measured.iter().map(|(name, format, e)| ((name.clone(), (*format).to_owned()), (e.ulp, e.absolute)));
        findings.extend(new);
        write(&findings);
        return Vec::new();
    }
    let mut wrong = Vec::new();
    for (name, format, Errors { ulp, absolute }) in measured {
        match findings.get(&(name.clone(), (*format).to_owned())) {
            None => wrong.push(format!("{name}: {format} has no record (set {RECORD}=1 to write it)")),
            // An ulp counts near zeros of a function, where its absolute error is what can be had.
            Some((u, a)) if *ulp > slack(format) * u + 0.001 || *absolute > slack(format) * a => {
                wrong.push(format!("{name}: {format} {ulp:.3} ulp, {absolute:.2e}; recorded {u:.3}, {a:.2e}"));
            }
            Some(_) => {}
        }
    }
    wrong
}
