//! The few statistics that timings are summed up with: robust ones, since a machine is disturbed
//! now and then, and always in one direction.

/// The value below which the share `q` (0 to 1) of the samples lies, by linear interpolation
/// between neighbours (Hyndman and Fan 1996, type 7); NaN if there is none.
pub fn quantile(samples: &[f64], q: f64) -> f64 {
    let mut sorted = samples.to_vec();
    sorted.sort_unstable_by(f64::total_cmp);
    let Some(last) = sorted.len().checked_sub(1) else { return f64::NAN };
    let at = q.clamp(0.0, 1.0) * last as f64;
    let below = crate::geometry::num::floor_index(at, last);
    let above = (below + 1).min(last);
    sorted[below] + (sorted[above] - sorted[below]) * (at - below as f64)
}

/// The middle sample; NaN if there is none.
pub fn median(samples: &[f64]) -> f64 {
    quantile(samples, 0.5)
}

/// Half the interquartile range, the spread that is printed after `±`; 0 for one sample, NaN for none.
pub fn half_iqr(samples: &[f64]) -> f64 {
    (quantile(samples, 0.75) - quantile(samples, 0.25)) * 0.5
}

/// Counts of many rays, summed exactly, so that their order leaves no trace.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Moments {
    /// How many.
    pub n: u64,
    sum: u128,
    squares: u128,
}

impl Moments {
    /// Adds one.
    pub fn add(&mut self, x: u64) {
        self.n += 1;
        self.sum += u128::from(x);
        self.squares += u128::from(x) * u128::from(x);
    }

    /// Adds others.
    pub fn join(&mut self, other: &Self) {
        self.n += other.n;
        self.sum += other.sum;
        self.squares += other.squares;
    }

    /// NaN if there is none.
    pub fn mean(&self) -> f64 {
        self.sum as f64 / self.n as f64
    }

    /// The standard deviation of one, estimated from these (Bessel's correction); NaN below two.
    pub fn deviation(&self) -> f64 {
        let (n, sum) = (u128::from(self.n), self.sum);
        // n squares - sum^2 is at least 0 in whole numbers; counts that would overflow do not occur.
        let spread = (n.saturating_mul(self.squares)).saturating_sub(sum.saturating_mul(sum));
        (spread as f64 / (self.n as f64 * (self.n as f64 - 1.0))).sqrt()
    }

    /// The standard error of the mean.
    pub fn error(&self) -> f64 {
        self.deviation() / (self.n as f64).sqrt()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_those_of_the_whole() {
        let (mut all, mut rest) = (Moments::default(), Moments::default());
        [2, 4, 4].iter().for_each(|x| all.add(*x));
        [4, 5, 5, 7, 9].iter().for_each(|x| rest.add(*x));
        all.join(&rest);
        assert_eq!((all.n, all.mean()), (8, 5.0));
        assert!((all.deviation() - (32.0f64 / 7.0).sqrt()).abs() < 1e-12);
        assert!((all.error() - all.deviation() / 8f64.sqrt()).abs() < 1e-12);
        assert!(Moments::default().mean().is_nan() && Moments::default().deviation().is_nan());
    }

    #[test]
    fn the_median_is_the_middle_in_any_order() {
        assert_eq!(median(&[3.0, 1.0, 2.0]), 2.0);
        assert_eq!(median(&[4.0, 1.0, 3.0, 2.0]), 2.5);
        assert_eq!(median(&[7.0]), 7.0);
        assert!(median(&[]).is_nan());
    }

    #[test]
    fn the_spread_ignores_a_single_outlier() {
        assert_eq!(half_iqr(&[1.0, 2.0, 3.0, 4.0, 5.0]), 1.0);
        assert_eq!(half_iqr(&[1.0, 2.0, 3.0, 4.0, 5000.0]), 1.0);
        assert_eq!(half_iqr(&[2.0]), 0.0);
        assert!(half_iqr(&[]).is_nan());
    }

    #[test]
    fn quantiles_interpolate_and_stay_in_range() {
        let samples = [10.0, 20.0];
        assert_eq!(quantile(&samples, 0.25), 12.5);
        assert_eq!((quantile(&samples, -1.0), quantile(&samples, 9.0)), (10.0, 20.0));
    }
}
