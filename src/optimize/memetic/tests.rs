//! The wrapper and the annealing: accounting, order, acceptance.

use super::annealing::{ACTING, Acceptance, PRINTED};
use super::*;
use crate::evaluate::Evaluator;
use crate::evaluate::mock::{Landscape, Mock};
use crate::optimize::pso::{CONSTRICTION, Pso};
use crate::random::{Purpose, Stream};
use rand_distr::{Distribution, StandardNormal};

const fn settings(generations: usize, evaluations: Option<u64>) -> Settings {
    Settings { population: 20, generations, seed: 4, objectives: 2, evaluations }
}

/// Two costs of one variable on [0.1, 45] with the trade-off between 1 and 3, as the study has it.
fn two_costs(x: &[f64]) -> [f64; 2] {
    [(x[0] - 1.0).powi(2) + 40.0, (x[0] / 3.0 - 1.0).abs()]
}

fn evaluated(population: &Population) -> Evaluation {
    let costs = population.rows().flat_map(two_costs).collect();
    Evaluation::new(2, costs, vec![Status::OK; population.len()])
}

fn space() -> Space {
    Space::boxed(&[[0.1, 45.0]])
}

/// Candidates of each part of each generation, stopped as a study stops: no part starts that does not fit.
fn parts(optimizer: &mut dyn Optimizer, allowed: u64) -> Vec<Vec<Population>> {
    let (mut generations, mut sent, mut finished) = (Vec::<Vec<Population>>::new(), 0, true);
    while let Some(population) = optimizer.ask() {
        sent += population.len() as u64;
        if sent > allowed {
            break;
        }
        optimizer.tell(&population, &evaluated(&population));
        if finished {
            generations.push(Vec::new());
        }
        generations.last_mut().expect("a generation").push(population);
        finished = optimizer.generation_finished();
    }
    generations
}

#[test]
fn five_hundred_evaluations_of_the_study() {
    let sizes = |name: &str| -> Vec<Vec<usize>> {
        let mut optimizer = crate::optimize::build(name, &space(), &settings(1000, Some(500))).expect(name);
        let parts = parts(optimizer.as_mut(), 500);
        parts.iter().map(|generation| generation.iter().map(Population::len).collect()).collect()
    };
    let searched = [vec![20], vec![2; 8]].concat();
    for name in ["moma", "moma-annealed"] {
        let sizes = sizes(name);
        assert_eq!(sizes.len(), 21, "{name}: the initial population and 20 generations");
        for (g, parts) in sizes.iter().enumerate() {
            assert_eq!(*parts, if g.is_multiple_of(5) { searched.clone() } else { vec![20] }, "{name}, {g}");
        }
        assert_eq!(sizes.concat().iter().sum::<usize>(), 500, "{name}");
    }
    for name in ["nsga2", "nsga2-study"] {
        assert_eq!(sizes(name), vec![vec![20]; 25], "{name}: 24 generations");
    }
}

/// A search starts only if 16 more evaluations fit: at 515 that of generation 20 does, at 499 it does not.
#[test]
fn a_search_that_does_not_fit_is_left_out() {
    for (allowed, spent) in [(499, 484), (500, 500), (515, 500), (520, 520), (35, 20), (36, 36)] {
        let mut moma = moma(&space(), &settings(1000, Some(allowed)), MOMA, nsga2::STUDY, PRINTED);
        let sent: usize = parts(&mut moma, allowed).iter().flatten().map(Population::len).sum();
        assert_eq!(sent, spent, "of {allowed}");
    }
}

/// The printed search of one individual written out again; `place` is 0 for the best and 1 for the second.
fn printed_search(start: f64, seed: u64, place: u64) -> f64 {
    let (mut x, mut temperature) = (start, 1e6);
    for k in 0..8_u64 {
        let mut stream = Stream::new(seed, Purpose::LocalSearch, 0, 2 * k + place);
        let normal: f64 = StandardNormal.sample(&mut stream);
        let proposal = (x + 0.05 * 44.9 * normal).clamp(0.1, 45.0);
        let (new, old) = (two_costs(&[proposal]), two_costs(&[x]));
        let (df1, df2) = (new[0] - old[0], new[1] - old[1]);
        let rand = stream.uniform();
        if df1 < 0.0 && (df2 < 0.0 || rand < (-df2 / temperature).exp()) {
            x = proposal;
        }
        temperature *= 0.9;
    }
    x
}

