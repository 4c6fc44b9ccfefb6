//! The rays that structures are measured with: what a renderer would trace from one camera.

use rayon::prelude::*;

use super::lines::line;
use crate::accel::{Accel, Hit, Mode};
use crate::geometry::Ray;
use crate::render::Job;
use crate::render::sampler::Random;
use crate::render::spawn::{BOUNCE, Point, light_beside};
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
    /// The diffuse rays in a random order: neighbours have nothing in common.
    Shuffled,
}

impl RayKind {
    /// All of them, in the order of tables.
    pub const ALL: [Self; 5] = [Self::Primary, Self::Shadow, Self::Diffuse, Self::Lines, Self::Shuffled];

    /// The name used on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Diffuse => "diffuse",
            Self::Lines => "lines",
            Self::Shuffled => "shuffled",
        }
    }

    /// One sentence for the user.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Primary => "From the camera through the centre of each pixel to the closest hit.",
            Self::Shadow => "From each primary hit to a point light beside the camera: any hit will do.",
            Self::Diffuse => "From each primary hit in a random direction about the normal, to the closest hit.",
            Self::Lines => "Random lines through the scene's box, each as likely as any other, to the closest hit.",
            Self::Shuffled => "The diffuse rays in a random order: what a path tracer traces after some bounces.",
        }
    }

    /// What is asked of them.
    pub const fn mode(self) -> Mode {
        match self {
            Self::Primary | Self::Diffuse | Self::Lines | Self::Shuffled => Mode::Closest,
            Self::Shadow => Mode::Any,
        }
    }
}

impl std::str::FromStr for RayKind {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().find(|kind| kind.id() == s);
        found.ok_or_else(|| format!("there is no ray kind '{s}': use primary, shadow, diffuse, lines or shuffled"))
    }
}

/// In which order the pixels of a picture send their rays.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PixelOrder {
    /// Row by row, as a picture is stored.
    #[default]
    Rows,
    /// Along the Morton curve, so that neighbours in the list are neighbours in both directions: what
    /// renderers that trace in tiles do.
    Morton,
}

impl std::str::FromStr for PixelOrder {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        match s {
            "rows" => Ok(Self::Rows),
            "morton" => Ok(Self::Morton),
            _ => Err(format!("there is no order '{s}': use rows or morton")),
        }
    }
}

impl std::fmt::Display for PixelOrder {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Rows => "rows",
            Self::Morton => "morton",
        })
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

/// A ray with the column and row that it comes from.
type FromPixel = ((u32, u32), Ray);

/// Rows of a picture made at a time.
const ROWS: u32 = 4;

/// The sampler's dimension of the place where a shuffled ray goes; those before it are the renderer's.
const SHUFFLE: u32 = 3;

impl RaySet {
    /// The rays of a picture of `width` by `height` pixels from the job's camera, row by row; the job's
    /// structure finds the primary hits. The same for every structure and number of threads, up to
    /// which of two near hits a structure of cells reports.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn generate(kind: RayKind, job: &Job, width: u32, height: u32, pool: &Pool, cancel: &Cancel) -> Result<Self, Cancelled> {
        Self::ordered(kind, PixelOrder::Rows, job, (width, height), pool, cancel)
    }

    /// The same in an order of pixels. Lines have none, and shuffled rays are shuffled from it.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn ordered(
        kind: RayKind,
        order: PixelOrder,
        job: &Job,
        (width, height): (u32, u32),
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        if kind == RayKind::Lines {
            return Self::lines(job.accel.geometry(), u64::from(width) * u64::from(height), pool, cancel);
        }
        let light = light_beside(&job.camera);
        let band = |first: u32| {
            cancel.check()?;
            let rays = job.camera_rays(width, height, first..height.min(first + ROWS), 0);
            let pixel = |i: usize| (i as u32 % width, first + i as u32 / width);
            if kind == RayKind::Primary {
                return Ok(rays.into_iter().enumerate().map(|(i, ray)| (pixel(i), ray)).collect());
            }
            let mut hits = vec![None; rays.len()];
            job.accel.trace(&rays, Mode::Closest, &mut hits, cancel)?;
            let geometry = job.accel.geometry();
            let leave = |(i, (ray, hit)): (usize, (&Ray, &Option<Hit>))| {
                let point = Point::of(geometry, ray, hit.as_ref()?);
                let (x, y) = pixel(i);
                Some(((x, y), second(kind, &point, geometry, light, &Random::new(x, y, 0))))
            };
            Ok(rays.iter().zip(&hits).enumerate().filter_map(leave).collect())
        };
        let bands: Vec<u32> = (0..height).step_by(ROWS as usize).collect();
        let bands: Result<Vec<Vec<FromPixel>>, Cancelled> = pool.run(|| bands.into_par_iter().map(band).collect());
        let mut rays = bands?.concat();
        if order == PixelOrder::Morton {
            pool.run(|| rays.par_sort_unstable_by_key(|((x, y), _)| morton(*x) | morton(*y) << 1));
        }
        let mut rays: Vec<Ray> = rays.into_iter().map(|(_, ray)| ray).collect();
        if kind == RayKind::Shuffled {
            shuffle(&mut rays);
        }
        Ok(Self { kind, mode: kind.mode(), rays })
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

