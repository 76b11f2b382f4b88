//! Output files, written whole or not at all: under a temporary name in the same folder, then renamed.

use std::fs::{self, File, OpenOptions};
use std::io::{self, BufRead as _, BufReader, BufWriter, Read as _, Write};
use std::path::{Path, PathBuf};

use anyhow::Context as _;

use super::aside;
use super::console::Console;

/// Where a verb's table goes: a file, or standard output.
#[derive(Debug)]
pub(super) enum Destination {
    Stdout,
    File {
        path: PathBuf,
        /// Whether a file that is there already is kept under a number.
        keeps: bool,
    },
}

impl Destination {
    /// `None` and `-` mean standard output. A file's folder is tried at once, so that nothing is lost at the end.
    pub(super) fn prepare(out: Option<&Path>) -> anyhow::Result<Self> {
        match out {
            None => Ok(Self::Stdout),
            Some(path) if path == Path::new("-") => Ok(Self::Stdout),
            Some(path) => {
                prepare_file(path)?;
                Ok(Self::File { path: path.to_path_buf(), keeps: false })
            }
        }
    }

    /// Decides about a file that is there already, before the work starts: unless `force` lets it be replaced, a table (by
    /// its name, or with the columns of `header`) will be kept under a number, and any other file is refused.
    pub(super) fn respect(&mut self, header: &[u8], force: bool) -> anyhow::Result<()> {
        let Self::File { path, keeps } = self else { return Ok(()) };
        if force || !path.exists() || is_stream(path) {
            return Ok(());
        }
        let mut first = Vec::new();
        let limit = header.len() as u64 + 2;
        let file = File::open(&*path).with_context(|| format!("cannot read {}", path.display()))?;
        BufReader::new(file.take(limit)).read_until(b'\n', &mut first)?;
        anyhow::ensure!(
            path.extension().is_some_and(|e| e.eq_ignore_ascii_case("csv"))
                || first.trim_ascii() == header.trim_ascii(),
            "{} exists and is no earlier table of these columns (choose another name, or give --force to replace it)",
            path.display()
        );
        *keeps = true;
        Ok(())
    }

    /// Writes the table.
    pub(super) fn write(
        &self,
        console: Console,
        fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>,
    ) -> anyhow::Result<()> {
        match self {
            Self::File { path, keeps } => {
                let mut kept = None;
                write_whole(path, |out| {
                    fill(out)?;
                    // Not before the new one is whole.
                    out.flush()?;
                    kept = keeps.then(|| keep(path)).transpose()?;
                    Ok(())
                })?;
                kept.iter().for_each(|kept| {
                    console.note(format_args!("kept the earlier {} as {}", path.display(), kept.display()))
                });
                Ok(())
            }
            Self::Stdout => {
                let mut out = BufWriter::new(Watched { out: io::stdout().lock(), failure: None });
                let written = fill(&mut out).and_then(|()| Ok(out.flush()?));
                // Table writers wrap the error in their own; what it was must not be lost.
                let failure = out.get_ref().failure;
                failure.map_or(written, |kind| Err(io::Error::from(kind)).context(STDOUT))
            }
        }
    }
}

/// The first line that `fill` writes, which is then stopped.
pub(super) fn first_line(fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>) -> Vec<u8> {
    let mut line = FirstLine(Vec::new());
    // It ends with an error of ours, or has written no line.
    let _ = fill(&mut line);
    let end = line.0.iter().position(|byte| *byte == b'\n').unwrap_or(line.0.len());
    line.0.truncate(end);
    line.0
}

struct FirstLine(Vec<u8>);

