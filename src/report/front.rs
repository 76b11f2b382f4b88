//! The front of a study of several objectives, for people, JSON and CSV.

use std::io::Write;

use rayon::prelude::*;
use serde::Serialize;

use super::consistency::Band;
use super::document::Section;
use super::{ConstraintCheck, Named, constraint_checks};
use crate::data::Log;
use crate::model::{Pick, Problem};
use crate::number::{short, significant};
use crate::objective::{Kind, Objective};
use crate::optimize::pareto::dominates;
use crate::reference;
use crate::study::{Among, FrontMember, Landmarks, MeanNis, Outcome, Split, scoring_rows};
use crate::table::{Cell, Table};
use crate::words::counted;

/// Members that its table shows.
const SHOWN: usize = 10;
/// Parameters that its table has columns for.
const SHOWN_PARAMETERS: usize = 6;
/// Digits of the table.
const DIGITS: usize = 6;

/// A member of the front. Objectives are those of the f64 reference.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontPoint {
    /// Values in their own units.
    pub parameters: Named<f64>,
    /// Objectives over the rows that were tuned on.
    pub objectives: Named<f64>,
    /// Objectives over held-out rows; `None` without a validation split, or where the filter fails on them.
    pub held_out: Option<Named<f64>>,
    /// Mean NIS over the rows that were tuned on; `None` where nothing was measured.
    pub nis_mean: Option<f64>,
    /// Whether that is in its 95 % band.
    pub consistent: Option<bool>,
    /// What it is: `recommended`, `knee` (or `most even`, of a front without a knee), `best nll` and so on.
    pub marks: Vec<String>,
}

/// What a front offers, as a whole.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct FrontSummary {
    /// How the recommended member was picked: a mark of [`FrontPoint::marks`], or `weights`.
    pub pick: String,
    /// The members that a recommended knee was looked for among (docs/semantics.md, Several objectives).
    pub among: Among,
    /// How many members have a mean NIS in its 95 % band; `None` where nothing was measured.
    pub consistent: Option<usize>,
    /// Whether the front has a knee: members nearer to the ideal point than the plane through the ends.
    pub has_knee: bool,
    /// The best value of each objective over the front.
    pub best: Named<f64>,
    /// What the recommended member gives up: (value - best) / |best| of each objective, `None` where the best is 0; of
    /// `nll`, whose zero depends on units, value - best in nats.
    pub given_up: Named<Option<f64>>,
    /// That of `nll`, divided by the rows that score; `None` where it is no objective.
    pub given_up_nats_per_row: Option<f64>,
    /// Members at least as good as the baseline in every objective and better in one; `None` where the baseline fails.
    pub dominate_baseline: Option<usize>,
    /// Whether the baseline meets every constraint.
    pub baseline_feasible: bool,
    /// Volume that the search's front dominates.
    pub hypervolume: Option<f64>,
    /// The point it is measured from, which the first generation with a feasible member fixes.
    pub reference_point: Named<f64>,
}

/// Members and summary of an outcome's front, re-scored on held-out rows where there are any; `None` without a front.
#[must_use]
pub fn front(problem: &Problem, outcome: &Outcome, split: &Split) -> Option<(Vec<FrontPoint>, FrontSummary)> {
    let landmarks = outcome.landmarks.as_ref()?;
    let names: Vec<&str> = problem.tune.objectives.iter().map(Objective::name).collect();
    let point = |(i, member): (usize, &FrontMember)| {
        let held_out = split.held_out.as_ref();
        let scores = held_out.and_then(|held_out| reference::costs_held_out(problem, held_out, &member.candidate).ok());
        FrontPoint {
            parameters: Named::new(problem.parameters.names(), member.candidate.iter().copied()),
            objectives: Named::new(names.iter().copied(), member.objectives.iter().copied()),
            held_out: scores.map(|scores| Named::new(names.iter().copied(), scores)),
            nis_mean: member.nis.map(|nis| nis.mean),
            consistent: member.nis.map(|nis| nis.is_consistent()),
            marks: marks(landmarks, &names, i),
        }
    };
    let points: Vec<FrontPoint> = outcome.front.par_iter().enumerate().map(point).collect();
    Some((points, summary(problem, outcome, landmarks, &split.train)?))
}

