//! The sections of a study's report: every finding in words and numbers, once.

mod glossary;
mod verdict;

use std::fmt;

use super::document::{Document, Part, Picture, Section};
use super::validation::improvement_text;
use super::{Certificate, Effort, Gain, Linearity, Named, Nothing, Tuning, Validation, constraint};
use crate::evaluate::Device;
use crate::number::{count, seconds, short, significant};
use crate::study::StopReason;
use crate::table::{Cell, Table};
use crate::words::{counted, enumerated};

/// Digits of parameters and objectives.
const DIGITS: usize = 8;

impl fmt::Display for Tuning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&document(self, &[]).text())
    }
}

impl fmt::Display for Effort {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(search(self).text().trim_end())
    }
}

/// The report of a study as a page for somebody who has not seen the tool, with these pictures.
#[must_use]
pub fn markdown(tuning: &Tuning, pictures: &[Picture]) -> String {
    document(tuning, pictures).markdown()
}

/// The page of a study without a usable candidate; `why` is a clause without a full stop.
#[must_use]
pub fn markdown_without_winner(Nothing { effort, .. }: &Nothing, why: &str) -> String {
    let verdict = Section::new("Verdict").on_page(Part::Strong(format!("No usable candidate was found: {why}.")));
    let sections = [verdict, search(effort)].into_iter().chain(warnings(&effort.warnings)).collect();
    Document { title: title(effort), sections }.markdown()
}

fn document(tuning: &Tuning, pictures: &[Picture]) -> Document {
    let front = tuning.front.as_ref().zip(tuning.front_summary.as_ref());
    let sections = [
        Some(verdict::of(tuning)),
        Some(search(&tuning.effort)),
        Some(parameters(tuning)),
        Some(objectives(tuning)),
        constraint::section(&tuning.constraints, tuning.validation.as_ref().map(|v| &v.constraints[..])),
        front.map(|(points, summary)| summary.section(points, tuning.validation.is_some())),
        Some(filter(tuning)),
        Some(tuning.consistency.under(Section::new(format!("Consistency ({})", tuning.consistency_on)))),
        tuning.linearity.as_ref().map(linearity),
        Some(certificate(tuning)),
        pictures
            .iter()
            .fold(Section::new("Pictures"), |section, picture| section.on_page(Part::Picture(picture.clone())))
            .unless_empty(),
        warnings(&tuning.effort.warnings),
        Some(glossary::of(tuning)),
    ];
    Document { title: title(&tuning.effort), sections: sections.into_iter().flatten().collect() }
}

fn title(effort: &Effort) -> String {
    format!("Tuning of {} on {}", effort.problem, effort.log.source)
}