/// What NSGA-II is told must be the initial population, sorted, with its first two improved.
#[test]
fn the_printed_search_step_by_step() {
    let mut moved = 0;
    for seed in 0..10 {
        let settings = Settings { seed, ..settings(3, None) };
        let mut optimizer = moma(&space(), &settings, MOMA, nsga2::STUDY, PRINTED);
        let first = optimizer.ask().expect("generation 0");
        let order = Ranking::of(&Scores::from(&evaluated(&first))).order();
        let mut expected: Vec<f64> = order.iter().map(|i| first.row(*i)[0]).collect();
        for (place, x) in (0..).zip(&mut expected[..2]) {
            let improved = printed_search(*x, seed, place);
            moved += usize::from(improved.total_cmp(x).is_ne());
            *x = improved;
        }
        optimizer.tell(&first, &evaluated(&first));
        while !optimizer.generation_finished() {
            let proposals = optimizer.ask().expect("proposals");
            optimizer.tell(&proposals, &evaluated(&proposals));
        }
        let told = optimizer.inner().population();
        assert_eq!(told.values(), expected, "seed {seed}: sorted, the first two improved");
        assert_eq!(*optimizer.inner().scores(), Scores::from(&evaluated(told)), "seed {seed}: their own costs");
    }
    assert!((5..20).contains(&moved), "{moved} of 20 found something better");
}

/// One walk through the proposals that `accepted` gives costs for, from costs (0, 0).
fn walk(rules: annealing::Rules, costs: impl Fn(usize) -> [f64; 2]) -> (Individual, usize) {
    let mut annealing = Annealing::new(&space(), 1, rules);
    let start = Individual { x: vec![20.0], costs: vec![0.0, 0.0], violation: 0.0 };
    annealing.begin(vec![start], 0);
    let mut asked = 0;
    while let Some(proposal) = annealing.ask() {
        annealing.tell(&proposal, &Evaluation::new(2, costs(asked).to_vec(), vec![Status::OK]));
        asked += 1;
    }
    (annealing.finish().remove(0), asked)
}

#[test]
fn the_printed_temperature_never_acts() {
    let (found, asked) = walk(PRINTED, |k| [-1.0 - k as f64, 1000.0 * k as f64]);
    assert_eq!((found.costs, asked), (vec![-8.0, 7000.0], 8), "whatever lowers the first cost is taken");
    let (found, _) = walk(PRINTED, |k| [k as f64, -1000.0]);
    assert_eq!(found.costs, [0.0, 0.0], "and nothing else is");
    let colder = annealing::Rules { coldest: 8e5, ..PRINTED };
    assert_eq!(walk(colder, |_| [0.0; 2]).1, 3, "1e6, 9e5 and 8.1e5 are above 8e5");
}

/// Alternately one unit better in the second cost, and `rise` worse in the first: shares of rises accepted at T = 1 are
/// exp(-1) of the mean for equal rises, at T = 0.05 almost none.
#[test]
fn the_acting_temperature_decides() {
    let accepted = |temperature: f64| {
        let rules = annealing::Rules { proposals: 1, temperature, ..ACTING };
        let mut annealing = Annealing::new(&space(), 1, rules);
        let start = Individual { x: vec![20.0], costs: vec![0.0, 0.0], violation: 0.0 };
        let walks = 4000;
        annealing.begin(vec![start; walks], 0);
        let proposals = annealing.ask().expect("proposals");
        let costs = (0..walks).flat_map(|_| [7e5, -3e-9]).collect();
        annealing.tell(&proposals, &Evaluation::new(2, costs, vec![Status::OK; walks]));
        annealing.finish().iter().filter(|individual| individual.costs[0] > 0.0).count() as f64 / walks as f64
    };
    for temperature in [1.0_f64, 0.3, 0.05] {
        let expected = (-1.0 / temperature).exp();
        let error = 4.0 * (expected * (1.0 - expected) / 4000.0).sqrt() + 1e-9;
        assert!((accepted(temperature) - expected).abs() < error, "T = {temperature}: {}", accepted(temperature));
    }
    let last = (1..8).fold(ACTING.temperature, |t, _| t * ACTING.ratio);
    assert!((last - 0.05).abs() < 1e-12, "{last}");
}

