//! One ray on its way through the tree, alone.

use super::child::Child;
use super::leaf::Pack;
use super::node::Node;
use super::open::Open;
use super::slots::bits;
use super::unit::Unit;
use crate::accel::best::Best;
use crate::accel::probe::{Probe, Prune};
use crate::accel::{PrimHit, Query};
use crate::geometry::tri::{Hits, TriTest, splat_own};
use crate::geometry::{Aabb, EightSlabs, Ray, Slabs};
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// A tree to walk.
#[derive(Clone, Copy, Debug)]
pub struct Ground<'a> {
    pub units: &'a [Unit],
    pub root: Child,
    pub bounds: &'a Aabb,
    /// The points of the geometry.
    pub points: &'a [Vec3],
}

/// Walks a ray of the scaled space to its end.
#[inline(always)]
pub fn walk<S: Simd, T: TriTest, B: Pack, Q: Query, P: Probe>(
    s: S,
    ground: Ground<'_>,
    ray: &Ray,
    query: &Q,
    probe: &mut P,
    open: &mut Open,
) -> Option<PrimHit> {
    let Ground { units, root, bounds, points } = ground;
    let test = T::prepare(ray, bounds);
    let order = test.slabs().forward();
    let axes = test.axes();
    let in_order = EightSlabs::splat(s, &test.slabs().in_order(axes));
    let own = splat_own(s, &test.own());
    let mut best = Best::new(ray.tmin, ray.tmax);
    // Visited next; what is open comes after it.
    let mut child = root;
    let mut last = Open::EMPTY;
    let mut found = Found::NONE;
    loop {
        if child.is_node() {
            probe.node();
            probe.at(child.place());
            let node = B::Node::at(units, child.place());
            let met = node.meet(s, test.slabs(), best.tmin(), best.t());
            if P::LISTENS {
                for (slot, child) in node.children().iter().enumerate() {
                    if *child != Child::NONE && met.slots >> slot & 1 == 0 {
                        probe.pruned(child.place(), why_not(test.slabs(), &node.bounds(slot), &best));
                    }
                }
            }
            if met.slots == 0 {
                (child, last) = open.pop(last);
            } else {
                (child, last) = open.keep_others(s, last, node.children(), &met, order);
                // What lies below them all is not counted.
                probe.waiting(last as usize);
            }
            continue;
        }
        if child == Child::NONE {
            return best.found();
        }
        let before = best.t();
        if P::WATCHES {
            probe.node();
            probe.at(child.place());
            probe.leaf();
        }
        for block in 0..child.blocks() {
            let block = B::at(units, child.place() + block * B::UNITS);
            let over = if P::WATCHES {
                // Whoever watches sees every triangle.
                bits(block.lanes()).any(|lane| best.test(&test, &block.triangle(points, lane), block.prim(lane), query, probe))
            } else {
                let corners = block.corners(s, points, axes);
                let meets = T::meet_eight(s, &own, &in_order, &corners);
                meets.any(s) && {
                    let interval = [s.splat(best.tmin()), s.splat(best.t())];
                    found.keep(s, &T::inside(s, &meets, &in_order, interval, &corners), block.lanes());
                    found.settle(&test, (block, points), query, &mut best, probe)
                }
            };
            if over {
                return best.found();
            }
        }
        if best.t() < before {
            last = open.forget_behind(s, last, best.t(), probe);
        }
        (child, last) = open.pop(last);
    }
}

fn why_not(slabs: &Slabs, bounds: &Aabb, best: &Best) -> Prune {
    let (entry, exit) = slabs.interval(bounds);
    if entry > exit {
        Prune::Missed
    } else if entry > best.t() && best.found().is_some() {
        Prune::BehindHit
    } else {
        Prune::Outside
    }
}

/// Hits among the triangles of a block that are closer than the best one was.
#[derive(Clone, Copy, Debug)]
pub struct Found {
    hit: u32,
    doubt: u32,
    t: Lanes,
    u: Lanes,
    v: Lanes,
}

impl Found {
    /// None.
    pub const NONE: Self = Self { hit: 0, doubt: 0, t: [0.0; LANES], u: [0.0; LANES], v: [0.0; LANES] };

    /// Those of the lanes that hold a triangle.
    #[inline(always)]
    pub fn keep<S: Simd>(&mut self, s: S, hits: &Hits<S>, lanes: u32) {
        (self.hit, self.doubt) = (s.bits(hits.hit) & lanes, hits.doubt & lanes);
        s.store(hits.t, &mut self.t);
        s.store(hits.u, &mut self.u);
        s.store(hits.v, &mut self.v);
    }

    /// Whether there is anything.
    #[inline(always)]
    pub const fn any(&self) -> bool {
        self.hit | self.doubt != 0
    }

    /// Offers them all. True if the search is over.
    #[inline(always)]
    pub fn settle<T: TriTest, B: Pack, Q: Query, P: Probe>(
        &self,
        test: &T,
        (block, points): (&B, &[Vec3]),
        query: &Q,
        best: &mut Best,
        probe: &mut P,
    ) -> bool {
        let mut left = self.hit | self.doubt;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let over = if self.doubt >> lane & 1 == 1 {
                best.test_in_doubt(test, &block.triangle(points, lane), block.prim(lane), query, probe)
            } else {
                let hit = PrimHit { t: self.t[lane], u: self.u[lane], v: self.v[lane], prim: block.prim(lane) };
                best.offer(hit, query)
            };
            if over {
                return true;
            }
        }
        false
    }
}
