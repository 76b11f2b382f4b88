//! Problems and logs as numbers, without a problem file.

use kfgpu::data::{DataSpec, Log, Table, Trajectory};
use kfgpu::model::{
    Angles, Binary, Expr, FilterKind, First, Model, Parameters, Pick, Problem, Start, Symbol, TuneSpec,
};
use kfgpu::objective::{Kind, Objective};
use nalgebra::{DMatrix, DVector};

/// x' = F x + B u, z = H x + D u + offset; `start` `None` = from the first complete measurement.
#[derive(Clone)]
pub(crate) struct Linear {
    pub(crate) f: DMatrix<f64>,
    pub(crate) b: DMatrix<f64>,
    pub(crate) q: DMatrix<f64>,
    pub(crate) h: DMatrix<f64>,
    pub(crate) d: DMatrix<f64>,
    pub(crate) offset: DVector<f64>,
    pub(crate) r: DMatrix<f64>,
    pub(crate) start: Option<DVector<f64>>,
    pub(crate) p0: DMatrix<f64>,
    pub(crate) first: First,
    /// Adds `dt * G x` to f and scales Q by dt, when set.
    pub(crate) drift: Option<DMatrix<f64>>,
}

impl Linear {
    /// Local level with x0 = 0: F = H = 1.
    pub(crate) fn level(q: f64, r: f64, p0: f64) -> Self {
        let one = |v| DMatrix::from_element(1, 1, v);
        Self {
            f: one(1.0),
            b: DMatrix::zeros(1, 0),
            q: one(q),
            h: one(1.0),
            d: DMatrix::zeros(1, 0),
            offset: DVector::zeros(1),
            r: one(r),
            start: Some(DVector::zeros(1)),
            p0: one(p0),
            first: First::Update,
            drift: None,
        }
    }

    pub(crate) fn problem(&self) -> Problem {
        let (n, m) = self.h.shape();
        let m_n = (n, m);
        let names = |letter: char, count: usize| (0..count).map(|i| format!("{letter}{i}")).collect::<Vec<_>>();
        let (states, measurements) = (names('x', m_n.1), names('z', m_n.0));
        let inputs = names('u', self.b.ncols());
        Problem {
            modes: vec![],
            source: "<test>".into(),
            text: String::new(),
            data: DataSpec::default(),
            model: Model {
                kind: None,
                f: (0..m_n.1).map(|i| self.transition_row(i)).collect(),
                h: (0..m_n.0)
                    .map(|i| {
                        sum([
                            Expr::number(self.offset[i]),
                            row(&self.h, i, Symbol::State),
                            row(&self.d, i, Symbol::Input),
                        ])
                    })
                    .collect(),
                q: numbers(&self.q).into_iter().map(|q| if self.drift.is_some() { times_dt(q) } else { q }).collect(),
                r: numbers(&self.r),
                x0: self
                    .start
                    .as_ref()
                    .map_or(Start::Measurement, |x| Start::Values(x.iter().map(|v| Expr::number(*v)).collect())),
                p0: numbers(&self.p0),
                first: self.first,
                angles: Angles::default(),
                states,
                measurements,
                inputs,
            },
            parameters: Parameters::default(),
            filter: FilterKind::default(),
            robust: None,
            tune: tune(vec![Objective::new(Kind::Nll)]),
            simulate: None,
        }
    }

    fn transition_row(&self, i: usize) -> Expr {
        let fixed = sum([row(&self.f, i, Symbol::State), row(&self.b, i, Symbol::Input)]);
        match &self.drift {
            Some(g) => sum([fixed, times_dt(row(g, i, Symbol::State))]),
            None => fixed,
        }
    }
}

pub(crate) fn matrix<const N: usize, const M: usize>(rows: [[f64; M]; N]) -> DMatrix<f64> {
    DMatrix::from_fn(N, M, |i, j| rows[i][j])
}

pub(crate) fn vector<const N: usize>(entries: [f64; N]) -> DVector<f64> {
    DVector::from_column_slice(&entries)
}

