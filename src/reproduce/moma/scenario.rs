//! The rocket, its filter and the data sets.

use super::super::ReproduceError;
use super::super::protocol::seed_of;
use crate::data::Log;
use crate::model::Problem;
use crate::random::{Purpose, Stream};

/// Range of the searched R, and of the fixed R0 of the filters that are not tuned.
pub(super) const RANGE: [f64; 2] = [0.1, 45.0];

/// Which filter runs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Filter {
    /// R as given.
    Regular,
    /// Q adapted by Sage and Husa's recursion, b = 0.98.
    SageHusa,
    /// R adapted by fuzzy covariance matching.
    Fuzzy,
}

impl Filter {
    const fn table(self) -> &'static str {
        match self {
            Self::Regular => "",
            Self::SageHusa => "[filter]\nkind = \"sage-husa\"\n",
            Self::Fuzzy => "[filter]\nkind = \"fuzzy\"\n",
        }
    }
}

/// What a candidate is scored by.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Scores {
    /// f1, the mean squared innovation, and f2, the mismatch of the last 100 innovations to S of the last step.
    Both,
    /// The root mean square of the three-state error over k = 0..200.
    Rmse,
}

/// The study's problem. The true R is 3.
pub(super) fn problem(filter: Filter, scores: Scores) -> Result<Problem, ReproduceError> {
    let objectives = match scores {
        Scores::Both => "\"mse_innovation\", { name = \"mismatch\", window = 100, ct = \"last\" }",
        Scores::Rmse => "\"rmse\"",
    };
    let text = format!(
        "[data]\n\
         time = \"k\"\n\
         measurements = [\"range\"]\n\
         truth = {{ d = \"d\", v = \"v\", a = \"a\" }}\n\
         [model]\n\
         state = [\"d\", \"v\", \"a\"]\n\
         f = [\"d + v + 0.5*a\", \"v + a\", \"a\"]\n\
         h = [\"d\"]\n\
         Q = {{ a = 0.1 }}\n\
         R = [\"r\"]\n\
         x0 = [990, 0, 0]\n\
         P0 = [30, 20, 10]\n\
         first = \"update\"\n\
         [parameters]\n\
         r = {{ min = {}, max = {} }}\n\
         {}\
         [tune]\n\
         algorithm = \"random\"\n\
         objectives = [{objectives}]\n\
         population = 20\n\
         include_start = false\n\
         polish = false\n\
         [simulate]\n\
         steps = 200\n\
         dt = 1\n\
         x0 = [1000, 50, 20]\n\
         parameters = {{ r = 3 }}\n\
         skip_first = true\n",
        RANGE[0],
        RANGE[1],
        filter.table(),
    );
    Ok(Problem::parse(&text, "moma")?)
}

/// Where the draws of a data set begin among the seeds of its searches.
const DATA: u64 = 1 << 40;

/// The log of a data set: row 0 has truth and no measurement.
pub(super) fn log(problem: &Problem, seed: u64, data_set: u64) -> Result<Log, ReproduceError> {
    Ok(crate::simulate::simulate(problem, Some(seed_of(seed, data_set, DATA)))?)
}

/// R0 of each run, uniform over [`RANGE`].
#[must_use]
pub(super) fn starts(seed: u64, data_set: u64, runs: u64) -> Vec<f64> {
    let mut stream = Stream::new(seed, Purpose::Workload, data_set, DATA + 1);
    (0..runs).map(|_| RANGE[0] + stream.uniform() * (RANGE[1] - RANGE[0])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reference;

    /// f1, f2 and RMSE of the printed steps, written out as plain loops.
    #[test]
    fn objectives_are_those_of_the_study() {
        let problem = |scores| problem(Filter::Regular, scores).unwrap();
        let log = log(&problem(Scores::Both), 1, 0).unwrap();
        let track = &log.trajectories[0];
        assert_eq!((track.len(), track.truth.row(0)), (201, &[1000.0, 50.0, 20.0][..]));
        let (mut x, mut p) = ([990.0, 0.0, 0.0], [[30.0, 0.0, 0.0], [0.0, 20.0, 0.0], [0.0, 0.0, 10.0]]);
        let error = |x: &[f64; 3], k: usize| (0..3).map(|i| (x[i] - track.truth.row(k)[i]).powi(2)).sum::<f64>();
        let (mut errors, mut squares, mut s, r) = (error(&x, 0), Vec::new(), 0.0, 2.5);
        let phi = [[1.0, 1.0, 0.5], [0.0, 1.0, 1.0], [0.0, 0.0, 1.0]];
        for k in 1..201 {
            x = std::array::from_fn(|i| (0..3).map(|j| phi[i][j] * x[j]).sum());
            let half: [[f64; 3]; 3] =
                std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|l| phi[i][l] * p[l][j]).sum()));
            p = std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|l| half[i][l] * phi[j][l]).sum()));
            p[2][2] += 0.1;
            s = p[0][0] + r;
            let innovation = track.z.row(k)[0] - x[0];
            squares.push(innovation * innovation);
            let prior = p;
            x = std::array::from_fn(|i| x[i] + prior[i][0] / s * innovation);
            p = std::array::from_fn(|i| std::array::from_fn(|j| prior[i][j] - prior[i][0] * prior[0][j] / s));
            errors += error(&x, k);
        }
        let expected = [
            squares.iter().sum::<f64>() / 200.0,
            (squares[100..].iter().sum::<f64>() / 100.0 / s - 1.0).abs(),
            (errors / 201.0).sqrt(),
        ];
        let both = reference::costs(&problem(Scores::Both), &log, &[r]).unwrap();
        let rmse = reference::costs(&problem(Scores::Rmse), &log, &[r]).unwrap();
        for (found, expected) in both.iter().chain(&rmse).zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-9, "{found}, expected {expected}");
        }
    }

    #[test]
    fn starts_are_in_range_and_differ_by_data_set() {
        let (a, b) = (starts(1, 0, 30), starts(1, 1, 30));
        assert!(a.iter().chain(&b).all(|r| (RANGE[0]..RANGE[1]).contains(r)), "{a:?} {b:?}");
        assert_ne!(a, b);
    }
}
