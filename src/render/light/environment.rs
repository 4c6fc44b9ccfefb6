//! Light from an image around the scene, drawn by how bright it is (Pharr, Jakob and Humphreys 2023, sections 12.5 and A.5).

use std::f64::consts::{PI, TAU};
use std::sync::Arc;

use glam::{DQuat, DVec3, Vec2, Vec3};
use rayon::prelude::*;

use super::sources::brightness;
use crate::geometry::num::{floor_index, narrow};
use crate::scene::Environment;
use crate::task::{Cancel, Cancelled};

/// An image around the scene as a light, infinitely far away.
///
/// With +Y up, the image's first row is around +Y, its middle (u = 0.5) lies along -Z, and u grows towards +X: to the right, as
/// seen from within. With another direction up, all that is turned by the shortest rotation from +Y to it (for -Y, half a turn
/// about Z).
#[derive(Debug)]
pub struct Dome {
    image: Arc<Environment>,
    /// Radians, 0 to a whole turn.
    rotation: f64,
    strength: f32,
    /// By row, the weight of all up to each, itself included; the last is about 1, or 0 if all is black.
    rows: Vec<f32>,
    /// By row and there by column, the same.
    columns: Vec<f32>,
    power: f64,
}

impl Dome {
    /// The image turned by `rotation` radians about the direction up (counter-clockwise, as seen from above), its radiance
    /// multiplied by `strength`; what is no finite number counts as 0, as does a negative strength. Takes 4 bytes a texel
    /// besides the image. Runs on the threads of the pool that it is called in.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn new(image: Arc<Environment>, rotation: f32, strength: f32, cancel: &Cancel) -> Result<Self, Cancelled> {
        let finite = |x: f32| if x.is_finite() { x } else { 0.0 };
        let strength = finite(strength).max(0.0);
        let (width, height) = (image.width(), image.height());
        let mut columns = vec![0.0; width * height];
        let row = |(y, sums): (usize, &mut [f32])| {
            cancel.check()?;
            let weight = accumulate(&weights(&image, y), sums);
            let light = |texel: &[f32; 3]| f64::from(brightness(Vec3::from_array(*texel)).min(f32::MAX));
            let light: f64 = image.texels()[y * width..][..width].iter().map(light).sum();
            let size = solid_angle(&image, y);
            Ok((weight * size * f64::from(strength), light * size))
        };
        let sums: Result<Vec<(f64, f64)>, Cancelled> = columns.par_chunks_mut(width).enumerate().map(row).collect();
        let (weights, light): (Vec<f64>, Vec<f64>) = sums?.into_iter().unzip();
        let mut rows = vec![0.0; height];
        accumulate(&weights, &mut rows);
        let power = light.iter().sum::<f64>() * f64::from(strength);
        Ok(Self { image, rotation: f64::from(finite(rotation)).rem_euclid(TAU), strength, rows, columns, power })
    }

    /// What comes from a direction: between the middles of texels, all the way round, and as at the last row's near the poles.
    /// Both directions are of unit length.
    pub fn radiance(&self, dir: Vec3, up: Vec3) -> Vec3 {
        self.radiance_at(self.at(dir, up))
    }

    /// A direction of unit length, by brightness, what comes from there, and how densely such directions are chosen, over
    /// solid angle. `u` is in `[0, 1)`. `None` if all is black, or rounding has led just beside what is not.
    pub fn choose(&self, u: Vec2, up: Vec3) -> Option<(Vec3, Vec3, f32)> {
        let (y, down) = pick(&self.rows, u.y)?;
        let (x, right) = pick(self.columns_of(y), u.x)?;
        // Evenly over the texel's part of the sphere, which is even in the cosine.
        let [above, below] = cosines(&self.image, y);
        let cosine = above + (below - above) * down;
        let sine = (1.0 - cosine * cosine).max(0.0).sqrt();
        let turn = TAU * ((x as f64 + right) / self.image.width() as f64 - 0.5) - self.rotation;
        let dir = (frame(up) * DVec3::new(sine * turn.sin(), cosine, -sine * turn.cos())).as_vec3();
        // At an edge rounding may have moved it to the next texel: what is said is what is there.
        let at = self.at(dir, up);
        let density = self.density_at(at);
        (density > 0.0).then(|| (dir, self.radiance_at(at), density))
    }

    /// How densely [`Self::choose`] chooses a direction, over solid angle. Both directions are of unit length.
    pub fn density(&self, dir: Vec3, up: Vec3) -> f32 {
        self.density_at(self.at(dir, up))
    }

    /// The brightness that comes from everywhere, integrated over solid angle: what a small ball receives, per area of its
    /// shadow. Each texel counts by the solid angle that it covers.
    pub const fn power_per_area(&self) -> f64 {
        self.power
    }

    /// Where in the image a direction lies, in texels from its upper left corner.
    fn at(&self, dir: Vec3, up: Vec3) -> (f64, f64) {
        let dir = frame(up).conjugate() * dir.as_dvec3();
        let right = (dir.x.atan2(-dir.z) + self.rotation) / TAU + 0.5;
        let down = dir.x.hypot(dir.z).atan2(dir.y) / PI;
        ((right - right.floor()) * self.image.width() as f64, down * self.image.height() as f64)
    }

    fn radiance_at(&self, (x, y): (f64, f64)) -> Vec3 {
        let (width, height) = (self.image.width(), self.image.height());
        let (x, y) = ((x - 0.5).rem_euclid(width as f64), (y - 0.5).clamp(0.0, (height - 1) as f64));
        let (left, above) = (floor_index(x, width - 1), floor_index(y, height - 1));
        let (right, below) = ((left + 1) % width, (above + 1).min(height - 1));
        let texel = |x, y| Vec3::from_array(self.image.texels()[y * width + x]);
        // Rounding must not make the greatest number there is infinite.
        let finite = |color: Vec3| color.min(Vec3::MAX);
        let row = |y| finite(texel(left, y).lerp(texel(right, y), narrow(x - left as f64)));
        finite(finite(row(above).lerp(row(below), narrow(y - above as f64))) * self.strength)
    }

    fn density_at(&self, (x, y): (f64, f64)) -> f32 {
        let y = floor_index(y, self.image.height() - 1);
        let x = floor_index(x, self.image.width() - 1);
        narrow(share(&self.rows, y) * share(self.columns_of(y), x) / solid_angle(&self.image, y))
    }

    fn columns_of(&self, y: usize) -> &[f32] {
        &self.columns[y * self.image.width()..][..self.image.width()]
    }
}

