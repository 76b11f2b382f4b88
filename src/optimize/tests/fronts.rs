//! Fronts that NSGA-II finds, against another program's at the same budget and against closed forms.

use super::*;
use crate::evaluate::mock::MultiObjective;
use crate::optimize::indicators::{hypervolume, igd, spread};
use crate::optimize::nsga2::{Nsga2, PUBLISHED};
use rayon::prelude::*;

/// Costs of the last population.
fn last_front(function: MultiObjective, coordinates: usize, settings: Settings) -> Vec<Vec<f64>> {
    let space = Space::boxed(&function.bounds()[..coordinates]);
    let settings = Settings { objectives: function.objectives(), ..settings };
    let mut search = Nsga2::new(&space, &settings, PUBLISHED);
    drive(&mut search, &mut Mock::new(function));
    (0..settings.population).map(|i| search.scores().costs(i).to_vec()).collect()
}

fn slices(points: &[Vec<f64>]) -> Vec<&[f64]> {
    points.iter().map(Vec::as_slice).collect()
}

fn middle(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// The other program's three seeds spread from `low` to `high`; the median of ours lies among them or beyond their best.
fn within_spread(what: &str, ours: f64, theirs: &[f64], larger_is_better: bool) {
    let (low, high) =
        (theirs.iter().copied().fold(f64::MAX, f64::min), theirs.iter().copied().fold(f64::MIN, f64::max));
    println!("{what}: {ours:.6} against {low:.6} to {high:.6}");
    let reached = if larger_is_better { ours >= low } else { ours <= high };
    assert!(reached, "{what}: {ours}, theirs {low} to {high}");
}

/// 100 candidates x 250 generations, as there; medians of 15 seeds. Measured hypervolumes: .86982 against .86962 to .86992
/// on ZDT1, .53662 against .53631 to .53639 on ZDT2, 1.32773 against 1.32733 to 1.32773 on ZDT3, .70244 against .69897 to
/// .71116 on DTLZ2. With copies among the offspring (1.4 in a last population) ZDT1 and ZDT2 miss theirs: .86947, .53626.
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
        let (truth, reference) = (function.front(n), vec![1.1; function.objectives()]);
        let score = |seed| {
            let front = last_front(function, coordinates, settings(100, 249, seed));
            (hypervolume(&slices(&front), &reference), igd(&slices(&front), &slices(&truth)))
        };
        let (hv, distance): (Vec<f64>, Vec<f64>) = (1..=15_u64).into_par_iter().map(score).unzip();
        let (their_hv, their_igd): (Vec<f64>, Vec<f64>) = theirs.iter().map(|run| (run.hv, run.igd)).unzip();
        within_spread(&format!("{name}, hypervolume"), middle(hv), &their_hv, true);
        within_spread(&format!("{name}, IGD"), middle(distance), &their_igd, false);
    }
}

/// ZDT6, which the other program's file does not have, and four objectives: the share of the true front's hypervolume
/// (0.980 and 0.784 measured).
#[test]
fn uneven_and_four_objective_fronts_are_found() {
    for (function, steps, least) in [(MultiObjective::Zdt6, 2000, 0.97), (MultiObjective::Dtlz2(4), 16, 0.75)] {
        let reference = vec![1.1; function.objectives()];
        let truth = function.front(steps);
        let front = last_front(function, function.bounds().len(), settings(100, 249, 1));
        let share = hypervolume(&slices(&front), &reference) / hypervolume(&slices(&truth), &reference);
        println!("{function:?}: {share:.4} of the true hypervolume");
        assert!(share > least, "{function:?}: {share}");
    }
}

/// Deb et al. report a spread of 0.39 on ZDT1 (real-coded, 100 x 250 generations).
#[test]
fn the_front_is_spread_as_published() {
    let front = last_front(MultiObjective::Zdt1, 30, settings(100, 249, 1));
    let found = spread(&slices(&front), &[&[0.0, 1.0], &[1.0, 0.0]]);
    println!("spread {found:.3}");
    assert!(found < 0.45, "{found}");
}
