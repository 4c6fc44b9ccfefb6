//! A sky, brighter or darker by how far up one looks, and a sun in it.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

/// Radiance from far away, linear, by how far up it comes from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sky {
    /// Straight from above.
    pub zenith: Vec3,
    /// From the horizon.
    pub horizon: Vec3,
    /// From below.
    pub ground: Vec3,
}

impl Sky {
    /// A clear day without its sun.
    pub const DAY: Self =
        Self { zenith: Vec3::new(0.28, 0.38, 0.56), horizon: Vec3::new(0.5, 0.5, 0.5), ground: Vec3::new(0.14, 0.13, 0.12) };

    /// The same from everywhere.
    pub const fn even(radiance: Vec3) -> Self {
        Self { zenith: radiance, horizon: radiance, ground: radiance }
    }

    /// What comes from a direction of unit length.
    pub fn radiance(&self, dir: Vec3, up: Vec3) -> Vec3 {
        let height = dir.dot(up);
        if height >= 0.0 {
            self.horizon.lerp(self.zenith, height.min(1.0))
        } else {
            self.horizon.lerp(self.ground, (-height * 8.0).min(1.0))
        }
    }
}

/// A bright disc, infinitely far away.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sun {
    /// To its middle, of unit length.
    towards: Vec3,
    /// The cosine of the angle between its middle and its edge.
    edge: f32,
    radiance: Vec3,
}

impl Sun {
    /// The sun's angle from middle to edge, as seen from the earth, in radians.
    const ANGLE: f32 = 0.004_65;
    /// What a surface that faces it receives, where [`Sky::DAY`] is around.
    const IRRADIANCE: Vec3 = Vec3::new(1.9, 1.75, 1.5);

    /// By day, that high over the horizon and that far round, in radians; round from where `up` has its first other axis.
    pub fn by_day(elevation: f32, azimuth: f32, up: Vec3) -> Self {
        let up = up.normalize_or(Vec3::Y);
        let (x, y) = up.any_orthonormal_pair();
        let around = x * azimuth.cos() + y * azimuth.sin();
        let towards = (around * elevation.cos() + up * elevation.sin()).normalize_or(up);
        let edge = Self::ANGLE.cos();
        Self { towards, edge, radiance: Self::IRRADIANCE / solid_angle(edge) }
    }

    /// What comes from a direction of unit length.
    pub fn radiance(&self, dir: Vec3) -> Vec3 {
        if dir.dot(self.towards) >= self.edge { self.radiance } else { Vec3::ZERO }
    }

    /// A direction to it.
    pub fn choose(&self, u: Vec2) -> Vec3 {
        let cosine = 1.0 - u.x * (1.0 - self.edge);
        let (sine, angle) = ((1.0 - cosine * cosine).max(0.0).sqrt(), u.y * TAU);
        let (x, y) = self.towards.any_orthonormal_pair();
        (x * (sine * angle.cos()) + y * (sine * angle.sin()) + self.towards * cosine).normalize_or(self.towards)
    }

    /// How densely [`Self::choose`] chooses a direction of unit length, over solid angle.
    pub fn density(&self, dir: Vec3) -> f32 {
        if dir.dot(self.towards) >= self.edge { 1.0 / solid_angle(self.edge) } else { 0.0 }
    }

    /// What a surface that faces it receives.
    pub fn irradiance(&self) -> Vec3 {
        self.radiance * solid_angle(self.edge)
    }
}

/// Of a cone, by the cosine of the angle between its axis and its side.
fn solid_angle(edge: f32) -> f32 {
    2.0 * PI * (1.0 - edge)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sun_is_where_it_is_put_and_chosen_within_its_disc() {
        for up in [Vec3::Y, Vec3::Z] {
            let sun = Sun::by_day(0.7, 1.0, up);
            assert!((sun.towards.dot(up) - 0.7f32.sin()).abs() < 1e-6);
            for i in 0..100u16 {
                let dir = sun.choose(Vec2::new(f32::from(i) * 0.01, f32::from(i * 37 % 100) * 0.01));
                assert!((dir.length() - 1.0).abs() < 1e-6);
                // At its very edge rounding decides.
                assert!(i > 97 || (sun.density(dir) > 0.0 && sun.radiance(dir).x > 0.0), "{i}");
            }
            assert_eq!((sun.density(-sun.towards), sun.radiance(-sun.towards)), (0.0, Vec3::ZERO));
            assert!((sun.irradiance() - Sun::IRRADIANCE).abs().max_element() < 1e-3);
        }
    }
}
