//! Files of rays, and what each of them does in a structure: a line a ray, as [`super::follow::to_text`] writes it, `#` before
//! what is no ray; or a NumPy array, as `boxwood rays` and the stability lab write it.

pub mod npy;

use rayon::prelude::*;

use super::follow::from_text;
use crate::accel::probe::Counts;
use crate::accel::stats::SahWeights;
use crate::accel::{Accel, Mode};
use crate::geometry::{Ray, num};
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// Rays that are taken of one file.
pub const MOST: usize = 1_000_000;
/// Rays traced between two looks at whether to stop.
const CHUNK: usize = 256;

/// The rays of a file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RayFile {
    /// The first [`MOST`].
    pub rays: Vec<Ray>,
    /// There are more in it.
    pub more: bool,
}

impl RayFile {
    /// Reads the bytes of a file of either kind.
    ///
    /// # Errors
    /// Where it is wrong and why, in words for the user.
    pub fn parse(bytes: &[u8]) -> Result<Self, String> {
        if bytes.starts_with(npy::MAGIC) {
            return Self::of_array(npy::parse(bytes)?);
        }
        let text = std::str::from_utf8(bytes).map_err(|_| "it is neither text nor a NumPy array".to_owned())?;
        let mut file = Self::default();
        for (i, line) in text.lines().enumerate() {
            let said = line.split('#').next().unwrap_or_default().trim();
            if said.is_empty() {
                continue;
            }
            let ray = from_text(said).map_err(|why| format!("line {}: {why}", i + 1))?;
            if file.rays.len() == MOST {
                file.more = true;
                break;
            }
            file.rays.push(ray);
        }
        if file.rays.is_empty() { Err("there is no ray in it".to_owned()) } else { Ok(file) }
    }

    fn of_array(mut rays: Vec<Ray>) -> Result<Self, String> {
        let more = rays.len() > MOST;
        rays.truncate(MOST);
        rays.shrink_to_fit();
        match rays.iter().position(|ray| !ray.is_valid()) {
            Some(row) => Err(format!("row {row}: it needs a direction, and an interval that is none the wrong way round")),
            None if rays.is_empty() => Err("there is no ray in it".to_owned()),
            None => Ok(Self { rays, more }),
        }
    }
}

/// What a ray did in a structure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RayWork {
    /// Nodes and cells that it entered.
    pub nodes: u32,
    /// Triangles that it was tested against.
    pub tests: u32,
    /// Where it met the closest; infinite where it met nothing.
    pub t: f32,
}

impl RayWork {
    /// What that costs in the weights of a structure.
    pub fn cost(&self, weights: SahWeights) -> f64 {
        weights.c_trav * f64::from(self.nodes) + weights.c_isect * f64::from(self.tests)
    }
}

