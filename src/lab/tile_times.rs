//! How long the rays of each tile of a picture take. Never of each pixel: a ray alone is over before a clock has told its start
//! from its end, and what else happens meanwhile would be taken for its own.

use std::time::{Duration, Instant};

use super::measure::Fairness;
use crate::geometry::num::{index, narrow};
use crate::render::Job;
use crate::task::{Cancel, Cancelled, Progress};

/// Columns and rows of a tile.
pub const TILE: u32 = 8;
/// How often each tile is traced, at most; the least time counts.
pub const REPEATS: usize = 5;

/// How long tiles are timed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Limits {
    /// After so long no further round over all tiles begins.
    enough: Duration,
    /// After so long the first round ends, whatever tiles are left.
    most: Duration,
}

const LIMITS: Limits = Limits { enough: Duration::from_secs(5), most: Duration::from_secs(20) };

/// Nanoseconds by tile.
#[derive(Clone, Debug, PartialEq)]
pub struct TileTimes {
    /// Columns and rows of the picture.
    pub size_px: [u32; 2],
    /// Nanoseconds a ray of each tile, row by row; no number where it has no rays, or there was no time for it.
    pub ns: Vec<f32>,
    /// Rays of all tiles that were timed.
    pub rays: u64,
    /// Seconds of all tiles, the least of each.
    pub secs: f64,
    /// How often all tiles were timed; 0 where there was no time for all of them once.
    pub rounds: usize,
}

impl TileTimes {
    /// Of each pixel that of its tile, row by row.
    pub fn by_pixel(&self) -> Vec<f32> {
        let [width, height] = self.size_px;
        let columns = width.div_ceil(TILE);
        let tile = |x: u32, y: u32| (y / TILE * columns + x / TILE) as usize;
        (0..height).flat_map(|y| (0..width).map(move |x| self.ns[tile(x, y)])).collect()
    }

    /// What is less than it would be with more time, in words for the user.
    pub fn shortfall(&self) -> Option<String> {
        match self.rounds {
            0 => Some(format!("Not all tiles were timed: that would take more than {} s.", LIMITS.most.as_secs())),
            1 => Some(format!("Each tile was timed once: {REPEATS} times would take too long.")),
            n if n < REPEATS => Some(format!("Each tile was timed {n} times: {REPEATS} would take too long.")),
            _ => None,
        }
    }

    /// Nanoseconds a ray, of all of them; no number if there are none.
    pub fn mean_ns(&self) -> f64 {
        self.secs * 1e9 / self.rays as f64
    }
}

