//! A node of eight boxes, and how a ray meets them all at once.
//!
//! The operations are those of [`crate::geometry::Slabs::interval`], so a box around another never has
//! the smaller interval. The nearer plane of each axis is picked by the ray's sign, which takes the
//! place of a minimum and a maximum.

use super::child::Child;
use super::unit::{self, Unit};
use crate::geometry::{Aabb, Sides};
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// Eight boxes and what is in them. 224 bytes: as many cache lines as 256.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Node {
    /// `planes[axis][side][slot]`: the least and the greatest of each box. A slot that is not used is
    /// empty: no ray meets it.
    planes: [[Lanes; 2]; 3],
    children: [Child; LANES],
}

/// A ray as nodes see it: one number for all lanes.
#[derive(Clone, Copy, Debug)]
pub struct RayIn {
    sides: Sides,
    /// Which plane of each axis is met first: 0 for the least, 1 for the greatest.
    first: [usize; 3],
    /// Slots are visited in the order of `slot ^ order`, the last first: see [`super::slots`].
    pub order: u32,
}

impl RayIn {
    #[inline(always)]
    pub fn new(sides: Sides) -> Self {
        let backward = sides.backward as usize;
        Self { first: [backward & 1, backward >> 1 & 1, backward >> 2], order: !sides.backward & 7, sides }
    }
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
        let plane = |side: usize, axis: usize| children.each_ref().map(|(_, b)| [b.min, b.max][side][axis]);
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
    pub fn meet<S: Simd>(&self, s: S, ray: &RayIn, tmin: f32, tmax: f32) -> Met<S::F> {
        let [nx, ny, nz] = [self.near(s, ray, 0), self.near(s, ray, 1), self.near(s, ray, 2)];
        let [fx, fy, fz] = [self.far(s, ray, 0), self.far(s, ray, 1), self.far(s, ray, 2)];
        let entry = s.max(s.max(nx, ny), s.max(nz, s.splat(tmin)));
        let exit = s.min(s.min(fx, fy), s.min(fz, s.splat(tmax)));
        Met { slots: s.bits(s.le(entry, exit)), entry }
    }

    #[inline(always)]
    fn near<S: Simd>(&self, s: S, ray: &RayIn, axis: usize) -> S::F {
        let plane = s.load(&self.planes[axis][ray.first[axis] & 1]);
        s.mul(s.sub(s.splat(ray.sides.near[axis]), plane), s.splat(ray.sides.minus_inv[axis]))
    }

    #[inline(always)]
    fn far<S: Simd>(&self, s: S, ray: &RayIn, axis: usize) -> S::F {
        let plane = s.load(&self.planes[axis][ray.first[axis] & 1 ^ 1]);
        s.mul(s.sub(s.splat(ray.sides.far[axis]), plane), s.splat(ray.sides.minus_inv[axis]))
    }
}

const _: () = assert!(size_of::<Node>() == 224);
