//! The whole registry on the mock evaluator.

mod fronts;
mod genetic;
mod local;
mod refuelling;
mod saved;
mod steps;

use super::*;
use crate::evaluate::Evaluator;
use crate::evaluate::mock::{Landscape, Mock};

const fn settings(population: usize, generations: usize, seed: u64) -> Settings {
    Settings { population, generations, seed, objectives: 1, evaluations: None }
}

/// All candidates of the next generation, in as many parts as it has, and the best cost among them.
fn generation(optimizer: &mut dyn Optimizer, mock: &mut Mock) -> Option<(Population, f64)> {
    let (mut whole, mut best) = (None::<Population>, f64::INFINITY);
    while let Some(population) = optimizer.ask() {
        let costs = mock.evaluate(&population);
        best = (0..costs.len()).map(|i| costs.costs(i)[0]).fold(best, f64::min);
        optimizer.tell(&population, &costs);
        let whole = whole.get_or_insert_with(|| Population::new(population.dimension()));
        population.rows().for_each(|row| whole.push(row));
        if optimizer.generation_finished() {
            break;
        }
    }
    whole.map(|whole| (whole, best))
}

/// The candidates of every generation and the best cost seen.
fn drive(optimizer: &mut dyn Optimizer, mock: &mut Mock) -> (Vec<Population>, f64) {
    let (mut populations, mut best) = (Vec::new(), f64::INFINITY);
    while let Some((population, cost)) = generation(optimizer, mock) {
        best = best.min(cost);
        populations.push(population);
    }
    (populations, best)
}

fn run(name: &str, space: &Space, settings: Settings, mock: Mock) -> (Vec<Population>, f64) {
    let mut mock = mock;
    drive(build(name, space, &settings).expect(name).as_mut(), &mut mock)
}

/// Median over 20 seeds of the best cost of 40 candidates x 150 generations.
fn median(name: &str, landscape: Landscape, dimension: usize) -> f64 {
    let space = Space::boxed(&Mock::bounds(dimension));
    let mut costs: Vec<f64> =
        (0..20).map(|seed| run(name, &space, settings(40, 150, seed), Mock::new(landscape)).1).collect();
    costs.sort_by(f64::total_cmp);
    costs[10]
}

fn same_bits(a: &[Population], b: &[Population]) -> bool {
    let bits =
        |p: &[Population]| -> Vec<u64> { p.iter().flat_map(Population::rows).flatten().map(|x| x.to_bits()).collect() };
    bits(a) == bits(b)
}

/// Measured medians, in brackets, against limits a factor of about 100 above them.
#[test]
fn shifted_optima_are_reached() {
    let cases = [
        ("pso", Landscape::Sphere, 4, 1e-10),            // 2.5e-13
        ("pso", Landscape::Ellipsoid, 4, 1e-6),          // 1.2e-8
        ("pso", Landscape::Rosenbrock, 2, 1e-6),         // 5.9e-9
        ("pso", Landscape::Rastrigin, 2, 1e-10),         // 1.8e-14
        ("pso-inertia", Landscape::Sphere, 4, 1e-8),     // 7.3e-11
        ("pso-inertia", Landscape::Rosenbrock, 2, 1e-3), // 4.1e-6
        ("pso-inertia", Landscape::Rastrigin, 2, 1e-10), // 7.6e-13
        ("pio", Landscape::Sphere, 4, 5e-2),             // 4.2e-3: the published form stops early
        ("pio-printed", Landscape::Sphere, 4, 1e-12),    // 7.4e-16
        ("pio+", Landscape::Sphere, 4, 1e-14),           // 1.9e-17
        ("pio+", Landscape::Rosenbrock, 2, 1e-7),        // 5.5e-10
        ("pio+", Landscape::Rastrigin, 2, 1e-12),        // 0
    ];
    for (name, landscape, dimension, limit) in cases {
        let median = median(name, landscape, dimension);
        println!("{name} {landscape:?} {dimension}: {median:.1e}");
        assert!(median <= limit, "{name} on {landscape:?}: {median:e}, limit {limit:e}");
    }
}

#[test]
fn random_search_is_the_worst_on_the_sphere() {
    let random = median("random", Landscape::Sphere, 4);
    assert!((0.1..1.0).contains(&random), "0.37 measured, {random} found");
    for row in ALGORITHMS.iter().filter(|row| row.name != "random") {
        assert!(median(row.name, Landscape::Sphere, 4) < 0.1 * random, "{}", row.name);
    }
}

#[test]
fn evaluations_of_the_published_sizes() {
    let space = Space::boxed(&Mock::bounds(2));
    let expected =
        [("pso", 30_200), ("pso-inertia", 30_200), ("pio", 20_440), ("pio-printed", 20_440), ("pio+", 30_200)];
    for (name, expected) in expected {
        let (populations, _) = run(name, &space, settings(200, 150, 1), Mock::new(Landscape::Sphere));
        assert_eq!(populations.len(), 151, "{name}: the initial population and 150 generations");
        assert_eq!(populations.iter().map(Population::len).sum::<usize>(), expected, "{name}");
    }
    let (populations, _) = run("pio", &space, settings(200, 150, 1), Mock::new(Landscape::Sphere));
    let flock: Vec<usize> = populations[100..111].iter().map(Population::len).collect();
    assert_eq!(flock, [200, 100, 50, 25, 12, 6, 3, 1, 1, 1, 1]);
}

