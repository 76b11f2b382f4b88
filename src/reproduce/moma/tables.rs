//! Tables of the study: printed ones, and the numbers behind them for files.

use super::super::Table;
use super::super::columns::Columns;
use super::super::statistics::{mean, median, standard_deviation};
use super::search::Found;
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

/// A row of Table 1: the RMSE of its runs, by data set.
struct Method {
    name: &'static str,
    operators: &'static str,
    paper: Option<&'static (&'static str, f64, f64)>,
    rmse: Vec<Vec<f64>>,
}

/// A run of a method.
struct Ran<'a> {
    data_set: u64,
    run: u64,
    method: &'static str,
    operators: &'static str,
    r: f64,
    rmse: f64,
    found: Option<&'a Found>,
}

impl Results {
    /// Table 1 beside the paper's: NSGA-II and MOMA with hardly any mutation first, then by profile.
    pub(super) fn summary_table(&self) -> Table {
        let title = format!(
            "Table 1: RMSE of {} runs a data set; mean, 10 % and 90 % of the data sets' means, median of their \
             variances",
            self.plan.runs
        );
        let means = |method: &Method| method.rmse.iter().map(|runs| mean(runs)).collect::<Vec<f64>>();
        let variance = |method: &Method| {
            let all: Vec<f64> = method.rmse.iter().map(|runs| standard_deviation(runs).powi(2)).collect();
            Some(median(&all)).filter(|variance| !variance.is_nan())
        };
        let columns = Columns::new()
            .words("method", |method: &Method| method.name)
            .words("operators", |method| method.operators)
            .number("paper mean", 5, |method| method.paper.map(|paper| paper.1))
            .number("mean RMSE", 5, move |method| mean(&means(method)))
            .quantiles(["10 %", "90 %"], [0.1, 0.9], 4, means)
            .number("paper variance", 3, |method| method.paper.map(|paper| paper.2))
            .number("median variance", 3, variance);
        columns.table("summary", title, self.methods())
    }

    fn methods(&self) -> Vec<Method> {
        let method = |name, operators, paper, rmse: &dyn Fn(&DataSet) -> Vec<f64>| Method {
            name,
            operators,
            paper,
            rmse: self.data_sets.iter().map(rmse).collect(),
        };
        let mut methods = vec![
            method(PAPER[0].0, "", PAPER.first(), &|set| set.regular.clone()),
            method(PAPER[1].0, "", PAPER.get(1), &|set| set.sage_husa.clone()),
            method(PAPER[2].0, "", PAPER.get(2), &|set| set.fuzzy.clone()),
        ];
        for (p, profile) in self.plan.profiles.iter().enumerate() {
            let paper = |row: usize| if p == 0 { PAPER.get(row) } else { None };
            methods.push(method("NSGA-II", profile.name, paper(3), &|set| rmse(&set.tuned[p].nsga)));
            methods.push(method("MOMA", profile.name, paper(4), &|set| rmse(&set.tuned[p].moma)));
        }
        methods.push(method("end of least f1", "", None, &|set| vec![set.ends[0].1]));
        methods.push(method("end of least f2", "", None, &|set| vec![set.ends[1].1]));
        methods
    }

    pub(super) fn tables(&self) -> Vec<Table> {
        vec![self.profile_table(), self.convergence_table()]
    }

    /// NSGA-II against MOMA by profile.
    fn profile_table(&self) -> Table {
        let title = format!(
            "MOMA by operators: wins of {} runs, data sets of {} led by MOMA, shares of first individuals",
            self.plan.runs,
            self.data_sets.len()
        );
        let columns = Columns::new()
            .words("operators", |p: &usize| self.plan.profiles[*p].name)
            .count("paper smallest of 5", |p| (*p == 0).then_some(PAPER_WINS))
            .quantiles(["smallest of 5, median", "least", "most"], [0.5, 0.0, 1.0], 3, |p| {
                self.each(|set| set.smallest_of_five(*p))
            })
            .number("beats untuned 3, median", 3, |p| median(&self.each(|set| set.beats_untuned(*p))))
            .count("mean(NSGA-II) >= mean(MOMA)", |p| {
                self.data_sets.iter().filter(|set| set.lead(*p) >= 0.0).count() as u64
            })
            .numbers(["at an end", "at the f1-end"], 3, |p| {
                [0, 1].map(|which| mean(&self.each(|set| set.at_ends(*p)[which])))
            });
        columns.table("profiles", title, 0..self.plan.profiles.len())
    }

    fn convergence_table(&self) -> Table {
        let title = "\"Converges faster\" (Fig. 3): first k from which the error of all three states stays < 10, and \
                     the median error at k = 5, 10, 20";
        let columns = Columns::new()
            .words("R", |which: &usize| ["least f1", "43"][*which])
            .quantiles(["first k, median", "10 %", "90 %"], [0.5, 0.1, 0.9], 2, |which| {
                self.each(|set| set.paths[*which].settled_at() as f64)
            })
            .numbers(["error at 5", "at 10", "at 20"], 3, |which| {
                [5, 10, 20].map(|k| median(&self.each(|set| set.paths[*which].errors[k])))
            });
        columns.table("convergence", title, 0..2)
    }

    /// One row a run and method, and one a data set.
    pub(super) fn data(&self) -> Vec<Table> {
        let runs = Columns::new()
            .count("data_set", |ran: &Ran<'_>| ran.data_set)
            .count("run", |ran| ran.run)
            .words("method", |ran| ran.method)
            .words("operators", |ran| ran.operators)
            .number("R", 6, |ran| ran.r)
            .number("rmse", 6, |ran| ran.rmse)
            .count("evaluations", |ran| ran.found.map(|found| found.evaluations))
            .count("generations", |ran| ran.found.map(|found| found.generations as u64));
        let ends = Columns::new()
            .count("data_set", |set: &&DataSet| set.index)
            .numbers(["R_f1", "rmse_f1"], 6, |set| [set.ends[0].0, set.ends[0].1])
            .numbers(["R_f2", "rmse_f2"], 6, |set| [set.ends[1].0, set.ends[1].1]);
        vec![
            runs.table("runs", "Every run", self.data_sets.iter().flat_map(|set| self.ran(set))),
            ends.table("ends", "The ends of each data set's front", &self.data_sets),
        ]
    }

    /// Every run on a data set.
    fn ran<'a>(&self, set: &'a DataSet) -> Vec<Ran<'a>> {
        let data_set = set.index;
        let fixed = [("Regular", &set.regular), ("Sage-Husa", &set.sage_husa), ("Fuzzy", &set.fuzzy)];
        let untuned = fixed.into_iter().flat_map(|(method, rmse)| {
            let runs = set.starts.iter().zip(rmse).zip(0..);
            runs.map(move |((r, rmse), run)| Ran {
                data_set,
                run,
                method,
                operators: "",
                r: *r,
                rmse: *rmse,
                found: None,
            })
        });
        let tuned = self.plan.profiles.iter().zip(&set.tuned).flat_map(|(profile, tuned)| {
            [("NSGA-II", &tuned.nsga), ("MOMA", &tuned.moma)].into_iter().flat_map(move |(method, all)| {
                all.iter().zip(0..).map(move |(Run { found, rmse }, run)| {
                    let (operators, r, rmse) = (profile.name, found.r, *rmse);
                    Ran { data_set, run, method, operators, r, rmse, found: Some(found) }
                })
            })
        });
        untuned.chain(tuned).collect()
    }
}