/// The mean NIS of a candidate over `log` by the f64 reference; `None` where its filter fails or nothing is measured.
#[must_use]
pub fn mean_nis(problem: &Problem, log: &Log, candidate: &[f64]) -> Option<MeanNis> {
    let (mut sum, mut components) = (0.0, 0_u32);
    reference::visit(problem, log, candidate, &mut |_, step| {
        if let Some(update) = &step.update {
            sum += update.nis;
            components += update.present.len() as u32;
        }
    })
    .ok()?;
    let Band { mean, low, high } = Band::of(sum, f64::from(components));
    (components > 0).then_some(MeanNis { mean, low, high })
}

fn marks(landmarks: &Landmarks, names: &[&str], i: usize) -> Vec<String> {
    let recommended = (i == landmarks.recommended).then(|| "recommended".to_owned());
    let knee = (i == landmarks.knee).then(|| knee_mark(landmarks).to_owned());
    let ends = landmarks.ends.iter().zip(names).filter(|(end, _)| **end == i).map(|(_, name)| format!("best {name}"));
    recommended.into_iter().chain(knee).chain(ends).collect()
}

const fn knee_mark(landmarks: &Landmarks) -> &'static str {
    if landmarks.has_knee { "knee" } else { "most even" }
}

fn summary(problem: &Problem, outcome: &Outcome, landmarks: &Landmarks, log: &Log) -> Option<FrontSummary> {
    let objectives = &problem.tune.objectives;
    let names: Vec<&str> = objectives.iter().map(Objective::name).collect();
    let named = |values: Vec<f64>| Named::new(names.iter().copied(), values);
    let best: Vec<f64> = landmarks
        .ends
        .iter()
        .enumerate()
        .map(|(j, end)| outcome.front.get(*end)?.objectives.get(j).copied())
        .collect::<Option<_>>()?;
    let recommended = &outcome.front.get(landmarks.recommended)?.objectives;
    let given_up = |(objective, (value, best)): (&Objective, (&f64, &f64))| match objective.kind {
        Kind::Nll => Some(value - best),
        _ => (best.abs() > 0.0).then(|| (value - best) / best.abs()),
    };
    let given_up: Vec<Option<f64>> = objectives.iter().zip(recommended.iter().zip(&best)).map(given_up).collect();
    let nll = objectives.iter().position(|objective| objective.kind == Kind::Nll);
    let rows = |i: usize| scoring_rows(problem, log, &vec![0; log.trajectories.len()], &objectives[i]) as f64;
    let pick = match &problem.tune.pick {
        Pick::Knee => knee_mark(landmarks).to_owned(),
        Pick::Best(j) => format!("best {}", names.get(*j).copied().unwrap_or_default()),
        Pick::Weights(_) => "weights".to_owned(),
    };
    let beats = |baseline: &Vec<f64>| outcome.front.iter().filter(|m| dominates(&m.objectives, baseline)).count();
    Some(FrontSummary {
        pick,
        among: landmarks.among,
        consistent: consistent_members(outcome),
        has_knee: landmarks.has_knee,
        given_up_nats_per_row: nll.and_then(|i| Some(given_up[i]? / rows(i))),
        given_up: Named::new(names.iter().copied(), given_up),
        best: named(best),
        dominate_baseline: outcome.baseline.objectives.as_ref().map(beats),
        baseline_feasible: constraint_checks(problem, outcome).iter().all(ConstraintCheck::met_by_baseline),
        hypervolume: outcome.history.last().and_then(|row| row.hypervolume),
        reference_point: named(outcome.reference_point.clone()),
    })
}

/// How many members have a mean NIS in its band; `None` where none has a mean NIS.
fn consistent_members(outcome: &Outcome) -> Option<usize> {
    let known: Vec<MeanNis> = outcome.front.iter().filter_map(|member| member.nis).collect();
    (!known.is_empty()).then(|| known.iter().filter(|nis| nis.is_consistent()).count())
}