impl Write for FirstLine {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        if self.0.contains(&b'\n') {
            return Err(io::Error::other("a line is enough"));
        }
        self.0.extend_from_slice(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

/// What is said when standard output fails.
const STDOUT: &str = "cannot write to standard output";

/// Remembers why writing failed.
struct Watched<W> {
    out: W,
    failure: Option<io::ErrorKind>,
}

impl<W> Watched<W> {
    fn watch<T>(&mut self, result: io::Result<T>) -> io::Result<T> {
        // An interrupted call is repeated by the writers above.
        let kind = result.as_ref().err().map(io::Error::kind).filter(|kind| *kind != io::ErrorKind::Interrupted);
        self.failure = self.failure.or(kind);
        result
    }
}

impl<W: Write> Write for Watched<W> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let written = self.out.write(bytes);
        self.watch(written)
    }

    fn flush(&mut self) -> io::Result<()> {
        let flushed = self.out.flush();
        self.watch(flushed)
    }
}

/// Prints a verb's text result on standard output.
pub(super) fn print(text: &str) -> anyhow::Result<()> {
    let end = if text.ends_with('\n') { "" } else { "\n" };
    let mut out = io::stdout().lock();
    write!(out, "{text}{end}").and_then(|()| out.flush()).context(STDOUT)
}

/// Prints exactly one JSON object on standard output.
pub(super) fn print_json(value: &impl serde::Serialize) -> anyhow::Result<()> {
    print(&serde_json::to_string(value)?)
}

/// Writes `path` whole or leaves it as it was. A device or a pipe, such as `/dev/null`, is written to: a file renamed
/// over it would take its place.
pub(super) fn write_whole(path: &Path, fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let written = if is_stream(path) { fill_stream(path, fill) } else { replace(path, fill) };
    written.map_err(|error| {
        // What went wrong while the content was computed speaks for itself.
        let writing = error.is::<io::Error>() || error.is::<csv::Error>();
        if writing { error.context(format!("cannot write {}", path.display())) } else { error }
    })
}

/// Gives a file that is in the way a number; its new name.
fn keep(path: &Path) -> anyhow::Result<PathBuf> {
    let kept = aside::numbered(path)?;
    fs::rename(path, &kept)?;
    Ok(kept)
}

fn replace(path: &Path, fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let name = path.file_name().unwrap_or_default();
    aside::remove_leftovers(folder_of(path), |left| name == left);
    let temporary = temporary_name(path);
    let written = fill_file(&temporary, fill).and_then(|()| Ok(fs::rename(&temporary, path)?));
    if written.is_err() {
        // The first error is the one to report; a temporary file that never came to be cannot be removed either.
        let _ = fs::remove_file(&temporary);
    }
    written
}

/// Whether `path` is there and neither a file nor a folder.
pub(super) fn is_stream(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

fn fill_stream(path: &Path, fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let mut out = BufWriter::new(OpenOptions::new().write(true).open(path)?);
    fill(&mut out)?;
    Ok(out.flush()?)
}

fn fill_file(path: &Path, fill: impl FnOnce(&mut dyn Write) -> anyhow::Result<()>) -> anyhow::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    fill(&mut out)?;
    out.into_inner().map_err(io::IntoInnerError::into_error)?.sync_all()?;
    Ok(())
}

/// Whether a file can be written here; its folder is tried.
pub(super) fn prepare_file(path: &Path) -> anyhow::Result<()> {
    anyhow::ensure!(!path.is_dir(), "cannot write {}: it is a folder (name a file in it)", path.display());
    if is_stream(path) {
        return Ok(());
    }
    try_writing_in(folder_of(path))
}

pub(super) fn try_writing_in(folder: &Path) -> anyhow::Result<()> {
    let probe = temporary_name(&folder.join("writable"));
    File::create(&probe).with_context(|| {
        format!("cannot write in the folder {} (choose a folder you may write to)", folder.display())
    })?;
    Ok(fs::remove_file(&probe)?)
}

/// The folder of a file.
pub(super) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or_else(|| Path::new("."))
}

