//! One ray on its way through the tree: what is left to visit, and a step.
//!
//! ```text
//! open   [ far … near ]   children that were met and not visited yet: the last is next
//!         child, entry    what begins behind a new hit is taken out when the hit is found,
//!                         so whatever is on top is always worth a visit
//! ```

use super::child::Child;
use super::leaf::Pack;
use super::node::{Node, RayIn};
use super::unit::Unit;
use crate::accel::best::Best;
use crate::accel::bvh::MAX_DEPTH;
use crate::accel::probe::{Probe, Prune};
use crate::accel::{PrimHit, Query};
use crate::geometry::Ray;
use crate::geometry::tri::TriTest;
use crate::scene::Geometry;
use crate::simd::{LANES, LEFT, Simd, UNDER_XOR};
use glam::Vec3;

/// Every level leaves seven siblings behind, and eight are written at a time.
const OPEN: usize = (LANES - 1) * MAX_DEPTH as usize + 2 * LANES;

/// What a ray has met and not visited yet.
#[derive(Clone, Debug)]
pub struct Open {
    children: [Child; OPEN],
    entries: [f32; OPEN],
}

impl Open {
    /// Nothing.
    pub const fn new() -> Self {
        Self { children: [Child::NONE; OPEN], entries: [0.0; OPEN] }
    }
}

/// A ray on its way.
#[derive(Debug)]
pub struct Walk<'a, T> {
    test: T,
    ray: RayIn,
    best: Best,
    top: usize,
    /// Lanes of a block that the ray may meet, to be settled at the next step: by then it is known
    /// whether there are any, and no branch has to wait for it.
    met: u32,
    met_block: u32,
    open: &'a mut Open,
}

impl<'a, T: TriTest> Walk<'a, T> {
    /// A ray of the scaled space that begins at the root.
    #[inline(always)]
    pub fn new(ray: &Ray, geometry: &Geometry, root: Child, open: &'a mut Open) -> Self {
        let test = T::prepare(ray, geometry.bounds());
        let (sides, best) = (RayIn::new(test.slabs().sides()), Best::new(ray.tmin, ray.tmax));
        (open.children[0], open.entries[0]) = (root, ray.tmin);
        Self { test, ray: sides, best, top: 1, met: 0, met_block: 0, open }
    }

    /// No ray yet.
    #[inline(always)]
    pub fn idle(geometry: &Geometry, open: &'a mut Open) -> Self {
        let nowhere = Ray::new(Vec3::ZERO, Vec3::X);
        Self { top: 0, ..Self::new(&nowhere, geometry, Child::NONE, open) }
    }

    /// The next ray of the scaled space takes the place of one that is done.
    #[inline(always)]
    pub fn begin(&mut self, ray: &Ray, geometry: &Geometry, root: Child) {
        let test = T::prepare(ray, geometry.bounds());
        self.ray = RayIn::new(test.slabs().sides());
        self.test = test;
        self.best = Best::new(ray.tmin, ray.tmax);
        (self.top, self.met) = (1, 0);
        (self.open.children[0], self.open.entries[0]) = (root, ray.tmin);
    }

    /// What is visited next, if anything is left.
    #[inline(always)]
    pub fn next(&self) -> Child {
        self.open.children[self.top.saturating_sub(1)]
    }

    /// One step: settles what the last one met, then visits what is next. False once all is done.
    #[inline(always)]
    pub fn step<S: Simd, B: Pack, Q: Query, P: Probe>(&mut self, s: S, units: &[Unit], query: &Q, probe: &mut P) -> bool {
        if self.met != 0 && self.settle::<S, B, Q, P>(s, units, query, probe) {
            return false;
        }
        if self.top == 0 {
            return false;
        }
        let child = self.next();
        probe.node();
        probe.at(child.place());
        if child.is_node() {
            self.enter(s, Node::at(units, child.place()), probe);
        } else if P::WATCHES {
            // Whoever watches sees the leaf as a whole.
            probe.leaf();
            self.top -= 1;
            for block in 0..child.blocks() {
                self.look::<S, B, P>(s, units, child.place() + block * B::UNITS, probe);
                if self.settle::<S, B, Q, P>(s, units, query, probe) {
                    return false;
                }
            }
        } else {
            match child.rest(B::UNITS) {
                Some(rest) => self.open.children[self.top - 1] = rest,
                None => self.top -= 1,
            }
            self.look::<S, B, P>(s, units, child.place(), probe);
        }
        true
    }

