//! The same rules on any scene: what structures answer to rays of a view, beside the exact test over a plain BVH, which the
//! lab holds to the oracle. Where an answer differs, the oracle itself judges it.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::judge::{Expected, Wrong, expected};
use super::oracle::passings_of;
use crate::accel::cell::{Descend, walk};
use crate::accel::registry::{self, Family};
use crate::accel::{Accel, BuildCx, BuildError, Hit, Mode};
use crate::geometry::space::Entered;
use crate::geometry::tri::{TestKind, bounds::bounds};
use crate::geometry::{Ray, Slabs};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled, Pool};

/// What came out of one structure.
#[derive(Clone, Debug, Serialize)]
pub struct SceneRow {
    /// The structure.
    pub id: String,
    /// The triangle test.
    pub test: TestKind,
    /// Rays traced: all, or an evenly spread part where a structure is too slow for that.
    pub rays: usize,
    /// Rays that meet another triangle than they do exactly, or none, or one where there is none, as rounding may have it.
    pub rounded: usize,
    /// Rays that are answered wrongly.
    pub wrong: usize,
    /// The first of those that are not answered exactly, the wrong ones first.
    pub differing: Vec<DifferingRay>,
}

/// A ray that is not answered exactly.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct DifferingRay {
    /// Which of the rays.
    pub ray: usize,
    /// What is wrong; nothing if rounding explains it.
    pub why: Option<Wrong>,
    /// The exact t, in the world; infinite if nothing is hit.
    pub t: f32,
}

/// What traces rays for their closest hits.
pub type Answers<'a> = &'a (dyn Fn(&[Ray], &mut [Option<Hit>]) -> Result<(), Cancelled> + Sync);

/// A structure's.
pub fn answers_of<'a>(
    accel: &'a dyn Accel,
    cancel: &'a Cancel,
) -> impl Fn(&[Ray], &mut [Option<Hit>]) -> Result<(), Cancelled> + Sync + 'a {
    |rays, hits| accel.trace(rays, Mode::Closest, hits, cancel).map(|_| ())
}

/// Rays compared at a time; a structure that is none takes a tenth of a second for them on a million triangles.
const CHUNK: usize = 64;
/// Differing rays kept of a row.
const KEPT: usize = 512;

/// What others are compared with.
pub struct Reference {
    /// A plain BVH with the exact test.
    pub accel: Arc<dyn Accel>,
    closed: bool,
}

impl Reference {
    /// Builds it. Where the surface is `closed`, nothing may slip through.
    ///
    /// # Errors
    /// Cancelled, or it would not fit.
    pub fn build(geometry: &Arc<Geometry>, closed: bool, cx: &BuildCx) -> Result<Self, BuildError> {
        let entry = registry::ALL.iter().find(|entry| entry.family == Family::Bvh).unwrap_or(&registry::ALL[0]);
        let mut params = entry.defaults();
        // Without triangles cut: below, boxes of nodes must hold those of their triangles.
        let _ = params.set("builder", "binned"); // a structure without that choice cuts none
        Ok(Self { accel: Arc::from(entry.build(geometry, TestKind::Exact, &params, cx)?), closed })
    }

