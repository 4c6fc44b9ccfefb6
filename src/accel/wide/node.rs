//! A node of eight boxes, and how a ray meets them all at once.
//!
//! The operations are those of [`crate::geometry::Slabs::interval`], so a box around another never has
//! the smaller interval.

use super::child::Child;
use super::unit::{self, Unit};
use crate::geometry::eight::Points;
use crate::geometry::slabs::Boxes;
use crate::geometry::{Aabb, EightSlabs, Slabs};
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// Eight boxes and what is in them. 224 bytes: as many cache lines as 256.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Node {
    /// `planes[axis][side][slot]`: the least and the greatest of each box. A slot that is not used holds
    /// NaN: no ray meets it.
    planes: [[Lanes; 2]; 3],
    children: [Child; LANES],
}

/// Which boxes a ray meets, and where it enters them.
pub struct Met<F> {
    /// One bit for each slot.
    pub slots: u32,
    /// The t of entry, not before the ray's start.
    pub entry: F,
}

impl Node {
    /// Units that it takes.
    pub const UNITS: usize = size_of::<Self>() / unit::BYTES;

    /// The node at a place.
    #[inline(always)]
    pub fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { Self::UNITS }>(units, place as usize)
    }

    /// The same, to be changed.
    pub fn at_mut(units: &mut [Unit], place: u32) -> &mut Self {
        unit::at_mut::<Self, { Self::UNITS }>(units, place as usize)
    }

    pub fn new(children: &[(Child, Aabb); LANES]) -> Self {
        let plane = |side: usize, axis: usize| {
            children.each_ref().map(|(child, b)| if child.is_none() { f32::NAN } else { [b.min, b.max][side][axis] })
        };
        let planes = [0, 1, 2].map(|axis| [0, 1].map(|side| plane(side, axis)));
        Self { planes, children: children.map(|(child, _)| child) }
    }

    /// A slot's box.
    pub fn bounds(&self, slot: usize) -> Aabb {
        let [x, y, z] = &self.planes;
        let corner = |side: usize| Vec3::new(x[side][slot], y[side][slot], z[side][slot]);
        Aabb { min: corner(0), max: corner(1) }
    }

    /// What is in the slots.
    #[inline(always)]
    pub const fn children(&self) -> &[Child; LANES] {
        &self.children
    }

    /// Sets what a slot refers to.
    pub const fn refer(&mut self, slot: usize, child: Child) {
        self.children[slot] = child;
    }

    /// Boxes entered in `[tmin, tmax]`.
    #[inline(always)]
    pub fn meet<S: Simd>(&self, s: S, slabs: &Slabs, tmin: f32, tmax: f32) -> Met<S::F> {
        let (entry, exit) = EightSlabs::splat(s, slabs).intervals(s, &Boxes { min: self.corner(s, 0), max: self.corner(s, 1) });
        let (entry, exit) = (s.max(s.splat(tmin), entry), s.min(exit, s.splat(tmax)));
        Met { slots: s.bits(s.le(entry, exit)), entry }
    }

    /// The nearer, or else the farther planes of all axes, for rays that meet these sides of an axis first.
    #[inline(always)]
    pub fn planes<S: Simd>(&self, s: S, sides: [usize; 3]) -> Points<S::F> {
        let ([x, y, z], [i, j, k]) = (&self.planes, sides);
        Points { x: s.load(&x[i & 1]), y: s.load(&y[j & 1]), z: s.load(&z[k & 1]) }
    }

    #[inline(always)]
    fn corner<S: Simd>(&self, s: S, side: usize) -> Points<S::F> {
        let [x, y, z] = &self.planes;
        Points { x: s.load(&x[side]), y: s.load(&y[side]), z: s.load(&z[side]) }
    }
}

const _: () = assert!(size_of::<Node>() == 224);
