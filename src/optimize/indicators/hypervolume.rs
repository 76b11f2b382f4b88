//! Exact hypervolume.

/// Volume of what `points` dominate up to the corner `reference`: exact; points that are not below it in every objective
/// add nothing. Larger is better.
///
/// Two objectives are swept in O(N log N). Three are swept by the last one, keeping the staircase of the other two
/// (C. M. Fonseca, L. Paquete, M. Lopez-Ibanez, CEC 2006, doi 10.1109/CEC.2006.1688440), and each further objective cuts
/// the volume into N slices with one objective less, so four take O(N^2 log N) beside moves within the staircase.
///
/// ```
/// use kfgpu::optimize::indicators::hypervolume;
/// assert_eq!(hypervolume(&[&[1.0, 2.0], &[2.0, 1.0]], &[3.0, 3.0]), 3.0);
/// ```
///
/// # Panics
/// If a point has not as many costs as `reference`.
#[must_use]
pub fn hypervolume(points: &[&[f64]], reference: &[f64]) -> f64 {
    assert!(points.iter().all(|p| p.len() == reference.len()), "a point has one cost an objective");
    let inside = |point: &&&[f64]| point.iter().zip(reference).all(|(cost, limit)| cost < limit);
    let points: Vec<&[f64]> = points.iter().filter(inside).copied().collect();
    volume(points, reference)
}

/// Of points inside the reference, which may have more costs than it: only as many count.
fn volume(mut points: Vec<&[f64]>, reference: &[f64]) -> f64 {
    let last = reference.len().saturating_sub(1);
    if points.is_empty() || reference.is_empty() {
        return 0.0;
    }
    points.sort_unstable_by(|a, b| a[last].total_cmp(&b[last]));
    if last == 0 {
        return reference[0] - points[0][0];
    }
    let levels = points.iter().map(|p| p[last]).skip(1).chain([reference[last]]);
    let slices = points.iter().zip(levels).map(|(point, next)| (*point, next - point[last]));
    if last <= 2 {
        let mut staircase = Staircase::new(reference);
        return slices.map(|(point, height)| staircase.add(point, last) * height).sum();
    }
    let covers = |a: &[f64], b: &[f64]| a[..last].iter().zip(b).all(|(a, b)| a <= b);
    let (mut section, mut total) = (Vec::<&[f64]>::new(), 0.0);
    for (point, height) in slices {
        if !section.iter().any(|old| covers(old, point)) {
            section.retain(|old| !covers(point, old));
            section.push(point);
        }
        if height > 0.0 {
            total += height * volume(section.clone(), &reference[..last]);
        }
    }
    total
}

/// What is left of a set of points when all but the leading one or two costs are forgotten, with the length or area that
/// it dominates.
struct Staircase {
    /// Rising in the first cost, falling in the second.
    steps: Vec<[f64; 2]>,
    reference: [f64; 2],
    area: f64,
}

impl Staircase {
    fn new(reference: &[f64]) -> Self {
        Self { steps: Vec::new(), reference: [reference[0], reference[1]], area: 0.0 }
    }

    /// Adds a point by its first `costs` costs, and returns the length or area dominated with it.
    fn add(&mut self, point: &[f64], costs: usize) -> f64 {
        if costs == 1 {
            self.area = self.area.max(self.reference[0] - point[0]);
        } else {
            self.step(point[0], point[1]);
        }
        self.area
    }

    fn step(&mut self, x: f64, y: f64) {
        let place = self.steps.partition_point(|step| step[0] <= x);
        let mut top = place.checked_sub(1).map_or(self.reference[1], |left| self.steps[left][1]);
        if top <= y {
            return;
        }
        let mut from = x;
        let covered = self.steps[place..].iter().take_while(|step| step[1] >= y).count();
        for step in &self.steps[place..place + covered] {
            self.area += (step[0] - from) * (top - y);
            (from, top) = (step[0], step[1]);
        }
        let right = self.steps.get(place + covered).map_or(self.reference[0], |step| step[0]);
        self.area += (right - from) * (top - y);
        self.steps.splice(place..place + covered, [[x, y]]);
    }
}