/// The whole front as CSV: parameters, objectives, `held_out.` objectives where they are, `nis_mean` and marks.
///
/// # Errors
/// If `out` cannot be written.
pub fn write_front(points: &[FrontPoint], out: impl Write) -> Result<(), csv::Error> {
    let Some(first) = points.first() else { return Ok(()) };
    let validated = points.iter().any(|point| point.held_out.is_some());
    let heads = first.parameters.iter().chain(first.objectives.iter()).map(|(name, _)| name.to_owned());
    let held_out = first.objectives.iter().filter(|_| validated).map(|(name, _)| format!("held_out.{name}"));
    let mut table = Table::of(heads.chain(held_out).chain(["nis_mean", "marks"].map(str::to_owned)));
    let number = |value: Option<&f64>| value.map_or(Cell::Empty, |v| Cell::Number(*v, DIGITS));
    for point in points {
        let values = point.parameters.iter().chain(point.objectives.iter()).map(|(_, value)| number(Some(value)));
        let held_out = |name| number(point.held_out.as_ref().and_then(|held_out| held_out.get(name)));
        let held_out = point.objectives.iter().filter(|_| validated).map(|(name, _)| held_out(name));
        table.push(values.chain(held_out).chain([number(point.nis_mean.as_ref()), point.marks.join("; ").into()]));
    }
    table.write_csv(out)
}

impl FrontSummary {
    /// "knee: nll 3.2 nats above its best (0.03 a row), rmse at its best".
    #[must_use]
    pub fn given_up_line(&self, recommended: &FrontPoint) -> String {
        let part = |(name, value): (&str, &f64)| {
            let best = self.best.get(name).copied().unwrap_or(*value);
            match self.given_up.get(name).copied().flatten() {
                _ if *value <= best => format!("{name} at its best"),
                Some(nats) if name == "nll" => {
                    let row =
                        self.given_up_nats_per_row.map_or_else(String::new, |v| format!(" ({} a row)", short(v, 2)));
                    format!("nll {} nats above its best{row}", short(nats, 3))
                }
                // A best close to 0 makes any share of it large and meaningless.
                Some(share) if share < 10.0 => format!("{name} {} % above its best", significant(100.0 * share, 2)),
                _ => format!("{name} {} (best {})", short(*value, 3), short(best, 3)),
            }
        };
        format!(
            "{}: {}",
            self.picked(recommended),
            recommended.objectives.iter().map(part).collect::<Vec<_>>().join(", ")
        )
    }

    /// What was picked, and from which members where not from all.
    fn picked(&self, recommended: &FrontPoint) -> String {
        let is = |what: &str| format!("{} of the members that {what}", self.pick);
        match self.among {
            // That of the whole front too.
            _ if recommended.marks.contains(&self.pick) => self.pick.clone(),
            _ if !matches!(self.pick.as_str(), "knee" | "most even") => self.pick.clone(),
            Among::All => self.pick.clone(),
            Among::Dominating => is("dominate the baseline"),
            Among::Consistent => is("are consistent"),
            Among::ConsistentAndDominating => is("are consistent and dominate the baseline"),
        }
    }

    /// How many members can be trusted; nothing where nothing was measured.
    fn consistent_line(&self, members: usize) -> String {
        match self.consistent {
            None => String::new(),
            Some(0) => " None is consistent: no mean NIS is in its 95 % band.".to_owned(),
            Some(1) => format!(" 1 of {members} is consistent (mean NIS in its 95 % band)."),
            Some(some) => format!(" {some} of {members} are consistent (mean NIS in its 95 % band)."),
        }
    }

    /// How the front stands to the user's own candidate.
    fn baseline_line(&self, members: usize) -> String {
        match self.dominate_baseline {
            _ if !self.baseline_feasible => "The baseline does not meet every constraint.".to_owned(),
            None => "The baseline fails, so it cannot be compared.".to_owned(),
            Some(0) => "No member dominates the baseline (is as good in every objective and better in one).".to_owned(),
            Some(better) => format!(
                "{better} of {members} {} the baseline (as good in every objective and better in one).",
                if better == 1 { "dominates" } else { "dominate" },
            ),
        }
    }

