//! Random numbers that are the same on every machine and on any number of threads: each element of
//! a scene draws from a stream of its own.

use glam::Vec3;

/// SplitMix64 (Steele, Lea and Flood 2014, "Fast splittable pseudorandom number generators").
pub struct Random(u64);

/// The golden ratio as a fraction of 2^64: odd, so adding it runs through every state.
const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

impl Random {
    /// The `stream`-th of the streams of `seed`.
    pub fn new(seed: u64, stream: usize) -> Self {
        Self(mix(mix(seed).wrapping_add(stream as u64)))
    }

    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(STEP);
        mix(self.0)
    }

    /// Evenly from 0 up to, but without, 1.
    pub fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1u32 << 24) as f32
    }

    /// Evenly from `low` to `high`.
    pub fn between(&mut self, low: f32, high: f32) -> f32 {
        low + (high - low) * self.unit()
    }

    /// Evenly in the ball of radius 1: drawn from the cube until it falls inside (two draws on
    /// average), which needs no trigonometry, whose last bit differs between systems.
    pub fn in_ball(&mut self) -> Vec3 {
        loop {
            let p = Vec3::from_array(std::array::from_fn(|_| self.between(-1.0, 1.0)));
            if p.length_squared() <= 1.0 {
                return p;
            }
        }
    }

    /// Evenly on the sphere of radius 1.
    pub fn direction(&mut self) -> Vec3 {
        loop {
            if let Some(d) = self.in_ball().try_normalize() {
                return d;
            }
        }
    }
}

/// The finaliser of SplitMix64: every bit of the input moves every bit of the output.
const fn mix(x: u64) -> u64 {
    let x = (x ^ (x >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    x ^ (x >> 31)
}

/// Random bits for a point of a plane lattice.
pub(super) const fn lattice(seed: u64, x: i32, y: i32) -> u64 {
    let point = ((x.cast_unsigned() as u64) << 32) | y.cast_unsigned() as u64;
    mix(mix(point ^ seed).wrapping_add(STEP))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sequence_never_changes() {
        // The published reference: the first outputs of SplitMix64 from state 1234567.
        let mut random = Random(1_234_567);
        assert_eq!([random.next(), random.next()], [6_457_827_717_110_365_317, 3_203_168_211_198_807_973]);
    }

    #[test]
    fn numbers_spread_over_the_interval() {
        let draws: Vec<f32> = (0..10_000).map(|i| Random::new(7, i).unit()).collect();
        let mean = draws.iter().sum::<f32>() / 10_000.0;
        assert!((mean - 0.5).abs() < 0.01 && draws.iter().all(|x| (0.0..1.0).contains(x)), "{mean}");
        assert!((Random::new(1, 2).direction().length() - 1.0).abs() < 1e-6);
    }
}
