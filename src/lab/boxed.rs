//! A plain binary tree in which the test of boxes is to choose: what each test loses of a scene's hits, and what a ray takes
//! with it. The structures have the one that loses nothing; this is where the others can be seen beside it.

use std::ops::ControlFlow;
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::measure::MeasureOptions;
use super::stability::{Asker, BoxTest};
use super::statistics::median;
use super::turns::{self, Racer};
use crate::accel::cell::{Descend, walk};
use crate::accel::{Accel, BuildError, Fits, Hit};
use crate::geometry::tri::{TriTest, Watertight};
use crate::geometry::{Aabb, Ray, num};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Budget, Cancel, Cancelled, Charge, Pool, Progress};

/// Its nodes, parents before children, a first child next to its parent.
pub struct Boxed {
    geometry: Arc<Geometry>,
    nodes: Vec<Node>,
    prims: Vec<PrimRef>,
    _charge: Charge,
}

#[derive(Clone, Copy)]
struct Node {
    bounds: Aabb,
    /// Of a leaf its first triangle; else the node behind all that is below it.
    at: u32,
    /// Triangles of a leaf; nothing for inner nodes.
    count: u32,
}

/// Rays traced between two looks at whether to stop.
const CHUNK: usize = 256;
/// Cells walked between two such looks.
const PER_CHECK: usize = 1 << 12;

impl Boxed {
    /// The tree of a structure of boxes within boxes, two a node.
    ///
    /// # Errors
    /// [`BuildError::Cancelled`], or it does not fit into the budget.
    pub fn of(accel: &dyn Accel, budget: &Budget, cancel: &Cancel) -> Result<Self, BuildError> {
        let (mut nodes, mut prims, mut depths) = (Vec::new(), Vec::new(), Vec::new());
        walk(accel, &mut |cell| {
            if nodes.len().is_multiple_of(PER_CHECK) && cancel.is_cancelled() {
                return ControlFlow::Break(());
            }
            let first = num::index(prims.len());
            if cell.is_leaf() {
                accel.prims(cell, &mut |prim| prims.push(prim));
            }
            nodes.push(Node { bounds: *cell.shape.bounds(), at: first, count: num::index(prims.len()) - first });
            depths.push(cell.depth);
            ControlFlow::Continue(Descend::Yes)
        });
        cancel.check()?;
        // The node behind all below one is the next that lies no deeper.
        let mut behind = vec![num::index(nodes.len()); nodes.len()];
        let mut open: Vec<usize> = Vec::new();
        for i in 0..nodes.len() {
            while let Some(above) = open.pop_if(|above| depths[*above] >= depths[i]) {
                behind[above] = num::index(i);
            }
            open.push(i);
        }
        for (node, behind) in nodes.iter_mut().zip(behind).filter(|(node, _)| node.count == 0) {
            node.at = behind;
        }
        let bytes = (size_of_val(&nodes[..]) + size_of_val(&prims[..])) as u64;
        let charge = budget.charge(bytes).map_err(|over| BuildError::Memory {
            structure: "boxes",
            over,
            remedy: "Raise the memory budget.",
            fits: Fits::default(),
        })?;
        Ok(Self { geometry: Arc::clone(accel.geometry()), nodes, prims, _charge: charge })
    }

