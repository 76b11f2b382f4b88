//! One block of candidates through the whole log.

use super::Status;
use crate::filter::{Initial, Program, Role, Step};
use crate::tape::lanes::{Lane, Register, run, run_one};
use multiversion::multiversion;
use std::sync::Arc;

/// A program, and its numbers rounded to the lane's precision, once.
#[derive(Debug)]
pub(super) struct Rounded<T> {
    pub(super) program: Program,
    /// Record and constants of each step.
    steps: Vec<(Arc<Vec<T>>, Vec<T>)>,
}

/// Totals and status of the candidates of a block.
#[derive(Debug, Default)]
pub(super) struct Totals {
    /// Candidates x [`Program::folded`].
    pub(super) folded: Vec<f64>,
    /// One a candidate.
    pub(super) status: Vec<Status>,
}

impl<T: Blocks> Rounded<T> {
    pub(super) fn new(program: Program) -> Self {
        let round =
            |step: &Step| (T::rounded(step.record()), step.constants().iter().map(|v| T::from_f64(*v)).collect());
        Self { steps: program.steps().iter().map(round).collect(), program }
    }
}

/// Runs candidates (row-major, at most `B * C`, the rest of the lanes repeat the last) through every trajectory.
#[inline(always)]
fn run_block<T: Lane, const C: usize, const B: usize>(rounded: &Rounded<T>, candidates: &[f64]) -> Totals {
    let program = &rounded.program;
    let d = program.parameters().max(1);
    let n = candidates.len() / d;
    let width = program.totals();
    let folded = program.folded();
    let mut totals = Totals { folded: vec![0.0; n * folded], status: vec![Status::OK; n] };
    let mut of_lane = vec![0.0; width];
    let mut registers = vec![Register::<T, C, B>::splat(T::ZERO); program.registers()];
    let mut prologue = vec![Register::<f64, C, B>::splat(0.0); program.prologue().registers];
    for (t, span) in program.spans().iter().enumerate() {
        for lane in 0..B * C {
            let candidate = &candidates[lane.min(n - 1) * d..][..d];
            candidate.iter().enumerate().for_each(|(p, v)| prologue[p].lanes_mut()[lane] = *v);
        }
        run(&program.prologue().operations, &mut prologue, &span.scalars);
        start(program, &prologue, &mut registers);
        let mut sums = vec![Register::<f64, C, B>::splat(0.0); width];
        run_rows(rounded, t, &mut registers, &mut sums);
        finish(program, &registers, &mut sums);
        let failed = failures(program, &registers, &sums);
        for lane in 0..n {
            sums.iter().zip(&mut of_lane).for_each(|(sum, to)| *to = sum.lanes()[lane]);
            program.fold(t, &of_lane, &mut totals.folded[lane * folded..][..folded]);
            if failed.lanes()[lane] {
                totals.status[lane] = totals.status[lane].union(Status::NOT_POSITIVE);
            }
        }
    }
    totals
}

/// What the registers hold before the first row, rounded once.
#[inline(always)]
fn start<T: Lane, const C: usize, const B: usize>(
    program: &Program,
    prologue: &[Register<f64, C, B>],
    registers: &mut [Register<T, C, B>],
) {
    for (register, initial) in registers.iter_mut().zip(program.initial()) {
        match initial {
            Initial::Number(value) => register.lanes_mut().fill(T::from_f64(value)),
            Initial::Result(result) => {
                let lanes = register.lanes_mut().iter_mut().zip(prologue[result].lanes());
                lanes.for_each(|(to, from)| *to = T::from_f64(*from));
            }
        }
    }
}

/// The time loop, to the last totals.
#[inline(always)]
fn run_rows<T: Lane, const C: usize, const B: usize>(
    rounded: &Rounded<T>,
    t: usize,
    registers: &mut [Register<T, C, B>],
    sums: &mut [Register<f64, C, B>],
) {
    let mut exponents = vec![Register::<T, C, B>::splat(T::ZERO); sums.len()];
    pass_rows(rounded, t, T::STEPS_PER_SPLIT, registers, (&mut exponents, sums));
    move_sums(&rounded.program, registers, &mut exponents, sums);
}

