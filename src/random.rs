//! The one source of randomness: Philox4x32-10, a counter-based generator.
//!
//! J. K. Salmon, M. A. Moraes, R. O. Dror, D. E. Shaw, "Parallel random numbers: as easy as 1, 2, 3", SC 2011,
//! doi 10.1145/2063384.2063405. A draw is a function of (seed, purpose, generation, index, position), so results do not
//! depend on thread count, chunking or the order of work. Only 32-bit operations are used, all of which WGSL has: the
//! high word of a product is put together from 16-bit halves.

use std::convert::Infallible;

use rand::TryRng;

/// Multipliers and Weyl key increments of Philox4x32 (section 4.3 and the Random123 reference of the paper).
const MULTIPLIER: [u32; 2] = [0xD251_1F53, 0xCD9E_8D57];
const WEYL: [u32; 2] = [0x9E37_79B9, 0xBB67_AE85];
const ROUNDS: u32 = 10;

/// What a draw is for. Streams of different purposes never share a number.
///
/// The discriminants are part of every recorded result: add at the end, never renumber.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[repr(u8)]
pub enum Purpose {
    /// Positions of generation 0.
    Population = 0,
    /// Moves of an optimiser.
    Move = 1,
    /// Initial states of simulated truth.
    InitialState = 2,
    /// Process noise of simulated truth.
    ProcessNoise = 3,
    /// Measurement noise of simulated logs.
    MeasurementNoise = 4,
    /// Which simulated components are missing.
    Missing = 5,
    /// Synthetic workloads of benchmarks and tests.
    Workload = 6,
    /// Which candidates become parents.
    Selection = 7,
    /// Crossover and mutation.
    Variation = 8,
    /// Local search of a memetic method.
    LocalSearch = 9,
    /// Mutation of candidates that repeat another.
    Distinction = 10,
    /// Fresh starts of the local searches that end a study.
    Polish = 11,
    /// Changes of measurements that say how far a filter carries rounding.
    Amplification = 12,
}

/// High and low word of the 64-bit product of two words.
const fn multiply(a: u32, b: u32) -> (u32, u32) {
    let (a_high, a_low, b_high, b_low) = (a >> 16, a & 0xFFFF, b >> 16, b & 0xFFFF);
    let middle = a_high * b_low + ((a_low * b_low) >> 16);
    let carry = (middle & 0xFFFF) + a_low * b_high;
    (a_high * b_high + (middle >> 16) + (carry >> 16), a.wrapping_mul(b))
}

/// Philox4x32-10: four random words from a 128-bit counter and a 64-bit key.
#[must_use]
pub const fn philox4x32(counter: [u32; 4], key: [u32; 2]) -> [u32; 4] {
    let [mut c0, mut c1, mut c2, mut c3] = counter;
    let [mut k0, mut k1] = key;
    let mut round = 0;
    while round < ROUNDS {
        let (high0, low0) = multiply(MULTIPLIER[0], c0);
        let (high1, low1) = multiply(MULTIPLIER[1], c2);
        (c0, c1, c2, c3) = (high1 ^ c1 ^ k0, low1, high0 ^ c3 ^ k1, low0);
        k0 = k0.wrapping_add(WEYL[0]);
        k1 = k1.wrapping_add(WEYL[1]);
        round += 1;
    }
    [c0, c1, c2, c3]
}

/// The draws of one (seed, purpose, generation, index), usable wherever `rand` and `rand_distr` take a generator.
///
/// The key is the seed. The counter holds the block in word 0, the low words of index and generation in words 1 and 2,
/// and in word 3 the purpose (8 bits) with bits 32-43 of index and generation. So streams are disjoint for indices and
/// generations below 2^44, each 2^34 words long; higher bits are ignored.
///
/// ```
/// use kfgpu::random::{Purpose, Stream};
/// let mut noise = Stream::new(7, Purpose::MeasurementNoise, 0, 12);
/// let u = noise.uniform();
/// assert!((0.0..1.0).contains(&u));
/// assert_eq!(u, Stream::new(7, Purpose::MeasurementNoise, 0, 12).uniform());
/// ```
#[derive(Debug, Clone)]
pub struct Stream {
    key: [u32; 2],
    counter: [u32; 4],
    words: [u32; 4],
    used: usize,
}

#[expect(clippy::cast_possible_truncation, reason = "the low word is meant")]
const fn split(value: u64) -> (u32, u32) {
    (value as u32, (value >> 32) as u32)
}

impl Stream {
    /// The stream of this key, at its beginning.
    #[must_use]
    pub const fn new(seed: u64, purpose: Purpose, generation: u64, index: u64) -> Self {
        let (key_low, key_high) = split(seed);
        let (generation_low, generation_high) = split(generation);
        let (index_low, index_high) = split(index);
        let tag = purpose as u32 | (index_high & 0xFFF) << 8 | (generation_high & 0xFFF) << 20;
        Self { key: [key_low, key_high], counter: [0, index_low, generation_low, tag], words: [0; 4], used: 4 }
    }

    /// The next 32 random bits.
    pub const fn word(&mut self) -> u32 {
        if self.used == 4 {
            self.words = philox4x32(self.counter, self.key);
            self.counter[0] = self.counter[0].wrapping_add(1);
            self.used = 0;
        }
        self.used += 1;
        self.words[self.used - 1]
    }

    /// Uniform on [0, 1): the upper 53 of 64 bits, whose low word comes first.
    pub const fn uniform(&mut self) -> f64 {
        const STEP: f64 = 1.0 / (1_u64 << 53) as f64;
        let low = self.word() as u64;
        let high = self.word() as u64;
        ((high << 32 | low) >> 11) as f64 * STEP
    }

