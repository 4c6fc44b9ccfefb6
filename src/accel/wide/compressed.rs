//! A node of eight boxes in 160 bytes: each plane is one of 65,536, from the least to the greatest of them all.
//!
//! ```text
//! plane = base + q step                         rounded twice, on every road alike
//! ```
//! After Ylitie, Karras and Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide
//! BVHs", section 3.1, who take 8 bits for q and powers of two for the step. With 8 bits the flat boxes of leaves
//! grow so thick that most rays that leave a surface meet their own leaf: on an interior (bathroom2) a diffuse ray
//! looked into 2.5 leaves, where it looks into 1.8 with 16 bits, as with full boxes. That cost a tenth of the
//! speed, and the second byte costs 1.2 bytes a triangle.
//!
//! Each q is chosen by that formula itself, which never falls as q rises: the box that it gives holds the
//! box that was asked for, to the bit, and sticks out by less than a step on each side. So no test has to be
//! widened for it. The step is the least that reaches from one end to the other: at both ends boxes stay as
//! thin as they are.

use super::child::Child;
use super::node::Node;
use super::unit::{self, Unit};
use crate::geometry::Aabb;
use crate::geometry::eight::Points;
use crate::simd::{LANES, Simd};
use glam::Vec3;

/// Boxes in steps.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Compressed {
    /// The least corner of all.
    base: [f32; 3],
    /// By axis; 0 where all boxes are flat and in one plane.
    steps: [f32; 3],
    /// A bit for each slot that is used.
    used: u32,
    spare: u32,
    /// `planes[axis][side][slot]`, in steps.
    planes: [[[u16; LANES]; 2]; 3],
    children: [Child; LANES],
}

/// Steps from one end to the other.
const STEPS: u16 = u16::MAX;

fn plane(base: f32, step: f32, q: u16) -> f32 {
    base + f32::from(q) * step
}

/// The least step that reaches from `base` to `end` in [`STEPS`].
fn step(base: f32, end: f32) -> f32 {
    let about = (end - base) / f32::from(STEPS);
    let steps = std::iter::successors(Some(about), |step| Some(step.next_up()));
    steps.into_iter().find(|step| plane(base, *step, STEPS) >= end).unwrap_or(about)
}

/// How many steps it is to `x`, less what is not a whole one; rounding may take or give one.
fn steps(base: f32, step: f32, x: f32) -> u16 {
    // 0 / 0, where all is in one plane, becomes 0.
    ((x - base) / step) as u16
}

/// The most steps that do not go beyond `x`.
fn below(base: f32, step: f32, x: f32) -> u16 {
    let near = steps(base, step, x);
    (0..=near.saturating_add(1)).rev().find(|q| plane(base, step, *q) <= x).unwrap_or(0)
}

/// The fewest steps that reach `x`.
fn above(base: f32, step: f32, x: f32) -> u16 {
    let near = steps(base, step, x);
    (near..=STEPS).find(|q| plane(base, step, *q) >= x).unwrap_or(STEPS)
}

impl Node for Compressed {
    #[inline(always)]
    fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { size_of::<Self>() / unit::BYTES }>(units, place as usize)
    }

    fn at_mut(units: &mut [Unit], place: u32) -> &mut Self {
        unit::at_mut::<Self, { size_of::<Self>() / unit::BYTES }>(units, place as usize)
    }

    fn new(children: &[(Child, Aabb); LANES]) -> Self {
        let there = || children.iter().enumerate().filter(|(_, (child, _))| !child.is_none());
        let whole = there().fold(Aabb::EMPTY, |whole, (_, (_, b))| whole.union(*b));
        let used = there().fold(0, |used, (slot, _)| used | 1 << slot);
        let mut node = Self {
            base: if used == 0 { [0.0; 3] } else { whole.min.into() },
            steps: [0.0; 3],
            used,
            spare: 0,
            planes: [[[0; LANES]; 2]; 3],
            children: children.map(|(child, _)| child),
        };
        for axis in 0..3 {
            node.steps[axis] = step(node.base[axis], if used == 0 { 0.0 } else { whole.max[axis] });
        }
        for (slot, (_, b)) in there() {
            for axis in 0..3 {
                let (base, step) = (node.base[axis], node.steps[axis]);
                node.planes[axis][0][slot] = below(base, step, b.min[axis]);
                node.planes[axis][1][slot] = above(base, step, b.max[axis]);
            }
        }
        node
    }

    #[inline(always)]
    fn children(&self) -> &[Child; LANES] {
        &self.children
    }

    fn refer(&mut self, slot: usize, child: Child) {
        self.children[slot] = child;
    }

    fn bounds(&self, slot: usize) -> Aabb {
        let corner = |side: usize| {
            Vec3::from([0, 1, 2].map(|axis| plane(self.base[axis], self.steps[axis], self.planes[axis][side][slot])))
        };
        Aabb { min: corner(0), max: corner(1) }
    }

    #[inline(always)]
    fn planes<S: Simd>(&self, s: S, sides: [usize; 3]) -> Points<S::F> {
        let ([x, y, z], [i, j, k]) = (&self.planes, sides);
        let q = Points { x: s.load_shorts(&x[i & 1]), y: s.load_shorts(&y[j & 1]), z: s.load_shorts(&z[k & 1]) };
        q.scaled(s, Points::splat(s, self.steps.into())).plus(s, Points::splat(s, self.base.into()))
    }

    #[inline(always)]
    fn used(&self, slots: u32) -> u32 {
        slots & self.used
    }
}

