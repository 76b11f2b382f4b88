//! The tanker's track, the receiver's filter and the searches' boxes, as problems and logs.

use rand_distr::{Distribution, StandardNormal};

use super::super::ReproduceError;
use crate::data::{Log, Table, Trajectory};
use crate::model::Problem;
use crate::random::{Purpose, Stream};

/// Rows of a track, N.
pub(super) const ROWS: usize = 50;

/// The tanker moves by this each step.
pub(super) const INPUT: [f64; 2] = [1.0, 2.0];

/// Standard deviation of the measurement noise, per axis. The score at R = I fixes only N sigma: the steady gain is
/// .618, the mean error .838 sigma a row, and the paper's 70.44 then says N sigma = 84.04.
#[must_use]
pub(super) fn sigma(rows: usize) -> f64 {
    84.04 / rows as f64
}

/// Where M is drawn from, and whether it must stay there.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Bounds {
    /// Drawn from [0, sqrt 10] each, then without limits.
    Free,
    /// Drawn from, and clipped to, this range.
    Box(f64, f64),
}

/// The problem whose M moves within `bounds`. No start joins generation 0: the untuned filter is scored apart.
pub(super) fn problem(bounds: Bounds) -> Result<Problem, ReproduceError> {
    let range = match bounds {
        Bounds::Free => format!("init = [0, {}]", 10.0_f64.sqrt()),
        Bounds::Box(low, high) => format!("min = {low}, max = {high}"),
    };
    let text = format!(
        "[data]\n\
         file = \"-\"\n\
         measurements = [\"zx\", \"zy\"]\n\
         inputs = [\"ux\", \"uy\"]\n\
         truth = {{ x = \"x\", y = \"y\" }}\n\
         [model]\n\
         state = [\"x\", \"y\"]\n\
         f = [\"x + ux\", \"y + uy\"]\n\
         h = [\"x\", \"y\"]\n\
         Q = [1, 1]\n\
         R = {{ factor = \"M\", form = \"square\" }}\n\
         x0 = \"measurement\"\n\
         P0 = [1, 1]\n\
         [parameters]\n\
         M = {{ {range} }}\n\
         [tune]\n\
         algorithm = \"pso\"\n\
         objectives = [\"distance\"]\n\
         population = 200\n\
         generations = 150\n\
         include_start = false\n\
         polish = false\n"
    );
    Ok(Problem::parse(&text, "kf-pio")?)
}

/// M of the untuned filter, R = I.
pub(super) const UNTUNED: [f64; 4] = [1.0, 0.0, 0.0, 1.0];

/// One noisy track: t_i = i (1, 2) and z_i = t_i + sigma n_i, the n_i drawn in the order of i, x before y.
fn track(seed: u64, data_set: u64, realisation: u64) -> Trajectory {
    let mut stream = Stream::new(seed, Purpose::MeasurementNoise, data_set, realisation);
    let mut noise = || sigma(ROWS) * Distribution::<f64>::sample(&StandardNormal, &mut stream);
    let mut track = Trajectory {
        id: realisation.to_string(),
        time: Vec::with_capacity(ROWS),
        z: Table::new(2),
        u: Table::new(2),
        truth: Table::new(2),
        line: Vec::with_capacity(ROWS),
    };
    for i in 1..=ROWS {
        let truth = INPUT.map(|step| i as f64 * step);
        track.time.push(i as f64);
        track.z.push(&truth.map(|t| t + noise()));
        track.u.push(&INPUT);
        track.truth.push(&truth);
        track.line.push(i as u64 + 1);
    }
    track
}

fn log_of(trajectories: Vec<Trajectory>) -> Log {
    let names = |a: &str, b: &str| vec![a.to_owned(), b.to_owned()];
    Log {
        source: "<drawn>".to_owned(),
        measurements: names("zx", "zy"),
        inputs: names("ux", "uy"),
        truth: names("x", "y"),
        trajectories,
        ..Log::default()
    }
}

/// The track that data set `data_set` tunes on.
#[must_use]
pub(super) fn log(seed: u64, data_set: u64) -> Log {
    log_of(vec![track(seed, data_set, 0)])
}

/// `count` fresh realisations of the same track, pooled.
#[must_use]
pub(super) fn fresh(seed: u64, data_set: u64, count: u64) -> Log {
    log_of((1..=count).map(|realisation| track(seed, data_set, realisation)).collect())
}

#[cfg(test)]
#[expect(clippy::float_cmp, reason = "the same bits are meant")]
mod tests {
    use super::*;

    #[test]
    fn tracks_differ_and_fresh_ones_are_not_the_training_track() {
        let (a, b, fresh) = (log(1, 0), log(1, 1), fresh(1, 0, 3));
        let first = |log: &Log, t: usize| log.trajectories[t].z.row(0)[0];
        let seen =
            [first(&a, 0), first(&b, 0), first(&fresh, 0), first(&fresh, 1), first(&fresh, 2), first(&log(2, 0), 0)];
        assert!((0..6).all(|i| (0..i).all(|j| seen[i] != seen[j])), "{seen:?}");
        assert_eq!(a.rows(), ROWS);
        assert_eq!(a.trajectories[0].truth.row(ROWS - 1), [50.0, 100.0]);
    }

    #[test]
    fn noise_has_the_stated_spread() {
        let log = fresh(3, 0, 200);
        let errors: Vec<f64> =
            log.trajectories.iter().flat_map(|t| (0..ROWS).map(|k| t.z.row(k)[1] - t.truth.row(k)[1])).collect();
        let spread = super::super::super::statistics::standard_deviation(&errors);
        // 10 000 draws: the standard error of a standard deviation is 0.7 %.
        assert!((spread / sigma(ROWS) - 1.0).abs() < 0.03, "{spread}");
    }
}
