//! Bounding volumes of one node side by side: one of each kind around its triangles, how large it is, how often it lets a ray of
//! the view in for nothing, and what one test of it takes.

use std::ops::ControlFlow;
use std::time::Instant;

use rayon::prelude::*;

use super::rays::{RayKind, RaySet};
use super::sample::pick;
use super::statistics::{half_iqr, median};
use crate::accel::cell::{Cell, Descend, Form, walk_below};
use crate::accel::volumes::{Alone, KINDS, Kind};
use crate::accel::{Accel, Filter, Hit, Level, Mode};
use crate::geometry::Ray;
use crate::geometry::num::{floor_index, index};
use crate::render::Job;
use crate::scene::{Geometry, PrimRef};
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget, Pool, Progress};

/// A kind of volume around the node, in figures.
#[derive(Clone, Debug, PartialEq)]
pub struct FitRow {
    /// The kind, as in [`Kind`].
    pub id: &'static str,
    /// The area of its surface, in the scaled space of the node's level.
    pub area: f64,
    /// Rays that it lets in.
    pub met: usize,
    /// Those of them that hit none of the node's triangles, nowhere in their interval.
    pub in_vain: usize,
    /// Nanoseconds of one test: the median over rounds.
    pub test_ns: f64,
    /// Half the interquartile range of that.
    pub spread_ns: f64,
    /// It has fewer faces than its name says, since there would be too many.
    pub loose: bool,
    /// What it looks like, in the space of the node's level.
    pub form: Form,
}

impl FitRow {
    /// The share of the rays that it lets in for nothing; no number where it lets none in.
    pub fn false_positives(&self) -> f64 {
        self.in_vain as f64 / self.met as f64
    }
}

/// All kinds around one node.
#[derive(Clone, Debug, PartialEq)]
pub struct Fitting {
    /// A row a kind, in the order of the kinds.
    pub rows: Vec<FitRow>,
    /// Triangles of the node.
    pub triangles: usize,
    /// Those that the volumes are around: all, or so many evenly spread.
    pub taken: usize,
    /// Rays of the view that were tried: primary ones, and some that leave what those meet.
    pub rays: usize,
    /// Those of them that meet some volume and were followed: all, or so many evenly spread.
    pub followed: usize,
}

/// The most triangles that volumes are put around.
const MOST_TRIANGLES: usize = 1 << 16;
/// Primary rays that are tried, at most.
const PRIMARY: f64 = 262_144.0;
/// Pixels that send rays on from what they meet, at most.
const DIFFUSE: f64 = 8192.0;
/// Rays that are followed, at most.
const FOLLOWED: usize = 8192;
/// Seconds after which no more of them are.
const SECS: f64 = 2.0;
/// Rays followed at a time.
const CHUNK: usize = 64;
/// Cells between two looks at whether to stop.
const PER_CHECK: usize = 1 << 12;
/// Bytes of a triangle in the list of those of a node: its number, and as much again while the list grows.
const LISTED: u64 = 2 * 4;
/// Bytes of a triangle's corners in 64 bits, as a volume is put around them.
const POINTS: u64 = 3 * 24;
/// Tests of a volume in a round of its timing, about.
const TESTS: usize = 100_000;
/// Rounds of it.
const ROUNDS: usize = 15;

/// Whether volumes can be compared around a cell: not in an upper level, whose triangles are in many spaces.
pub fn can_fit(accel: &dyn Accel, cell: &Cell) -> bool {
    accel.levels().is_none() || cell.id.instance != 0
}

/// Why volumes can't be compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum FitError {
    /// Stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The node's triangles, or the rays, do not fit.
    #[error(transparent)]
    Memory(#[from] OverBudget),
}

