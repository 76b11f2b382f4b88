//! Tables of the study: printed ones, and the numbers behind them for files.

use super::super::columns::Columns;
use super::super::statistics::{count, mean, median, quantile};
use super::super::{Cell, Table};
use super::search::Run;
use super::{BOXES, Bounds, DataSet, Results, SWEEP};
use crate::number::short;

/// J of Table 1 and the iterations at which Fig. 8 is flat, as the paper gives them.
const PAPER_KF: f64 = 70.44;
const PAPER_PIO: (f64, u64) = (44.25, 54);
const PAPER_PSO: (f64, u64) = (37.62, 59);

/// Shares of the quantiles shown.
const SHARES: [f64; 3] = [0.5, 0.1, 0.9];

/// A filter of Table 1, with its J, J/KF and iterations in the paper. The untuned one has no runs.
struct Method<'a> {
    label: &'static str,
    paper: [Cell; 3],
    j: Vec<f64>,
    runs: Vec<&'a Run>,
}

fn of_runs(runs: &[&Run], of: impl Fn(&Run) -> f64) -> Vec<f64> {
    runs.iter().map(|run| of(run)).collect()
}

impl Results {
    /// Our Table 1 beside the paper's.
    pub(super) fn summary_table(&self) -> Table {
        let title = format!(
            "J in-sample: means over {} data sets (paper: one); 10 % and 90 %: quantiles of J/KF over \
             data sets; iterations: median, to within 1e-3 of the final J",
            self.data_sets.len()
        );
        let ratios =
            |m: &Method<'_>| -> Vec<f64> { m.j.iter().zip(&self.data_sets).map(|(j, set)| j / set.untuned).collect() };
        let tuned = |m: &Method<'_>, number: f64| (!m.runs.is_empty()).then_some(number);
        let columns = Columns::new()
            .words("filter", |m: &Method<'_>| m.label)
            .cell("paper J", |m| m.paper[0].clone())
            .number("J in-sample", 4, |m| mean(&m.j))
            .cell("paper J/KF", |m| m.paper[1].clone())
            .number("J/KF", 3, |m| mean(&ratios(m)))
            .number("10 %", 3, |m| tuned(m, quantile(&ratios(m), 0.1)))
            .number("90 %", 3, |m| tuned(m, quantile(&ratios(m), 0.9)))
            .cell("paper iterations", |m| m.paper[2].clone())
            .number("iterations", 3, |m| tuned(m, median(&of_runs(&m.runs, Run::converged_at))))
            .count("evaluations", |m| m.runs.first().map(|run| run.evaluations))
            .number("search s", 2, |m| tuned(m, median(&of_runs(&m.runs, |run| run.seconds))));
        let paper =
            |(j, iterations): (f64, u64)| [Cell::Number(j, 4), Cell::Number(j / PAPER_KF, 3), Cell::Count(iterations)];
        let nothing = || [Cell::Empty, Cell::Empty, Cell::Empty];
        let method = |label, paper, of: fn(&DataSet) -> &Run| {
            let runs = self.runs(of);
            Method { label, paper, j: of_runs(&runs, |run| run.j), runs }
        };
        let known = [Cell::Number(PAPER_KF, 4), Cell::Number(1.0, 4), Cell::Empty];
        let methods = [
            Method { label: "KF only (R = I)", paper: known, j: self.each(|set| set.untuned), runs: Vec::new() },
            method("KF-PIO", paper(PAPER_PIO), |set| &set.pio),
            method("KF-PIO printed", nothing(), |set| &set.printed),
            method("KF-PIO+", nothing(), |set| &set.plus),
            method("KF-PSO", paper(PAPER_PSO), |set| &set.pso),
        ];
        columns.table("summary", title, methods)
    }

    fn runs<'a>(&'a self, of: impl Fn(&'a DataSet) -> &'a Run) -> Vec<&'a Run> {
        self.data_sets.iter().map(of).collect()
    }

    pub(super) fn tables(&self) -> Vec<Table> {
        vec![self.sweep_table(), self.box_table(), self.held_out_table()]
    }

    fn sweep_table(&self) -> Table {
        let swept = SWEEP.iter().enumerate().map(|(i, r)| (*r, self.runs(move |set| &set.sweep[i])));
        let columns = Columns::new()
            .words("r", |(r, _): &(f64, Vec<&Run>)| r.to_string())
            .quantiles(["PIO/PSO median", "10 %", "90 %"], SHARES, 4, |(_, runs)| {
                runs.iter().zip(&self.data_sets).map(|(run, set)| run.j / set.pso.j).collect()
            })
            .number("iterations", 3, |(_, runs)| median(&of_runs(runs, Run::converged_at)));
        let title = "Sweep of r: PIO/PSO by the map and compass factor r; the paper's one pair gives 1.176 at r = 0.2";
        columns.table("sweep", title, std::iter::once((0.2, self.runs(|set| &set.pio))).chain(swept))
    }

