//! Signals that ask a study to end: Ctrl-C (SIGINT), SIGTERM of schedulers, containers and CI, SIGHUP of a lost
//! terminal. The first keeps the best so far, the second ends the process.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicI32, Ordering};

/// Signals of this process, from the moment it listens.
#[derive(Debug, Clone, Default)]
pub(super) struct Interrupt {
    stop: Arc<AtomicBool>,
    /// Whether there is a study that could keep anything.
    studying: Arc<AtomicBool>,
    signal: Arc<AtomicI32>,
}

impl Interrupt {
    /// Listens. Until [`Self::flag`] is asked for, a signal ends the process as it would without.
    ///
    /// It must come before any thread is started: on Unix a signal goes to whatever thread does not block it.
    ///
    /// # Errors
    /// If the system refuses.
    pub(super) fn listen() -> anyhow::Result<Self> {
        let interrupt = Self::default();
        let heard = interrupt.clone();
        listen(move |signal| heard.hear(signal))?;
        Ok(interrupt)
    }

    /// A flag that the first signal sets.
    pub(super) fn flag(&self) -> Arc<AtomicBool> {
        self.studying.store(true, Ordering::SeqCst);
        Arc::clone(&self.stop)
    }

    /// Exit code of a study that a signal has ended: 128 and its number, as shells report it.
    pub(super) fn exit_code(&self) -> u8 {
        u8::try_from(128 + self.signal.load(Ordering::SeqCst)).unwrap_or(u8::MAX)
    }

    fn hear(&self, signal: i32) {
        let is_first = !self.stop.swap(true, Ordering::SeqCst);
        self.signal.store(signal, Ordering::SeqCst);
        if !(is_first && self.studying.load(Ordering::SeqCst)) {
            process::exit(self.exit_code().into());
        }
    }
}

/// A thread that waits for the signals, which all others block: it may do what a signal handler may not.
#[cfg(unix)]
fn listen(heard: impl Fn(i32) + Send + 'static) -> anyhow::Result<()> {
    use nix::sys::signal::{SigSet, Signal};
    let mut signals = SigSet::empty();
    signals.add(Signal::SIGINT);
    signals.add(Signal::SIGTERM);
    if !ignores_hangup() {
        signals.add(Signal::SIGHUP);
    }
    signals.thread_block()?;
    let wait = move || {
        while let Ok(signal) = signals.wait() {
            heard(signal as i32);
        }
    };
    std::thread::Builder::new().name("signals".to_owned()).spawn(wait)?;
    Ok(())
}

/// Whether whoever started the process lets it live on without its terminal, as `nohup` does. A blocked signal arrives
/// even where it is ignored. Where that cannot be read, it is taken to be so, and SIGHUP stays what it is.
#[cfg(unix)]
fn ignores_hangup() -> bool {
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    ignored.is_none_or(|mask| mask >> (nix::sys::signal::Signal::SIGHUP as i32 - 1) & 1 == 1)
}

#[cfg(not(unix))]
fn listen(heard: impl Fn(i32) + Send + 'static) -> anyhow::Result<()> {
    const CTRL_C: i32 = 2;
    ctrlc::set_handler(move || heard(CTRL_C))?;
    Ok(())
}
