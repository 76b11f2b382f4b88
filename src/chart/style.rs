//! Colours, strokes and markers that survive grey print: neighbours differ in lightness, and lines also in dashes.

/// The few colours of every picture, from dark to light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Colour {
    Black,
    Blue,
    Red,
    Steel,
    Grey,
    Amber,
    Pale,
}

impl Colour {
    /// As SVG writes it. Lightness L* of CIELAB: 0, 34, 50, 52, 62, 75, 88.
    pub(super) const fn hex(self) -> &'static str {
        match self {
            Self::Black => "#000000",
            Self::Blue => "#1b4f9c",
            Self::Red => "#cc4125",
            Self::Steel => "#6a7d93",
            Self::Grey => "#969696",
            Self::Amber => "#eeac2e",
            Self::Pale => "#dcdcdc",
        }
    }

    /// A light tint of the same hue, for the area of a band.
    pub(super) const fn tint(self) -> &'static str {
        match self {
            Self::Black => "#cfcfcf",
            Self::Blue => "#c4d6f0",
            Self::Red => "#f6d3c9",
            Self::Steel => "#a9b8c9",
            Self::Grey => "#e0e0e0",
            Self::Amber => "#fbe8bf",
            Self::Pale => "#f0f0f0",
        }
    }
}

/// Dashes of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[expect(missing_docs, reason = "the names say it")]
pub enum Dash {
    Solid,
    Dashed,
    Dotted,
    DashDot,
}

impl Dash {
    /// As `stroke-dasharray`; nothing for a solid line.
    pub(super) const fn pattern(self) -> Option<&'static str> {
        match self {
            Self::Solid => None,
            Self::Dashed => Some("7 4"),
            Self::Dotted => Some("1.5 3.5"),
            Self::DashDot => Some("9 3.5 2 3.5"),
        }
    }
}

/// How a line looks.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// Colour.
    pub colour: Colour,
    /// Width \[px\].
    pub width: f64,
    /// Dashes.
    pub dash: Dash,
}

impl Stroke {
    /// A solid line of 1.6 px.
    #[must_use]
    pub const fn new(colour: Colour) -> Self {
        Self { colour, width: 1.6, dash: Dash::Solid }
    }

    /// A line of 1.2 px with dashes, as reference lines have.
    #[must_use]
    pub const fn dashed(colour: Colour, dash: Dash) -> Self {
        Self { colour, width: 1.2, dash }
    }

    /// The same line in another width \[px\].
    #[must_use]
    pub const fn width(mut self, width: f64) -> Self {
        self.width = width;
        self
    }

    /// Six strokes that stay apart in grey print, for the series of one panel; they repeat after that.
    #[must_use]
    pub const fn of_series(i: usize) -> Self {
        let (colour, dash) = match i % 6 {
            0 => (Colour::Black, Dash::Solid),
            1 => (Colour::Red, Dash::Dashed),
            2 => (Colour::Blue, Dash::DashDot),
            3 => (Colour::Amber, Dash::Solid),
            4 => (Colour::Grey, Dash::Dashed),
            _ => (Colour::Blue, Dash::Dotted),
        };
        Self { colour, width: 1.8, dash }
    }
}

/// The form of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Marker {
    /// Filled circle, 4 px, for many points.
    Dot,
    /// Filled circle, 2 px, for what stands beside an area.
    Speck,
    /// Filled circle, 8 px.
    Disc,
    /// Open circle.
    Circle,
    /// Large open circle, around another marker.
    Ring,
    /// x, with a white edge.
    Cross,
    /// +.
    Plus,
    /// Open square.
    Square,
    /// Filled triangle, point up.
    Triangle,
    /// Filled diamond.
    Diamond,
}

impl Marker {
    /// Whether it is an area, not lines.
    pub(super) const fn is_filled(self) -> bool {
        matches!(self, Self::Triangle | Self::Diamond)
    }

    /// Width of its lines \[px\]; a point without extent under a round cap is a disc of this diameter.
    pub(super) const fn line(self) -> f64 {
        match self {
            Self::Dot => 4.0,
            Self::Speck => 2.0,
            Self::Disc => 8.0,
            Self::Circle | Self::Square => 1.5,
            Self::Cross | Self::Plus | Self::Ring => 2.0,
            Self::Triangle | Self::Diamond => 0.0,
        }
    }

    /// The rest of its path after moving to the centre.
    pub(super) const fn path(self) -> &'static str {
        match self {
            Self::Dot | Self::Speck | Self::Disc => "h0",
            Self::Circle => "m-3.6 0a3.6 3.6 0 1 0 7.2 0a3.6 3.6 0 1 0-7.2 0",
            Self::Ring => "m-8 0a8 8 0 1 0 16 0a8 8 0 1 0-16 0",
            Self::Cross => "m-5-5l10 10m0-10l-10 10",
            Self::Plus => "m-5 0h10m-5-5v10",
            Self::Square => "m-3.6-3.6h7.2v7.2h-7.2z",
            Self::Triangle => "m0-6l5.4 9.4h-10.8z",
            Self::Diamond => "m0-6l5 6l-5 6l-5-6z",
        }
    }
}
