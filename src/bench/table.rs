//! A comparison as a table for people.

use std::fmt::{self, Display, Formatter};

use super::{Comparison, Crossover, Report};
use crate::table::Table;

impl Display for Comparison {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let flops = self.measurements.iter().map(|m| m.flops_per_step);
        let (least, most) = (flops.clone().min().unwrap_or(0), flops.max().unwrap_or(0));
        let range = if least == most { most.to_string() } else { format!("{least} to {most}") };
        writeln!(f, "{}: {} candidates x {} rows, {range} flops a step", self.workload, self.candidates, self.rows)?;
        let heads =
            ["device", "format", "evaluation s", "filter-steps/s", "kernels s", "kernel steps/s", "GFLOP/s", "on"];
        let mut table = Table::of(heads);
        self.measurements.iter().for_each(|report| table.push(row(report)));
        write!(f, "\n{table}")?;
        for crossover in &self.crossover {
            writeln!(f, "\n{crossover}")?;
        }
        for skipped in &self.skipped {
            writeln!(f, "\nnot measured: {} {}: {}", skipped.device, skipped.dtype, skipped.reason)?;
        }
        write!(f, "\nGFLOP/s: + - * / of the tape over the time in kernels, on the CPU over the evaluation")
    }
}

fn row(report: &Report) -> [String; 8] {
    let Report { device, dtype, isa, .. } = report;
    let or_dash = |value: Option<String>| value.unwrap_or_else(|| "-".to_owned());
    [
        device.clone(),
        dtype.clone(),
        format!("{:.6}", report.median_s),
        format!("{:.3e}", report.steps_per_s),
        or_dash(report.kernel_s.map(|s| format!("{s:.6}"))),
        or_dash(report.kernel_steps_per_s.map(|rate| format!("{rate:.3e}"))),
        format!("{:.2}", report.gflops),
        isa.clone(),
    ]
}

impl Display for Crossover {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let Self { adapter, dtype, threads, ladder, .. } = self;
        let what = if self.software { "software adapter" } else { "gpu" };
        let against = format!("the CPU ({dtype}, {threads} thread{})", if *threads == 1 { "" } else { "s" });
        match (self.candidates, ladder.last()) {
            (Some(n), _) => write!(f, "crossover: {what} `{adapter}` is faster than {against} from {n} candidates on"),
            (None, Some(most)) => {
                write!(
                    f,
                    "crossover: {what} `{adapter}` is not faster than {against} up to {} candidates",
                    most.candidates
                )
            }
            (None, None) => write!(f, "crossover: {what} `{adapter}` was not compared"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bench::Rung;

    #[test]
    fn a_software_adapter_is_never_called_a_gpu() {
        let ladder = vec![Rung { candidates: 64, cpu_s: 1.0, adapter_s: 2.0 }];
        let (adapter, dtype) = ("llvmpipe".to_owned(), "f32".to_owned());
        let mut crossover = Crossover { adapter, software: true, dtype, threads: 2, candidates: None, ladder };
        let told =
            "crossover: software adapter `llvmpipe` is not faster than the CPU (f32, 2 threads) up to 64 candidates";
        assert_eq!(crossover.to_string(), told);
        (crossover.candidates, crossover.software) = (Some(64), false);
        assert!(crossover.to_string().starts_with("crossover: gpu `llvmpipe` is faster"), "{crossover}");
    }
}
