//! Ctrl-C: the first asks the study to stop and keeps the best so far, the second ends the process.

use std::process;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of a process ended by SIGINT, as shells report it.
const INTERRUPTED: i32 = 130;

/// A flag that the first Ctrl-C sets.
///
/// # Errors
/// If the handler cannot be installed.
pub(super) fn flag() -> anyhow::Result<Arc<AtomicBool>> {
    let stop = Arc::new(AtomicBool::new(false));
    let seen = Arc::clone(&stop);
    ctrlc::set_handler(move || {
        if seen.swap(true, Ordering::SeqCst) {
            process::exit(INTERRUPTED);
        }
    })?;
    Ok(stop)
}