    /// Judges what a structure that was built over the same geometry, or anything else, answers to rays: to as many as it
    /// takes in about `secs` seconds.
    ///
    /// # Errors
    /// [`Cancelled`] within 100 ms of the request.
    pub fn compare(
        &self,
        (id, test): (&str, TestKind),
        answers: Answers<'_>,
        rays: &[Ray],
        secs: f64,
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<SceneRow, Cancelled> {
        let (begin, next, traced) = (Instant::now(), AtomicUsize::new(0), AtomicUsize::new(0));
        // Every so many-th ray is a part, so that whatever parts there is time for are spread over the picture. They are
        // taken one by one, since those of a list that is dealt out beforehand would not be the first ones.
        let parts = rays.len().div_ceil(CHUNK);
        let work = |_| {
            let mut differing = Vec::new();
            loop {
                let part = next.fetch_add(1, Ordering::Relaxed);
                if part >= parts || (part > 0 && begin.elapsed().as_secs_f64() > secs) {
                    return Ok(differing);
                }
                let which: Vec<usize> = (part..rays.len()).step_by(parts).collect();
                differing.extend(self.part(test, answers, rays, &which, cancel)?);
                traced.fetch_add(which.len(), Ordering::Relaxed);
                // Others wait for the same threads.
                rayon::yield_now();
            }
        };
        let found: Result<Vec<Vec<DifferingRay>>, _> = pool.run(|| (0..pool.threads()).into_par_iter().map(work).collect());
        let mut differing = found?.concat();
        differing.sort_by_key(|ray| (ray.why.is_none(), ray.ray));
        let wrong = differing.iter().filter(|ray| ray.why.is_some()).count();
        let rounded = differing.len() - wrong;
        differing.truncate(KEPT);
        Ok(SceneRow { id: id.to_owned(), test, rays: traced.into_inner(), rounded, wrong, differing })
    }

    fn part(
        &self,
        test: TestKind,
        answers: Answers<'_>,
        rays: &[Ray],
        which: &[usize],
        cancel: &Cancel,
    ) -> Result<Vec<DifferingRay>, Cancelled> {
        let rays: Vec<Ray> = which.iter().map(|i| rays[*i]).collect();
        let (mut hits, mut exact) = (vec![None; rays.len()], vec![None; rays.len()]);
        answers(&rays, &mut hits)?;
        self.accel.trace(&rays, Mode::Closest, &mut exact, cancel)?;
        let geometry = self.accel.geometry();
        let mut differing = Vec::new();
        for (i, ray) in rays.iter().enumerate() {
            let (hit, exact): (Option<Hit>, Option<Hit>) = (hits[i], exact[i]);
            let same = match (&hit, &exact) {
                (None, None) => true,
                (Some(a), Some(b)) => (a.instance, a.primitive) == (b.instance, b.primitive) && a.t == b.t,
                _ => false,
            };
            if same || !ray.is_valid() {
                continue;
            }
            let entered = geometry.space().enter(ray);
            if explained(test, geometry, &entered, hit.as_ref(), exact.as_ref()) {
                continue;
            }
            cancel.check()?;
            let why = self.expected(test, &entered.ray).judge(geometry, &entered.back, hit.as_ref()).err();
            differing.push(DifferingRay { ray: which[i], why, t: exact.map_or(f32::INFINITY, |hit| hit.t) });
        }
        Ok(differing)
    }

    /// What may be reported of a ray of the scaled space.
    fn expected(&self, test: TestKind, ray: &Ray) -> Expected {
        let geometry = self.accel.geometry();
        let slabs = Slabs::new(ray, geometry.bounds());
        let mut prims: Vec<PrimRef> = Vec::new();
        walk(self.accel.as_ref(), &mut |cell| {
            let (entry, exit) = slabs.interval(cell.shape.bounds());
            if entry > exit {
                return ControlFlow::Continue(Descend::No);
            }
            if cell.is_leaf() {
                self.accel.prims(cell, &mut |prim| prims.push(prim));
            }
            ControlFlow::Continue(Descend::Yes)
        });
        expected(test, geometry, self.closed, ray, &passings_of(geometry, ray, prims.into_iter()))
    }
}

/// Whether it is the same triangle, at a t that is off by no more than the test's bound: nothing to speak of.
fn explained(test: TestKind, geometry: &Geometry, entered: &Entered, hit: Option<&Hit>, exact: Option<&Hit>) -> bool {
    let (Some(hit), Some(exact)) = (hit, exact) else { return false };
    if (hit.instance, hit.primitive) != (exact.instance, exact.primitive) {
        return false;
    }
    let tri = geometry.corners_of(hit.instance, hit.primitive);
    let bound = bounds(test, &entered.ray, &tri).t;
    let [t, exactly] = [hit, exact].map(|hit| f64::from(entered.back.scaled_t(hit.t)));
    if test == TestKind::Exact && entered.back.rounding(exact.t) == 0.0 {
        return false;
    }
    // The exact one is rounded as well.
    (t - exactly).abs() <= bound + 2.0 * entered.back.rounding(exact.t) + exactly.abs() * f64::from(f32::EPSILON)
}

#[cfg(test)]
mod tests {
    use super::super::cases;
    use super::*;
    use crate::scene::LoadCx;

    fn row(case: &str, test: TestKind, closed: bool) -> SceneRow {
        let trial = cases::find(case).expect("a case").trial(7, 3000);
        let geometry = Arc::new(Geometry::new(&trial.scene(case), &LoadCx::unattended()).expect("small"));
        let cx = BuildCx::unattended(2);
        let entry = registry::find("kdtree").expect("registered");
        let accel = entry.build(&geometry, test, &entry.defaults(), &cx).expect("builds");
        let reference = Reference::build(&geometry, closed, &cx).expect("builds");
        let answers = answers_of(accel.as_ref(), &cx.cancel);
        reference.compare(("kdtree", test), &answers, &trial.rays, f64::INFINITY, &cx.pool, &cx.cancel).expect("not cancelled")
    }

    #[test]
    fn exact_is_exact_and_watertight_is_right() {
        let exact = row("shared-edges", TestKind::Exact, true);
        assert_eq!((exact.rounded, exact.wrong, exact.differing.len()), (0, 0, 0));
        let watertight = row("shared-edges", TestKind::Watertight, true);
        assert!(watertight.wrong == 0 && watertight.rounded > 100, "{watertight:?}");
    }

    #[test]
    fn fast_slips_through_what_is_closed() {
        let open = row("shared-edges", TestKind::Fast, false);
        assert_eq!(open.wrong, 0, "of an open surface rounding explains a miss");
        let closed = row("shared-edges", TestKind::Fast, true);
        assert!(closed.wrong > 0 && closed.differing[0].why == Some(Wrong::Slipped), "{} wrong", closed.wrong);
    }
}
