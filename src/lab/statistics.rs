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

#[cfg(test)]
mod tests {
    use super::*;

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
