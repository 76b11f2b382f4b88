//! States saved and taken up again, over the whole registry.

use super::*;
use proptest::prelude::*;

fn space() -> Space {
    Space { seeds: vec![vec![1.0, 2.0]], ..Space::boxed(&Mock::bounds(2)) }
}

fn built(name: &str, settings: Settings) -> Box<dyn Optimizer> {
    build(name, &space(), &settings).expect(name)
}

/// The states after every generation of a run, with the populations asked for.
fn states(name: &str, settings: Settings) -> (Vec<Vec<u8>>, Vec<Population>) {
    let (mut optimizer, mut mock) = (built(name, settings), Mock::new(Landscape::Rastrigin));
    let (mut states, mut populations) = (Vec::new(), Vec::new());
    while let Some((population, _)) = generation(optimizer.as_mut(), &mut mock) {
        states.push(optimizer.save().expect(name));
        populations.push(population);
    }
    (states, populations)
}

#[test]
fn from_any_generation_on_every_bit_is_the_same() {
    for row in ALGORITHMS {
        // 13 halves to 6, 3 and 1 in the landmark phase of pio.
        let settings = settings(13, 12, 5);
        let (states, populations) = states(row.name, settings);
        for (g, state) in states.iter().enumerate() {
            let mut resumed = built(row.name, settings);
            resumed.restore(state).unwrap_or_else(|error| panic!("{}, generation {g}: {error}", row.name));
            assert_eq!(resumed.save().as_ref(), Some(state), "{}, generation {g}: the same state", row.name);
            let (later, _) = drive(resumed.as_mut(), &mut Mock::new(Landscape::Rastrigin));
            assert!(same_bits(&later, &populations[g + 1..]), "{} from generation {g}", row.name);
            assert_eq!(later.len(), populations.len() - g - 1, "{} from generation {g}", row.name);
        }
    }
}

#[test]
fn states_of_other_settings_are_refused_and_change_nothing() {
    for row in ALGORITHMS.iter().filter(|row| row.name != "random") {
        let (states, _) = states(row.name, settings(13, 12, 5));
        let last = states.last().expect("a state");
        let fewer = settings(9, 12, 5);
        let mut other = built(row.name, fewer);
        let refused = other.restore(last).expect_err(row.name).to_string();
        assert!(refused.starts_with(&format!("algorithm {:?} cannot take up this state: it", row.name)), "{refused}");
        let fresh = run(row.name, &space(), fewer, Mock::new(Landscape::Sphere)).0;
        let (populations, _) = drive(other.as_mut(), &mut Mock::new(Landscape::Sphere));
        assert!(same_bits(&populations, &fresh), "{}: as if nothing had been tried", row.name);
        let wide = Space::boxed(&Mock::bounds(3));
        let mut other = build(row.name, &wide, &settings(13, 12, 5)).expect(row.name);
        assert!(other.restore(last).is_err(), "{}: three coordinates for two", row.name);
    }
    for row in ALGORITHMS {
        let (states, _) = states(row.name, settings(13, 12, 5));
        let short = built(row.name, settings(13, 3, 5)).restore(states.last().expect("a state"));
        assert!(short.is_err(), "{}: generation 12 of 3", row.name);
    }
}

proptest! {
    /// Whatever bytes come, and whatever becomes of a true state, the optimiser either refuses or runs on.
    #[test]
    fn broken_states_never_panic(
        row in 0..ALGORITHMS.len(), g in 0..7_usize, at in 0..4096_usize, byte: u8, cut in 0..64_usize,
        noise in proptest::collection::vec(any::<u8>(), 0..80),
    ) {
        let (name, settings) = (ALGORITHMS[row].name, settings(5, 6, 1));
        let mut state = states(name, settings).0.swap_remove(g);
        prop_assert!(built(name, settings).restore(&[state.clone(), vec![0]].concat()).is_err(), "a byte too many");
        let at = at % state.len();
        state[at] = byte;
        state.truncate(state.len() - cut.saturating_sub(32).min(state.len()));
        for bytes in [state, noise] {
            let mut optimizer = built(name, settings);
            let _ = optimizer.restore(&bytes);
            let (populations, _) = drive(optimizer.as_mut(), &mut Mock::new(Landscape::Sphere));
            prop_assert!(populations.len() <= 7);
        }
    }
}