/// How the search went.
fn search(effort: &Effort) -> Section {
    let Effort { log, device: Device { backend, adapter, precision }, .. } = effort;
    let many = |number: u64, one: &str| format!("{} {one}{}", count(number), if number == 1 { "" } else { "s" });
    let trajectories =
        if log.trajectories > 1 { format!(" in {} trajectories", log.trajectories) } else { String::new() };
    let span = log.span.as_ref().map(|[from, to]| format!("{from} to {to}")).unwrap_or_default();
    let more = [
        ("times:", span),
        ("failed evaluations:", count(effort.failed)),
        ("time evaluating:", seconds(effort.evaluate_s)),
        ("SHA-256 of the log's numbers:", format!("`{}`", log.sha256)),
        ("kfgpu:", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let more = more.into_iter().filter(|(_, value)| !value.is_empty()).map(|(label, value)| (label.to_owned(), value));
    Section::untitled("The search")
        .with(format!("{}: {}, {}{trajectories}", effort.problem, log.source, many(log.rows as u64, "row")))
        .with(format!(
            "{}, seed {}: {} in {}, {} on {backend} ({adapter}, {precision})",
            effort.algorithm,
            effort.seed,
            many(effort.evaluations, "evaluation"),
            many(effort.generations as u64, "generation"),
            seconds(effort.wall_s)
        ))
        .with(format!("stopped: {}", ended(effort.stop)))
        .on_page(Part::List(more.collect()))
}

const fn ended(stop: StopReason) -> &'static str {
    match stop {
        StopReason::Generations => "all generations are done",
        StopReason::Evaluations => "no more evaluations are allowed",
        StopReason::WallTime => "the time allowed is over",
        StopReason::Stall => "no gain for as many generations as allowed",
        StopReason::Target => "the target is reached",
        StopReason::Interrupted => "interrupted; this is the best so far",
    }
}

fn parameters(tuning: &Tuning) -> Section {
    let Tuning { effort, consistency, .. } = tuning;
    let intervals = consistency.uncertainty.intervals_95.as_ref();
    let mut table = Table::of(["parameter", "unit", "baseline", "tuned", "95 % interval", "bounds", "note"]);
    for (name, tuned) in tuning.parameters.iter() {
        let interval = intervals.and_then(|intervals| intervals.get(name)).map(|[low, high]| {
            let known = low.is_finite() && high.is_finite();
            if known { format!("{} to {}", significant(*low, 4), significant(*high, 4)) } else { "-".to_owned() }
        });
        let bounds = effort.bounds.get(name).copied().flatten();
        let bounds =
            bounds.map_or_else(|| "none".to_owned(), |[min, max]| format!("{} to {}", short(min, 6), short(max, 6)));
        let at_bound = tuning.at_bound.get(name).map(|bound| format!("at its {bound} bound"));
        let left = tuning.polish.as_ref().is_some_and(|polish| polish.left_at_start.iter().any(|left| left == name));
        let left = left.then(|| "undetermined, left at its start".to_owned());
        let truth = tuning.simulated_with.get(name).map(|truth| format!("simulated with {}", short(*truth, DIGITS)));
        table.push([
            name.to_owned(),
            effort.units.get(name).cloned().flatten().unwrap_or_default(),
            effort.baseline.parameters.get(name).map_or_else(String::new, |v| short(*v, DIGITS)),
            short(*tuned, DIGITS),
            interval.unwrap_or_default(),
            bounds,
            [at_bound, left, truth].into_iter().flatten().collect::<Vec<_>>().join("; "),
        ]);
    }
    Section::untitled("Parameters").in_text(table.without(&["95 % interval", "bounds"])).on_page(table)
}

/// An objective's value; that of a filter that cannot run is none.
fn value(named: Option<&Named<f64>>, name: &str) -> Cell {
    named.and_then(|named| named.get(name)).map_or_else(|| "failed".into(), |value| Cell::Number(*value, DIGITS))
}

fn objectives(tuning: &Tuning) -> Section {
    let section = Section::untitled("Objectives")
        .on_page("Computed in double precision by a filter independent of the search; lower is better.");
    let table = objective_table(tuning);
    let in_text = table.without(&["scored"]);
    let Some(validation) = &tuning.validation else { return section.in_text(in_text).on_page(table) };
    let gap = validation.overfit_gap.iter().map(|(name, gap)| format!("{name} {}", improvement_text(name, *gap)));
    let gap = gap.collect::<Vec<_>>().join("; ");
    section
        .with(format!("Validation: {validation}."))
        .in_text(in_text)
        .on_page(table)
        .with(validation.sentence())
        .with(format!("Overfit gap (improvement on training rows less that on held-out rows): {gap}."))
}

/// Every objective, on training and on held-out rows where there is a split.
fn objective_table(tuning: &Tuning) -> Table {
    let validation = tuning.validation.as_ref();
    let head = if validation.is_some() { "objective, f64" } else { "objective, in-sample, f64" };
    let mut table = Table::of([head, "scored", "rows", "baseline", "tuned", "improvement", "raw measurements"]);
    let improvement = |name: &str, of: fn(&Validation) -> &Named<Option<f64>>| {
        validation.map_or(Cell::Empty, |v| improvement_text(name, of(v).get(name).copied().flatten()).into())
    };
    let raw = |named: &Named<f64>, name: &str| named.get(name).map_or(Cell::Empty, |v| Cell::Number(*v, DIGITS));
    let baseline = tuning.effort.baseline.objectives.as_ref();
    for (name, tuned) in tuning.objectives.iter() {
        table.push([
            name.into(),
            tuning.effort.definitions.get(name).map_or(Cell::Empty, Cell::text),
            validation.map_or(Cell::Empty, |_| "training".into()),
            value(baseline, name),
            Cell::Number(*tuned, DIGITS),
            improvement(name, |v| &v.improvement_train),
            raw(&tuning.raw_measurements, name),
        ]);
        match validation {
            Some(v) => table.push([
                Cell::Empty,
                Cell::Empty,
                "held out".into(),
                value(v.baseline.as_ref(), name),
                value(v.winner.as_ref(), name),
                improvement(name, |v| &v.improvement_held_out),
                raw(&v.raw_measurements, name),
            ]),
            None if name == "nll" => {
                let per_row = |named: &Named<f64>| {
                    named.iter().map(|(name, v)| (name, v / tuning.measured_rows.max(1) as f64)).collect::<Named<f64>>()
                };
                let [baseline, tuned] = [baseline, Some(&tuning.objectives)].map(|named| named.map(per_row));
                let [baseline, tuned] = [baseline, tuned].map(|named| value(named.as_ref(), name));
                table.push(["nll per measured row".into(), Cell::Empty, Cell::Empty, baseline, tuned]);
            }
            None => {}
        }
    }
    table
}

fn filter(tuning: &Tuning) -> Section {
    let (matrices, unit) = (&tuning.matrices, &tuning.effort.log.time_unit);
    let step = matrices.dt.map_or_else(|| "dt varies".to_owned(), |dt| format!("dt = {} {unit}", short(dt, 6)));
    let gain = if matrices.gain == Gain::Steady { "; K: steady gain" } else { "" };
    let formulas = if matrices.varies.is_empty() { "" } else { " What changes from row to row is a formula." };
    Section::new(format!("Tuned filter ({step}{gain})"))
        .on_page(format!("`tuned.toml` in this folder runs as a problem file.{formulas}"))
        .with(Part::Verbatim(matrices.to_string()))
}

/// Whether another view of f and h would do better.
fn linearity(found: &Linearity) -> Section {
    Section::untitled("Linearity").with(found.of_the_tuned()).on_page(found.table())
}

/// Whether the search can be believed, and how it ended.
fn certificate(tuning: &Tuning) -> Section {
    let certificate = &tuning.certificate;
    let gap = significant(certificate.largest_relative_gap, 2);
    let (who, what) = match &tuning.front {
        None => (format!("the {} best candidates", certificate.candidates), "their order"),
        Some(_) => (format!("the {} candidates of its front", certificate.candidates), "their places"),
    };
    let kept = if certificate.order_held { "kept" } else { "changed" };
    let section = Section::untitled("Certificate").with(format!(
        "Certificate: the f64 reference differs from the search by at most {gap} (relative), and {who} {kept} {what}.",
    ));
    let section = match amplification(certificate) {
        Some(sentence) => section.with(sentence),
        None => section,
    };
    match polish(tuning) {
        Some(polish) => section.with(polish),
        None => section,
    }
}

/// Whether rounding can decide the costs of a nonlinear filter.
fn amplification(certificate: &Certificate) -> Option<String> {
    let amplification = certificate.amplification?;
    let found = format!("Amplification: {}", short(amplification, 2));
    let others = match certificate.amplified {
        0 => String::new(),
        1 => " One of the candidates has 1 or more, and is left out above.".to_owned(),
        more => format!(" {more} of the candidates have 1 or more, and are left out above."),
    };
    Some(if certificate.promise_holds {
        format!(
            "{found}, below 1: the filter takes small changes of the log in, and single precision keeps its promise.{others}"
        )
    } else {
        format!(
            "{found}, not below 1: the filter carries the last digits of the log into its likelihood (it loses the track \
             somewhere), so single precision promises nothing here and f64 is needed.{others}"
        )
    })
}

fn polish(tuning: &Tuning) -> Option<String> {
    let polish = tuning.polish.as_ref()?;
    let moved = polish.before.iter().zip(polish.after.iter()).map(|((name, before), (_, after))| {
        format!("{name} from {} to {}", significant(*before, DIGITS + 2), significant(*after, DIGITS + 2))
    });
    let took = format!(
        "Polish: {} evaluations from {} took {}",
        count(polish.evaluations as u64),
        counted(polish.starts, "start"),
        enumerated(&moved.collect::<Vec<_>>())
    );
    if tuning.front.is_some() {
        return Some(format!("{took}, and gave the front {}.", counted(polish.members, "member")));
    }
    let norm = tuning
        .gradient_norm
        .map(|norm| format!(", {} standard errors from the optimum by its gradient", short(norm, 2)));
    let ended = match (tuning.converged, &polish.note) {
        (Some(true), _) => format!("; converged{}", norm.unwrap_or_default()),
        (Some(false), Some(note)) => format!("; not converged: {note}"),
        (None, Some(note)) => format!("; convergence unknown: {note}"),
        (_, None) => String::new(),
    };
    Some(format!("{took}{ended}."))
}

fn warnings(warnings: &[String]) -> Option<Section> {
    let list = warnings.iter().map(|warning| (String::new(), warning.clone())).collect();
    (!warnings.is_empty()).then(|| Section::new("Warnings").on_page(Part::List(list)))
}
