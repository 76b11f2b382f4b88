//! NSGA-II step by step, and its odd cases.

use super::*;
use crate::evaluate::mock::MultiObjective;
use crate::optimize::nsga2::{Merge, Nsga2, PUBLISHED, Rules, STUDY};
use crate::optimize::pareto::Scores;
use crate::optimize::pareto::tests::{crowding_by_neighbours, peeled};
use crate::population::Status;
use crate::random::{Purpose, Stream};

const SEED: u64 = 11;
const LOW: f64 = 0.1;
const HIGH: f64 = 45.0;

fn two_costs(x: f64) -> [f64; 2] {
    // Steps, so that candidates tie.
    [(x - 1.0).abs().floor(), (x / 3.0 - 1.0).abs()]
}

fn scores(all: &[f64]) -> Scores {
    let mut scores = Scores::new(2);
    all.iter().for_each(|x| scores.push(&two_costs(*x), 0.0));
    scores
}

/// A candidate with the rank and crowding distance it is compared by.
#[derive(Debug, Clone, Copy)]
struct Ranked {
    x: f64,
    rank: usize,
    crowding: f64,
}

impl Ranked {
    fn beats(&self, other: &Self) -> bool {
        self.rank < other.rank || (self.rank == other.rank && self.crowding > other.crowding)
    }
}

fn ranked(all: &[f64]) -> Vec<Ranked> {
    let scores = scores(all);
    let rank = peeled(&scores);
    let one = |i| Ranked { x: all[i], rank: rank[i], crowding: crowding_by_neighbours(&scores, &rank, i) };
    (0..all.len()).map(one).collect()
}

fn mutated(x: f64, probability: f64, stream: &mut Stream) -> f64 {
    if stream.uniform() >= probability {
        return x;
    }
    let u = stream.uniform();
    let delta = if u < 0.5 { (2.0 * u).powf(1.0 / 21.0) - 1.0 } else { 1.0 - (2.0 * (1.0 - u)).powf(1.0 / 21.0) };
    (x + delta * (HIGH - LOW)).clamp(LOW, HIGH)
}

/// Steps (1) to (4) of the study's generation: the parents chosen and the offspring.
fn offspring(old: &[Ranked], t: u64, mutation: f64) -> (Vec<Ranked>, Vec<f64>) {
    let n = old.len();
    let mut parents = Vec::new();
    for k in 0..n as u64 {
        let mut stream = Stream::new(SEED, Purpose::Selection, t, k);
        let (first, second) = (old[stream.below(n)], old[stream.below(n)]);
        parents.push(if first.beats(&second) { first } else { second });
    }
    let (mut first, mut second) = (Vec::new(), Vec::new());
    for pair in 0..n / 2 {
        let mut stream = Stream::new(SEED, Purpose::Variation, t, pair as u64);
        let (mut a, mut b) = (parents[2 * pair].x, parents[2 * pair + 1].x);
        if stream.uniform() < 0.9 {
            let u = stream.uniform();
            let beta: f64 = if u <= 0.5 { 2.0 * u } else { 1.0 / (2.0 * (1.0 - u)) };
            let beta = beta.powf(1.0 / 21.0);
            (a, b) = (0.5 * ((1.0 + beta) * a + (1.0 - beta) * b), 0.5 * ((1.0 - beta) * a + (1.0 + beta) * b));
        }
        first.push(mutated(a.clamp(LOW, HIGH), mutation, &mut stream));
        second.push(mutated(b.clamp(LOW, HIGH), mutation, &mut stream));
    }
    (parents, [first, second].concat())
}

/// Step (7): by rank, then crowding distance, then index, with what they were in the merged set.
fn survivors(old: &[f64], offspring: &[f64], keep: usize) -> Vec<Ranked> {
    let mut merged = ranked(&[old, offspring].concat());
    merged.sort_by(|a, b| a.rank.cmp(&b.rank).then(b.crowding.total_cmp(&a.crowding)));
    merged.truncate(keep);
    merged
}

