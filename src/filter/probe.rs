//! What runs of a few candidates in f64 say before a search: how far an update takes P down, which is what subtraction loses,
//! and the track of the baseline.
//!
//! P grows in the middle of a log where nothing is measured for long, or where H is next to nothing, as at a diffuse start.
//! Only logs in which something comes back into sight after a gap, or starts that are diffuse, are looked at.

use super::columns::Rows;
use super::covariance::Covariance;
use super::error::TraceError;
use super::form::{Carrying, Form, over_rows};
use super::kalman::Recursion;
use super::program::{Program, Role};
use super::trace::trace_rows;
use super::tracer::Tracer;
use crate::model::{Parameters, Problem, Search};
use crate::tape::lanes::{Register, run_apart};
use crate::tape::{Graph, Id};
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
    /// Runs the probe where a start is `diffuse` or the log has a gap; `h` is what each row's H sees, see [`Sight`].
    pub(super) fn run(
        problem: &Problem,
        rows: &Rows<'_>,
        h: &Sight,
        diffuse: bool,
    ) -> Result<Option<Self>, TraceError> {
        let watch = Watch::new(rows, h);
        if !diffuse && watch.after.iter().all(|after| *after <= 0.0) {
            return Ok(None);
        }
        let carrying = Carrying { form: Form::Full, anchored: false };
        let program = trace_rows(problem, rows, &[], None, carrying, Some(&watch))?;
        let n = problem.model.states.len();
        let mut probe = Self { start: 0.0, after: 0.0, track: vec![0.0; n * watch.after.len()] };
        for (block, candidates) in probed(&problem.parameters).chunks(LANES).enumerate() {
            let mut sums = [[0.0_f64; LANES]; 2];
            run_lanes(&program, candidates, |row, seen| {
                if block == 0 {
                    let track = &mut probe.track[row * n..(row + 1) * n];
                    let units = program.units.states.iter().map(|exponent| 2.0_f64.powi(*exponent));
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

/// What the baseline's H sees of the states: the norm of each of its rows in each used row of the log, or of one row for all
/// where H is constant.
pub(super) struct Sight {
    norms: Vec<f64>,
    /// The largest of each component.
    largest: Vec<f64>,
}

impl Sight {
    /// Share of a component's largest norm below which it sees nothing: as good as a missing measurement.
    const BLIND: f64 = 1e-3;

    pub(super) fn new(tracer: &mut Tracer<'_>) -> Result<Self, TraceError> {
        let (jacobian, _) = tracer.measurement_map(&tracer.problem.parameters.baseline())?;
        let (m, n) = (jacobian.len(), tracer.problem.model.states.len());
        let mut entries = Vec::new();
        over_rows(tracer, &jacobian.concat(), |value| entries.push(value));
        let norms: Vec<f64> = entries.chunks(n).map(|row| row.iter().map(|h| h * h).sum::<f64>().sqrt()).collect();
        let mut largest = vec![0.0_f64; m];
        norms.chunks(m).for_each(|row| largest.iter_mut().zip(row).for_each(|(most, norm)| *most = most.max(*norm)));
        Ok(Self { norms, largest })
    }

    /// Whether component `i` sees something in a used row.
    fn sees(&self, i: usize, row: usize) -> bool {
        let norm = self.norms.get(row * self.largest.len() + i);
        norm.is_none_or(|norm| *norm > Self::BLIND * self.largest[i])
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

    /// What is summed up in each row: the states after the update, and the eighth powers of losses before and from the
    /// first gap on, which stand for their maximum.
    pub(super) fn sums(
        &self,
        (g, after): (&mut Graph, Id),
        recursion: &Recursion,
        (prior, posterior): (&Covariance, &Covariance),
        x: &[Id],
    ) -> Vec<(Role, Id)> {
        let mut total = g.constant(0.0);
        if let (Covariance::Full(prior), Covariance::Full(posterior)) = (prior, posterior) {
            let unit = g.constant(1.0 / UNIT);
            for i in 0..x.len() {
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
                let zero = g.constant(0.0);
                power = g.select(before, power, zero);
                for present in recursion.alone(g, i) {
                    power = g.select(present, zero, power);
                }
                total = g.add(total, power);
            }
        }
        let late = g.mul(after, total);
        let early = g.sub(total, late);
        x.iter().copied().chain([early, late]).map(|id| (Role::Sum, id)).collect()
    }

    /// The weights as they are.
    pub(super) fn after(&self) -> Vec<f64> {
        self.after.clone()
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

/// The ends that a candidate's parameter may have.
pub(super) fn range(search: &Search) -> [f64; 2] {
    let finite = |bound: f64, init: f64| if bound.is_finite() { bound } else { init };
    [finite(search.min, search.init[0]), finite(search.max, search.init[1])]
}

/// Runs up to [`LANES`] candidates through the log and shows what each row adds to the sums.
fn run_lanes(program: &Program, candidates: &[Vec<f64>], mut visit: impl FnMut(usize, &[Register<f64, LANES, 1>])) {
    let splat = Register::<f64, LANES, 1>::splat;
    let states = program.carried.iter().filter(|c| c.role == Role::State).count();
    let sums = states..states + program.totals();
    let first = program.parameters;
    for span in &program.spans {
        let mut prologue = vec![splat(0.0); program.prologue.registers.max(first)];
        for (lane, candidate) in (0..LANES).map(|lane| (lane, &candidates[lane.min(candidates.len() - 1)])) {
            candidate.iter().zip(&mut prologue).for_each(|(v, r)| r.lanes_mut()[lane] = *v);
        }
        run_apart(&program.prologue.operations, &mut prologue, &span.scalars);
        let mut registers = vec![splat(0.0); program.step.registers];
        registers[..states].copy_from_slice(&prologue[first..first + states]);
        registers[sums.end..program.carried.len()].fill(splat(1.0));
        let invariants = &prologue[first + states..first + states + program.invariants];
        registers[program.carried.len()..][..program.invariants].copy_from_slice(invariants);
        let mut scalars = vec![0.0; program.columns];
        scalars.extend_from_slice(&program.constants);
        for row in span.rows.clone() {
            let record = &program.record[row * program.columns..(row + 1) * program.columns];
            scalars[..program.columns].copy_from_slice(record);
            run_apart(&program.step.operations, &mut registers, &scalars);
            visit(row, &registers[sums.clone()]);
            registers[sums.clone()].fill(splat(0.0));
        }
    }
}
