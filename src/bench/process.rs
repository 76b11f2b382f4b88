//! What the operating system says of this process.

use std::time::Duration;

/// CPU time of all threads of this process so far; `None` where the system does not tell.
#[cfg(unix)]
#[must_use]
pub fn cpu_time() -> Option<Duration> {
    let time = nix::time::clock_gettime(nix::time::ClockId::CLOCK_PROCESS_CPUTIME_ID).ok()?;
    Some(Duration::from(time))
}

/// The largest resident set so far \[MiB\]; `None` where the system does not tell.
#[cfg(unix)]
pub(super) fn peak_memory_mib() -> Option<u64> {
    use nix::sys::resource::{UsageWho, getrusage};
    // Apple counts bytes, every other Unix KiB.
    let unit = if cfg!(target_vendor = "apple") { 1 << 20 } else { 1 << 10 };
    let peak = getrusage(UsageWho::RUSAGE_SELF).ok()?.max_rss();
    u64::try_from(peak).ok().map(|peak| peak / unit)
}

/// CPU time of all threads of this process so far; `None` where the system does not tell.
#[cfg(not(unix))]
#[must_use]
pub fn cpu_time() -> Option<Duration> {
    None
}

#[cfg(not(unix))]
pub(super) fn peak_memory_mib() -> Option<u64> {
    None
}

#[cfg(all(test, unix))]
mod tests {
    use super::*;

    #[test]
    fn cpu_time_grows_with_work() {
        let start = cpu_time().unwrap();
        let mut x = 1.0_f64;
        (0..2_000_000).for_each(|_| x = std::hint::black_box(x * 1.000_001));
        let spent = cpu_time().unwrap() - start;
        // Two million dependent products take at least 1 ms at any clock rate below 6 GHz.
        assert!(x > 1.0 && spent > Duration::from_micros(500), "{spent:?}");
    }

    #[test]
    fn a_test_process_holds_between_one_mebibyte_and_one_tebibyte() {
        let peak = peak_memory_mib().unwrap();
        assert!((1..1 << 20).contains(&peak), "{peak} MiB");
    }
}
