//! The numbers that samples are made of. They depend on the pixel, the sample and what they are for, never on the structure
//! or the threads, so that all give the same picture.

mod mask;
mod random;

use glam::Vec2;

pub use random::Random;
use random::{hash, unit};

/// How they are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum SamplerKind {
    /// Each by itself.
    #[default]
    Independent,
    /// A sequence that fills space evenly (Sobol 1967), scrambled anew for each pixel (Owen 1995; Burley 2020).
    Sobol,
    /// One such sequence for all pixels, shifted by a mask of blue noise, so that what errs in one pixel errs the other way in
    /// the next (Georgiev and Fajardo 2016).
    BlueNoise,
}

impl SamplerKind {
    /// All of them, in the order of reports.
    pub const ALL: [Self; 3] = [Self::Independent, Self::Sobol, Self::BlueNoise];

    /// The name on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Independent => "independent",
            Self::Sobol => "sobol",
            Self::BlueNoise => "blue-noise",
        }
    }

    /// The name in the window.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Independent => "Independent",
            Self::Sobol => "Sobol, Owen-scrambled",
            Self::BlueNoise => "Sobol, blue noise",
        }
    }
}

impl std::str::FromStr for SamplerKind {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let ids = || Self::ALL.map(Self::id).join(", ");
        Self::ALL
            .into_iter()
            .find(|kind| kind.id() == s)
            .ok_or_else(|| format!("there is no sampler '{s}': use one of {}", ids()))
    }
}

/// Which numbers a picture is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct Sampling {
    /// How they are chosen.
    pub kind: SamplerKind,
    /// Pictures with different seeds have nothing to do with each other.
    pub seed: u32,
}

/// Samples that a Sobol sequence has here; after them comes another.
const LONGEST: u32 = 1 << 16;

impl Sampling {
    /// The numbers of a pixel's `sample`-th sample.
    pub fn of(self, x: u32, y: u32, sample: u32) -> Sampler {
        let (index, block) = (sample % LONGEST, hash(self.seed ^ hash(sample / LONGEST)));
        match self.kind {
            SamplerKind::Independent => Sampler::Random(Random::seeded([x, y], sample, self.seed)),
            SamplerKind::Sobol => Sampler::Sobol { index, seed: hash(x ^ hash(y ^ hash(block ^ OF_PIXELS))) },
            SamplerKind::BlueNoise => Sampler::Dithered { index, seed: block, at: [x, y] },
        }
    }
}

/// Tells seeds of pixels from those of other uses.
const OF_PIXELS: u32 = 0x5EED_0B01;

/// The numbers of one sample of one pixel, in fours: a set is for one use.
#[derive(Clone, Copy, Debug)]
pub enum Sampler {
    /// See [`SamplerKind::Independent`].
    Random(Random),
    /// See [`SamplerKind::Sobol`].
    Sobol {
        /// Of the sample in its sequence.
        index: u32,
        /// The pixel's.
        seed: u32,
    },
    /// See [`SamplerKind::BlueNoise`].
    Dithered {
        /// Of the sample in its sequence.
        index: u32,
        /// That of all pixels.
        seed: u32,
        /// Column and row.
        at: [u32; 2],
    },
}

impl Sampler {
    /// Four numbers in `[0, 1)`.
    pub fn four(&self, set: u32) -> [f32; 4] {
        match *self {
            Self::Random(random) => {
                let (a, b) = (random.pair(2 * set), random.pair(2 * set + 1));
                [a.x, a.y, b.x, b.y]
            }
            Self::Sobol { index, seed } => sobol(index, set, seed),
            Self::Dithered { index, seed, at } => {
                let shifts = [0, 1, 2, 3].map(|k| shift(at, seed, 4 * set + k));
                let numbers = sobol(index, set, seed);
                std::array::from_fn(|k| wrapped(numbers[k], shifts[k]))
            }
        }
    }

