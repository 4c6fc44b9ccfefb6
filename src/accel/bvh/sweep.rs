//! Full SAH sweep (Goldsmith and Salmon 1987; MacDonald and Booth 1990; Wald, Boulos and Shirley
//! 2007, §4.1): every plane between two neighbouring centres on three axes is tried. The triangles
//! are sorted on each axis once and stay sorted while they are divided, so it is O(N log N) where
//! the tree is as deep as log N.

use std::sync::atomic::{AtomicBool, Ordering};

use super::boxes::{Bounds, PrimBox};
use super::costs::Costs;
use super::topdown::{Divide, Divided};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, num};
use crate::scene::PrimRef;
use crate::task::sort::{self, ascending};

/// The sweep over some triangles.
#[derive(Debug)]
pub struct Sweep<'a> {
    boxes: &'a [PrimBox],
    /// While a node is divided: which of its triangles go left. Nodes share no triangle.
    goes_left: Vec<AtomicBool>,
    costs: Costs,
}

/// A node's triangles, by index, sorted along each axis.
#[derive(Debug)]
pub struct Sorted<'a>([&'a mut [u32]; 3]);

/// A plane between two triangles: `left` of them along `axis` go left.
#[derive(Clone, Copy)]
struct Plane {
    axis: usize,
    left: usize,
    children: f64,
}

/// Triangles handled between two looks at the cancel flag.
const CHUNK: usize = 1 << 16;

impl<'a> Sweep<'a> {
    /// Over these.
    pub fn new(boxes: &'a [PrimBox], costs: Costs) -> Self {
        Self { boxes, goes_left: boxes.iter().map(|_| AtomicBool::new(false)).collect(), costs }
    }

    /// All of them, sorted along each axis; called on the pool.
    pub fn sorted(boxes: &[PrimBox], cx: &BuildCx) -> Result<[Vec<u32>; 3], BuildError> {
        let mut lists = [const { Vec::new() }; 3];
        for (axis, list) in lists.iter_mut().enumerate() {
            let key = |i: usize| (ascending(boxes[i].centre_twice()[axis]), num::index(i));
            let mut keys: Vec<(u32, u32)> = (0..boxes.len()).map(key).collect();
            sort::by_value(&mut keys, &cx.cancel)?;
            *list = keys.into_iter().map(|(_, i)| i).collect();
        }
        Ok(lists)
    }

    /// The work that a build begins with.
    pub fn work(lists: &mut [Vec<u32>; 3]) -> Sorted<'_> {
        Sorted(lists.each_mut().map(|list| &mut list[..]))
    }

    fn bounds(&self, ids: &[u32]) -> Bounds {
        ids.iter().fold(Bounds::EMPTY, |b, i| b.union(self.boxes[*i as usize].bounds()))
    }

    fn best(&self, work: &Sorted<'_>, cx: &BuildCx) -> Result<Option<Plane>, BuildError> {
        let mut right_cost = vec![0.0; work.0[0].len()];
        let mut best: Option<Plane> = None;
        for (axis, ids) in work.0.iter().enumerate() {
            let mut right = Bounds::EMPTY;
            for (i, id) in ids.iter().enumerate().rev() {
                if i.is_multiple_of(CHUNK) {
                    cx.cancel.check()?;
                }
                right = right.union(self.boxes[*id as usize].bounds());
                right_cost[i] = right.half_area() * (ids.len() - i) as f64;
            }
            let mut left = Bounds::EMPTY;
            for (i, id) in ids.iter().enumerate().take(ids.len() - 1) {
                if i.is_multiple_of(CHUNK) {
                    cx.cancel.check()?;
                }
                left = left.union(self.boxes[*id as usize].bounds());
                let children = left.half_area() * (i + 1) as f64 + right_cost[i + 1];
                if children < best.map_or(f64::INFINITY, |b| b.children) {
                    best = Some(Plane { axis, left: i + 1, children });
                }
            }
        }
        Ok(best)
    }

    /// Divides all three lists, each of which stays sorted.
    fn apart<'w>(&self, work: Sorted<'w>, axis: usize, left: usize) -> (Sorted<'w>, Sorted<'w>) {
        for (i, id) in work.0[axis].iter().enumerate() {
            self.goes_left[*id as usize].store(i < left, Ordering::Relaxed);
        }
        let mut kept = Vec::with_capacity(work.0[0].len() - left);
        let mut halves = work.0.into_iter().enumerate().map(|(k, ids)| {
            if k != axis {
                self.stable(ids, &mut kept);
            }
            ids.split_at_mut(left)
        });
        let mut next = || halves.next().unwrap_or_default();
        let (x, y, z) = (next(), next(), next());
        (Sorted([x.0, y.0, z.0]), Sorted([x.1, y.1, z.1]))
    }

    /// What goes left to the front, in the same order; `kept` is room for the others.
    fn stable(&self, ids: &mut [u32], kept: &mut Vec<u32>) {
        kept.clear();
        let mut to = 0;
        for i in 0..ids.len() {
            let id = ids[i];
            if self.goes_left[id as usize].load(Ordering::Relaxed) {
                ids[to] = id;
                to += 1;
            } else {
                kept.push(id);
            }
        }
        ids[to..].copy_from_slice(kept);
    }
}

impl<'a> Divide for Sweep<'a> {
    type Work = Sorted<'a>;

    fn count(&self, work: &Sorted<'a>) -> usize {
        work.0[0].len()
    }

    fn divide(&self, work: Sorted<'a>, may_be_leaf: bool, cx: &BuildCx) -> Result<Divided<Sorted<'a>>, BuildError> {
        let area = self.bounds(work.0[0]).half_area();
        let leaf = self.costs.triangles(area, work.0[0].len());
        let pays = |plane: &Plane| !may_be_leaf || self.costs.split(area, plane.children) < leaf;
        let Some(plane) = self.best(&work, cx)?.filter(pays) else { return Ok(Divided::Whole(work)) };
        let (left, right) = self.apart(work, plane.axis, plane.left);
        Ok(Divided::Two(left, right))
    }

    /// The axis on which the first and the last centre are farthest apart.
    fn halve(&self, work: Sorted<'a>) -> (Sorted<'a>, Sorted<'a>) {
        let centre = |ids: &[u32], i: usize, axis: usize| self.boxes[ids[i] as usize].centre_twice()[axis];
        let spread = |axis: usize| {
            let ids = &work.0[axis];
            centre(ids, ids.len() - 1, axis) - centre(ids, 0, axis)
        };
        let axis = (0..3).max_by(|a, b| spread(*a).total_cmp(&spread(*b)).then(b.cmp(a))).unwrap_or(0);
        let mid = work.0[0].len() / 2;
        self.apart(work, axis, mid)
    }

    fn leaf(&self, work: Sorted<'a>, refs: &mut Vec<PrimRef>) -> Aabb {
        refs.extend(work.0[0].iter().map(|i| self.boxes[*i as usize].prim()));
        self.bounds(work.0[0]).aabb()
    }
}
