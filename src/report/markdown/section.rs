//! The sections of report.md below the verdict.

use super::{Picture, plain, table};
use crate::report::constraint::cells;
use crate::report::front::{held_out_cells, nis_cell, objective_columns};
use crate::report::text::ended;
use crate::report::validation::improvement_text;
use crate::report::{ConstraintCheck, Effort, Gain, Matrices, Named, Rows, Tuning, count, seconds, short, significant};
use crate::words::counted;

/// Digits of parameters and objectives.
const DIGITS: usize = 8;
/// Members of a front that are listed.
const MEMBERS: usize = 30;

pub(super) fn title(effort: &Effort) -> Option<String> {
    Some(format!("# Tuning of {} on {}", plain(&effort.problem), plain(&effort.log.source)))
}

pub(super) fn parameters(tuning: &Tuning) -> Option<String> {
    let effort = &tuning.effort;
    let uncertainty = &tuning.consistency.uncertainty;
    let error = |name: &str| match uncertainty.standard_errors.as_ref().and_then(|errors| errors.get(name)) {
        Some(error) if error.is_finite() => significant(*error, 3),
        Some(_) => "-".to_owned(),
        None => String::new(),
    };
    let interval = |name: &str| match uncertainty.intervals_95.as_ref().and_then(|intervals| intervals.get(name)) {
        Some([low, high]) if low.is_finite() && high.is_finite() => {
            format!("{} to {}", significant(*low, 4), significant(*high, 4))
        }
        Some(_) => "-".to_owned(),
        None => String::new(),
    };
    let row = |(name, tuned): (&str, &f64)| {
        let bounds = effort.bounds.get(name).copied().flatten();
        let bound = tuning.at_bound.get(name).map(|bound| format!("at its {bound} bound"));
        let truth = tuning.simulated_with.get(name).map(|truth| format!("simulated with {}", short(*truth, DIGITS)));
        vec![
            plain(name),
            effort.units.get(name).cloned().flatten().map_or_else(String::new, |unit| plain(&unit)),
            effort.baseline.parameters.get(name).map_or_else(String::new, |v| short(*v, DIGITS)),
            short(*tuned, DIGITS),
            error(name),
            interval(name),
            bounds.map_or_else(|| "none".to_owned(), |[min, max]| format!("{} to {}", short(min, 6), short(max, 6))),
            [bound, truth].into_iter().flatten().collect::<Vec<_>>().join("; "),
        ]
    };
    let rows: Vec<Vec<String>> = tuning.parameters.iter().map(row).collect();
    let header = ["parameter", "unit", "start", "tuned", "standard error", "95 % interval", "bounds", "note"];
    let mut text = format!("## Parameters\n\n{}", table(&header, &rows));
    if let Some(note) = &uncertainty.standard_errors_note {
        text += &format!("\n\nStandard errors: {}.", plain(note.trim_end_matches('.')));
    }
    for flat in uncertainty.flat_directions.iter().flatten() {
        text += &format!("\n\n{}.", plain(flat.statement.trim_end_matches('.')));
    }
    Some(text)
}

pub(super) fn objectives(tuning: &Tuning) -> Option<String> {
    let cell = |value: Option<f64>| value.map_or_else(|| "failed".to_owned(), |v| significant(v, DIGITS));
    let of = |named: &Option<Named<f64>>, name: &str| cell(named.as_ref().and_then(|n| n.get(name).copied()));
    let raw = |named: &Named<f64>, name: &str| named.get(name).map_or_else(String::new, |v| significant(*v, DIGITS));
    let mut rows = Vec::new();
    for (name, tuned) in tuning.objectives.iter() {
        let scored = tuning.effort.definitions.get(name).cloned().unwrap_or_default();
        let training = if tuning.validation.is_some() { "training" } else { "all" };
        let improvement = |named: &Named<Option<f64>>| improvement_text(name, named.get(name).copied().flatten());
        rows.push(vec![
            format!("`{name}`"),
            scored,
            training.to_owned(),
            of(&tuning.effort.baseline.objectives, name),
            significant(*tuned, DIGITS),
            tuning.validation.as_ref().map_or_else(String::new, |v| improvement(&v.improvement_train)),
            raw(&tuning.raw_measurements, name),
        ]);
        if let Some(validation) = &tuning.validation {
            rows.push(vec![
                format!("`{name}`"),
                String::new(),
                "held out".to_owned(),
                of(&validation.baseline, name),
                of(&validation.winner, name),
                improvement(&validation.improvement_held_out),
                raw(&validation.raw_measurements, name),
            ]);
        }
    }
    let header = ["objective", "scored", "rows", "start", "tuned", "improvement", "raw measurements"];
    Some(format!(
        "## Objectives\n\nComputed in double precision by a filter independent of the search; lower is better.\n\n{}",
        table(&header, &rows)
    ))
}

