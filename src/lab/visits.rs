//! How often the rays of a view enter the cells of a structure.

use std::collections::HashMap;

use super::rays::{RayKind, RaySet};
use super::tally::{Tally, shrunk};
use crate::accel::CellId;
use crate::render::Job;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// About so many pixels have their rays followed.
const PIXELS: f64 = 50_000.0;

/// Visits of cells, of a sample of a view's camera rays.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Visits {
    rays: usize,
    of: HashMap<CellId, u64>,
}

impl Visits {
    /// Follows camera rays of a view of that shape, for two seconds at most.
    ///
    /// # Errors
    /// [`Cancelled`] within 100 ms of the request.
    pub fn of_view(job: &Job, size: [u32; 2], pool: &Pool, cancel: &Cancel, progress: &Progress) -> Result<Self, Cancelled> {
        let [width, height] = shrunk(size, PIXELS);
        let set = RaySet::generate(RayKind::Primary, job, width, height, pool, cancel)?;
        let tally = Tally::of(job.accel.as_ref(), &[set], pool, cancel, progress)?;
        Ok(Self { rays: tally.rays, of: tally.visits })
    }

    /// Rays that were followed.
    pub const fn rays(&self) -> usize {
        self.rays
    }

    /// How often a ray enters a cell, on average.
    pub fn a_ray(&self, cell: CellId) -> f64 {
        self.of.get(&cell).copied().unwrap_or(0) as f64 / self.rays.max(1) as f64
    }

    /// The same of all cells.
    pub fn of_all(&self) -> f64 {
        self.of.values().sum::<u64>() as f64 / self.rays.max(1) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::probe::Counts;
    use crate::accel::{Accel, BuildCx, Mode, registry};
    use crate::geometry::tri::TestKind;
    use crate::render;
    use crate::scene::{Geometry, LoadCx, open};
    use std::sync::Arc;

    #[test]
    fn visits_are_those_that_are_counted() {
        let load = LoadCx::unattended();
        let scene = open("builtin:teapot?triangles=500", &load).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let camera = scene.first_camera(geometry.world_bounds(), 1.5);
        let scene = Arc::new(scene);
        for id in ["bvh", "kdtree", "grid"] {
            let entry = registry::find(id).expect("registered");
            let cx = BuildCx::unattended(2);
            let built = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds");
            let accel: Arc<dyn Accel> = Arc::from(built);
            let job = Job::new(Arc::clone(&scene), accel, camera, render::Mode::Shaded, Arc::default());
            let visits = Visits::of_view(&job, [30, 20], &cx.pool, &cx.cancel, &cx.progress).expect("not cancelled");
            let mut counts = Counts::default();
            for ray in job.camera_rays(30, 20, 0..20, 0) {
                job.accel.trace_watched(&ray, Mode::Closest, &mut counts, &cx.cancel).expect("not cancelled");
            }
            assert_eq!(visits.rays(), 600);
            assert!((visits.of_all() * 600.0 - counts.nodes as f64).abs() < 1e-6, "{id}: {counts:?}");
            // Nobody enters a tree but by its root.
            let root = visits.a_ray(job.accel.root().id);
            assert!(id == "grid" || (0.0..=1.0).contains(&root) && root > 0.0, "{id}: {root}");
        }
    }
}