    /// Clamped against unclamped searches.
    fn box_table(&self) -> Table {
        let free = ("start [0, 3.162], then free".to_owned(), self.each(|set| set.pio.j), self.each(|set| set.pso.j));
        let boxed = BOXES.iter().enumerate().filter_map(|(i, bounds)| {
            let Bounds::Box(low, high) = bounds else { return None };
            let label = format!("clipped to [{}, {}]", short(*low, 4), short(*high, 4));
            Some((label, self.each(|set| set.boxed[i].0.j), self.each(|set| set.boxed[i].1.j)))
        });
        let title = format!(
            "Unclamped and clamped: searches with r = 0.2; the optimum is the best of {} independent local searches \
             without limits",
            self.plan.local_searches
        );
        let over = |j: &[f64], to: &[f64]| -> Vec<f64> { j.iter().zip(to).map(|(j, to)| j / to).collect() };
        let (untuned, optimum) = (&self.each(|set| set.untuned), &self.each(|set| set.optimum));
        let columns = Columns::new()
            .words("search of M", |(label, ..): &(String, Vec<f64>, Vec<f64>)| label.clone())
            .number("PIO/KF", 3, |(_, pio, _)| mean(&over(pio, untuned)))
            .number("PSO/KF", 3, |(_, _, pso)| mean(&over(pso, untuned)))
            .quantiles(["PIO/PSO median", "10 %", "90 %"], SHARES, 4, |(_, pio, pso)| over(pio, pso))
            .number("PSO/optimum median", 5, |(_, _, pso)| median(&over(pso, optimum)));
        columns.table("boxes", title, std::iter::once(free).chain(boxed))
    }

    fn held_out_table(&self) -> Table {
        let title =
            format!("Held-out: mean J over {} fresh tracks a data set, over the same mean at R = I", self.plan.fresh);
        let ratios = |of: fn(&DataSet) -> f64| self.ratios(of, |set| set.held_out.untuned);
        let rows = [
            ("tuned by PIO", ratios(|set| set.held_out.pio)),
            ("tuned by PSO", ratios(|set| set.held_out.pso)),
            ("50 I for all, not tuned", ratios(|set| set.held_out.fixed)),
        ];
        let columns = Columns::new()
            .words("R", |(label, _): &(&str, Vec<f64>)| *label)
            .quantiles(["median ratio", "10 %", "90 %"], SHARES, 4, |(_, ratios)| ratios.clone())
            .number("share below 1", 4, |(_, ratios)| count(ratios, |x| x < 1.0) / ratios.len() as f64);
        columns.table("held_out", title, rows)
    }

    /// One row a data set and search, and the convergence of the four searches.
    pub(super) fn data(&self) -> Vec<Table> {
        let runs =
            self.data_sets.iter().flat_map(|set| labelled(set).into_iter().map(move |(name, run)| (set, name, run)));
        let columns = Columns::new()
            .count("data_set", |(set, ..): &(&DataSet, String, &Run)| set.index)
            .words("search", |(_, label, _)| label.clone())
            .number("J", 6, |(.., run)| run.j)
            .number("J_untuned", 6, |(set, ..)| set.untuned)
            .number("J_optimum", 6, |(set, ..)| set.optimum)
            .number("iterations", 6, |(.., run)| run.converged_at())
            .count("evaluations", |(.., run)| run.evaluations)
            .count("failed", |(.., run)| run.failed)
            .number("seconds", 6, |(.., run)| run.seconds)
            .number("gap", 6, |(.., run)| run.gap)
            .numbers(["M11", "M12", "M21", "M22"], 6, |(.., run)| std::array::from_fn(|i| run.factor[i]));
        let best = self.data_sets.iter().flat_map(|set| {
            let curve = move |(label, run): (&'static str, &Run)| {
                run.best
                    .iter()
                    .zip(0..)
                    .map(move |(best, iteration)| (set.index, label, iteration, *best))
                    .collect::<Vec<_>>()
            };
            set.methods().into_iter().flat_map(curve)
        });
        let convergence = Columns::new()
            .count("data_set", |(set, ..): &(u64, &str, u64, f64)| *set)
            .words("search", |(_, label, ..)| *label)
            .count("iteration", |(_, _, iteration, _)| *iteration)
            .number("best_J", 6, |(.., best)| *best);
        vec![columns.table("runs", "Every search", runs), convergence.table("convergence", "Best J by iteration", best)]
    }
}

/// Every search of a data set by name.
fn labelled(set: &DataSet) -> Vec<(String, &Run)> {
    let main = set.methods().into_iter().map(|(label, run)| (label.to_owned(), run));
    let sweep = SWEEP.iter().zip(&set.sweep).map(|(r, run)| (format!("KF-PIO r={r}"), run));
    let boxed = BOXES.iter().zip(&set.boxed).flat_map(|(bounds, (pio, pso))| {
        let name = match bounds {
            Bounds::Box(low, high) => format!("[{low:.3} {high:.3}]"),
            Bounds::Free => String::new(),
        };
        [(format!("KF-PIO {name}"), pio), (format!("KF-PSO {name}"), pso)]
    });
    main.chain(sweep).chain(boxed).collect()
}
