//! From CSV to [`Log`], one row at a time.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::columns::Columns;
use super::{Clock, Log, LogError, Place, Rows, Table, Trajectory};
use crate::model::DataSpec;

const LEAVE_EMPTY: &str = "leave the cell empty for a missing measurement";
const LEAVE_TRUTH_EMPTY: &str = "leave the cell empty where the truth is unknown";
const GIVE_INPUT: &str = "only a trajectory's last row may leave an input empty";

impl Log {
    /// Reads the log that `spec` names: a CSV file relative to the folder `base`, or standard input for `-`.
    ///
    /// # Errors
    /// [`LogError`]: the file or its content is not a log with the columns of `spec`.
    pub fn open(spec: &DataSpec, base: &Path) -> Result<Self, LogError> {
        let name = spec.file.as_deref().ok_or(LogError::Unnamed)?;
        if name == "-" {
            return Self::read(spec, io::stdin().lock(), "<stdin>");
        }
        let path = base.join(name);
        let file: Box<str> = path.display().to_string().into();
        let reader = File::open(&path).map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => LogError::NotFound { file: file.clone() },
            io::ErrorKind::IsADirectory => LogError::Directory { file: file.clone() },
            _ => LogError::Io { file: file.clone(), error },
        })?;
        Self::read(spec, reader, &file)
    }

    /// Reads a log from any reader; `source` stands for it in messages. Memory stays at the log itself plus one row.
    ///
    /// The text is UTF-8 with a header line; `,`, `;` or tab part the cells, double quotes may enclose one, `#` starts a
    /// comment line, blank lines are skipped. An empty cell, `NaN`, `NA` or `null` is a missing value (in a log of one
    /// column, write `NaN` or `""`). Times are seconds, or ISO-8601 (UTC without a zone), which become seconds since the
    /// first row.
    ///
    /// # Errors
    /// [`LogError`], with the line and the character that is to blame.
    pub fn read(spec: &DataSpec, mut reader: impl Read, source: &str) -> Result<Self, LogError> {
        let mut rows = Rows::open(&mut reader, source)?;
        let mut builder = Builder::new(Columns::of(spec, &rows)?);
        while rows.advance()? {
            builder.push(&rows)?;
        }
        if builder.trajectories.is_empty() {
            return Err(LogError::HeaderOnly { file: source.into() });
        }
        let log = Self {
            source: source.to_owned(),
            measurements: spec.measurements.clone(),
            inputs: spec.inputs.clone(),
            truth: spec.truth.iter().map(|(state, _)| state.clone()).collect(),
            trajectories: builder.finish(),
        };
        log.refuse_empty_measurements()?;
        Ok(log)
    }

    fn refuse_empty_measurements(&self) -> Result<(), LogError> {
        let present = |i: usize| self.trajectories.iter().any(|t| t.z.column(i).any(|z| !z.is_nan()));
        match (0..self.measurements.len()).find(|&i| !present(i)) {
            None => Ok(()),
            Some(i) => Err(LogError::AllMissing {
                file: self.source.as_str().into(),
                column: self.measurements[i].as_str().into(),
            }),
        }
    }
}

/// Trajectories under construction.
struct Builder {
    columns: Columns,
    clock: Clock,
    trajectories: Vec<Trajectory>,
    /// Where the last row of each trajectory lacks an input: an error as soon as another row follows.
    gaps: Vec<Option<(Place, usize)>>,
    index: HashMap<Box<str>, usize>,
    /// One row's cells, kept to spare an allocation a row.
    cells: Vec<f64>,
}

impl Builder {
    fn new(columns: Columns) -> Self {
        let (trajectories, gaps, index) = (Vec::new(), Vec::new(), HashMap::new());
        Self { columns, clock: Clock::Unset, trajectories, gaps, index, cells: Vec::new() }
    }

    fn push(&mut self, rows: &Rows<'_>) -> Result<(), LogError> {
        let t = self.trajectory(rows)?;
        let time = self.time(rows, t)?;
        if let Some((place, i)) = self.gaps[t].take() {
            return Err(LogError::MissingInput { place, column: rows.name(i) });
        }
        let trajectory = &mut self.trajectories[t];
        let cells = &mut self.cells;
        fill(cells, rows, &self.columns.measurements, LEAVE_EMPTY)?;
        trajectory.z.push(cells);
        fill(cells, rows, &self.columns.truth, LEAVE_TRUTH_EMPTY)?;
        trajectory.truth.push(cells);
        fill(cells, rows, &self.columns.inputs, GIVE_INPUT)?;
        trajectory.u.push(cells);
        let gap = cells.iter().position(|u| u.is_nan());
        self.gaps[t] = gap.map(|i| self.columns.inputs[i]).map(|i| (rows.place(i), i));
        trajectory.time.push(time);
        trajectory.line.push(rows.line());
        Ok(())
    }

    /// Position of the current row's trajectory, which is begun if it is new.
    fn trajectory(&mut self, rows: &Rows<'_>) -> Result<usize, LogError> {
        let id = match self.columns.trajectory {
            None => "",
            Some(i) => match rows.cell(i)? {
                "" => return Err(LogError::MissingTrajectory { place: rows.place(i), column: rows.name(i) }),
                id => id,
            },
        };
        if let Some(&t) = self.index.get(id) {
            return Ok(t);
        }
        self.index.insert(id.into(), self.trajectories.len());
        self.gaps.push(None);
        self.trajectories.push(Trajectory {
            id: id.to_owned(),
            time: Vec::new(),
            z: Table::new(self.columns.measurements.len()),
            u: Table::new(self.columns.inputs.len()),
            truth: Table::new(self.columns.truth.len()),
            line: Vec::new(),
        });
        Ok(self.trajectories.len() - 1)
    }

    /// Time of the current row [s], later than the last row of trajectory `t`.
    fn time(&mut self, rows: &Rows<'_>, t: usize) -> Result<f64, LogError> {
        let trajectory = &self.trajectories[t];
        let Some(i) = self.columns.time else { return Ok(trajectory.len() as f64) };
        let time = self.clock.read(rows, i)?;
        match (trajectory.time.last(), trajectory.line.last()) {
            (Some(&previous), Some(&previous_line)) if time <= previous => Err(LogError::NotIncreasing {
                place: rows.place(i),
                time: self.clock.show(time),
                previous: self.clock.show(previous),
                previous_line,
            }),
            _ => Ok(time),
        }
    }

    fn finish(mut self) -> Vec<Trajectory> {
        for trajectory in &mut self.trajectories {
            trajectory.shrink();
        }
        self.trajectories
    }
}

fn fill(cells: &mut Vec<f64>, rows: &Rows<'_>, columns: &[usize], remedy: &'static str) -> Result<(), LogError> {
    cells.clear();
    for &i in columns {
        cells.push(rows.number(i, remedy)?);
    }
    Ok(())
}
