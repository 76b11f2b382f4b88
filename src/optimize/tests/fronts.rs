//! Fronts that NSGA-II finds, against another program's at the same budget.

use super::*;
use crate::evaluate::mock::MultiObjective;
use crate::optimize::indicators::{hypervolume, igd};
use crate::optimize::nsga2::{Nsga2, PUBLISHED, STUDY};

/// Costs of the last population of 100 candidates x 250 generations.
fn last_front(function: MultiObjective, coordinates: usize, seed: u64) -> Vec<Vec<f64>> {
    let space = Space::boxed(&function.bounds()[..coordinates]);
    let settings = Settings { objectives: function.objectives(), ..settings(100, 249, seed) };
    let mut search = Nsga2::new(&space, &settings, PUBLISHED);
    drive(&mut search, &mut Mock::new(function));
    (0..100).map(|i| search.scores().costs(i).to_vec()).collect()
}

fn slices(points: &[Vec<f64>]) -> Vec<&[f64]> {
    points.iter().map(Vec::as_slice).collect()
}

#[test]
fn fronts_are_as_good_as_another_programs() {
    #[derive(serde::Deserialize)]
    struct Run {
        hv: f64,
        igd: f64,
    }
    let text = include_str!("../../../tests/golden/golden_moo.json");
    let golden: serde_json::Value = serde_json::from_str(text).expect("the golden file");
    let cases = [
        ("zdt1", MultiObjective::Zdt1, 30, 2000),
        ("zdt2", MultiObjective::Zdt2, 30, 2000),
        ("zdt3", MultiObjective::Zdt3, 30, 2000),
        ("dtlz2", MultiObjective::Dtlz2(3), 10, 30),
    ];
    for (name, function, coordinates, n) in cases {
        let theirs: Vec<Run> = serde_json::from_value(golden[name]["runs"].clone()).expect(name);
        let truth = function.front(n);
        let score = |seed| {
            let front = last_front(function, coordinates, seed);
            let reference = vec![1.1; function.objectives()];
            (hypervolume(&slices(&front), &reference), igd(&slices(&front), &slices(&truth)))
        };
        let ours: Vec<(f64, f64)> = (1..=5).map(score).collect();
        println!("{name}: {ours:?}");
        println!("   {:?}", theirs.iter().map(|r| (r.hv, r.igd)).collect::<Vec<_>>());
    }
}
