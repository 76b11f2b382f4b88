//! A k-d tree that answers: is any stored point nowhere above this one?

/// Points that a leaf holds before it is split.
const BUCKET: usize = 16;

/// Where space is cut: the medians of all points, coordinate after coordinate, so that no order of insertion unbalances a
/// tree. In the order of a heap: the cuts below `k` are `2 k + 1` and `2 k + 2`.
pub(super) struct Cuts {
    coordinates: usize,
    at: Vec<f64>,
}

impl Cuts {
    /// For trees that will hold some of these points, which must not be none.
    pub(super) fn of(points: &mut [&[f64]]) -> Self {
        let leaves = (points.len() / BUCKET).max(1).next_power_of_two();
        let mut cuts = Self { coordinates: points[0].len(), at: vec![0.0; leaves - 1] };
        cuts.place(points, 0, 0);
        cuts
    }

    fn place(&mut self, points: &mut [&[f64]], k: usize, level: usize) {
        if k >= self.at.len() || points.is_empty() {
            return;
        }
        let (coordinate, middle) = (level % self.coordinates, points.len() / 2);
        let by_coordinate = |a: &&[f64], b: &&[f64]| a[coordinate].total_cmp(&b[coordinate]);
        let (low, median, high) = points.select_nth_unstable_by(middle, by_coordinate);
        self.at[k] = median[coordinate];
        self.place(low, 2 * k + 1, level + 1);
        self.place(high, 2 * k + 2, level + 1);
    }
}

enum Node<'a> {
    Leaf(Vec<&'a [f64]>),
    /// What is below the cut, and the rest.
    Split(Box<[Self; 2]>),
}

/// Points of one front, without their first cost: the order of insertion has dealt with that.
pub(super) struct DominanceTree<'a> {
    root: Node<'a>,
}

impl<'a> DominanceTree<'a> {
    pub(super) const fn new() -> Self {
        Self { root: Node::Leaf(Vec::new()) }
    }

    /// Whether a stored point is nowhere above `point`.
    pub(super) fn dominates(&self, point: &[f64], cuts: &Cuts) -> bool {
        self.root.dominates(point, cuts, 0, 0)
    }

    pub(super) fn insert(&mut self, point: &'a [f64], cuts: &Cuts) {
        self.root.insert(point, cuts, 0, 0);
    }
}

impl<'a> Node<'a> {
    fn dominates(&self, point: &[f64], cuts: &Cuts, k: usize, coordinate: usize) -> bool {
        match self {
            Self::Leaf(points) => points.iter().any(|stored| stored.iter().zip(point).all(|(a, b)| a <= b)),
            Self::Split(halves) => {
                let next = (coordinate + 1) % cuts.coordinates;
                halves[0].dominates(point, cuts, 2 * k + 1, next)
                    || (point[coordinate] >= cuts.at[k] && halves[1].dominates(point, cuts, 2 * k + 2, next))
            }
        }
    }

    fn insert(&mut self, point: &'a [f64], cuts: &Cuts, k: usize, coordinate: usize) {
        match self {
            Self::Leaf(points) => {
                points.push(point);
                if points.len() > BUCKET && k < cuts.at.len() {
                    let (low, high) = std::mem::take(points).into_iter().partition(|p| p[coordinate] < cuts.at[k]);
                    *self = Self::Split(Box::new([Self::Leaf(low), Self::Leaf(high)]));
                }
            }
            Self::Split(halves) => {
                let high = point[coordinate] >= cuts.at[k];
                let next = (coordinate + 1) % cuts.coordinates;
                halves[usize::from(high)].insert(point, cuts, 2 * k + 1 + usize::from(high), next);
            }
        }
    }
}
