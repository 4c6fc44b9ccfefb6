//! What a ray has met and not visited yet: a stack of children, and where the ray enters them.
//!
//! ```text
//! [ NONE, far … near ]   the last is visited next; NONE lies below them all, so that there always is
//!                        one to look at
//! ```
//! What begins behind a new hit is taken out when the hit is found, so whatever is last is always worth a
//! visit.

use super::child::Child;
use super::node::Met;
use super::slots::bits;
use crate::accel::bvh::MAX_DEPTH;
use crate::accel::probe::{Probe, Prune};
use crate::simd::{LANES, LEFT, Simd, UNDER_XOR};

/// A power of two, so that an index into it is cut short by a mask.
const ROOM: usize = 512;
/// Every level leaves seven siblings behind.
const _: () = assert!((LANES - 1) * (MAX_DEPTH as usize) + LANES < ROOM);

/// The stack. Which one is the last is kept by whoever walks.
#[derive(Clone, Debug)]
pub struct Open {
    /// Eight are written at a time.
    children: [Child; ROOM + LANES],
    entries: [f32; ROOM + LANES],
}

impl Open {
    /// Nothing.
    pub const fn new() -> Self {
        Self { children: [Child::NONE; ROOM + LANES], entries: [f32::NEG_INFINITY; ROOM + LANES] }
    }

    /// A ray begins at the root: which is the last.
    #[inline(always)]
    pub const fn begin(&mut self, root: Child, tmin: f32) -> u32 {
        (self.children[1], self.entries[1]) = (root, tmin);
        1
    }

    /// The last where nothing is open.
    pub const EMPTY: u32 = 0;

    /// The last, and which is the last without it. Nothing comes after [`Child::NONE`].
    #[inline(always)]
    pub const fn pop(&self, last: u32) -> (Child, u32) {
        (self.next(last), last.wrapping_sub(1))
    }

    /// What is visited next.
    #[inline(always)]
    pub const fn next(&self, last: u32) -> Child {
        self.children[last as usize % ROOM]
    }

    /// In place of the last, a node, those of its children that were met, the nearest last: which is the last then.
    /// Slots are taken in the order of `slot ^ order`, the last first: see [`super::slots`].
    #[inline(always)]
    pub fn replace<S: Simd>(&mut self, s: S, last: u32, children: &[Child; LANES], met: &Met<S::F>, order: u32) -> u32 {
        self.put(s, last, children, &met.entry, in_order(met.slots, order), order).wrapping_sub(1)
    }

    /// Puts all children of a node that were met, one at least, but the nearest, after the last: the nearest, and which
    /// is the last then.
    #[inline(always)]
    pub fn keep_others<S: Simd>(
        &mut self,
        s: S,
        last: u32,
        children: &[Child; LANES],
        met: &Met<S::F>,
        order: u32,
    ) -> (Child, u32) {
        let all = in_order(met.slots, order);
        let nearest = 31 - u32::from(all).leading_zeros();
        let child = children[((nearest ^ order) & 7) as usize];
        let others = all & !(1u32 << nearest) as u8;
        (child, self.put(s, last + 1, children, &met.entry, others, order).wrapping_sub(1))
    }

    /// Writes children from a place on: the first place that is free then.
    #[inline(always)]
    fn put<S: Simd>(&mut self, s: S, at: u32, children: &[Child; LANES], entry: &S::F, in_order: u8, order: u32) -> u32 {
        let from = s.flip(s.indices(&LEFT[usize::from(in_order)]), order);
        let children = s.permute(s.load_bits(bytemuck::cast_ref(children)), from);
        let entries = s.permute(*entry, from);
        s.store_bits(children, bytemuck::cast_mut(eight(&mut self.children, at as usize)));
        s.store(entries, eight(&mut self.entries, at as usize));
        at.wrapping_add(in_order.count_ones())
    }

    /// Takes the first block, of so many units, off the last, which is this leaf; which is the last then.
    #[inline(always)]
    pub const fn shorten(&mut self, last: u32, leaf: Child, units: u32) -> u32 {
        let (rest, left) = leaf.shortened(units);
        self.children[last as usize % ROOM] = rest;
        last - !left as u32
    }

    /// Takes out what begins behind t; which is the last then.
    #[inline(always)]
    pub fn forget_behind<S: Simd, P: Probe>(&mut self, s: S, last: u32, t: f32, probe: &mut P) -> u32 {
        let (end, t) = (last as usize + 1, s.splat(t));
        let (mut from, mut kept) = (0, 0);
        while from < end {
            let entries = s.load(eight(&mut self.entries, from));
            let children = s.load_bits(bytemuck::cast_ref(eight(&mut self.children, from)));
            let there = (1u32 << (end - from).min(LANES)) - 1;
            let stay = s.bits(s.le(entries, t)) & there;
            if P::LISTENS {
                for i in bits(there & !stay) {
                    probe.pruned(self.children[from + i].place(), Prune::BehindHit);
                }
            }
            let order = s.indices(&LEFT[(stay & 0xff) as usize]);
            s.store(s.permute(entries, order), eight(&mut self.entries, kept));
            s.store_bits(s.permute(children, order), bytemuck::cast_mut(eight(&mut self.children, kept)));
            kept += stay.count_ones() as usize;
            from += LANES;
        }
        // What lies below them all always stays.
        kept as u32 - 1
    }
}

/// Slots as bits, each at the place where it comes in the order of a ray.
#[inline(always)]
fn in_order(slots: u32, order: u32) -> u8 {
    UNDER_XOR[(order & 7) as usize][(slots & 0xff) as usize]
}

/// Eight of a list from some place on.
#[inline(always)]
fn eight<V>(list: &mut [V; ROOM + LANES], at: usize) -> &mut [V; LANES] {
    list[at % ROOM..].first_chunk_mut().unwrap_or_else(|| unreachable!())
}