/// The ray of a kind that leaves what a world ray meets first: towards the light beside the camera, or in a random direction
/// about the normal; a primary one is the ray itself. `None` if it meets nothing.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn leaving(kind: RayKind, accel: &dyn Accel, camera: &Camera, ray: &Ray, cancel: &Cancel) -> Result<Option<Ray>, Cancelled> {
    if kind == RayKind::Primary {
        return Ok(Some(*ray));
    }
    let mut hit = [None];
    accel.trace(std::slice::from_ref(ray), Mode::Closest, &mut hit, cancel)?;
    let geometry = accel.geometry();
    let leave = |hit: &Hit| second(kind, &Point::of(geometry, ray, hit), geometry, light_beside(camera), &Random::new(0, 0, 0));
    Ok(hit[0].as_ref().map(leave))
}

/// The ray that leaves a primary hit.
fn second(kind: RayKind, point: &Point, geometry: &Geometry, light: Vec3, sampler: &Random) -> Ray {
    match kind {
        RayKind::Primary | RayKind::Shadow | RayKind::Lines => point.segment_to(geometry, light),
        RayKind::Diffuse | RayKind::Shuffled => point.bounce(geometry, sampler.pair(BOUNCE)),
    }
}

/// Every bit of a column or row moved to twice its place, so that two of them interleave.
fn morton(x: u32) -> u64 {
    let mut x = u64::from(x);
    for (shift, mask) in [(16, 0x0000_FFFF_0000_FFFF), (8, 0x00FF_00FF_00FF_00FF), (4, 0x0F0F_0F0F_0F0F_0F0F)] {
        x = (x | x << shift) & mask;
    }
    x = (x | x << 2) & 0x3333_3333_3333_3333;
    (x | x << 1) & 0x5555_5555_5555_5555
}

/// Puts the rays in a random order, the same for the same number of rays (Fisher and Yates).
fn shuffle(rays: &mut [Ray]) {
    for i in (1..rays.len()).rev() {
        let random = Random::new(crate::geometry::num::index(i), 0, 0).bits(SHUFFLE);
        rays.swap(i, ((u128::from(random) * (i as u128 + 1)) >> 64) as usize);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_morton_curve_goes_through_quarters() {
        let code = |x, y| morton(x) | morton(y) << 1;
        assert_eq!([(0, 0), (1, 0), (0, 1), (1, 1), (2, 0), (0, 2)].map(|(x, y)| code(x, y)), [0, 1, 2, 3, 4, 8]);
        assert_eq!(code(u32::MAX, u32::MAX), u64::MAX);
    }

    #[test]
    fn shuffling_keeps_every_ray_and_leaves_few_in_place() {
        let ray = |i: u16| Ray::new(Vec3::splat(f32::from(i)), Vec3::X);
        let (sorted, mut rays): (Vec<Ray>, Vec<Ray>) = (0..1000).map(|i| (ray(i), ray(i))).unzip();
        shuffle(&mut rays);
        assert!(rays.iter().zip(&sorted).filter(|(a, b)| a == b).count() < 10);
        rays.sort_by(|a, b| a.origin.x.total_cmp(&b.origin.x));
        assert_eq!(rays, sorted);
    }
}