pub(crate) fn tune(objectives: Vec<Objective>) -> TuneSpec {
    TuneSpec {
        constraints: Vec::new(),
        pick: Pick::Knee,
        algorithm: "pso".into(),
        objectives,
        population: 1,
        generations: 0,
        seed: 0,
        evaluations: None,
        wall_time: None,
        stall: None,
        target: None,
        include_start: true,
        polish: false,
    }
}

fn numbers(matrix: &DMatrix<f64>) -> Vec<Expr> {
    matrix.transpose().iter().map(|v| Expr::number(*v)).collect()
}

fn sum(terms: impl IntoIterator<Item = Expr>) -> Expr {
    terms.into_iter().reduce(|a, b| Expr::binary(Binary::Add, a, b)).unwrap_or(Expr::number(0.0))
}

fn row(matrix: &DMatrix<f64>, i: usize, symbol: impl Fn(usize) -> Symbol) -> Expr {
    sum((0..matrix.ncols())
        .map(|j| Expr::binary(Binary::Multiply, Expr::number(matrix[(i, j)]), Expr::symbol(symbol(j)))))
}

fn times_dt(expr: Expr) -> Expr {
    Expr::binary(Binary::Multiply, Expr::symbol(Symbol::Dt), expr)
}

/// A trajectory of rows (time, measurements); NaN = missing.
pub(crate) fn trajectory(rows: &[(f64, &[f64])]) -> Trajectory {
    let mut z = Table::new(rows.first().map_or(0, |r| r.1.len()));
    let (mut u, mut truth) = (Table::new(0), Table::new(0));
    for (_, values) in rows {
        z.push(values);
        u.push(&[]);
        truth.push(&[]);
    }
    let time: Vec<f64> = rows.iter().map(|r| r.0).collect();
    let line = (2..).take(time.len()).collect();
    Trajectory { id: String::new(), time, z, u, truth, line }
}

/// One scalar measurement a row, one second apart.
pub(crate) fn scalars(z: &[f64]) -> Trajectory {
    let cells: Vec<[f64; 1]> = z.iter().map(|z| [*z]).collect();
    let rows: Vec<(f64, &[f64])> = (0u32..).zip(&cells).map(|(k, cell)| (f64::from(k), cell.as_slice())).collect();
    trajectory(&rows)
}

pub(crate) fn with_truth(mut trajectory: Trajectory, rows: &[&[f64]]) -> Trajectory {
    trajectory.truth = table(rows);
    trajectory
}

pub(crate) fn table(rows: &[&[f64]]) -> Table {
    let mut table = Table::new(rows.first().map_or(0, |r| r.len()));
    rows.iter().for_each(|r| table.push(r));
    table
}

/// A log of the names that [`Linear::problem`] uses.
pub(crate) fn log(trajectories: Vec<Trajectory>) -> Log {
    let names = |letter: char, count: usize| (0..count).map(|i| format!("{letter}{i}")).collect::<Vec<_>>();
    let first = &trajectories[0];
    Log {
        source: "<test>".into(),
        measurements: names('z', first.z.columns()),
        inputs: names('u', first.u.columns()),
        truth: names('x', first.truth.columns()),
        trajectories,
        ..Log::default()
    }
}

/// The cost under one objective, which `costs` and `score` of `run` must agree on to the last bit.
pub(crate) fn cost(problem: &Problem, log: &Log, objective: Objective) -> f64 {
    let mut problem = problem.clone();
    problem.tune = tune(vec![objective]);
    let run = kfgpu::reference::run(&problem, log, &[]).expect("the run succeeds");
    let kept = kfgpu::reference::score(&problem, log, &run, &problem.tune.objectives);
    let streamed = kfgpu::reference::costs(&problem, log, &[]).expect("the run succeeds");
    assert_eq!(kept[0].to_bits(), streamed[0].to_bits(), "score(run) is {}, costs is {}", kept[0], streamed[0]);
    kept[0]
}

#[track_caller]
pub(crate) fn close(found: f64, expected: f64, tolerance: f64) {
    assert!((found - expected).abs() <= tolerance, "found {found:.15}, expected {expected:.15} within {tolerance:e}");
}