    /// Half of a set of four: dimension 0 and 1 are set 0.
    pub fn pair(&self, dimension: u32) -> Vec2 {
        if let Self::Random(random) = self {
            return random.pair(dimension);
        }
        let [a, b, c, d] = self.four(dimension / 2);
        if dimension.is_multiple_of(2) { Vec2::new(a, b) } else { Vec2::new(c, d) }
    }
}

fn sobol(index: u32, set: u32, seed: u32) -> [f32; 4] {
    let sets = sobol_burley::NUM_DIMENSION_SETS_4D;
    // Beyond the last dimension others are used again, scrambled otherwise.
    sobol_burley::sample_4d(index, set % sets, seed ^ hash(set / sets))
}

/// The sum of two numbers in `[0, 1)`, without what is whole of it.
fn wrapped(a: f32, b: f32) -> f32 {
    let sum = a + b;
    if sum >= 1.0 { sum - 1.0 } else { sum }
}

/// By how much a dimension of a pixel is shifted: the mask's cell, which each dimension has elsewhere, and anything within it.
fn shift([x, y]: [u32; 2], seed: u32, dimension: u32) -> f32 {
    let moved = hash(seed ^ hash(dimension));
    let (column, row) = ((x.wrapping_add(moved)) % mask::SIDE, (y.wrapping_add(moved >> 16)) % mask::SIDE);
    let rank = mask::RANKS[(row * mask::SIDE + column) as usize];
    let within = unit(hash(x ^ hash(y ^ moved)));
    ((f32::from(rank) + within) / (mask::SIDE * mask::SIDE) as f32).min(1.0f32.next_down())
}

/// Where a point of a picture, in pixels from its upper left corner, lies on the screen: (-1, -1) is
/// the lower left corner, (1, 1) the upper right.
pub fn on_screen(at: Vec2, size: Vec2) -> Vec2 {
    let at = at / size;
    Vec2::new(2.0 * at.x - 1.0, 1.0 - 2.0 * at.y)
}

