//! An evenly spread part of a long list, for when all of it would take too long.

use crate::geometry::num::floor_index;

/// `n` indices below `len`, ascending and all different; every index if `n` is not less.
///
/// One from each of `n` equal strata, at a place in the stratum that the golden ratio chooses:
/// plain strides would fall into step with the rows of a picture and see one column of it.
pub fn spread(len: usize, n: usize) -> Vec<usize> {
    const GOLDEN: f64 = 0.618_033_988_749_894_9;
    if n >= len {
        return (0..len).collect();
    }
    let width = len as f64 / n as f64;
    let pick = |i: usize| floor_index((i as f64 + (i as f64 * GOLDEN).fract()) * width, len - 1);
    // Strata begin between whole numbers, so two picks may round to one.
    let mut picks: Vec<usize> = (0..n).map(pick).collect();
    picks.dedup();
    picks
}

/// The values at `n` evenly spread places.
pub fn pick<T: Copy>(list: &[T], n: usize) -> Vec<T> {
    spread(list.len(), n).into_iter().map(|i| list[i]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_spread_is_ascending_and_meets_every_column() {
        let (width, height) = (1280, 800);
        let picks = spread(width * height, height);
        assert!(picks.windows(2).all(|w| w[0] < w[1]) && picks.len() == height);
        let mut columns: Vec<usize> = picks.iter().map(|i| i % width * 16 / width).collect();
        columns.sort_unstable();
        columns.dedup();
        assert_eq!(columns.len(), 16, "all sixteenths of the width are met");
    }

    #[test]
    fn all_are_taken_where_there_are_few() {
        assert_eq!(spread(3, 10), [0, 1, 2]);
        assert!(spread(0, 10).is_empty() && spread(10, 0).is_empty());
        assert_eq!(pick(&["a", "b"], 2), ["a", "b"]);
        let most = spread(1000, 999);
        assert!(most.windows(2).all(|w| w[0] < w[1]) && most.len() > 600);
    }
}
