//! From CSV to [`Log`], one row at a time.

use std::collections::HashMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use super::columns::Columns;
use super::sensors::{Sensors, Set, Spoken};
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
        let mut builder = Builder::new(spec, Columns::of(spec, &rows)?, unit);
        while rows.advance()? {
            builder.push(&rows)?;
        }
        if builder.trajectories.is_empty() {
            return Err(LogError::HeaderOnly { file: source.into() });
        }
        builder.sensors.refuse_silent(source)?;
        let (trajectories, times) = builder.finish();
        let log = Self {
            source: source.to_owned(),
            measurements: spec.measurements.clone(),
            inputs: spec.inputs.clone(),
            truth: spec.truth.iter().map(|(state, _)| state.clone()).collect(),
            trajectories,
            times,
            ranges: None,
        };
        log.refuse_empty_measurements(spec)?;
        Ok(log)
    }

    fn refuse_empty_measurements(&self, spec: &DataSpec) -> Result<(), LogError> {
        let present = |i: usize| self.trajectories.iter().any(|t| t.z.column(i).any(|z| !z.is_nan()));
        match (0..self.measurements.len()).find(|&i| !present(i)) {
            None => Ok(()),
            Some(i) => {
                Err(LogError::AllMissing { file: self.source.as_str().into(), column: spec.columns()[i].into() })
            }
        }
    }
}

/// Trajectories under construction.
struct Builder<'a> {
    columns: Columns,
    sensors: Sensors,
    /// For each trajectory, who has spoken at its latest time.
    spoken: Vec<Spoken>,
    spec: &'a DataSpec,
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

impl<'a> Builder<'a> {
    fn new(spec: &'a DataSpec, columns: Columns, unit: TimeUnit) -> Self {
        let (clock, texts, trajectories) = (Clock::new(unit), Texts::default(), Vec::new());
        let (gaps, index, cells) = (Vec::new(), HashMap::new(), Vec::new());
        let (sensors, spoken) = (Sensors::new(spec, &columns), Vec::new());
        Self { columns, sensors, spoken, spec, unit, clock, texts, trajectories, gaps, index, cells }
    }

    fn push(&mut self, rows: &Rows<'_>) -> Result<(), LogError> {
        let Some(label) = self.sensors.label(rows)? else { return Ok(()) };
        let t = self.trajectory(rows)?;
        let cells = &mut self.cells;
        let set = if self.sensors.are_told_apart() {
            let columns = &self.columns.measurements;
            self.sensors.hear(label, |i| rows.number(columns[i], LEAVE_EMPTY), cells)?
        } else {
            Set::default()
        };
        let time = self.time(rows, t, set)?;
        if let Some((place, i)) = self.gaps[t].take() {
            return Err(LogError::MissingInput { place, column: rows.name(i) });
        }
        let (trajectory, cells) = (&mut self.trajectories[t], &mut self.cells);
        if !self.sensors.are_told_apart() {
            fill(cells, rows, &self.columns.measurements, LEAVE_EMPTY)?;
        }
        trajectory.z.push(cells);
        fill(cells, rows, &self.columns.truth, LEAVE_TRUTH_EMPTY)?;
        trajectory.truth.push(cells);
        fill(cells, rows, &self.columns.inputs, GIVE_INPUT)?;
        trajectory.u.push(cells);
        trajectory.time.push(time);
        trajectory.line.push(rows.line());
        self.gaps[t] = self.input_gap(rows, t)?;
        Ok(())
    }

    /// An input that the current row lacks although the step after it needs one.
    fn input_gap(&self, rows: &Rows<'_>, t: usize) -> Result<Option<(Place, usize)>, LogError> {
        let trajectory = &self.trajectories[t];
        let row = trajectory.len() - 1;
        for (i, _) in trajectory.u.row(row).iter().enumerate().filter(|(_, u)| u.is_nan()) {
            let place = rows.place(self.columns.inputs[i]);
            let Some(Some(readers)) = self.spec.readers.get(i) else {
                return Ok(Some((place, self.columns.inputs[i])));
            };
            if let Some(reader) = readers.iter().find(|m| !trajectory.z.row(row)[**m].is_nan()) {
                let (column, measurement) = (rows.name(self.columns.inputs[i]), &self.spec.measurements[*reader]);
                return Err(LogError::MissingSensorInput { place, column, measurement: measurement.as_str().into() });
            }
        }
        Ok(None)
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
        self.spoken.push(Spoken::default());
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

    /// Time of the current row, which comes after the last row of trajectory `t`, or with it where no sensor of `set` spoke
    /// yet.
    fn time(&mut self, rows: &Rows<'_>, t: usize, set: Set) -> Result<f64, LogError> {
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
            (Some(&previous), Some(&line)) if time <= previous => {
                self.not_later(rows, (t, set), time, (previous, line))?
            }
            _ => self.spoken[t].later(),
        }
        self.spoken[t].speak(set, rows.line());
        Ok(time)
    }

    /// Refuses the time of the current row, which is not later than the last one, unless other sensors spoke then.
    fn not_later(
        &self,
        rows: &Rows<'_>,
        (t, set): (usize, Set),
        time: f64,
        (previous, previous_line): (f64, u64),
    ) -> Result<(), LogError> {
        let place = self.columns.time.map_or_else(|| rows.header_place(), |i| rows.place(i));
        let (shown, told) = (self.clock.show(time), self.sensors.are_told_apart());
        if told && time < previous && !set.is_nobody() {
            let (sensor, previous) = (self.sensors.name(set), self.clock.show(previous));
            return Err(LogError::Late { place, sensor, time: shown, previous, previous_line });
        }
        match self.spoken[t].before(set) {
            None if told => Ok(()),
            Some((both, previous_line)) if told && !both.is_nobody() => {
                let sensor = self.sensors.name(both);
                Err(LogError::SecondAtOneTime { place, sensor, time: shown, previous_line })
            }
            _ => {
                let previous = self.clock.show(previous);
                Err(LogError::NotIncreasing { place, time: shown, previous, previous_line })
            }
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
            let idle = |i: &usize| self.spec.readers.get(*i).is_some_and(Option::is_some);
            // Nothing reads an input there, but masked formulas are computed from it.
            (0..self.spec.inputs.len()).filter(idle).for_each(|i| trajectory.u.hold(i));
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
