//! Where light comes from: triangles that shine, lights without extent, and what is around the scene.

use std::sync::Arc;

use glam::{Vec2, Vec3};

use super::beams::Beams;
use super::environment::Dome;
use super::shining::Shining;
use super::sky::{Sky, Sun};
use crate::geometry::num::narrow;
use crate::scene::texture::Textures;
use crate::scene::{Environment, Geometry, Scene};
use crate::task::{Cancel, Cancelled};

/// What is around a scene.
#[derive(Clone, Debug, Default)]
pub enum Surroundings {
    /// A clear day where the scene has no lights of its own, and else nothing.
    #[default]
    Usual,
    /// A clear day whatever the scene has, with the sun so high over the horizon and so far round, in radians.
    Day {
        /// Over the horizon; below it there is no sun.
        elevation: f32,
        /// Round the axis that is up.
        azimuth: f32,
    },
    /// An image, turned by so many radians about the axis that is up, and so many times as bright.
    Image {
        /// What is seen all around.
        image: Arc<Environment>,
        /// In radians.
        turn: f32,
        /// 1 for as it is.
        strength: f32,
    },
}

impl Surroundings {
    /// The sun of a usual day: half way up, over the shoulder of who looks along the first axis.
    const SUN: [f32; 2] = [0.9, 0.6];

    /// What tells one from another, for a person and for a hash.
    pub fn describe(&self) -> String {
        match self {
            Self::Usual => "usual".to_owned(),
            Self::Day { elevation, azimuth } => format!("day, sun {elevation} up, {azimuth} round"),
            Self::Image { image, turn, strength } => format!("{}, turned {turn}, times {strength}", image.name()),
        }
    }
}

/// The lights of a scene.
#[derive(Debug, Default)]
pub struct Sources {
    shining: Shining,
    beams: Beams,
    sun: Option<Sun>,
    sky: Option<Sky>,
    dome: Option<Dome>,
    /// How likely triangles, beams, the sun and the dome are asked. The sky is not: it is found by chance well enough.
    chances: [f32; 4],
    up: Vec3,
}

/// Light that may come to a point.
#[derive(Clone, Copy, Debug)]
pub struct Incoming {
    /// To where it comes from, of unit length.
    pub dir: Vec3,
    /// Where that is, in the world; `None` if infinitely far away.
    pub from: Option<Vec3>,
    /// The triangle that it leaves, if it does: its instance, and its number in the mesh.
    pub triangle: Option<(u32, u32)>,
    /// Radiance over [`Self::density`]; of a beam, irradiance over how likely it was chosen.
    pub light: Vec3,
    /// How densely such directions are chosen, over solid angle; infinite for a beam, which nothing else finds.
    pub density: f32,
}

/// What light is of.
pub type Of<'a> = (&'a Scene, &'a Geometry, &'a Textures);

/// The brightness of a linear colour (ITU-R BT.709).
pub fn brightness(color: Vec3) -> f32 {
    color.dot(Vec3::new(0.2126, 0.7152, 0.0722))
}

/// No light is asked less often than that many times of all it could be: what is dim altogether may be bright somewhere.
const LEAST: f64 = 0.1;

/// Four chances by power; none where there is none.
fn chances(powers: [f64; 4]) -> [f32; 4] {
    let total: f64 = powers.iter().sum();
    if total.is_nan() || total <= 0.0 {
        return [0.0; 4];
    }
    let shares = powers.map(|power| if power > 0.0 { (power / total).max(LEAST) } else { 0.0 });
    let all: f64 = shares.iter().sum();
    shares.map(|share| narrow(share / all))
}

impl Sources {
    /// A sky and nothing else.
    pub fn sky(sky: Sky) -> Self {
        Self { sky: Some(sky), ..Self::default() }
    }

