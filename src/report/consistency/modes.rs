//! What a filter of several models made of each.

use serde::Serialize;

/// One model over a run.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ModeUse {
    /// Its name.
    pub mode: String,
    /// Mean of its probability over the rows.
    pub share: f64,
    /// The largest of its probabilities.
    pub most: f64,
    /// Rows in which no other is more likely.
    pub rows: usize,
    #[serde(skip)]
    seen: usize,
}

impl ModeUse {
    /// Before any row.
    pub(super) fn none(mode: &str) -> Self {
        Self { mode: mode.to_owned(), share: 0.0, most: 0.0, rows: 0, seen: 0 }
    }

    /// The next row, with the probabilities of all modes after it.
    pub(super) fn add(modes: &mut [Self], probabilities: &[f64]) {
        let most = probabilities.iter().copied().fold(0.0, f64::max);
        for (mode, probability) in modes.iter_mut().zip(probabilities) {
            mode.seen += 1;
            mode.share += (probability - mode.share) / mode.seen as f64;
            mode.most = mode.most.max(*probability);
            mode.rows += usize::from(*probability >= most);
        }
    }
}

/// How much of the time each was, and which never.
pub(super) fn sentences(modes: &[ModeUse]) -> impl Iterator<Item = (&'static str, String)> {
    let per_cent = |share: f64| format!("{:.1} %", 100.0 * share);
    let shares: Vec<String> = modes.iter().map(|mode| format!("{} {}", mode.mode, per_cent(mode.share))).collect();
    let shares = (!modes.is_empty()).then(|| ("modes", format!("{} of the time", shares.join(", "))));
    let never = modes.iter().filter(|mode| mode.seen > 0 && mode.rows == 0);
    let never = never.map(move |mode| {
        let most = per_cent(mode.most);
        let sentence = format!(
            "mode {} is never used: another is more likely in every row (it has at most {most}), so the log does not need it",
            mode.mode
        );
        ("unused", sentence)
    });
    shares.into_iter().chain(never)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mode_that_is_never_the_most_likely_is_said_to_be_unused() {
        let mut modes = ["calm", "wild"].map(ModeUse::none);
        ModeUse::add(&mut modes, &[0.75, 0.25]);
        ModeUse::add(&mut modes, &[0.95, 0.05]);
        let found: Vec<String> = sentences(&modes).map(|(_, sentence)| sentence).collect();
        assert_eq!(found[0], "calm 85.0 %, wild 15.0 % of the time");
        assert!(found[1].starts_with("mode wild is never used: ") && found[1].contains("at most 25.0 %"), "{found:?}");
        assert_eq!(sentences(&[]).count(), 0, "one model is nothing to speak of");
    }
}
