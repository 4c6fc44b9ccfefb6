//! Triangles that shine.

use glam::{Vec2, Vec3};
use rayon::prelude::*;

use super::sources::brightness;
use crate::geometry::num::narrow;
use crate::scene::texture::Textures;
use crate::scene::{Alpha, Finish, Geometry, Material, Scene, coverage};
use crate::task::{Cancel, Cancelled};

/// The triangles of a scene that shine. Lengths and areas are those of the scaled space.
#[derive(Debug, Default)]
pub struct Shining {
    triangles: Vec<Emitter>,
    /// The power of all up to each, itself included.
    powers: Vec<f64>,
    /// How bright each material of the scene is on average: what its triangles are chosen by.
    brightness: Vec<f32>,
}

/// A triangle that shines: many points of it are asked for, so that all of it is at hand.
#[derive(Clone, Copy, Debug)]
struct Emitter {
    instance: u32,
    primitive: u32,
    corner: Vec3,
    edges: [Vec3; 2],
    normal: Vec3,
    /// What it sends out, where no image says so.
    radiance: Option<Vec3>,
    /// How densely its points are chosen but for the power of all.
    brightness: f32,
    /// Whether it may not be there in places, and does not shine there.
    has_holes: bool,
}

/// A point that light comes from.
#[derive(Clone, Copy, Debug)]
pub struct Chosen {
    /// What it sends out.
    pub radiance: Vec3,
    /// In the scaled space.
    pub at: Vec3,
    /// Of the triangle, of unit length.
    pub normal: Vec3,
    /// How densely such points are chosen, over area.
    pub density: f32,
    /// The triangle: its instance, and its number in the mesh.
    pub triangle: (u32, u32),
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
            let number_of_material = scene.meshes[instance.mesh].material;
            let bright = shining.brightness_of(number_of_material);
            let Some(material) = number_of_material.and_then(|m| scene.materials.get(m)).filter(|_| bright > 0.0) else {
                continue;
            };
            let count = geometry.count_of(number);
            let radiance = material.emission_texture.is_none().then(|| Vec3::from(material.emission));
            let emitter = |primitive: u32| {
                let [a, b, c] = geometry.corners_of(number, primitive);
                let cross = (b - a).as_dvec3().cross((c - a).as_dvec3());
                let normal = cross.try_normalize()?.as_vec3();
                let (corner, edges) = (a, [b - a, c - a]);
                let emitter = Emitter {
                    instance: number,
                    primitive,
                    corner,
                    edges,
                    normal,
                    radiance,
                    brightness: bright,
                    has_holes: material.alpha != Alpha::Opaque,
                };
                Some((emitter, 0.5 * cross.length())).filter(|(_, area)| area.is_finite() && *area > 0.0)
            };
            let chunk = |from: usize| {
                cancel.check()?;
                let all = (from..count.min(from + CHUNK)).map(|i| emitter(crate::geometry::num::index(i)));
                Ok(all.flatten().collect())
            };
            let starts: Vec<usize> = (0..count).step_by(CHUNK).collect();
            let emitters: Result<Vec<Vec<(Emitter, f64)>>, Cancelled> = starts.into_par_iter().map(chunk).collect();
            for (emitter, area) in emitters?.concat() {
                shining.powers.push(shining.total() + area * f64::from(bright));
                shining.triangles.push(emitter);
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
    pub fn choose(&self, scene: &Scene, textures: &Textures, which: f32, u: Vec2) -> Option<Chosen> {
        let total = self.total();
        let at = self.powers.partition_point(|power| *power <= f64::from(which) * total);
        let emitter = self.triangles.get(at.min(self.triangles.len().checked_sub(1)?))?;
        // Evenly over a triangle (Shirley and Chiu 1997; Osada et al. 2002).
        let root = u.x.sqrt();
        let (v, w) = (root * (1.0 - u.y), root * u.y);
        let at = emitter.corner + emitter.edges[0] * v + emitter.edges[1] * w;
        let mesh = || scene.instances[emitter.instance as usize].mesh;
        let there = || coverage::Surface::new(scene, mesh(), textures).covers(emitter.instance, emitter.primitive, v, w);
        if emitter.has_holes && !there() {
            return None;
        }
        let of_image = || Finish::new(scene, mesh(), textures).emission(emitter.primitive, v, w).into();
        let radiance = emitter.radiance.unwrap_or_else(of_image);
        let density = narrow(f64::from(emitter.brightness) / total);
        let triangle = (emitter.instance, emitter.primitive);
        Some(Chosen { radiance, at, normal: emitter.normal, density, triangle })
    }

    /// How densely [`Self::choose`] chooses points of triangles of a material, over area: of brighter ones as much more as
    /// they are brighter, whatever their size.
    pub fn density(&self, material: Option<usize>) -> f32 {
        let total = self.total();
        if total > 0.0 { narrow(f64::from(self.brightness_of(material)) / total) } else { 0.0 }
    }
}