/// Times the rays of a job ([`Job::heat_rays`]) tile by tile, on the thread that it is called on: each tile is one call. All tiles
/// are traced once, then all once more, so that what disturbs the machine meanwhile falls on no tile each time. After some seconds
/// no further round begins; a first one that takes much longer ends, and leaves tiles out. The caller sees to it that nothing else
/// keeps the processors busy.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
pub fn time_tiles(
    job: &Job,
    size_px: [u32; 2],
    terms: Fairness,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<TileTimes, Cancelled> {
    let tiles = tiles(size_px);
    progress.start("tiles", (tiles * REPEATS) as u64);
    let (mode, mut hits, mut rays_of) = (job.heat_rays.mode(), Vec::new(), vec![0usize; tiles]);
    let time = |tile: usize| {
        cancel.check()?;
        let rays = job.heat_rays_of(pixels(size_px, tile), size_px, cancel)?;
        hits.clear();
        hits.resize(rays.len(), None);
        let start = Instant::now();
        match terms {
            Fairness::LikeForLike => job.accel.trace_like_for_like(&rays, mode, &mut hits, cancel)?,
            Fairness::Best => job.accel.trace(&rays, mode, &mut hits, cancel)?,
        };
        let took = start.elapsed();
        rays_of[tile] = rays.len();
        progress.advance(1);
        Ok(took)
    };
    let (least, rounds) = least_of_rounds(tiles, LIMITS, time)?;
    progress.finish();
    let each = || least.iter().map(Duration::as_secs_f64).zip(&rays_of);
    let ns = each().map(|(secs, rays)| if *rays > 0 { narrow(secs * 1e9 / *rays as f64) } else { f32::NAN }).collect();
    // What has no rays takes the clock's own time, and what was not timed has none.
    let secs = each().filter(|(_, rays)| **rays > 0).map(|(secs, _)| secs).sum();
    Ok(TileTimes { size_px, ns, rays: rays_of.iter().sum::<usize>() as u64, secs, rounds })
}

/// The least time of each of `n`, of [`REPEATS`] rounds over all of them or as many as there is time for; and how many those are.
fn least_of_rounds(
    n: usize,
    limits: Limits,
    mut time: impl FnMut(usize) -> Result<Duration, Cancelled>,
) -> Result<(Vec<Duration>, usize), Cancelled> {
    let (begin, mut least) = (Instant::now(), vec![Duration::MAX; n]);
    for round in 0..REPEATS {
        if round > 0 && begin.elapsed() >= limits.enough {
            return Ok((least, round));
        }
        for i in 0..n {
            if round == 0 && i > 0 && begin.elapsed() >= limits.most {
                return Ok((least, 0));
            }
            least[i] = time(i)?.min(least[i]);
        }
    }
    Ok((least, REPEATS))
}

/// Tiles of a picture, those cut off by its edges among them.
fn tiles([width, height]: [u32; 2]) -> usize {
    width.div_ceil(TILE) as usize * height.div_ceil(TILE) as usize
}

/// Columns and rows of a tile's pixels.
fn pixels([width, height]: [u32; 2], tile: usize) -> impl Iterator<Item = (u32, u32)> + Clone {
    let columns = width.div_ceil(TILE).max(1) as usize;
    let first = |i: usize| index(i).saturating_mul(TILE);
    let (x, y) = (first(tile % columns), first(tile / columns));
    let span = move |first: u32, n: u32| first..n.min(first.saturating_add(TILE));
    span(y, height).flat_map(move |y| span(x, width).map(move |x| (x, y)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accel, BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::render::{HeatRays, Mode};
    use crate::scene::{Geometry, LoadCx, open};
    use std::collections::HashSet;
    use std::sync::Arc;

    fn job() -> Job {
        let load = LoadCx::unattended();
        let scene = open("builtin:teapot?triangles=500", &load).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let entry = registry::find("bvh").expect("registered");
        let built = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
        let accel: Arc<dyn Accel> = Arc::from(built);
        let camera = scene.first_camera(geometry.world_bounds(), 1.5);
        Job::new(Arc::new(scene), accel, camera, Mode::Nodes, Arc::default())
    }

    #[test]
    fn every_pixel_is_in_one_tile_also_at_the_edges() {
        for size in [[16, 8], [17, 9], [1, 1], [7, 30], [0, 5]] {
            let all: Vec<(u32, u32)> = (0..tiles(size)).flat_map(|tile| pixels(size, tile)).collect();
            let once: HashSet<(u32, u32)> = all.iter().copied().collect();
            assert_eq!((all.len(), once.len()), ((size[0] * size[1]) as usize, all.len()), "{size:?}");
            assert!(all.iter().all(|(x, y)| *x < size[0] && *y < size[1]));
        }
        let corner: Vec<(u32, u32)> = pixels([17, 9], 5).collect();
        assert_eq!(corner, [(16, 8)]);
    }

    #[test]
    fn tiles_take_turns_and_the_least_of_five_counts() {
        let mut order = Vec::new();
        let unhurried = Limits { enough: Duration::MAX, most: Duration::MAX };
        let least = least_of_rounds(3, unhurried, |tile| {
            order.push(tile);
            Ok(Duration::from_nanos((100 - order.len() as u64) * (1 + tile as u64)))
        });
        assert_eq!(order, [0, 1, 2].repeat(REPEATS));
        // The last round was the fastest: calls 13, 14 and 15.
        assert_eq!(least, Ok(([87, 2 * 86, 3 * 85].map(Duration::from_nanos).to_vec(), REPEATS)));
    }

    #[test]
    fn no_more_is_timed_than_there_is_time_for() {
        let timed = |limits| {
            let mut calls = 0;
            let (least, rounds) = least_of_rounds(3, limits, |_| {
                calls += 1;
                Ok(Duration::ZERO)
            })
            .expect("not cancelled");
            (calls, rounds, least.iter().filter(|least| **least == Duration::MAX).count())
        };
        assert_eq!(timed(Limits { enough: Duration::ZERO, most: Duration::MAX }), (3, 1, 0));
        assert_eq!(timed(Limits { enough: Duration::ZERO, most: Duration::ZERO }), (1, 0, 2));
        let of = |rounds| TileTimes { size_px: [8, 8], ns: vec![1.0], rays: 64, secs: 64e-9, rounds }.shortfall();
        assert!(of(0).is_some_and(|said| said.starts_with("Not all tiles")) && of(1).is_some_and(|said| said.contains("once")));
        assert!(of(4).is_some_and(|said| said.contains("4 times")) && of(REPEATS).is_none());
    }

    #[test]
    fn each_pixel_has_the_time_of_its_tile() {
        let times = TileTimes { size_px: [9, 9], ns: vec![1.0, 2.0, 3.0, 4.0], rays: 81, secs: 81e-9, rounds: REPEATS };
        let by_pixel = times.by_pixel();
        assert_eq!([0, 7, 8, 72, 80].map(|i| by_pixel[i]), [1.0, 1.0, 2.0, 3.0, 4.0]);
        assert!((times.mean_ns() - 1.0).abs() < 1e-9);
    }

    #[test]
    fn all_rays_of_a_view_are_timed_and_tiles_without_rays_say_so() {
        let (mut job, size) = (job(), [50, 33]);
        let run = |job: &Job, terms| time_tiles(job, size, terms, &Cancel::new(), &Progress::new()).expect("not cancelled");
        for terms in [Fairness::LikeForLike, Fairness::Best] {
            let times = run(&job, terms);
            assert_eq!((times.ns.len(), times.rays), (7 * 5, 50 * 33));
            assert!(times.ns.iter().all(|ns| ns.is_finite() && *ns >= 0.0) && times.secs > 0.0);
        }
        job.heat_rays = HeatRays::Shadow;
        let times = run(&job, Fairness::LikeForLike);
        assert!(times.rays > 0 && times.rays < 50 * 33);
        assert!(times.ns.iter().any(|ns| ns.is_nan()) && times.ns.iter().any(|ns| ns.is_finite()));
        let cancel = Cancel::new();
        cancel.cancel();
        assert!(time_tiles(&job, size, Fairness::Best, &cancel, &Progress::new()).is_err());
    }
}
