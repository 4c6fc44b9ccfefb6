//! Gives each side of a plane its triangles. One that the plane cuts goes to both, each time with
//! the box of the part that lies there: perfect splits (Havran and Bittner 2002; Wald and Havran
//! 2006, §4.1). A triangle whose part turns out empty is dropped.

use super::costs::Plane;
use super::events::{self, Event, Lists};
use crate::geometry::{Aabb, Clipped, num};
use crate::scene::{Geometry, PrimRef};

/// A triangle in a cell: the box around the part of it that lies there.
#[derive(Clone, Copy, Debug)]
pub struct KdRef {
    /// Within the cell.
    pub bounds: Aabb,
    /// The triangle.
    pub prim: PrimRef,
}

/// What a side gets.
#[derive(Debug, Default)]
pub struct Side {
    /// In the order they had.
    pub refs: Vec<KdRef>,
    /// The events of those that the plane cut, not sorted; empty where events are not kept.
    pub fresh: Lists,
}

/// Where a reference went: its index on the side whose bit is set. No bit: cut or dropped, so that
/// its old events are gone.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moved(u32);

/// The bit of the side below.
pub const LOW: u32 = 1 << 30;
/// The bit of the side above.
pub const HIGH: u32 = 1 << 31;

impl Moved {
    /// Whether it went to that side whole.
    #[inline(always)]
    pub const fn is_in(self, side: u32) -> bool {
        self.0 & side != 0
    }

    /// Its index there.
    #[inline(always)]
    pub const fn index(self) -> u32 {
        self.0 & !(LOW | HIGH)
    }

    /// The same with those of other chunks before it.
    pub const fn after(self, low: u32, high: u32) -> Self {
        Self(self.0 + if self.is_in(LOW) { low } else { 0 } + if self.is_in(HIGH) { high } else { 0 })
    }
}

/// The references of a cell, dealt out.
#[derive(Debug, Default)]
pub struct Dealt {
    /// The side below.
    pub low: Side,
    /// The side above.
    pub high: Side,
    /// For each reference of the cell.
    pub moved: Vec<Moved>,
}

/// How to deal.
#[derive(Clone, Copy, Debug)]
pub struct Dealer<'a> {
    /// Where the corners are.
    pub geometry: &'a Geometry,
    /// The cell that is divided.
    pub cell: Aabb,
    /// Where.
    pub plane: Plane,
    /// Whether events are kept.
    pub events: bool,
}

impl Dealt {
    /// Deals out some references, after what was there is cleared.
    pub fn deal(&mut self, refs: &[KdRef], dealer: &Dealer) {
        self.clear();
        let (k, pos) = (dealer.plane.axis.index(), dealer.plane.pos);
        for r in refs {
            let (min, max) = (r.bounds.min[k], r.bounds.max[k]);
            let moved = if min < pos && pos < max {
                self.cut(r, dealer);
                0
            } else if max < pos || (max == pos && (min < pos || dealer.plane.planar_below)) {
                self.low.refs.push(*r);
                LOW | num::index(self.low.refs.len() - 1)
            } else {
                self.high.refs.push(*r);
                HIGH | num::index(self.high.refs.len() - 1)
            };
            self.moved.push(Moved(moved));
        }
    }

    fn clear(&mut self) {
        self.moved.clear();
        for side in [&mut self.low, &mut self.high] {
            side.refs.clear();
            side.fresh.iter_mut().for_each(Vec::clear);
        }
    }

    /// Both boxes are bounded by the box so far, which is what clipping at the planes above it left.
    fn cut(&mut self, r: &KdRef, dealer: &Dealer) {
        let Plane { axis, pos, .. } = dealer.plane;
        let part = Clipped::new(&dealer.geometry.corners(r.prim), &dealer.cell);
        let (low, high) = part.halves(axis, pos);
        let (low, high) = (low.intersection(r.bounds), high.intersection(r.bounds));
        if low.is_empty() && high.is_empty() {
            // Not by the bounds of the errors; were they wrong, no triangle would be lost.
            let (below, above) = r.bounds.split(axis, pos);
            self.low.add(below, r.prim, dealer.events);
            self.high.add(above, r.prim, dealer.events);
            return;
        }
        if !low.is_empty() {
            self.low.add(low, r.prim, dealer.events);
        }
        if !high.is_empty() {
            self.high.add(high, r.prim, dealer.events);
        }
    }

    /// Appends what another chunk of the same cell was dealt.
    pub fn append(&mut self, other: Self) {
        let (low, high) = (num::index(self.low.refs.len()), num::index(self.high.refs.len()));
        self.moved.extend(other.moved.iter().map(|moved| moved.after(low, high)));
        self.low.append(other.low);
        self.high.append(other.high);
    }
}

impl Side {
    fn add(&mut self, bounds: Aabb, prim: PrimRef, events: bool) {
        if events {
            events::append(&mut self.fresh, &bounds, num::index(self.refs.len()));
        }
        self.refs.push(KdRef { bounds, prim });
    }

    fn append(&mut self, other: Self) {
        let by = num::index(self.refs.len());
        for (all, more) in self.fresh.iter_mut().zip(&other.fresh) {
            all.extend(more.iter().map(|event| event.renamed(num::index(event.index()) + by)));
        }
        self.refs.extend(other.refs);
    }
}

/// Copies the events of the references that went whole to a side, renamed; returns how many.
/// `out` is at least as long as `events`.
pub fn keep(events: &[Event], moved: &[Moved], side: u32, out: &mut [Event]) -> usize {
    let mut n = 0;
    for event in events {
        let to = moved[event.index()];
        // Written always and counted only if kept: no branch that cannot be foreseen.
        out[n] = event.renamed(to.index());
        n += usize::from(to.is_in(side));
    }
    n
}

/// Merges `fresh` into the first `n` of `out`, from the back, and empties it; returns how many
/// there are then. `out` has room.
pub fn merge(out: &mut [Event], n: usize, fresh: &mut Vec<Event>) -> usize {
    fresh.sort_unstable();
    let total = n + fresh.len();
    let (mut old, mut to) = (n, total);
    while let Some(last) = fresh.pop() {
        while old > 0 && out[old - 1] > last {
            old -= 1;
            to -= 1;
            out[to] = out[old];
        }
        to -= 1;
        out[to] = last;
    }
    total
}
