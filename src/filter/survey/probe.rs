//! What runs of a few candidates in f64 say before a search: how far an update takes P down, which is what subtraction loses,
//! and the track of the baseline.
//!
//! P grows in the middle of a log where nothing is measured for long, or where H is next to nothing, as at a diffuse start.
//! Only logs in which something comes back into sight after a gap, or starts that are diffuse, are looked at.

use super::sight::Sight;
use super::{Survey, range, units};
use crate::filter::carried::Role;
use crate::filter::columns::{Columns, Key};
use crate::filter::covariance::Covariance;
use crate::filter::error::TraceError;
use crate::filter::evidence::Evidence;
use crate::filter::form::{Carrying, Form};
use crate::filter::program::Program;
use crate::filter::rounds::trace_rows;
use crate::filter::rows::Rows;
use crate::filter::step::{self, Request};
use crate::filter::tracer::Tracer;
use crate::model::Parameters;
use crate::precision::Precision;
use crate::tape::Id;
use crate::tape::lanes::Register;
use std::f64::consts::PI;

/// Candidates side by side.
const LANES: usize = 8;
/// Unit of a loss while it is summed up, so that eighth powers neither overflow nor vanish.
const UNIT: f64 = 1e6;

/// What was found.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Probe {
    /// The largest variance before an update over that after it, of states that no sensor sees by themselves, up to the
    /// first gap of each trajectory. (The ratio form takes nothing away from the others.)
    pub(super) start: f64,
    /// The same from the first gap on.
    pub(super) after: f64,
    /// The baseline's states after the update of each used row, n values a row, in the problem's own units.
    pub(super) track: Vec<f64>,
}

/// Which rows come after a gap.
pub(super) struct Watch {
    /// 1 from the first gap of a trajectory on, else 0; one a used row.
    after: Vec<f64>,
}

impl Probe {
    /// Runs the probe where a start is `diffuse` or the log has a gap, of measurements or of what H sees.
    pub(super) fn run(survey: &Survey<'_>, diffuse: bool) -> Result<Option<Self>, TraceError> {
        let (problem, rows) = (survey.t.problem, survey.t.rows);
        let watch = Watch::new(rows, &Sight::new(survey));
        if !diffuse && watch.after.iter().all(|after| *after <= 0.0) {
            return Ok(None);
        }
        let carrying = Carrying { form: Form::Full, anchored: false, affine: true };
        let units = units::choose(survey, Precision::F64);
        let request = Request { objectives: &[], nominal: None, carrying, units: &units, watch: Some(&watch) };
        let program = trace_rows(problem, rows, &mut Columns::default(), &request)?;
        let n = problem.model.states.len();
        let mut probe = Self { start: 0.0, after: 0.0, track: vec![0.0; n * watch.after.len()] };
        for (block, candidates) in probed(&problem.parameters).chunks(LANES).enumerate() {
            let mut sums = [[0.0_f64; LANES]; 2];
            run_lanes(&program, candidates, |row, seen| {
                if block == 0 {
                    let track = &mut probe.track[row * n..(row + 1) * n];
                    let units = program.units().states.iter().map(|exponent| 2.0_f64.powi(*exponent));
                    track.iter_mut().zip(seen).zip(units).for_each(|((x, seen), unit)| *x = seen.lanes()[0] * unit);
                }
                for (sums, seen) in sums.iter_mut().zip(&seen[n..]) {
                    sums.iter_mut().zip(seen.lanes()).for_each(|(sum, seen)| *sum += seen);
                }
            });
            // What has no value has lost everything.
            let largest = |sums: [f64; LANES]| {
                let losses = sums[..candidates.len()].iter().map(|sum| UNIT * sum.powf(0.125));
                losses.map(|loss| if loss.is_nan() { f64::INFINITY } else { loss }).fold(0.0, f64::max)
            };
            probe.start = probe.start.max(largest(sums[0]));
            probe.after = probe.after.max(largest(sums[1]));
        }
        Ok(Some(probe))
    }
}

impl Watch {
    /// Times a component's usual spacing after which it counts as coming back into sight.
    const LONG: f64 = 4.0;

