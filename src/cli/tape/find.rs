//! What is to be looked at: a candidate, a trajectory, a row.

use anyhow::{Context as _, bail, ensure};

use crate::data::Log;
use crate::model::{Problem, Start};
use crate::words::{counted, listed, shorten};

/// The start values with those that `--candidate` names in their place.
pub(super) fn candidate(problem: &Problem, named: &[String]) -> anyhow::Result<Vec<f64>> {
    let (mut candidate, names) = (problem.parameters.baseline(), problem.parameters.names());
    for pair in named {
        let given = shorten(pair);
        let (name, value) =
            pair.split_once('=').with_context(|| format!("--candidate has `{given}`, expected NAME=VALUE"))?;
        let (name, value) = (name.trim(), value.trim());
        let Some(place) = names.iter().position(|known| *known == name) else {
            let (name, names) = (shorten(name), listed(&names));
            bail!("--candidate names `{name}`, expected one of the searched parameters: {names}");
        };
        let number = value.parse().ok().filter(|value: &f64| value.is_finite());
        candidate[place] = number.with_context(|| format!("--candidate has `{given}`, expected a finite number"))?;
    }
    Ok(candidate)
}

/// Which trajectory is called so; the first without a name.
pub(super) fn trajectory(log: &Log, name: Option<&str>) -> anyhow::Result<usize> {
    let Some(name) = name else { return Ok(0) };
    let place = log.trajectories.iter().position(|trajectory| trajectory.id == name);
    place.with_context(|| {
        let (source, name) = (&log.source, shorten(name));
        let ids: Vec<&str> = log.trajectories.iter().map(|t| &*t.id).filter(|id| !id.is_empty()).collect();
        if ids.is_empty() {
            return format!("--trajectory is `{name}`, but {source} has no trajectory column (leave it out)");
        }
        format!("--trajectory is `{name}`, expected one of those of {source}: {}", listed(ids))
    })
}

/// The first row of trajectory `t` that the filter uses, where `row` is one of those.
pub(super) fn first_row(problem: &Problem, log: &Log, t: usize, row: usize) -> anyhow::Result<usize> {
    let trajectory = &log.trajectories[t];
    let rows = trajectory.len();
    let source = &log.source;
    let of =
        if trajectory.id.is_empty() { source.clone() } else { format!("trajectory `{}`", shorten(&trajectory.id)) };
    ensure!(row < rows, "--row is {row}, but {of} has {}: expected 0 to {}", counted(rows, "row"), rows.max(1) - 1);
    if problem.model.x0 != Start::Measurement {
        return Ok(0);
    }
    let first = (0..rows).find(|k| trajectory.is_complete(*k));
    let first =
        first.with_context(|| format!("{of} has no complete measurement, from which the filter would start"))?;
    ensure!(
        row >= first,
        "--row is {row}, but the filter starts from the first complete measurement of {of}: expected {first} to {}",
        rows - 1
    );
    Ok(first)
}
