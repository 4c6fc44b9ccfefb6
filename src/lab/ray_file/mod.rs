//! Files of rays, and what each of them does in a structure: a line a ray, as [`super::follow::to_text`] writes it, `#` before
//! what is no ray; or a NumPy array, as `boxwood rays` and the stability lab write it.

pub mod npy;

use std::fs::File;
use std::io::Read;
use std::path::Path;

use rayon::prelude::*;

use super::follow::from_text;
use crate::accel::probe::Counts;
use crate::accel::stats::SahWeights;
use crate::accel::{Accel, Mode};
use crate::geometry::{Ray, num};
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget, Pool, Progress};

/// Rays that are taken of one file.
pub const MOST: usize = 1_000_000;
/// Rays traced between two looks at whether to stop.
const CHUNK: usize = 256;
/// Lines or rows between two looks at whether to stop.
const PER_CHECK: usize = 4096;
/// Bytes read between two.
const READ: u64 = 1 << 20;

/// Why a file is of no use.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RayFileError {
    /// Stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// It does not fit.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// It can't be read, or where it is wrong and why, in words for the user.
    #[error("{0}")]
    Wrong(String),
}

impl From<String> for RayFileError {
    fn from(why: String) -> Self {
        Self::Wrong(why)
    }
}

impl From<std::io::Error> for RayFileError {
    fn from(why: std::io::Error) -> Self {
        Self::Wrong(why.to_string())
    }
}

/// The bytes of a file, and what they and as many bytes of rays take. A pipe, which does not say how long it is, is read
/// until it ends or the budget does; a file that grows meanwhile is cut at what it claimed.
///
/// # Errors
/// Stopped, it does not fit, or it can't be read.
pub fn read(path: &Path, budget: &Budget, cancel: &Cancel) -> Result<(Vec<u8>, Charge), RayFileError> {
    let file = File::open(path)?;
    let claimed = file.metadata()?.len();
    let mut memory = budget.charge(claimed.saturating_mul(2))?;
    let mut file = file.take(if claimed == 0 { u64::MAX } else { claimed });
    let mut bytes = Vec::new();
    loop {
        cancel.check()?;
        let more = file.by_ref().take(READ).read_to_end(&mut bytes)? as u64;
        if more == 0 {
            return Ok((bytes, memory));
        }
        if claimed == 0 {
            memory.grow(more * 2)?;
        }
    }
}

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
    /// Stopped, or where it is wrong and why.
    pub fn parse(bytes: &[u8], cancel: &Cancel) -> Result<Self, RayFileError> {
        if bytes.starts_with(npy::MAGIC) {
            return Ok(Self::of_array(npy::parse(bytes, MOST + 1, cancel)?)?);
        }
        let mut file = Self::default();
        for (i, line) in bytes.split(|byte| *byte == b'\n').enumerate() {
            if i.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            let line = std::str::from_utf8(line).map_err(|_| "it is neither text nor a NumPy array".to_owned())?;
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
        if file.rays.is_empty() { Err("there is no ray in it".to_owned().into()) } else { Ok(file) }
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

    fn parse(bytes: &[u8]) -> Result<RayFile, String> {
        RayFile::parse(bytes, &Cancel::new()).map_err(|why| why.to_string())
    }

    #[test]
    fn reading_stops_when_asked_and_ends_with_the_budget() {
        let cancel = Cancel::new();
        cancel.cancel();
        let array = b"\x93NUMPY\x01\x00\x00\x00";
        assert_eq!(RayFile::parse(b"0 0 1 0 0 -1\n", &cancel), Err(Cancelled.into()));
        assert!(RayFile::parse(array, &cancel).is_err());
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("many.rays");
        std::fs::write(&path, "0 0 1 0 0 -1\n".repeat(200_000)).expect("room on the disk");
        let budget = Budget::new(1 << 30);
        let (bytes, memory) = read(&path, &budget, &Cancel::new()).expect("readable");
        assert_eq!((bytes.len(), memory.bytes()), (13 * 200_000, 2 * 13 * 200_000));
        assert_eq!(parse(&bytes).map(|file| file.rays.len()), Ok(200_000));
        assert_eq!(read(&path, &budget, &cancel).err(), Some(Cancelled.into()));
        assert!(matches!(read(&path, &Budget::new(1 << 20), &Cancel::new()), Err(RayFileError::Memory(_))));
        assert!(matches!(read(&folder.path().join("none.rays"), &budget, &Cancel::new()), Err(RayFileError::Wrong(_))));
    }

    #[cfg(unix)]
    #[test]
    fn what_never_ends_is_read_until_the_budget_does() {
        let endless = read(Path::new("/dev/zero"), &Budget::new(16 << 20), &Cancel::new());
        assert!(matches!(endless, Err(RayFileError::Memory(_))));
    }

    #[test]
    fn lines_are_rays_and_what_is_wrong_is_told_by_its_line() {
        let text = "# x y z  dx dy dz\n\n0 0 1  0 0 -1 # straight down\n0,0,1, 0,0,-1, 0.5, 2\n";
        let file = parse(text.as_bytes()).expect("rays");
        assert_eq!((file.rays.len(), file.rays[0].tmax, file.rays[1].tmin, file.more), (2, f32::INFINITY, 0.5, false));
        for (text, part) in [
            ("0 0 1 0 0 -1\n# fine\n0 0 1 0 zero -1\n", "line 3: 'zero' is no number"),
            ("1 2 3\n", "line 1: a ray is six or eight"),
            ("# nothing\n", "there is no ray in it"),
            ("", "there is no ray in it"),
        ] {
            assert!(parse(text.as_bytes()).is_err_and(|why| why.contains(part)), "{part}");
        }
        assert!(parse(&[0xff, 0xfe, 0]).is_err_and(|why| why.contains("neither text")));
        assert!(parse(npy::MAGIC).is_err_and(|why| why.contains("cut short")));
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
        assert_eq!(parse(text.as_bytes()).map(|file| file.rays), Ok(rays.clone()));
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