/// Compares volumes around the triangles of a cell of the job's structure, with rays of its view of that size; `None` if it has
/// none, or [they can't be compared](can_fit).
///
/// The caller sees to it that nothing else keeps the processors busy.
///
/// # Errors
/// It does not fit, or it was asked to stop: within 100 ms of the request.
pub fn fit_volumes(
    job: &Job,
    size: [u32; 2],
    cell: &Cell,
    pool: &Pool,
    (budget, cancel, progress): (&Budget, &Cancel, &Progress),
) -> Result<Option<Fitting>, FitError> {
    let accel = job.accel.as_ref();
    progress.start("triangles", 0);
    if !can_fit(accel, cell) {
        return Ok(None);
    }
    let mut memory = budget.charge(0)?;
    let mut node = Node::new(accel, cell, &mut memory)?;
    let triangles = node.gather(cell, &mut memory, cancel)?;
    if triangles.is_empty() {
        return Ok(None);
    }
    let taken = pick(&triangles, MOST_TRIANGLES);
    memory.grow(taken.len() as u64 * POINTS * kinds().count() as u64)?;
    progress.start("fit", kinds().count() as u64);
    let volumes = fitted(node.geometry, &taken, pool, cancel, progress)?;

    progress.start("rays", FOLLOWED as u64);
    let rays = rays_of(job, size, pool, &mut memory, cancel)?;
    // They are found in parts, and then put together.
    memory.grow(rays.len() as u64 * 2 * size_of::<Near>() as u64)?;
    let near = near(&node, &volumes, &rays, pool, cancel)?;
    let chosen = pick(&near, FOLLOWED);
    let hits = hits(&node, &chosen.iter().map(|near| near.world).collect::<Vec<_>>(), pool, cancel, progress)?;
    let times = times(&volumes, &chosen.iter().map(|near| near.local).collect::<Vec<_>>(), cancel, progress)?;

    let followed: Vec<(u32, bool)> = chosen.iter().zip(&hits).filter_map(|(near, hit)| Some((near.met, (*hit)?))).collect();
    let row = |(k, (kind, volume)): (usize, &(&'static Kind, Box<dyn Alone>))| {
        let met = || followed.iter().filter(move |(met, _)| met >> k & 1 == 1);
        let loose = volume.loose();
        FitRow {
            id: kind.id,
            area: volume.area(),
            met: met().count(),
            in_vain: met().filter(|(_, hit)| !hit).count(),
            test_ns: median(&times[k]),
            spread_ns: half_iqr(&times[k]),
            loose: loose.simplified + loose.failed > 0,
            form: volume.form(),
        }
    };
    let rows = volumes.iter().enumerate().map(row).collect();
    let (triangles, taken) = (triangles.len(), taken.len());
    Ok(Some(Fitting { rows, triangles, taken, rays: rays.len(), followed: followed.len() }))
}

/// The kinds that are compared: the box of the axes is there once, and not as slabs as well.
fn kinds() -> impl Iterator<Item = &'static Kind> {
    KINDS.iter().filter(|kind| kind.id != "kdop6")
}

/// Their names, in the order of the rows.
pub fn fitted_kinds() -> impl Iterator<Item = &'static str> {
    kinds().map(|kind| kind.id)
}

/// The triangles that are asked for, and where they are.
struct Node<'a> {
    accel: &'a dyn Accel,
    level: Option<Level>,
    /// What the references are of.
    geometry: &'a Geometry,
    /// A bit for each triangle of those.
    members: Vec<u64>,
}

impl<'a> Node<'a> {
    /// Of no triangles yet.
    fn new(accel: &'a dyn Accel, cell: &Cell, memory: &mut Charge) -> Result<Self, OverBudget> {
        let geometry = accel.geometry_of(cell.id.instance);
        let words = geometry.triangle_count().div_ceil(64);
        memory.grow(words as u64 * 8)?;
        Ok(Self { accel, level: accel.level(cell.id.instance), geometry, members: vec![0; words] })
    }

