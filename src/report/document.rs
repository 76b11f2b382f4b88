//! What is said of a study, as data: written once, printed as text and as Markdown.

use crate::table::{Table, escaped};

/// A picture that the page shows.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// Path of its file, relative to the page.
    pub path: String,
    /// What it shows, in a sentence.
    pub caption: String,
}

/// Sections in order.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Document {
    /// Heading of the page.
    pub(super) title: String,
    pub(super) sections: Vec<Section>,
}

/// A title with what stands under it. Text leaves out a section that it has no part of.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Section {
    title: String,
    /// Whether text shows the title; a page always does.
    is_titled: bool,
    parts: Vec<(Shown, Part)>,
}

/// Where a part stands: a terminal has less room than a page for somebody who has not seen the tool.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Shown {
    Everywhere,
    InText,
    OnPage,
}

/// Words of it are literal but for `code` in backticks.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Part {
    Paragraph(String),
    Strong(String),
    Table(Table),
    /// Labels, which may be empty, and what is said of each.
    List(Vec<(String, String)>),
    /// Lines whose columns matter.
    Verbatim(String),
    Picture(Picture),
}

impl From<String> for Part {
    fn from(sentences: String) -> Self {
        Self::Paragraph(sentences)
    }
}

impl From<&str> for Part {
    fn from(sentences: &str) -> Self {
        Self::Paragraph(sentences.to_owned())
    }
}

impl From<Table> for Part {
    fn from(table: Table) -> Self {
        Self::Table(table)
    }
}

impl Section {
    pub(super) fn new(title: impl Into<String>) -> Self {
        Self { title: title.into(), is_titled: true, parts: Vec::new() }
    }

    /// One that says what it is by itself, so that text needs no title.
    pub(super) fn untitled(title: impl Into<String>) -> Self {
        Self { is_titled: false, ..Self::new(title) }
    }

    pub(super) fn with(self, part: impl Into<Part>) -> Self {
        self.shown(Shown::Everywhere, part)
    }

    pub(super) fn in_text(self, part: impl Into<Part>) -> Self {
        self.shown(Shown::InText, part)
    }

    pub(super) fn on_page(self, part: impl Into<Part>) -> Self {
        self.shown(Shown::OnPage, part)
    }

    fn shown(mut self, shown: Shown, part: impl Into<Part>) -> Self {
        self.parts.push((shown, part.into()));
        self
    }

    /// `None` without a part.
    pub(super) fn unless_empty(self) -> Option<Self> {
        (!self.parts.is_empty()).then_some(self)
    }

    /// As lines; the first sentence follows the title.
    pub(super) fn text(&self) -> String {
        let mut text = if self.is_titled { format!("{}:", self.title) } else { String::new() };
        let mut after_table = false;
        for (_, part) in self.parts.iter().filter(|(shown, _)| *shown != Shown::OnPage) {
            let is_sentence = matches!(part, Part::Paragraph(_) | Part::Strong(_));
            if text.ends_with(':') {
                text.push(if is_sentence { ' ' } else { '\n' });
            } else if after_table {
                text.push('\n');
            }
            text += &part.text();
            after_table = matches!(part, Part::Table(_));
        }
        text
    }

    fn markdown(&self) -> String {
        let parts = self.parts.iter().filter(|(shown, _)| *shown != Shown::InText).map(|(_, part)| part.markdown());
        let heading = format!("## {}", escaped(&self.title));
        std::iter::once(heading).chain(parts).collect::<Vec<_>>().join("\n\n")
    }
}

impl Part {
    /// Whole lines.
    fn text(&self) -> String {
        let item = |(label, text): &(String, String)| match label.as_str() {
            "" => format!("  {text}\n"),
            label => format!("  {label:<5} {text}\n"),
        };
        match self {
            Self::Paragraph(sentences) | Self::Strong(sentences) => format!("{sentences}\n"),
            Self::Table(table) => table.to_string(),
            Self::List(items) => items.iter().map(item).collect(),
            Self::Verbatim(lines) => format!("{}\n", lines.trim_end()),
            Self::Picture(picture) => format!("{}: {}\n", picture.path, picture.caption),
        }
    }

    fn markdown(&self) -> String {
        let item = |(label, text): &(String, String)| match label.as_str() {
            "" => format!("- {}", escaped(text)),
            label => format!("- **{}** {}", escaped(label), escaped(text)),
        };
        match self {
            Self::Paragraph(sentences) => escaped(sentences),
            Self::Strong(sentences) => format!("**{}**", escaped(sentences)),
            Self::Table(table) => table.markdown().trim_end().to_owned(),
            Self::List(items) => items.iter().map(item).collect::<Vec<_>>().join("\n"),
            Self::Verbatim(lines) => format!("```text\n{}\n```", lines.trim_end()),
            Self::Picture(Picture { path, caption }) => format!("![{0}]({path})\n\n*{0}*", escaped(caption)),
        }
    }
}

impl Document {
    /// For a terminal.
    pub(super) fn text(&self) -> String {
        let in_text = |section: &&Section| section.parts.iter().any(|(shown, _)| *shown != Shown::OnPage);
        self.sections.iter().filter(in_text).map(Section::text).collect::<Vec<_>>().join("\n")
    }

    /// For a page.
    pub(super) fn markdown(&self) -> String {
        let title = format!("# {}", escaped(&self.title));
        std::iter::once(title).chain(self.sections.iter().map(Section::markdown)).collect::<Vec<_>>().join("\n\n")
            + "\n"
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_document_as_text_and_as_markdown() {
        let mut table = Table::of(["a_b", "value"]);
        table.push(["x", "1.5"]);
        let list = [("NIS", "0.9  (`n`)"), ("right:", "yes"), ("", "so it is")];
        let list = Part::List(list.map(|(label, text)| (label.to_owned(), text.to_owned())).to_vec());
        let first = Section::new("First (f64)").with("one_two.").in_text("short").with(list);
        let second = Section::untitled("Second").on_page("For a page.").with(table.clone()).with("After it.");
        let third = Section::new("Third").with(table).on_page(Part::Strong("Both".into()));
        let page = Section::new("Page").on_page("No text.");
        let document = Document { title: "A_b".into(), sections: vec![first, second, third, page] };
        assert_eq!(
            document.text(),
            "First (f64): one_two.\nshort\n  NIS   0.9  (`n`)\n  right: yes\n  so it is\n\n  a_b  value\n  x      1.5\n\nAfter it.\n\n\
             Third:\n  a_b  value\n  x      1.5\n"
        );
        assert_eq!(
            document.markdown(),
            "# A\\_b\n\n## First (f64)\n\none\\_two.\n\n- **NIS** 0.9  (`n`)\n- **right:** yes\n- so it is\n\n## Second\n\n\
             For a page.\n\n| a\\_b | value |\n| --- | ---: |\n| x | 1.5 |\n\nAfter it.\n\n## Third\n\n\
             | a\\_b | value |\n| --- | ---: |\n| x | 1.5 |\n\n**Both**\n\n## Page\n\nNo text.\n"
        );
    }
}