pub(super) fn constraints(tuning: &Tuning) -> Option<String> {
    let row = |c: &ConstraintCheck, rows: &str| {
        let [baseline, tuned] = cells(c);
        let note = if c.value.is_some() && !c.met { "**not met**" } else { c.note() };
        vec![format!("`{c}`"), rows.to_owned(), baseline, tuned, note.to_owned()]
    };
    let training = if tuning.validation.is_some() { "training" } else { "all" };
    let held_out = |i: usize| tuning.validation.as_ref()?.constraints.get(i).map(|c| row(c, "held out"));
    let of = |(i, c): (usize, &ConstraintCheck)| [Some(row(c, training)), held_out(i)].into_iter().flatten();
    let rows: Vec<Vec<String>> = tuning.constraints.iter().enumerate().flat_map(of).collect();
    let table = table(&["constraint", "rows", "start", "tuned", "note"], &rows);
    (!rows.is_empty()).then(|| format!("## Constraints\n\n{table}"))
}

pub(super) fn front(tuning: &Tuning) -> Option<String> {
    let (points, summary) = (tuning.front.as_ref()?, tuning.front_summary.as_ref()?);
    let first = points.first()?;
    let validated = tuning.validation.is_some();
    let mut header = objective_columns(first, validated);
    header.push("mean NIS".to_owned());
    header.extend(first.parameters.iter().map(|(name, _)| name.to_owned()));
    header.iter_mut().for_each(|name| *name = plain(name));
    header.push("mark".to_owned());
    let shown = |i: &usize| points.len() <= MEMBERS || !points[*i].marks.is_empty();
    let row = |i: usize| {
        let values = |named: &Named<f64>| named.iter().map(|(_, value)| short(*value, 6)).collect::<Vec<_>>();
        let held_out = held_out_cells(&points[i], validated, 6).collect();
        let marks = vec![plain(&points[i].marks.join(", "))];
        let nis = vec![nis_cell(&points[i])];
        [values(&points[i].objectives), held_out, nis, values(&points[i].parameters), marks].concat()
    };
    let rows: Vec<Vec<String>> = (0..points.len()).filter(shown).map(row).collect();
    let recommended = points.iter().find(|p| p.marks.first().is_some_and(|mark| mark == "recommended"));
    let line = recommended
        .map_or_else(String::new, |point| format!("\n\nRecommended: {}.", plain(&summary.given_up_line(point))));
    let baseline = format!("{}{}", summary.baseline_line(points.len()), summary.consistent_line(points.len()));
    let header: Vec<&str> = header.iter().map(String::as_str).collect();
    let listed = if rows.len() < points.len() { ". Those with a mark are listed; front.csv has all" } else { "" };
    let meaning = match points.len() {
        1 => "One candidate is the best under every objective at once".to_owned(),
        members => format!(
            "No candidate is best under every objective. For each of these {members}, no other is as good in every \
             objective and better in one"
        ),
    };
    Some(format!("## Front\n\n{meaning}{listed}.\n\n{}{line} {baseline}", table(&header, &rows)))
}

