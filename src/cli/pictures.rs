//! The pictures of `tune --out` and `filter --figures`.

use super::folder::OutFolder;
use crate::chart::Figure;
use crate::data::{HeldOut, Log, SplitBy};
use crate::evaluate::CpuEvaluator;
use crate::model::Problem;
use crate::objective::Objective;
use crate::reference;
use crate::report::pictures::{FrontPicture, RunRecord, convergence, hypervolume, landscape, titled};
use crate::report::{Picture, Rows, Tuning, Whiteness};
use crate::study::{Outcome, Winner};

/// Folder of the pictures inside that of `tune --out`.
const FOLDER: &str = "figures";

/// Every picture there may be. One that a run does not draw is removed, so that none is left of an earlier run.
const NAMES: [&str; 13] = [
    "front.svg",
    "parameters.svg",
    "hypervolume.svg",
    "convergence.svg",
    "landscape.svg",
    "plan.svg",
    "estimates.svg",
    "errors.svg",
    "modes.svg",
    "innovations.svg",
    "nis.svg",
    "autocorrelation.svg",
    "histogram.svg",
];

/// Rows times candidates that the picture of the cost may take, unless the log is so long that its coarsest grid takes
/// more. They are a second of one core for a small filter.
const LANDSCAPE: f64 = 4e7;
/// Candidates of that picture: at most a grid of 64 x 64, at least one of 16 x 16.
const CANDIDATES: [f64; 2] = [256.0, 4096.0];
/// Rows times squared states up to which the smoother, which keeps that many numbers, is drawn.
const SMOOTHED: usize = 20_000_000;

/// A finished study and how its cost is computed again.
#[derive(Clone, Copy)]
pub(super) struct Study<'a> {
    pub(super) logs: Logs<'a>,
    pub(super) outcome: &'a Outcome,
    pub(super) winner: &'a Winner,
    pub(super) scorer: &'a dyn Fn() -> CpuEvaluator,
}

/// What the pictures of a study are of.
#[derive(Debug, Clone, Copy)]
pub(super) struct Logs<'a> {
    /// What was tuned on: the cost.
    pub(super) train: &'a Log,
    /// What the tuned filter is shown on; what was tuned on where that is nothing.
    pub(super) held_out: Option<&'a HeldOut>,
}

type Pictures = Vec<(&'static str, Figure)>;

/// The pictures of a finished study, into a folder of the output folder.
pub(super) fn write_tuning(
    folder: &OutFolder,
    problem: &Problem,
    study: &Study<'_>,
    whiteness: &[Whiteness],
) -> anyhow::Result<()> {
    let Study { logs, outcome, winner, scorer } = *study;
    let mut pictures = vec![("convergence.svg", convergence(problem, &outcome.history))];
    let mut evaluator = scorer();
    let [least, most] = CANDIDATES;
    let evaluations = (LANDSCAPE / logs.train.rows().max(1) as f64).clamp(least, most) as usize;
    let baseline = &outcome.baseline.candidate;
    let around = landscape(problem, &winner.candidate, baseline, evaluations, &mut evaluator);
    pictures.push(("landscape.svg", around));
    pictures.extend(of_front(problem, outcome));
    pictures.extend(of_run(problem, logs, &winner.candidate, whiteness)?);
    write(&OutFolder::prepare(&folder.path().join(FOLDER))?, &pictures)
}

/// The pictures of a study, as they are called in its folder.
pub(super) fn names() -> impl Iterator<Item = String> {
    NAMES.iter().map(|name| format!("{FOLDER}/{name}"))
}

/// Removes the pictures of an earlier study.
pub(super) fn clear(folder: &OutFolder) -> anyhow::Result<()> {
    names().try_for_each(|name| folder.remove(&name))?;
    remove_folder(folder);
    Ok(())
}

/// Removes their folder, unless the user keeps something in it.
pub(super) fn remove_folder(folder: &OutFolder) {
    // It need not be there at all.
    let _ = std::fs::remove_dir(folder.path().join(FOLDER));
}

/// The pictures that stand in the folder of a study, in their order.
pub(super) fn drawn(folder: &OutFolder, tuning: &Tuning) -> Vec<Picture> {
    let there = NAMES.iter().filter(|name| folder.path().join(FOLDER).join(name).is_file());
    let caption = |name: &str| format!("{}{}", caption(name), rows_shown(name, tuning));
    there.map(|name| Picture { path: format!("{FOLDER}/{name}"), caption: caption(name) }).collect()
}

/// Which rows a picture of the filter shows, where not all were tuned on.
fn rows_shown(name: &str, tuning: &Tuning) -> &'static str {
    let over_time =
        matches!(name, "plan.svg" | "estimates.svg" | "errors.svg" | "modes.svg" | "innovations.svg" | "nis.svg");
    let pooled = matches!(name, "autocorrelation.svg" | "histogram.svg");
    let Some(validation) = tuning.validation.as_ref().filter(|_| over_time || pooled) else { return "" };
    match (tuning.consistency_on, validation.by) {
        (Rows::InSample, _) => " Of the rows tuned on: on the held-out ones the filter fails.",
        (Rows::HeldOut, SplitBy::Time) if name == "plan.svg" => " Training rows and held-out ones.",
        (Rows::HeldOut, SplitBy::Time) if over_time => " Rows after the dotted line were held out.",
        (Rows::HeldOut, SplitBy::Trajectory) if over_time => " Shown is a trajectory that was held out.",
        (Rows::HeldOut, _) => " Of the held-out rows alone.",
    }
}

