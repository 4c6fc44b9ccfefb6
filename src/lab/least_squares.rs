//! Least squares of the two kinds that reports need: a straight line, and three costs that cannot be
//! negative.

/// A straight line through points.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Line {
    /// How much y grows where x grows by 1.
    pub slope: f64,
    /// y at x = 0.
    pub intercept: f64,
    /// The standard error of the slope; NaN (`null` in JSON) for fewer than three points.
    pub slope_error: f64,
}

/// The line that has the least sum of squared distances in y; `None` for fewer than two places x.
pub fn line(points: &[(f64, f64)]) -> Option<Line> {
    let n = points.len() as f64;
    let mean = |of: fn(&(f64, f64)) -> f64| points.iter().map(of).sum::<f64>() / n;
    let (x, y) = (mean(|p| p.0), mean(|p| p.1));
    let spread = points.iter().map(|p| (p.0 - x) * (p.0 - x)).sum::<f64>();
    if points.len() < 2 || spread.is_nan() || spread <= 0.0 {
        return None;
    }
    let slope = points.iter().map(|p| (p.0 - x) * (p.1 - y)).sum::<f64>() / spread;
    let intercept = y - slope * x;
    let left = points.iter().map(|p| (p.1 - intercept - slope * p.0).powi(2)).sum::<f64>();
    let slope_error = if points.len() > 2 { (left / (n - 2.0) / spread).sqrt() } else { f64::NAN };
    Some(Line { slope, intercept, slope_error })
}

/// Three coefficients, none negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fit {
    /// Of each column; 0 where the best would be negative, or where the columns do not tell it apart.
    pub coefficients: [f64; 3],
    /// Their standard errors, given which of them are 0; NaN for those.
    pub errors: [f64; 3],
    /// The share of the variance of y that is explained (R squared); NaN if y does not vary.
    pub explained: f64,
}

/// The coefficients c >= 0 with the least sum of squared `y - row . c`.
///
/// With three of them every choice of which are 0 is tried, and the best of those without a negative
/// one taken: what the general method (Lawson and Hanson 1974, ch. 23) comes to. `None` if no choice
/// is determined by the rows.
pub fn non_negative(rows: &[[f64; 3]], y: &[f64]) -> Option<Fit> {
    let mut best: Option<(f64, Fit)> = None;
    for choice in (1..8usize).rev() {
        let free: Vec<usize> = (0..3).filter(|k| choice >> k & 1 == 1).collect();
        let Some((fit, left)) = fit_some(rows, y, &free) else { continue };
        let feasible = fit.coefficients.iter().all(|c| *c >= 0.0);
        if feasible && best.as_ref().is_none_or(|(least, _)| left < *least) {
            best = Some((left, fit));
        }
    }
    best.map(|(_, fit)| fit)
}

/// Ordinary least squares with the columns `free`, and the sum of squares that is left.
fn fit_some(rows: &[[f64; 3]], y: &[f64], free: &[usize]) -> Option<(Fit, f64)> {
    let n = rows.len().min(y.len());
    // Columns of length one, so that the inverse tells whether they can be told apart.
    let lengths: Vec<f64> = free.iter().map(|k| rows.iter().map(|row| row[*k] * row[*k]).sum::<f64>().sqrt()).collect();
    if n <= free.len() || lengths.iter().any(|length| length.is_nan() || *length <= 0.0) {
        return None;
    }
    let mut normal = [[0.0; 3]; 3];
    let mut right = [0.0; 3];
    for (row, y) in rows.iter().zip(y) {
        let x: Vec<f64> = free.iter().zip(&lengths).map(|(k, length)| row[*k] / length).collect();
        for i in 0..x.len() {
            right[i] += x[i] * y;
            (0..x.len()).for_each(|j| normal[i][j] += x[i] * x[j]);
        }
    }
    let inverse = invert(&normal, free.len())?;
    let mut fit = Fit { coefficients: [0.0; 3], errors: [f64::NAN; 3], explained: f64::NAN };
    for (i, k) in free.iter().enumerate() {
        fit.coefficients[*k] = (0..free.len()).map(|j| inverse[i][j] * right[j]).sum::<f64>() / lengths[i];
    }
    let told = |row: &[f64; 3]| row.iter().zip(&fit.coefficients).map(|(x, c)| x * c).sum::<f64>();
    let left: f64 = rows.iter().zip(y).map(|(row, y)| (y - told(row)).powi(2)).sum();
    let mean = y[..n].iter().sum::<f64>() / n as f64;
    let spread: f64 = y[..n].iter().map(|y| (y - mean).powi(2)).sum();
    fit.explained = if spread > 0.0 { 1.0 - left / spread } else { f64::NAN };
    let variance = left / (n - free.len()) as f64;
    for (i, k) in free.iter().enumerate() {
        fit.errors[*k] = (variance * inverse[i][i].max(0.0)).sqrt() / lengths[i];
    }
    Some((fit, left))
}

