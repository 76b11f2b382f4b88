//! Tables of the study: printed ones, and the numbers behind them for files.

use super::super::statistics::{mean, median, quantile};
use super::super::{Cell, Table};
use super::search::Run;
use super::{BOXES, Bounds, DataSet, Results, SWEEP};

/// J of Table 1 and the iterations at which Fig. 8 is flat, as the paper gives them.
const PAPER_KF: f64 = 70.44;
const PAPER_PIO: (f64, u64) = (44.25, 54);
const PAPER_PSO: (f64, u64) = (37.62, 59);

fn number(value: f64, digits: usize) -> Cell {
    Cell::Number(value, digits)
}

impl Results {
    /// Our Table 1 beside the paper's.
    pub(super) fn summary_table(&self) -> Table {
        let columns = [
            "filter",
            "paper J",
            "J in-sample",
            "paper J/KF",
            "J/KF",
            "10 %",
            "90 %",
            "paper iterations",
            "iterations",
            "evaluations",
            "search s",
        ];
        let title = format!(
            "J in-sample: means over {} data sets (paper: one); 10 % and 90 %: quantiles of J/KF over \
             data sets; iterations: median, to within 1e-3 of the final J",
            self.data_sets.len()
        );
        let mut table = Table::new("summary", title, &columns);
        let untuned = self.each(|set| set.untuned);
        let mut row = vec![Cell::text("KF only (R = I)"), number(PAPER_KF, 4), number(mean(&untuned), 4)];
        row.extend([number(1.0, 4), number(1.0, 3)]);
        row.extend(std::iter::repeat_n(Cell::Empty, 6));
        table.rows.push(row);
        table.rows.push(self.summary_row("KF-PIO", &self.runs(|set| &set.pio), Some(PAPER_PIO)));
        table.rows.push(self.summary_row("KF-PIO printed", &self.runs(|set| &set.printed), None));
        table.rows.push(self.summary_row("KF-PIO+", &self.runs(|set| &set.plus), None));
        table.rows.push(self.summary_row("KF-PSO", &self.runs(|set| &set.pso), Some(PAPER_PSO)));
        table
    }

