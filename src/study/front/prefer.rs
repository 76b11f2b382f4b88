//! Which members of a front may be recommended: those that can be trusted, and those that gain on the user's own.

use rayon::prelude::*;
use serde::Serialize;

use super::FrontMember;
use super::pick::{Landmarks, knee_of};
use crate::model::Pick;
use crate::optimize::pareto::dominates;
use crate::study::Outcome;

/// The mean NIS of a member over the rows that were tuned on, with the band that 95 % of right filters have it in.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(missing_docs, reason = "the names say it")]
pub struct MeanNis {
    pub mean: f64,
    pub low: f64,
    pub high: f64,
}

impl MeanNis {
    /// Whether it lies in its band.
    #[must_use]
    pub fn is_consistent(&self) -> bool {
        (self.low..=self.high).contains(&self.mean)
    }
}

/// The members among which the knee that is recommended was looked for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Among {
    /// All: none is consistent, and none dominates the baseline.
    All,
    /// None is consistent; those as good as the baseline in every objective and better in one.
    Dominating,
    /// Those whose mean NIS is in its band; none of them dominates the baseline.
    Consistent,
    /// Those that are both.
    ConsistentAndDominating,
}

impl Outcome {
    /// Asks for the mean NIS of every member of the front, in parallel, and recommends a knee that can be trusted: where
    /// `pick` is the knee, that of the members that are consistent and dominate the baseline; without any such, that of
    /// the consistent ones, else that of those that dominate the baseline, else the front's.
    ///
    /// A knee knows costs alone: of a front of `nll` and `rmse` it may be a filter whose NIS is a thousandth of what it
    /// should be.
    pub fn prefer_consistent(&mut self, pick: &Pick, mean_nis: impl Fn(&[f64]) -> Option<MeanNis> + Sync) {
        self.front.par_iter_mut().for_each(|member| member.nis = mean_nis(&member.candidate));
        let Some(landmarks) = self.landmarks.as_mut().filter(|_| *pick == Pick::Knee) else { return };
        let baseline = self.baseline.objectives.as_deref();
        landmarks.prefer(&self.front, baseline);
        let recommended = landmarks.recommended;
        if let (Some(winner), Some(member)) = (&mut self.winner, self.front.get(recommended)) {
            winner.candidate.clone_from(&member.candidate);
            winner.objectives.clone_from(&member.objectives);
            winner.constraints.clone_from(&member.constraints);
            winner.certificate.objectives_f64.clone_from(&member.objectives);
            winner.certificate.objectives_search.clone_from(&member.costs_search);
        }
    }
}

impl Landmarks {
    fn prefer(&mut self, front: &[FrontMember], baseline: Option<&[f64]>) {
        let consistent = |m: &FrontMember| m.nis.is_some_and(|nis| nis.is_consistent());
        let dominating = |m: &FrontMember| baseline.is_some_and(|baseline| dominates(&m.objectives, baseline));
        let classes = [
            (Among::ConsistentAndDominating, true, true),
            (Among::Consistent, true, false),
            (Among::Dominating, false, true),
            (Among::All, false, false),
        ];
        let objectives: Vec<Vec<f64>> = front.iter().map(|m| m.objectives.clone()).collect();
        for (among, is_consistent, dominates) in classes {
            let belongs = |m: &FrontMember| (!is_consistent || consistent(m)) && (!dominates || dominating(m));
            let allowed: Vec<bool> = front.iter().map(belongs).collect();
            if let Some(knee) = knee_of(&objectives, self.has_knee, &allowed) {
                (self.recommended, self.among) = (knee, among);
                return;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn members(of: &[([f64; 2], f64)]) -> Vec<FrontMember> {
        let member = |(objectives, nis): &([f64; 2], f64)| FrontMember {
            candidate: vec![*nis],
            costs_search: objectives.to_vec(),
            objectives: objectives.to_vec(),
            constraints: Vec::new(),
            nis: Some(MeanNis { mean: *nis, low: 0.9, high: 1.1 }),
        };
        of.iter().map(member).collect()
    }

    /// The recommended member and from which class, of a front whose knee is member 2.
    fn preferred(nis: [f64; 5], baseline: Option<[f64; 2]>) -> (usize, Among) {
        let objectives = [[0.0, 10.0], [1.0, 4.0], [2.0, 2.0], [4.0, 1.0], [10.0, 0.0]];
        let front = members(&std::array::from_fn::<_, 5, _>(|i| (objectives[i], nis[i])));
        let rows: Vec<Vec<f64>> = objectives.iter().map(|row| row.to_vec()).collect();
        let mut landmarks = Landmarks::of(&rows, &Pick::Knee).expect("a front");
        assert_eq!((landmarks.knee, landmarks.among), (2, Among::All));
        landmarks.prefer(&front, baseline.as_ref().map(|b| b.as_slice()));
        assert_eq!(landmarks.knee, 2, "what is the knee stays the knee");
        (landmarks.recommended, landmarks.among)
    }

    #[test]
    fn a_consistent_member_that_dominates_comes_first() {
        let far = Some([5.0, 4.5]);
        assert_eq!(preferred([9.0, 1.0, 0.001, 1.0, 1.0], far), (1, Among::ConsistentAndDominating));
        assert_eq!(preferred([9.0, 9.0, 9.0, 9.0, 1.0], far), (4, Among::Consistent));
        assert_eq!(preferred([9.0; 5], far), (2, Among::Dominating));
        assert_eq!(preferred([9.0; 5], Some([5.0, 1.5])), (3, Among::Dominating), "the one that dominates");
        assert_eq!(preferred([9.0; 5], Some([0.5, 0.5])), (2, Among::All));
        assert_eq!(preferred([1.0; 5], None), (2, Among::Consistent), "the baseline fails");
        assert_eq!(preferred([f64::NAN; 5], None), (2, Among::All), "nothing measured");
    }
}
