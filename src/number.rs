//! Numbers as text.

/// `value` with `digits` significant digits, as a person writes it: plain from 1e-4 to 1e7, and beyond that as long as
/// every digit before the point is one of them; else with an exponent.
#[must_use]
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return value.to_string();
    }
    if value.abs() <= 0.0 {
        return "0".to_owned();
    }
    let scientific = format!("{value:.*e}", digits.saturating_sub(1));
    // The exponent after rounding: 9.9999 with three digits is 1.00e1.
    let exponent: i32 = scientific.split_once('e').and_then(|(_, e)| e.parse().ok()).unwrap_or(0);
    let longest = i32::try_from(digits.min(16)).unwrap_or(16).max(7);
    if !(-4..longest).contains(&exponent) {
        return scientific;
    }
    let decimals = usize::try_from(i32::try_from(digits).unwrap_or(i32::MAX) - 1 - exponent).unwrap_or(0);
    format!("{value:.decimals$}")
}

/// As [`significant`], without zeros at the end: for values a person typed.
#[must_use]
pub fn short(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (mantissa, exponent) = text.find('e').map_or((&*text, ""), |at| text.split_at(at));
    if !mantissa.contains('.') {
        return text;
    }
    format!("{}{exponent}", mantissa.trim_end_matches('0').trim_end_matches('.'))
}

/// The shortest text that reads back as the same bits, for CSV.
#[must_use]
pub fn exact(value: f64) -> String {
    let size = value.abs();
    if size > 0.0 && !(1e-5..1e16).contains(&size) { format!("{value:e}") } else { format!("{value}") }
}

/// A time for people \[s\].
#[must_use]
pub fn seconds(value: f64) -> String {
    match value {
        v if v < 1.0 => format!("{} ms", significant(v * 1e3, 3)),
        v if v < 120.0 => format!("{v:.1} s"),
        v => format!("{:.0} min {:.0} s", (v / 60.0).floor(), v % 60.0),
    }
}

/// A count with thousands separated: `1 250 000`.
#[must_use]
pub fn count(value: u64) -> String {
    let digits = value.to_string();
    let mut text = String::with_capacity(digits.len() + digits.len() / 3);
    for (i, digit) in digits.char_indices() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            text.push(' ');
        }
        text.push(digit);
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits() {
        let cases = [
            (15_099.686_9, 6, "15099.7"),
            (0.008_123_4, 3, "0.00812"),
            (9.9999, 3, "10.0"),
            (1.0e7, 3, "1.00e7"),
            (12_345_678.9, 8, "12345679"),
            (12_345_678.9, 7, "1.234568e7"),
            (1.158_734_9e-23, 3, "1.16e-23"),
            (1_468.5, 2, "1468"),
            (-0.000_012, 3, "-1.20e-5"),
            (0.0, 4, "0"),
            (f64::INFINITY, 4, "inf"),
        ];
        for (value, digits, expected) in cases {
            assert_eq!(significant(value, digits), expected, "{value} with {digits} digits");
        }
    }

    #[test]
    fn short_text_ends_in_no_zeros() {
        assert_eq!(short(10_000.0, 8), "10000");
        assert_eq!(short(0.25, 8), "0.25");
        assert_eq!(short(1.5e9, 3), "1.5e9");
        assert_eq!(short(1e-8, 6), "1e-8");
        assert_eq!(short(0.0, 3), "0");
        assert_eq!(short(f64::INFINITY, 3), "inf");
    }

    #[test]
    fn exact_text_reads_back() {
        for value in [0.1, -1.0 / 3.0, f64::MAX, f64::MIN_POSITIVE, 0.0, 1e16, 123_456.0] {
            let text = exact(value);
            assert_eq!(text.parse::<f64>().unwrap().to_bits(), value.to_bits(), "{text}");
            assert!(text.len() < 30, "{text}");
        }
    }

    #[test]
    fn counts_and_times() {
        assert_eq!(count(999), "999");
        assert_eq!(count(1_250_000), "1 250 000");
        assert_eq!(seconds(0.012_34), "12.3 ms");
        assert_eq!(seconds(75.0), "75.0 s");
        assert_eq!(seconds(754.0), "12 min 34 s");
    }
}
