//! What a measurement found: one JSON object for programs, a short table for people.

use std::fmt;

/// Filter-steps per second (one step = one candidate over one row), with what is needed to compare it with another
/// program: the field names are those of a common harness that other libraries print too. Times are in seconds.
#[derive(Debug, Clone, PartialEq, serde::Serialize)]
pub struct Report {
    /// Always `kfgpu`.
    pub peer: &'static str,
    /// Letter of the workload, or name of the problem file.
    pub workload: String,
    /// `f64` or `f32`.
    pub dtype: String,
    /// Candidates.
    #[serde(rename = "N")]
    pub candidates: usize,
    /// Rows, over all trajectories.
    #[serde(rename = "T")]
    pub rows: usize,
    /// Median time of an evaluation of all candidates.
    pub median_s: f64,
    /// Least time of an evaluation.
    pub min_s: f64,
    /// Median CPU time of an evaluation, all threads together; null where the system does not tell.
    pub cpu_s: Option<f64>,
    /// Timed evaluations.
    pub reps: usize,
    /// N T / `median_s`.
    pub steps_per_s: f64,
    /// N T / `cpu_s`.
    pub steps_per_cpu_s: Option<f64>,
    /// Time to trace the filter and prepare the log.
    pub compile_s: f64,
    /// `compile_s` plus the first evaluation.
    pub first_call_s: f64,
    /// N T / `first_call_s`.
    pub steps_per_s_incl_compile: f64,
    /// Log-likelihood of candidate 0 \[nats\]; null if it failed.
    pub check: Option<f64>,
    /// Mean squared innovation of candidate 0.
    pub check_mse: Option<f64>,
    /// Sum of NIS / T of candidate 0.
    pub check_nis: Option<f64>,
    /// Mean log-likelihood over usable candidates \[nats\].
    pub mean_ll: Option<f64>,
    /// Mean of their mean squared innovations.
    pub mean_mse: Option<f64>,
    /// Candidates that failed.
    pub failed: usize,
    /// Processors this process may use.
    pub cpus: usize,
    /// Threads of the processor it was told to use; null on an adapter.
    pub threads: Option<usize>,
    /// Largest resident set of the process \[MiB\]; null where the system does not tell.
    pub maxrss_mb: Option<u64>,
    /// `cpu`, `gpu` or `software adapter`.
    pub device: String,
    /// Instruction set and threads of the processor, or adapter, backend and driver.
    pub isa: String,
    /// Median time in kernels, by the adapter's own timestamps; null on the CPU and where an adapter has none.
    pub kernel_s: Option<f64>,
    /// N T / `kernel_s`.
    pub kernel_steps_per_s: Option<f64>,
    /// Time to assemble the shader and create its pipeline; null on the CPU.
    pub kernel_build_s: Option<f64>,
    /// + - * / of one filter-step of the tape, one each, fused ones as many as they stand for.
    pub flops_per_step: usize,
    /// Those of all steps over `kernel_s`, or over `median_s` without one \[1e9 a second\].
    pub gflops: f64,
    /// `gflops` over the arithmetic limit that was given; null without one.
    pub share_of_peak: Option<f64>,
}

impl fmt::Display for Report {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { workload, candidates, rows, dtype, reps, .. } = self;
        let best = *candidates as f64 * *rows as f64 / self.min_s;
        let share = self.share_of_peak.map(|share| format!(", {:.1} % of the limit given", 100.0 * share));
        let kernels = self.kernel_s.zip(self.kernel_steps_per_s);
        let check = self.check.zip(self.check_mse).zip(self.check_nis);
        let lines = [
            ("workload", Some(format!("{workload}: {candidates} candidates x {rows} rows, {dtype}"))),
            ("device", Some(format!("{} ({})", self.device, self.isa))),
            ("filter-steps/s", Some(format!("{:.3e} (median of {reps}, best {best:.3e})", self.steps_per_s))),
            ("per CPU-second", self.steps_per_cpu_s.map(|rate| format!("{rate:.3e}"))),
            ("evaluation", Some(format!("{:.6} s", self.median_s))),
            ("in kernels", kernels.map(|(seconds, rate)| format!("{seconds:.6} s, {rate:.3e} filter-steps/s"))),
            ("shader and pipeline", self.kernel_build_s.map(|seconds| format!("{seconds:.6} s"))),
            (
                "arithmetic",
                Some(format!(
                    "{:.2} GFLOP/s, {} flops a step{}",
                    self.gflops,
                    self.flops_per_step,
                    share.unwrap_or_default()
                )),
            ),
            ("trace and prepare", Some(format!("{:.6} s", self.compile_s))),
            ("peak memory", self.maxrss_mb.map(|peak| format!("{peak} MiB"))),
            (
                "candidate 0",
                check.map(|((check, mse), nis)| {
                    format!("log-likelihood {check:.6}, mse {mse:.6}, NIS per row {nis:.6}")
                }),
            ),
        ];
        for (label, value) in lines.into_iter().filter_map(|(label, value)| Some((label, value?))) {
            writeln!(f, "{label:<20} {value}")?;
        }
        write!(f, "{:<20} {}", "failed candidates", self.failed)
    }
}
