//! How sure each pixel's mean is, so that those that have converged get no more samples.
//!
//! A pixel is sure once the standard error of what it shows is below half a step of a picture's 256. Errors are estimated
//! from the samples themselves, which may have missed something small: so a pixel goes on as long as one of its neighbours
//! does, and for some samples in any case. Leaving pixels out this way biases the picture by less than what it shows.

use rayon::prelude::*;

use super::develop::encode;

/// The samples of a pixel: their number, and mean and squared deviations of what they show (Welford 1962).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Spread {
    /// Samples.
    pub n: u32,
    mean: f32,
    deviations: f32,
    /// Of those, the ones that hit something.
    hits: u32,
    /// Squared deviations of linear red, green and blue together.
    linear: f32,
}

/// Samples that each pixel gets in any case.
pub const LEAST: u32 = 16;
/// Half a step of 256.
const SURE: f32 = 0.5 / 255.0;

impl Spread {
    /// Adds a sample: linear colour, and 1 where something is hit; `before` is the sum of those before it.
    pub fn add(&mut self, [r, g, b, hit]: [f32; 4], before: [f32; 4]) {
        let n = self.n as f32;
        for (x, sum) in [r, g, b].into_iter().zip(before) {
            // From the mean before and from the one after: both are fractions of the same difference.
            let from_mean = if self.n == 0 { 0.0 } else { x - sum / n };
            self.linear += from_mean * from_mean * (n / (n + 1.0));
        }
        let shown = encode(0.2126 * r + 0.7152 * g + 0.0722 * b);
        self.n += 1;
        self.hits += u32::from(hit > 0.0);
        let before = shown - self.mean;
        self.mean += before / self.n as f32;
        self.deviations += before * (shown - self.mean);
    }

    /// The squared standard error of the mean: of linear red, green and blue together.
    pub fn error_squared(&self) -> f64 {
        let n = f64::from(self.n);
        if self.n < 2 { 0.0 } else { f64::from(self.linear) / (n * (n - 1.0)) }
    }

    /// Whether more samples would change nothing that is seen. So it is of a pixel that gets none.
    fn is_sure(&self) -> bool {
        if self.n == 0 {
            return true;
        }
        let n = self.n as f32;
        let hit = self.hits as f32 / n;
        let variance = (self.deviations / (n - 1.0)).max(hit * (1.0 - hit));
        self.n >= LEAST && variance <= SURE * SURE * n
    }
}

/// For each pixel of a picture of so many columns, whether it gets no more samples: it and its neighbours are sure.
/// Runs on the threads of the pool that it is called in.
pub fn at_rest(pixels: &[Spread], width: usize) -> Vec<bool> {
    let sure: Vec<bool> = pixels.par_iter().map(Spread::is_sure).collect();
    let height = pixels.len() / width.max(1);
    let at_rest = |i: usize| {
        let (x, y) = (i % width, i / width);
        let columns = x.saturating_sub(1)..=(x + 1).min(width - 1);
        let mut rows = y.saturating_sub(1)..=(y + 1).min(height - 1);
        rows.all(|row| columns.clone().all(|column| sure[row * width + column]))
    };
    (0..pixels.len()).into_par_iter().map(at_rest).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(samples: &[[f32; 4]]) -> Spread {
        let mut spread = Spread::default();
        let mut sum = [0.0; 4];
        for sample in samples {
            spread.add(*sample, sum);
            (0..4).for_each(|k| sum[k] += sample[k]);
        }
        spread
    }

    #[test]
    fn the_error_is_that_of_the_mean() {
        let samples = [[1.0, 2.0, 0.0, 1.0], [3.0, 2.0, 0.5, 1.0], [2.0, 8.0, 0.25, 1.0], [4.0, 0.0, 0.75, 1.0]];
        let variance = |k: usize| {
            let mean = samples.iter().map(|s| f64::from(s[k])).sum::<f64>() / 4.0;
            samples.iter().map(|s| (f64::from(s[k]) - mean).powi(2)).sum::<f64>() / 3.0
        };
        let expected = (variance(0) + variance(1) + variance(2)) / 4.0;
        assert!((of(&samples).error_squared() - expected).abs() < 1e-5 * expected);
        assert_eq!((of(&samples[..1]).error_squared(), of(&[]).error_squared()), (0.0, 0.0));
    }

    #[test]
    fn what_does_not_change_is_sure_and_noise_and_edges_are_not() {
        let grey = [0.3, 0.3, 0.3, 1.0];
        assert!(of(&[]).is_sure() && !of(&[grey; 15]).is_sure() && of(&[grey; 16]).is_sure());
        assert!(!of(&[grey, [0.5, 0.5, 0.5, 1.0]].repeat(20)).is_sure());
        // Black in front of nothing differs by what is behind it alone.
        assert!(!of(&[[0.0; 4], [0.0, 0.0, 0.0, 1.0]].repeat(20)).is_sure());
        // Enough samples make even those sure.
        assert!(of(&[grey, [0.301, 0.301, 0.301, 1.0]].repeat(20)).is_sure());
    }

    #[test]
    fn a_pixel_goes_on_with_its_neighbours() {
        let (sure, unsure) = (of(&[[0.2, 0.2, 0.2, 1.0]; 20]), of(&[[0.2, 0.2, 0.2, 1.0], [0.0; 4]].repeat(10)));
        let mut pixels = vec![sure; 5 * 4];
        pixels[5 + 1] = unsure;
        let rest = at_rest(&pixels, 5);
        let going = |x: usize, y: usize| !rest[y * 5 + x];
        assert_eq!(rest.iter().filter(|rest| !**rest).count(), 9);
        assert!((0..3).all(|y| (0..3).all(|x| going(x, y))));
        assert!(at_rest(&[], 0).is_empty());
    }
}