    /// Takes in the triangles in a cell and below it, and returns them, each once, in the order of a walk: neighbours are near
    /// each other.
    fn gather(&mut self, cell: &Cell, memory: &mut Charge, cancel: &Cancel) -> Result<Vec<PrimRef>, FitError> {
        let (mut order, mut room, mut looked, mut stopped) = (Vec::new(), 0usize, 0usize, Ok(()));
        let (accel, members) = (self.accel, &mut self.members);
        walk_below(accel, *cell, &mut |cell| {
            looked += 1;
            if looked.is_multiple_of(PER_CHECK) {
                stopped = cancel.check().map_err(FitError::from);
            }
            let need = order.len() + if cell.is_leaf() { cell.prims() as usize } else { 0 };
            if stopped.is_ok() && need > room {
                let more = (need - room).max(PER_CHECK);
                room += more;
                stopped = memory.grow(more as u64 * LISTED).map_err(FitError::from);
            }
            if stopped.is_err() {
                return ControlFlow::Break(());
            }
            if cell.is_leaf() {
                accel.prims(cell, &mut |prim| {
                    let (word, bit) = place(prim);
                    if members[word] & bit == 0 {
                        members[word] |= bit;
                        order.push(prim);
                    }
                });
            }
            ControlFlow::Continue(Descend::Yes)
        });
        stopped.map(|()| order)
    }

    /// A world ray in the space of the level; `None` if nothing can be hit there.
    fn enter(&self, ray: &Ray) -> Option<Ray> {
        if !ray.is_valid() {
            return None;
        }
        let scene = self.accel.geometry().space().enter(ray).ray;
        let local = match self.level {
            Some(Level { instance: Some(_), scene_from_level }) => {
                self.geometry.space().enter_mapped(&scene, &scene_from_level.inverse()).ray
            }
            _ => scene,
        };
        (local.tmin <= local.tmax && local.is_valid()).then_some(local)
    }
}

impl Filter for Node<'_> {
    /// Whether one of the triangles was hit.
    fn accepts(&self, hit: &Hit) -> bool {
        // What was flattened has numbers of its own.
        let flat = self.accel.geometry().flat(hit.instance, hit.primitive);
        let here = match self.level.and_then(|level| level.instance) {
            Some(instance) => flat.is_none() && instance == hit.instance,
            None => flat.is_some(),
        };
        let (word, bit) = place(flat.unwrap_or(hit.primitive));
        here && self.members.get(word).is_some_and(|members| members & bit != 0)
    }
}

/// The word that a triangle's bit is in, and the bit.
const fn place(prim: PrimRef) -> (usize, u64) {
    (prim as usize / 64, 1 << (prim % 64))
}

