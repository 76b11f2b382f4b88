//! The time column of a draft: what it counts, and what is said where there is none.

use super::names::{names_a_time, unit_of_time, unit_of_time_column};
use super::roles::Roles;
use super::survey::{Content, Survey};
use crate::data::{DataSpec, Log, LogError, TimeUnit};

/// The unit of the time column, with the reason; `None` where it is seconds.
pub(super) fn guess_unit(
    survey: &Survey,
    roles: &Roles,
    units: &[String],
    data: &DataSpec,
    text: &[u8],
) -> Option<(TimeUnit, String)> {
    let i = roles.time?;
    let column = &survey.columns[i];
    match column.content {
        Content::Instants(_) => of_dates(column.dates, data, text),
        _ => of_numbers(&column.name, units.get(i).map(String::as_str), column.values.first().copied()?),
    }
}

fn of_numbers(name: &str, units_row: Option<&str>, first: f64) -> Option<(TimeUnit, String)> {
    let row = units_row.and_then(|unit| unit_of_time(&unit.to_lowercase()));
    let named = row.map(|unit| (unit, "as the row of units says".to_owned()));
    let named = named.or_else(|| unit_of_time_column(name).map(|unit| (unit, "as its name says".to_owned())));
    let sized = TimeUnit::of_epoch(first).filter(|unit| unit.decimals() > 0);
    match (named, sized) {
        // Seconds of this size would be of another age.
        (Some((TimeUnit::Second, _)) | None, Some(unit)) => Some((unit, format!("as the size of {first} suggests"))),
        (Some((TimeUnit::Second, _)), _) => None,
        (named, _) => named,
    }
}

/// Dates without a time of day count days, or months and years where they are so far apart and fit the calendar.
fn of_dates(dates: bool, data: &DataSpec, text: &[u8]) -> Option<(TimeUnit, String)> {
    let read = |unit| Log::read(&DataSpec { time_unit: Some(unit), ..data.clone() }, text, "").ok().filter(|_| dates);
    let steps =
        |log: Log| -> Vec<f64> { log.trajectories.iter().flat_map(|t| (0..t.len()).filter_map(|k| t.dt(k))).collect() };
    let are_long = steps(read(TimeUnit::Day)?).iter().all(|days| *days >= 28.0);
    let unit = match read(TimeUnit::Month).map(steps).filter(|months| are_long && !months.is_empty()) {
        Some(months) if months.iter().all(|months| months % 12.0 == 0.0) => TimeUnit::Year,
        Some(_) => TimeUnit::Month,
        None => TimeUnit::Day,
    };
    Some((unit, "as its dates suggest".to_owned()))
}

/// A time that cannot be read is an error where no other column is a time.
pub(super) fn refuse_unreadable(survey: &Survey, roles: &Roles) -> Result<(), LogError> {
    if roles.time.is_some_and(|_| !roles.time_by_content) {
        return Ok(());
    }
    let named = survey.columns.iter().find(|c| names_a_time(&c.name) && !c.odd.is_empty());
    let named = named.and_then(|column| Some((column, column.odd.first()?)));
    let looks = || survey.columns.iter().find_map(|column| Some((column, column.unreadable_time()?)));
    let Some((column, odd)) = named.or_else(looks) else { return Ok(()) };
    Err(LogError::not_a_time(odd.place.clone(), &column.name, &odd.text))
}

/// What is said about the time: its unit, that it is none, or that it was chosen by content.
pub(super) fn say(survey: &Survey, roles: &Roles, unit: Option<&(TimeUnit, String)>) -> Option<String> {
    if let Some(stop) = &roles.false_time {
        let name = &survey.columns[stop.column].name;
        return Some(format!(
            "column {name:?} cannot be the time, because it {} at line {}: the draft counts rows 0, 1, 2, ... s instead; \
             {}",
            stop.how,
            stop.line,
            remedy(stop.how)
        ));
    }
    let name = &survey.columns[roles.time?].name;
    match unit {
        Some((unit, why)) if unit.decimals() > 0 => {
            Some(format!("column {name:?} is read in {}, {why} (time_unit = \"{0}\"): dt is in seconds", unit.name()))
        }
        Some((unit, why)) => Some(format!(
            "column {name:?} counts {}, {why} (time_unit = \"{}\"): dt and all rates are per {1}",
            unit.after(2.0),
            unit.name()
        )),
        None if roles.time_by_content => Some(format!(
            "column {name:?} is taken for the time in seconds, because it is the first that increases: check `time`"
        )),
        None => None,
    }
}

/// What to do about a time that does not increase.
pub(super) fn remedy(how: &str) -> &'static str {
    match how {
        "goes back" => "sort the rows by it, or name the column that tells pooled runs apart (trajectory)",
        "stands still" => {
            "log finer times, merge rows of one instant, or name the column that tells pooled runs apart (trajectory)"
        }
        _ => "fill the cell or delete the row",
    }
}
