//! A square of numbers, each once, without low frequencies: neighbours differ as much as they can (blue noise), by
//! void-and-cluster (Ulichney 1993, "The void-and-cluster method for dither array generation").

use std::sync::LazyLock;

/// Columns and rows.
pub const SIDE: u32 = 64;
const CELLS: usize = (SIDE * SIDE) as usize;
/// How far a point crowds others, in cells (Ulichney's choice).
const SIGMA: f32 = 1.5;
/// Beyond it nothing is left of that.
const REACH: i32 = 7;
/// Points of the first pattern: a tenth of all.
const FIRST: usize = CELLS / 10;

/// The rank of each cell, row by row, from 0.
pub static RANKS: LazyLock<Vec<u16>> = LazyLock::new(ranks);

/// Where points are, and how crowded each cell is by them. The square repeats in both directions.
struct Pattern {
    points: Vec<bool>,
    crowd: Vec<f32>,
}

impl Pattern {
    fn set(&mut self, cell: usize, there: bool) {
        self.points[cell] = there;
        let side = SIDE.cast_signed();
        let (x, y) = ((cell as u32 % SIDE).cast_signed(), (cell as u32 / SIDE).cast_signed());
        let sign = if there { 1.0 } else { -1.0 };
        for dy in -REACH..=REACH {
            for dx in -REACH..=REACH {
                let at = ((y + dy).rem_euclid(side) * side + (x + dx).rem_euclid(side)).cast_unsigned();
                self.crowd[at as usize] += sign * (-((dx * dx + dy * dy) as f32) / (2.0 * SIGMA * SIGMA)).exp();
            }
        }
    }

    /// The most crowded point, or the least crowded place without one.
    fn extreme(&self, of_points: bool) -> usize {
        let sign = if of_points { 1.0 } else { -1.0 };
        let there = (0..CELLS).filter(|cell| self.points[*cell] == of_points);
        there.max_by(|a, b| (sign * self.crowd[*a]).total_cmp(&(sign * self.crowd[*b]))).unwrap_or(0)
    }
}

fn ranks() -> Vec<u16> {
    let mut pattern = Pattern { points: vec![false; CELLS], crowd: vec![0.0; CELLS] };
    for i in 0..FIRST as u32 {
        // Anywhere, and nowhere twice: a factor without divisors in common with the number of cells.
        pattern.set((i as usize * 1597) % CELLS, true);
    }
    loop {
        // Points move from where they are crowded to where there are none, until that is the same place.
        let cluster = pattern.extreme(true);
        pattern.set(cluster, false);
        let void = pattern.extreme(false);
        pattern.set(void, true);
        if void == cluster {
            break;
        }
    }
    let mut ranks = vec![0; CELLS];
    let first: Vec<usize> = (0..CELLS).filter(|cell| pattern.points[*cell]).collect();
    // Of the pattern's own points, the most crowded comes last.
    let mut thinned = Pattern { points: pattern.points.clone(), crowd: pattern.crowd.clone() };
    for rank in (0..first.len() as u16).rev() {
        let cell = thinned.extreme(true);
        thinned.set(cell, false);
        ranks[cell] = rank;
    }
    for rank in first.len() as u16..CELLS as u16 {
        let cell = pattern.extreme(false);
        pattern.set(cell, true);
        ranks[cell] = rank;
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_rank_is_there_once_and_neighbours_are_far_apart() {
        let mut seen = RANKS.clone();
        seen.sort_unstable();
        assert!(seen.iter().enumerate().all(|(i, rank)| usize::from(*rank) == i) && seen.len() == CELLS);
        // The mean of the four neighbours' differences; a third of all for random ranks.
        let side = SIDE as usize;
        let apart = |a: usize, b: usize| f64::from(RANKS[a].abs_diff(RANKS[b]));
        let sum: f64 = (0..CELLS).map(|i| apart(i, (i + 1) % CELLS) + apart(i, (i + side) % CELLS)).sum();
        let mean = sum / (2 * CELLS) as f64 / CELLS as f64;
        assert!(mean > 0.39, "{mean}");
        // The sums of squares of eight by eight cells hardly differ: no low frequencies.
        let block = |b: usize| {
            let (x, y) = (b % 8 * 8, b / 8 * 8);
            (0..64).map(|i| f64::from(RANKS[(y + i / 8) * side + x + i % 8])).sum::<f64>() / 64.0 / CELLS as f64
        };
        let spread = (0..64).map(|b| (block(b) - 0.5).powi(2)).sum::<f64>() / 64.0;
        // Of random ranks it is 1/12/64.
        assert!(spread < 0.15 / 12.0 / 64.0, "{spread}");
    }
}
