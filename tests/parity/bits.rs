//! Bit for bit: cutting, shuffling and threads never change a cost.

use crate::case::{Case, Single};
use crate::{cases, evaluate};
use kfgpu::evaluate::{CpuEvaluator, CpuOptions, Evaluation, Evaluator, Population, Precision};
use rayon::prelude::*;

/// Candidates a part: below, at and above the widths of the blocks.
const SIZES: [usize; 7] = [1, 8, 16, 17, 64, 65, 257];

fn evaluator(case: &Case, precision: Precision, threads: usize) -> CpuEvaluator {
    let options = CpuOptions { precision, threads: std::num::NonZero::new(threads) };
    CpuEvaluator::new(&case.problem, &case.log, options).unwrap_or_else(|error| panic!("{}: {error}", case.name))
}

fn bits(evaluation: &Evaluation, i: usize) -> (Vec<u64>, bool) {
    (evaluation.costs(i).iter().map(|c| c.to_bits()).collect(), evaluation.status(i).is_ok())
}

/// Evaluates the named candidates and compares each with its place in the whole.
fn compare(case: &Case, whole: &Evaluation, evaluator: &mut CpuEvaluator, picked: &[usize], what: &str) {
    let values = picked.iter().flat_map(|i| case.population.row(*i).to_vec()).collect();
    let part = evaluator.evaluate(&Population::from_rows(case.population.dimension(), values));
    for (at, i) in picked.iter().enumerate() {
        assert_eq!(bits(&part, at), bits(whole, *i), "{}: candidate {i}, {what}", case.name);
    }
}

fn check(case: &Case, precision: Precision) {
    let whole = evaluate(case, precision);
    let n = case.population.len();
    let mut alone = evaluator(case, precision, 1);
    for size in SIZES.into_iter().filter(|size| *size <= n) {
        for first in [0, 31 % (n - size + 1)] {
            let picked: Vec<usize> = (first..first + size).rev().collect();
            compare(case, &whole, &mut alone, &picked, &format!("{precision} in a part of {size}"));
        }
    }
    for threads in [2, 4] {
        // Repeated until there is work for several threads; a stride prime to n shuffles.
        let picked: Vec<usize> = (0..3 * 257).map(|i| i * 89 % n).collect();
        compare(
            case,
            &whole,
            &mut evaluator(case, precision, threads),
            &picked,
            &format!("{precision}, {threads} threads"),
        );
    }
}

#[test]
fn populations_may_be_cut_and_shuffled() {
    cases().par_iter().for_each(|(case, _)| {
        check(case, Precision::F64);
        if case.single != Single::Refused {
            check(case, Precision::F32);
        }
    });
}
