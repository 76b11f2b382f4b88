//! What a study found, for people (text, Markdown) and programs (JSON).

use std::fmt;

use serde::Serialize;
use serde::ser::{SerializeStruct as _, Serializer};

use super::target::Target;
use crate::chart::{Figure as Picture, FigureError};
use crate::evaluate::Device;
use crate::number::seconds;
use crate::table::{Cell, Table};

/// A picture of a study.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Figure {
    /// Name of its file, without ending.
    pub name: String,
    /// What it shows.
    pub caption: String,
    /// The picture.
    pub svg: String,
}

impl Figure {
    pub(super) fn of(
        name: impl Into<String>,
        caption: impl Into<String>,
        picture: &Picture,
    ) -> Result<Self, FigureError> {
        Ok(Self { name: name.into(), caption: caption.into(), svg: picture.to_svg()? })
    }
}

/// A study as it was run.
#[derive(Debug, Clone)]
pub struct Reproduction {
    /// Name of the study.
    pub name: &'static str,
    /// What was done, in a sentence or two.
    pub summary: String,
    /// The paper.
    pub paper: &'static str,
    /// What a quick run left out; `None` = the full study.
    pub reduced: Option<String>,
    /// Seed of data and searches.
    pub seed: u64,
    /// What must be reached.
    pub targets: Vec<Target>,
    /// Our numbers beside the paper's.
    pub table: Table,
    /// Further tables, printed after it.
    pub tables: Vec<Table>,
    /// What was found and is not gated, one sentence each.
    pub findings: Vec<String>,
    /// What of the paper cannot be recovered, and the reading taken.
    pub readings: Vec<String>,
    /// Every number behind the tables and figures; files only.
    pub data: Vec<Table>,
    /// The pictures; files only.
    pub figures: Vec<Figure>,
    /// Where costs were computed.
    pub device: Device,
    /// Time of the whole study, in seconds.
    pub wall_s: f64,
}

impl Reproduction {
    /// Whether every target is reached.
    #[must_use]
    pub fn passes(&self) -> bool {
        self.targets.iter().all(|target| target.pass)
    }

    /// The targets as a table.
    #[must_use]
    pub fn target_table(&self) -> Table {
        let mut table = Table::new("targets", "Targets", &["target", "required", "measured", "pass"]);
        for target in &self.targets {
            table.rows.push(vec![
                Cell::text(&target.name),
                Cell::text(target.required.to_string()),
                measured(target.measured),
                Cell::text(if target.pass { "yes" } else { "NO" }),
            ]);
        }
        table
    }

    fn verdict(&self) -> String {
        let missed = self.targets.iter().filter(|target| !target.pass).count();
        match missed {
            0 => format!("All {} targets are reached.", self.targets.len()),
            _ => format!("{missed} of {} targets are MISSED.", self.targets.len()),
        }
    }

    fn quick_note(&self) -> Option<String> {
        self.reduced.as_ref().map(|reduced| format!("Quick run: {reduced}"))
    }

    fn device_line(&self) -> String {
        let Device { backend, adapter, precision } = &self.device;
        format!("seed {}, {backend} ({adapter}), {precision}, {}", self.seed, seconds(self.wall_s))
    }

    /// The report in Markdown, with the figures it names beside it in `figures`.
    #[must_use]
    pub fn markdown(&self, figure_names: &[String]) -> String {
        let mut text = format!("# {}\n\n{}\n\n{}\n\n{}\n", self.name, self.paper, self.summary, self.device_line());
        if let Some(note) = self.quick_note() {
            text += &format!("\n**{note}**\n");
        }
        text += &format!("\n## Targets\n\n{}\n\n{}", self.verdict(), self.target_table().markdown());
        for table in std::iter::once(&self.table).chain(&self.tables) {
            text += &format!("\n## {}\n\n{}", table.title, table.markdown());
        }
        for (title, lines) in self.lists() {
            let items: String = lines.iter().map(|line| format!("- {line}\n")).collect();
            text += &format!("\n## {title}\n\n{items}");
        }
        if !self.figures.is_empty() {
            text += "\n## Figures\n";
        }
        for (figure, name) in self.figures.iter().zip(figure_names) {
            text += &format!("\n{}\n\n![{}]({name})\n", figure.caption, figure.name);
        }
        text
    }

