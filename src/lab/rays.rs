//! The rays that structures are measured with: what a renderer would trace from one camera.

use rayon::prelude::*;

use super::lines::line;
use crate::accel::{Hit, Mode};
use crate::geometry::Ray;
use crate::render::Job;
use crate::render::sampler::{Sampler, cosine_direction};
use crate::render::spawn::Point;
use crate::scene::{Camera, Geometry};
use crate::task::{Cancel, Cancelled, Pool};
use glam::Vec3;

/// What rays are for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum RayKind {
    /// From the camera through the centre of each pixel: the most coherent.
    Primary,
    /// From each primary hit to a light.
    Shadow,
    /// From each primary hit in a random direction about the normal: the least coherent.
    Diffuse,
    /// Random lines through the whole scene, from outside: what the surface area heuristic is about.
    Lines,
}

impl RayKind {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 4] = [Self::Primary, Self::Shadow, Self::Diffuse, Self::Lines];

    /// The name used on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
            Self::Lines => "lines",
        }
    }

    /// One sentence for the user.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Primary => "From the camera through the centre of each pixel to the closest hit.",
            Self::Shadow => "From each primary hit to a point light beside the camera: any hit will do.",
            Self::Diffuse => "From each primary hit in a random direction about the normal, to the closest hit.",
            Self::Lines => "Random lines through the scene's box, each as likely as any other, to the closest hit.",
        }
    }

    /// What is asked of them.
    pub const fn mode(self) -> Mode {
        match self {
            Self::Primary | Self::Diffuse | Self::Lines => Mode::Closest,
            Self::Shadow => Mode::Any,
        }
    }
}

impl std::str::FromStr for RayKind {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.id() == s);
        found.ok_or_else(|| format!("there is no ray kind '{s}': use primary, shadow, diffuse or lines"))
    }
}

/// World rays of one kind, in the order of pixels.
#[derive(Clone, Debug, PartialEq)]
pub struct RaySet {
    /// What they are for.
    pub kind: RayKind,
    /// What is asked of them.
    pub mode: Mode,
    /// One for each pixel, or for each pixel that hits something; of lines as many as pixels.
    pub rays: Vec<Ray>,
}

/// Rows of a picture made at a time.
const ROWS: u32 = 4;

/// The sampler's dimension of the bounce; 0 is the place in the pixel, 1 ambient occlusion.
const BOUNCE: u32 = 2;

impl RaySet {
    /// The rays of a picture of `width` by `height` pixels from the job's camera; the job's
    /// structure finds the primary hits. The same for every structure and number of threads, up to
    /// which of two near hits a structure of cells reports.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn generate(kind: RayKind, job: &Job, width: u32, height: u32, pool: &Pool, cancel: &Cancel) -> Result<Self, Cancelled> {
        if kind == RayKind::Lines {
            return Self::lines(job.accel.geometry(), u64::from(width) * u64::from(height), pool, cancel);
        }
        let light = light(&job.camera);
        let band = |first: u32| {
            cancel.check()?;
            let rays = job.camera_rays(width, height, first..height.min(first + ROWS), 0);
            if kind == RayKind::Primary {
                return Ok(rays);
            }
            let mut hits = vec![None; rays.len()];
            job.accel.trace(&rays, Mode::Closest, &mut hits, cancel)?;
            let geometry = job.accel.geometry();
            let leave = |(i, (ray, hit)): (usize, (&Ray, &Option<Hit>))| {
                let point = Point::of(geometry, ray, hit.as_ref()?);
                let (x, y) = (i as u32 % width, first + i as u32 / width);
                Some(second(kind, &point, geometry, light, &Sampler::new(x, y, 0)))
            };
            Ok(rays.iter().zip(&hits).enumerate().filter_map(leave).collect())
        };
        let bands: Vec<u32> = (0..height).step_by(ROWS as usize).collect();
        let bands: Result<Vec<Vec<Ray>>, Cancelled> = pool.run(|| bands.into_par_iter().map(band).collect());
        Ok(Self { kind, mode: kind.mode(), rays: bands?.concat() })
    }

    /// The first `n` random lines through the box of what structures hold; none where there is nothing.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn lines(geometry: &Geometry, n: u64, pool: &Pool, cancel: &Cancel) -> Result<Self, Cancelled> {
        const BAND: u64 = 4096;
        let bounds = *geometry.world_bounds();
        let n = if bounds.is_empty() { 0 } else { n };
        let band = |first: u64| {
            cancel.check()?;
            Ok((first..n.min(first + BAND)).map(|i| line(&bounds, i)).collect())
        };
        let bands: Vec<u64> = (0..n.div_ceil(BAND)).map(|band| band * BAND).collect();
        let bands: Result<Vec<Vec<Ray>>, Cancelled> = pool.run(|| bands.into_par_iter().map(band).collect());
        Ok(Self { kind: RayKind::Lines, mode: RayKind::Lines.mode(), rays: bands?.concat() })
    }
}

/// The ray that leaves a primary hit.
fn second(kind: RayKind, point: &Point, geometry: &Geometry, light: Vec3, sampler: &Sampler) -> Ray {
    match kind {
        RayKind::Primary | RayKind::Shadow | RayKind::Lines => point.segment_to(geometry, light),
        RayKind::Diffuse => point.ray(geometry, cosine_direction(point.normal, sampler.pair(BOUNCE))),
    }
}

/// Where the light of shadow rays stands: up and to the right of the camera by half and a quarter
/// of its distance to what it looks at, so that shadows are seen beside the things that throw them
/// and the light is inside a room if the camera is.
fn light(camera: &Camera) -> Vec3 {
    let frame = camera.frame();
    let distance = camera.eye.distance(camera.target);
    camera.eye + (frame.up * 0.5 + frame.right * 0.25) * distance
}
