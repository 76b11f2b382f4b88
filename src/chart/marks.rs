//! Marks in pixels: how each kind of shape is drawn in its window and in a legend.

use std::fmt::Write as _;

use super::axis::Scale;
use super::panel::{Mark, Shape};
use super::style::{Colour, Marker, Stroke};
use super::svg::{Svg, rectangle, segment};
use super::thin::{self, Pixel};

/// The window of a panel: its scales and size \[px\].
#[derive(Debug, Clone, Copy)]
pub(super) struct Window {
    pub(super) x: Scale,
    pub(super) y: Scale,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Window {
    fn across(&self, x: f64) -> Option<f64> {
        self.x.share(x).map(|share| share * self.width)
    }

    fn down(&self, y: f64) -> Option<f64> {
        self.y.share(y).map(|share| (1.0 - share) * self.height)
    }

    fn at(&self, (x, y): (f64, f64)) -> Pixel {
        Some((self.across(x)?, self.down(y)?))
    }

    /// Draws one mark; says whether anything was there to draw.
    pub(super) fn draw(&self, svg: &mut Svg, shape: &Shape) -> bool {
        match shape {
            Shape::Line { points, stroke } => self.line(svg, points, *stroke),
            Shape::Points { points, marker, colour } => self.points(svg, points, (*marker, *colour)),
            Shape::Band { rows, colour } => self.band(svg, rows, *colour),
            Shape::Bars { bars, colour } => self.bars(svg, bars, *colour),
            Shape::Region { outlines, shade } => self.region(svg, outlines, *shade),
            Shape::Horizontal { y, stroke } => {
                let ends = self.down(*y).map(|y| [(0.0, y), (self.width, y)]);
                straight(svg, ends, *stroke)
            }
            Shape::Vertical { x, stroke } => {
                let ends = self.across(*x).map(|x| [(x, 0.0), (x, self.height)]);
                straight(svg, ends, *stroke)
            }
        }
    }

    fn line(&self, svg: &mut Svg, points: &[(f64, f64)], stroke: Stroke) -> bool {
        let stretches = thin::stretches(points.iter().map(|p| self.at(*p)), self.width);
        let mut path = String::new();
        let mut alone = Vec::new();
        for stretch in &stretches {
            if let [only] = stretch[..] {
                alone.push(only);
            } else {
                trace(&mut path, stretch);
            }
        }
        if !path.is_empty() {
            svg.stroke(&path, stroke);
        }
        // A point between two gaps would be invisible as a line.
        if !alone.is_empty() {
            svg.markers(&alone, Marker::Dot, stroke.colour);
        }
        !stretches.is_empty()
    }

    fn points(&self, svg: &mut Svg, points: &[(f64, f64)], (marker, colour): (Marker, Colour)) -> bool {
        let inside =
            |(x, y): &(f64, f64)| (-0.5..=self.width + 0.5).contains(x) && (-0.5..=self.height + 0.5).contains(y);
        let pixels = points.iter().map(|p| self.at(*p).filter(inside));
        let shown = thin::markers(pixels, if marker == Marker::Dot { 1.5 } else { 3.0 });
        if !shown.is_empty() {
            svg.markers(&shown, marker, colour);
        }
        !shown.is_empty()
    }

    fn band(&self, svg: &mut Svg, rows: &[(f64, [f64; 2])], colour: Colour) -> bool {
        let edges = |row: &(f64, [f64; 2])| Some((self.across(row.0)?, self.down(row.1[0])?, self.down(row.1[1])?));
        let mut path = String::new();
        for stretch in rows.chunk_by(|a, b| edges(a).is_some() == edges(b).is_some()) {
            let edges: Vec<_> = stretch.iter().filter_map(edges).collect();
            let edge = |pick: fn(&(f64, f64, f64)) -> (f64, f64)| {
                thin::stretches(edges.iter().map(|e| Some(pick(e))), self.width).concat()
            };
            let mut outline = edge(|e| (e.0, e.2));
            outline.extend(edge(|e| (e.0, e.1)).into_iter().rev());
            // One row alone is as wide as a line.
            if let [(x, low, high)] = edges[..] {
                outline = vec![(x - 1.5, high), (x + 1.5, high), (x + 1.5, low), (x - 1.5, low)];
            }
            close(&mut path, &outline);
        }
        if !path.is_empty() {
            svg.fill(&path, colour.tint(), None);
        }
        !path.is_empty()
    }

    fn bars(&self, svg: &mut Svg, bars: &[([f64; 2], f64)], colour: Colour) -> bool {
        let foot = self.down(0.0).unwrap_or(self.height);
        let mut path = String::new();
        for ([left, right], height) in bars {
            let edges = self.across(*left).zip(self.across(*right)).zip(self.down(*height));
            if let Some(((left, right), top)) = edges {
                path += &rectangle([left, top.min(foot), right - left, (foot - top).abs()]);
            }
        }
        if !path.is_empty() {
            svg.fill(&path, colour.tint(), Some(colour.hex()));
        }
        !path.is_empty()
    }

    fn region(&self, svg: &mut Svg, outlines: &[Vec<(f64, f64)>], shade: u8) -> bool {
        let mut path = String::new();
        for outline in outlines {
            let pixels: Vec<(f64, f64)> = outline.iter().filter_map(|p| self.at(*p)).collect();
            close(&mut path, &pixels);
        }
        if !path.is_empty() {
            svg.fill(&path, &grey(shade), None);
        }
        !path.is_empty()
    }
}

fn straight(svg: &mut Svg, ends: Option<[(f64, f64); 2]>, stroke: Stroke) -> bool {
    if let Some([from, to]) = ends {
        svg.stroke(&segment(from, to), stroke);
    }
    ends.is_some()
}

fn grey(shade: u8) -> String {
    format!("#{shade:02x}{shade:02x}{shade:02x}")
}

fn trace(path: &mut String, points: &[(f64, f64)]) {
    for (i, (x, y)) in points.iter().enumerate() {
        // Writing to a String cannot fail.
        let _ = write!(path, "{}{x:.1} {y:.1}", if i == 0 { 'M' } else { 'L' });
    }
}

fn close(path: &mut String, points: &[(f64, f64)]) {
    if points.len() > 2 {
        trace(path, points);
        path.push('z');
    }
}

/// Width of a legend's sample \[px\].
pub(super) const SAMPLE: f64 = 26.0;

/// The sample of a mark in a legend, its left end at `x` and its middle at height `y`.
pub(super) fn sample(svg: &mut Svg, mark: &Mark, (x, y): (f64, f64)) {
    let line = segment((x, y), (x + SAMPLE, y));
    let area = rectangle([x, y - 5.0, SAMPLE, 10.0]);
    match &mark.shape {
        Shape::Line { stroke, .. } | Shape::Horizontal { stroke, .. } => svg.stroke(&line, *stroke),
        Shape::Vertical { stroke, .. } => {
            let middle = x + 0.5 * SAMPLE;
            svg.stroke(&segment((middle, y - 8.0), (middle, y + 8.0)), *stroke);
        }
        Shape::Points { marker, colour, .. } => svg.markers(&[(x + 0.5 * SAMPLE, y)], *marker, *colour),
        Shape::Band { colour, .. } => svg.fill(&area, colour.tint(), None),
        Shape::Bars { colour, .. } => svg.fill(&area, colour.tint(), Some(colour.hex())),
        Shape::Region { shade, .. } => svg.fill(&area, &grey(*shade), Some(Colour::Grey.hex())),
    }
}
