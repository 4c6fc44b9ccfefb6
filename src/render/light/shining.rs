//! Triangles that shine.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::sources::brightness;
use crate::geometry::num::narrow;
use crate::scene::texture::Textures;
use crate::scene::{Geometry, Material, Scene};
use crate::task::{Cancel, Cancelled};

/// The triangles of a scene that shine. Lengths and areas are those of the scaled space.
#[derive(Debug, Default)]
pub struct Shining {
    triangles: Vec<(u32, u32)>,
    /// The power of all up to each, itself included.
    powers: Vec<f64>,
    /// How bright each material of the scene is on average: what its triangles are chosen by.
    brightness: Vec<f32>,
}

/// A point that light comes from.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// Which triangle it is of.
    pub instance: u32,
    /// Of that instance.
    pub primitive: u32,
    /// The weights of the triangle's second and third corner.
    pub uv: Vec2,
    /// In the scaled space.
    pub at: Vec3,
    /// Of the triangle, of unit length.
    pub normal: Vec3,
    /// How densely such points are chosen, over area.
    pub density: f32,
}

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// How bright a material is on average.
fn mean_brightness(material: &Material, textures: &Textures) -> f32 {
    let map = material.emission_texture.and_then(|texture| textures.get(texture.image));
    let mean = map.map_or(Vec3::ONE, |map| map.mean_color().into());
    brightness(Vec3::from(material.emission) * mean)
}

impl Shining {
    /// Of a scene. Runs on the threads of the pool that it is called in.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of(scene: &Scene, geometry: &Geometry, textures: &Textures, cancel: &Cancel) -> Result<Self, Cancelled> {
        let brightness = scene.materials.iter().map(|material| mean_brightness(material, textures)).collect();
        let mut shining = Self { brightness, ..Self::default() };
        for (number, instance) in (0u32..).zip(&scene.instances) {
            let bright = shining.brightness_of(scene.meshes[instance.mesh].material);
            if bright <= 0.0 {
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
                shining.powers.push(shining.total() + area * f64::from(bright));
                shining.triangles.push((number, primitive));
            }
        }
        Ok(shining)
    }

    fn brightness_of(&self, material: Option<usize>) -> f32 {
        material.and_then(|material| self.brightness.get(material)).copied().unwrap_or(0.0)
    }

    /// Brightness times area of all.
    pub fn total(&self) -> f64 {
        self.powers.last().copied().unwrap_or(0.0)
    }

    /// A point, by power; `None` if no triangle shines.
    pub fn choose(&self, scene: &Scene, geometry: &Geometry, which: f32, u: Vec2) -> Option<Chosen> {
        let at = self.powers.partition_point(|power| *power <= f64::from(which) * self.total());
        let (instance, primitive) = *self.triangles.get(at.min(self.triangles.len().checked_sub(1)?))?;
        let [a, b, c] = geometry.corners_of(instance, primitive);
        // Evenly over a triangle (Shirley and Chiu 1997; Osada et al. 2002).
        let root = u.x.sqrt();
        let uv = Vec2::new(root * (1.0 - u.y), root * u.y);
        let at = a + (b - a) * uv.x + (c - a) * uv.y;
        let normal = (b - a).as_dvec3().cross((c - a).as_dvec3()).try_normalize()?.as_vec3();
        let material = scene.meshes[scene.instances[instance as usize].mesh].material;
        Some(Chosen { instance, primitive, uv, at, normal, density: self.density(material) })
    }

    /// How densely [`Self::choose`] chooses points of triangles of a material, over area: of brighter ones as much more as
    /// they are brighter, whatever their size.
    pub fn density(&self, material: Option<usize>) -> f32 {
        let total = self.total();
        if total > 0.0 { narrow(f64::from(self.brightness_of(material)) / total) } else { 0.0 }
    }
}
