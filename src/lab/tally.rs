//! What rays do in a structure, cell by cell and triangle by triangle.

use std::collections::HashMap;
use std::hash::Hash;
use std::time::Instant;

use rayon::prelude::*;

use super::rays::RaySet;
use crate::accel::probe::{Counts, Watched};
use crate::accel::{Accel, CellId, Mode, Step};
use crate::geometry::Ray;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// Seconds after which no more rays are followed.
const SECS: f64 = 2.0;
/// Rays followed at a time.
const CHUNK: usize = 64;

/// Columns and rows of a picture of the same shape that has about so many pixels, if it has more.
pub fn shrunk(size: [u32; 2], pixels: f64) -> [u32; 2] {
    let shrink = (pixels / (f64::from(size[0].max(1)) * f64::from(size[1].max(1)))).sqrt().min(1.0);
    size.map(|n| crate::geometry::num::index((f64::from(n) * shrink).ceil().max(1.0) as usize))
}

/// A triangle, by the level that it is on (see [`CellId`]) and its number there.
pub type Prim = (u32, u32);

/// What rays did.
#[derive(Default)]
pub struct Tally {
    /// How many were followed.
    pub rays: usize,
    /// In all.
    pub counts: Counts,
    /// How often cells were entered.
    pub visits: HashMap<CellId, u64>,
    /// What became of triangles that were tested.
    pub tests: HashMap<Prim, Tested>,
}

/// What became of a triangle.
#[derive(Clone, Copy, Default)]
pub struct Tested {
    /// How often it was tested.
    pub tests: u64,
    /// How often it was met.
    pub hits: u64,
    /// A leaf that it was tested in.
    pub leaf: Option<CellId>,
}

impl Tested {
    fn add(&mut self, other: Self) {
        self.tests += other.tests;
        self.hits += other.hits;
        self.leaf = self.leaf.or(other.leaf);
    }
}

impl Tally {
    /// Follows rays, as many as there is time for.
    ///
    /// # Errors
    /// [`Cancelled`] within 100 ms of the request.
    pub fn of(accel: &dyn Accel, sets: &[RaySet], pool: &Pool, cancel: &Cancel, progress: &Progress) -> Result<Self, Cancelled> {
        let rays: Vec<(Ray, Mode)> = sets.iter().flat_map(|set| set.rays.iter().map(|ray| (*ray, set.mode))).collect();
        // Every so many-th ray is a chunk: if there is no time for all, those that were followed are from everywhere.
        let chunks = rays.len().div_ceil(CHUNK);
        progress.start("rays", rays.len() as u64);
        let begin = Instant::now();
        let chunk = |first: usize| {
            let mut tally = Self::default();
            if first > 0 && begin.elapsed().as_secs_f64() > SECS {
                return Ok(tally);
            }
            for (ray, mode) in rays.iter().skip(first).step_by(chunks) {
                tally.follow(accel, ray, *mode, cancel)?;
            }
            progress.advance(tally.rays as u64);
            Ok(tally)
        };
        let add = |a: Self, b: Self| Ok(a.add(b));
        pool.run(|| (0..chunks).into_par_iter().map(chunk).try_reduce(Self::default, add))
    }

    fn follow(&mut self, accel: &dyn Accel, ray: &Ray, mode: Mode, cancel: &Cancel) -> Result<(), Cancelled> {
        let (mut level, mut leaf) = (0, None);
        let mut listener = |step| match step {
            Step::Level(instance) => (level, leaf) = (instance, None),
            Step::Entered(node) => {
                let cell = CellId { instance: level, node };
                *self.visits.entry(cell).or_default() += 1;
                leaf = Some(cell);
            }
            Step::Tested(prim, t) => {
                self.tests.entry((level, prim)).or_default().add(Tested { tests: 1, hits: u64::from(t.is_some()), leaf });
            }
            Step::Pruned(..) | Step::OutsideCell => {}
        };
        let mut counts = Counts::default();
        let mut watched = Watched { counts: &mut counts, listener: Some(&mut listener) };
        accel.trace_heard(ray, mode, &mut watched, cancel)?;
        self.counts += counts;
        self.rays += 1;
        Ok(())
    }

    fn add(mut self, other: Self) -> Self {
        self.rays += other.rays;
        self.counts += other.counts;
        merge(&mut self.visits, other.visits, |a, b| *a += b);
        merge(&mut self.tests, other.tests, Tested::add);
        self
    }
}

fn merge<K: Eq + Hash, V: Default>(into: &mut HashMap<K, V>, from: HashMap<K, V>, add: impl Fn(&mut V, V)) {
    from.into_iter().for_each(|(key, value)| add(into.entry(key).or_default(), value));
}
