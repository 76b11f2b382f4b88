//! Units of time.

/// `data.time_unit`: what the numbers of a time column are in, and what dt counts.
///
/// Fractions of a second become seconds; any other unit stays, so that dt, rates and the strength of the noise are per
/// minute, day or month. Instants (ISO-8601) are counted in it too, in months and years by the calendar.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TimeUnit {
    /// `s`
    #[default]
    Second,
    /// `ms`, read as seconds
    Millisecond,
    /// `us`, read as seconds
    Microsecond,
    /// `ns`, read as seconds
    Nanosecond,
    /// `min`
    Minute,
    /// `h`
    Hour,
    /// `day`
    Day,
    /// `month`
    Month,
    /// `year`
    Year,
}

impl TimeUnit {
    /// Every unit with the name it has in problem files.
    pub const ALL: [(Self, &'static str); 9] = [
        (Self::Second, "s"),
        (Self::Millisecond, "ms"),
        (Self::Microsecond, "us"),
        (Self::Nanosecond, "ns"),
        (Self::Minute, "min"),
        (Self::Hour, "h"),
        (Self::Day, "day"),
        (Self::Month, "month"),
        (Self::Year, "year"),
    ];

    /// The name in problem files.
    #[must_use]
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(unit, _)| *unit == self).map_or("s", |(_, name)| name)
    }

    /// The unit that dt counts, as reports print it: `s` for fractions of a second.
    #[must_use]
    pub fn counted(self) -> &'static str {
        if self.decimals() > 0 { "s" } else { self.name() }
    }

    /// [`Self::counted`] after a number: `days` unless there is one.
    #[must_use]
    pub fn after(self, count: f64) -> &'static str {
        // As it is printed, to six digits.
        let is_one = (count - 1.0).abs() < 5e-6;
        match self {
            Self::Day if !is_one => "days",
            Self::Month if !is_one => "months",
            Self::Year if !is_one => "years",
            _ => self.counted(),
        }
    }

    /// How many decimal places its numbers are shifted to become seconds.
    #[must_use]
    pub const fn decimals(self) -> i32 {
        match self {
            Self::Millisecond => 3,
            Self::Microsecond => 6,
            Self::Nanosecond => 9,
            _ => 0,
        }
    }

    /// Seconds in what dt counts; `None` for months and years, which have no fixed length.
    #[must_use]
    pub fn seconds(self) -> Option<f64> {
        if self.decimals() > 0 { Some(1.0) } else { self.nanoseconds().map(|length| length * 1e-9) }
    }

    /// The unit in which an epoch of this size lies between 1973 and 5138; `None` for a number too small to be one.
    #[must_use]
    pub fn of_epoch(time: f64) -> Option<Self> {
        match time.abs() {
            t if (1e8..1e11).contains(&t) => Some(Self::Second),
            t if (1e11..1e14).contains(&t) => Some(Self::Millisecond),
            t if (1e14..1e17).contains(&t) => Some(Self::Microsecond),
            t if (1e17..1e20).contains(&t) => Some(Self::Nanosecond),
            _ => None,
        }
    }

    /// Its length in nanoseconds; `None` for months and years, which have no fixed length.
    pub(crate) const fn nanoseconds(self) -> Option<f64> {
        match self {
            Self::Nanosecond => Some(1.0),
            Self::Microsecond => Some(1e3),
            Self::Millisecond => Some(1e6),
            Self::Second => Some(1e9),
            Self::Minute => Some(60e9),
            Self::Hour => Some(3_600e9),
            Self::Day => Some(86_400e9),
            Self::Month | Self::Year => None,
        }
    }
}
