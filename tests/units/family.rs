//! Problems that can be put in any units, with the log that belongs to each.

use kfgpu::data::{Log, Table, Trajectory};
use kfgpu::evaluate::Population;
use kfgpu::model::Problem;
use kfgpu::random::{Purpose, Stream};

/// Units of the two states and of the measurements, as multiples of plain ones.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Unit {
    pub(crate) states: [f64; 2],
    pub(crate) measurements: f64,
}

impl Unit {
    /// One unit for all.
    pub(crate) const fn of(unit: f64) -> Self {
        Self { states: [unit; 2], measurements: unit }
    }
}

/// A position that drifts, measured twice; the parameters `q`, `r` are variances in plain units.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Family {
    pub(crate) name: &'static str,
    /// R over `r`, row by row.
    r: [[f64; 2]; 2],
    /// `None` = from the first measurement.
    x0: Option<[f64; 2]>,
    p0: [f64; 2],
    filter: &'static str,
    /// Whether P0 is so large that f32 carries factors.
    pub(crate) diffuse: bool,
}

const PLAIN: Family = Family {
    name: "plain",
    r: [[1.0, 0.0], [0.0, 2.0]],
    x0: Some([0.0, 0.5]),
    p0: [4.0, 1.0],
    filter: "",
    diffuse: false,
};

/// Every way in which scale enters a filter.
pub(crate) const FAMILIES: [Family; 7] = [
    PLAIN,
    Family { name: "correlated R", r: [[1.0, 0.5], [0.5, 2.0]], ..PLAIN },
    Family { name: "x0 from a measurement", x0: None, ..PLAIN },
    Family { name: "diffuse", p0: [1e8, 1e6], diffuse: true, ..PLAIN },
    Family { name: "fuzzy", filter: "kind = \"fuzzy\"\nwindow = 8\ngain = 0.1\nwidth = 1", ..PLAIN },
    Family { name: "sage-husa", filter: "kind = \"sage-husa\"\nforgetting = 0.98", ..PLAIN },
    Family { name: "sage-husa-r", filter: "kind = \"sage-husa-r\"\nforgetting = 0.98\nfloor = 0.3", ..PLAIN },
];

/// What a problem is scored by, and the power of the unit in each.
pub(crate) const OBJECTIVES: [(&str, i32); 7] =
    [("nll", 0), ("mse_innovation", 2), ("mismatch", 0), ("nis", 0), ("nees", 0), ("rmse", 1), ("distance", 1)];

impl Family {
    /// In some units. Bounds of `q` and `r` span eight decades.
    pub(crate) fn problem(&self, unit: Unit) -> Problem {
        let ([a, b], m) = (unit.states, unit.measurements);
        let list = |values: &[f64]| values.iter().map(|v| format!("{v:e}")).collect::<Vec<_>>().join(", ");
        let entry = |factor: f64| format!("\"{factor:e}*r\"");
        let row = |row: &[f64; 2]| format!("[{}]", row.map(|v| entry(v * m * m)).join(", "));
        let diagonal = [0, 1].map(|i| entry(self.r[i][i] * m * m));
        let r = if self.r[0][1] == 0.0 { diagonal } else { [row(&self.r[0]), row(&self.r[1])] };
        let x0 = self.x0.map_or("\"measurement\"".to_owned(), |[x, v]| format!("[{}]", list(&[x * a, v * b])));
        let text = format!(
            "[data]\nfile = \"none.csv\"\ntime = \"t\"\nmeasurements = [\"y\", \"z\"]\ntruth = {{ x = \"tx\", v = \"tv\" }}\n\
             [model]\nstate = [\"x\", \"v\"]\nf = [\"x + dt*v*{:e}\", \"v\"]\nh = [\"x*{:e}\", \"x*{:e}\"]\n\
             Q = [[\"{:e}*q*dt^3\", \"{:e}*q*dt^2\"], [\"{:e}*q*dt^2\", \"{:e}*q*dt\"]]\nR = [{}]\nx0 = {x0}\nP0 = [{}]\n\
             [filter]\n{}\n[parameters]\nq = {{ min = 1e-4, max = 1e4, scale = \"log\", start = 0.1 }}\n\
             r = {{ min = 1e-4, max = 1e4, scale = \"log\", start = 1 }}\n[tune]\nobjectives = [{}]\n",
            a / b,
            m / a,
            m / a,
            0.25 * a * a,
            0.375 * a * b,
            0.375 * a * b,
            b * b,
            r.join(", "),
            list(&[self.p0[0] * a * a, self.p0[1] * b * b]),
            self.filter,
            OBJECTIVES.map(|(name, _)| format!("\"{name}\"")).join(", "),
        );
        Problem::parse(&text, "units.toml").unwrap_or_else(|error| panic!("{error}\n{text}"))
    }
}

/// Two trajectories with gaps and irregular intervals, in some units.
pub(crate) fn log(unit: Unit) -> Log {
    let trajectory = |index: u64| {
        let mut stream = Stream::new(5, Purpose::Workload, 0, index);
        let mut normal = || (0..12).map(|_| stream.uniform()).sum::<f64>() - 6.0;
        let (mut time, mut line, mut t) = (vec![], vec![], 0.0);
        let (mut z, mut truth) = (Table::new(2), Table::new(2));
        let [mut x, mut v] = [normal(), 0.5 + normal()];
        for k in 0..70_u32 {
            let gap = [k % 7 == 3, k % 11 == 5];
            let measured = [x + normal(), x + 1.4 * normal()];
            let measured: Vec<f64> =
                (0..2).map(|i| if gap[i] { f64::NAN } else { measured[i] * unit.measurements }).collect();
            z.push(&measured);
            truth.push(&[x * unit.states[0], v * unit.states[1]]);
            time.push(t);
            line.push(u64::from(k) + 2);
            let dt = if k % 5 == 0 { 0.5 } else { 1.0 };
            t += dt;
            x += dt * v + 0.15 * dt * normal();
            v += 0.3 * normal();
        }
        let mut u = Table::new(0);
        (0..70).for_each(|_| u.push(&[]));
        Trajectory { id: index.to_string(), time, z, u, truth, line }
    };
    Log {
        times: kfgpu::data::Times::default(),
        source: "units.csv".to_owned(),
        measurements: vec!["y".to_owned(), "z".to_owned()],
        inputs: vec![],
        truth: vec!["x".to_owned(), "v".to_owned()],
        trajectories: vec![trajectory(0), trajectory(1)],
        ranges: None,
    }
}

/// Measured values that update a filter of `family`.
pub(crate) fn updates(family: &Family) -> f64 {
    let log = log(Unit::of(1.0));
    let value = |t: &Trajectory| (0..t.len()).flat_map(|k| t.z.row(k)).filter(|z| !z.is_nan()).count();
    let all: usize = log.trajectories.iter().map(value).sum();
    // Of the rows that x0 comes from, the first of each trajectory, no component updates.
    let starts = if family.x0.is_none() { 2 * log.trajectories.len() } else { 0 };
    (all - starts) as f64
}

/// Candidates over the middle of the range.
pub(crate) fn candidates() -> Population {
    let mut population = Population::new(2);
    for q in [0.003, 0.09, 2.0] {
        for r in [0.2, 1.0, 30.0] {
            population.push(&[q, r]);
        }
    }
    population
}
