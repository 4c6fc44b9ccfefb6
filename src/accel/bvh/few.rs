//! Nodes of a few triangles: every way to divide them is tried. That is cheaper than to clear a single bucket
//! list, and half of all nodes are such.

use super::boxes::{Bounds, PrimBox};
use super::costs::Costs;
use super::slice::Slice;
use super::topdown::Divided;

/// The most triangles: seven ways for four.
pub const MOST: usize = 4;

/// Divides at most [`MOST`] triangles where the surface area heuristic is least; not at all if a leaf may stay
/// and costs no more. The first of equals; ways are counted by a bit for each triangle that goes left.
pub fn divide<'a>(slice: Slice<'a>, may_be_leaf: bool, costs: &Costs) -> Divided<Slice<'a>> {
    let n = slice.prims.len();
    // The last always goes right: the other half of all ways is the same with the sides changed.
    let best = (1..1u32 << n.saturating_sub(1)).fold((f64::INFINITY, 0), |best, left| {
        let cost = cost(slice.prims, left) + cost(slice.prims, !left);
        if cost < best.0 { (cost, left) } else { best }
    });
    let (children, left) = best;
    let pays = left != 0 && (!may_be_leaf || costs.split(slice.bounds.half_area(), children) < costs.leaf(&slice));
    if !pays {
        return Divided::Whole(slice);
    }
    // What goes left moves to the front.
    let (mut kept, mut count) = ([slice.prims[0]; MOST], 0);
    for side in [left, !left] {
        for (_, prim) in chosen(slice.prims, side) {
            kept[count] = *prim;
            count += 1;
        }
    }
    slice.prims.copy_from_slice(&kept[..n]);
    let (l, r) = slice.prims.split_at_mut(left.count_ones() as usize);
    Divided::Two(Slice::new(l), Slice::new(r))
}

fn chosen(prims: &[PrimBox], which: u32) -> impl Iterator<Item = (usize, &PrimBox)> {
    prims.iter().enumerate().filter(move |(i, _)| which >> i & 1 == 1)
}

/// `half area * count` of those whose bits are set.
fn cost(prims: &[PrimBox], which: u32) -> f64 {
    let (bounds, count) = chosen(prims, which).fold((Bounds::EMPTY, 0.0), |(b, n), (_, prim)| (b.union(prim.bounds()), n + 1.0));
    bounds.half_area() * count
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Aabb;
    use glam::Vec3;

    fn boxes(at: &[(f32, f32)]) -> Vec<PrimBox> {
        let boxed = |(i, (x, y)): (usize, &(f32, f32))| {
            let min = Vec3::new(*x, *y, 0.0);
            PrimBox::new(&Bounds::from(&Aabb { min, max: min + Vec3::ONE }), i as u32)
        };
        at.iter().enumerate().map(boxed).collect()
    }

    fn sides(at: &[(f32, f32)], may_be_leaf: bool) -> Option<[Vec<u32>; 2]> {
        let mut prims = boxes(at);
        let costs = Costs { c_trav: 1.0, c_isect: 1.0 };
        match divide(Slice::new(&mut prims), may_be_leaf, &costs) {
            Divided::Two(l, r) => Some([l, r].map(|side| {
                let mut prims: Vec<u32> = side.prims.iter().map(PrimBox::prim).collect();
                prims.sort_unstable();
                prims
            })),
            Divided::Whole(_) => None,
        }
    }

    #[test]
    fn neighbours_stay_together_wherever_they_are_in_the_list() {
        // Two pairs, far from each other on a diagonal.
        let pairs = [(0.0, 0.0), (50.0, 50.0), (0.5, 0.0), (50.5, 50.0)];
        assert_eq!(sides(&pairs, true), Some([vec![0, 2], vec![1, 3]]));
        assert_eq!(sides(&[(0.0, 0.0), (90.0, 0.0), (91.0, 0.0)], true), Some([vec![0], vec![1, 2]]));
    }

    #[test]
    fn what_lies_in_one_place_is_divided_only_if_it_must_be() {
        let same = [(2.0, 2.0); 3];
        assert_eq!(sides(&same, true), None);
        assert_eq!(sides(&same, false).map(|[l, r]| l.len() + r.len()), Some(3));
        assert_eq!(sides(&same[..1], false), None);
    }
}
