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
use bytemuck::Pod;
use glam::Vec3;

/// Eight boxes and what is in them.
pub trait Node: Pod + Send + Sync + std::fmt::Debug {
    /// The node at a place.
    fn at(units: &[Unit], place: u32) -> &Self;

    /// The same, to be changed.
    fn at_mut(units: &mut [Unit], place: u32) -> &mut Self;

    /// Of such children; the slots of [`Child::NONE`] are not used.
    fn new(children: &[(Child, Aabb); LANES]) -> Self;

    /// What is in the slots.
    fn children(&self) -> &[Child; LANES];

    /// Sets what a slot refers to.
    fn refer(&mut self, slot: usize, child: Child);

    /// A slot's box: what is in it, or more.
    fn bounds(&self, slot: usize) -> Aabb;

    /// The nearer, or else the farther planes of all axes, for rays that meet these sides of an axis first:
    /// 0 for the least, 1 for the greatest.
    fn planes<S: Simd>(&self, s: S, sides: [usize; 3]) -> Points<S::F>;

    /// Of these slots those that are used, if the planes of others do not see to it.
    fn used(&self, slots: u32) -> u32;

    /// Boxes entered in `[tmin, tmax]`.
    #[inline(always)]
    fn meet<S: Simd>(&self, s: S, slabs: &Slabs, tmin: f32, tmax: f32) -> Met<S::F> {
        let boxes = Boxes { min: self.planes(s, [0; 3]), max: self.planes(s, [1; 3]) };
        let (entry, exit) = EightSlabs::splat(s, slabs).intervals(s, &boxes);
        let (entry, exit) = (s.max(s.splat(tmin), entry), s.min(exit, s.splat(tmax)));
        Met { slots: self.used(s.bits(s.le(entry, exit))), entry }
    }
}

/// Which boxes a ray meets, and where it enters them.
pub struct Met<F> {
    /// One bit for each slot.
    pub slots: u32,
    /// The t of entry, not before the ray's start.
    pub entry: F,
}

/// Boxes as they are. 224 bytes: as many cache lines as 256.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Full {
    /// `planes[axis][side][slot]`: the least and the greatest of each box. A slot that is not used holds
    /// NaN: no ray meets it.
    planes: [[Lanes; 2]; 3],
    children: [Child; LANES],
}

impl Node for Full {
    #[inline(always)]
    fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { size_of::<Self>() / unit::BYTES }>(units, place as usize)
    }

    fn at_mut(units: &mut [Unit], place: u32) -> &mut Self {
        unit::at_mut::<Self, { size_of::<Self>() / unit::BYTES }>(units, place as usize)
    }

    fn new(children: &[(Child, Aabb); LANES]) -> Self {
        let plane = |side: usize, axis: usize| {
            children.each_ref().map(|(child, b)| if child.is_none() { f32::NAN } else { [b.min, b.max][side][axis] })
        };
        let planes = [0, 1, 2].map(|axis| [0, 1].map(|side| plane(side, axis)));
        Self { planes, children: children.map(|(child, _)| child) }
    }

    #[inline(always)]
    fn children(&self) -> &[Child; LANES] {
        &self.children
    }

    fn refer(&mut self, slot: usize, child: Child) {
        self.children[slot] = child;
    }

    fn bounds(&self, slot: usize) -> Aabb {
        let [x, y, z] = &self.planes;
        let corner = |side: usize| Vec3::new(x[side][slot], y[side][slot], z[side][slot]);
        Aabb { min: corner(0), max: corner(1) }
    }

    #[inline(always)]
    fn planes<S: Simd>(&self, s: S, sides: [usize; 3]) -> Points<S::F> {
        let ([x, y, z], [i, j, k]) = (&self.planes, sides);
        Points { x: s.load(&x[i & 1]), y: s.load(&y[j & 1]), z: s.load(&z[k & 1]) }
    }

    #[inline(always)]
    fn used(&self, slots: u32) -> u32 {
        slots
    }
}

const _: () = assert!(size_of::<Full>() == 224);
