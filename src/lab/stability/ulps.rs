//! The greatest of many errors: enough of them for a quantile near the end, in little memory.

use crate::geometry::num;

/// Errors of which the greatest are kept.
#[derive(Clone, Debug)]
pub struct Tail {
    greatest: Vec<f64>,
    keep: usize,
    count: usize,
}

impl Tail {
    /// Of at most `count` errors as many as the quantile `q`, near 1, needs.
    pub fn new(count: usize, q: f64) -> Self {
        Self { greatest: Vec::new(), keep: num::floor_index((1.0 - q) * count as f64, count) + 3, count: 0 }
    }

    /// Adds one.
    pub fn add(&mut self, error: f64) {
        self.count += 1;
        self.greatest.push(error);
        if self.greatest.len() >= 2 * self.keep {
            self.cut();
        }
    }

    fn cut(&mut self) {
        self.greatest.sort_unstable_by(|a, b| b.total_cmp(a));
        self.greatest.truncate(self.keep);
    }

    /// The greatest; 0 if there is none.
    pub fn max(&self) -> f64 {
        self.greatest.iter().copied().fold(0.0, f64::max)
    }

    /// The quantile that it was made for or one nearer to the end, as [`crate::lab::statistics::quantile`] has it; 0 if there is none.
    pub fn quantile(&mut self, q: f64) -> f64 {
        self.cut();
        let Some(last) = self.count.checked_sub(1) else { return 0.0 };
        let at = (1.0 - q) * last as f64;
        let above = num::floor_index(at, last);
        let of = |i: usize| self.greatest.get(i.min(last)).or(self.greatest.last()).copied().unwrap_or(0.0);
        of(above) + (of(above + 1) - of(above)) * (at - above as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::statistics::quantile;
    use crate::scene::builtin::Random;

    #[test]
    fn the_tail_is_that_of_all() {
        let mut random = Random::new(3, 0);
        for n in [0, 1, 2, 999, 1000, 1001, 20_000] {
            let all: Vec<f64> = (0..n).map(|_| f64::from(random.unit())).collect();
            let mut tail = Tail::new(n, 0.999);
            all.iter().for_each(|x| tail.add(*x));
            let wanted = if n == 0 { 0.0 } else { quantile(&all, 0.999) };
            assert!((tail.quantile(0.999) - wanted).abs() < 1e-12, "{n}");
            assert_eq!(tail.max(), all.iter().copied().fold(0.0, f64::max));
            assert!(tail.greatest.len() <= n / 1000 + 3);
        }
    }
}