    /// All lights of a scene. Runs on the threads of the pool that it is called in.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of(
        scene: &Scene,
        geometry: &Geometry,
        (textures, surroundings): (&Textures, &Surroundings),
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        let up = scene.up.normalize_or(Vec3::Y);
        let bounds = geometry.world_bounds();
        let radius = 0.5 * f64::from(bounds.size().length());
        let disc = std::f64::consts::PI * radius * radius;
        let shining = Shining::of(scene, geometry, textures, cancel)?;
        let beams = Beams::of(&scene.lights, disc);
        let mut sources = Self { shining, beams, up, ..Self::default() };
        let has_lights = sources.shining.total() > 0.0 || sources.beams.total() > 0.0;
        let day = |[elevation, azimuth]: [f32; 2]| {
            (Some(Sky::DAY), (elevation.sin() > 0.0).then(|| Sun::by_day(elevation, azimuth, up)))
        };
        match surroundings {
            Surroundings::Usual if has_lights => {}
            Surroundings::Usual => (sources.sky, sources.sun) = day(Surroundings::SUN),
            Surroundings::Day { elevation, azimuth } => (sources.sky, sources.sun) = day([*elevation, *azimuth]),
            Surroundings::Image { image, turn, strength } => {
                sources.dome = Some(Dome::new(Arc::clone(image), *turn, *strength, cancel)?);
            }
        }
        // Areas in the scaled space to those in the world.
        let area = geometry.space().scale().powi(-2);
        let of_triangles = 2.0 * std::f64::consts::PI * area * sources.shining.total();
        let of_sun = sources.sun.map_or(0.0, |sun| f64::from(brightness(sun.irradiance())) * disc);
        let of_dome = sources.dome.as_ref().map_or(0.0, |dome| dome.power_per_area() * disc);
        sources.chances = chances([of_triangles, sources.beams.total(), of_sun, of_dome]);
        Ok(sources)
    }

    /// Light that may come to a point of the scaled space from a source that `which` chooses.
    pub fn choose(&self, (scene, geometry, textures): Of<'_>, point: Vec3, which: f32, u: Vec2) -> Option<Incoming> {
        let [triangles, beams, sun, dome] = self.chances;
        let (mut from, mut which) = (0.0, which);
        // The number is used again within what it has chosen.
        let mut falls_to = |chance: f32| {
            let within = (which - from) / chance;
            let is_it = chance > 0.0 && which < from + chance;
            from += chance;
            if is_it {
                which = within.clamp(0.0, 1.0f32.next_down());
            }
            is_it
        };
        if falls_to(triangles) {
            self.of_triangle((scene, geometry, textures), point, which, u)
        } else if falls_to(beams) {
            let beam = self.beams.choose(which, geometry.space().world_point(point))?;
            let light = beam.irradiance / (beam.chance * beams);
            Some(Incoming { dir: beam.dir, from: beam.at, triangle: None, light, density: f32::INFINITY })
        } else if falls_to(sun) {
            let dir = self.sun?.choose(u);
            self.of_far(dir, Some(self.sun?.irradiance()))
        } else if dome > 0.0 {
            let (dir, ..) = self.dome.as_ref()?.choose(u, self.up)?;
            self.of_far(dir, None)
        } else {
            None
        }
    }

    fn of_triangle(&self, (scene, geometry, textures): Of<'_>, point: Vec3, which: f32, u: Vec2) -> Option<Incoming> {
        let chosen = self.shining.choose(scene, textures, which, u)?;
        let away = chosen.at - point;
        let distance = away.length();
        let dir = away.try_normalize()?;
        let cosine = chosen.normal.dot(dir).abs();
        let density = self.chances[0] * chosen.density * distance * distance / cosine;
        let (from, light) = (Some(geometry.space().world_point(chosen.at)), chosen.radiance / density);
        let triangle = Some(chosen.triangle);
        (density > 0.0 && density.is_finite()).then_some(Incoming { dir, from, triangle, light, density })
    }

    /// What comes from far away, from a direction that was chosen; at the sun's edge rounding would lose it.
    fn of_far(&self, dir: Vec3, irradiance: Option<Vec3>) -> Option<Incoming> {
        let (mut radiance, mut density) = self.far(dir);
        if let (Some(irradiance), Some(sun)) = (irradiance, self.sun.filter(|sun| sun.density(dir) <= 0.0)) {
            let of_sun = sun.density(sun.choose(Vec2::ZERO));
            (radiance, density) = (radiance + irradiance * of_sun, density + self.chances[2] * of_sun);
        }
        (density > 0.0).then(|| Incoming { dir, from: None, triangle: None, light: radiance / density, density })
    }

    /// Radiance from far away, from a direction of unit length, and how densely [`Self::choose`] chooses that over solid angle.
    pub fn far(&self, dir: Vec3) -> (Vec3, f32) {
        let mut far = (Vec3::ZERO, 0.0);
        if let Some(sky) = &self.sky {
            far.0 += sky.radiance(dir, self.up);
        }
        if let Some(sun) = &self.sun {
            far = (far.0 + sun.radiance(dir), far.1 + self.chances[2] * sun.density(dir));
        }
        if let Some(dome) = &self.dome {
            far = (far.0 + dome.radiance(dir, self.up), far.1 + self.chances[3] * dome.density(dir, self.up));
        }
        far
    }

    /// How densely [`Self::choose`] chooses points of triangles of a material, over area of the scaled space.
    pub fn density(&self, material: Option<usize>) -> f32 {
        self.chances[0] * self.shining.density(material)
    }
}