/// The inverse of the upper left `n` by `n` of a symmetric matrix with a diagonal of ones (Gauss and
/// Jordan); `None` where columns cannot be told apart.
fn invert(matrix: &[[f64; 3]; 3], n: usize) -> Option<[[f64; 3]; 3]> {
    /// Below this what is left of a column is rounding.
    const NOTHING: f64 = 1e-9;
    let (mut m, mut inverse) = (*matrix, [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| m[*a][k].abs().total_cmp(&m[*b][k].abs()))?;
        m.swap(k, pivot);
        inverse.swap(k, pivot);
        let by = m[k][k];
        if by.is_nan() || by.abs() < NOTHING {
            return None;
        }
        for j in 0..n {
            m[k][j] /= by;
            inverse[k][j] /= by;
        }
        for i in (0..n).filter(|i| *i != k) {
            let times = m[i][k];
            for j in 0..n {
                m[i][j] -= times * m[k][j];
                inverse[i][j] -= times * inverse[k][j];
            }
        }
    }
    Some(inverse)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_with_its_error() {
        let exact = line(&[(0.0, 1.0), (1.0, 3.0), (2.0, 5.0)]).expect("three points");
        assert_eq!((exact.slope, exact.intercept, exact.slope_error), (2.0, 1.0, 0.0));
        // By hand: slope 1/2, residuals 1/6, -1/3, 1/6, so 1/6 is left over 1 degree and a spread of 2.
        let rough = line(&[(0.0, 0.0), (1.0, 0.0), (2.0, 1.0)]).expect("three points");
        assert!((rough.slope - 0.5).abs() < 1e-12 && (rough.slope_error - (1.0f64 / 12.0).sqrt()).abs() < 1e-12);
        assert!(line(&[(0.0, 1.0), (1.0, 2.0)]).is_some_and(|l| l.slope == 1.0 && l.slope_error.is_nan()));
        assert!(line(&[(1.0, 1.0)]).is_none() && line(&[(1.0, 1.0), (1.0, 2.0)]).is_none() && line(&[]).is_none());
    }

    fn rows() -> Vec<[f64; 3]> {
        (0..20u8).map(|i| [f64::from(i % 5) + 3.0, f64::from(i % 7) + 1.0, 1.0]).collect()
    }

    #[test]
    fn costs_that_made_the_times_are_found() {
        let y: Vec<f64> = rows().iter().map(|r| 4.0 * r[0] + 2.5 * r[1] + 10.0).collect();
        let fit = non_negative(&rows(), &y).expect("determined");
        let close = |a: f64, b: f64| (a - b).abs() < 1e-9;
        assert!(close(fit.coefficients[0], 4.0) && close(fit.coefficients[1], 2.5) && close(fit.coefficients[2], 10.0));
        assert!((fit.explained - 1.0).abs() < 1e-12 && fit.errors.iter().all(|e| *e < 1e-6), "{fit:?}");
    }

    #[test]
    fn no_cost_is_negative() {
        let y: Vec<f64> = rows().iter().map(|r| 4.0 * r[0] - 0.5 * r[1] + 10.0).collect();
        let fit = non_negative(&rows(), &y).expect("determined");
        assert!(fit.coefficients[1] == 0.0 && fit.errors[1].is_nan(), "{fit:?}");
        assert!(fit.coefficients[0] > 3.0 && fit.explained < 1.0, "{fit:?}");
        let none = non_negative(&rows(), &[-1.0; 20]);
        assert!(none.is_none(), "{none:?}");
    }

    #[test]
    fn columns_that_cannot_be_told_apart_are_not_both_used() {
        // As brute force has it: one node for every ray.
        let rows: Vec<[f64; 3]> = (1..9u8).map(|i| [1.0, f64::from(i), 1.0]).collect();
        let y: Vec<f64> = rows.iter().map(|r| 3.0 * r[1] + 2.0).collect();
        let fit = non_negative(&rows, &y).expect("two columns are enough");
        assert!((fit.coefficients[1] - 3.0).abs() < 1e-9);
        assert!((fit.coefficients[0] + fit.coefficients[2] - 2.0).abs() < 1e-9, "{fit:?}");
        assert!(non_negative(&[[1.0, 2.0, 1.0]], &[1.0]).is_none() && non_negative(&[], &[]).is_none());
    }
}