#[test]
fn the_seed_decides_and_nothing_else() {
    let space = Space::boxed(&Mock::bounds(3));
    for row in ALGORITHMS {
        let with = |seed, chunk, threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
            let mock = Mock::new(Landscape::Rastrigin).chunked(chunk);
            pool.install(|| run(row.name, &space, settings(23, 12, seed), mock).0)
        };
        let reference = with(5, 1000, 1);
        assert!(same_bits(&reference, &with(5, 7, 3)), "{}: 3 threads, chunks of 7", row.name);
        assert!(!same_bits(&reference, &with(6, 1000, 1)), "{}: another seed", row.name);
    }
}

/// The optimum lies outside the box: positions press against its sides but never pass them.
#[test]
fn bounds_are_never_left() {
    let space = Space::boxed(&[[-1.0, 0.5], [-0.25, 1.0]]);
    let corner = Landscape::Sphere.value(&[0.5, -0.25]);
    for row in ALGORITHMS {
        let (populations, best) = run(row.name, &space, settings(30, 60, 2), Mock::new(Landscape::Sphere));
        let inside = |x: &[f64]| (-1.0..=0.5).contains(&x[0]) && (-0.25..=1.0).contains(&x[1]);
        assert!(populations.iter().flat_map(Population::rows).all(inside), "{}", row.name);
        assert!(best >= corner, "{}", row.name);
        assert!(row.name == "random" || best <= corner + 1e-9, "{} ends in the corner: {best}", row.name);
    }
}

#[test]
fn unbounded_coordinates_leave_the_initial_range() {
    let unbounded = Space {
        lower: vec![f64::NEG_INFINITY; 2],
        upper: vec![f64::INFINITY; 2],
        init: vec![[-30.0, -20.0]; 2],
        seeds: Vec::new(),
    };
    for name in ["pso", "pso-inertia"] {
        let (_, best) = run(name, &unbounded, settings(40, 200, 3), Mock::new(Landscape::Sphere));
        assert!(best < 1e-3, "{name}: {best}");
    }
}

#[test]
fn failed_candidates_do_no_harm() {
    let space = Space::boxed(&Mock::bounds(2));
    for row in ALGORITHMS {
        let (populations, best) =
            run(row.name, &space, settings(12, 30, 4), Mock::new(Landscape::Sphere).failing(|_| true));
        assert_eq!((populations.len(), best), (31, Evaluation::FAILED), "{}", row.name);
        assert!(populations.iter().flat_map(Population::rows).flatten().all(|x| x.is_finite()), "{}", row.name);
    }
    for name in ["pso", "pio+"] {
        let mock = Mock::new(Landscape::Sphere).failing(|x| x[0] < 0.0 || x[1] > 0.0);
        assert!(run(name, &space, settings(40, 100, 4), mock).1 < 1e-8, "{name}: three quarters of the box fail");
    }
}

#[test]
fn seeds_open_generation_0() {
    let mut space = Space::boxed(&Mock::bounds(2));
    space.seeds = vec![vec![0.25, -4.0], vec![99.0, 0.0]];
    for row in ALGORITHMS {
        let first = build(row.name, &space, &settings(5, 3, 1)).expect(row.name).ask().expect("generation 0");
        assert_eq!((first.row(0), first.row(1)), (&[0.25, -4.0][..], &[5.0, 0.0][..]), "{}", row.name);
        assert_eq!(first.len(), 5, "{}", row.name);
    }
}

#[test]
fn wrong_use_says_what_to_do() {
    let space = Space::boxed(&Mock::bounds(2));
    let message = |name, space: &Space, settings| build(name, space, &settings).err().expect("an error").to_string();
    assert_eq!(
        message("psso", &space, settings(9, 1, 1)),
        "unknown algorithm \"psso\" (did you mean \"pso\"?): expected one of pso, pso-inertia, pio, pio-printed, pio+, nsga2, nsga2-study, moma, moma-annealed, random"
    );
    assert!(
        message("simulated-annealing", &space, settings(9, 1, 1))
            .starts_with("unknown algorithm \"simulated-annealing\": ")
    );
    assert_eq!(
        message("pio", &space, settings(1, 9, 1)),
        "algorithm \"pio\" needs a population of at least 2, received 1: its landmark phase halves the flock"
    );
    let two = Settings { objectives: 2, ..settings(9, 1, 1) };
    assert_eq!(
        message("pso", &space, two),
        "algorithm \"pso\" minimises one objective, received 2: keep 1 in [tune] objectives, or set [tune] algorithm = \
         \"nsga2\" (--algorithm nsga2), which finds a Pareto front of up to 4"
    );
    let five = Settings { objectives: 5, ..settings(9, 1, 1) };
    assert_eq!(
        message("nsga2", &space, five),
        "algorithm \"nsga2\" minimises at most 4 objectives, received 5: keep 4 in [tune] objectives"
    );
    for (lower, init) in [(2.0, [0.0, 1.0]), (f64::NAN, [0.0, 1.0]), (0.0, [1.0, 0.0]), (0.0, [0.0, f64::INFINITY])] {
        let broken = Space { lower: vec![lower], upper: vec![1.0], init: vec![init], seeds: Vec::new() };
        assert!(message("pso", &broken, settings(9, 1, 1)).starts_with("search coordinate 0: "), "{broken:?}");
    }
}
