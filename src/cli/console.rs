//! What a person reads on standard error. Nothing here can fail: a closed stderr must not lose the result.

use std::fmt::Display;
use std::io::{self, IsTerminal as _, Write as _};

/// Standard error, or silence.
#[derive(Debug, Clone, Copy)]
pub(super) struct Console {
    quiet: bool,
}

impl Console {
    pub(super) const fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// A line, or several, of information.
    pub(super) fn note(self, text: impl Display) {
        if !self.quiet {
            let _ = writeln!(io::stderr().lock(), "{text}");
        }
    }

    /// Something the user should look at.
    pub(super) fn warn(self, text: impl Display) {
        self.note(format_args!("warning: {text}"));
    }

    /// Whether a progress bar has a reader.
    pub(super) fn shows_progress(self) -> bool {
        !self.quiet && io::stderr().is_terminal()
    }
}

/// Prints an error as `error: ...`.
pub(super) fn error(error: &anyhow::Error) {
    let _ = writeln!(io::stderr().lock(), "error: {}", cut(&sentence(error)));
}

/// The text with the middle of overlong lines left out. Messages shorten what they repeat of the input; this is for what
/// they do not know to be long.
pub(super) fn cut(text: &str) -> String {
    const LONGEST: usize = 300;
    const BEGIN: usize = 185;
    const END: usize = 100;
    let line = |line: &str| {
        let characters: Vec<char> = line.chars().collect();
        if characters.len() <= LONGEST {
            return line.to_owned();
        }
        let (begin, end) = (&characters[..BEGIN], &characters[characters.len() - END..]);
        begin.iter().chain(&[' ', '.', '.', '.', ' ']).chain(end).collect()
    };
    text.split('\n').map(line).collect::<Vec<_>>().join("\n")
}

/// The error and its causes in one sentence, leaving out a cause that the message before it already tells.
fn sentence(error: &anyhow::Error) -> String {
    let mut said = error.to_string();
    for cause in error.chain().skip(1).map(ToString::to_string) {
        if !said.contains(&cause) {
            said.push_str(": ");
            said.push_str(&cause);
        }
    }
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_keeps_its_begin_and_its_end() {
        let text = format!("p.toml:1:2: `{}` is unknown: did you mean `r`?\n  |\n", "x".repeat(1_000_000));
        let short = cut(&text);
        assert!(short.starts_with("p.toml:1:2: `xxx") && short.contains("x ... x"), "{short}");
        assert!(short.ends_with("did you mean `r`?\n  |\n") && short.chars().count() < 300, "{short}");
        assert_eq!(cut("a sentence"), "a sentence");
    }

    #[test]
    fn a_cause_is_told_once() {
        let cause = io::Error::other("disk full");
        let error = anyhow::Error::from(cause).context("cannot write out.csv");
        assert_eq!(sentence(&error), "cannot write out.csv: disk full");
        let repeated = error.context("stopped: cannot write out.csv");
        assert_eq!(sentence(&repeated), "stopped: cannot write out.csv: disk full");
    }
}