/// The rotation from +Y to the direction up.
fn frame(up: Vec3) -> DQuat {
    DQuat::from_rotation_arc(DVec3::Y, up.as_dvec3().normalize_or(DVec3::Y))
}

/// The cosines of the angles from the zenith to a row's upper and lower edge.
fn cosines(image: &Environment, y: usize) -> [f64; 2] {
    [y, y + 1].map(|y| (PI * y as f64 / image.height() as f64).cos())
}

/// Of each texel of a row.
fn solid_angle(image: &Environment, y: usize) -> f64 {
    let [above, below] = cosines(image, y);
    (above - below) * TAU / image.width() as f64
}

/// The weights of a row's texels per solid angle: the greatest value of the texel and the eight around it. Only these nine reach
/// into the texel when colours are mixed between their middles. So no channel of what comes from a direction is greater
/// than the texel's weight, what is not black can be chosen, and radiance over density is at most the sum of all weights.
fn weights(image: &Environment, y: usize) -> Vec<f64> {
    let width = image.width();
    let rows = y.saturating_sub(1)..(y + 2).min(image.height());
    let greatest = |x: usize| rows.clone().flat_map(|y| image.texels()[y * width + x]).fold(0.0, f32::max);
    let upright: Vec<f32> = (0..width).map(greatest).collect();
    let around = |x: usize| upright[(x + width - 1) % width].max(upright[x]).max(upright[(x + 1) % width]);
    (0..width).map(|x| f64::from(around(x))).collect()
}

/// Adds weights up, as shares of their sum, which is returned. What has a weight has a share, however small.
fn accumulate(weights: &[f64], sums: &mut [f32]) -> f64 {
    let total: f64 = weights.iter().sum();
    let (mut sum, mut last) = (0.0, 0.0f32);
    for (weight, into) in weights.iter().zip(sums) {
        if *weight > 0.0 {
            sum += weight;
            last = narrow(sum / total).max(last.next_up());
        }
        *into = last;
    }
    total
}

