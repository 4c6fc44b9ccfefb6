//! Smooth noise over the plane, and mountains made of it.

use super::random::lattice;
use glam::Vec2;

/// Gradient noise, about -0.7 to 0.7 and 0 at the lattice points (Perlin 2002, "Improving noise":
/// his fade curve, and eight gradients for the plane).
pub(super) fn gradient(seed: u64, p: Vec2) -> f32 {
    let (x, y) = (floor(p.x), floor(p.y));
    let at = p - Vec2::new(x as f32, y as f32);
    let corner = |i: i32, j: i32| {
        let away = at - Vec2::new(i as f32, j as f32);
        slope(lattice(seed, x.wrapping_add(i), y.wrapping_add(j))).dot(away)
    };
    let fade = at * at * at * (at * (at * 6.0 - 15.0) + 10.0);
    let mix = |a: f32, b: f32, t: f32| a + (b - a) * t;
    let low = mix(corner(0, 0), corner(1, 0), fade.x);
    let high = mix(corner(0, 1), corner(1, 1), fade.x);
    mix(low, high, fade.y)
}

/// The lattice coordinate below; the noise is only asked for near the origin. (`f32::floor` is a call
/// into the C library where the processor is not known to have the instruction.)
#[inline(always)]
#[expect(clippy::cast_possible_truncation, reason = "`as` saturates")]
fn floor(x: f32) -> i32 {
    let towards_zero = x as i32;
    towards_zero - i32::from(towards_zero as f32 > x)
}

fn slope(bits: u64) -> Vec2 {
    const D: f32 = std::f32::consts::FRAC_1_SQRT_2;
    const SLOPES: [(f32, f32); 8] = [(1.0, 0.0), (D, D), (0.0, 1.0), (-D, D), (-1.0, 0.0), (-D, -D), (0.0, -1.0), (D, -D)];
    SLOPES[(bits >> 61) as usize].into()
}

/// Fractional Brownian motion: `octaves` of noise, each twice as fine and half as high.
pub(super) fn fbm(seed: u64, mut p: Vec2, octaves: u32) -> f32 {
    let (mut sum, mut height) = (0.0, 1.0);
    for k in 0..octaves {
        sum += height * gradient(seed + u64::from(k), p);
        height *= 0.5;
        p = finer(p);
    }
    sum
}

/// Mountain chains, about 0 to 1: noise folded at 0 into sharp ridges; finer ridges grow on high
/// ground, valleys stay smooth (the ridged multifractal of Musgrave, in Ebert et al. 2003,
/// "Texturing and Modeling", chapter 16).
pub(super) fn ridges(seed: u64, mut p: Vec2, octaves: u32) -> f32 {
    let (mut sum, mut weight, mut height) = (0.0, 1.0f32, 0.5);
    for k in 0..octaves {
        let fold = 1.0 - 1.4 * gradient(seed + u64::from(k), p).abs();
        let ridge = fold * fold * weight;
        sum += ridge * height;
        weight = (ridge * 1.8).clamp(0.0, 1.0);
        height *= 0.5;
        p = finer(p);
    }
    sum
}

/// The point for the next octave: twice as far out, and turned by the angle of the 3-4-5 triangle
/// so that the lattices of the octaves do not line up.
fn finer(p: Vec2) -> Vec2 {
    Vec2::new(1.6 * p.x - 1.2 * p.y, 1.2 * p.x + 1.6 * p.y) + Vec2::new(17.3, 9.1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_bounded_smooth_and_zero_on_the_lattice() {
        assert_eq!(gradient(3, Vec2::new(-4.0, 7.0)), 0.0);
        for i in 0..2000u16 {
            let p = Vec2::new(f32::from(i) * 0.037 - 20.0, f32::from(i) * 0.0531);
            assert!(gradient(3, p).abs() <= 1.0 && fbm(3, p, 8).abs() <= 2.0);
            assert!((gradient(3, p) - gradient(3, p + Vec2::splat(1e-3))).abs() < 0.01);
            assert!((0.0..=1.0).contains(&ridges(3, p, 8)));
        }
    }
}
