//! Independent random numbers: a hash of pixel, sample, dimension and seed, so that every structure and any number of
//! threads gives the same picture.

use glam::Vec2;

/// The numbers of one sample of one pixel.
#[derive(Clone, Copy, Debug)]
pub struct Random {
    seed: u32,
}

impl Random {
    /// For the `sample`-th sample of a pixel.
    pub fn new(x: u32, y: u32, sample: u32) -> Self {
        Self::seeded([x, y], sample, 0)
    }

    /// The same of another of 2^32 pictures, which has nothing to do with the first.
    pub const fn seeded([x, y]: [u32; 2], sample: u32, seed: u32) -> Self {
        Self { seed: hash(x ^ hash(y ^ hash(sample ^ hash(seed)))) }
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

/// A number in `[0, 1)` of the upper bits.
pub(super) fn unit(bits: u32) -> f32 {
    (bits >> 8) as f32 * (1.0 / (1 << 24) as f32)
}

/// Wellons' low-bias integer hash.
pub(super) const fn hash(mut x: u32) -> u32 {
    x ^= x >> 16;
    x = x.wrapping_mul(0x7FEB_352D);
    x ^= x >> 15;
    x = x.wrapping_mul(0x846C_A68B);
    x ^ (x >> 16)
}
