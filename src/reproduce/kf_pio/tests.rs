//! The study with tiny repetitions: it passes as published, and misses its targets when something is wrong.

use super::super::Silent;
use super::*;

const TINY: Plan = Plan { data_sets: 3, untuned: 40, matrices: 20, local_searches: 6, fresh: 4, ..Bench::FULL };

fn bench() -> Bench {
    Bench::new().unwrap()
}

fn missed(plan: Plan) -> Vec<String> {
    let results = Results::compute(&bench(), plan, 1, &Silent).unwrap();
    results.targets().into_iter().filter(|target| !target.pass).map(|target| target.name).collect()
}

#[test]
fn tiny_study_reaches_its_targets_and_reports() {
    let results = Results::compute(&bench(), TINY, 1, &Silent).unwrap();
    let report = results.report(&STUDY);
    assert!(report.passes(), "{report}");
    assert!(report.reduced.as_deref().is_some_and(|note| note.starts_with("3 data sets in place of 30")), "{report}");
    for table in std::iter::once(&report.table).chain(&report.tables).chain(&report.data) {
        assert!(!table.rows.is_empty(), "{}", table.name);
        assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", table.name);
    }
}

/// Undamped pigeons do as well as particles, so the published gap is gone.
#[test]
fn another_r_misses_the_published_gap() {
    let missed = missed(Plan { data_sets: 2, pio: pio::Rules { r: 0.0, ..pio::PUBLISHED }, ..TINY });
    assert!(missed.iter().any(|name| name == "median PIO/PSO at r = 0.2"), "{missed:?}");
}

/// A swarm that hardly moves finds no optimum.
#[test]
fn a_weak_swarm_misses_the_independent_optimum() {
    let missed =
        missed(Plan { pso: pso::Rules { own: 0.1, swarm: 0.1, inertia: [0.1; 2], ..pso::CONSTRICTION }, ..TINY });
    assert!(missed.iter().any(|name| name.contains("where PSO is within")), "{missed:?}");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let plan = Plan { data_sets: 2, ..TINY };
        pool.install(|| Results::compute(&bench(), plan, 3, &Silent).unwrap().targets())
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn figures_show_the_three_filters_and_the_convergence() {
    let plan = Plan { data_sets: 1, untuned: 1, matrices: 1, ..TINY };
    let results = Results::compute(&bench(), plan, 1, &Silent).unwrap();
    let shown = results.shown(&bench()).unwrap().unwrap();
    let names: Vec<String> = shown.figures().unwrap().into_iter().map(|figure| figure.name).collect();
    assert_eq!(names, ["fig5-kf", "fig6-kf-pio", "fig7-kf-pso", "fig8-convergence"]);
    let table = shown.table();
    assert!(table.rows.len() == scenario::ROWS && table.rows.iter().all(|row| row.len() == table.columns.len()));
}
