//! The SVG elements that pictures are made of.

use std::fmt::Write as _;

use super::style::{Colour, Marker, Stroke};
use super::text::{self, FAMILY};

/// A document that is being written. Coordinates are pixels from the upper left corner.
#[derive(Debug)]
pub(super) struct Svg {
    out: String,
}

/// Where a text stands to its point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Anchor {
    Start,
    Middle,
    End,
}

/// How a text looks.
#[derive(Debug, Clone, Copy)]
pub(super) struct Font {
    pub(super) size: f64,
    pub(super) anchor: Anchor,
    pub(super) bold: bool,
    /// Read from below, for the name of a y axis.
    pub(super) upright: bool,
}

impl Font {
    pub(super) const fn new(size: f64, anchor: Anchor) -> Self {
        Self { size, anchor, bold: false, upright: false }
    }
}

// Writing to a String cannot fail.
impl Svg {
    /// An empty white document; `title` is for readers that speak and for tooltips.
    pub(super) fn new(width: f64, height: f64, title: &str) -> Self {
        let mut out = String::new();
        let title = text::escaped(title);
        let _ = write!(
            out,
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width:.0}\" height=\"{height:.0}\" \
             viewBox=\"0 0 {width:.0} {height:.0}\" role=\"img\" font-family=\"{FAMILY}\">\n<title>{title}</title>\n\
             <rect width=\"{width:.0}\" height=\"{height:.0}\" fill=\"#ffffff\"/>\n"
        );
        Self { out }
    }

    pub(super) fn finish(mut self) -> String {
        self.out.push_str("</svg>\n");
        self.out
    }

    /// Opens a part with its own origin that shows nothing farther than `margin` outside of it. An inner svg element
    /// clips by itself, so that no name is needed that could occur twice in a page.
    pub(super) fn open_window(&mut self, [x, y, width, height]: [f64; 4], margin: f64) {
        let (left, top) = (x - margin, y - margin);
        let (width, height) = (width + 2.0 * margin, height + 2.0 * margin);
        let _ = writeln!(
            self.out,
            "<svg x=\"{left:.1}\" y=\"{top:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" overflow=\"hidden\" \
             viewBox=\"{:.1} {:.1} {width:.1} {height:.1}\">",
            -margin, -margin
        );
    }

    pub(super) fn close_window(&mut self) {
        self.out.push_str("</svg>\n");
    }

    /// One text; where it had to be shortened, `full` is its tooltip.
    pub(super) fn text(&mut self, (x, y): (f64, f64), font: Font, shown: &str, full: &str) {
        let anchor = match font.anchor {
            Anchor::Start => "start",
            Anchor::Middle => "middle",
            Anchor::End => "end",
        };
        let size = font.size;
        let _ = write!(self.out, "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"{size}\" text-anchor=\"{anchor}\"");
        if font.bold {
            self.out.push_str(" font-weight=\"bold\"");
        }
        if font.upright {
            let _ = write!(self.out, " transform=\"rotate(-90 {x:.1} {y:.1})\"");
        }
        let _ = write!(self.out, ">{}", text::escaped(shown));
        if shown != full {
            let _ = write!(self.out, "<title>{}</title>", text::escaped(full));
        }
        self.out.push_str("</text>\n");
    }

    /// Lines along a path.
    pub(super) fn stroke(&mut self, path: &str, stroke: Stroke) {
        let (colour, width) = (stroke.colour.hex(), stroke.width);
        let _ = write!(
            self.out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-width=\"{width}\" stroke-linejoin=\"round\""
        );
        if let Some(pattern) = stroke.dash.pattern() {
            let _ = write!(self.out, " stroke-dasharray=\"{pattern}\"");
        }
        self.out.push_str("/>\n");
    }

    /// An area with an optional thin edge.
    pub(super) fn fill(&mut self, path: &str, fill: &str, edge: Option<&str>) {
        let _ = write!(self.out, "<path d=\"{path}\" fill=\"{fill}\"");
        if let Some(edge) = edge {
            let _ = write!(self.out, " stroke=\"{edge}\" stroke-width=\"0.8\"");
        }
        self.out.push_str("/>\n");
    }

    /// One marker at each point.
    pub(super) fn markers(&mut self, points: &[(f64, f64)], marker: Marker, colour: Colour) {
        let mut path = String::with_capacity(20 * points.len());
        for (x, y) in points {
            let _ = write!(path, "M{x:.1} {y:.1}{}", marker.path());
        }
        let hex = colour.hex();
        if marker.is_filled() {
            // A white edge keeps it apart from what lies under it.
            self.fill(&path, hex, Some("#ffffff"));
            return;
        }
        let width = marker.line();
        if marker == Marker::Cross {
            let edge = width + 2.5;
            let _ = writeln!(
                self.out,
                "<path d=\"{path}\" fill=\"none\" stroke=\"#ffffff\" stroke-width=\"{edge}\" stroke-linecap=\"round\"/>"
            );
        }
        let _ = writeln!(
            self.out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"{hex}\" stroke-width=\"{width}\" stroke-linecap=\"round\"/>"
        );
    }
}

/// Path of one rectangle.
pub(super) fn rectangle([x, y, width, height]: [f64; 4]) -> String {
    format!("M{x:.1} {y:.1}h{width:.1}v{height:.1}h{:.1}z", -width)
}

/// Path of one straight line.
pub(super) fn segment((x1, y1): (f64, f64), (x2, y2): (f64, f64)) -> String {
    format!("M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}")
}
