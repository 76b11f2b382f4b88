//! Fewer members, evenly spread.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Neighbours of each member in the order of one objective; `None` beyond the ends.
struct Order {
    before: Vec<Option<usize>>,
    after: Vec<Option<usize>>,
    /// Largest minus smallest cost; 1 where they are equal.
    range: f64,
}

impl Order {
    fn of(column: &[f64]) -> Self {
        let mut order: Vec<usize> = (0..column.len()).collect();
        order.sort_by(|a, b| column[*a].total_cmp(&column[*b]));
        let (mut before, mut after) = (vec![None; column.len()], vec![None; column.len()]);
        for pair in order.windows(2) {
            after[pair[0]] = Some(pair[1]);
            before[pair[1]] = Some(pair[0]);
        }
        let range = order.first().zip(order.last()).map_or(0.0, |(low, high)| column[*high] - column[*low]);
        Self { before, after, range: if range > 0.0 { range } else { 1.0 } }
    }

    /// Takes a member out; gives those that stood beside it.
    fn remove(&mut self, i: usize) -> [Option<usize>; 2] {
        let (before, after) = (self.before[i], self.after[i]);
        if let Some(before) = before {
            self.after[before] = after;
        }
        if let Some(after) = after {
            self.before[after] = before;
        }
        [before, after]
    }

    fn gap(&self, column: &[f64], i: usize) -> f64 {
        self.before[i].zip(self.after[i]).map_or(f64::INFINITY, |(b, a)| (column[a] - column[b]) / self.range)
    }
}

/// Which members stay when the most crowded one is removed again and again until `capacity` are left, crowding worked
/// out anew each time: all at once would empty whole regions (S. Kukkonen, K. Deb, CEC 2006,
/// doi 10.1109/CEC.2006.1688443). `columns` are the costs, one column an objective. The best and the worst of every
/// objective go last. O(M N log N).
pub(super) fn spread_out(columns: &[Vec<f64>], capacity: usize) -> Vec<bool> {
    let n = columns.first().map_or(0, Vec::len);
    let mut orders: Vec<Order> = columns.iter().map(|column| Order::of(column)).collect();
    // A distance is never below 0, so its bits are ordered as it is.
    let crowding = |orders: &[Order], i: usize| {
        orders.iter().zip(columns).map(|(order, column)| order.gap(column, i)).sum::<f64>().to_bits()
    };
    let mut current: Vec<u64> = (0..n).map(|i| crowding(&orders, i)).collect();
    let mut queue: BinaryHeap<Reverse<(u64, usize)>> = (0..n).map(|i| Reverse((current[i], i))).collect();
    let mut keep = vec![true; n];
    let mut left = n;
    while left > capacity {
        let Some(Reverse((distance, i))) = queue.pop() else { break };
        if !keep[i] || distance != current[i] {
            continue;
        }
        keep[i] = false;
        left -= 1;
        let beside: Vec<usize> = orders.iter_mut().flat_map(|order| order.remove(i)).flatten().collect();
        for neighbour in beside {
            let distance = crowding(&orders, neighbour);
            if distance != current[neighbour] {
                current[neighbour] = distance;
                queue.push(Reverse((distance, neighbour)));
            }
        }
    }
    keep
}

#[cfg(test)]
mod tests {
    use super::*;

    fn kept(columns: &[Vec<f64>], capacity: usize) -> Vec<usize> {
        spread_out(columns, capacity).iter().enumerate().filter(|(_, keep)| **keep).map(|(i, _)| i).collect()
    }

    /// On a line the costs are x and 1 - x, so crowding is twice the gap between neighbours.
    #[test]
    fn the_most_crowded_go_first_and_the_ends_stay() {
        let x = [0.0, 0.1, 0.11, 0.12, 0.5, 0.8, 1.0];
        let columns = [x.to_vec(), x.iter().map(|x| 1.0 - x).collect()];
        // 0.11 has gap 0.02; then 0.1 has 0.12 before 0.12 has 0.4; then 0.12 and 0.8 have 0.5 each.
        assert_eq!(kept(&columns, 6), [0, 1, 3, 4, 5, 6]);
        assert_eq!(kept(&columns, 5), [0, 3, 4, 5, 6]);
        assert_eq!(kept(&columns, 2), [0, 6], "ends stay");
        assert_eq!(kept(&columns, 9), [0, 1, 2, 3, 4, 5, 6]);
        assert_eq!(spread_out(&[vec![], vec![]], 3), Vec::<bool>::new());
    }

    /// Half of the members stand in one hundredth of the front; removing all at once by their first crowding would leave
    /// none of them.
    #[test]
    fn a_dense_region_is_thinned_and_not_emptied() {
        let dense = (0..50).map(|i| 0.5 + f64::from(i) * 2e-4);
        let x: Vec<f64> = (0..50).map(|i| f64::from(i) / 49.0).chain(dense).collect();
        let columns = [x.clone(), x.iter().map(|x| 1.0 - x).collect()];
        let mut left: Vec<f64> = kept(&columns, 50).iter().map(|i| x[*i]).collect();
        left.sort_by(f64::total_cmp);
        let widest = left.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        assert!(widest < 2.1 / 49.0, "the widest gap is {widest}");
    }
}