    /// Uniform on 0, 1, ..., `limit` - 1: the high word of 64 random bits times `limit`. Uneven by less than
    /// `limit` / 2^64.
    ///
    /// # Panics
    /// If `limit` is 0.
    #[expect(clippy::cast_possible_truncation, reason = "below the limit")]
    pub const fn below(&mut self, limit: usize) -> usize {
        assert!(limit > 0, "there is no number below 0");
        let low = self.word() as u64;
        let bits = (self.word() as u64) << 32 | low;
        ((bits as u128 * limit as u128) >> 64) as usize
    }
}

/// Gives [`rand::Rng`] and, with it, every distribution of `rand_distr`.
impl TryRng for Stream {
    type Error = Infallible;

    fn try_next_u32(&mut self) -> Result<u32, Infallible> {
        Ok(self.word())
    }

    fn try_next_u64(&mut self) -> Result<u64, Infallible> {
        let low = u64::from(self.word());
        Ok(u64::from(self.word()) << 32 | low)
    }

    fn try_fill_bytes(&mut self, bytes: &mut [u8]) -> Result<(), Infallible> {
        for chunk in bytes.chunks_mut(4) {
            chunk.copy_from_slice(&self.word().to_le_bytes()[..chunk.len()]);
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_distr::{Distribution, StandardNormal};
    use std::collections::HashSet;

    /// Lines `philox4x32 10` of `tests/kat_vectors` in Random123 1.14.0 (DEShawResearch/random123).
    #[test]
    fn published_known_answers() {
        let cases = [
            ([0; 4], [0; 2], [0x6627_e8d5, 0xe169_c58d, 0xbc57_ac4c, 0x9b00_dbd8]),
            ([u32::MAX; 4], [u32::MAX; 2], [0x408f_276d, 0x41c8_3b0e, 0xa20b_c7c6, 0x6d54_51fd]),
            (
                [0x243f_6a88, 0x85a3_08d3, 0x1319_8a2e, 0x0370_7344],
                [0xa409_3822, 0x299f_31d0],
                [0xd16c_fe09, 0x94fd_cceb, 0x5001_e420, 0x2412_6ea1],
            ),
        ];
        for (counter, key, expected) in cases {
            assert_eq!(philox4x32(counter, key), expected, "counter {counter:08x?}, key {key:08x?}");
        }
    }

    #[test]
    fn product_from_halves_is_the_64_bit_product() {
        let words = [0, 1, 0xFFFF, 0x1_0000, 0xFFFF_FFFF, MULTIPLIER[0], MULTIPLIER[1], 0x8000_0001];
        for (a, b) in words.iter().flat_map(|a| words.map(|b| (*a, b))) {
            let product = u64::from(a) * u64::from(b);
            assert_eq!(multiply(a, b), ((product >> 32) as u32, product as u32), "{a:#x} * {b:#x}");
        }
    }

    /// One differing field, high bits included, gives another stream.
    #[test]
    fn every_field_of_the_key_counts() {
        let base = |seed, purpose, generation, index| Stream::new(seed, purpose, generation, index).try_next_u64();
        let mut seen = HashSet::new();
        for bit in [0, 1 << 5, 1 << 31, 1 << 32, 1 << 43] {
            seen.insert(base(bit, Purpose::Move, 0, 0));
            seen.insert(base(0, Purpose::Move, bit, 0));
            seen.insert(base(0, Purpose::Move, 0, bit));
        }
        seen.insert(base(0, Purpose::Missing, 0, 0));
        assert_eq!(seen.len(), 14, "12 single bits, the zero key and one other purpose");
    }

    #[test]
    fn uniform_and_normal_moments() {
        let mut stream = Stream::new(1, Purpose::Workload, 0, 0);
        let n = 40_000;
        let mean = (0..n).map(|_| stream.uniform()).sum::<f64>() / f64::from(n);
        assert!((mean - 0.5).abs() < 4.0 * (1.0_f64 / 12.0 / f64::from(n)).sqrt(), "mean of uniforms {mean}");
        let normals: Vec<f64> = (0..n).map(|_| StandardNormal.sample(&mut stream)).collect();
        let variance = normals.iter().map(|x| x * x).sum::<f64>() / f64::from(n);
        assert!((variance - 1.0).abs() < 4.0 * (2.0 / f64::from(n)).sqrt(), "variance of normals {variance}");
    }

    #[test]
    fn whole_numbers_are_even_and_below_the_limit() {
        let mut stream = Stream::new(2, Purpose::Selection, 0, 0);
        let mut counts = [0_i32; 7];
        (0..70_000).for_each(|_| counts[stream.below(7)] += 1);
        // 4 standard deviations of a binomial with n = 70,000 and p = 1/7.
        assert!(counts.iter().all(|count| (count - 10_000).abs() < 371), "{counts:?}");
        assert_eq!(stream.below(1), 0);
    }

    #[test]
    fn words_bytes_and_integers_are_one_sequence() {
        let (mut a, mut b) = (Stream::new(3, Purpose::Move, 2, 1), Stream::new(3, Purpose::Move, 2, 1));
        let mut bytes = [0; 10];
        a.try_fill_bytes(&mut bytes).expect("infallible");
        for chunk in bytes.chunks(4) {
            assert_eq!(*chunk, b.word().to_le_bytes()[..chunk.len()]);
        }
        assert_eq!(a.try_next_u64(), b.try_next_u64());
    }
}
