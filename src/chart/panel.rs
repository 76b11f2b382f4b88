//! One pair of axes and what is drawn between them.

use super::axis::Axis;
use super::style::{Colour, Marker, Stroke};

/// A pair of axes with marks, drawn in the order in which they were added.
///
/// Every mark takes a label for the legend; an empty one leaves it out. Values that are not finite, not positive on a
/// log axis, or beyond 1e300 are gaps.
#[derive(Debug, Clone, PartialEq)]
pub struct Panel {
    pub(super) title: String,
    pub(super) x: Axis,
    pub(super) y: Axis,
    pub(super) marks: Vec<Mark>,
    /// Whether a unit is as long along x as along y.
    pub(super) equal: bool,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) struct Mark {
    pub(super) label: String,
    pub(super) shape: Shape,
}

#[derive(Debug, Clone, PartialEq)]
pub(super) enum Shape {
    Line {
        points: Vec<(f64, f64)>,
        stroke: Stroke,
    },
    Points {
        points: Vec<(f64, f64)>,
        marker: Marker,
        colour: Colour,
    },
    /// x, and the lower and upper edge there.
    Band {
        rows: Vec<(f64, [f64; 2])>,
        colour: Colour,
    },
    /// Left and right edge, height.
    Bars {
        bars: Vec<([f64; 2], f64)>,
        colour: Colour,
    },
    /// Closed curves as one area, in a grey of 0 (black) to 255.
    Region {
        outlines: Vec<Vec<(f64, f64)>>,
        shade: u8,
    },
    Horizontal {
        y: f64,
        stroke: Stroke,
    },
    Vertical {
        x: f64,
        stroke: Stroke,
    },
}

impl Panel {
    /// An empty panel.
    #[must_use]
    pub const fn new(x: Axis, y: Axis) -> Self {
        Self { title: String::new(), x, y, marks: Vec::new(), equal: false }
    }

    /// One scale for both axes, as of a map: the one with room to spare shows more. Log axes stay as they are.
    #[must_use]
    pub const fn equal(mut self) -> Self {
        self.equal = true;
        self
    }

    /// With a title of its own.
    #[must_use]
    pub fn title(mut self, title: impl Into<String>) -> Self {
        self.title = title.into();
        self
    }

    /// Straight lines from point to point, broken at gaps.
    #[must_use]
    pub fn line(self, label: &str, stroke: Stroke, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        self.mark(label, Shape::Line { points: points.into_iter().collect(), stroke })
    }

    /// A line that keeps each value until the next point.
    #[must_use]
    pub fn steps(self, label: &str, stroke: Stroke, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let mut corners = Vec::new();
        for (x, y) in points {
            corners.extend(corners.last().map(|&(_, before)| (x, before)));
            corners.push((x, y));
        }
        self.mark(label, Shape::Line { points: corners, stroke })
    }

    /// One marker a point.
    #[must_use]
    pub fn points(
        self,
        label: &str,
        (marker, colour): (Marker, Colour),
        points: impl IntoIterator<Item = (f64, f64)>,
    ) -> Self {
        self.mark(label, Shape::Points { points: points.into_iter().collect(), marker, colour })
    }

    /// The area between two curves: rows of x and (lower, upper), broken at gaps.
    #[must_use]
    pub fn band(self, label: &str, colour: Colour, rows: impl IntoIterator<Item = (f64, [f64; 2])>) -> Self {
        self.mark(label, Shape::Band { rows: rows.into_iter().collect(), colour })
    }

    /// Bars from 0: (left, right) and height.
    #[must_use]
    pub fn bars(mut self, label: &str, colour: Colour, bars: impl IntoIterator<Item = ([f64; 2], f64)>) -> Self {
        self.y = self.y.including(0.0);
        self.mark(label, Shape::Bars { bars: bars.into_iter().collect(), colour })
    }

    /// The area inside closed curves, in a grey of 0 (black) to 255 (white).
    #[must_use]
    pub fn region(self, label: &str, shade: u8, outlines: Vec<Vec<(f64, f64)>>) -> Self {
        self.mark(label, Shape::Region { outlines, shade })
    }

    /// A horizontal reference line through the whole panel.
    #[must_use]
    pub fn horizontal(self, label: &str, stroke: Stroke, y: f64) -> Self {
        self.mark(label, Shape::Horizontal { y, stroke })
    }

    /// A vertical reference line through the whole panel.
    #[must_use]
    pub fn vertical(self, label: &str, stroke: Stroke, x: f64) -> Self {
        self.mark(label, Shape::Vertical { x, stroke })
    }

    fn mark(mut self, label: &str, shape: Shape) -> Self {
        self.marks.push(Mark { label: label.to_owned(), shape });
        self
    }

    /// Every x value that is to be seen.
    pub(super) fn xs(&self) -> impl Iterator<Item = f64> {
        self.marks.iter().flat_map(|mark| mark.shape.xs())
    }

    /// Every y value that is to be seen.
    pub(super) fn ys(&self) -> impl Iterator<Item = f64> {
        self.marks.iter().flat_map(|mark| mark.shape.ys())
    }
}

impl Shape {
    /// How it looks: itself without its data.
    pub(super) const fn look(&self) -> Self {
        match self {
            Self::Line { stroke, .. } => Self::Line { points: Vec::new(), stroke: *stroke },
            Self::Points { marker, colour, .. } => {
                Self::Points { points: Vec::new(), marker: *marker, colour: *colour }
            }
            Self::Band { colour, .. } => Self::Band { rows: Vec::new(), colour: *colour },
            Self::Bars { colour, .. } => Self::Bars { bars: Vec::new(), colour: *colour },
            Self::Region { shade, .. } => Self::Region { outlines: Vec::new(), shade: *shade },
            Self::Horizontal { stroke, .. } => Self::Horizontal { y: 0.0, stroke: *stroke },
            Self::Vertical { stroke, .. } => Self::Vertical { x: 0.0, stroke: *stroke },
        }
    }

    fn xs(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        match self {
            Self::Line { points, .. } | Self::Points { points, .. } => Box::new(points.iter().map(|p| p.0)),
            Self::Band { rows, .. } => Box::new(rows.iter().map(|row| row.0)),
            Self::Bars { bars, .. } => Box::new(bars.iter().flat_map(|bar| bar.0)),
            Self::Region { outlines, .. } => Box::new(outlines.iter().flatten().map(|p| p.0)),
            Self::Horizontal { .. } => Box::new(std::iter::empty()),
            Self::Vertical { x, .. } => Box::new(std::iter::once(*x)),
        }
    }

    fn ys(&self) -> Box<dyn Iterator<Item = f64> + '_> {
        match self {
            Self::Line { points, .. } | Self::Points { points, .. } => Box::new(points.iter().map(|p| p.1)),
            Self::Band { rows, .. } => Box::new(rows.iter().flat_map(|row| row.1)),
            Self::Bars { bars, .. } => Box::new(bars.iter().map(|bar| bar.1)),
            Self::Region { outlines, .. } => Box::new(outlines.iter().flatten().map(|p| p.1)),
            Self::Horizontal { y, .. } => Box::new(std::iter::once(*y)),
            Self::Vertical { .. } => Box::new(std::iter::empty()),
        }
    }
}