/// `.NAME.PROCESS.tmp` beside `path`: the same file system, so that renaming is one step.
fn temporary_name(path: &Path) -> PathBuf {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    folder_of(path).join(format!(".{name}.{}.tmp", std::process::id()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_the_old_file_and_no_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("result.json");
        write_whole(&path, |out| Ok(out.write_all(b"old")?)).unwrap();
        let failed = write_whole(&path, |out| {
            out.write_all(b"half of the n")?;
            anyhow::bail!("interrupted")
        });
        assert!(failed.is_err(), "{failed:?}");
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "the temporary file is gone");
    }

    #[test]
    fn a_table_under_a_file_is_refused_before_work_starts() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = Destination::prepare(Some(&file.path().join("out.csv"))).unwrap_err();
        assert!(error.to_string().starts_with("cannot write in the folder"), "{error}");
    }

    #[cfg(unix)]
    #[test]
    fn a_pipe_is_written_to_and_not_replaced() {
        use std::os::unix::fs::FileTypeExt as _;
        let folder = tempfile::tempdir().unwrap();
        let pipe = folder.path().join("pipe");
        assert!(std::process::Command::new("mkfifo").arg(&pipe).status().unwrap().success());
        let reader = std::thread::spawn({
            let pipe = pipe.clone();
            move || fs::read_to_string(pipe).unwrap()
        });
        let mut destination = Destination::prepare(Some(&pipe)).unwrap();
        destination.respect(b"t,z", false).unwrap();
        destination.write(Console::new(true), |out| Ok(out.write_all(b"rows")?)).unwrap();
        assert_eq!(reader.join().unwrap(), "rows");
        assert!(fs::metadata(&pipe).unwrap().file_type().is_fifo(), "it is still a pipe");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1, "no other file is left");
    }

    #[test]
    fn a_table_is_kept_and_any_other_file_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("run.csv");
        let write = |rows: &'static str, force| {
            let mut destination = Destination::prepare(Some(&path)).unwrap();
            let header = first_line(|out| Ok(out.write_all(rows.as_bytes())?));
            destination.respect(&header, force)?;
            destination.write(Console::new(true), |out| Ok(out.write_all(rows.as_bytes())?))
        };
        let read = |name: &str| fs::read_to_string(folder.path().join(name)).unwrap();
        write("t,z\n0,1\n", false).unwrap();
        write("t,z\n0,2\n", false).unwrap();
        write("t,z\n0,3\n", false).unwrap();
        assert_eq!(["run.csv.1", "run.csv.2", "run.csv"].map(read), ["t,z\n0,1\n", "t,z\n0,2\n", "t,z\n0,3\n"]);
        write("t,z\n0,4\n", true).unwrap();
        assert_eq!((read("run.csv").as_str(), fs::read_dir(folder.path()).unwrap().count()), ("t,z\n0,4\n", 3));
        write("t,z,more\n0,1,2\n", false).unwrap();
        assert_eq!(
            ["run.csv.3", "run.csv"].map(read),
            ["t,z\n0,4\n", "t,z,more\n0,1,2\n"],
            "columns of another problem"
        );

        let path = folder.path().join("notes");
        let write = |rows: &[u8]| {
            let mut destination = Destination::prepare(Some(&path)).unwrap();
            destination.respect(b"t,z", false)?;
            destination.write(Console::new(true), |out| Ok(out.write_all(rows)?))
        };
        write(b"t,z\n").unwrap();
        write(b"t,z\n0,1\n").unwrap();
        assert_eq!(["notes.1", "notes"].map(read), ["t,z\n", "t,z\n0,1\n"]);
        fs::write(&path, "mine").unwrap();
        let refused = write(b"t,z\n").unwrap_err().to_string();
        assert!(refused.contains("notes exists and is no earlier table of these columns"), "{refused}");
        assert_eq!(read("notes"), "mine");
    }

    #[test]
    fn a_folder_is_no_destination() {
        let folder = tempfile::tempdir().unwrap();
        let error = Destination::prepare(Some(folder.path())).unwrap_err();
        assert!(error.to_string().contains("it is a folder"), "{error}");
    }
}
