//! Whether what is asked for fits in memory. Sizes are known before the work starts, so that a process need not be ended
//! by the system in the middle of it.

use anyhow::bail;

use crate::data::Log;
use crate::model::{Problem, SimulateSpec, TuneSpec};
use crate::words::counted;

/// Memory that the process may still take.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Room {
    bytes: f64,
    /// Who sets the limit.
    by: &'static str,
}

/// Refuses what takes more than there is: `what` names it, `remedy` says what to do. `bytes` should be what it takes at
/// least, so that nothing is refused that would have run.
pub(super) fn ensure_fits(what: &str, bytes: f64, remedy: &str) -> anyhow::Result<()> {
    match room() {
        Some(room) if bytes > room.bytes => bail!(
            "{what} at least {} of memory, and this process may take {} more ({}): {remedy}",
            size(bytes),
            size(room.bytes),
            room.by
        ),
        _ => Ok(()),
    }
}

/// Refuses a log that `[simulate]` makes too long.
pub(super) fn ensure_log_fits(problem: &Problem) -> anyhow::Result<()> {
    let Some(SimulateSpec { steps, trajectories, .. }) = &problem.simulate else { return Ok(()) };
    let rows = (*steps as f64 + 1.0) * *trajectories as f64;
    let numbers = problem.model.states.len() + problem.model.measurements.len();
    // Truth and measurements, the time, and the number of the line.
    let bytes = rows * 8.0 * (numbers as f64 + 2.0);
    let times = if *trajectories == 1 { String::new() } else { format!(" in {trajectories} trajectories") };
    let what = format!("[simulate] steps = {steps}{times} takes");
    ensure_fits(&what, bytes, "take fewer steps or trajectories")
}

/// Refuses a population that is too large for its optimiser.
pub(super) fn ensure_population_fits(problem: &Problem) -> anyhow::Result<()> {
    let TuneSpec { algorithm, population, objectives, .. } = &problem.tune;
    // Positions as the optimiser has them and as they are scored; those with a memory have also velocities, the best of
    // each and the generation before: in all 5.4 copies were measured of pio, 5.6 of pso, 13 of nsga2, and a quarter more
    // comes and goes.
    let copies = match algorithm.as_str() {
        "random" => 2.0,
        name if name.starts_with("nsga2") => 13.0,
        _ => 7.0,
    };
    let numbers = copies * problem.parameters.dimension() as f64 + objectives.len() as f64 + 1.0;
    let what = format!("a population of {population} takes");
    ensure_fits(&what, *population as f64 * 8.0 * numbers, "take a smaller population")
}

/// Refuses to smooth a log that is too long.
pub(super) fn ensure_smoother_fits(problem: &Problem, log: &Log) -> anyhow::Result<()> {
    let (n, m) = (problem.model.states.len() as f64, problem.model.measurements.len() as f64);
    // A row keeps x, P and the update (innovation, S, K), each in an allocation of its own.
    let bytes = 8.0 * (n + n * n + m + m * m + n * m) + 440.0;
    let states = counted(problem.model.states.len(), "state");
    let what = format!("smoothing {} of {states} takes", counted(log.rows(), "row"));
    ensure_fits(&what, log.rows() as f64 * bytes, "leave out --smooth, or take a part of the log")
}

/// Bytes in the unit that people use.
fn size(bytes: f64) -> String {
    let (value, unit) = if bytes >= 1e9 { (bytes / 1e9, "GB") } else { (bytes / 1e6, "MB") };
    format!("{value:.1} {unit}")
}

/// The tightest of the limits that can be read; `None` where none can.
fn room() -> Option<Room> {
    let all = [address_space(), free(), container()];
    all.into_iter().flatten().min_by(|a, b| a.bytes.total_cmp(&b.bytes))
}

/// `ulimit -v`, less what the process has mapped already.
#[cfg(target_os = "linux")]
fn address_space() -> Option<Room> {
    use nix::sys::resource::{RLIM_INFINITY, Resource, getrlimit};
    let (limit, _) = getrlimit(Resource::RLIMIT_AS).ok()?;
    let mapped = of_key(&read("/proc/self/status")?, "VmSize:")?;
    (limit != RLIM_INFINITY).then(|| Room { bytes: (limit as f64 - mapped).max(0.0), by: "by ulimit -v" })
}

#[cfg(not(target_os = "linux"))]
const fn address_space() -> Option<Room> {
    None
}

/// What the machine has free, with what it can swap out.
fn free() -> Option<Room> {
    let known = read("/proc/meminfo")?;
    let bytes = of_key(&known, "MemAvailable:")? + of_key(&known, "SwapFree:").unwrap_or(0.0);
    Some(Room { bytes, by: "what this machine has free" })
}

/// The limit of a container or a job, in either version of cgroups, less what cannot be given back.
fn container() -> Option<Room> {
    let places = read("/proc/self/cgroup")?;
    let own = |place: &str| {
        let (controllers, path) = place.split_once(':')?.1.split_once(':')?;
        match controllers {
            "" => Some((format!("/sys/fs/cgroup{path}"), "memory.max", "anon ")),
            _ if controllers.split(',').any(|c| c == "memory") => {
                Some((format!("/sys/fs/cgroup/memory{path}"), "memory.limit_in_bytes", "rss "))
            }
            _ => None,
        }
    };
    let outside = [
        ("/sys/fs/cgroup".to_owned(), "memory.max", "anon "),
        ("/sys/fs/cgroup/memory".to_owned(), "memory.limit_in_bytes", "rss "),
    ];
    // Inside a container its own group is the root of what it sees.
    let rooms = places.lines().filter_map(own).chain(outside).filter_map(|(folder, limit, used)| {
        let limit: f64 = read(&format!("{folder}/{limit}"))?.trim().parse().ok()?;
        let used = read(&format!("{folder}/memory.stat")).and_then(|stat| bytes_of(&stat, used)).unwrap_or(0.0);
        Some(Room { bytes: (limit - used).max(0.0), by: "by the limit of its cgroup" })
    });
    rooms.min_by(|a, b| a.bytes.total_cmp(&b.bytes))
}

fn read(path: &str) -> Option<String> {
    std::fs::read_to_string(path).ok()
}

/// The value of `key`, which /proc gives in kB.
fn of_key(text: &str, key: &str) -> Option<f64> {
    bytes_of(text, key).map(|kilobytes| 1024.0 * kilobytes)
}

fn bytes_of(text: &str, key: &str) -> Option<f64> {
    text.lines().find_map(|line| line.strip_prefix(key))?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_read_and_said() {
        let text = "VmPeak:\t 9 kB\nVmSize:\t  2048 kB\nanon 512\n";
        assert_eq!(
            (of_key(text, "VmSize:"), bytes_of(text, "anon "), of_key(text, "No:")),
            (Some(2_097_152.0), Some(512.0), None)
        );
        assert_eq!((size(3.24e9).as_str(), size(5.0e6).as_str()), ("3.2 GB", "5.0 MB"));
    }

    #[test]
    fn what_no_machine_has_is_refused_and_what_every_one_has_is_not() {
        assert!(ensure_fits("a byte", 1.0, "").is_ok());
        if room().is_some() {
            let refused = ensure_fits("[simulate] steps = 9 takes", 1e18, "take fewer rows").unwrap_err().to_string();
            assert!(
                refused.starts_with("[simulate] steps = 9 takes at least 1000000000.0 GB of memory, and"),
                "{refused}"
            );
            assert!(refused.ends_with("): take fewer rows"), "{refused}");
        }
    }
}