/// Traces every ray to its closest hit, and counts.
///
/// # Errors
/// [`Cancelled`], within 100 ms of the request.
pub fn work(
    accel: &dyn Accel,
    rays: &[Ray],
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<RayWork>, Cancelled> {
    progress.start("rays", rays.len() as u64);
    let one = |ray: &Ray| {
        let mut counts = Counts::default();
        let hit = accel.trace_watched(ray, Mode::Closest, &mut counts, cancel)?;
        let [nodes, tests] = [counts.nodes, counts.prims].map(|n| u32::try_from(n).unwrap_or(u32::MAX));
        Ok(RayWork { nodes, tests, t: hit.map_or(f32::INFINITY, |hit| hit.t) })
    };
    let chunk = |rays: &[Ray]| {
        cancel.check()?;
        let work = rays.iter().map(one).collect::<Result<Vec<RayWork>, Cancelled>>()?;
        progress.advance(rays.len() as u64);
        Ok(work)
    };
    let parts: Result<Vec<Vec<RayWork>>, Cancelled> = pool.run(|| rays.par_chunks(CHUNK).map(chunk).collect());
    Ok(parts?.concat())
}

/// The numbers of rays, the dearest first and equal ones as they came.
pub fn dearest_first(work: &[RayWork], weights: SahWeights) -> Vec<u32> {
    let mut order: Vec<u32> = (0..num::index(work.len())).collect();
    order.sort_by(|a, b| work[*b as usize].cost(weights).total_cmp(&work[*a as usize].cost(weights)));
    order
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::lab::follow::{follow, to_text};
    use crate::scene::{Geometry, LoadCx, open};
    use glam::Vec3;
    use std::sync::Arc;

    #[test]
    fn lines_are_rays_and_what_is_wrong_is_told_by_its_line() {
        let text = "# x y z  dx dy dz\n\n0 0 1  0 0 -1 # straight down\n0,0,1, 0,0,-1, 0.5, 2\n";
        let file = RayFile::parse(text.as_bytes()).expect("rays");
        assert_eq!((file.rays.len(), file.rays[0].tmax, file.rays[1].tmin, file.more), (2, f32::INFINITY, 0.5, false));
        for (text, part) in [
            ("0 0 1 0 0 -1\n# fine\n0 0 1 0 zero -1\n", "line 3: 'zero' is no number"),
            ("1 2 3\n", "line 1: a ray is six or eight"),
            ("# nothing\n", "there is no ray in it"),
            ("", "there is no ray in it"),
        ] {
            assert!(RayFile::parse(text.as_bytes()).is_err_and(|why| why.contains(part)), "{part}");
        }
        assert!(RayFile::parse(&[0xff, 0xfe, 0]).is_err_and(|why| why.contains("neither text")));
        assert!(RayFile::parse(npy::MAGIC).is_err_and(|why| why.contains("cut short")));
    }

    #[test]
    fn no_more_than_the_most_are_taken() {
        let ray = Ray::new(Vec3::Z, Vec3::NEG_Z);
        let file = RayFile::of_array(vec![ray; MOST + 1]).expect("rays");
        assert_eq!((file.rays.len(), file.more), (MOST, true));
        let broken = Ray::new(Vec3::Z, Vec3::ZERO);
        assert!(RayFile::of_array(vec![ray, broken]).is_err_and(|why| why.contains("row 1")));
    }

    #[test]
    fn rays_do_in_a_list_what_they_do_when_they_are_followed() {
        let load = LoadCx::unattended();
        let geometry =
            Arc::new(Geometry::new(&open("builtin:soup?triangles=2000", &load).expect("built in"), &load).expect("fits"));
        let entry = registry::find("bvh").expect("registered");
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
        let (middle, size) = (geometry.world_bounds().centre(), geometry.world_bounds().size().max_element());
        let ray = |i: u16| {
            let aside = Vec3::new(f32::from(i) / 300.0 - 0.5, 0.1, 0.0) * size;
            Ray::new(middle + aside + Vec3::Z * 2.0 * size, Vec3::NEG_Z)
        };
        let rays: Vec<Ray> = (0..600).map(ray).collect();
        let text: String = rays.iter().map(|ray| format!("{}\n", to_text(ray))).collect();
        assert_eq!(RayFile::parse(text.as_bytes()).map(|file| file.rays), Ok(rays.clone()));
        let (pool, cancel) = (Pool::new("rays", 2), Cancel::new());
        let work = work(accel.as_ref(), &rays, &pool, &cancel, &Progress::new()).expect("not cancelled");
        let order = dearest_first(&work, SahWeights::default());
        assert!(order.windows(2).all(|w| {
            let [a, b] = [w[0], w[1]].map(|i| work[i as usize].cost(SahWeights::default()));
            a > b || (a == b && w[0] < w[1])
        }));
        let at = order[0] as usize;
        let followed = follow(accel.as_ref(), &rays[at], Mode::Closest, &cancel).expect("not cancelled");
        assert_eq!(u64::from(work[at].nodes), followed.counts.nodes);
        assert_eq!(u64::from(work[at].tests), followed.counts.prims);
        assert_eq!(work[at].t, followed.hit.map_or(f32::INFINITY, |hit| hit.t));
        cancel.cancel();
        assert_eq!(super::work(accel.as_ref(), &rays, &pool, &cancel, &Progress::new()), Err(Cancelled));
    }
}
