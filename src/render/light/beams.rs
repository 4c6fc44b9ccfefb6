//! Light from single points and directions (KHR_lights_punctual): nothing finds it but who asks for it.

use glam::Vec3;

use super::sources::brightness;
use crate::scene::{Light, LightKind};

/// Lights without extent.
#[derive(Debug, Default)]
pub struct Beams {
    lights: Vec<Light>,
    /// The power of all up to each, itself included.
    powers: Vec<f64>,
}

/// Light that one of them sends to a point.
#[derive(Clone, Copy, Debug)]
pub struct Beam {
    /// Where it is, in the world; `None` if infinitely far away.
    pub at: Option<Vec3>,
    /// To it, of unit length.
    pub dir: Vec3,
    /// What a surface receives that faces it.
    pub irradiance: Vec3,
    /// How likely it was chosen.
    pub chance: f32,
}

/// What a light sends out altogether, if directional ones fall on a disc of that area.
fn power(light: &Light, disc: f64) -> f64 {
    let bright = f64::from(brightness(light.color.into()));
    match light.kind {
        LightKind::Point => 4.0 * std::f64::consts::PI * bright,
        LightKind::Spot { outer, .. } => 2.0 * std::f64::consts::PI * (1.0 - f64::from(outer).cos()) * bright,
        LightKind::Directional => disc * bright,
    }
}

impl Beams {
    /// Of a scene whose bounds are within a disc of that area, in the world.
    pub fn of(lights: &[Light], disc: f64) -> Self {
        let mut beams = Self::default();
        for light in lights {
            let power = power(light, disc);
            if power > 0.0 && power.is_finite() {
                beams.powers.push(beams.total() + power);
                beams.lights.push(light.clone());
            }
        }
        beams
    }

    /// The power of all, in watts where the file means them.
    pub fn total(&self) -> f64 {
        self.powers.last().copied().unwrap_or(0.0)
    }

    /// What one of them, chosen by power, sends to a point of the world; `None` if that is nothing.
    pub fn choose(&self, which: f32, point: Vec3) -> Option<Beam> {
        let total = self.total();
        let index =
            self.powers.partition_point(|power| *power <= f64::from(which) * total).min(self.lights.len().checked_sub(1)?);
        let before = if index > 0 { self.powers[index - 1] } else { 0.0 };
        let chance = crate::geometry::num::narrow((self.powers[index] - before) / total);
        let light = &self.lights[index];
        let color = Vec3::from(light.color);
        if light.kind == LightKind::Directional {
            return Some(Beam { at: None, dir: -light.towards, irradiance: color, chance });
        }
        let away = light.at - point;
        let squared = away.length_squared();
        let dir = away.try_normalize()?;
        // It ends where the file says so, smoothly (the extension's recommendation).
        let window = light.range.map_or(1.0, |range| (1.0 - (squared / (range * range)).powi(2)).clamp(0.0, 1.0));
        let cone = match light.kind {
            LightKind::Spot { inner, outer } => {
                let (inner, outer, cosine) = (inner.cos(), outer.cos(), light.towards.dot(-dir));
                ((cosine - outer) / (inner - outer).max(1e-4)).clamp(0.0, 1.0).powi(2)
            }
            _ => 1.0,
        };
        let irradiance = color * (window * cone / squared);
        (irradiance.max_element() > 0.0 && irradiance.is_finite()).then_some(Beam { at: Some(light.at), dir, irradiance, chance })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn light(kind: LightKind) -> Light {
        let at = Vec3::new(0.0, 2.0, 0.0);
        Light { name: String::new(), kind, color: [8.0, 4.0, 0.0], at, towards: Vec3::NEG_Y, range: None }
    }

    #[test]
    fn light_falls_with_the_square_and_ends_at_cone_and_range() {
        let of = |light: Light, point: Vec3| Beams::of(&[light], 1.0).choose(0.5, point).map(|beam| beam.irradiance.x);
        assert_eq!(of(light(LightKind::Point), Vec3::ZERO), Some(2.0));
        assert_eq!(of(light(LightKind::Directional), Vec3::new(50.0, 0.0, 0.0)), Some(8.0));
        let spot = LightKind::Spot { inner: 0.2, outer: 0.6 };
        assert_eq!(of(light(spot), Vec3::ZERO), Some(2.0));
        // A foot away and two below is 0.46 from the axis: between the cones.
        let between = of(light(spot), Vec3::new(1.0, 0.0, 0.0)).expect("in the cone");
        let cosine = 2.0 / 5f32.sqrt();
        let share = (cosine - 0.6f32.cos()) / (0.2f32.cos() - 0.6f32.cos());
        assert!((between - 8.0 / 5.0 * share * share).abs() < 1e-5, "{between}");
        assert_eq!(of(light(spot), Vec3::new(2.0, 0.0, 0.0)), None);
        let ranged = |range: f32| of(Light { range: Some(range), ..light(LightKind::Point) }, Vec3::ZERO);
        assert_eq!((ranged(2.0), ranged(4.0)), (None, Some(2.0 * 0.9375)));
    }

    #[test]
    fn brighter_lights_are_chosen_more_often() {
        let dim = Light { color: [2.0, 1.0, 0.0], ..light(LightKind::Point) };
        let beams = Beams::of(&[dim, light(LightKind::Point)], 1.0);
        let chance = |which: f32| beams.choose(which, Vec3::ZERO).map(|beam| (beam.irradiance.x, (beam.chance * 10.0).round()));
        assert_eq!((chance(0.1), chance(0.3), chance(0.999)), (Some((0.5, 2.0)), Some((2.0, 8.0)), Some((2.0, 8.0))));
        assert!(Beams::default().choose(0.5, Vec3::ZERO).is_none());
    }
}
