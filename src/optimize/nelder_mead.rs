//! Nelder-Mead: the local search for costs that have kinks.

use super::{LocalSearch, OptimizeError, Optimizer, Space, Standing};
use crate::population::{Evaluation, Population};

/// How a local search runs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Never sends more candidates than this.
    pub evaluations: usize,
    /// Stops when the simplex and the spread of its costs are both this small, relative to the best vertex.
    pub tolerance: f64,
    /// Whether reflection, expansion and both contractions travel in one `ask`. The path is the same either way; with
    /// an evaluator that scores four candidates as fast as one, it takes half the calls.
    pub speculative: bool,
}

impl Default for Options {
    fn default() -> Self {
        Self { evaluations: 300, tolerance: 1e-10, speculative: true }
    }
}

#[derive(Debug, Clone)]
struct Vertex {
    x: Vec<f64>,
    cost: f64,
}

/// What the costs of the last `ask` are for.
#[derive(Debug, Clone, PartialEq)]
enum Pending {
    /// Simplex vertices from this one on: all at the start, all but the best after a shrink.
    Vertices(usize),
    /// These trial points.
    Trials(Vec<usize>),
}

/// What an iteration does with the costs it has.
enum Step {
    Need(usize),
    Accept(usize),
    Shrink,
}

const REFLECTION: usize = 0;
const EXPANSION: usize = 1;
const OUTSIDE: usize = 2;
const INSIDE: usize = 3;

/// Downhill simplex with coefficients that suit the dimension, clipped to the box; one objective.
///
/// J. A. Nelder, R. Mead, Computer Journal 7 (1965), doi 10.1093/comjnl/7.4.308; order of decisions as in J. C. Lagarias
/// et al., SIAM J. Optim. 9 (1998), doi 10.1137/S1052623496303470; for n >= 2, expansion 1 + 2/n, contraction
/// 3/4 - 1/(2n) and shrinkage 1 - 1/n of F. Gao, L. Han, Comput. Optim. Appl. 51 (2012), doi 10.1007/s10589-010-9329-3
/// (n = 2 gives the classic 2, 1/2, 1/2, which n = 1 takes too).
#[derive(Debug, Clone)]
pub struct NelderMead {
    space: Space,
    options: Options,
    edges: Vec<f64>,
    simplex: Vec<Vertex>,
    trials: [Vertex; 4],
    known: [bool; 4],
    pending: Pending,
    sent: usize,
    converged: bool,
}

impl NelderMead {
    /// From `start` (clipped to the box): the other vertices lie `edges[d]` away along coordinate d, in the direction
    /// that the box has room for.
    ///
    /// # Errors
    /// If the space is not a box, or `start` and positive `edges` are not as long as it has coordinates.
    pub fn new(space: &Space, start: &[f64], edges: &[f64], options: Options) -> Result<Self, OptimizeError> {
        space.check()?;
        let n = space.dimension();
        if start.len() != n || edges.len() != n || !edges.iter().all(|edge| *edge > 0.0) {
            return Err(OptimizeError::Space { coordinate: n, problem: "the first simplex does not fit the space" });
        }
        let mut x = start.to_vec();
        space.clip(&mut x);
        let vertex = |x: Vec<f64>| Vertex { x, cost: f64::INFINITY };
        let mut simplex = vec![vertex(x.clone())];
        for (d, edge) in edges.iter().enumerate() {
            let mut moved = x.clone();
            moved[d] += if x[d] + edge <= space.upper[d] { *edge } else { -edge };
            space.clip(&mut moved);
            simplex.push(vertex(moved));
        }
        Ok(Self {
            space: space.clone(),
            options,
            edges: edges.to_vec(),
            trials: std::array::from_fn(|_| vertex(x.clone())),
            known: [false; 4],
            simplex,
            pending: Pending::Vertices(0),
            sent: 0,
            converged: false,
        })
    }

    /// The best vertex of the simplex and its cost. (A speculative trial that the method did not take may be better.)
    #[must_use]
    pub fn best(&self) -> Option<(&[f64], f64)> {
        let best = self.simplex.iter().min_by(|a, b| a.cost.total_cmp(&b.cost))?;
        best.cost.is_finite().then_some((best.x.as_slice(), best.cost))
    }

    /// Number of candidates sent so far.
    #[must_use]
    pub const fn evaluations(&self) -> usize {
        self.sent
    }

    fn batch(&self) -> Population {
        let mut batch = Population::new(self.space.dimension());
        match &self.pending {
            Pending::Vertices(first) => self.simplex[*first..].iter().for_each(|v| batch.push(&v.x)),
            Pending::Trials(which) => which.iter().for_each(|k| batch.push(&self.trials[*k].x)),
        }
        batch
    }

