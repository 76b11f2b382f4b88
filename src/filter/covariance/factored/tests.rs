//! Factors against products of plain matrices.

use super::*;
use crate::tape::{Calculator, Leaf};
use proptest::prelude::*;

fn constants(g: &mut Graph, a: [[f64; 3]; 3]) -> Symmetric {
    Symmetric::from_fn(3, |i, j| g.constant(a[i][j]))
}

/// U D U'.
fn product(g: &Graph, factors: &Factored) -> [[f64; 3]; 3] {
    let ids: Vec<Id> = factors.u.iter().flatten().chain(&factors.d).copied().collect();
    let values: Vec<f64> = Calculator::new(g, &ids).evaluate(|_| f64::NAN).collect();
    let entry = |i: usize, j: usize| (0..3).map(|k| values[3 * i + k] * values[9 + k] * values[3 * j + k]).sum();
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn distance(a: [[f64; 3]; 3], b: [[f64; 3]; 3]) -> f64 {
    a.iter().flatten().zip(b.iter().flatten()).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

fn gram(m: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| (0..3).map(|k| m[i][k] * m[j][k]).sum()))
}

proptest! {
    /// Factors multiply out to the matrix, of any rank.
    #[test]
    fn factors_rebuild_the_matrix(m in prop::array::uniform3(prop::array::uniform3(-2.0f64..2.0)), rank in 0usize..=3) {
        let a = gram(m.map(|row| std::array::from_fn(|k| if k < rank { row[k] } else { 0.0 })));
        let mut g = Graph::default();
        let matrix = constants(&mut g, a);
        let factors = Factored::of(&mut g, &matrix);
        let error = distance(product(&g, &factors), a);
        prop_assert!(error < 1e-6, "off by {error:e}");
    }

    /// Fading keeps a share of the matrix and adds a square, whatever is zero.
    #[test]
    fn fading_is_exact(m in prop::array::uniform3(prop::array::uniform3(-2.0f64..2.0)), x in prop::array::uniform3(-2.0f64..2.0), rank in 0usize..=3, d in 0.0f64..1.0) {
        let a = gram(m.map(|row| std::array::from_fn(|k| if k < rank { row[k] } else { 0.0 })));
        let mut g = Graph::default();
        let matrix = constants(&mut g, a);
        let mut factors = Factored::of(&mut g, &matrix);
        let (kept, weight) = (g.constant(1.0 - d), g.constant(d));
        let column = x.iter().map(|x| g.constant(*x)).collect();
        factors.fade(&mut g, kept, column, weight);
        let expected = std::array::from_fn(|i| std::array::from_fn(|j| (1.0 - d) * a[i][j] + d * x[i] * x[j]));
        let error = distance(product(&g, &factors), expected);
        prop_assert!(error < 1e-6, "off by {error:e}");
        let multiplied = factors.product(&mut g);
        let own = std::array::from_fn(|i| std::array::from_fn(|j| g.value(multiplied.at(i, j)).unwrap()));
        prop_assert!(distance(own, expected) < 1e-6, "the product of the factors: {own:?}");
    }

    /// The time update is F P F' + Q, whatever the order of sizes.
    #[test]
    fn propagation_is_exact(f in prop::array::uniform3(prop::array::uniform3(-2.0f64..2.0)), d in prop::array::uniform3(0.0f64..9.0), zero in 0usize..4) {
        let mut g = Graph::default();
        let d: Vec<Id> = (0..3).map(|i| g.constant(if i == zero { 0.0 } else { d[i] })).collect();
        let (nil, half) = (g.constant(0.0), g.constant(0.5));
        let p = Factored { d, ..Factored::from_entries(&mut g, &Symmetric::from_fn(3, |_, _| half)) };
        let q = Symmetric::from_fn(3, |i, j| if i == 1 && j == 1 { half } else { nil });
        let rows: Vec<Vec<Id>> = f.iter().map(|row| row.iter().map(|v| g.constant(*v)).collect()).collect();
        let noise = Factored::of(&mut g, &q);
        let next = p.propagate(&mut g, &rows, &noise);
        let prior = product(&g, &p);
        let mut expected = [[0.0; 3]; 3];
        for (i, j) in (0..9).map(|k| (k / 3, k % 3)) {
            let terms = (0..9).map(|k| f[i][k / 3] * prior[k / 3][k % 3] * f[j][k % 3]);
            expected[i][j] = terms.sum::<f64>() + if i == 1 && j == 1 { 0.5 } else { 0.0 };
        }
        let error = distance(product(&g, &next), expected);
        prop_assert!(error < 1e-9, "off by {error:e}");
    }
}

#[test]
fn an_indefinite_matrix_shows_it() {
    let mut g = Graph::default();
    let matrix = constants(&mut g, [[1.0, 2.0, 0.0], [2.0, 1.0, 0.0], [0.0, 0.0, 0.0]]);
    let factors = Factored::of(&mut g, &matrix);
    assert_eq!(factors.d.iter().map(|d| g.value(*d)).collect::<Vec<_>>(), [Some(-3.0), Some(1.0), Some(0.0)]);
}

#[test]
fn rounding_is_judged_by_where_it_happens() {
    let mut g = Graph::default();
    let (q, dt) = (g.leaf(Leaf::Parameter(0)), g.leaf(Leaf::Column(0)));
    let mixed = g.mul(q, dt);
    for (leaf, share) in [(q, 1e-12), (dt, 1e-12), (mixed, 1e-6)] {
        let one = g.constant(1.0);
        let pivot = g.sub(leaf, one);
        let resolved = Factored::resolved(&mut g, pivot, leaf);
        let at = |q: f64| {
            Calculator::new(&g, &[resolved])
                .evaluate(|l| if l == Leaf::Column(0) && leaf == mixed { 1.0 } else { q })
                .next()
        };
        assert!(at(1.0 + 3.0 * share) > Some(0.0), "a pivot of 3 times the bound stays");
        assert!(at(1.0 + share / 3.0) < Some(0.0), "a third of it is rounding");
    }
}