pub(super) fn consistency(tuning: &Tuning) -> Option<String> {
    let c = &tuning.consistency;
    let on = if tuning.consistency_on == Rows::HeldOut { "held-out rows" } else { "the rows tuned on" };
    let range = |low: f64, high: f64| format!("{} to {}", short(low, 4), short(high, 4));
    let mut rows = vec![vec![
        "mean NIS".to_owned(),
        short(c.nis_mean, 4),
        range(c.nis_low, c.nis_high),
        format!("{} measured values", count(c.components as u64)),
    ]];
    if let Some(nees) = &c.nees {
        let band = range(nees.nees_low, nees.nees_high);
        rows.push(vec![
            "mean NEES".to_owned(),
            short(nees.nees_mean, 4),
            band,
            format!("{} rows with truth", count(nees.rows as u64)),
        ]);
    }
    if let Some(tails) = &c.nis_distribution {
        let share = |share: f64| format!("{} %", short(100.0 * share, 3));
        let band = format!("{} to {}", share(tails.above_95_low), share(tails.above_95_high));
        rows.push(vec!["rows above their 95 % quantile of NIS".to_owned(), share(tails.above_95), band, String::new()]);
    }
    for w in c.whiteness.iter().filter(|w| w.is_tested()) {
        let name = format!("autocorrelation of {}, lag 1", plain(&w.measurement));
        let p_value = if w.p_value < 1e-4 { "< 1e-4".to_owned() } else { format!("= {}", significant(w.p_value, 2)) };
        let found = format!("Ljung-Box p {}", plain(&p_value));
        rows.push(vec![name, short(w.lag_1(), 3), range(-w.band, w.band), found]);
    }
    let findings: Vec<String> =
        c.findings.iter().map(|f| format!("- **{}**: {}.", f.verdict, plain(f.advice.trim_end_matches('.')))).collect();
    Some(format!(
        "## Consistency\n\nJudged on {on}.\n\n{}\n\n{}",
        table(&["", "value", "95 % band", "of"], &rows),
        findings.join("\n")
    ))
}

pub(super) fn pictures(pictures: &[Picture]) -> Option<String> {
    let one = |p: &Picture| format!("![{}]({})\n\n*{}*", plain(&p.caption), p.path, plain(&p.caption));
    let all: Vec<String> = pictures.iter().map(one).collect();
    (!all.is_empty()).then(|| format!("## Pictures\n\n{}", all.join("\n\n")))
}

pub(super) fn filter(tuning: &Tuning) -> Option<String> {
    let Matrices { dt, gain, varies, .. } = &tuning.matrices;
    let unit = &tuning.effort.log.time_unit;
    let step = dt
        .map_or_else(|| "For steps of any length dt".to_owned(), |dt| format!("For a step of {} {unit}", short(dt, 6)));
    let formulas = if varies.is_empty() { "" } else { "; what changes from row to row is a formula" };
    let gain = if *gain == Gain::Steady { "; K is the gain that the filter settles to" } else { "" };
    Some(format!(
        "## The tuned filter\n\n{step}{formulas}{gain}. `tuned.toml` in this folder runs as a problem file.\n\n```text\n{}\n```",
        tuning.matrices.to_string().trim_end()
    ))
}

pub(super) fn search(tuning: &Tuning) -> Option<String> {
    let c = &tuning.certificate;
    let order = if c.order_held { "in the same order" } else { "**in another order**" };
    let mut text = effort(&tuning.effort);
    text += &format!(
        "\n\nCertificate: the {} best candidates were computed again in double precision by code that shares nothing with \
         the search. The two differ by at most {} (relative), and rank them {order}.",
        c.candidates,
        significant(c.largest_relative_gap, 2)
    );
    if let Some(polish) = &tuning.polish {
        let starts = counted(polish.starts, "start");
        text +=
            &format!(" Local searches from {starts} ended it, with {} evaluations.", count(polish.evaluations as u64));
        text += &match (tuning.converged, tuning.gradient_norm, &polish.note) {
            (Some(true), Some(norm), _) => format!(
                " They converged: by its gradient the result is {} standard errors from the optimum.",
                short(norm, 2)
            ),
            (Some(false), _, Some(note)) => format!(" **They did not converge**: {}.", plain(note)),
            (None, _, Some(note)) => format!(" Whether they converged is not known: {}.", plain(note)),
            _ => String::new(),
        };
        if !polish.left_at_start.is_empty() {
            let names: Vec<String> = polish.left_at_start.iter().map(|name| format!("`{name}`")).collect();
            text += &format!(" The cost does not depend on {}: left at the start.", names.join(" and "));
        }
    }
    Some(text)
}

