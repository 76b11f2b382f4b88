//! Which column of the header plays which role of `[data]`.

use super::{DataSpec, LogError, Rows};

/// Positions in the header of the columns that `[data]` names.
pub(super) struct Columns {
    pub(super) time: Option<usize>,
    pub(super) trajectory: Option<usize>,
    /// One a measurement; sensors may share some.
    pub(super) measurements: Vec<usize>,
    /// The column that says which sensor a row is of.
    pub(super) sensor: Option<usize>,
    pub(super) inputs: Vec<usize>,
    pub(super) truth: Vec<usize>,
}

/// A role and the column it is given to.
struct Use<'a> {
    role: String,
    column: &'a str,
}

impl Columns {
    pub(super) fn of(spec: &DataSpec, rows: &Rows<'_>) -> Result<Self, LogError> {
        refuse_double_use(spec)?;
        let find = |role: &str, column: &str| find(rows, role, column);
        let all = |role: &str, names: &[&str]| names.iter().map(|name| find(role, name)).collect::<Result<_, _>>();
        let inputs: Vec<&str> = spec.inputs.iter().map(String::as_str).collect();
        Ok(Self {
            time: spec.time.as_deref().map(|name| find("time", name)).transpose()?,
            trajectory: spec.trajectory.as_deref().map(|name| find("trajectory", name)).transpose()?,
            measurements: all("a measurement", &spec.columns())?,
            sensor: spec.sensor.as_deref().map(|name| find("the sensor of a row", name)).transpose()?,
            inputs: all("an input", &inputs)?,
            truth: spec
                .truth
                .iter()
                .map(|(state, column)| find(&truth_role(state), column))
                .collect::<Result<_, _>>()?,
        })
    }
}

fn truth_role(state: &str) -> String {
    format!("truth of state {state:?}")
}

fn refuse_double_use(spec: &DataSpec) -> Result<(), LogError> {
    let named = |role: &str, column| Use { role: role.to_owned(), column };
    let mut uses: Vec<Use<'_>> = Vec::new();
    uses.extend(spec.time.as_deref().map(|c| named("time", c)));
    uses.extend(spec.trajectory.as_deref().map(|c| named("trajectory", c)));
    uses.extend(spec.sensor.as_deref().map(|c| named("the sensor of a row", c)));
    for column in spec.columns() {
        // Sensors may share a column of measurements.
        if spec.sensors.is_empty() || !uses.iter().any(|u| u.column == column && u.role == "a measurement") {
            uses.push(named("a measurement", column));
        }
    }
    uses.extend(spec.inputs.iter().map(|c| named("an input", c)));
    uses.extend(spec.truth.iter().map(|(state, c)| named(&truth_role(state), c)));
    for (i, later) in uses.iter().enumerate() {
        if let Some(earlier) = uses[..i].iter().find(|u| u.column == later.column) {
            let (first, second) = (earlier.role.as_str().into(), later.role.as_str().into());
            return Err(LogError::UsedTwice { column: later.column.into(), first, second });
        }
    }
    Ok(())
}

fn find(rows: &Rows<'_>, role: &str, column: &str) -> Result<usize, LogError> {
    let position = rows.names().iter().position(|name| name == column && !name.is_empty());
    position.ok_or_else(|| {
        let place = rows.header_place();
        if rows.header_is_numbers() {
            return LogError::NoHeader { place };
        }
        let nearest = nearest(column, rows.names()).map(|name| format!(" (did you mean {name:?}?)"));
        let blanks = matches!(rows.names(), [only] if only.contains([' ', '\t']));
        let blanks = blanks.then(|| " (cells parted by blanks need separator = \" \" in [data])".to_owned());
        LogError::NoColumn {
            place,
            column: column.into(),
            role: role.into(),
            nearest: blanks.or(nearest).unwrap_or_default().into(),
            present: list(rows.names()).into(),
        }
    })
}

/// The name most like `wanted`, if any is like it at all.
pub(super) fn nearest<'a>(wanted: &str, names: &'a [String]) -> Option<&'a str> {
    let wanted = wanted.to_lowercase();
    let likeness = |name: &String| strsim::jaro_winkler(&wanted, &name.to_lowercase());
    let best = names.iter().max_by(|a, b| likeness(a).total_cmp(&likeness(b)))?;
    (likeness(best) > 0.7).then_some(best)
}

/// The first names, quoted, and how many more there are.
fn list(names: &[String]) -> String {
    const SHOWN: usize = 20;
    let shown: Vec<String> = names.iter().take(SHOWN).map(|name| format!("{name:?}")).collect();
    let more = names.len().saturating_sub(SHOWN);
    let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
    shown.join(", ") + &rest
}