    fn new(rows: &Rows<'_>, h: &Sight) -> Self {
        let components = rows.log.measurements.len();
        let spans = rows.spans();
        let mut first = vec![usize::MAX; spans.len()];
        for i in 0..components {
            let mut spacings: Vec<(f64, usize, usize)> = Vec::new();
            for (t, (trajectory, begin)) in rows.log.trajectories.iter().zip(&rows.first).enumerate() {
                let mut last = *begin;
                let seen = |k: &usize| !trajectory.z.row(*k)[i].is_nan() && h.sees(i, spans[t].start + k - begin);
                for k in (*begin..trajectory.len()).filter(seen) {
                    if k > last {
                        spacings.push((trajectory.time[k] - trajectory.time[last], t, k - begin));
                    }
                    last = k;
                }
            }
            let middle = spacings.len() / 2;
            if spacings.is_empty() {
                continue;
            }
            let usual = spacings.select_nth_unstable_by(middle, |a, b| a.0.total_cmp(&b.0)).1.0;
            for (_, t, k) in spacings.iter().filter(|(spacing, ..)| *spacing > Self::LONG * usual) {
                first[*t] = first[*t].min(*k);
            }
        }
        let flags = spans.iter().zip(first).flat_map(|(span, first)| (0..span.len()).map(move |k| k >= first));
        Self { after: flags.map(|after| f64::from(u8::from(after))).collect() }
    }
}

impl step::Watch for Watch {
    /// The states after the update, and the eighth powers of losses before and from the first gap on, which stand for their
    /// maximum.
    fn sums(&self, t: &mut Tracer<'_>, prior: &[Id], evidence: &Evidence, _: &[Id]) -> Vec<(Role, Id)> {
        let x = &evidence.state;
        let after = t.columns.node(&mut t.g, Key::AfterGap, || self.after.clone());
        let g = &mut t.g;
        let prior = Covariance::from_entries(g, Form::Full, x.len(), &prior[x.len()..]).matrix(g);
        let posterior = evidence.covariance.matrix(g);
        let (zero, unit) = (g.constant(0.0), g.constant(1.0 / UNIT));
        let mut total = zero;
        for (i, alone) in evidence.alone.iter().enumerate() {
            let (before, left) = (prior.at(i, i), posterior.at(i, i));
            if before == left {
                continue;
            }
            let ratio = g.div(before, left);
            let mut power = g.mul(ratio, unit);
            for _ in 0..3 {
                power = g.mul(power, power);
            }
            // A state known exactly loses nothing; what a sensor sees by itself is multiplied.
            power = g.select(before, power, zero);
            for present in alone {
                power = g.select(*present, zero, power);
            }
            total = g.add(total, power);
        }
        let late = g.mul(after, total);
        let early = g.sub(total, late);
        x.iter().copied().chain([early, late]).map(|id| (Role::Sum, id)).collect()
    }
}

/// The baseline, every searched parameter at its lower and upper bound (the range of the first population where there is no
/// bound), all corners of up to four parameters, and each of more at its other bound.
pub(crate) fn probed(parameters: &Parameters) -> Vec<Vec<f64>> {
    let bounds: Vec<[f64; 2]> = parameters.searched().map(|(_, search)| range(search)).collect();
    let d = bounds.len();
    let corner = |upper: &dyn Fn(usize) -> bool| (0..d).map(|i| bounds[i][usize::from(upper(i))]).collect();
    let mut all = vec![parameters.baseline()];
    if d <= 4 {
        all.extend((0..1_usize << d).map(|corners| corner(&|i| corners >> i & 1 == 1)));
    } else {
        all.extend([corner(&|_| false), corner(&|_| true)]);
        all.extend((0..d).map(|other| corner(&|i| i == other)));
    }
    all
}

/// So many candidates all over the ranges of the first population, on the scale of each parameter: multiples of irrational
/// numbers fill them evenly (Weyl 1916, doi:10.1007/BF01475864).
pub(crate) fn scattered(parameters: &Parameters, count: usize) -> Vec<Vec<f64>> {
    let share = |number: usize, i: usize| (number as f64 * (i as f64 + 2.0).sqrt() * PI).fract();
    let candidate = |k| parameters.searched().enumerate().map(|(i, (_, search))| search.at(share(k, i))).collect();
    (1..=count).map(candidate).collect()
}

/// Runs up to [`LANES`] candidates through the log and shows what each row adds to the sums.
fn run_lanes(program: &Program, candidates: &[Vec<f64>], mut visit: impl FnMut(usize, &[Register<f64, LANES, 1>])) {
    let states = program.varies().len();
    let after = |row: usize, registers: &mut [Register<f64, LANES, 1>]| {
        let sums = &mut registers[states..states + program.totals()];
        visit(row, sums);
        sums.fill(Register::splat(0.0));
    };
    program.walk(candidates, |_| (), after);
}
