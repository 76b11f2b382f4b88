//! What the study must reach. The numbers were set from an independent program before this one ran.

use super::super::protocol::Protocol as _;
use super::super::statistics::{count, mean, median};
use super::super::{Required, Target};
use super::search::Found;
use super::{Bench, DataSet, Results, Run, rmse};

/// RMSE closer than this is equal, when the smallest of five is sought.
const TIE: f64 = 1e-4;

/// An answer whose RMSE is this close to that of an end of the front stands there.
const AT_END: f64 = 0.005;

/// Standard deviation over data sets of Regular's mean, of the f1-end's RMSE, and of the ratio of the ends.
const SPREADS: [f64; 3] = [0.19, 0.058, 0.005];

impl DataSet {
    /// Runs in which MOMA beats all three filters that are not tuned.
    pub(super) fn beats_untuned(&self, profile: usize) -> f64 {
        let moma = rmse(&self.tuned[profile].moma);
        let others = |j: usize| self.regular[j].min(self.sage_husa[j]).min(self.fuzzy[j]);
        moma.iter().enumerate().filter(|(j, moma)| **moma < others(*j)).count() as f64
    }

    /// Runs in which MOMA's RMSE is the smallest of the five, ties included.
    pub(super) fn smallest_of_five(&self, profile: usize) -> f64 {
        let nsga = rmse(&self.tuned[profile].nsga);
        let moma = rmse(&self.tuned[profile].moma);
        let others = |j: usize| self.regular[j].min(self.sage_husa[j]).min(self.fuzzy[j]).min(nsga[j]);
        moma.iter().enumerate().filter(|(j, moma)| **moma <= others(*j) + TIE).count() as f64
    }

    /// Share of MOMA's answers that stand at an end of the front, and at the f1-end.
    pub(super) fn at_ends(&self, profile: usize) -> [f64; 2] {
        let moma = rmse(&self.tuned[profile].moma);
        let [f1, f2] = self.ends.map(|(_, rmse)| rmse);
        let near = |end: f64| move |x: f64| (x - end).abs() <= AT_END;
        let share = |test: &dyn Fn(f64) -> bool| count(&moma, test) / moma.len() as f64;
        [share(&|x| near(f1)(x) || near(f2)(x)), share(&near(f1))]
    }

    /// Mean RMSE of NSGA-II's runs minus that of MOMA's.
    pub(super) fn lead(&self, profile: usize) -> f64 {
        mean(&rmse(&self.tuned[profile].nsga)) - mean(&rmse(&self.tuned[profile].moma))
    }
}

/// The number that all runs share; NaN if they differ.
fn same(runs: &[&Run], of: &dyn Fn(&Found) -> u64) -> f64 {
    let mut all: Vec<u64> = runs.iter().map(|run| of(&run.found)).collect();
    all.sort_unstable();
    all.dedup();
    if let [one] = all[..] { one as f64 } else { f64::NAN }
}

/// Places of the gated profiles in the plan.
const PAPER_LIKE: usize = 0;
const STANDARD: usize = 1;

impl Results {
    pub(super) fn targets(&self) -> Vec<Target> {
        let mut targets = self.exact_targets();
        targets.push(self.untuned_target());
        targets.extend(self.level_targets());
        targets.extend(self.end_targets());
        targets.extend(self.paper_like_targets());
        targets.extend(self.standard_targets());
        targets.extend(self.convergence_targets());
        targets
    }

    /// What a smaller sample adds to two standard errors of a mean with this spread.
    fn growth(&self, spread: f64) -> f64 {
        let error = |sets: u64| 2.0 * spread / (sets as f64).sqrt();
        (error(self.plan.data_sets) - error(Bench::FULL.data_sets)).max(0.0)
    }

    fn exact_targets(&self) -> Vec<Target> {
        let tuned = || self.data_sets.iter().flat_map(|set| &set.tuned);
        let nsga: Vec<&Run> = tuned().flat_map(|tuned| &tuned.nsga).collect();
        let moma: Vec<&Run> = tuned().flat_map(|tuned| &tuned.moma).collect();
        let generations = |found: &Found| found.generations as u64;
        vec![
            Target::new("evaluations of NSGA-II", Required::Exactly(500), same(&nsga, &|f| f.evaluations)),
            Target::new("evaluations of MOMA", Required::Exactly(500), same(&moma, &|f| f.evaluations)),
            Target::new("generations of NSGA-II", Required::Exactly(24), same(&nsga, &generations)),
            Target::new("generations of MOMA", Required::Exactly(20), same(&moma, &generations)),
            Target::new(
                "random fronts with the ranks and crowding distances of their definitions",
                Required::Exactly(self.plan.fronts),
                self.beside as f64,
            ),
        ]
    }