/// A kind, and its volume around the triangles.
type Fitted = (&'static Kind, Box<dyn Alone>);

fn fitted(
    geometry: &Geometry,
    prims: &[PrimRef],
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<Fitted>, Cancelled> {
    let one = |kind: &'static Kind| {
        let volume = kind.around(geometry, prims, cancel)?;
        progress.advance(1);
        Ok((kind, volume))
    };
    let kinds: Vec<&'static Kind> = kinds().collect();
    pool.run(|| kinds.into_par_iter().map(one).collect())
}

/// Rays of the view: primary ones, and some that leave what they meet.
fn rays_of(job: &Job, size: [u32; 2], pool: &Pool, memory: &mut Charge, cancel: &Cancel) -> Result<Vec<Ray>, FitError> {
    let mut of = |kind, pixels: f64| -> Result<RaySet, FitError> {
        let shrink = (pixels / (f64::from(size[0].max(1)) * f64::from(size[1].max(1)))).sqrt().min(1.0);
        let [width, height] = size.map(|n| index(floor_index((f64::from(n) * shrink).ceil().max(1.0), 1 << 16)));
        // Rays are made in parts, each with its pixel, and then put together.
        memory.grow(u64::from(width) * u64::from(height) * 2 * (size_of::<Ray>() as u64 + 8))?;
        Ok(RaySet::generate(kind, job, width, height, pool, cancel)?)
    };
    let mut rays = of(RayKind::Primary, PRIMARY)?.rays;
    rays.extend(of(RayKind::Diffuse, DIFFUSE)?.rays);
    Ok(rays)
}

/// A ray that meets some volume.
#[derive(Clone, Copy)]
struct Near {
    world: Ray,
    /// The same in the space of the level.
    local: Ray,
    /// Which volumes, a bit each.
    met: u32,
}

fn near(node: &Node<'_>, volumes: &[Fitted], rays: &[Ray], pool: &Pool, cancel: &Cancel) -> Result<Vec<Near>, Cancelled> {
    const BAND: usize = 4096;
    let one = |world: &Ray| {
        let local = node.enter(world)?;
        let bit = |(k, (_, volume)): (usize, &Fitted)| u32::from(volume.meets(&local)) << k;
        let met = volumes.iter().enumerate().map(bit).fold(0, |a, b| a | b);
        (met != 0).then_some(Near { world: *world, local, met })
    };
    let band = |rays: &[Ray]| cancel.check().map(|()| rays.iter().filter_map(one).collect::<Vec<_>>());
    let bands: Result<Vec<Vec<Near>>, Cancelled> = pool.run(|| rays.par_chunks(BAND).map(band).collect());
    Ok(bands?.concat())
}

/// Whether each ray hits one of the node's triangles; `None` where there was no time to look.
fn hits(
    node: &Node<'_>,
    rays: &[Ray],
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<Option<bool>>, Cancelled> {
    // Every so many-th ray is a chunk: if there is no time for all, those that were followed are from everywhere.
    let chunks = rays.len().div_ceil(CHUNK);
    let begin = Instant::now();
    let chunk = |first: usize| {
        let some: Vec<Ray> = rays.iter().skip(first).step_by(chunks).copied().collect();
        if first > 0 && begin.elapsed().as_secs_f64() > SECS {
            return Ok(vec![None; some.len()]);
        }
        let mut hits = vec![None; some.len()];
        node.accel.trace_filtered(&some, Mode::Any, node, &mut hits, cancel)?;
        progress.advance(some.len() as u64);
        Ok(hits.iter().map(|hit| Some(hit.is_some())).collect())
    };
    let parts: Result<Vec<Vec<Option<bool>>>, Cancelled> = pool.run(|| (0..chunks).into_par_iter().map(chunk).collect());
    let parts = parts?;
    Ok((0..rays.len()).map(|i| parts[i % chunks][i / chunks]).collect())
}

/// Nanoseconds of one test of each volume, by rounds: all of them in turns, by one thread, with the same rays.
fn times(volumes: &[Fitted], rays: &[Ray], cancel: &Cancel, progress: &Progress) -> Result<Vec<Vec<f64>>, Cancelled> {
    let mut ns: Vec<Vec<f64>> = vec![Vec::new(); volumes.len()];
    if rays.is_empty() {
        return Ok(ns);
    }
    progress.start("time", ROUNDS as u64);
    let times = TESTS.div_ceil(rays.len());
    let runs: Vec<_> = volumes.iter().map(|(_, volume)| volume.tests(rays)).collect();
    for round in 0..=ROUNDS {
        for i in 0..runs.len() {
            cancel.check()?;
            let k = (round + i) % runs.len();
            let start = Instant::now();
            std::hint::black_box(runs[k](times));
            // The first round warms up.
            if round > 0 {
                ns[k].push(start.elapsed().as_secs_f64() * 1e9 / (times * rays.len()) as f64);
            }
        }
        progress.advance(u64::from(round > 0));
    }
    Ok(ns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::render::{Looks, Mode as Shown};
    use crate::scene::texture::Detail;
    use crate::scene::{LoadCx, open};
    use std::sync::Arc;

    fn job(id: &str) -> Job {
        let cx = LoadCx::unattended();
        let scene = Arc::new(open("builtin:teapot?triangles=1000", &cx).expect("built in"));
        let geometry = Arc::new(Geometry::new(&scene, &cx).expect("fits"));
        let entry = registry::find(id).expect("registered");
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
        let camera = scene.first_camera(geometry.world_bounds(), 1.0);
        let looks = Arc::new(Looks::decode(&scene, Detail::Colors, &cx).expect("not cancelled"));
        Job::new(scene, Arc::from(accel), camera, Shown::Shaded, looks)
    }

    fn fit(job: &Job, cell: &Cell) -> Fitting {
        let pool = Pool::new("test", 1);
        let fitted = fit_volumes(job, [64, 64], cell, &pool, (&Budget::unlimited(), &Cancel::new(), &Progress::new()));
        fitted.expect("not cancelled").expect("has triangles")
    }

    fn child(accel: &dyn Accel, cell: &Cell) -> Cell {
        let mut child = *cell;
        accel.children(cell, &mut |cell| {
            child = cell;
            ControlFlow::Break(())
        });
        child
    }

    #[test]
    fn tighter_volumes_let_fewer_rays_in_for_nothing() {
        let job = job("bvh");
        let root = job.accel.root();
        for (cell, least) in [(root, 100), (child(job.accel.as_ref(), &root), 5)] {
            let fitting = fit(&job, &cell);
            let row = |id: &str| fitting.rows.iter().find(|row| row.id == id).expect("a row");
            assert_eq!(fitting.rows.len(), KINDS.len() - 1);
            assert!(fitting.taken == fitting.triangles && fitting.triangles > least && fitting.followed > least);
            let [hull, all, corners, aabb] = ["hull", "kdop26", "kdop14", "aabb"].map(row);
            for pair in [[hull, all], [all, corners], [corners, aabb]] {
                assert!(pair[0].area <= pair[1].area * (1.0 + 1e-5), "{} {}", pair[0].id, pair[1].id);
                assert!(pair[0].met <= pair[1].met && pair[0].in_vain <= pair[1].in_vain);
            }
            // No volume misses a ray that hits: all let the same rays in that hit.
            let hit = hull.met - hull.in_vain;
            assert!(hit > least && fitting.rows.iter().all(|row| row.met - row.in_vain == hit));
            assert!(fitting.rows.iter().all(|row| row.test_ns > 0.0));
        }
    }

    #[test]
    fn what_does_not_fit_is_refused_and_given_back() {
        let (job, pool, progress) = (job("bvh"), Pool::new("test", 1), Progress::new());
        let fit = |budget: &Budget, cancel: &Cancel| {
            fit_volumes(&job, [64, 64], &job.accel.root(), &pool, (budget, cancel, &progress)).map(|fitting| fitting.is_some())
        };
        // No bits, no list, no points, no rays.
        for room in [0, 1000, 20_000, 600_000] {
            assert!(matches!(fit(&Budget::new(room), &Cancel::new()), Err(FitError::Memory(_))), "{room}");
        }
        let budget = Budget::new(1 << 30);
        assert_eq!((fit(&budget, &Cancel::new()), budget.used()), (Ok(true), 0));
        let cancel = Cancel::new();
        cancel.cancel();
        assert_eq!(fit(&budget, &cancel), Err(FitError::Cancelled(Cancelled)));
    }

    #[test]
    fn the_same_triangles_are_hit_in_every_structure() {
        let of = |id| {
            let job = job(id);
            fit(&job, &job.accel.root())
        };
        let (bvh, kd) = (of("bvh"), of("kdtree"));
        // Near ties may send a ray on from another triangle.
        let near = |a: usize, b: usize| a.abs_diff(b) <= bvh.followed / 100;
        // The others are chosen by a few points, and which those are is decided by the order of the triangles.
        let of_slabs = |row: &&FitRow| row.id == "aabb" || row.id.starts_with("kdop");
        for (a, b) in bvh.rows.iter().filter(of_slabs).zip(kd.rows.iter().filter(of_slabs)) {
            assert!(a.id == b.id && a.area == b.area && near(a.met, b.met) && near(a.in_vain, b.in_vain), "{}", a.id);
        }
        assert_eq!((bvh.triangles, bvh.rays > 4000), (kd.triangles, true));
    }
}
