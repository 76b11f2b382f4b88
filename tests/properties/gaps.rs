//! Long gaps anywhere: lanes in f64 and in f32 keep their promise, or say that they do not.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluator, Population, Precision};
use kfgpu::model::Problem;
use kfgpu::random::{Purpose, Stream};
use kfgpu::reference;
use proptest::prelude::*;

const TRACKER: &str = "[data]\nfile = \"none.csv\"\nmeasurements = [\"z\"]\n[model]\nkind = \"KIND\"\naxes = [\"x\"]\nq = \"q\"\n\
                       R = [\"r\"]\nx0 = X0\nP0 = P0\n[parameters]\nq = { min = 0.01, max = 100, scale = \"log\", start = 1 }\n\
                       r = { min = 1e-5, max = 1e-2, scale = \"log\", start = 1e-4 }\n";

fn tracker(states: usize) -> Problem {
    let kind = ["local-level", "constant-velocity", "constant-acceleration"][states - 1];
    let text = TRACKER.replace("KIND", kind).replace("X0", &format!("{:?}", vec![0; states]));
    Problem::parse(&text.replace("P0 = P0", &format!("P0 = {:?}", vec![1; states])), "tracker.toml").unwrap()
}

/// 90 rows every 10 to 20 ms of something that stays within half a metre, with gaps of so many seconds after some rows.
fn log(seed: u64, gaps: &[(usize, f64)]) -> Log {
    let mut stream = Stream::new(seed, Purpose::Workload, 0, 0);
    let (mut z, mut u, mut truth, mut time) = (Table::new(1), Table::new(0), Table::new(0), vec![]);
    let mut now = 0.0;
    for k in 0..90 {
        time.push(now);
        z.push(&[stream.uniform() - 0.5]);
        u.push(&[]);
        truth.push(&[]);
        let gap: f64 = gaps.iter().filter(|(row, _)| *row == k).map(|(_, seconds)| seconds).sum();
        now += 0.01 + 0.01 * stream.uniform() + gap;
    }
    let trajectory = Trajectory { id: String::new(), line: vec![2; 90], time, z, u, truth };
    let measurements = vec!["z".to_owned()];
    Log { source: "<drawn>".to_owned(), measurements, trajectories: vec![trajectory], ..Log::default() }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn costs_after_gaps_keep_their_promise(
        seed in any::<u64>(),
        states in 1usize..=3,
        gaps in prop::collection::vec((5usize..85, 0.0..3.5f64), 1..4),
        candidates in prop::collection::vec((-2.0..2.0f64, -5.0..-2.0f64), 1..6),
    ) {
        let problem = tracker(states);
        let gaps: Vec<(usize, f64)> = gaps.into_iter().map(|(row, size)| (row, 10f64.powf(size))).collect();
        let log = log(seed, &gaps);
        let values: Vec<f64> = candidates.iter().flat_map(|(q, r)| [10f64.powf(*q), 10f64.powf(*r)]).collect();
        let population = Population::from_rows(2, values);
        for (precision, per_row) in [(Precision::F64, 0.0), (Precision::F32, 1e-5)] {
            let options = CpuOptions { precision, ..CpuOptions::default() };
            let Ok(mut lanes) = CpuEvaluator::new(&problem, &log, options) else {
                prop_assert!(precision == Precision::F32, "f64 is never refused");
                continue;
            };
            let found = lanes.evaluate(&population);
            for (i, candidate) in population.rows().enumerate() {
                let expected = reference::costs(&problem, &log, candidate).unwrap()[0];
                let allowed = (1e-10 * expected.abs().max(1.0)).max(per_row * expected.abs().max(90.0));
                let cost = found.costs(i)[0];
                let refused = !found.status(i).is_ok();
                prop_assert!(refused || (cost - expected).abs() <= allowed, "{candidate:?} in {precision}: {cost}, not {expected}");
                prop_assert!(!refused || precision == Precision::F32, "{candidate:?} fails in {precision}");
            }
        }
    }
}
