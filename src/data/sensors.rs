//! Which sensors speak in a row, and what that asks of its time and inputs.

use super::columns::{Columns, nearest};
use super::rows::shorten;
use super::{DataSpec, LogError, Rows};
use std::ops::Range;

/// The sensors of a log; none where one row measures all.
pub(super) struct Sensors {
    /// Column that says which sensor a row is of.
    column: Option<usize>,
    of: Vec<Sensor>,
    ignored: Vec<String>,
    /// Labels that rows have, for sensors that have none.
    labels: Vec<String>,
}

struct Sensor {
    name: Box<str>,
    when: Option<String>,
    /// Its measurements.
    range: Range<usize>,
    /// Whether any row has a measurement of it.
    heard: bool,
}

/// A set of sensors; bit 63 stands for none, so that rows of no sensor have times of their own too.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Set(u64);

/// When the sensors of a trajectory spoke last.
#[derive(Debug, Clone, Default)]
pub(super) struct Spoken {
    /// Those that have a row at the latest time.
    now: Set,
    /// Lines of these rows.
    lines: Vec<(Set, u64)>,
}

impl Set {
    const NONE: Self = Self(1 << 63);

    /// Whether a row of this set is of no sensor.
    pub(super) const fn is_nobody(self) -> bool {
        self.0 == Self::NONE.0
    }

    const fn meets(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }

    const fn with(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }
}

impl Spoken {
    /// The next row is at a later time.
    pub(super) fn later(&mut self) {
        *self = Self::default();
    }

    /// A row of `set` stands in `line`.
    pub(super) fn speak(&mut self, set: Set, line: u64) {
        self.now = self.now.with(set);
        self.lines.push((set, line));
    }

    /// The line and the sensors in which one of `set` spoke at this time.
    pub(super) fn before(&self, set: Set) -> Option<(Set, u64)> {
        let (other, line) = self.lines.iter().find(|(other, _)| other.meets(set))?;
        self.now.meets(set).then_some((Set(other.0 & set.0), *line))
    }
}

impl Sensors {
    pub(super) fn new(spec: &DataSpec, columns: &Columns) -> Self {
        let sensor = |(sensor, range): (&super::SensorSpec, _)| Sensor {
            name: shorten(&sensor.name),
            when: sensor.when.clone(),
            range,
            heard: false,
        };
        Self {
            column: columns.sensor,
            of: spec.sensors.iter().zip(spec.sensor_ranges()).map(sensor).collect(),
            ignored: spec.ignore_sensors.clone(),
            labels: Vec::new(),
        }
    }

    /// Whether there are any.
    pub(super) const fn are_told_apart(&self) -> bool {
        !self.of.is_empty()
    }

    /// The label of the current row, `None` where its sensor is to be ignored; empty without a column or a label.
    pub(super) fn label<'r>(&mut self, rows: &'r Rows<'_>) -> Result<Option<&'r str>, LogError> {
        let Some(column) = self.column else { return Ok(Some("")) };
        let label = rows.cell(column)?;
        if self.ignored.iter().any(|ignored| ignored == label) {
            return Ok(None);
        }
        if !label.is_empty() && !self.labels.iter().any(|known| known == label) {
            if !self.of.iter().any(|sensor| sensor.when.as_deref() == Some(label)) {
                return Err(self.unknown(rows, column, label));
            }
            self.labels.push(label.to_owned());
        }
        Ok(Some(label))
    }

    fn unknown(&self, rows: &Rows<'_>, column: usize, label: &str) -> LogError {
        let known: Vec<String> = self.of.iter().filter_map(|sensor| sensor.when.clone()).collect();
        let nearest = nearest(label, &known).map(|name| format!("; did you mean {:?}?", shorten(name)));
        LogError::UnknownSensor {
            place: rows.place(column),
            column: rows.name(column),
            found: shorten(label),
            nearest: nearest.unwrap_or_default().into(),
        }
    }

    /// Takes out of a row's measurements those of sensors that it is not of; the sensors that it is of.
    pub(super) fn hear(
        &mut self,
        label: &str,
        z: impl Fn(usize) -> Result<f64, LogError>,
        cells: &mut Vec<f64>,
    ) -> Result<Set, LogError> {
        let mut set = Set::default();
        cells.clear();
        for (number, sensor) in self.of.iter_mut().enumerate() {
            let named = sensor.when.as_ref().map(|when| when == label);
            for i in sensor.range.clone() {
                cells.push(if named == Some(false) { f64::NAN } else { z(i)? });
            }
            let filled = cells[sensor.range.clone()].iter().any(|z| !z.is_nan());
            sensor.heard |= filled;
            if named.unwrap_or(filled) {
                set = set.with(Set(1 << number));
            }
        }
        Ok(if set == Set::default() { Set::NONE } else { set })
    }

    /// The first sensor of a set, for messages.
    pub(super) fn name(&self, set: Set) -> Box<str> {
        let first = self.of.get(set.0.trailing_zeros() as usize);
        first.map_or_else(|| "none".into(), |sensor| sensor.name.clone())
    }

    /// Refuses sensors that measured nothing in a whole log.
    pub(super) fn refuse_silent(&self, file: &str) -> Result<(), LogError> {
        let Some(sensor) = self.of.iter().find(|sensor| !sensor.heard) else { return Ok(()) };
        let reason = match &sensor.when {
            Some(when) if !self.labels.contains(when) => {
                let near = nearest(when, &self.labels).map(|name| format!(", though some have {:?}", shorten(name)));
                format!("no row has {:?} in the sensor column{}", shorten(when), near.unwrap_or_default())
            }
            Some(_) => "its rows are empty".to_owned(),
            None => "its columns are empty".to_owned(),
        };
        Err(LogError::SilentSensor { file: file.into(), sensor: sensor.name.clone(), reason: reason.into() })
    }
}