    /// The closest hits of world rays, the nearer of two children first.
    ///
    /// # Errors
    /// [`Cancelled`], within 100 ms of the request.
    pub fn trace(&self, test: BoxTest, rays: &[Ray], hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<(), Cancelled> {
        match test {
            BoxTest::Plain => self.trace_with::<0>(rays, hits, cancel),
            BoxTest::Ize => self.trace_with::<1>(rays, hits, cancel),
            BoxTest::Pbrt => self.trace_with::<2>(rays, hits, cancel),
            BoxTest::TwoOrigins => self.trace_with::<3>(rays, hits, cancel),
        }
    }

    /// With the test that has this number among all.
    fn trace_with<const TEST: usize>(&self, rays: &[Ray], hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<(), Cancelled> {
        let mut stack = Vec::new();
        for (rays, hits) in rays.chunks(CHUNK).zip(hits.chunks_mut(CHUNK)) {
            cancel.check()?;
            for (ray, hit) in rays.iter().zip(hits) {
                *hit = self.closest::<TEST>(ray, &mut stack);
            }
        }
        Ok(())
    }

    fn closest<const TEST: usize>(&self, ray: &Ray, stack: &mut Vec<(u32, f32)>) -> Option<Hit> {
        let test = BoxTest::ALL[TEST];
        if !ray.is_valid() || self.nodes.is_empty() {
            return None;
        }
        let entered = self.geometry.space().enter(ray);
        let ray = &entered.ray;
        if ray.tmin > ray.tmax {
            return None;
        }
        let asker = Asker::new(ray, self.geometry.bounds());
        let triangles = Watertight::prepare(ray, self.geometry.bounds());
        let mut best: Option<Hit> = None;
        let (mut t, mut prim_of_best) = (ray.tmax, PrimRef::MAX);
        stack.clear();
        stack.extend(asker.entry(test, &self.nodes[0].bounds, t).map(|entry| (0, entry)));
        while let Some((at, entry)) = stack.pop() {
            if entry > t {
                continue;
            }
            let node = &self.nodes[at as usize];
            if node.count > 0 {
                for &prim in &self.prims[node.at as usize..][..node.count as usize] {
                    let Some(hit) = triangles.hit(&self.geometry.corners(prim), ray.tmin, t) else { continue };
                    // Of hits at the same t the first triangle counts, as everywhere.
                    if hit.t < t || prim < prim_of_best {
                        let (instance, primitive) = self.geometry.locate(prim);
                        (t, prim_of_best) = (hit.t, prim);
                        best = Some(Hit { t: entered.back.world_t(hit.t), u: hit.u, v: hit.v, instance, primitive });
                    }
                }
                continue;
            }
            let mut far = None;
            let mut child = at + 1;
            while child < node.at {
                let below = &self.nodes[child as usize];
                if let Some(entry) = asker.entry(test, &below.bounds, t) {
                    match far.replace((child, entry)) {
                        Some(other) if other.1 <= entry => {
                            stack.push((child, entry));
                            far = Some(other);
                        }
                        Some(other) => stack.push(other),
                        None => {}
                    }
                }
                child = if below.count > 0 { child + 1 } else { below.at };
            }
            // What is left is the nearest.
            stack.extend(far);
        }
        best
    }

    /// Seconds of a pass over the rays with each test, the median of rounds in turns.
    ///
    /// # Errors
    /// [`Cancelled`].
    pub fn times(&self, rays: &[Ray], options: &MeasureOptions, pool: &Pool, cancel: &Cancel) -> Result<[f64; 4], Cancelled> {
        let mut lanes = BoxTest::ALL.map(|test| Lane { tree: self, test, rays, secs: Vec::new() });
        for lane in &mut lanes {
            lane.round(pool, cancel)?;
            lane.secs.clear(); // the first one warms up
        }
        let mut racers: Vec<&mut dyn Racer> = lanes.iter_mut().map(|lane| lane as &mut dyn Racer).collect();
        turns::take(&mut racers, options, pool, cancel, &Progress::new())?;
        Ok(lanes.map(|lane| median(&lane.secs)))
    }
}

/// One test that takes its turns.
struct Lane<'a> {
    tree: &'a Boxed,
    test: BoxTest,
    rays: &'a [Ray],
    secs: Vec<f64>,
}

impl Racer for Lane<'_> {
    fn round(&mut self, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        let trace = |rays: &[Ray]| self.tree.trace(self.test, rays, &mut [None; CHUNK][..rays.len()], cancel);
        pool.run(|| self.rays.par_chunks(CHUNK).try_for_each(trace))?;
        self.secs.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share_done(&self, options: &MeasureOptions) -> u64 {
        if self.rays.is_empty() { turns::DONE } else { turns::share(&self.secs, options) }
    }
}

#[cfg(test)]
mod tests {
    use super::super::stability::cases;
    use super::*;
    use crate::accel::{BuildCx, Mode, registry};
    use crate::geometry::tri::TestKind;
    use crate::scene::LoadCx;

    /// The rays of a case with a structure of boxes.
    fn case(id: &str, cx: &BuildCx) -> (Vec<Ray>, Box<dyn Accel>) {
        let trial = cases::find(id).expect("a case").trial(7, 3000);
        let geometry = Arc::new(Geometry::new(&trial.scene(id), &LoadCx::unattended()).expect("small"));
        let entry = registry::find("bvh").expect("registered");
        (trial.rays, entry.build(&geometry, TestKind::Watertight, &entry.defaults(), cx).expect("builds"))
    }

    /// Rays that each test of boxes answers otherwise than the structure itself.
    fn differing(id: &str) -> [usize; 4] {
        let cx = BuildCx::unattended(2);
        let (rays, accel) = case(id, &cx);
        let tree = Boxed::of(accel.as_ref(), &cx.budget, &cx.cancel).expect("small");
        let mut theirs = vec![None; rays.len()];
        accel.trace(&rays, Mode::Closest, &mut theirs, &cx.cancel).expect("not cancelled");
        assert!(theirs.iter().flatten().count() > 100, "{id} has hits");
        BoxTest::ALL.map(|test| {
            let mut hits = vec![None; rays.len()];
            tree.trace(test, &rays, &mut hits, &cx.cancel).expect("not cancelled");
            hits.iter().zip(&theirs).filter(|(a, b)| a != b).count()
        })
    }

    #[test]
    fn two_origins_lose_nothing_and_plain_slabs_do() {
        let mut lost = [0; 4];
        for id in ["shared-edges", "slivers", "layers", "far-1e5", "stadium-1e5"] {
            let of_case = differing(id);
            lost = std::array::from_fn(|i| lost[i] + of_case[i]);
        }
        assert!(lost[0] > 0 && lost[1] < lost[0] && lost[2] < lost[0], "{lost:?}");
        assert_eq!(lost[3], 0, "{lost:?}");
    }

    #[test]
    fn rounds_are_timed_of_each_test_and_can_be_stopped() {
        let cx = BuildCx::unattended(2);
        let (rays, accel) = case("shared-edges", &cx);
        let tree = Boxed::of(accel.as_ref(), &cx.budget, &cx.cancel).expect("small");
        let options = MeasureOptions { min_rounds: 2, min_secs: 0.0, ..MeasureOptions::default() };
        let secs = tree.times(&rays, &options, &cx.pool, &cx.cancel).expect("not cancelled");
        assert!(secs.iter().all(|secs| *secs > 0.0), "{secs:?}");
        cx.cancel.cancel();
        assert!(tree.times(&rays, &options, &cx.pool, &cx.cancel).is_err());
        assert!(Boxed::of(accel.as_ref(), &cx.budget, &cx.cancel).is_err());
    }
}