    /// All that is said of a front.
    pub(super) fn section(&self, points: &[FrontPoint], validated: bool) -> Section {
        let recommended = points.iter().find(|p| p.marks.first().is_some_and(|mark| mark == "recommended"));
        let line = recommended.map(|point| self.given_up_line(point)).unwrap_or_default();
        let shown = representatives(points);
        let of = if shown.len() < points.len() { format!(", {} shown", shown.len()) } else { String::new() };
        let rows = if validated { "training rows beside held-out rows" } else { "in-sample" };
        let meaning = match points {
            [_] => "One candidate is the best under every objective at once.",
            _ => {
                "No candidate is best under every objective. For each of these, no other is as good in every objective and \
                 better in one. `front.csv` has all of them."
            }
        };
        let (members, consistent) = (points.len(), self.consistent_line(points.len()));
        Section::new(format!("Front, {rows}, f64 ({}{of})", counted(members, "member")))
            .on_page(meaning)
            .with(table(points, &shown, validated))
            .with(format!("Recommended: {line}."))
            .with(format!("{}{consistent}", self.baseline_line(members)))
    }
}

/// Every marked member, and others evenly along the front.
fn representatives(points: &[FrontPoint]) -> Vec<usize> {
    if points.len() <= SHOWN {
        return (0..points.len()).collect();
    }
    let mut shown: Vec<usize> = (0..points.len()).filter(|i| !points[*i].marks.is_empty()).collect();
    let room = SHOWN.saturating_sub(shown.len());
    let last = points.len() - 1;
    shown.extend((1..=room).map(|i| i * last / (room + 1)));
    shown.sort_unstable();
    shown.dedup();
    shown
}