#[test]
fn a_generation_of_the_study_as_specified() {
    let (mut ties, mut duplicates) = (0, 0);
    for (mutation, merge) in [(None, Merge::Population), (Some(0.01), Merge::Population), (Some(0.3), Merge::Parents)] {
        let rules = Rules { mutation_probability: mutation, merge, ..STUDY };
        let settings = Settings { objectives: 2, ..settings(20, 30, SEED) };
        let mut search = Nsga2::new(&Space::boxed(&[[LOW, HIGH]]), &settings, rules);
        let mut expected: Vec<Ranked> = Vec::new();
        for t in 0..=30 {
            let asked = search.ask().expect("a generation");
            if t == 0 {
                expected = ranked(asked.values());
            } else {
                let (parents, children) = offspring(&expected, t, mutation.unwrap_or(1.0));
                assert_eq!(asked.values(), children, "generation {t}, {rules:?}");
                let old = if merge == Merge::Parents { &parents } else { &expected };
                let old: Vec<f64> = old.iter().map(|ranked| ranked.x).collect();
                expected = survivors(&old, &children, 20);
            }
            let costs = asked.values().iter().flat_map(|x| two_costs(*x)).collect();
            search.tell(&asked, &Evaluation::new(2, costs, vec![Status::OK; asked.len()]));
            let kept: Vec<f64> = expected.iter().map(|ranked| ranked.x).collect();
            assert_eq!(search.population().values(), kept, "after generation {t}, {rules:?}");
            ties += expected.windows(2).filter(|w| !w[0].beats(&w[1]) && !w[1].beats(&w[0])).count();
            duplicates += usize::from(kept.windows(2).any(|w| w[0].total_cmp(&w[1]).is_eq()));
        }
    }
    assert!(ties > 100 && duplicates > 10, "{ties} ties, {duplicates} generations with duplicates");
}

/// Of generation 0's best front nothing is lost: an elite leaves only for one that is at least as good.
#[test]
fn no_cost_is_ever_lost() {
    let settings = Settings { objectives: 2, ..settings(30, 60, 3) };
    let function = MultiObjective::Zdt1;
    for rules in [PUBLISHED, STUDY] {
        let mut search = Nsga2::new(&Space::boxed(&function.bounds()), &settings, rules);
        let (mut mock, mut best) = (Mock::new(function), [f64::INFINITY; 2]);
        while let Some(population) = search.ask() {
            search.tell(&population, &mock.evaluate(&population));
            let least = [0, 1].map(|m| (0..30).map(|i| search.scores().costs(i)[m]).fold(f64::INFINITY, f64::min));
            assert!(least[0] <= best[0] && least[1] <= best[1], "{}: {least:?} after {best:?}", rules.name);
            best = least;
        }
    }
}

#[test]
fn odd_and_tiny_populations() {
    for (name, population) in
        ["nsga2", "nsga2-study", "moma", "moma-annealed"].into_iter().flat_map(|name| [2, 3, 5, 21].map(|n| (name, n)))
    {
        let function = MultiObjective::Dtlz2(3);
        let settings = Settings { objectives: 3, ..settings(population, 40, 1) };
        let space = Space::boxed(&function.bounds());
        let mut search = build(name, &space, &settings).expect(name);
        let mut mock = Mock::new(function);
        let mut generations = 0;
        while let Some(asked) = search.ask() {
            assert!(asked.len() == population || name.starts_with("moma"), "{name}: {} of {population}", asked.len());
            search.tell(&asked, &mock.evaluate(&asked));
            generations += usize::from(search.generation_finished());
        }
        assert_eq!(generations, 41, "{name} with {population}");
    }
    let space = Space::boxed(&Mock::bounds(2));
    let refused = build("nsga2", &space, &settings(1, 9, 1)).err().expect("an error").to_string();
    assert_eq!(refused, "algorithm \"nsga2\" needs a population of at least 2, received 1: children have two parents");
}

