//! Where light comes from: triangles that shine, and a sky around everything.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use crate::scene::{Geometry, Scene};
use crate::task::{Cancel, Cancelled};

/// The lights of a scene. Lengths and areas are those of the scaled space.
#[derive(Debug, Default)]
pub struct Sources {
    shining: Vec<Shining>,
    /// The power of all up to each, itself included.
    powers: Vec<f64>,
    sky: Option<Sky>,
}

/// A triangle that shines.
#[derive(Clone, Copy, Debug)]
struct Shining {
    instance: u32,
    primitive: u32,
    radiance: Vec3,
}

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

/// A point that light comes from.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// In the scaled space.
    pub at: Vec3,
    /// Of the triangle, of unit length.
    pub normal: Vec3,
    /// What it sends out.
    pub radiance: Vec3,
    /// How densely such points are chosen, over area.
    pub density: f32,
}

/// The brightness of a linear colour (ITU-R BT.709).
pub fn brightness(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

impl Sky {
    /// A clear day without its sun.
    pub const DAY: Self =
        Self { zenith: Vec3::new(0.55, 0.75, 1.1), horizon: Vec3::new(1.0, 1.0, 1.0), ground: Vec3::new(0.28, 0.26, 0.24) };

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

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

impl Sources {
    /// A sky and nothing else.
    pub fn sky(sky: Sky) -> Self {
        Self { sky: Some(sky), ..Self::default() }
    }

    /// The triangles of a scene that shine; where there are none, a sky. Runs on the threads of the pool that it is called in.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of(scene: &Scene, geometry: &Geometry, cancel: &Cancel) -> Result<Self, Cancelled> {
        let mut sources = Self::default();
        for (number, instance) in (0u32..).zip(&scene.instances) {
            let mesh = &scene.meshes[instance.mesh];
            let radiance = mesh.material.and_then(|m| scene.materials.get(m)).map_or(Vec3::ZERO, |m| m.emission.into());
            if radiance.max_element() <= 0.0 {
                continue;
            }
            let count = geometry.count_of(number);
            let area = |primitive: u32| {
                let [a, b, c] = geometry.corners_of(number, primitive);
                let area = 0.5 * (b - a).as_dvec3().cross((c - a).as_dvec3()).length();
                if area.is_finite() { area } else { 0.0 }
            };
            let chunk = |from: usize| {
                cancel.check()?;
                Ok((from..count.min(from + CHUNK)).map(|i| area(crate::geometry::num::index(i))).collect())
            };
            let starts: Vec<usize> = (0..count).step_by(CHUNK).collect();
            let areas: Result<Vec<Vec<f64>>, Cancelled> = starts.into_par_iter().map(chunk).collect();
            for (primitive, area) in (0u32..).zip(areas?.concat()).filter(|(_, area)| *area > 0.0) {
                let power = sources.total() + area * f64::from(brightness(radiance));
                sources.powers.push(power);
                sources.shining.push(Shining { instance: number, primitive, radiance });
            }
        }
        if sources.shining.is_empty() {
            sources.sky = Some(Sky::DAY);
        }
        Ok(sources)
    }

    fn total(&self) -> f64 {
        self.powers.last().copied().unwrap_or(0.0)
    }

    /// The sky, if there is one.
    pub const fn above(&self) -> Option<&Sky> {
        self.sky.as_ref()
    }

    /// A point of a triangle that shines, by power; `None` if none does.
    pub fn choose(&self, geometry: &Geometry, which: f32, u: Vec2) -> Option<Chosen> {
        let at = self.powers.partition_point(|power| *power <= f64::from(which) * self.total());
        let Shining { instance, primitive, radiance } = *self.shining.get(at.min(self.shining.len().checked_sub(1)?))?;
        let [a, b, c] = geometry.corners_of(instance, primitive);
        // Evenly over a triangle (Shirley and Chiu 1997; Osada et al. 2002).
        let root = u.x.sqrt();
        let at = a + (b - a) * (root * (1.0 - u.y)) + (c - a) * (root * u.y);
        let normal = (b - a).as_dvec3().cross((c - a).as_dvec3()).try_normalize()?.as_vec3();
        Some(Chosen { at, normal, radiance, density: self.density(radiance) })
    }

    /// How densely [`Self::choose`] chooses points of triangles with this radiance, over area: brighter ones as much more
    /// as they are brighter, whatever their size.
    pub fn density(&self, radiance: Vec3) -> f32 {
        let total = self.total();
        if total > 0.0 { crate::geometry::num::narrow(f64::from(brightness(radiance)) / total) } else { 0.0 }
    }
}
