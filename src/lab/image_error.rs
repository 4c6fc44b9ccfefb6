//! How far a picture is from a reference: five measures, of linear light but for the last.

use serde::Serialize;

/// A measure.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Metric {
    /// Root mean squared error.
    Rmse,
    /// Relative mean squared error.
    RelMse,
    /// Mean absolute error.
    Mae,
    /// Symmetric mean absolute percentage error.
    Smape,
    /// What an eye sees that flips between the two (Andersson et al. 2020).
    Flip,
}

impl Metric {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 5] = [Self::Rmse, Self::RelMse, Self::Mae, Self::Smape, Self::Flip];

    /// The name in tables.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Rmse => "RMSE",
            Self::RelMse => "relMSE",
            Self::Mae => "MAE",
            Self::Smape => "SMAPE",
            Self::Flip => "FLIP",
        }
    }

    /// What is computed: of a value v and that of the reference r, over all pixels and their red, green and blue.
    pub const fn formula(self) -> &'static str {
        match self {
            Self::Rmse => "sqrt(mean((v - r)^2))",
            Self::RelMse => "mean((v - r)^2 / (r^2 + 0.01))",
            Self::Mae => "mean(|v - r|)",
            Self::Smape => "mean(2 |v - r| / (|v| + |r|)), 0 where both are 0",
            Self::Flip => "mean of the LDR-FLIP map; exposure 0 stops, plain tone map, sRGB of 8 bits, 67 pixels per degree",
        }
    }
}

/// The errors of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ImageErrors {
    /// [`Metric::Rmse`].
    pub rmse: f64,
    /// [`Metric::RelMse`].
    pub relmse: f64,
    /// [`Metric::Mae`].
    pub mae: f64,
    /// [`Metric::Smape`].
    pub smape: f64,
    /// [`Metric::Flip`], where this program has it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub flip: Option<f64>,
}

impl ImageErrors {
    /// Of a picture of linear light, row by row in `width` columns, beside a reference of the same size. All but
    /// [`Metric::Flip`].
    pub fn of(picture: &[[f32; 3]], reference: &[[f32; 3]]) -> Self {
        let n = (picture.len().min(reference.len()) * 3).max(1) as f64;
        let mut sums = [0.0f64; 4];
        for (v, r) in picture.as_flattened().iter().zip(reference.as_flattened()) {
            let (v, r) = (f64::from(*v), f64::from(*r));
            let error = (v - r).abs();
            let sizes = v.abs() + r.abs();
            sums[0] += error * error;
            sums[1] += error * error / (r * r + 0.01);
            sums[2] += error;
            sums[3] += if sizes > 0.0 { 2.0 * error / sizes } else { 0.0 };
        }
        let [squares, relative, absolute, symmetric] = sums.map(|sum| sum / n);
        Self { rmse: squares.sqrt(), relmse: relative, mae: absolute, smape: symmetric, flip: None }
    }
}

impl ImageErrors {
    /// The same with [`Metric::Flip`], of pictures of that size; where this program has it.
    #[must_use]
    pub fn with_flip(self, picture: &[[f32; 3]], reference: &[[f32; 3]], size: [u32; 2]) -> Self {
        Self { flip: flip(picture, reference, size), ..self }
    }
}

#[cfg(feature = "flip")]
fn flip(picture: &[[f32; 3]], reference: &[[f32; 3]], [width, height]: [u32; 2]) -> Option<f64> {
    let pixels = width as usize * height as usize;
    if pixels == 0 || picture.len() != pixels || reference.len() != pixels {
        return None;
    }
    let shown = |light: &[[f32; 3]]| {
        let bytes: Vec<u8> = light.as_flattened().iter().map(|x| (crate::render::encode(*x) * 255.0 + 0.5) as u8).collect();
        nv_flip::FlipImageRgb8::with_data(width, height, &bytes)
    };
    let map = nv_flip::flip(shown(reference), shown(picture), nv_flip::DEFAULT_PIXELS_PER_DEGREE);
    Some(f64::from(nv_flip::FlipPool::from_image(&map).mean()))
}

#[cfg(not(feature = "flip"))]
fn flip(_: &[[f32; 3]], _: &[[f32; 3]], _: [u32; 2]) -> Option<f64> {
    None
}

/// The root mean squared difference of two pictures.
pub fn rms_difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f64 {
    ImageErrors::of(a, b).rmse
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_measure_is_its_formula() {
        let (v, r) = ([[1.0, 0.5, 0.0], [0.0, 0.0, 2.0]], [[0.5, 0.5, 0.0], [0.2, 0.0, 1.0]]);
        let errors = ImageErrors::of(&v, &r);
        let is = |a: f64, b: f64| assert!((a - b).abs() < 1e-7 * b, "{a} is not {b}");
        is(errors.rmse, ((0.25 + 0.04 + 1.0f64) / 6.0).sqrt());
        is(errors.relmse, (0.25 / 0.26 + 0.04 / 0.05 + 1.0 / 1.01) / 6.0);
        is(errors.mae, 1.7 / 6.0);
        is(errors.smape, (2.0 * 0.5 / 1.5 + 2.0 + 2.0 / 3.0) / 6.0);
        let both = errors.with_flip(&v, &r, [2, 1]);
        assert_eq!((both.flip.is_some(), both.rmse), (cfg!(feature = "flip"), errors.rmse));
        assert_eq!(errors.with_flip(&v, &r, [7, 1]).flip, None, "a size that is not theirs");
        assert!(
            errors.with_flip(&r, &r, [2, 1]).flip.unwrap_or(0.0) == 0.0
                && both.flip.is_none_or(|flip| flip > 0.05 && flip <= 1.0)
        );
        assert_eq!(ImageErrors::of(&r, &r), ImageErrors { rmse: 0.0, relmse: 0.0, mae: 0.0, smape: 0.0, flip: None });
    }
}