/// The front must lie where x_1 is at least 0.5: feasible candidates win over better infeasible ones.
#[test]
fn constraints_are_kept() {
    let function = MultiObjective::Zdt2;
    let settings = Settings { objectives: 2, ..settings(40, 100, 1) };
    for name in ["nsga2", "moma-annealed"] {
        let mut search = build(name, &Space::boxed(&function.bounds()[..5]), &settings).expect(name);
        let mut mock = Mock::new(function).violating(|x| 0.5 - x[0]);
        let (populations, _) = drive(search.as_mut(), &mut mock);
        let last = &populations[100];
        let kept = last.rows().filter(|x| x[0] >= 0.5).count();
        assert!(kept > last.len() / 2, "{name}: {kept} of {} keep the constraint", last.len());
    }
    let nothing_feasible = Mock::new(function).violating(|x| 1.0 + x[0]);
    let mut search = Nsga2::new(&Space::boxed(&function.bounds()[..5]), &settings, PUBLISHED);
    drive(&mut search, &mut { nothing_feasible });
    assert!(
        search.scores().violation(0) < 1.0 + 1e-3,
        "the least violation is sought: {}",
        search.scores().violation(0)
    );
}

/// Without bounds mutation steps by the width of the first population, and the search walks out of it.
#[test]
fn unbounded_coordinates_are_searched() {
    let unbounded = Space {
        lower: vec![f64::NEG_INFINITY; 2],
        upper: vec![f64::INFINITY; 2],
        init: vec![[-30.0, -20.0]; 2],
        seeds: Vec::new(),
    };
    for name in ["nsga2", "nsga2-study", "moma", "moma-annealed"] {
        let (_, best) = run(name, &unbounded, settings(40, 200, 3), Mock::new(Landscape::Sphere));
        println!("{name}: {best:e}");
        assert!(best < 1e-2, "{name}: {best}");
    }
}

/// Population and offspring, positions as bits.
fn positions(search: &Nsga2, asked: &Population) -> Vec<Vec<u64>> {
    let bits = |x: &[f64]| x.iter().map(|x| x.to_bits()).collect();
    search.population().rows().chain(asked.rows()).map(bits).collect()
}

/// With `distinct` no position occurs twice, and a child that repeats nothing is what it is without.
#[test]
fn no_position_is_scored_twice() {
    let function = MultiObjective::Zdt1;
    for coordinates in [2, 5] {
        let settings = Settings { objectives: 2, ..settings(30, 40, 7) };
        let space = Space::boxed(&function.bounds()[..coordinates]);
        let (mut search, mut mock) = (Nsga2::new(&space, &settings, PUBLISHED), Mock::new(function));
        let mut repeated = 0;
        for t in 0..=40 {
            let state = search.save().expect("a state");
            let asked = search.ask().expect("a generation");
            if t > 0 {
                let mut careless = Nsga2::new(&space, &settings, Rules { distinct: false, ..PUBLISHED });
                careless.restore(&state).expect("the same settings");
                let (found, plain) = (positions(&search, &asked), careless.ask().expect("a generation"));
                let plain = positions(&search, &plain);
                for i in 30..60 {
                    assert!(!found[..i].contains(&found[i]), "{coordinates} coordinates, generation {t}, child {i}");
                    let repeats = plain[..i].contains(&plain[i]);
                    assert_eq!(found[i] != plain[i], repeats, "{coordinates} coordinates, generation {t}, child {i}");
                    repeated += usize::from(repeats);
                }
            }
            search.tell(&asked, &mock.evaluate(&asked));
        }
        assert!(repeated > 20, "{repeated} children of 1,200 with {coordinates} coordinates repeated another");
    }
}

/// Where there is one position only, all children are copies, and the search still ends.
#[test]
fn a_box_without_room_is_searched_to_its_end() {
    let space = Space::boxed(&[[0.5, 0.5]; 2]);
    let (populations, _) = run("nsga2", &space, settings(6, 5, 1), Mock::new(Landscape::Sphere));
    assert_eq!(populations.len(), 6);
}
