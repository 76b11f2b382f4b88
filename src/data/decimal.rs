//! Decimal numbers, exactly: differences of times whose digits no double holds.

use std::cmp::Ordering;
use std::fmt;

/// `digits` x 10^`exponent`.
#[derive(Debug, Clone, Copy)]
pub(super) struct Decimal {
    digits: i128,
    exponent: i32,
}

impl Decimal {
    /// Reads what [`f64`] would; `None` where it is no finite number, or one of more digits than fit.
    pub(super) fn parse(text: &str) -> Option<Self> {
        let (mantissa, exponent) = match text.find(['e', 'E']) {
            Some(at) => (&text[..at], text[at + 1..].parse::<i32>().ok()?),
            None => (text, 0),
        };
        let (negative, mantissa) = match mantissa.strip_prefix('-') {
            Some(rest) => (true, rest),
            None => (false, mantissa.strip_prefix('+').unwrap_or(mantissa)),
        };
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        if whole.is_empty() && fraction.is_empty() {
            return None;
        }
        let mut digits: i128 = 0;
        for c in whole.bytes().chain(fraction.bytes()) {
            let digit = c.is_ascii_digit().then(|| i128::from(c - b'0'))?;
            digits = digits.checked_mul(10)?.checked_add(digit)?;
        }
        let exponent = exponent.checked_sub(i32::try_from(fraction.len()).ok()?)?;
        let value = Self { digits: if negative { -digits } else { digits }, exponent };
        Some(value.reduced())
    }

    /// The shortest decimal that reads back as `value`.
    pub(super) fn shortest(value: f64) -> Option<Self> {
        Self::parse(&format!("{value:e}"))
    }

    /// Times 10^`places`.
    pub(super) const fn shifted(self, places: i32) -> Self {
        Self { digits: self.digits, exponent: self.exponent.saturating_add(places) }
    }

    /// `None` where the sum has more digits than fit.
    pub(super) fn plus(self, other: Self) -> Option<Self> {
        let exponent = self.exponent.min(other.exponent);
        let sum = self.at(exponent)?.checked_add(other.at(exponent)?)?;
        Some(Self { digits: sum, exponent }.reduced())
    }

    /// `None` where the difference has more digits than fit.
    pub(super) fn minus(self, other: Self) -> Option<Self> {
        self.plus(Self { digits: other.digits.checked_neg()?, exponent: other.exponent })
    }

    /// The nearest double.
    pub(super) fn to_f64(self) -> f64 {
        format!("{}e{}", self.digits, self.exponent).parse().unwrap_or(f64::NAN)
    }

    /// Whether a double was printed to give this: `value` is what the digits read as, and they are its shortest text, or
    /// its digits up to as many decimals as were written.
    pub(super) fn is_print_of(self, value: f64) -> bool {
        let decimals = usize::try_from(-self.exponent).unwrap_or(0);
        Self::shortest(value) == Some(self) || Self::parse(&format!("{value:.decimals$}")) == Some(self)
    }

    /// Digits when written with this lower exponent.
    fn at(self, exponent: i32) -> Option<i128> {
        let places = u32::try_from(self.exponent.checked_sub(exponent)?).ok()?;
        if self.digits == 0 { Some(0) } else { self.digits.checked_mul(10_i128.checked_pow(places)?) }
    }

    /// Without zeros at the end.
    const fn reduced(mut self) -> Self {
        if self.digits == 0 {
            return Self { digits: 0, exponent: 0 };
        }
        while self.digits % 10 == 0 {
            self.digits /= 10;
            self.exponent += 1;
        }
        self
    }
}

impl PartialEq for Decimal {
    fn eq(&self, other: &Self) -> bool {
        let (a, b) = (self.reduced(), other.reduced());
        a.digits.cmp(&b.digits) == Ordering::Equal && a.exponent == b.exponent
    }
}

/// Plain digits, with an exponent where they would be many zeros.
impl fmt::Display for Decimal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { digits, exponent } = self.reduced();
        let (sign, text) = (if digits < 0 { "-" } else { "" }, digits.unsigned_abs().to_string());
        let point = i32::try_from(text.len()).unwrap_or(i32::MAX).saturating_add(exponent);
        match usize::try_from(point) {
            _ if !(-6..=22).contains(&point) => write!(f, "{digits}e{exponent}"),
            Ok(point) if point >= text.len() => write!(f, "{sign}{text}{}", "0".repeat(point - text.len())),
            Ok(0) | Err(_) => write!(f, "{sign}0.{}{text}", "0".repeat(point.unsigned_abs() as usize)),
            Ok(point) => write!(f, "{sign}{}.{}", &text[..point], &text[point..]),
        }
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::float_cmp, reason = "the same bits are meant")]
    use super::*;

    #[test]
    fn differences_are_exact() {
        let of = |text| Decimal::parse(text).unwrap();
        for (a, b, difference) in [
            ("1700000000.123456789", "1700000000.123456788", 1e-9),
            ("1477010443399397000", "1477010443399396999", 1.0),
            ("0.3", "0.1", 0.2),
            ("1e3", "-2.5E-1", 1000.25),
            (".5", "1.", -0.5),
        ] {
            assert_eq!(of(a).minus(of(b)).unwrap().to_f64(), difference, "{a} - {b}");
        }
        assert!(Decimal::parse("1e400").is_some() && of("1e400").minus(of("1e-400")).is_none());
        for text in ["", ".", "e5", "1e", "0x1", "nan", "inf", "1_0", "--1"] {
            assert!(Decimal::parse(text).is_none(), "{text}");
        }
    }

    #[test]
    fn texts_read_back() {
        for text in ["0", "-12.5", "1700000000.123456789", "0.00012", "1200", "1477010443399397", "-0.5"] {
            assert_eq!(Decimal::parse(text).unwrap().to_string(), text);
        }
        assert_eq!(Decimal::parse("1.50").unwrap().to_string(), "1.5");
        assert_eq!(Decimal::parse("1e300").unwrap().to_string(), "1e300");
    }

    #[test]
    fn prints_of_doubles_are_known() {
        let printed = |text: &str| Decimal::parse(text).unwrap().is_print_of(text.parse().unwrap());
        assert!(printed("1700000000.1") && printed("0.30000000000000004"));
        // 1700000000.1 with nine decimals.
        assert!(printed("1700000000.099999905"));
        assert!(!printed("1700000000.123456789") && !printed("1700000000.100000000123"));
    }
}