    fn untuned_target(&self) -> Target {
        let wins: f64 = self.each(|set| set.beats_untuned(PAPER_LIKE)).iter().sum();
        let runs = self.plan.runs as f64 * self.data_sets.len() as f64;
        // The pooled standard error of 20 data sets is 0.9 %.
        let required = Required::AtLeast(92.0).widened(self.growth(4.0));
        let name = format!("per cent of {runs} runs in which MOMA beats Regular, Sage-Husa and Fuzzy together");
        Target::new(name, required, 100.0 * wins / runs)
    }

    fn level_targets(&self) -> Vec<Target> {
        let n = self.data_sets.len();
        let [regular, end, ratio] = SPREADS.map(|spread| self.growth(spread));
        vec![
            Target::new(
                format!("mean RMSE of Regular over {n} data sets"),
                Required::Within(6.25, 6.50).widened(regular),
                mean(&self.each(|set| mean(&set.regular))),
            ),
            Target::new(
                format!("mean RMSE at the f1-end over {n} data sets"),
                Required::Within(5.15, 5.27).widened(end),
                mean(&self.each(|set| set.ends[0].1)),
            ),
            Target::new(
                "median RMSE ratio of f2-end to f1-end",
                Required::Within(1.005, 1.020).widened(ratio),
                median(&self.each(|set| set.ends[1].1 / set.ends[0].1)),
            ),
        ]
    }

    fn end_targets(&self) -> Vec<Target> {
        let shares = |profile| self.each(|set| set.at_ends(profile)[0]);
        let paper_like = shares(PAPER_LIKE);
        let least = paper_like.iter().copied().fold(f64::INFINITY, f64::min);
        vec![
            Target::new(
                "paper-like: mean share of first individuals at an end",
                Required::AtLeast(0.80),
                mean(&paper_like),
            ),
            Target::new("paper-like: least such share of a data set", Required::AtLeast(0.55), least),
            Target::new(
                "standard: mean share of first individuals at an end",
                Required::AtLeast(0.98),
                mean(&shares(STANDARD)),
            ),
        ]
    }

    fn paper_like_targets(&self) -> Vec<Target> {
        let leads = self.each(|set| set.lead(PAPER_LIKE));
        let smallest = self.each(|set| set.smallest_of_five(PAPER_LIKE));
        let least = smallest.iter().copied().fold(f64::INFINITY, f64::min);
        let name = format!("paper-like: data sets of {} with mean(NSGA-II) >= mean(MOMA)", leads.len());
        vec![
            Target::new(name, self.agreeing(17), count(&leads, |lead| lead >= 0.0)),
            Target::new("paper-like: least smallest-of-five wins of MOMA in 30 runs", Required::AtLeast(12.0), least),
            Target::new(
                "paper-like: median smallest-of-five wins of MOMA in 30 runs",
                Required::Within(19.0, 26.0).widened(self.growth(2.5)),
                median(&smallest),
            ),
        ]
    }

    fn standard_targets(&self) -> Vec<Target> {
        let leads = self.each(|set| set.lead(STANDARD));
        let smallest = median(&self.each(|set| set.smallest_of_five(STANDARD)));
        let required = Required::Within(13.0, 20.0).widened(self.growth(2.5));
        let name = "standard: median smallest-of-five wins of MOMA in 30 runs";
        let mut targets = vec![Target::new(name, required, smallest)];
        if self.is_full() {
            let name = format!("standard: data sets of {} with mean(NSGA-II) >= mean(MOMA)", leads.len());
            targets.push(Target::new(name, Required::Within(4.0, 16.0), count(&leads, |lead| lead >= 0.0)));
        }
        targets
    }

    fn convergence_targets(&self) -> Vec<Target> {
        let settled = |which: usize| self.each(|set| set.paths[which].settled_at() as f64);
        let n = self.data_sets.len();
        vec![
            Target::new(
                format!("data sets of {n} where the f1-end's error stays < 10 from k <= 3"),
                self.agreeing(18),
                count(&settled(0), |k| k <= 3.0),
            ),
            Target::new(
                format!("data sets of {n} where the error with R = 43 stays < 10 from k >= 7 only"),
                self.agreeing(18),
                count(&settled(1), |k| k >= 7.0),
            ),
        ]
    }
}
