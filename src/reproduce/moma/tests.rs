//! The study with tiny repetitions: it runs, reports, and misses its targets when something is wrong.

use super::super::Silent;
use super::*;

const TINY: Plan = Plan { data_sets: 2, runs: 6, fronts: 20, ..Bench::FULL };

fn compute(plan: Plan, seed: u64) -> Results {
    Results::compute(&Bench::new().unwrap(), plan, seed, &Silent).unwrap()
}

fn missed(plan: Plan) -> Vec<String> {
    compute(plan, 1).targets().into_iter().filter(|target| !target.pass).map(|target| target.name).collect()
}

#[test]
fn tiny_study_reports() {
    let results = compute(TINY, 1);
    let report = results.report(&STUDY);
    assert!(report.reduced.as_deref().is_some_and(|note| note.starts_with("2 data sets in place of 20")), "{report}");
    for table in std::iter::once(&report.table).chain(&report.tables).chain(&report.data) {
        assert!(!table.rows.is_empty(), "{}", table.name);
        assert!(table.rows.iter().all(|row| row.len() == table.columns.len()), "{}", table.name);
    }
    // What does not depend on the size of the sample holds in any.
    let exact = ["evaluations of", "generations of", "random fronts", "where the f1-end", "mean RMSE at the f1-end"];
    for target in report.targets.iter().filter(|t| exact.iter().any(|start| t.name.contains(start))) {
        assert!(target.pass, "{target:?}");
    }
}

/// Without any variation the first individual is whatever generation 0 happened to hold.
#[test]
fn operators_that_vary_nothing_miss_the_ends() {
    let genetic = nsga2::Rules { mutation_probability: Some(0.0), crossover_probability: 0.0, ..nsga2::STUDY };
    let nothing = Profile { name: "nothing", genetic };
    let missed = missed(Plan { profiles: [nothing; 3], ..TINY });
    assert!(missed.iter().any(|name| name.starts_with("standard: mean share")), "{missed:?}");
}

#[test]
fn results_do_not_depend_on_the_number_of_threads() {
    let on = |threads| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        let plan = Plan { runs: 2, ..TINY };
        pool.install(|| compute(plan, 3).targets())
    };
    assert_eq!(on(1), on(2));
}

#[test]
fn figures_show_the_front_and_the_three_states() {
    let results = compute(Plan { data_sets: 1, runs: 3, fronts: 1, ..TINY }, 1);
    let shown = results.shown(&Bench::new().unwrap()).unwrap().unwrap();
    let names: Vec<String> = shown.figures().unwrap().into_iter().map(|figure| figure.name).collect();
    assert_eq!(names, ["fig2-front", "fig3-error", "fig4-displacement", "fig5-velocity", "fig6-acceleration"]);
    for table in shown.tables() {
        assert!(!table.rows.is_empty() && table.rows.iter().all(|row| row.len() == table.columns.len()), "{table:?}");
    }
}
