use std::path::Path;

use super::*;

const ALL: [&str; 4] = ["extended", "unscented", "iterated", "cubature"];

/// A problem file of the repository, changed, with its log.
fn opened(path: &str, change: impl Fn(String) -> String) -> (Problem, Log) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(path);
    let problem = Problem::parse(&change(std::fs::read_to_string(&path).unwrap()), "problem.toml").unwrap();
    let log = match problem.data.file {
        Some(_) => Log::open(&problem.data, path.parent().unwrap()).unwrap(),
        None => crate::simulate::simulate(&problem, None).unwrap(),
    };
    (problem, log)
}

fn same(text: String) -> String {
    text
}

fn of((problem, log): &(Problem, Log), names: &[&str]) -> Linearity {
    let others: Vec<Problem> = names.iter().map(|name| problem.with_filter(name).unwrap()).collect();
    Linearity::of(problem, &others, log, &problem.parameters.baseline(), true)
}

fn score<'a>(found: &'a Linearity, filter: &str) -> &'a FilterScore {
    found.filters.iter().find(|one| one.filter == filter).unwrap()
}

/// The univariate growth model: its curvature is far above its noise.
#[test]
fn on_the_growth_model_linearising_costs() {
    let found = of(&opened("tests/data/nonlinear/growth.toml", same), &ALL);
    let (extended, unscented) = (score(&found, "extended"), score(&found, "unscented"));
    assert!((extended.difference, extended.verdict) == (0.0, Standing::NotToldApart), "{extended:?}");
    assert!(unscented.nll < extended.nll - 500.0 && unscented.verdict == Standing::Better, "{unscented:?}");
    assert!((unscented.difference - (unscented.nll - extended.nll)).abs() < 1e-9, "{unscented:?}");
    assert!(unscented.rmse.get("x") < extended.rmse.get("x") && extended.amplification > Some(1.0), "{found}");
    assert_eq!(found.verdict.linearising, Linearising::Costs);
    let sentence = found.verdict.to_string();
    assert!(sentence.starts_with("The unscented filter is more likely than the extended by 718 +- "), "{sentence}");
    assert!(sentence.ends_with(" nats: linearising costs here, and tuning Q and R would hide it."), "{sentence}");
    let text = found.to_string();
    assert!(text.contains("extended (own)") && text.contains("rmse x") && text.contains("amplification"), "{text}");
}

/// A radar that looks at a distant target sees straight lines.
#[test]
fn a_distant_radar_sees_no_curvature() {
    let radar = opened("tests/data/nonlinear/radar.toml", same);
    let found = of(&radar, &ALL);
    assert!(found.filters.iter().all(|one| one.difference.abs() < 0.1 && one.verdict == Standing::NotToldApart));
    assert_eq!(found.verdict.linearising, Linearising::NoProblem);
    let sentence = found.verdict.to_string();
    let start = "Linearising is no problem on this log: no other filter can be told to be a nat more likely than the extended (";
    assert!(sentence.starts_with(start), "{sentence}");
    let problem = &radar.0;
    let tuned = Linearity::of_winner(problem, &radar.1, &problem.parameters.baseline()).unwrap();
    assert_eq!(tuned.filters.iter().map(|one| one.filter.as_str()).collect::<Vec<_>>(), ["extended", "unscented"]);
    let said = tuned.of_the_tuned();
    assert!(said.starts_with("With the tuned parameters, on the rows tuned on: linearising is no problem"), "{said}");
}

/// What rows cannot tell is not called no problem: a turn of a hundred rows, and nine rows.
#[test]
fn where_rows_cannot_tell_it_is_said() {
    let turn = of(&opened("tests/data/nonlinear/ct.toml", same), &["unscented"]);
    assert_eq!(turn.verdict.linearising, Linearising::NotToldApart);
    assert!(turn.verdict.sentence.starts_with("these rows cannot tell whether another filter is better"), "{turn}");
    let (problem, mut log) = opened("tests/data/nonlinear/radar.toml", same);
    let rows = &mut log.trajectories[0];
    rows.time.truncate(9);
    let short = of(&(problem, log), &["unscented"]);
    assert!(short.verdict.sentence.starts_with("these rows are too few to tell the filters apart"), "{short}");
    assert!(score(&short, "unscented").standard_error.is_nan(), "{short}");
}

/// With affine f and h every filter is the Kalman filter, whatever the problem's own is.
#[test]
fn on_linear_models_every_filter_is_the_same() {
    for (path, own) in [("examples/rocket.toml", "kalman"), ("examples/nile.toml", "unscented")] {
        let with_own = |text: String| text.replace("[tune]", &format!("[filter]\nkind = \"{own}\"\n[tune]"));
        let linear = opened(path, with_own);
        let found = of(&linear, &["kalman", "extended", "unscented", "iterated", "cubature"]);
        assert_eq!((found.filters.len(), found.filters[0].filter.as_str()), (5, own));
        assert!(found.filters.iter().all(|one| one.difference.abs() < 1e-8), "{found}");
        assert_eq!(found.verdict.linearising, Linearising::Exact);
        let sentence = found.verdict.to_string();
        assert!(sentence.starts_with("Every filter is the Kalman filter here, since f and h are affine"), "{sentence}");
        assert!(Linearity::of_winner(&linear.0, &linear.1, &linear.0.parameters.baseline()).is_none(), "not asked");
    }
    let adaptive = opened("examples/rocket_sage_husa.toml", same);
    let found = of(&adaptive, &["kalman", "extended"]);
    assert!(score(&found, "kalman").difference.abs() > 1e-3, "it adapts: {found}");
    assert!(found.verdict.sentence.starts_with("every filter that adapts nothing is the Kalman filter"), "{found}");
}

/// A filter that fails is a row with its reason.
#[test]
fn a_filter_that_fails_has_its_reason() {
    // Where the extended filter starts there is no derivative; sigma points lie beside it.
    let (mut problem, log) =
        opened("tests/data/nonlinear/radar.toml", |text| text.replace("[990, 510, 0, 0]", "[0, 0, 0, 0]"));
    problem.model.first = crate::model::First::Update;
    let found = of(&(problem, log), &["unscented"]);
    let own = &found.filters[0];
    assert!(own.failed.as_ref().is_some_and(|why| why.contains("not finite")) && own.nll.is_nan(), "{found}");
    let sentence = "the extended filter fails on this log, where unscented runs: linearising costs here, and tuning Q and R would \
                    hide it";
    assert_eq!((found.verdict.linearising, found.verdict.sentence.as_str()), (Linearising::Costs, sentence));
    assert!(found.to_string().contains("failed"), "{found}");
}

#[test]
fn names_that_are_no_filter_for_the_problem_are_refused() {
    let (growth, _) = opened("tests/data/nonlinear/growth.toml", same);
    let refused = |name: &str| growth.with_filter(name).unwrap_err().to_string();
    assert_eq!(
        refused("unscentd"),
        "there is no filter `unscentd`: did you mean `unscented`? (known: `extended`, `iterated`, `unscented`, `cubature`)"
    );
    assert!(refused("").starts_with("there is no filter `` (known: `extended`"), "{}", refused(""));
    let others = "give one of `extended`, `iterated`, `unscented` and `cubature`";
    assert_eq!(
        refused("kalman"),
        format!("the kalman filter takes affine f and h, and this problem's are not: {others}")
    );
    assert!(refused("fuzzy").ends_with(others), "{}", refused("fuzzy"));
    let (own, _) = opened("examples/rocket_sage_husa.toml", same);
    assert_eq!(own.with_filter("sage-husa").unwrap().filter, own.filter, "its own, as it is set");
}