/// Objectives, on training rows beside held-out rows (`-` where a member's filter fails there), mean NIS, parameters where
/// they are few, and marks.
fn table(points: &[FrontPoint], shown: &[usize], validated: bool) -> Table {
    let Some(first) = points.first() else { return Table::default() };
    let names =
        |named: &Named<f64>, rows: &str| named.iter().map(|(name, _)| format!("{name}{rows}")).collect::<Vec<_>>();
    let with_parameters = first.parameters.iter().len() <= SHOWN_PARAMETERS;
    let mut heads = names(&first.objectives, if validated { ", training" } else { "" });
    heads.extend(names(&first.objectives, ", held out").into_iter().filter(|_| validated));
    heads.push("NIS".to_owned());
    heads.extend(names(&first.parameters, "").into_iter().filter(|_| with_parameters));
    heads.push(String::new());
    let row = |i: &usize| {
        let point = &points[*i];
        let held_out = |name: &str| point.held_out.as_ref().and_then(|held_out| held_out.get(name));
        let held_out = |(name, _)| held_out(name).map_or("-".into(), |value| Cell::Number(*value, DIGITS));
        let mut row: Vec<Cell> = point.objectives.iter().map(|(_, value)| Cell::Number(*value, DIGITS)).collect();
        row.extend(point.objectives.iter().filter(|_| validated).map(held_out));
        row.push(point.nis_mean.map_or(Cell::Empty, |nis| Cell::Number(nis, 3)));
        let parameters = point.parameters.iter().filter(|_| with_parameters);
        row.extend(parameters.map(|(_, value)| Cell::Text(short(*value, DIGITS))));
        row.push(point.marks.join(", ").into());
        row
    };
    Table { rows: shown.iter().map(row).collect(), ..Table::of(heads) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn point(i: usize, objectives: [f64; 2], marks: &[&str]) -> FrontPoint {
        FrontPoint {
            parameters: Named::new(["q"], [i as f64]),
            objectives: Named::new(["nll", "rmse"], objectives),
            held_out: None,
            nis_mean: None,
            consistent: None,
            marks: marks.iter().map(|m| (*m).to_owned()).collect(),
        }
    }

    fn summary(pick: &str, best: [f64; 2], given_up: [Option<f64>; 2]) -> FrontSummary {
        FrontSummary {
            pick: pick.to_owned(),
            among: Among::All,
            consistent: None,
            given_up_nats_per_row: Some(0.016),
            has_knee: true,
            best: Named::new(["nll", "rmse"], best),
            given_up: Named::new(["nll", "rmse"], given_up),
            dominate_baseline: Some(3),
            baseline_feasible: true,
            hypervolume: None,
            reference_point: Named::default(),
        }
    }

    #[test]
    fn what_is_given_up_is_said_by_name() {
        let mut knee = summary("knee", [-100.0, 2.0], [Some(3.2), Some(0.011)]);
        let member = point(0, [-96.8, 2.022], &["recommended", "knee"]);
        let line = knee.given_up_line(&member);
        assert_eq!(line, "knee: nll 3.2 nats above its best (0.016 a row), rmse 1.1 % above its best");
        (knee.among, knee.consistent) = (Among::ConsistentAndDominating, Some(1));
        assert_eq!(knee.given_up_line(&member), line, "the knee of the whole front too");
        let line = knee.given_up_line(&point(0, [-96.8, 2.022], &["recommended"]));
        assert!(
            line.starts_with("knee of the members that are consistent and dominate the baseline: nll 3.2"),
            "{line}"
        );
        let text = knee.section(&[member], false).text();
        assert!(text.ends_with(" 1 of 1 is consistent (mean NIS in its 95 % band).\n"), "{text}");
        let end = summary("best nll", [-5.0, 1e-9], [Some(0.0), Some(4e7)]);
        let line = end.given_up_line(&point(0, [-5.0, 0.04], &["recommended", "best nll"]));
        assert_eq!(line, "best nll: nll at its best, rmse 0.04 (best 1e-9)");
    }

    #[test]
    fn few_members_are_shown_and_all_with_a_mark() {
        let marked = |i: usize| match i {
            0 => vec!["best nll"],
            41 => vec!["recommended", "knee"],
            99 => vec!["best rmse"],
            _ => vec![],
        };
        let points: Vec<FrontPoint> = (0..100).map(|i| point(i, [i as f64, 99.0 - i as f64], &marked(i))).collect();
        let shown = representatives(&points);
        assert!(shown.len() <= SHOWN && [0, 41, 99].iter().all(|i| shown.contains(i)), "{shown:?}");
        let widest = shown.windows(2).map(|w| w[1] - w[0]).max().unwrap();
        assert!(widest <= 13, "evenly: {shown:?}");
        let text = summary("knee", [0.0, 0.0], [None, None]).section(&points, false).text();
        assert!(text.starts_with("Front, in-sample, f64 (100 members, 10 shown)"), "{text}");
        assert!(text.contains("recommended, knee"), "{text}");
        assert_eq!(representatives(&points[..1]), [0]);
        assert_eq!(representatives(&points[1..3]), [0, 1]);
    }

    #[test]
    fn the_table_has_held_out_columns_only_where_there_are_scores() {
        let written = |points: &[FrontPoint]| {
            let mut out = Vec::new();
            write_front(points, &mut out).unwrap();
            String::from_utf8(out).unwrap()
        };
        let mut points = vec![point(1, [1.5, 2.0], &["best nll"]), point(2, [2.5, 1.0], &["recommended", "knee"])];
        points[1].nis_mean = Some(0.95);
        let expected = "q,nll,rmse,nis_mean,marks\n1,1.5,2,,best nll\n2,2.5,1,0.95,recommended; knee\n";
        assert_eq!(written(&points), expected);
        points[1].held_out = Some(Named::new(["nll", "rmse"], [3.5, 4.0]));
        let expected = "q,nll,rmse,held_out.nll,held_out.rmse,nis_mean,marks\n1,1.5,2,,,,best nll\n2,2.5,1,3.5,4,0.95,recommended; knee\n";
        assert_eq!(written(&points), expected);
        let text = summary("knee", [1.5, 1.0], [None, None]).section(&points, true).text();
        assert!(text.starts_with("Front, training rows beside held-out rows, f64 (2 members):"), "{text}");
        let line = |i: usize| text.lines().nth(i).map(|line| line.split_whitespace().collect::<Vec<_>>().join(" "));
        assert_eq!(
            line(1).as_deref(),
            Some("nll, training rmse, training nll, held out rmse, held out NIS q"),
            "{text}"
        );
        assert_eq!(line(3).as_deref(), Some("2.50000 1.00000 3.50000 4.00000 0.950 2 recommended, knee"), "{text}");
    }
}
