//! Exact sums of products of 32-bit floats (Shewchuk 1997, "Adaptive Precision Floating-Point Arithmetic and Fast
//! Robust Geometric Predicates"): a number as a sum of 64-bit floats that do not overlap, the smallest first.
//!
//! A product of three 32-bit floats lies between `2^-447` and `2^384`, so nothing over- or underflows here.

/// A sum of up to `N` parts, exactly. Its parts grow and do not overlap, so the last one has its sign.
#[derive(Clone, Copy, Debug)]
pub struct Expansion<const N: usize> {
    parts: [f64; N],
    len: usize,
}

impl<const N: usize> Expansion<N> {
    /// Zero.
    pub const fn zero() -> Self {
        Self { parts: [0.0; N], len: 0 }
    }

    /// Adds a number (Shewchuk 1997, figure 6). Parts that are zero are left out. No more than `N` may be added.
    pub fn add(&mut self, x: f64) {
        let (mut sum, mut kept) = (x, 0);
        for i in 0..self.len {
            let rest;
            (sum, rest) = two_sum(sum, self.parts[i]);
            if rest != 0.0 {
                self.parts[kept] = rest;
                kept += 1;
            }
        }
        if sum != 0.0 {
            self.parts[kept] = sum;
            kept += 1;
        }
        self.len = kept;
    }

    /// Adds `sign` times the product of three numbers that 32 bits hold; two parts.
    pub fn add_product(&mut self, sign: f64, [a, b, c]: [f64; 3]) {
        if a * b * c == 0.0 {
            return;
        }
        let (high, low) = split(a * b);
        self.add(sign * low * c);
        self.add(sign * high * c);
    }

    /// Adds `sign` times the determinant of three rows of numbers that 32 bits hold; twelve parts.
    pub fn add_determinant(&mut self, sign: f64, [x, y, z]: [[f64; 3]; 3]) {
        for (i, j, k) in [(0, 1, 2), (1, 2, 0), (2, 0, 1)] {
            self.add_product(sign, [x[i], y[j], z[k]]);
            self.add_product(-sign, [x[i], y[k], z[j]]);
        }
    }

    /// Adds another times a number of at most 26 bits; two parts for each of the other's.
    pub fn add_scaled<const M: usize>(&mut self, other: &Expansion<M>, by: f64) {
        for part in other.parts() {
            let (high, low) = split(*part);
            self.add(low * by);
            self.add(high * by);
        }
    }

    /// The parts, the smallest first.
    pub fn parts(&self) -> &[f64] {
        &self.parts[..self.len]
    }

    /// -1, 0 or 1.
    pub fn sign(&self) -> f64 {
        if self.len == 0 { 0.0 } else { self.parts[self.len - 1].signum() }
    }

    /// The nearest number that 64 bits hold, within two units of its last place.
    pub fn estimate(&self) -> f64 {
        self.parts().iter().sum()
    }
}

/// The sum and what rounding took from it (Knuth).
fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let of_b = sum - a;
    (sum, (a - (sum - of_b)) + (b - of_b))
}

/// Two numbers of at most 26 bits that sum up to `x` (Veltkamp; Dekker 1971).
fn split(x: f64) -> (f64, f64) {
    const SPLITTER: f64 = ((1u64 << 27) + 1) as f64;
    let big = SPLITTER * x;
    let high = big - (big - x);
    (high, x - high)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_64_bits_lose_is_kept() {
        let mut sum = Expansion::<8>::zero();
        [1e30, 1.0, -1e30, 1e-30].into_iter().for_each(|x| sum.add(x));
        assert_eq!(sum.estimate(), 1.0);
        sum.add(-1.0);
        assert_eq!((sum.sign(), sum.estimate()), (1.0, 1e-30));
        sum.add(-1e-30);
        assert_eq!((sum.sign(), sum.estimate()), (0.0, 0.0));
    }

    #[test]
    fn a_determinant_of_dependent_rows_is_zero() {
        let f = |x: f32| f64::from(x);
        let (x, y) = ([f(0.1), f(3.7e-12), f(1e20)], [f(-7.3e9), f(0.3), f(1e-30)]);
        let mut sum = Expansion::<24>::zero();
        sum.add_determinant(1.0, [x, y, x.map(|c| 2.0 * c)]);
        assert_eq!(sum.sign(), 0.0);
        sum.add_determinant(1.0, [x, y, [0.0, 0.0, f(1e-45)]]);
        assert_eq!(sum.sign(), 1.0, "{sum:?}");
    }
}