    fn lists(&self) -> [(&'static str, &[String]); 2] {
        [("Found, not gated", &self.findings), ("Readings: what the paper leaves open", &self.readings)]
    }
}

/// A count without decimals, anything else with five digits.
fn measured(value: f64) -> Cell {
    /// Whole numbers up to here are counts.
    const COUNTS: f64 = 1e9;
    let whole = value.fract().abs() <= 0.0 && value.abs() < COUNTS;
    if whole { Cell::text(format!("{value:.0}")) } else { Cell::Number(value, 5) }
}

impl fmt::Display for Reproduction {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        writeln!(f, "{}: {}\n{}\n{}", self.name, self.paper, self.summary, self.device_line())?;
        if let Some(note) = self.quick_note() {
            writeln!(f, "{note}")?;
        }
        for table in std::iter::once(&self.table).chain(&self.tables) {
            writeln!(f, "\n{}\n{}", table.title, table.to_string().trim_end())?;
        }
        for (title, lines) in self.lists() {
            writeln!(f, "\n{title}")?;
            lines.iter().try_for_each(|line| writeln!(f, "  - {line}"))?;
        }
        writeln!(f, "\nTargets\n{}", self.target_table().to_string().trim_end())?;
        writeln!(f, "\n{}", self.verdict())
    }
}

impl Serialize for Reproduction {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut object = serializer.serialize_struct("Reproduction", 13)?;
        object.serialize_field("name", self.name)?;
        object.serialize_field("paper", self.paper)?;
        object.serialize_field("pass", &self.passes())?;
        object.serialize_field("targets", &self.targets)?;
        object.serialize_field("quick", &self.reduced.is_some())?;
        object.serialize_field("reduced", &self.reduced)?;
        object.serialize_field("seed", &self.seed)?;
        object.serialize_field("table", &self.table)?;
        let further: std::collections::BTreeMap<&str, &Table> = self.tables.iter().map(|t| (t.name, t)).collect();
        object.serialize_field("tables", &further)?;
        object.serialize_field("findings", &self.findings)?;
        object.serialize_field("readings", &self.readings)?;
        object.serialize_field("device", &self.device)?;
        object.serialize_field("wall_s", &self.wall_s)?;
        object.end()
    }
}

#[cfg(test)]
mod tests {
    use super::super::Required;
    use super::*;
    use crate::evaluate::{Backend, Precision};

    fn reproduction(measured: f64) -> Reproduction {
        let mut table = Table::new("summary", "Summary", &["method", "J"]);
        table.rows.push(vec![Cell::text("PIO"), Cell::Number(1.5, 3)]);
        let device = Device { backend: Backend::Mock, adapter: "none".into(), precision: Precision::F64 };
        Reproduction {
            name: "made-up",
            summary: "A study of nothing.".into(),
            paper: "Nobody, 2000",
            reduced: Some("2 data sets in place of 30.".into()),
            seed: 7,
            targets: vec![Target::new("J", Required::AtMost(2.0), measured)],
            table,
            tables: Vec::new(),
            findings: vec!["It rains.".into()],
            readings: vec!["J is a sum.".into()],
            data: Vec::new(),
            figures: vec![Figure { name: "rain".into(), caption: "Rain".into(), svg: "<svg/>".into() }],
            device,
            wall_s: 0.5,
        }
    }

    #[test]
    fn a_missed_target_shows_in_every_form() {
        let (passed, missed) = (reproduction(1.0), reproduction(3.0));
        assert!(passed.passes() && !missed.passes(), "the limit is 2");
        assert!(passed.to_string().ends_with("All 1 targets are reached.\n"), "{passed}");
        assert!(missed.to_string().ends_with("1 of 1 targets are MISSED.\n"), "{missed}");
        assert!(missed.markdown(&[]).contains("| J | <= 2 | 3 | NO |"), "{}", missed.markdown(&[]));
        let json = serde_json::to_value(&missed).expect("a report");
        assert_eq!((&json["name"], &json["quick"], &json["pass"]), (&"made-up".into(), &true.into(), &false.into()));
        assert_eq!(json["targets"][0]["required"], "<= 2");
        assert_eq!(json["table"][0]["J"], 1.5);
    }

    #[test]
    fn the_report_names_its_figures_and_says_what_was_reduced() {
        let markdown = reproduction(1.0).markdown(&["rain.svg".into()]);
        for part in ["**Quick run: 2 data sets", "![rain](rain.svg)", "- It rains.", "- J is a sum.", "| PIO | 1.50 |"]
        {
            assert!(markdown.contains(part), "{part} in\n{markdown}");
        }
    }
}