    /// What was found.
    #[inline(always)]
    pub fn found(&self) -> Option<PrimHit> {
        self.best.found()
    }

    /// Visits a node: the ones that are met take its place, the nearest on top.
    #[inline(always)]
    fn enter<S: Simd, P: Probe>(&mut self, s: S, node: &Node, probe: &mut P) {
        let met = node.meet(s, &self.ray, self.best.tmin(), self.best.t());
        self.top -= 1;
        let order = self.ray.order;
        let in_order = UNDER_XOR[(order & 7) as usize][(met.slots & 0xff) as usize];
        let from = s.flip(s.indices(&LEFT[usize::from(in_order)]), order);
        let children = s.permute(s.load_bits(bytemuck::cast_ref(node.children())), from);
        let entries = s.permute(met.entry, from);
        s.store_bits(children, bytemuck::cast_mut(eight(&mut self.open.children, self.top)));
        s.store(entries, eight(&mut self.open.entries, self.top));
        self.top += met.slots.count_ones() as usize;
        if P::LISTENS {
            for (slot, child) in node.children().iter().enumerate() {
                if *child != Child::NONE && met.slots >> slot & 1 == 0 {
                    probe.pruned(child.place(), self.why_not(node, slot));
                }
            }
        }
    }

    fn why_not(&self, node: &Node, slot: usize) -> Prune {
        let (entry, exit) = self.test.slabs().interval(&node.bounds(slot));
        if entry > exit {
            Prune::Missed
        } else if entry > self.best.t() && self.best.found().is_some() {
            Prune::BehindHit
        } else {
            Prune::Outside
        }
    }

    /// Looks which triangles of a block may be met.
    #[inline(always)]
    fn look<S: Simd, B: Pack, P: Probe>(&mut self, s: S, units: &[Unit], at: u32, probe: &mut P) {
        let block = B::at(units, at);
        self.met = self.test.may_meet(s, block) & block.lanes();
        self.met_block = at;
        if P::WATCHES {
            // The others were tested, too, and missed.
            (self.met.count_ones()..block.lanes().count_ones()).for_each(|_| probe.prim());
        }
    }

    /// Tests what may be met one by one. True if the search is over.
    #[inline(always)]
    fn settle<S: Simd, B: Pack, Q: Query, P: Probe>(&mut self, s: S, units: &[Unit], query: &Q, probe: &mut P) -> bool {
        let block = B::at(units, self.met_block);
        let before = self.best.t();
        while self.met != 0 {
            let lane = self.met.trailing_zeros() as usize % LANES;
            self.met &= self.met - 1;
            if self.best.test(&self.test, &block.triangle(lane), block.prim(lane), query, probe) {
                // Nothing is left to do.
                (self.top, self.met) = (0, 0);
                return true;
            }
        }
        if self.best.t() < before {
            self.forget_behind(s, probe);
        }
        false
    }

    /// Takes out what begins behind the best hit.
    #[inline(always)]
    fn forget_behind<S: Simd, P: Probe>(&mut self, s: S, probe: &mut P) {
        let (end, t) = (self.top, s.splat(self.best.t()));
        let (mut from, mut kept) = (0, 0);
        while from < end {
            let entries = s.load(eight(&mut self.open.entries, from));
            let children = s.load_bits(bytemuck::cast_ref(eight(&mut self.open.children, from)));
            let there = (1u32 << (end - from).min(LANES)) - 1;
            let stay = s.bits(s.le(entries, t)) & there;
            if P::LISTENS {
                for i in super::slots::bits(there & !stay) {
                    probe.pruned(self.open.children[from + i].place(), Prune::BehindHit);
                }
            }
            let order = s.indices(&LEFT[(stay & 0xff) as usize]);
            s.store(s.permute(entries, order), eight(&mut self.open.entries, kept));
            s.store_bits(s.permute(children, order), bytemuck::cast_mut(eight(&mut self.open.children, kept)));
            kept += stay.count_ones() as usize;
            from += LANES;
        }
        self.top = kept;
    }
}

/// Eight entries of a list from some place on.
#[inline(always)]
fn eight<V>(list: &mut [V; OPEN], at: usize) -> &mut [V; LANES] {
    // There is room for eight above any place that is reached.
    let at = at.min(OPEN - LANES);
    list[at..].first_chunk_mut().unwrap_or_else(|| unreachable!())
}
