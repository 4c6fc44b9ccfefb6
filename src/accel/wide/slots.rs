//! Which slot a child takes, so that a ray visits children near to far without sorting them.
//!
//! The three bits of a slot say on which side of the node it is, one for each axis. A ray that runs
//! forward on all axes visits slots 0 to 7; any other in the order of `slot ^ octant` (Ylitie, Karras and
//! Laine 2017, "Efficient Incoherent Ray Traversal on GPUs Through Compressed Wide BVHs", section 3.4).

use super::child::Child;
use crate::geometry::Aabb;
use crate::simd::LANES;
use glam::Vec3;

/// Puts up to eight children where they are nearest to the side that their slot stands for: the
/// best pair of child and slot first.
pub fn assign(bounds: &Aabb, children: &[(Child, Aabb)]) -> [(Child, Aabb); LANES] {
    let centre = bounds.min + bounds.max;
    let away: [Vec3; LANES] = std::array::from_fn(|i| children.get(i).map_or(Vec3::ZERO, |(_, b)| b.min + b.max - centre));
    let mut slots = [(Child::NONE, Aabb::EMPTY); LANES];
    let (mut left, mut free) = ((1u32 << children.len()) - 1, 0xffu32);
    let gain = |child: usize, slot: usize| {
        let [x, y, z] = [0, 1, 2].map(|k| if slot >> k & 1 == 1 { away[child][k] } else { -away[child][k] });
        x + y + z
    };
    while left != 0 {
        let mut best = (f32::NEG_INFINITY, 0, 0);
        for child in bits(left) {
            for slot in bits(free) {
                let gain = gain(child, slot);
                // Without an order (an overflow) the first free slot is as good as any.
                if gain > best.0 || best.0 == f32::NEG_INFINITY {
                    best = (gain, child, slot);
                }
            }
        }
        let (_, child, slot) = best;
        slots[slot] = children[child];
        left &= !(1 << child);
        free &= !(1 << slot);
    }
    slots
}

/// The numbers of the set bits, ascending.
pub fn bits(mut mask: u32) -> impl Iterator<Item = usize> {
    std::iter::from_fn(move || {
        let bit = mask.trailing_zeros() as usize;
        let any = mask != 0;
        mask &= mask.wrapping_sub(1);
        any.then_some(bit)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn eight_octants_take_their_own_slots() {
        let whole = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let octant = |slot: u32| {
            let min = Vec3::from_array([0, 1, 2].map(|k| if slot >> k & 1 == 1 { 0.0 } else { -1.0 }));
            (Child::node(slot), Aabb { min, max: min + 1.0 })
        };
        let order = [3, 1, 7, 0, 2, 6, 5, 4];
        let slots = assign(&whole, &order.map(octant));
        for (slot, (child, _)) in slots.iter().enumerate() {
            assert_eq!(child.place() as usize, slot);
        }
    }

    #[test]
    fn slots_without_a_child_are_empty() {
        let whole = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let slots = assign(&whole, &[(Child::node(9), whole), (Child::node(8), whole)]);
        assert_eq!(slots.iter().filter(|(child, b)| *child == Child::NONE && b.is_empty()).count(), 6);
    }
}