/// Passes the rows. Sums are moved to f64 every [`Program::BLOCK`] of them, exponents of products every `split`.
#[inline(always)]
fn pass_rows<T: Lane, const C: usize, const B: usize>(
    Rounded { program, steps }: &Rounded<T>,
    t: usize,
    split: usize,
    registers: &mut [Register<T, C, B>],
    (exponents, sums): (&mut [Register<T, C, B>], &mut [Register<f64, C, B>]),
) {
    let mut scalars: Vec<Vec<T>> = program.steps().iter().map(|step| vec![T::ZERO; step.columns()]).collect();
    scalars.iter_mut().zip(steps).for_each(|(scalars, (_, constants))| scalars.extend_from_slice(constants));
    let mut cursor = program.cursor(t);
    for (k, row) in program.spans()[t].rows.clone().enumerate() {
        let (kind, place) = cursor.next(row);
        let (step, scalars) = (&program.steps()[kind], &mut scalars[kind]);
        let columns = step.columns();
        scalars[..columns].copy_from_slice(&steps[kind].0[place * columns..(place + 1) * columns]);
        run(&step.tape().operations, registers, scalars);
        if (k + 1) % split == 0 {
            split_products(program, registers, exponents);
        }
        if (k + 1) % Program::BLOCK == 0 {
            move_sums(program, registers, exponents, sums);
        }
    }
}

/// What the registers of one candidate hold behind the last row of the only trajectory, products split every `split` rows.
pub(super) fn behind<T: Lane>(rounded: &Rounded<T>, candidate: &[f64], split: usize) -> Vec<Register<T, 1, 1>> {
    let program = &rounded.program;
    let mut prologue = candidate.to_vec();
    run_one(program.prologue(), &mut prologue, &program.spans()[0].scalars);
    let prologue: Vec<Register<f64, 1, 1>> = prologue.into_iter().map(Register::splat).collect();
    let mut registers = vec![Register::splat(T::ZERO); program.registers()];
    start(program, &prologue, &mut registers);
    let mut exponents = vec![Register::splat(T::ZERO); program.totals()];
    let mut sums = vec![Register::splat(0.0); program.totals()];
    pass_rows(rounded, 0, split, &mut registers, (&mut exponents, &mut sums));
    registers
}

/// Slots with their register and role, in the order of [`Program::totals`].
fn slots(program: &Program) -> impl Iterator<Item = (usize, Role)> + '_ {
    let carried = program.carried().iter().enumerate();
    carried.filter(|(_, c)| matches!(c.role, Role::Sum | Role::Product)).map(|(i, c)| (i, c.role))
}

/// Takes the exponents out of the running products. They are whole numbers, so their own running sums are exact.
#[inline(always)]
fn split_products<T: Lane, const C: usize, const B: usize>(
    program: &Program,
    registers: &mut [Register<T, C, B>],
    exponents: &mut [Register<T, C, B>],
) {
    for ((i, role), exponents) in slots(program).zip(exponents) {
        if role != Role::Product {
            continue;
        }
        for (product, sum) in registers[i].lanes_mut().iter_mut().zip(exponents.lanes_mut()) {
            let (mantissa, exponent) = product.split();
            *product = mantissa;
            *sum = *sum + exponent;
        }
    }
}

/// Moves running sums, of products the exponents, to their f64 totals.
#[inline(always)]
fn move_sums<T: Lane, const C: usize, const B: usize>(
    program: &Program,
    registers: &mut [Register<T, C, B>],
    exponents: &mut [Register<T, C, B>],
    sums: &mut [Register<f64, C, B>],
) {
    for (((i, role), exponents), sum) in slots(program).zip(exponents).zip(sums) {
        let parts = if role == Role::Product { exponents } else { &mut registers[i] };
        for (part, sum) in parts.lanes_mut().iter_mut().zip(sum.lanes_mut()) {
            *sum += part.to_f64();
            *part = T::ZERO;
        }
    }
}

