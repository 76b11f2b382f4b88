//! Tables of the study: printed ones, and the numbers behind them for files.

use super::super::statistics::{mean, median, quantile, standard_deviation};
use super::super::{Cell, Table};
use super::{DataSet, Results, Run, rmse};

/// Mean and variance (n - 1) of the 30 RMSE of each column of the paper's Table 1, and in how many runs a column is the
/// smallest, ties included.
const PAPER: [(&str, f64, f64); 5] = [
    ("Regular", 6.4114, 4.777e-1),
    ("Sage-Husa", 6.3760, 7.8e-3),
    ("Fuzzy", 6.3616, 4.94e-1),
    ("NSGA-II", 5.2958, 5.6e-3),
    ("MOMA", 5.2556, 5.3e-4),
];

/// MOMA smallest of five in the paper's 30 runs, ties included.
const PAPER_WINS: u64 = 25;

fn number(value: f64, digits: usize) -> Cell {
    Cell::Number(value, digits)
}

impl Results {
    /// Table 1 beside the paper's: NSGA-II and MOMA with hardly any mutation first, then by profile.
    pub(super) fn summary_table(&self) -> Table {
        let columns =
            ["method", "operators", "paper mean", "mean RMSE", "10 %", "90 %", "paper variance", "median variance"];
        let title = format!(
            "Table 1: RMSE of {} runs a data set; mean, 10 % and 90 % of the data sets' means, median of their \
             variances",
            self.plan.runs
        );
        let mut table = Table::new("summary", title, &columns);
        let fixed: [fn(&DataSet) -> Vec<f64>; 3] =
            [|set| set.regular.clone(), |set| set.sage_husa.clone(), |set| set.fuzzy.clone()];
        for (paper, of) in PAPER.iter().zip(fixed) {
            table.rows.push(self.row((paper.0, ""), Some(paper), of));
        }
        for (p, profile) in self.plan.profiles.iter().enumerate() {
            let paper = |row: usize| if p == 0 { PAPER.get(row) } else { None };
            table.rows.push(self.row(("NSGA-II", profile.name), paper(3), |set| rmse(&set.tuned[p].nsga)));
            table.rows.push(self.row(("MOMA", profile.name), paper(4), |set| rmse(&set.tuned[p].moma)));
        }
        table.rows.push(self.row(("end of least f1", ""), None, |set| vec![set.ends[0].1]));
        table.rows.push(self.row(("end of least f2", ""), None, |set| vec![set.ends[1].1]));
        table
    }

    fn row(
        &self,
        (method, operators): (&str, &str),
        paper: Option<&(&str, f64, f64)>,
        of: impl Fn(&DataSet) -> Vec<f64>,
    ) -> Vec<Cell> {
        let means = self.each(|set| mean(&of(set)));
        let variance = median(&self.each(|set| standard_deviation(&of(set)).powi(2)));
        vec![
            Cell::text(method),
            Cell::text(operators),
            paper.map_or(Cell::Empty, |p| number(p.1, 5)),
            number(mean(&means), 5),
            number(quantile(&means, 0.1), 4),
            number(quantile(&means, 0.9), 4),
            paper.map_or(Cell::Empty, |p| number(p.2, 3)),
            if variance.is_nan() { Cell::Empty } else { number(variance, 3) },
        ]
    }

    pub(super) fn tables(&self) -> Vec<Table> {
        vec![self.profile_table(), self.convergence_table()]
    }