/// A walk may pass through worse states, but what it hands back is dominated by nothing it kept before.
#[test]
fn annealing_never_hands_back_what_its_start_dominates() {
    let hot = annealing::Rules { temperature: 1e9, ..ACTING };
    let (found, _) = walk(hot, |k| [1.0 + k as f64; 2]);
    assert_eq!(found.costs, [0.0, 0.0]);
    let (found, _) = walk(hot, |k| if k == 3 { [-1.0, 1.0] } else { [2.0, 2.0] });
    assert_eq!(found.costs, [-1.0, 1.0]);
    assert_eq!(hot.acceptance, Acceptance::Scaled);
}

#[test]
fn feasibility_comes_first_and_failures_do_no_harm() {
    for rules in [PRINTED, ACTING] {
        let mut annealing = Annealing::new(&space(), 1, rules);
        let failed = Individual { x: vec![20.0], costs: vec![Evaluation::FAILED; 2], violation: f64::INFINITY };
        annealing.begin(vec![failed.clone(), failed], 0);
        let statuses = [Status::OK, Status::NOT_FINITE];
        let mut violation = 4.0;
        while let Some(proposals) = annealing.ask() {
            let costs = Evaluation::new(2, vec![5.0; 4], statuses.to_vec());
            annealing.tell(&proposals, &costs.with_violation(vec![violation, 0.0]));
            violation = if violation > 3.0 { 3.0 } else { 3.5 };
        }
        let found = annealing.finish();
        assert_eq!((found[0].violation, found[0].costs.as_slice()), (3.0, &[5.0, 5.0][..]), "{rules:?}");
        assert!(found[1].violation.is_infinite() && found[1].x[0].is_finite(), "{rules:?}");
    }
}

/// Records what it is told of.
#[derive(Default)]
struct Recorder {
    told: Option<(Population, Evaluation)>,
}

impl Optimizer for Recorder {
    fn name(&self) -> &'static str {
        "recorder"
    }

    fn ask(&mut self) -> Option<Population> {
        Some(Population::from_rows(1, (0..20).map(|i| f64::from(44 - i)).collect()))
    }

    fn tell(&mut self, population: &Population, costs: &Evaluation) {
        self.told = Some((population.clone(), costs.clone()));
    }
}

/// Candidates stay in their places for a method that knows them by these; what was not improved stays as it was.
#[test]
fn the_improved_take_the_places_of_the_original_ones() {
    let rules = Rules { name: "recorded", one_in: 10, every: 1, sorted: false };
    let settings = settings(9, None);
    let mut search = Memetic::new(Recorder::default(), Annealing::new(&space(), 1, PRINTED), &settings, rules);
    while search.inner().told.is_none() {
        let population = search.ask().expect("candidates");
        let status = population.rows().map(|x| if x[0] > 43.5 { Status::NOT_POSITIVE } else { Status::OK }).collect();
        let costs = population.rows().flat_map(|x| [x[0], 45.0 - x[0]]).collect();
        search.tell(&population, &Evaluation::new(2, costs, status));
    }
    let (told, costs) = search.inner().told.as_ref().expect("a generation");
    // All but the failed 44 are on one front: the best by crowding and index are its ends, 43 and 25.
    for (i, x) in told.rows().enumerate() {
        let original = 44.0 - i as f64;
        let searched = i == 1 || i == 19;
        assert!(if searched { x[0] < original } else { x[0] >= original }, "{i}: {x:?} from {original}");
        assert_eq!(costs.status(i), if i == 0 { Status::NOT_POSITIVE } else { Status::OK }, "{i}");
        assert!(i == 0 || (costs.costs(i)[0] - x[0]).abs() < 1e-12, "{i}: its own costs");
    }
}

#[test]
fn around_a_swarm_of_one_objective() {
    let rules = Rules { name: "memetic-pso", one_in: 10, every: 2, sorted: false };
    let space = Space::boxed(&Mock::bounds(2));
    for seed in 0..5 {
        let settings = Settings { objectives: 1, seed, ..settings(60, None) };
        let swarm = Pso::new(&space, &settings, CONSTRICTION);
        let mut search = Memetic::new(swarm, Annealing::new(&space, seed, ACTING), &settings, rules);
        let (mut mock, mut best) = (Mock::new(Landscape::Sphere), f64::INFINITY);
        while let Some(population) = search.ask() {
            let costs = mock.evaluate(&population);
            search.tell(&population, &costs);
            best = (0..costs.len()).map(|i| costs.costs(i)[0]).fold(best, f64::min);
        }
        assert!(best < 1e-4, "seed {seed}: {best:e}");
        assert_eq!(mock.candidates, 61 * 20 + 31 * 16, "seed {seed}");
    }
}