const _: () = assert!(size_of::<Compressed>() == 160);

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Kernel, LANES, Road};
    use proptest::prelude::*;

    struct Planes<'a>(&'a Compressed, usize);

    impl Kernel for Planes<'_> {
        type Out = [[f32; LANES]; 3];

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Out {
            let mut planes = [[0.0; LANES]; 3];
            self.0.planes(s, [self.1; 3]).store(s, &mut planes);
            planes
        }
    }

    fn coordinate() -> impl Strategy<Value = f32> {
        // Round ones, any, and such that many lie in one plane, or far closer to each other than to 0.
        prop_oneof![
            (-8i8..=8).prop_map(|i| f32::from(i) * 0.125),
            -1.0f32..1.0,
            Just(0.7f32),
            (0u32..64).prop_map(|i| f32::from_bits(0.7f32.to_bits() + i)),
            (0u32..9).prop_map(f32::from_bits),
            -1e-38f32..1e-38,
        ]
    }

    proptest! {
        #[test]
        fn a_decoded_box_holds_the_box_and_little_more(
            boxes in proptest::collection::vec([coordinate(), coordinate(), coordinate(), coordinate(), coordinate(), coordinate()], 1..=LANES),
            first in 0..LANES,
        ) {
            let mut children = [(Child::NONE, Aabb::EMPTY); LANES];
            for (i, [a, b, c, d, e, f]) in boxes.iter().copied().enumerate() {
                let (p, q) = (Vec3::new(a, b, c), Vec3::new(d, e, f));
                children[(first + i) % LANES] = (Child::node(7), Aabb { min: p.min(q), max: p.max(q) });
            }
            let node = Compressed::new(&children);
            let whole = children.iter().fold(Aabb::EMPTY, |whole, (_, b)| whole.union(*b));
            for (slot, (child, b)) in children.iter().enumerate() {
                prop_assert_eq!(node.used(1 << slot) != 0, *child != Child::NONE);
                if child.is_none() {
                    continue;
                }
                let decoded = node.bounds(slot);
                prop_assert!(decoded.contains_box(b), "{:?} does not hold {:?}", decoded, b);
                // A step, and the rounding of the plane itself.
                let slack = (whole.max - whole.min) / 65534.0 + whole.min.abs().max(whole.max.abs()) * 2.0 * f32::EPSILON
                    + Vec3::splat(f32::MIN_POSITIVE);
                prop_assert!((decoded.max - b.max).cmple(slack).all() && (b.min - decoded.min).cmple(slack).all());
            }
            for road in Road::all() {
                let [least, greatest] = [0, 1].map(|side| road.run(Planes(&node, side)));
                for slot in 0..LANES {
                    let corner = |planes: &[[f32; LANES]; 3]| Vec3::new(planes[0][slot], planes[1][slot], planes[2][slot]);
                    let b = node.bounds(slot);
                    prop_assert_eq!([corner(&least), corner(&greatest)], [b.min, b.max], "{}", road.id());
                }
            }
        }
    }
}
