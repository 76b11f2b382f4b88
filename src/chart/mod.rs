//! Pictures as SVG text.
//!
//! A [`Figure`] is a title and [`Panel`]s under one another or side by side; a panel is two [`Axis`] and the marks
//! between them. What is given may be empty, constant, full of gaps, 1e-12 wide or a million points long: the picture
//! then shows what can be shown. Lines of many points are thinned to the lowest and highest of every pixel.
//!
//! ```
//! use kfgpu::chart::{Axis, Colour, Dash, Figure, Marker, Panel, Stroke};
//!
//! # fn main() -> Result<(), kfgpu::chart::FigureError> {
//! let level = Panel::new(Axis::new("time").unit("s"), Axis::new("level").unit("m"))
//!     .band("3-sigma band", Colour::Blue, [(0.0, [0.5, 1.5]), (1.0, [0.8, 1.4])])
//!     .points("measured", (Marker::Dot, Colour::Grey), [(0.0, 0.9), (1.0, 1.2)])
//!     .line("estimate", Stroke::new(Colour::Black), [(0.0, 1.0), (1.0, 1.1)])
//!     .horizontal("mean", Stroke::dashed(Colour::Red, Dash::Dashed), 1.05);
//! let svg: String = Figure::new("Tank").panel(level).to_svg()?;
//! # assert!(svg.contains("level [m]"));
//! # Ok(())
//! # }
//! ```
//!
//! The pictures are written as SVG by hand: lines need parts of pixels, dashes, clipping and text that is measured
//! before it is placed, which no plotting crate's SVG backend has.

mod axis;
mod contour;
mod dates;
mod envelope;
mod layout;
mod legend;
mod marks;
mod panel;
mod style;
mod svg;
#[cfg(test)]
pub(crate) mod tests;
mod text;
mod thin;
mod ticks;

pub use axis::Axis;
pub use contour::Grid;
pub(crate) use envelope::{Envelope, broken, longest};
pub use panel::Panel;
pub use style::{Colour, Dash, Marker, Stroke};

/// A picture: a title over panels.
#[derive(Debug, Clone, PartialEq)]
pub struct Figure {
    title: String,
    columns: usize,
    width: f64,
    plot_height: f64,
    panels: Vec<Panel>,
}

impl Figure {
    /// A figure 760 px wide without panels, which stand under one another, each 240 px high between its axes.
    #[must_use]
    pub fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), columns: 1, width: 760.0, plot_height: 240.0, panels: Vec::new() }
    }

    /// Panels side by side in so many columns, row by row.
    #[must_use]
    pub const fn columns(mut self, columns: usize) -> Self {
        self.columns = columns;
        self
    }

    /// Width of the whole and height of a panel between its axes \[px\], within 200 to 4000 and 40 to 4000. The figure is
    /// wider where its labels need it, and as high as its panels need.
    #[must_use]
    pub const fn size(mut self, width: f64, plot_height: f64) -> Self {
        self.width = within(width, 200.0);
        self.plot_height = within(plot_height, 40.0);
        self
    }

    /// With one more panel.
    #[must_use]
    pub fn panel(mut self, panel: Panel) -> Self {
        self.panels.push(panel);
        self
    }

    /// With more panels.
    #[must_use]
    pub fn panels(mut self, panels: impl IntoIterator<Item = Panel>) -> Self {
        self.panels.extend(panels);
        self
    }

    /// The SVG document.
    ///
    /// # Errors
    /// If there is no panel, or an axis was given a range that is none.
    pub fn to_svg(&self) -> Result<String, FigureError> {
        layout::draw(self)
    }
}

/// `size` from `least` to 4000; `least` for NaN.
const fn within(size: f64, least: f64) -> f64 {
    if size > 4000.0 {
        4000.0
    } else if size > least {
        size
    } else {
        least
    }
}

/// Why a picture could not be drawn.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum FigureError {
    /// There is nothing to draw in.
    #[error("figure {title:?} has no panel (add one)")]
    NoPanel {
        /// The figure's title.
        title: String,
    },
    /// A range that an axis cannot show.
    #[error(
        "axis {axis:?} cannot run from {low} to {high}: expected finite values that increase{} (mend the range)",
        if *log { ", above 0 on a log axis" } else { "" }
    )]
    Range {
        /// The axis's name.
        axis: String,
        /// Its low end.
        low: f64,
        /// Its high end.
        high: f64,
        /// Whether it is logarithmic.
        log: bool,
    },
}
