//! Numbers of the form m 2^e, exactly: what sums and products of floats are. Written with big integers, so that it
//! shares nothing with the test that it judges.

use std::cmp::Ordering;
use std::ops::{Add, Mul, Sub};

use num_bigint::{BigInt, Sign};
use num_traits::ToPrimitive;

/// `mantissa * 2^exponent`.
#[derive(Clone, Debug)]
pub struct Dyadic {
    mantissa: BigInt,
    exponent: i64,
}

impl Dyadic {
    /// Of a finite float.
    pub fn new(x: f64) -> Self {
        const MANTISSA: u32 = 52;
        let bits = x.to_bits();
        let exponent = i64::from((bits >> MANTISSA & 0x7FF) as u16);
        let fraction = bits & ((1 << MANTISSA) - 1);
        let (mantissa, exponent) = if exponent == 0 { (fraction, -1074) } else { (fraction | 1 << MANTISSA, exponent - 1075) };
        let sign = if x.is_sign_negative() { Sign::Minus } else { Sign::Plus };
        Self { mantissa: BigInt::from_biguint(sign, mantissa.into()), exponent }
    }

    /// -1, 0 or 1.
    pub fn sign(&self) -> i8 {
        match self.mantissa.sign() {
            Sign::Minus => -1,
            Sign::NoSign => 0,
            Sign::Plus => 1,
        }
    }

    /// The quotient, within two units of its last place; `other` is not zero.
    pub fn over(&self, other: &Self) -> f64 {
        let close = |m: &BigInt| {
            // 64 bits are enough, and keep the quotient far from the ends of what a float holds.
            let spare = m.bits().saturating_sub(64);
            ((m >> spare).to_f64().unwrap_or(f64::NAN), i64::try_from(spare).unwrap_or(i64::MAX))
        };
        let ((a, a_spare), (b, b_spare)) = (close(&self.mantissa), close(&other.mantissa));
        let exponent = (self.exponent + a_spare) - (other.exponent + b_spare);
        let half = i32::try_from(exponent / 2).unwrap_or(i32::MAX);
        let rest = i32::try_from(exponent - exponent / 2).unwrap_or(i32::MAX);
        a / b * 2.0f64.powi(half) * 2.0f64.powi(rest)
    }

    /// How it compares with another.
    pub fn compare(&self, other: &Self) -> Ordering {
        (self - other).sign().cmp(&0)
    }

    /// Both mantissas for the lesser exponent.
    fn aligned(&self, other: &Self) -> (BigInt, BigInt, i64) {
        let exponent = self.exponent.min(other.exponent);
        (&self.mantissa << (self.exponent - exponent), &other.mantissa << (other.exponent - exponent), exponent)
    }
}

impl Add for &Dyadic {
    type Output = Dyadic;

    fn add(self, other: Self) -> Dyadic {
        let (a, b, exponent) = self.aligned(other);
        Dyadic { mantissa: a + b, exponent }
    }
}

impl Sub for &Dyadic {
    type Output = Dyadic;

    fn sub(self, other: Self) -> Dyadic {
        let (a, b, exponent) = self.aligned(other);
        Dyadic { mantissa: a - b, exponent }
    }
}

impl Mul for &Dyadic {
    type Output = Dyadic;

    fn mul(self, other: Self) -> Dyadic {
        Dyadic { mantissa: &self.mantissa * &other.mantissa, exponent: self.exponent + other.exponent }
    }
}

/// A point or a direction.
pub type Exactly = [Dyadic; 3];

/// The difference of two points.
pub fn minus(a: &Exactly, b: &Exactly) -> Exactly {
    [&a[0] - &b[0], &a[1] - &b[1], &a[2] - &b[2]]
}

/// `x . (y x z)`.
pub fn determinant(x: &Exactly, y: &Exactly, z: &Exactly) -> Dyadic {
    let minor = |i: usize, j: usize| &(&y[i] * &z[j]) - &(&y[j] * &z[i]);
    &(&(&x[0] * &minor(1, 2)) + &(&x[1] * &minor(2, 0))) + &(&x[2] * &minor(0, 1))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_what_they_were() {
        for x in [0.0, -0.0, 1.0, -0.1, 1e-310, f64::MAX, f64::from(f32::from_bits(1))] {
            let (exact, two) = (Dyadic::new(x), Dyadic::new(2.0));
            assert_eq!(exact.sign(), if x == 0.0 { 0 } else { x.signum() as i8 });
            assert_eq!((&exact * &two).over(&two), x);
            assert_eq!((&(&exact + &two) - &two).compare(&exact), Ordering::Equal, "{x}");
        }
    }

    #[test]
    fn what_64_bits_lose_counts() {
        let of = |x: [f64; 3]| x.map(Dyadic::new);
        let (a, b) = (of([0.1, 3e-20, 7.0]), of([1e10, 0.3, -1e-5]));
        assert_eq!(determinant(&a, &b, &of([0.2, 6e-20, 14.0])).sign(), 0);
        assert_eq!(determinant(&a, &b, &of([0.2, 6e-20, 14.0f64.next_up()])).sign(), 1);
    }
}
