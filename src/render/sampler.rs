//! Random numbers for samples: a hash of pixel, sample and dimension, so that every structure and
//! any number of threads gives the same picture.

use glam::Vec2;

/// The numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Sampler {
    seed: u32,
}

impl Sampler {
    /// For the `sample`-th sample of a pixel.
    pub fn new(x: u32, y: u32, sample: u32) -> Self {
        Self { seed: hash(x ^ hash(y ^ hash(sample))) }
    }

    /// Two numbers in `[0, 1)` for a use of its own, the dimension.
    pub fn pair(&self, dimension: u32) -> Vec2 {
        let bits = self.bits(dimension);
        Vec2::new(unit((bits >> 32) as u32), unit((bits & 0xFFFF_FFFF) as u32))
    }

    /// The same as 64 random bits.
    pub fn bits(&self, dimension: u32) -> u64 {
        let a = hash(self.seed ^ hash(2 * dimension));
        let b = hash(self.seed ^ hash(2 * dimension + 1));
        u64::from(a) << 32 | u64::from(b)
    }
}

/// Where in its pixel a sample lies, in `[0, 1)`: the first in the middle, the others anywhere.
pub fn in_pixel(x: u32, y: u32, sample: u32) -> Vec2 {
    if sample == 0 { Vec2::splat(0.5) } else { Sampler::new(x, y, sample).pair(0) }
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

fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

/// Wellons' low-bias integer hash.
const fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn numbers_are_uniform_and_directions_follow_the_cosine() {
        let n = 20_000u32;
        let mean = (0..n).map(|i| Sampler::new(i % 100, i / 100, 3).pair(1)).sum::<Vec2>() / n as f32;
        assert!((mean - 0.5).abs().max_element() < 0.01, "{mean}");
        let normal = Vec3::new(0.6, 0.0, 0.8);
        let directions = (0..n).map(|i| cosine_direction(normal, Sampler::new(i, 0, 1).pair(0)));
        let cosines: Vec<f32> = directions.inspect(|d| assert!((d.length() - 1.0).abs() < 1e-5)).map(|d| d.dot(normal)).collect();
        assert!(cosines.iter().all(|c| *c >= 0.0));
        let mean = cosines.iter().sum::<f32>() / n as f32;
        assert!((mean - 2.0 / 3.0).abs() < 0.01, "the mean cosine is 2/3: {mean}");
    }
}