/// The last totals: ln of the products.
fn finish<T: Lane, const C: usize, const B: usize>(
    program: &Program,
    registers: &[Register<T, C, B>],
    sums: &mut [Register<f64, C, B>],
) {
    for ((i, role), sum) in slots(program).zip(sums) {
        if role != Role::Product {
            continue;
        }
        for (rest, sum) in registers[i].lanes().iter().zip(sum.lanes_mut()) {
            *sum = rest.to_f64().ln() + *sum * std::f64::consts::LN_2;
        }
    }
}

/// Lanes in which an innovation variance was not positive or not finite: a product has no logarithm, or the check is down.
fn failures<T: Lane, const C: usize, const B: usize>(
    program: &Program,
    registers: &[Register<T, C, B>],
    sums: &[Register<f64, C, B>],
) -> Register<bool, C, B> {
    let mut failed = Register::splat(false);
    for ((_, role), sum) in slots(program).zip(sums) {
        let lanes = failed.lanes_mut().iter_mut().zip(sum.lanes());
        lanes.for_each(|(failed, sum)| *failed |= role == Role::Product && !sum.is_finite());
    }
    for (carried, register) in program.carried().iter().zip(registers) {
        let lanes = failed.lanes_mut().iter_mut().zip(register.lanes());
        lanes.for_each(|(failed, check)| *failed |= carried.role == Role::Check && *check <= T::ZERO);
    }
    failed
}

