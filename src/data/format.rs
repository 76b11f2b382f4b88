//! How a file writes cells and numbers, where that is not as usual.

use std::borrow::Cow;

/// Keys of `[data]` about the file: the default reads a header, then rows with decimal points.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Format {
    /// `separator`: what parts the cells; `None` = whichever of `,` `;` tab the header has most of. A blank stands for
    /// any number of blanks and tabs.
    pub separator: Option<char>,
    /// `decimal = ","`.
    pub decimal_comma: bool,
    /// `thousands`: what groups digits by three.
    pub thousands: Option<char>,
    /// `header_line`: 1-based; lines before it are left out.
    pub header_line: Option<u64>,
    /// `skip_lines`: 1-based lines that are left out, in rising order.
    pub skip_lines: Vec<u64>,
}

impl Format {
    /// The number that a cell writes, with a decimal point and nothing else; `None` where it breaks the rules of this
    /// format. Whether it is a number at all is for the caller to see.
    pub(crate) fn plain<'t>(&self, text: &'t str) -> Option<Cow<'t, str>> {
        let mut plain = Cow::Borrowed(text);
        if let Some(mark) = self.thousands.filter(|mark| text.contains(*mark)) {
            let decimal = if self.decimal_comma { ',' } else { '.' };
            let end = text.find([decimal, 'e', 'E']).unwrap_or(text.len());
            plain = Cow::Owned(ungrouped(&text[..end], mark)? + &text[end..]);
        }
        if self.decimal_comma {
            if plain.contains('.') {
                return None;
            }
            if plain.contains(',') {
                plain = Cow::Owned(plain.replacen(',', ".", 1));
            }
        }
        Some(plain)
    }
}

/// Digits in groups of three, without the marks between; the first may be shorter.
fn ungrouped(text: &str, mark: char) -> Option<String> {
    let mut groups = text.split(mark);
    let first = groups.next()?.trim_start_matches(['-', '+']);
    let digits = |group: &str| group.bytes().all(|b| b.is_ascii_digit());
    let sound = (1..=3).contains(&first.len()) && digits(first) && groups.all(|g| g.len() == 3 && digits(g));
    sound.then(|| text.replace(mark, ""))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(decimal_comma: bool, thousands: Option<char>, text: &str) -> Option<f64> {
        let format = Format { decimal_comma, thousands, ..Format::default() };
        format.plain(text).and_then(|plain| plain.parse().ok())
    }

    #[test]
    fn numbers_of_every_country() {
        assert_eq!(read(true, None, "-0,019081"), Some(-0.019081));
        assert_eq!(read(true, None, "1,5E-3"), Some(0.0015));
        assert_eq!(read(true, None, "12"), Some(12.0));
        assert_eq!(read(true, Some('.'), "1.234.567,5"), Some(1_234_567.5));
        assert_eq!(read(false, Some(','), "2,294,223"), Some(2_294_223.0));
        assert_eq!(read(false, Some(','), "-1,234.5e1"), Some(-12345.0));
        assert_eq!(read(false, Some('\''), "12'345"), Some(12345.0));
        assert_eq!(read(false, Some(','), "12.25"), Some(12.25));
    }

    #[test]
    fn what_breaks_the_rules_is_no_number() {
        assert_eq!(read(true, None, "1.5"), None, "a point among commas");
        assert_eq!(read(true, Some('.'), "1.5"), None, "no group of three");
        assert_eq!(read(true, None, "1,2,3"), None);
        for text in ["1,23", "1234,567", ",123", "1,2345", "1,234,56"] {
            assert_eq!(read(false, Some(','), text), None, "{text}");
        }
    }
}
