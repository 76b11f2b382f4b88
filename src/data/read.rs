//! From CSV to [`Log`], one row at a time.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::columns::Columns;
use super::times::Texts;
use super::{Clock, DataSpec, Log, LogError, Place, Rows, Table, TimeUnit, Times, Trajectory};

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
    /// comment line, blank lines are skipped ([`super::Format`] has what else is read). An empty cell, `NaN`, `NA` or
    /// `null` is a missing value (in a log of one column, write `NaN` or `""`). Times are numbers of
    /// [`DataSpec::time_unit`], or instants (ISO-8601, UTC without a zone; `hh:mm:ss`), which count from the first row.
    ///
    /// # Errors
    /// [`LogError`], with the line and the character that is to blame.
    pub fn read(spec: &DataSpec, mut reader: impl Read, source: &str) -> Result<Self, LogError> {
        let mut rows = Rows::open(&mut reader, source, &spec.format)?;
        let unit = spec.time_unit.unwrap_or_default();
        let mut builder = Builder::new(Columns::of(spec, &rows)?, unit);
        while rows.advance()? {
            builder.push(&rows)?;
        }
        if builder.trajectories.is_empty() {
            return Err(LogError::HeaderOnly { file: source.into() });
        }
        let (trajectories, times) = builder.finish();
        let log = Self {
            source: source.to_owned(),
            measurements: spec.measurements.clone(),
            inputs: spec.inputs.clone(),
            truth: spec.truth.iter().map(|(state, _)| state.clone()).collect(),
            trajectories,
            times,
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
    unit: TimeUnit,
    clock: Clock,
    texts: Texts,
    trajectories: Vec<Trajectory>,
    /// Where the last row of each trajectory lacks an input: an error as soon as another row follows.
    gaps: Vec<Option<(Place, usize)>>,
    index: HashMap<Box<str>, usize>,
    /// One row's cells, kept to spare an allocation a row.
    cells: Vec<f64>,
}

impl Builder {
    fn new(columns: Columns, unit: TimeUnit) -> Self {
        let (clock, texts, trajectories) = (Clock::new(unit), Texts::default(), Vec::new());
        let (gaps, index, cells) = (Vec::new(), HashMap::new(), Vec::new());
        Self { columns, unit, clock, texts, trajectories, gaps, index, cells }
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

    /// Time of the current row, later than the last row of trajectory `t`.
    fn time(&mut self, rows: &Rows<'_>, t: usize) -> Result<f64, LogError> {
        let Some(i) = self.columns.time else { return Ok(self.trajectories[t].len() as f64) };
        let counted = self.clock.counts_from_first();
        let time = self.clock.read(rows, i)?;
        if self.clock.counts_from_first() && !counted {
            self.count_from_first();
        }
        let text = rows.cell(i)?;
        if text != time.to_string() {
            self.texts.push(rows.line(), text);
        }
        let trajectory = &self.trajectories[t];
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

    /// Makes the times read so far count from the first.
    fn count_from_first(&mut self) {
        let times = self.trajectories.iter_mut().flat_map(|t| &mut t.time);
        times.for_each(|time| *time = self.clock.counted_from_first(*time));
    }

    fn finish(mut self) -> (Vec<Trajectory>, Times) {
        if self.clock.is_noisy()
            && let Some(step) = noisy_step(&self.trajectories)
            && self.clock.count_from_first()
        {
            for trajectory in &mut self.trajectories {
                let start = trajectory.time.first().map_or(0.0, |first| self.clock.counted_from_first(*first));
                trajectory.time.iter_mut().enumerate().for_each(|(k, time)| *time = start + k as f64 * step);
            }
        }
        for trajectory in &mut self.trajectories {
            trajectory.shrink();
        }
        (self.trajectories, Times::new(self.unit, self.clock.origin(), self.texts))
    }
}

/// The regular step under times that are only as good as doubles of their size: (last - first) / (n - 1), where every
/// time is within their rounding of first + k step, but their differences are not equal.
fn noisy_step(trajectories: &[Trajectory]) -> Option<f64> {
    let longest = trajectories.iter().max_by_key(|t| t.len()).filter(|t| t.len() > 2)?;
    let (first, last) = (longest.time[0], longest.time[longest.len() - 1]);
    let step = (last - first) / (longest.len() - 1) as f64;
    let is_on_grid = |t: &Trajectory| {
        let (first, last) = (t.time[0], t.time[t.len() - 1]);
        let noise = f64::EPSILON * first.abs().max(last.abs());
        // Half a unit in the last place each: of the time, of the first, and twice of the ends that the step is from.
        noise < 1e-2 * step
            && t.time.iter().enumerate().all(|(k, time)| (time - first - k as f64 * step).abs() <= 2.0 * noise)
    };
    let mut steps = trajectories.iter().flat_map(|t| (0..t.len()).filter_map(|k| t.dt(k)));
    let one = steps.next()?;
    let is_regular = steps.all(|dt| (dt - one).abs() <= 1e-9 * one);
    (!is_regular && trajectories.iter().all(is_on_grid)).then_some(step)
}

fn fill(cells: &mut Vec<f64>, rows: &Rows<'_>, columns: &[usize], remedy: &'static str) -> Result<(), LogError> {
    cells.clear();
    for &i in columns {
        cells.push(rows.number(i, remedy)?);
    }
    Ok(())
}