    fn runs<'a>(&'a self, of: impl Fn(&'a DataSet) -> &'a Run) -> Vec<&'a Run> {
        self.data_sets.iter().map(of).collect()
    }

    fn summary_row(&self, label: &str, runs: &[&Run], paper: Option<(f64, u64)>) -> Vec<Cell> {
        let each = |of: &dyn Fn(&Run) -> f64| runs.iter().map(|run| of(run)).collect::<Vec<f64>>();
        let ratios: Vec<f64> = runs.iter().zip(&self.data_sets).map(|(run, set)| run.j / set.untuned).collect();
        vec![
            Cell::text(label),
            paper.map_or(Cell::Empty, |(j, _)| number(j, 4)),
            number(mean(&each(&|run| run.j)), 4),
            paper.map_or(Cell::Empty, |(j, _)| number(j / PAPER_KF, 3)),
            number(mean(&ratios), 3),
            number(quantile(&ratios, 0.1), 3),
            number(quantile(&ratios, 0.9), 3),
            paper.map_or(Cell::Empty, |(_, iterations)| Cell::Count(iterations)),
            number(median(&each(&Run::converged_at)), 3),
            runs.first().map_or(Cell::Empty, |run| Cell::Count(run.evaluations)),
            number(median(&each(&|run| run.seconds)), 2),
        ]
    }

    pub(super) fn tables(&self) -> Vec<Table> {
        vec![self.sweep_table(), self.box_table(), self.held_out_table()]
    }

    fn sweep_table(&self) -> Table {
        let columns = ["r", "PIO/PSO median", "10 %", "90 %", "iterations"];
        let mut table = Table::new(
            "sweep",
            "Sweep of r: PIO/PSO by the map and compass factor r; the paper's one pair gives 1.176 at r = 0.2",
            &columns,
        );
        let mut push = |r: f64, runs: &[&Run]| {
            let ratios: Vec<f64> = runs.iter().zip(&self.data_sets).map(|(run, set)| run.j / set.pso.j).collect();
            let iterations: Vec<f64> = runs.iter().map(|run| run.converged_at()).collect();
            let row = [median(&ratios), quantile(&ratios, 0.1), quantile(&ratios, 0.9)].map(|x| number(x, 4));
            let cells = std::iter::once(Cell::text(r.to_string())).chain(row);
            table.rows.push(cells.chain([number(median(&iterations), 3)]).collect());
        };
        push(0.2, &self.runs(|set| &set.pio));
        for (i, r) in SWEEP.iter().enumerate() {
            push(*r, &self.runs(|set| &set.sweep[i]));
        }
        table
    }

    /// Clamped against unclamped searches.
    fn box_table(&self) -> Table {
        let columns = ["search of M", "PIO/KF", "PSO/KF", "PIO/PSO median", "10 %", "90 %", "PSO/optimum median"];
        let title = format!(
            "Unclamped and clamped: searches with r = 0.2; the optimum is the best of {} independent local searches \
             without limits",
            self.plan.local_searches
        );
        let mut table = Table::new("boxes", title, &columns);
        let mut push = |label: String, pio: &dyn Fn(&DataSet) -> f64, pso: &dyn Fn(&DataSet) -> f64| {
            let ratios = self.ratios(pio, pso);
            let means = [self.ratios(pio, |set| set.untuned), self.ratios(pso, |set| set.untuned)];
            let shares = [median(&ratios), quantile(&ratios, 0.1), quantile(&ratios, 0.9)];
            let optimum = median(&self.ratios(pso, |set| set.optimum));
            let mut row = vec![Cell::text(label)];
            row.extend(means.iter().map(|all| number(mean(all), 3)));
            row.extend(shares.iter().map(|x| number(*x, 4)));
            row.push(number(optimum, 5));
            table.rows.push(row);
        };
        push("start [0, 3.162], then free".to_owned(), &|set| set.pio.j, &|set| set.pso.j);
        for (i, bounds) in BOXES.iter().enumerate() {
            let Bounds::Box(low, high) = bounds else { continue };
            let label = format!("clipped to [{}, {}]", crate::report::short(*low, 4), crate::report::short(*high, 4));
            push(label, &|set| set.boxed[i].0.j, &|set| set.boxed[i].1.j);
        }
        table
    }

    fn held_out_table(&self) -> Table {
        let title =
            format!("Held-out: mean J over {} fresh tracks a data set, over the same mean at R = I", self.plan.fresh);
        let columns = ["R", "median ratio", "10 %", "90 %", "share below 1"];
        let mut table = Table::new("held_out", title, &columns);
        let mut push = |label: &str, of: fn(&DataSet) -> f64| {
            let ratios = self.ratios(of, |set| set.held_out.untuned);
            let better = super::super::statistics::count(&ratios, |x| x < 1.0) / ratios.len() as f64;
            let row = [median(&ratios), quantile(&ratios, 0.1), quantile(&ratios, 0.9), better];
            table.rows.push(std::iter::once(Cell::text(label)).chain(row.map(|x| number(x, 4))).collect());
        };
        push("tuned by PIO", |set| set.held_out.pio);
        push("tuned by PSO", |set| set.held_out.pso);
        push("50 I for all, not tuned", |set| set.held_out.fixed);
        table
    }

    /// One row a data set and search, and the convergence of the four searches.
    pub(super) fn data(&self) -> Vec<Table> {
        let columns = [
            "data_set",
            "search",
            "J",
            "J_untuned",
            "J_optimum",
            "iterations",
            "evaluations",
            "failed",
            "seconds",
            "gap",
            "M11",
            "M12",
            "M21",
            "M22",
        ];
        let mut runs = Table::new("runs", "Every search", &columns);
        let mut convergence =
            Table::new("convergence", "Best J by iteration", &["data_set", "search", "iteration", "best_J"]);
        for set in &self.data_sets {
            for (label, run) in labelled(set) {
                runs.rows.push(run_row(set, &label, run));
            }
            for (label, run) in set.methods() {
                convergence.rows.extend(run.best.iter().zip(0..).map(|(best, iteration)| {
                    vec![Cell::Count(set.index), Cell::text(label), Cell::Count(iteration), number(*best, 6)]
                }));
            }
        }
        vec![runs, convergence]
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

fn run_row(set: &DataSet, label: &str, run: &Run) -> Vec<Cell> {
    let mut row = vec![Cell::Count(set.index), Cell::text(label)];
    row.extend([run.j, set.untuned, set.optimum, run.converged_at()].map(|x| number(x, 6)));
    row.extend([Cell::Count(run.evaluations), Cell::Count(run.failed)]);
    row.extend([run.seconds, run.gap].into_iter().chain(run.factor.iter().copied()).map(|x| number(x, 6)));
    row
}