/// How the search went, as a table.
pub(super) fn effort(effort: &Effort) -> String {
    let device = &effort.device;
    let failed = if effort.failed > 0 { format!(", {} of them failed", count(effort.failed)) } else { String::new() };
    let rows = [
        ("problem file", plain(&effort.problem)),
        (
            "log",
            format!(
                "{}, {} rows in {} {}{}",
                plain(&effort.log.source),
                count(effort.log.rows as u64),
                effort.log.trajectories,
                if effort.log.trajectories == 1 { "trajectory" } else { "trajectories" },
                effort.log.span.as_ref().map_or_else(String::new, |[from, to]| format!(", {from} to {to}"))
            ),
        ),
        ("SHA-256 of the log's numbers", format!("`{}`", effort.log.sha256)),
        ("optimiser", format!("`{}`, seed {}", effort.algorithm, effort.seed)),
        ("evaluations", format!("{}{failed}", count(effort.evaluations))),
        ("generations", count(effort.generations as u64)),
        ("ended", ended(effort.stop).to_owned()),
        ("time", format!("{}, of which {} evaluating", seconds(effort.wall_s), seconds(effort.evaluate_s))),
        ("computed on", format!("{} ({}, {})", device.backend, plain(&device.adapter.to_string()), device.precision)),
        ("kfgpu", env!("CARGO_PKG_VERSION").to_owned()),
    ];
    let rows: Vec<Vec<String>> = rows.map(|(what, value)| vec![what.to_owned(), value]).to_vec();
    format!("## The search\n\n{}", table(&["", "value"], &rows))
}

pub(super) fn warnings(warnings: &[String]) -> Option<String> {
    let lines: Vec<String> = warnings.iter().map(|warning| format!("- {}", plain(warning))).collect();
    (!lines.is_empty()).then(|| format!("## Warnings\n\n{}", lines.join("\n")))
}

pub(super) fn words(tuning: &Tuning) -> Option<String> {
    let explained = |name: &str| match name {
        "nll" => Some("`nll`: negative log-likelihood, how unlikely the measurements are to the filter [nats]"),
        "mse_innovation" => Some("`mse_innovation`: mean squared innovation"),
        "mismatch" => Some("`mismatch`: how far the size of the innovations is from what the filter computes for it"),
        "nis" => Some("`nis`: distance of the mean NIS from 1"),
        "nees" => Some("`nees`: distance of the mean NEES from 1"),
        "rmse" => Some("`rmse`: root mean squared error of the estimate against the true states"),
        "distance" => Some("`distance`: summed error of the estimate against the true states"),
        _ => None,
    };
    let mut lines: Vec<&str> = tuning.objectives.iter().filter_map(|(name, _)| explained(name)).collect();
    lines.extend([
        "innovation: a measurement less what the filter predicted for it",
        "NIS: squared innovation in units of its own variance; 1 on average when the filter knows its errors",
        "F, H, Q, R, K: transition, measurement, process noise, measurement noise and gain of the filter",
    ]);
    if tuning.matrices.f0.is_some() || tuning.matrices.h0.is_some() {
        lines.push("f0, h0: what transition and measurement add that no state is part of");
    }
    if tuning.consistency.nees.is_some() {
        lines.push("NEES: squared error of the estimate in units of its own variance, where the truth is known");
    }
    let lines: Vec<String> = lines.into_iter().map(|line| format!("- {line}.")).collect();
    Some(format!("## Words\n\n{}", lines.join("\n")))
}
