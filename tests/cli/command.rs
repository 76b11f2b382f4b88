//! Runs the built binary in a folder of its own.

use std::fs;
use std::io::Write as _;
use std::path::PathBuf;
use std::process::{Child, Command, Output, Stdio};

use serde_json::Value;
use tempfile::TempDir;

/// A temporary folder with the files of one test.
pub(crate) struct Folder(TempDir);

/// What a finished process left.
#[derive(Debug)]
pub(crate) struct Finished {
    pub(crate) code: i32,
    pub(crate) stdout: String,
    pub(crate) stderr: String,
}

impl Folder {
    pub(crate) fn new() -> Self {
        Self(TempDir::new().unwrap())
    }

    /// A folder with `problem.toml` and `log.csv`: a local level seen through noise.
    pub(crate) fn with_level() -> Self {
        let folder = Self::new();
        folder.write("problem.toml", LEVEL);
        folder.write("log.csv", level_log(60));
        folder
    }

    pub(crate) fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    pub(crate) fn write(&self, name: &str, content: impl AsRef<[u8]>) {
        fs::write(self.path(name), content).unwrap();
    }

    pub(crate) fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).unwrap_or_else(|e| panic!("{name}: {e}"))
    }

    pub(crate) fn names(&self, folder: &str) -> Vec<String> {
        let entries = fs::read_dir(self.path(folder)).unwrap();
        let mut names: Vec<String> = entries.map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    pub(crate) fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_kfgpu"));
        command.args(arguments).current_dir(self.0.path()).env_remove("RUST_BACKTRACE");
        command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::piped());
        command
    }

    pub(crate) fn spawn(&self, arguments: &[&str]) -> Child {
        self.command(arguments).stdin(Stdio::piped()).spawn().unwrap()
    }

    pub(crate) fn run(&self, arguments: &[&str]) -> Finished {
        self.command(arguments).output().unwrap().into()
    }

    pub(crate) fn run_with_input(&self, arguments: &[&str], input: impl AsRef<[u8]>) -> Finished {
        let mut child = self.spawn(arguments);
        // The process may refuse its input early; what it says then is what the test is about.
        let _ = child.stdin.take().unwrap().write_all(input.as_ref());
        child.wait_with_output().unwrap().into()
    }
}

impl From<Output> for Finished {
    fn from(output: Output) -> Self {
        Self {
            code: output.status.code().unwrap_or(-1),
            stdout: String::from_utf8(output.stdout).unwrap(),
            stderr: String::from_utf8(output.stderr).unwrap(),
        }
    }
}

impl Finished {
    /// Fails the test unless the process ended with `code`.
    pub(crate) fn expect(self, code: i32) -> Self {
        assert_eq!(self.code, code, "stdout: {}\nstderr: {}", self.stdout, self.stderr);
        self
    }

    /// The one JSON object on stdout.
    pub(crate) fn json(&self) -> Value {
        assert_eq!(self.stdout.trim_end().lines().count(), 1, "one line: {}", self.stdout);
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}: {}", self.stdout))
    }

    /// The rows of a CSV table on stdout, with its header.
    pub(crate) fn table(&self) -> Vec<Vec<String>> {
        self.stdout.lines().map(|line| line.split(',').map(str::to_owned).collect()).collect()
    }

    /// One error sentence on stderr, nothing on stdout, no panic; gives the sentence.
    pub(crate) fn refusal(self) -> String {
        let this = self.expect(2);
        assert_eq!(this.stdout, "", "nothing is written on stdout");
        assert!(!this.stderr.contains("panicked"), "{}", this.stderr);
        let errors: Vec<&str> = this.stderr.lines().filter(|l| l.starts_with("error: ")).collect();
        assert_eq!(errors.len(), 1, "{}", this.stderr);
        assert!(errors[0].len() < 600, "a sentence of {} characters: {}", errors[0].len(), errors[0]);
        errors[0].trim_start_matches("error: ").to_owned()
    }
}

/// What `tune --out` leaves of a study of one objective.
pub(crate) const RUN_FILES: [&str; 6] =
    ["checkpoint.kfgpu", "figures", "history.csv", "report.md", "result.json", "tuned.toml"];

pub(crate) const LEVEL: &str = r#"
[data]
file = "log.csv"
time = "t"
measurements = ["z"]

[model]
state = ["x"]
f = ["x"]
h = ["x"]
Q = { x = "q" }
R = { z = "r" }
x0 = [0]
P0 = [1e4]

[parameters]
q = { min = 1e-3, max = 1e2, scale = "log", start = 1, unit = "m^2" }
r = { min = 1e-3, max = 1e2, scale = "log", start = 50 }

[tune]
algorithm = "pso"
objectives = ["nll"]
population = 16
generations = 10
seed = 7
"#;

/// A slow wave and a fast pattern that stands for noise; the same in every run.
pub(crate) fn level_log(rows: u32) -> String {
    let mut text = String::from("t,z\n");
    for k in 0..rows {
        let t = f64::from(k);
        let noise = f64::from(k * 7919 % 13) - 6.0;
        text += &format!("{t},{:.6}\n", 10.0 * (t / 15.0).sin() + 0.4 * noise);
    }
    text
}
