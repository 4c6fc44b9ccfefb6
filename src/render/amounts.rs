//! The amounts that a heat map shows, and how many pixels have which.

use rayon::prelude::*;

use super::colormap::viridis;
use super::develop::{self, byte, fitting};
use super::{Film, Range};
use crate::geometry::num::floor_index;

/// What each pixel stands for.
#[derive(Clone, Debug, PartialEq)]
pub struct Amounts {
    /// Row by row, the upper row first; no number where nothing is seen.
    pub values: Vec<f32>,
    /// How they are spread.
    pub histogram: Histogram,
}

impl Amounts {
    /// The means of a film. Runs on the threads of the pool that it is called in.
    pub fn of(film: &Film) -> Self {
        let amount = |pixel| {
            let [amount, .., coverage] = film.mean(pixel);
            if coverage > 0.0 { amount / coverage } else { f32::NAN }
        };
        Self::new((0..film.pixels()).into_par_iter().map(amount).collect())
    }

    /// Of amounts from 0 on. Runs on the threads of the pool that it is called in.
    pub fn new(values: Vec<f32>) -> Self {
        Self { histogram: Histogram::of(&values), values }
    }

    /// Of differences of amounts, which have signs: the histogram is that of their sizes. Runs on the threads of the pool that it
    /// is called in.
    pub fn of_differences(values: Vec<f32>) -> Self {
        let sizes: Vec<f32> = values.par_iter().map(|x| x.abs()).collect();
        Self { histogram: Histogram::of(&sizes), values }
    }
}

impl Amounts {
    /// From 0 to the amount that one pixel in two hundred exceeds.
    pub fn fitting_range(&self) -> Range {
        fitting(self.values.iter().copied().filter(|x| x.is_finite()).collect(), false)
    }

    /// Four bytes a pixel (red, green, blue, opacity), clear where there is no amount. Runs on the threads of the pool that it is
    /// called in.
    pub fn develop(&self, range: Range) -> Vec<u8> {
        let mut rgba = vec![0; self.values.len() * 4];
        rgba.par_chunks_mut(4 * develop::CHUNK).zip(self.values.par_chunks(develop::CHUNK)).for_each(|(rgba, values)| {
            for (rgba, value) in rgba.as_chunks_mut::<4>().0.iter_mut().zip(values).filter(|(_, value)| value.is_finite()) {
                let [r, g, b] = viridis((value - range.min) / (range.max - range.min)).map(byte);
                *rgba = [r, g, b, u8::MAX];
            }
        });
        rgba
    }
}

/// How many pixels have how much, in bins of one width from 0 on.
#[derive(Clone, Debug, PartialEq)]
pub struct Histogram {
    /// Of a bin: a power of two from 1 on, so that each stands for as many counts, and histograms can be added.
    pub width: f32,
    /// Pixels in each; the greatest amount is in the last.
    pub counts: Vec<u32>,
}

/// Bins at most.
const BINS: usize = 64;
/// Amounts counted at a time.
const CHUNK: usize = 1 << 14;

impl Histogram {
    fn of(values: &[f32]) -> Self {
        let chunks = || values.par_chunks(CHUNK);
        let greatest = chunks().map(|chunk| chunk.iter().copied().filter(|x| x.is_finite()).fold(0.0, f32::max));
        let greatest = greatest.reduce(|| 0.0, f32::max);
        let mut width = 1.0;
        while width * (BINS as f32) < greatest + 1.0 {
            width *= 2.0;
        }
        let bin = |x: f32| floor_index(f64::from(x.max(0.0) / width), BINS - 1);
        let count = |chunk: &[f32]| {
            let mut counts = vec![0; bin(greatest) + 1];
            chunk.iter().filter(|x| x.is_finite()).for_each(|x| counts[bin(*x)] += 1);
            counts
        };
        let sum = |a: Vec<u32>, b: Vec<u32>| a.iter().zip(&b).map(|(a, b)| a + b).collect();
        let counts = chunks().map(count).reduce(|| vec![0; bin(greatest) + 1], sum);
        Self { width, counts }
    }

    /// Of the pixels of both.
    pub fn with(&self, other: &Self) -> Self {
        let width = self.width.max(other.width);
        let last = floor_index(f64::from(self.end().max(other.end()) / width).ceil(), BINS) - 1;
        let mut counts = vec![0_u32; last + 1];
        for of in [self, other] {
            for (i, count) in of.counts.iter().enumerate() {
                // A bin of the finer one lies in one of the coarser.
                let bin = floor_index(i as f64 * f64::from(of.width / width), last);
                counts[bin] = counts[bin].saturating_add(*count);
            }
        }
        Self { width, counts }
    }

    /// The amount at which the last bin ends.
    pub fn end(&self) -> f32 {
        self.width * self.counts.len() as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_amount_is_counted_once_and_none_is_left_out() {
        let values: Vec<f32> = (0..100_000u32).map(|i| if i % 7 == 0 { f32::NAN } else { (i % 22) as f32 }).collect();
        let seen = values.iter().filter(|x| x.is_finite()).count();
        let amounts = Amounts::new(values);
        let Histogram { width, counts } = &amounts.histogram;
        assert_eq!((*width, counts.len()), (1.0, 22), "a bin for each count");
        assert_eq!(counts.iter().sum::<u32>() as usize, seen);
        let wide = Amounts::new(vec![0.0, 639.9, 640.0, 1000.0]).histogram;
        assert_eq!((wide.width, wide.counts.len(), wide.counts[39], wide.counts[40]), (16.0, 63, 1, 1));
        assert!(wide.end() > 1000.0);
    }

    #[test]
    fn histograms_add_up_bin_by_bin() {
        let [few, many]: [Vec<f32>; 2] = [(0..37).map(|i| i as f32).collect(), (0..900).map(|i| (i % 301) as f32).collect()];
        let of = |values: &[f32]| Histogram::of(values);
        let both = of(&few).with(&of(&many));
        assert_eq!(both, of(&[few.clone(), many.clone()].concat()), "as if they were counted together");
        assert_eq!((both.width, of(&few).width), (8.0, 1.0));
        assert_eq!(both, of(&many).with(&of(&few)));
        let none = of(&[]);
        assert_eq!(of(&many).with(&none), of(&many));
        assert_eq!(none.with(&none), none);
    }

    #[test]
    fn differences_keep_their_signs() {
        let less = Amounts::of_differences(vec![-3.0, 2.0, f32::NAN, 0.0]);
        assert_eq!((less.values[0], less.histogram.counts), (-3.0, vec![1, 0, 1, 1]));
    }

    #[test]
    fn no_amounts_are_one_empty_bin() {
        for values in [vec![], vec![f32::NAN; 9]] {
            assert_eq!(Amounts::new(values).histogram, Histogram { width: 1.0, counts: vec![0] });
        }
    }
}