    /// Sorts the simplex and places the four trial points on the line from the worst vertex through the others' centroid.
    fn begin_iteration(&mut self) {
        self.simplex.sort_by(|a, b| a.cost.total_cmp(&b.cost));
        self.converged = self.is_small();
        let n = self.space.dimension();
        let centroid: Vec<f64> =
            (0..n).map(|d| self.simplex[..n].iter().map(|v| v.x[d]).sum::<f64>() / n as f64).collect();
        let adapted = n.max(2) as f64;
        let contraction = 0.75 - 0.5 / adapted;
        let along = [1.0, 1.0 + 2.0 / adapted, contraction, -contraction];
        for (trial, along) in self.trials.iter_mut().zip(along) {
            for ((x, centre), worst) in trial.x.iter_mut().zip(&centroid).zip(&self.simplex[n].x) {
                *x = centre + along * (centre - worst);
            }
            self.space.clip(&mut trial.x);
        }
        self.known = [false; 4];
        self.pending = Pending::Trials(if self.options.speculative { vec![0, 1, 2, 3] } else { vec![REFLECTION] });
    }

    fn is_small(&self) -> bool {
        let (best, worst) = (&self.simplex[0], &self.simplex[self.simplex.len() - 1]);
        let tolerance = self.options.tolerance;
        let close = |v: &Vertex| {
            v.x.iter()
                .zip(&best.x)
                .zip(&self.edges)
                .all(|((x, b), edge)| (x - b).abs() <= tolerance * b.abs().max(*edge))
        };
        worst.cost - best.cost <= tolerance * best.cost.abs().max(tolerance) && self.simplex.iter().all(close)
    }

    fn step(&self) -> Step {
        let n = self.space.dimension();
        let [best, second_worst, worst] = [0, n - 1, n].map(|i| self.simplex[i].cost);
        let cost = |k: usize| self.trials[k].cost;
        let accept_if =
            |k: usize, accept: &dyn Fn(f64) -> Step| if self.known[k] { accept(cost(k)) } else { Step::Need(k) };
        let reflected = cost(REFLECTION);
        if !self.known[REFLECTION] {
            Step::Need(REFLECTION)
        } else if reflected < best {
            accept_if(EXPANSION, &|c| Step::Accept(if c < reflected { EXPANSION } else { REFLECTION }))
        } else if reflected < second_worst {
            Step::Accept(REFLECTION)
        } else if reflected < worst {
            accept_if(OUTSIDE, &|c| if c <= reflected { Step::Accept(OUTSIDE) } else { Step::Shrink })
        } else {
            accept_if(INSIDE, &|c| if c < worst { Step::Accept(INSIDE) } else { Step::Shrink })
        }
    }

    fn decide(&mut self) {
        match self.step() {
            Step::Need(trial) => self.pending = Pending::Trials(vec![trial]),
            Step::Accept(trial) => {
                let last = self.simplex.len() - 1;
                self.simplex[last].clone_from(&self.trials[trial]);
                self.begin_iteration();
            }
            Step::Shrink => self.shrink(),
        }
    }

    fn shrink(&mut self) {
        let factor = 1.0 - 1.0 / self.space.dimension().max(2) as f64;
        let best = self.simplex[0].x.clone();
        for vertex in &mut self.simplex[1..] {
            for (x, best) in vertex.x.iter_mut().zip(&best) {
                *x = best + factor * (*x - best);
            }
        }
        self.pending = Pending::Vertices(1);
    }
}

impl Optimizer for NelderMead {
    fn name(&self) -> &'static str {
        "nelder-mead"
    }

    fn ask(&mut self) -> Option<Population> {
        let batch = self.batch();
        let fits = self.sent + batch.len() <= self.options.evaluations;
        (fits && !self.converged).then_some(batch)
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        self.sent += population.len();
        match self.pending.clone() {
            Pending::Vertices(first) => {
                for (i, vertex) in self.simplex[first..].iter_mut().enumerate() {
                    vertex.cost = costs.costs(i)[0];
                }
                self.begin_iteration();
            }
            Pending::Trials(which) => {
                for (i, trial) in which.into_iter().enumerate() {
                    self.trials[trial].cost = costs.costs(i)[0];
                    self.known[trial] = true;
                }
                self.decide();
            }
        }
    }
}

impl LocalSearch for NelderMead {
    fn best(&self) -> Option<(&[f64], f64)> {
        Self::best(self)
    }

    fn standing(&self) -> Standing {
        if self.converged { Standing::Collapsed } else { Standing::Unfinished }
    }

    fn gradient_norm(&self) -> Option<f64> {
        None
    }
}
