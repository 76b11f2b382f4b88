//! Text that must fit: widths without a font at hand, shortening, escaping.

/// The family of every text: one of these is on every system, and they are alike in width.
pub(super) const FAMILY: &str = "Helvetica, Arial, 'Liberation Sans', 'DejaVu Sans', sans-serif";

/// Widths of the printable ASCII characters, space first, in thousandths of the font size. They are those of DejaVu
/// Sans, the widest of [`FAMILY`], rounded up to tens.
const WIDTHS: [u16; 95] = [
    320, 410, 460, 840, 640, 960, 780, 280, 400, 400, 500, 840, 320, 370, 320, 340, 640, 640, 640, 640, 640, 640, 640,
    640, 640, 640, 340, 340, 840, 840, 840, 540, 1000, 690, 690, 700, 780, 640, 580, 780, 760, 300, 300, 660, 560, 870,
    750, 790, 610, 790, 700, 640, 620, 740, 690, 990, 690, 620, 690, 400, 340, 400, 840, 500, 500, 620, 640, 550, 640,
    620, 360, 640, 640, 280, 280, 580, 280, 980, 640, 620, 640, 640, 420, 530, 400, 640, 600, 820, 600, 600, 530, 640,
    340, 640, 840,
];

/// An upper estimate of the width of `text` \[px\] at a font size \[px\].
pub(super) fn width(text: &str, size: f64) -> f64 {
    text.chars().map(|c| character(c) * size).sum()
}

fn character(c: char) -> f64 {
    let code = c as usize;
    match WIDTHS.get(code.wrapping_sub(32)) {
        Some(width) => f64::from(*width) / 1000.0,
        // Latin, Greek and Cyrillic letters and signs. From U+1100 on come scripts of square characters, and what
        // cannot be shown becomes a square too.
        None if (0xa0..0x1100).contains(&code) || (0x2000..0x2300).contains(&code) => 0.85,
        None => 1.05,
    }
}

/// `text`, or its start and end around an ellipsis where it is wider than `limit` \[px\].
pub(super) fn fitted(text: &str, size: f64, limit: f64) -> String {
    if width(text, size) <= limit {
        return text.to_owned();
    }
    let characters: Vec<char> = text.chars().collect();
    let mut used = size;
    let (mut head, mut tail) = (0, characters.len());
    while head < tail {
        // Two from the start for each from the end: starts tell more.
        let from_start = head <= 2 * (characters.len() - tail);
        let next = characters[if from_start { head } else { tail - 1 }];
        used += character(next) * size;
        if used > limit {
            break;
        }
        if from_start {
            head += 1;
        } else {
            tail -= 1;
        }
    }
    characters[..head].iter().chain(&['…']).chain(&characters[tail..]).collect()
}

/// As character data of XML; characters that XML 1.0 does not allow become U+FFFD.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\t' | '\n' | '\r' => out.push(' '),
            '\0'..='\u{1f}' | '\u{7f}'..='\u{9f}' | '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_text_keeps_its_start_and_end() {
        assert_eq!(fitted("sigma", 13.0, 200.0), "sigma");
        let long = "a_parameter_with_a_name_that_nobody_can_read_at_once";
        let short = fitted(long, 13.0, 150.0);
        assert!(short.starts_with("a_param") && short.ends_with("once") && short.contains('…'), "{short}");
        assert!(width(&short, 13.0) <= 160.0, "{short}");
        assert_eq!(fitted("日本語の名前", 13.0, 20.0), "…", "no room for any");
    }

    #[test]
    fn text_is_escaped() {
        assert_eq!(escaped("<R & \"Q\">\u{1}\n"), "&lt;R &amp; &quot;Q&quot;&gt;\u{fffd} ");
        assert_eq!(escaped("σ² [m²]"), "σ² [m²]");
    }
}