macro_rules! versions {
    ($($(#[$doc:meta])* $name:ident: $float:ty, $chunk:literal x $chunks:literal;)*) => {$(
        $(#[$doc])*
        #[multiversion(targets("x86_64+avx512f+avx512dq+avx512vl+avx512bw", "x86_64+avx2"))]
        fn $name(rounded: &Rounded<$float>, candidates: &[f64]) -> Totals {
            run_block::<$float, $chunk, $chunks>(rounded, candidates)
        }
    )*};
}

versions! {
    f64_128: f64, 8 x 16;
    f64_64: f64, 8 x 8;
    f64_16: f64, 8 x 2;
    f64_8: f64, 8 x 1;
    f32_256: f32, 16 x 16;
    f32_128: f32, 16 x 8;
    f32_16: f32, 16 x 1;
}

/// A lane type with its block sizes.
pub(super) trait Blocks: Lane {
    /// A record in this format.
    fn rounded(record: &Arc<Vec<f64>>) -> Arc<Vec<Self>>;
    /// Candidates of the widest block of a program: the registers in use should stay in a core's first cache.
    fn widest(program: &Program) -> usize;
    /// Runs a block of at most [`Self::widest`] candidates, in the narrowest that holds them.
    fn run(rounded: &Rounded<Self>, candidates: &[f64]) -> Totals;
}

/// Registers of 1 KiB with which the widest block is still the faster one: most of those of a step are dead most of the
/// time, so that CV 3-D with 45 of them gains by it on a core with 32 KiB.
const WIDE_REGISTERS: usize = 48;

impl Blocks for f64 {
    fn rounded(record: &Arc<Vec<f64>>) -> Arc<Vec<Self>> {
        Arc::clone(record)
    }

    fn widest(program: &Program) -> usize {
        if program.registers() <= WIDE_REGISTERS { 128 } else { 64 }
    }

    fn run(rounded: &Rounded<Self>, candidates: &[f64]) -> Totals {
        match candidates.len() / rounded.program.parameters().max(1) {
            0..=8 => f64_8(rounded, candidates),
            9..=16 => f64_16(rounded, candidates),
            17..=64 => f64_64(rounded, candidates),
            _ => f64_128(rounded, candidates),
        }
    }
}

impl Blocks for f32 {
    fn rounded(record: &Arc<Vec<f64>>) -> Arc<Vec<Self>> {
        Arc::new(record.iter().map(|v| Self::from_f64(*v)).collect())
    }

    fn widest(program: &Program) -> usize {
        if program.registers() <= WIDE_REGISTERS { 256 } else { 128 }
    }

    fn run(rounded: &Rounded<Self>, candidates: &[f64]) -> Totals {
        match candidates.len() / rounded.program.parameters().max(1) {
            0..=16 => f32_16(rounded, candidates),
            17..=128 => f32_128(rounded, candidates),
            _ => f32_256(rounded, candidates),
        }
    }
}

/// The instruction set the blocks run on.
pub(super) fn instruction_set() -> &'static str {
    #[cfg(target_arch = "x86_64")]
    {
        if std::is_x86_feature_detected!("avx512f") && std::is_x86_feature_detected!("avx512bw") {
            return "avx512";
        }
        if std::is_x86_feature_detected!("avx2") {
            return "avx2";
        }
    }
    std::env::consts::ARCH
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::trace;
    use crate::model::Problem;
    use crate::objective::{Kind, Objective};
    use crate::simulate::simulate;
    use std::path::Path;

    /// Candidates of (q, r) for two of the examples, with every objective and gaps in the log.
    fn rounded<T: Blocks>() -> Rounded<T> {
        let text = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/matlab_plant.toml"));
        let text = text.unwrap().replace("steps = 500", "steps = 90\nmissing = 0.2\ntrajectories = 2");
        let problem = Problem::parse(&text, "plant.toml").unwrap();
        let log = simulate(&problem, None).unwrap();
        let objectives: Vec<Objective> = Kind::ALL.iter().map(|(_, kind)| Objective::new(*kind)).collect();
        Rounded::new(trace(&problem, &log, &objectives, None).unwrap())
    }

    fn candidates(n: usize) -> Vec<f64> {
        (0..2 * n).map(|i| 0.1 + 0.07 * f64::from(u32::try_from(i).unwrap())).collect()
    }

    fn bits(totals: &Totals) -> (Vec<u64>, &[Status]) {
        (totals.folded.iter().map(|s| s.to_bits()).collect(), &totals.status)
    }

    /// The plain build of the same code is what the instruction set chosen at run time must equal, at every width.
    #[test]
    fn every_instruction_set_and_width_gives_the_same_bits() {
        let (double, single) = (rounded::<f64>(), rounded::<f32>());
        for n in [1, 7, 8, 9, 16, 17, 63, 64] {
            let candidates = candidates(n);
            let plain = run_block::<f64, 1, 64>(&double, &candidates);
            assert_eq!(bits(&f64::run(&double, &candidates)), bits(&plain), "f64, {n} candidates");
            assert_eq!(bits(&f64_128(&double, &candidates)), bits(&plain), "f64, {n} candidates in the widest block");
            let plain = run_block::<f32, 1, 64>(&single, &candidates);
            assert_eq!(bits(&f32::run(&single, &candidates)), bits(&plain), "f32, {n} candidates");
            assert_eq!(bits(&f32_256(&single, &candidates)), bits(&plain), "f32, {n} candidates in the widest block");
        }
    }

    /// What a block leaves in its registers must not reach the next trajectory or block.
    #[test]
    fn a_failed_candidate_leaves_its_neighbours_alone() {
        let rounded = rounded::<f64>();
        let mut candidates = candidates(16);
        let good = f64::run(&rounded, &candidates);
        candidates[10..12].copy_from_slice(&[f64::NAN, -5.0]);
        let mixed = f64::run(&rounded, &candidates);
        let width = rounded.program.folded();
        for i in 0..16 {
            let same = bits(&good).0[i * width..(i + 1) * width] == bits(&mixed).0[i * width..(i + 1) * width];
            assert_eq!(same, i != 5, "candidate {i}");
            assert_eq!(mixed.status[i].is_ok(), i != 5, "status of candidate {i}");
        }
    }
}