    /// NSGA-II against MOMA by profile.
    fn profile_table(&self) -> Table {
        let columns = [
            "operators",
            "paper smallest of 5",
            "smallest of 5, median",
            "least",
            "most",
            "beats untuned 3, median",
            "mean(NSGA-II) >= mean(MOMA)",
            "at an end",
            "at the f1-end",
        ];
        let title = format!(
            "MOMA by operators: wins of {} runs, data sets of {} led by MOMA, shares of first individuals",
            self.plan.runs,
            self.data_sets.len()
        );
        let mut table = Table::new("profiles", title, &columns);
        for (p, profile) in self.plan.profiles.iter().enumerate() {
            let wins = self.each(|set| set.smallest_of_five(p));
            let leads = self.data_sets.iter().filter(|set| set.lead(p) >= 0.0).count();
            let mut row = vec![Cell::text(profile.name), if p == 0 { Cell::Count(PAPER_WINS) } else { Cell::Empty }];
            row.extend([median(&wins), quantile(&wins, 0.0), quantile(&wins, 1.0)].map(|x| number(x, 3)));
            row.push(number(median(&self.each(|set| set.beats_untuned(p))), 3));
            row.push(Cell::Count(leads as u64));
            row.extend([0, 1].map(|which| number(mean(&self.each(|set| set.at_ends(p)[which])), 3)));
            table.rows.push(row);
        }
        table
    }

    fn convergence_table(&self) -> Table {
        let title = "\"Converges faster\" (Fig. 3): first k from which the error of all three states stays < 10, and \
         the median error at k = 5, 10, 20";
        let columns = ["R", "first k, median", "10 %", "90 %", "error at 5", "at 10", "at 20"];
        let mut table = Table::new("convergence", title, &columns);
        for (which, label) in ["least f1", "43"].into_iter().enumerate() {
            let settled = self.each(|set| set.paths[which].settled_at() as f64);
            let mut row = vec![Cell::text(label)];
            row.extend([median(&settled), quantile(&settled, 0.1), quantile(&settled, 0.9)].map(|x| number(x, 2)));
            row.extend([5, 10, 20].map(|k| number(median(&self.each(|set| set.paths[which].errors[k])), 3)));
            table.rows.push(row);
        }
        table
    }

    /// One row a run and method, and one a data set.
    pub(super) fn data(&self) -> Vec<Table> {
        let columns = ["data_set", "run", "method", "operators", "R", "rmse", "evaluations", "generations"];
        let mut runs = Table::new("runs", "Every run", &columns);
        let columns = ["data_set", "R_f1", "rmse_f1", "R_f2", "rmse_f2"];
        let mut ends = Table::new("ends", "The ends of each data set's front", &columns);
        for set in &self.data_sets {
            let fixed = [("Regular", &set.regular), ("Sage-Husa", &set.sage_husa), ("Fuzzy", &set.fuzzy)];
            for (method, rmse) in fixed {
                let both = set.starts.iter().zip(rmse).zip(0..);
                runs.rows.extend(both.map(|((r, rmse), j)| run_row([set.index, j], [method, ""], [*r, *rmse], None)));
            }
            for (profile, tuned) in self.plan.profiles.iter().zip(&set.tuned) {
                for (method, all) in [("NSGA-II", &tuned.nsga), ("MOMA", &tuned.moma)] {
                    let rows = all.iter().zip(0..).map(|(run, j)| {
                        run_row([set.index, j], [method, profile.name], [run.found.r, run.rmse], Some(run))
                    });
                    runs.rows.extend(rows);
                }
            }
            let numbers = set.ends.iter().flat_map(|(r, rmse)| [number(*r, 6), number(*rmse, 6)]);
            ends.rows.push(std::iter::once(Cell::Count(set.index)).chain(numbers).collect());
        }
        vec![runs, ends]
    }
}

fn run_row([set, j]: [u64; 2], names: [&str; 2], [r, rmse]: [f64; 2], run: Option<&Run>) -> Vec<Cell> {
    let spent = run.map(|run| [run.found.evaluations, run.found.generations as u64].map(Cell::Count));
    let mut row = vec![Cell::Count(set), Cell::Count(j)];
    row.extend(names.map(Cell::text));
    row.extend([number(r, 6), number(rmse, 6)]);
    row.extend(spent.unwrap_or([Cell::Empty, Cell::Empty]));
    row
}
