//! The best plane that cuts triangles, among those between equal slabs of the node's box, and the
//! cutting itself with references kept whole where that is cheaper (Stich, Friedrich and Dietrich
//! 2009, §4.2 to 4.4).

use rayon::prelude::*;

use super::clip::cut;
use crate::accel::bvh::boxes::{Bounds, PrimBox};
use crate::accel::{BuildCx, BuildError};
use crate::geometry::num;
use crate::scene::Geometry;

/// Looks for planes.
#[derive(Clone, Copy, Debug)]
pub struct Spatial<'a> {
    pub geometry: &'a Geometry,
    /// Slabs on each axis.
    pub bins: u32,
}

/// A plane, and what its sides would come to.
#[derive(Clone, Copy, Debug)]
pub struct Cut {
    axis: usize,
    pos: f32,
    /// `half area * count` summed over both sides.
    pub children: f64,
    sides: [(Bounds, usize); 2],
}

/// The most slabs.
const MAX: usize = super::super::binned::MAX_BINS as usize;

/// References from which on a node is looked at in parallel, and in what portions.
const PARALLEL: usize = 1 << 14;
const CHUNK: usize = 1 << 12;

#[derive(Clone, Copy)]
struct Slab {
    bounds: Bounds,
    /// References that begin here.
    enter: u32,
    /// References that end here.
    exit: u32,
}

const EMPTY: Slab = Slab { bounds: Bounds::EMPTY, enter: 0, exit: 0 };

type Slabs = Vec<[Slab; 3]>;

/// Where the slabs of a node are on an axis.
struct Ruler {
    /// The planes between slabs, the box's own faces at the ends.
    planes: [f32; MAX + 1],
    bins: usize,
    min: f32,
    per_unit: f32,
}

impl Ruler {
    fn new(bounds: &Bounds, axis: usize, bins: usize) -> Self {
        let (min, size) = (bounds.min()[axis], f64::from(bounds.size()[axis]));
        let mut planes = [min; MAX + 1];
        let step = size / bins as f64;
        for (i, plane) in planes.iter_mut().enumerate().take(bins + 1) {
            *plane = num::narrow(f64::from(min) + step * i as f64);
        }
        Self { planes, bins, min, per_unit: num::narrow(1.0 / step) }
    }

    /// The slab of a coordinate: the last whose plane is not after it.
    #[inline(always)]
    fn slab(&self, x: f32) -> usize {
        let mut at = num::floor_index(f64::from((x - self.min) * self.per_unit), self.bins - 1);
        while at > 0 && x < self.planes[at] {
            at -= 1;
        }
        while at + 1 < self.bins && x >= self.planes[at + 1] {
            at += 1;
        }
        at
    }
}

