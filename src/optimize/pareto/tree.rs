//! A k-d tree that answers: is any stored point nowhere above this one?

/// Points that a leaf holds before it is split.
const BUCKET: usize = 16;

enum Node<'a> {
    Leaf(Vec<&'a [f64]>),
    /// Points whose `coordinate` is below `at` are in `low`, the others in `high`.
    Split {
        coordinate: usize,
        at: f64,
        low: Box<Self>,
        high: Box<Self>,
    },
}

/// Distinct points of one front, without their first cost: the order of insertion has dealt with that.
pub(super) struct DominanceTree<'a> {
    root: Node<'a>,
}

impl<'a> DominanceTree<'a> {
    pub(super) const fn new() -> Self {
        Self { root: Node::Leaf(Vec::new()) }
    }

    /// Whether a stored point is nowhere above `point`.
    pub(super) fn dominates(&self, point: &[f64]) -> bool {
        self.root.dominates(point)
    }

    pub(super) fn insert(&mut self, point: &'a [f64]) {
        self.root.insert(point, 0);
    }
}

impl<'a> Node<'a> {
    fn dominates(&self, point: &[f64]) -> bool {
        match self {
            Self::Leaf(points) => points.iter().any(|stored| stored.iter().zip(point).all(|(a, b)| a <= b)),
            Self::Split { coordinate, at, low, high } => {
                low.dominates(point) || (point[*coordinate] >= *at && high.dominates(point))
            }
        }
    }

    fn insert(&mut self, point: &'a [f64], depth: usize) {
        match self {
            Self::Leaf(points) => {
                points.push(point);
                if points.len() > BUCKET {
                    *self = Self::split(std::mem::take(points), depth);
                }
            }
            Self::Split { coordinate, at, low, high } => {
                let side = if point[*coordinate] < *at { low } else { high };
                side.insert(point, depth + 1);
            }
        }
    }

    /// Cuts at the median of the first coordinate, from `depth` on in turn, in which the points differ enough for both
    /// sides to have some. Distinct points differ in one.
    fn split(mut points: Vec<&'a [f64]>, depth: usize) -> Self {
        let coordinates = points[0].len();
        for turn in 0..coordinates {
            let coordinate = (depth + turn) % coordinates;
            points.sort_unstable_by(|a, b| a[coordinate].total_cmp(&b[coordinate]));
            let at = points[points.len() / 2][coordinate];
            let cut = points.partition_point(|p| p[coordinate] < at);
            if cut > 0 {
                let high = points.split_off(cut);
                return Self::Split {
                    coordinate,
                    at,
                    low: Box::new(Self::Leaf(points)),
                    high: Box::new(Self::Leaf(high)),
                };
            }
        }
        Self::Leaf(points)
    }
}
