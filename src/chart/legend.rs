//! Legends: rows of samples with their names above the panel, so that they never lie on data.

use super::marks::{self, SAMPLE};
use super::panel::{Mark, Panel};
use super::svg::{Anchor, Font, Svg};
use super::text;

const SIZE: f64 = 12.0;
/// Height of a row \[px\].
const ROW: f64 = 19.0;
/// Room between a sample and its name, and between a name and the next sample \[px\].
const SPACES: [f64; 2] = [6.0, 18.0];

/// Entries placed in rows.
#[derive(Debug, Default)]
pub(super) struct Legend<'a> {
    /// Left end, row, name as shown, mark.
    entries: Vec<(f64, usize, String, &'a Mark)>,
}

impl<'a> Legend<'a> {
    /// Of labelled marks, each label once, in rows of `width` \[px\].
    pub(super) fn of(marks: impl IntoIterator<Item = &'a Mark>, width: f64) -> Self {
        let mut entries: Vec<(f64, usize, String, &Mark)> = Vec::new();
        let (mut left, mut row) = (0.0, 0);
        for mark in marks.into_iter().filter(|mark| !mark.label.is_empty()) {
            if entries.iter().any(|(.., before)| before.label == mark.label) {
                continue;
            }
            let name = text::fitted(&mark.label, SIZE, width - SAMPLE - SPACES[0]);
            let length = SAMPLE + SPACES[0] + text::width(&name, SIZE);
            if left > 0.0 && left + length > width {
                (left, row) = (0.0, row + 1);
            }
            entries.push((left, row, name, mark));
            left += length + SPACES[1];
        }
        Self { entries }
    }

    /// One legend for all panels where a label stands in several, and means the same in all of them.
    pub(super) fn shared(panels: &'a [Panel], width: f64) -> Option<Self> {
        let labelled = |panel: &'a Panel| panel.marks.iter().filter(|mark| !mark.label.is_empty());
        let mut repeated = false;
        for (i, panel) in panels.iter().enumerate() {
            for mark in labelled(panel) {
                let before = panels[..i].iter().flat_map(labelled).find(|before| before.label == mark.label);
                let Some(before) = before else { continue };
                repeated = true;
                if before.shape.look() != mark.shape.look() {
                    return None;
                }
            }
        }
        repeated.then(|| Self::of(panels.iter().flat_map(labelled), width))
    }

    pub(super) fn height(&self) -> f64 {
        self.entries.last().map_or(0.0, |(_, row, ..)| ROW * (*row as f64 + 1.0) + 3.0)
    }

    /// Draws it with its upper left corner at (x, y).
    pub(super) fn draw(&self, svg: &mut Svg, (x, y): (f64, f64)) {
        for (left, row, name, mark) in &self.entries {
            let middle = y + ROW * (*row as f64 + 0.5);
            marks::sample(svg, mark, (x + left, middle));
            let at = (x + left + SAMPLE + SPACES[0], middle + 0.36 * SIZE);
            svg.text(at, Font::new(SIZE, Anchor::Start), name, &mark.label);
        }
    }
}
