//! Whether two structures find the same: one traces for a picture, the other is asked the same rays.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

use serde::Serialize;

use crate::accel::cell::{Cell, Cells, Layout, Level, MemoryPart};
use crate::accel::probe::{Off, Watched};
use crate::accel::{Accel, Accepts, Asked, Filter, Hit, Mode, PrimHit, Traced};
use crate::geometry::Ray;
use crate::lab::ties::rounding_explains;
use crate::render::{Film, Job};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled, Pool};

/// How two structures answer the rays of a picture's paths.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Agreement {
    /// Rays that both traced: camera rays, bounces and shadow rays.
    pub rays: u64,
    /// Of those, the ones where rounding decides which hit is the nearest, and it decided otherwise.
    pub near_ties: u64,
    /// Others; there should be none.
    pub wrong: u64,
}

/// Traces through one structure, and asks another.
struct Witness {
    first: Arc<dyn Accel>,
    other: Arc<dyn Accel>,
    rays: AtomicU64,
    near_ties: AtomicU64,
    wrong: AtomicU64,
}

/// Renders one sample of a picture of that size through the job's structure, and compares every ray with another's answer.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn agreement(
    job: &Job,
    other: &Arc<dyn Accel>,
    size: (u32, u32),
    pool: &Pool,
    cancel: &Cancel,
) -> Result<Agreement, Cancelled> {
    let [rays, near_ties, wrong] = [0; 3].map(AtomicU64::new);
    let witness = Arc::new(Witness { first: Arc::clone(&job.accel), other: Arc::clone(other), rays, near_ties, wrong });
    let job = Job { accel: Arc::clone(&witness) as Arc<dyn Accel>, ..job.clone() };
    job.pass(&mut Film::new(size.0, size.1), pool, cancel)?;
    let read = |n: &AtomicU64| n.load(Ordering::Relaxed);
    Ok(Agreement { rays: read(&witness.rays), near_ties: read(&witness.near_ties), wrong: read(&witness.wrong) })
}

impl Witness {
    fn compare(&self, rays: &[Ray], mode: Mode, ours: &[Option<Hit>], theirs: &[Option<Hit>]) {
        let geometry = self.first.geometry();
        self.rays.fetch_add(rays.len() as u64, Ordering::Relaxed);
        for ((ray, a), b) in rays.iter().zip(ours).zip(theirs) {
            let same = if mode == Mode::Any { a.is_some() == b.is_some() } else { a == b };
            if !same {
                let count = if rounding_explains(ray, [*a, *b], geometry) { &self.near_ties } else { &self.wrong };
                count.fetch_add(1, Ordering::Relaxed);
            }
        }
    }
}

impl Cells for Witness {
    fn root(&self) -> Cell {
        self.first.root()
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        self.first.children(cell, each);
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        self.first.prims(cell, each);
    }

    fn level(&self, instance: u32) -> Option<Level> {
        self.first.level(instance)
    }

    fn layout(&self) -> Layout {
        self.first.layout()
    }

    fn memory(&self) -> Vec<MemoryPart> {
        self.first.memory()
    }
}

impl Accel for Witness {
    fn geometry(&self) -> &Arc<Geometry> {
        self.first.geometry()
    }

    fn trace(&self, rays: &[Ray], mode: Mode, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<Traced, Cancelled> {
        let traced = self.first.trace(rays, mode, hits, cancel)?;
        let mut theirs = vec![None; hits.len()];
        self.other.trace(rays, mode, &mut theirs, cancel)?;
        self.compare(rays, mode, hits, &theirs);
        Ok(traced)
    }

    fn trace_filtered(
        &self,
        rays: &[Ray],
        mode: Mode,
        filter: &dyn Filter,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        let traced = self.first.trace_filtered(rays, mode, filter, hits, cancel)?;
        let mut theirs = vec![None; hits.len()];
        self.other.trace_filtered(rays, mode, filter, &mut theirs, cancel)?;
        self.compare(rays, mode, hits, &theirs);
        Ok(traced)
    }

    fn trace_like_for_like(
        &self,
        rays: &[Ray],
        mode: Mode,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        self.first.trace_like_for_like(rays, mode, hits, cancel)
    }

    fn trace_scaled(&self, ray: &Ray, mode: Mode, off: Off, cancel: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        self.first.trace_scaled(ray, mode, off, cancel)
    }

    fn trace_scaled_filtered(
        &self,
        ray: &Ray,
        mode: Mode,
        accepts: Accepts<'_>,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled> {
        self.first.trace_scaled_filtered(ray, mode, accepts, cancel)
    }

    fn trace_scaled_heard(
        &self,
        ray: &Ray,
        asked: Asked,
        watched: &mut Watched<'_>,
        cancel: &Cancel,
    ) -> Result<Option<PrimHit>, Cancelled> {
        self.first.trace_scaled_heard(ray, asked, watched, cancel)
    }
}