/// A direction about the normal, by cosine, from two numbers (Malley's method); of unit length if
/// the normal is.
pub fn cosine_direction(normal: glam::Vec3, u: Vec2) -> glam::Vec3 {
    let (r, angle) = (u.x.sqrt(), u.y * std::f32::consts::TAU);
    let (x, y) = normal.any_orthonormal_pair();
    x * (r * angle.cos()) + y * (r * angle.sin()) + normal * (1.0 - u.x).max(0.0).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn directions_follow_the_cosine() {
        let n = 20_000u32;
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let directions = (0..n).map(|i| cosine_direction(normal, Random::new(i, 0, 1).pair(0)));
        let cosines: Vec<f32> = directions.inspect(|d| assert!((d.length() - 1.0).abs() < 1e-5)).map(|d| d.dot(normal)).collect();
        assert!(cosines.iter().all(|c| *c >= 0.0));
        let mean = cosines.iter().sum::<f32>() / n as f32;
        assert!((mean - 2.0 / 3.0).abs() < 0.01, "the mean cosine is 2/3: {mean}");
    }

    /// Numbers of a set over `n` samples of each of some pixels.
    fn numbers(kind: SamplerKind, set: u32, seed: u32, n: u32) -> impl Iterator<Item = [f32; 4]> {
        let of = move |i: u32| Sampling { kind, seed }.of(i / n % 16, i / n / 16, i % n).four(set);
        (0..n * 256).map(of)
    }

    #[test]
    fn numbers_are_uniform_in_every_set_and_of_every_seed() {
        for kind in SamplerKind::ALL {
            for (set, seed) in [(0, 0), (1, 7), (24, 7), (64, 1), (200, 0)] {
                let mut bins = [[0u32; 8]; 4];
                for four in numbers(kind, set, seed, 64) {
                    for (bins, x) in bins.iter_mut().zip(four) {
                        assert!((0.0..1.0).contains(&x), "{x}");
                        bins[(x * 8.0) as usize] += 1;
                    }
                }
                // 2,048 of 16,384 in each; five standard deviations of independent ones.
                let even = |bins: &[u32; 8]| bins.iter().all(|n| n.abs_diff(2048) < 212);
                assert!(bins.iter().all(even), "{kind:?} {set} {seed}: {bins:?}");
            }
        }
    }

    #[test]
    fn sobol_fills_every_pixel_evenly_at_powers_of_two() {
        for kind in [SamplerKind::Sobol, SamplerKind::BlueNoise] {
            for pixel in 0..32 {
                let mut cells = [[0; 8]; 8];
                for sample in 0..64 {
                    let pair = Sampling { kind, seed: 3 }.of(pixel, 5, sample).pair(0);
                    cells[(pair.x * 8.0) as usize][(pair.y * 8.0) as usize] += 1;
                }
                // Scrambled points are one in each cell; shifted ones may share those that they are shifted across.
                let most = if kind == SamplerKind::Sobol { 1 } else { 4 };
                assert!(cells.as_flattened().iter().all(|n| *n <= most), "{kind:?} {pixel}: {cells:?}");
            }
        }
    }

    #[test]
    fn seeds_and_pixels_have_nothing_to_do_with_each_other() {
        for kind in SamplerKind::ALL {
            // The correlation of independent numbers over 16,384 pairs is below 5/128.
            let correlation = |a: &mut dyn Iterator<Item = f32>, b: &mut dyn Iterator<Item = f32>| {
                let (n, sum) = a.zip(b).fold((0u32, 0.0), |(n, sum), (a, b)| (n + 1, sum + (a - 0.5) * (b - 0.5)));
                12.0 * sum / n as f32
            };
            let first = |seed: u32, set: u32| numbers(kind, set, seed, 64).map(|four| four[0]);
            let of_seeds = correlation(&mut first(0, 1), &mut first(1, 1));
            let of_sets = correlation(&mut first(0, 1), &mut first(0, 2));
            assert!(of_seeds.abs() < 0.04 && of_sets.abs() < 0.04, "{kind:?}: {of_seeds} {of_sets}");
        }
        // Of neighbours too, but for blue noise, whose neighbours are to differ.
        for kind in [SamplerKind::Independent, SamplerKind::Sobol] {
            let at = |x: u32, y: u32| Sampling { kind, seed: 0 }.of(x, y, 0).four(1)[0] - 0.5;
            let pairs = (0..128 * 128).map(|i| (i % 128, i / 128));
            let of_pixels = 12.0 / 16_384.0 * pairs.map(|(x, y)| at(x, y) * at(x + 1, y)).sum::<f32>();
            assert!(of_pixels.abs() < 0.04, "{kind:?}: {of_pixels}");
        }
        // Without a seed, pictures are as they always were.
        assert_eq!(Random::new(3, 4, 5).bits(6), Random::seeded([3, 4], 5, 0).bits(6));
        // Samples beyond the sequence's end go on.
        let of = |sample| Sampling { kind: SamplerKind::Sobol, seed: 0 }.of(0, 0, sample).four(0);
        assert_ne!(of(0), of(LONGEST));
    }

    #[test]
    fn blue_noise_puts_neighbours_far_apart() {
        let mean = |kind: SamplerKind| {
            let at = |x: u32, y: u32| Sampling { kind, seed: 9 }.of(x, y, 0).four(3)[2];
            // Of numbers that wrap, how far apart they are, half at most.
            let apart = |a: f32, b: f32| 0.5 - ((a - b).abs() - 0.5).abs();
            (0..60 * 60).map(|i| (i % 60, i / 60)).map(|(x, y)| apart(at(x, y), at(x + 1, y))).sum::<f32>() / 3600.0
        };
        assert!((mean(SamplerKind::Sobol) - 0.25).abs() < 0.02, "{}", mean(SamplerKind::Sobol));
        assert!(mean(SamplerKind::BlueNoise) > 0.29, "{}", mean(SamplerKind::BlueNoise));
    }
}