fn before(sums: &[f32], i: usize) -> f64 {
    i.checked_sub(1).and_then(|i| sums.get(i)).map_or(0.0, |sum| f64::from(*sum))
}

/// The share of one in accumulated weights; 0 where all are 0.
fn share(sums: &[f32], i: usize) -> f64 {
    match sums.last() {
        Some(total) if *total > 0.0 => (f64::from(sums[i]) - before(sums, i)) / f64::from(*total),
        _ => 0.0,
    }
}

/// Which of accumulated weights a number in `[0, 1)` falls to, and how far into it, 0 to 1; `None` where all are 0.
fn pick(sums: &[f32], u: f32) -> Option<(usize, f64)> {
    let u = u.max(0.0).min(1f32.next_down()); // NaN becomes 0
    let wanted = f64::from(u) * f64::from(*sums.last()?);
    let i = sums.partition_point(|sum| f64::from(*sum) <= wanted);
    let (from, to) = (before(sums, i), f64::from(*sums.get(i)?));
    Some((i, (wanted - from) / (to - from)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::sampler::Random;

    const UPS: [Vec3; 4] = [Vec3::Y, Vec3::Z, Vec3::NEG_Y, Vec3::new(0.6, 0.0, 0.8)];

    fn dome(width: usize, texels: Vec<[f32; 3]>, rotation: f32) -> Dome {
        let image = Environment::new(width, texels.len() / width, texels).expect("whole rows");
        Dome::new(Arc::new(image), rotation, 1.0, &Cancel::new()).expect("nobody cancels")
    }

    /// Colours that differ, some of them black.
    fn noise(width: u32, height: u32) -> Vec<[f32; 3]> {
        let texel = |i: u32| {
            let (a, b) = (Random::new(i, 0, 0).pair(0), Random::new(i, 0, 0).pair(1));
            if b.y < 0.3 { [0.0; 3] } else { [a.x * a.x, a.y, 5.0 * b.x.powi(4)] }
        };
        (0..width * height).map(texel).collect()
    }

    /// Black but for one texel.
    fn single(width: usize, height: usize, x: usize, y: usize) -> Vec<[f32; 3]> {
        let mut texels = vec![[0.0; 3]; width * height];
        texels[y * width + x] = [50.0, 100.0, 20.0];
        texels
    }

    fn domes() -> Vec<Dome> {
        vec![
            dome(1, vec![[1.0; 3]], 0.0),
            dome(8, noise(8, 4), 1.0),
            dome(37, noise(37, 5), -7.5),
            dome(64, single(64, 32, 20, 11), 0.0),
            dome(64, single(64, 32, 0, 31), 0.3),
        ]
    }

    /// Directions in a grid, `fine` by `fine` a texel, with the solid angle that each stands for.
    fn grid(dome: &Dome, up: Vec3, fine: usize) -> impl Iterator<Item = (Vec3, f64)> {
        let (width, height, rotation) = (dome.image.width() * fine, dome.image.height() * fine, dome.rotation);
        (0..width * height).map(move |i| {
            let (x, y) = ((i % width) as f64 + 0.5, (i / width) as f64);
            let edge = |y: f64| (PI * y / height as f64).cos();
            let (sine, cosine) = (PI * (y + 0.5) / height as f64).sin_cos();
            let turn = TAU * (x / width as f64 - 0.5) - rotation;
            let local = DVec3::new(sine * turn.sin(), cosine, -sine * turn.cos());
            ((frame(up) * local).as_vec3(), (edge(y) - edge(y + 1.0)) * TAU / width as f64)
        })
    }

    fn close(a: Vec3, b: Vec3) -> bool {
        (a - b).abs().max_element() < 1e-4
    }

    #[test]
    fn the_image_lies_as_is_said() {
        // Four columns and three rows, told apart by their colours.
        let texels: Vec<[f32; 3]> = (0..12u8).map(|i| [f32::from(i % 4), f32::from(i / 4), 1.0]).collect();
        let plain = dome(4, texels.clone(), 0.0);
        let at = |dir: Vec3| plain.radiance(dir, Vec3::Y);
        assert!(close(at(Vec3::NEG_Z), Vec3::new(1.5, 1.0, 1.0)), "the middle of the image");
        assert!(close(at(Vec3::X), Vec3::new(2.5, 1.0, 1.0)), "to the right");
        assert!(close(at(Vec3::NEG_X), Vec3::new(0.5, 1.0, 1.0)), "to the left");
        assert!(close(at(Vec3::Z), Vec3::new(1.5, 1.0, 1.0)), "the seam, between the last column and the first");
        assert!(at(Vec3::Y).y == 0.0 && at(Vec3::NEG_Y).y == 2.0, "the first row is up, the last is down");
        // A quarter turn, counter-clockwise from above: what was ahead is to the left.
        let turned = dome(4, texels, std::f32::consts::FRAC_PI_2);
        assert!(close(turned.radiance(Vec3::NEG_X, Vec3::Y), at(Vec3::NEG_Z)));
        // With Z up, what was up (Y) is at Z, and what was ahead (-Z) at Y.
        for (dir, was) in [(Vec3::Z, Vec3::Y), (Vec3::Y, Vec3::NEG_Z), (Vec3::X, Vec3::X)] {
            assert!(close(plain.radiance(dir, Vec3::Z), at(was)), "{dir}");
        }
        assert!(
            close(plain.radiance(Vec3::NEG_Z, Vec3::NEG_Y), at(Vec3::NEG_Z)) && plain.radiance(Vec3::Y, Vec3::NEG_Y).y == 2.0
        );
    }

    #[test]
    fn nothing_jumps_at_the_seam() {
        let dome = dome(8, noise(8, 4), 0.0);
        for height in [-0.95, -0.3, 0.0, 0.4, 0.95f32] {
            let at = |x: f32| dome.radiance(Vec3::new(x, height, (1.0 - height * height - x * x).sqrt()), Vec3::Y);
            assert!(close(at(-1e-6), at(1e-6)), "{height}: {} beside {}", at(-1e-6), at(1e-6));
        }
    }

    #[test]
    fn densities_integrate_to_one() {
        for (i, dome) in domes().iter().enumerate() {
            for up in UPS {
                let sum: f64 = grid(dome, up, 7).map(|(dir, size)| f64::from(dome.density(dir, up)) * size).sum();
                assert!((sum - 1.0).abs() < 1e-4, "image {i}, {up} up: {sum}");
            }
        }
    }

    #[test]
    fn directions_are_chosen_as_densely_as_is_said() {
        let n = 20_000u32;
        for (i, dome) in domes().iter().enumerate() {
            for up in UPS {
                let (width, height) = (dome.image.width(), dome.image.height());
                let (mut counts, mut beside) = (vec![0u32; width * height], 0);
                for sample in 0..n {
                    let u = Random::new(sample, 7, 0).pair(3);
                    let Some((dir, radiance, density)) = dome.choose(u, up) else {
                        beside += 1;
                        continue;
                    };
                    assert!((dir.length() - 1.0).abs() < 1e-5 && density == dome.density(dir, up) && density > 0.0);
                    assert_eq!(radiance, dome.radiance(dir, up));
                    let (x, y) = dome.at(dir, up);
                    counts[floor_index(y, height - 1) * width + floor_index(x, width - 1)] += 1;
                }
                assert!(beside < 3, "image {i}, {up} up: {beside}");
                let mut expected = vec![0.0; width * height];
                for (dir, size) in grid(dome, up, 1) {
                    let (x, y) = dome.at(dir, up);
                    let at = floor_index(y, height - 1) * width + floor_index(x, width - 1);
                    expected[at] += f64::from(dome.density(dir, up)) * size * f64::from(n);
                }
                let bins = expected.iter().filter(|e| **e > 0.0).count() as f64;
                let term =
                    |(count, e): (&u32, &f64)| if *e > 0.0 { (f64::from(*count) - e).powi(2) / e } else { f64::from(*count) };
                let chi: f64 = counts.iter().zip(&expected).map(term).sum();
                assert!(chi < bins + 5.0 * (2.0 * bins).sqrt(), "image {i}, {up} up: {chi} in {bins} bins");
            }
        }
    }

    #[test]
    fn choosing_by_brightness_finds_the_same_light_with_less_noise() {
        let n = 20_000u32;
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        for (i, dome) in domes().iter().enumerate() {
            let up = Vec3::Z;
            let exact: f64 = grid(dome, up, 8).map(|(dir, size)| f64::from(brightness(dome.radiance(dir, up))) * size).sum();
            let chosen = |sample| {
                let (_, radiance, density) = dome.choose(Random::new(sample, 1, 0).pair(0), up).expect("it is not black");
                f64::from(brightness(radiance) / density)
            };
            let uniform = |sample| {
                let u = Random::new(sample, 1, 0).pair(0);
                let (y, turn) = (2.0 * u.y - 1.0, u.x * std::f32::consts::TAU);
                let dir = Vec3::new((1.0 - y * y).sqrt() * turn.cos(), y, (1.0 - y * y).sqrt() * turn.sin());
                f64::from(brightness(dome.radiance(dir, up))) * 2.0 * TAU
            };
            let (chosen, uniform): (Vec<f64>, Vec<f64>) = (0..n).map(|sample| (chosen(sample), uniform(sample))).unzip();
            let spread = |values: &[f64]| mean(&values.iter().map(|v| (v - mean(values)).powi(2)).collect::<Vec<_>>());
            let bound = 4.0 * (spread(&chosen) / f64::from(n)).sqrt() + 1e-3 * exact;
            assert!((mean(&chosen) - exact).abs() < bound, "image {i}: {} for {exact}, +-{bound}", mean(&chosen));
            if i == 3 {
                assert!(spread(&chosen) * 100.0 < spread(&uniform), "{} beside {}", spread(&chosen), spread(&uniform));
            }
        }
    }

    #[test]
    fn edges_of_what_can_be_asked() {
        assert!(dome(4, vec![[0.0; 3]; 8], 0.0).choose(Vec2::splat(0.5), Vec3::Y).is_none());
        assert_eq!(dome(4, vec![[0.0; 3]; 8], 0.0).density(Vec3::X, Vec3::Y), 0.0);
        let even = dome(6, vec![[2.0; 3]; 18], 0.0);
        assert!((even.power_per_area() - 8.0 * PI).abs() < 1e-5, "{}", even.power_per_area());
        // The greatest and the least radiance there is, and numbers that are none.
        let texels = vec![[f32::MAX; 3], [1e-45, 0.0, 0.0], [0.0; 3], [1.0; 3], [f32::MAX; 3], [0.0; 3]];
        for (width, rotation, strength) in [(1, f32::NAN, 3.0), (3, 1e30, 1.0), (6, -0.0, f32::MAX)] {
            let image = Environment::new(width, 6 / width, texels.clone()).expect("whole rows");
            let dome = Dome::new(Arc::new(image), rotation, strength, &Cancel::new()).expect("nobody cancels");
            assert!(dome.power_per_area().is_finite());
            for x in [f32::NAN, -1.0, 0.0, 1e-30, 0.3, 1f32.next_down(), 1.0, f32::INFINITY] {
                for y in [f32::NAN, -1.0, 0.0, 1e-30, 0.7, 1f32.next_down(), 1.0, f32::INFINITY] {
                    for up in [Vec3::Y, Vec3::ZERO, Vec3::NAN, Vec3::NEG_Y] {
                        let Some((dir, radiance, density)) = dome.choose(Vec2::new(x, y), up) else { continue };
                        assert!((dir.length() - 1.0).abs() < 1e-5 && radiance.is_finite() && density.is_finite());
                    }
                }
            }
        }
        let cancel = Cancel::new();
        cancel.cancel();
        assert!(Dome::new(even.image.clone(), 0.0, 1.0, &cancel).is_err());
        let dark = Dome::new(even.image.clone(), 0.0, -1.0, &Cancel::new()).expect("nobody cancels");
        assert!(dark.power_per_area() == 0.0 && dark.radiance(Vec3::X, Vec3::Y) == Vec3::ZERO);
    }
}
