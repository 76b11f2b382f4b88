//! The standard error of a difference that rows or trajectories add up to.

use statrs::distribution::{ContinuousCDF, StudentsT};

use super::per_row::Influence;

/// Fewest rows that tell anything.
const ROWS: usize = 10;
/// Trajectories from which each counts as one draw, and rows of one may depend on each other as they like.
const TRAJECTORIES: usize = 10;

/// Of the difference of two candidates over the same rows; `None` where these are too few.
///
/// With ten trajectories or more, the sums over whole trajectories are independent draws. Otherwise rows are, but for
/// what neighbours share: the long-run variance of Newey and West (1987, doi:10.2307/1913610) with lags up to 1.3 sqrt(n)
/// and the critical values of a fixed share of lags (Lazarus et al. 2018, doi:10.1080/07350015.2018.1506926; Kiefer and
/// Vogelsang 2005, doi:10.1017/S0266466605050565). Squares of normal errors, which scores are made of, estimate a variance
/// as a quarter as many normal values would, so Student's t with n / 4 degrees of freedom widens it. What comes back is
/// scaled so that 1.96 of it are a 95 % interval.
pub(super) fn paired(baseline: Influence, winner: &Influence) -> Option<f64> {
    let apart = |a: Vec<f64>, b: &[f64]| a.into_iter().zip(b).map(|(a, b)| a - b).collect::<Vec<f64>>();
    if baseline.rows.len() >= TRAJECTORIES {
        let sums = |influence: &Influence| match &influence.trajectories {
            Some(shares) => shares.clone(),
            None => influence.rows.iter().map(|rows| rows.iter().sum()).collect(),
        };
        return Some(clustered(&apart(sums(&baseline), &sums(winner))));
    }
    let rows: Vec<Vec<f64>> = baseline.rows.into_iter().zip(&winner.rows).map(|(a, b)| apart(a, b)).collect();
    let n: usize = rows.iter().map(Vec::len).sum();
    (n >= ROWS).then(|| long_run(&rows, n as f64))
}

/// Of a sum of independent shares, one a trajectory.
fn clustered(shares: &[f64]) -> f64 {
    let n = shares.len() as f64;
    let mean = shares.iter().sum::<f64>() / n;
    let squares: f64 = shares.iter().map(|share| (share - mean).powi(2)).sum();
    (squares * n / (n - 1.0)).sqrt() * widening(n - 1.0)
}

/// Of a sum over `n` rows in order, several series of them.
fn long_run(series: &[Vec<f64>], n: f64) -> f64 {
    let each = n / series.len() as f64;
    let lags = (1.3 * each.sqrt()).ceil();
    let covariance = |lag: usize| -> f64 {
        series.iter().map(|s| s.iter().zip(s.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>()).sum()
    };
    let mut variance = covariance(0);
    for lag in (1..).take_while(|lag| f64::from(*lag) <= lags) {
        variance += 2.0 * (1.0 - f64::from(lag) / (lags + 1.0)) * covariance(lag as usize);
    }
    // The weights of Bartlett keep it from being negative.
    let share = (lags + 1.0) / n;
    let critical = 1.96 + 2.9694 * share + 0.4160 * share.powi(2) - 0.5324 * share.powi(3);
    variance.max(0.0).sqrt() * critical / 1.96 * widening(n / 4.0)
}

/// How much wider an interval of Student's t is than a normal one.
fn widening(degrees: f64) -> f64 {
    StudentsT::new(0.0, 1.0, degrees).map_or(f64::NAN, |t| t.inverse_cdf(0.975) / 1.96)
}