/// What a picture shows, for somebody who has not seen the tool.
fn caption(name: &str) -> &'static str {
    match name {
        "front.svg" => "The front: what each member offers, with the start values, the knee and the ends marked.",
        "parameters.svg" => "Parameters and objectives of the front's members, a line each.",
        "hypervolume.svg" => "The search: the volume that its front dominates.",
        "errors.svg" => "Errors of the estimates against the truth, with the 3-sigma band of the filter.",
        "modes.svg" => "How likely each of the filter's models is after each row.",
        "convergence.svg" => "The search: the best cost so far and the spread of each generation.",
        "plan.svg" => "The track from above, one scale for both axes: measurements and the tuned filter's estimates.",
        "landscape.svg" => "The cost around the tuned parameters, with the start values marked.",
        "estimates.svg" => "Measurements and the tuned filter's estimates with their 3-sigma band.",
        "innovations.svg" => "Innovations with the band that the filter expects them in.",
        "nis.svg" => "NIS of each measured row with its 95 % band.",
        "autocorrelation.svg" => {
            "Autocorrelation of the innovations: inside its band when nothing is left to learn from them."
        }
        "histogram.svg" => "Normalised innovations against the normal distribution that they should have.",
        _ => "A picture of the study.",
    }
}

/// Refuses to replace pictures that are there already.
pub(super) fn refuse_existing(folder: &OutFolder) -> anyhow::Result<()> {
    folder.refuse_existing(NAMES, "the pictures there")
}

/// The pictures of a filter run, into a folder of their own.
pub(super) fn write_run(
    folder: &OutFolder,
    problem: &Problem,
    log: &Log,
    candidate: &[f64],
    whiteness: &[Whiteness],
) -> anyhow::Result<()> {
    write(folder, &of_run(problem, Logs { train: log, held_out: None }, candidate, whiteness)?)
}

/// Of a study of several objectives.
fn of_front(problem: &Problem, outcome: &Outcome) -> Pictures {
    if outcome.front.is_empty() {
        return Vec::new();
    }
    let objectives: Vec<&str> = problem.tune.objectives.iter().map(Objective::name).collect();
    let members: Vec<&[f64]> = outcome.front.iter().map(|member| &member.objectives[..]).collect();
    let candidates: Vec<&[f64]> = outcome.front.iter().map(|member| &member.candidate[..]).collect();
    let landmarks = outcome.landmarks.as_ref();
    let front = FrontPicture {
        title: &titled(problem, "Pareto front"),
        objectives: &objectives,
        members: &members,
        knee: landmarks.filter(|l| l.has_knee).map(|l| l.knee),
        recommended: landmarks.map(|l| l.recommended),
        baseline: outcome.baseline.objectives.as_deref(),
    };
    let title = titled(problem, "parameters and objectives along the front");
    let parameters = FrontPicture { title: &title, ..front };
    let parameters = parameters.parallel(&problem.parameters, &candidates, &outcome.baseline.candidate);
    let volumes = outcome.history.iter().filter_map(|row| Some((row.generation, row.hypervolume?)));
    vec![
        ("front.svg", front.scatter()),
        ("parameters.svg", parameters),
        ("hypervolume.svg", hypervolume(problem, volumes)),
    ]
}

fn of_run(problem: &Problem, logs: Logs<'_>, candidate: &[f64], whiteness: &[Whiteness]) -> anyhow::Result<Pictures> {
    let (log, mut record) = match logs.held_out {
        Some(held_out) => (&held_out.log, RunRecord::of_held_out(problem, held_out)),
        None => (logs.train, RunRecord::new(problem, logs.train)),
    };
    reference::visit(problem, log, candidate, &mut |trajectory, step| record.add(trajectory, step))?;
    let n = problem.model.states.len();
    if let Some(trajectory) = record.finish()
        && log.rows().saturating_mul(n * n) <= SMOOTHED
    {
        let smoothed = reference::smooth(problem, log, candidate);
        // Where R is singular there is no smoothed estimate, and the picture goes without.
        let rows = smoothed.ok().and_then(|mut all| (trajectory < all.len()).then(|| all.swap_remove(trajectory)));
        record.add_smoothed(rows.iter().flatten().map(|row| (row.time, &row.estimate)));
    }
    let mut pictures = vec![
        ("estimates.svg", record.estimates()),
        ("innovations.svg", record.innovations()),
        ("nis.svg", record.nis()),
        ("autocorrelation.svg", record.autocorrelation(whiteness)),
        ("histogram.svg", record.histogram()),
    ];
    pictures.extend(record.errors().map(|errors| ("errors.svg", errors)));
    pictures.extend(record.modes().map(|modes| ("modes.svg", modes)));
    pictures.extend(record.plan().map(|plan| ("plan.svg", plan)));
    Ok(pictures)
}

fn write(folder: &OutFolder, pictures: &Pictures) -> anyhow::Result<()> {
    for (name, figure) in pictures {
        let svg = figure.to_svg()?;
        folder.write(name, |out| Ok(out.write_all(svg.as_bytes())?))?;
    }
    for name in NAMES.iter().filter(|name| !pictures.iter().any(|(drawn, _)| drawn == *name)) {
        folder.remove(name)?;
    }
    Ok(())
}
