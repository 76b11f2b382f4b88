//! What graphics drivers print on stderr, and nobody asked for.

#[cfg(unix)]
use std::{
    fs::File,
    io::{self, BufRead as _, BufReader, PipeReader, Write as _},
    os::fd::OwnedFd,
    path::Path,
    thread::JoinHandle,
};

/// What the layer by which Mesa orders its adapters prints wherever there is no desktop.
#[cfg(unix)]
const NO_DESKTOP: &str = "XDG_RUNTIME_DIR is invalid or not set";

/// Does something with graphics drivers, with lines about a desktop that is not there left out of stderr.
#[cfg(unix)]
pub(super) fn without_desktop<T>(work: impl FnOnce() -> T) -> T {
    let has_desktop = std::env::var_os("XDG_RUNTIME_DIR").is_some_and(|folder| Path::new(&folder).is_dir());
    // Where stderr cannot be led elsewhere, the lines stay.
    let _filtered = if has_desktop { None } else { Filtered::new().ok() };
    work()
}

#[cfg(not(unix))]
pub(super) fn without_desktop<T>(work: impl FnOnce() -> T) -> T {
    work()
}

/// Standard error through a pipe, until it is dropped.
#[cfg(unix)]
struct Filtered {
    stderr: OwnedFd,
    filter: Option<JoinHandle<()>>,
}

#[cfg(unix)]
impl Filtered {
    fn new() -> io::Result<Self> {
        let stderr = nix::unistd::dup(io::stderr())?;
        let (lines, into) = io::pipe()?;
        let out = File::from(stderr.try_clone()?);
        let filter = std::thread::Builder::new().name("stderr".to_owned()).spawn(move || pass(lines, out))?;
        nix::unistd::dup2_stderr(into)?;
        Ok(Self { stderr, filter: Some(filter) })
    }
}

#[cfg(unix)]
impl Drop for Filtered {
    fn drop(&mut self) {
        // With it goes the last end of the pipe that is written to, so that the filter ends.
        if nix::unistd::dup2_stderr(&self.stderr).is_ok()
            && let Some(filter) = self.filter.take()
        {
            let _ = filter.join();
        }
    }
}

#[cfg(unix)]
fn pass(lines: PipeReader, mut out: File) {
    for line in BufReader::new(lines).split(b'\n').map_while(Result::ok) {
        if !String::from_utf8_lossy(&line).contains(NO_DESKTOP) {
            let _ = out.write_all(&[&line[..], b"\n"].concat());
        }
    }
}