impl Spatial<'_> {
    /// The cheapest plane that leaves both sides some reference, if there is one.
    pub fn best(&self, refs: &[PrimBox], bounds: &Bounds, cx: &BuildCx) -> Result<Option<Cut>, BuildError> {
        // Few references need few planes, and are cut by every one that they cross.
        let bins = (self.bins as usize).min(refs.len().clamp(4, if refs.len() < 256 { 16 } else { MAX }));
        let rulers = [0, 1, 2].map(|axis| Ruler::new(bounds, axis, bins));
        let wide = |axis: &usize| bounds.size()[*axis] > 0.0;
        let chunk = |refs: &[PrimBox]| {
            let mut slabs: Slabs = vec![[EMPTY; 3]; bins];
            for axis in (0..3).filter(wide) {
                refs.iter().for_each(|r| self.sort_in(r, &rulers[axis], axis, &mut slabs));
            }
            slabs
        };
        let slabs = if refs.len() < PARALLEL {
            chunk(refs)
        } else {
            let checked = |refs: &[PrimBox]| cx.cancel.check().map(|()| chunk(refs));
            let parts: Result<Vec<Slabs>, _> = refs.par_chunks(CHUNK).map(checked).collect();
            parts?.into_iter().reduce(joined).unwrap_or_default()
        };
        let cuts = (0..3).filter(wide).filter_map(|axis| cheapest(&slabs, &rulers[axis], axis));
        Ok(cuts.min_by(|a, b| a.children.total_cmp(&b.children)))
    }

    /// Cuts a reference at every plane that it crosses on an axis, and sorts the parts in.
    fn sort_in(&self, r: &PrimBox, ruler: &Ruler, axis: usize, slabs: &mut Slabs) {
        let b = r.bounds();
        let (first, last) = (ruler.slab(b.min()[axis]), ruler.slab(b.max()[axis]));
        slabs[first][axis].enter += 1;
        slabs[last][axis].exit += 1;
        if first == last {
            slabs[first][axis].bounds = slabs[first][axis].bounds.union(b);
            return;
        }
        let corners = self.geometry.corners(r.prim());
        let mut rest = Some(*r);
        for (i, slab) in slabs.iter_mut().enumerate().take(last).skip(first) {
            let Some(part) = rest else { return };
            let [below, above] = cut(&part, &corners, axis, ruler.planes[i + 1]);
            if let Some(below) = below {
                slab[axis].bounds = slab[axis].bounds.union(below.bounds());
            }
            rest = above;
        }
        if let Some(part) = rest {
            slabs[last][axis].bounds = slabs[last][axis].bounds.union(part.bounds());
        }
    }

    /// Deals the references to both sides. One that the plane crosses is cut, or goes whole to a side
    /// if that costs less (§4.4, reference unsplitting).
    pub fn apart(&self, refs: &[PrimBox], plane: &Cut, cx: &BuildCx) -> Result<(Vec<PrimBox>, Vec<PrimBox>), BuildError> {
        let (mut left, mut right) = (Vec::with_capacity(plane.sides[0].1), Vec::with_capacity(plane.sides[1].1));
        let [(mut left_box, mut left_count), (mut right_box, mut right_count)] = plane.sides;
        for chunk in refs.chunks(CHUNK) {
            cx.cancel.check()?;
            for r in chunk {
                let b = r.bounds();
                if b.max()[plane.axis] <= plane.pos && b.min()[plane.axis] < plane.pos {
                    left.push(*r);
                    continue;
                }
                if b.min()[plane.axis] >= plane.pos {
                    right.push(*r);
                    continue;
                }
                let (to_left, to_right) = (left_box.union(b), right_box.union(b));
                let (l, r_) = (left_count as f64, right_count as f64);
                let both = left_box.half_area() * l + right_box.half_area() * r_;
                let only_left = to_left.half_area() * l + right_box.half_area() * (r_ - 1.0);
                let only_right = left_box.half_area() * (l - 1.0) + to_right.half_area() * r_;
                let parts = cut(r, &self.geometry.corners(r.prim()), plane.axis, plane.pos);
                let whole_left = match parts {
                    [Some(below), Some(above)] if both <= only_left && both <= only_right => {
                        left.push(below);
                        right.push(above);
                        continue;
                    }
                    [Some(_), Some(_)] => only_left <= only_right,
                    [below, _] => below.is_some(),
                };
                if whole_left {
                    left.push(*r);
                    (left_box, right_count) = (to_left, right_count.saturating_sub(1));
                } else {
                    right.push(*r);
                    (right_box, left_count) = (to_right, left_count.saturating_sub(1));
                }
            }
        }
        Ok((left, right))
    }
}

fn joined(mut a: Slabs, b: Slabs) -> Slabs {
    for (a, b) in a.iter_mut().flatten().zip(b.iter().flatten()) {
        *a = Slab { bounds: a.bounds.union(b.bounds), enter: a.enter + b.enter, exit: a.exit + b.exit };
    }
    a
}

/// One sweep from the right, one from the left.
fn cheapest(slabs: &Slabs, ruler: &Ruler, axis: usize) -> Option<Cut> {
    let mut right = [(Bounds::EMPTY, 0usize); MAX];
    let mut side = (Bounds::EMPTY, 0usize);
    for i in (1..slabs.len()).rev() {
        side = (side.0.union(slabs[i][axis].bounds), side.1 + slabs[i][axis].exit as usize);
        right[i] = side;
    }
    let mut left = (Bounds::EMPTY, 0usize);
    let mut best: Option<Cut> = None;
    for first_right in 1..slabs.len() {
        let slab = &slabs[first_right - 1][axis];
        left = (left.0.union(slab.bounds), left.1 + slab.enter as usize);
        let right = right[first_right];
        if left.1 == 0 || right.1 == 0 {
            continue;
        }
        let children = left.0.half_area() * left.1 as f64 + right.0.half_area() * right.1 as f64;
        if children < best.map_or(f64::INFINITY, |b| b.children) {
            best = Some(Cut { axis, pos: ruler.planes[first_right], children, sides: [left, right] });
        }
    }
    best
}
