//! Boxes as builders see them: four lanes wide, so that a union is two instructions. The fourth lane
//! of a [`PrimBox`] carries the triangle's number, and that of [`Bounds`] nothing of meaning.

use glam::{Vec3, Vec4};
use rayon::prelude::*;

use crate::accel::{BuildCx, BuildError};
use crate::geometry::{Aabb, Axis};
use crate::scene::{Geometry, PrimRef};

/// A box of four lanes.
#[derive(Clone, Copy, Debug)]
pub struct Bounds {
    min: Vec4,
    max: Vec4,
}

impl Bounds {
    /// Holds nothing.
    pub const EMPTY: Self = Self { min: Vec4::INFINITY, max: Vec4::NEG_INFINITY };

    /// The tightest box around both.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// This box grown to hold a point.
    #[inline(always)]
    pub fn with(self, point: Vec4) -> Self {
        Self { min: self.min.min(point), max: self.max.max(point) }
    }

    /// What both hold.
    #[inline(always)]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: self.min.max(other.min), max: self.max.min(other.max) }
    }

    /// Half the surface area; not meaningful for an empty box.
    #[inline(always)]
    pub fn half_area(&self) -> f64 {
        let d = self.max - self.min;
        let [x, y, z] = [d.x, d.y, d.z].map(f64::from);
        x * (y + z) + y * z
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        (self.min.cmpgt(self.max).bitmask() & 7) != 0
    }

    /// The least corner.
    #[inline(always)]
    pub const fn min(&self) -> Vec4 {
        self.min
    }

    /// The greatest corner.
    #[inline(always)]
    pub const fn max(&self) -> Vec4 {
        self.max
    }

    /// The edges.
    #[inline(always)]
    pub fn size(&self) -> Vec4 {
        self.max - self.min
    }

    /// The longest axis; the first of equals.
    pub fn longest_axis(&self) -> Axis {
        self.aabb().longest_axis()
    }

    /// The same in three lanes.
    #[inline(always)]
    pub fn aabb(&self) -> Aabb {
        Aabb { min: self.min.truncate(), max: self.max.truncate() }
    }
}

impl From<&Aabb> for Bounds {
    #[inline(always)]
    fn from(b: &Aabb) -> Self {
        Self { min: b.min.extend(0.0), max: b.max.extend(0.0) }
    }
}

/// A triangle, or a part of one, as builders see it.
#[derive(Clone, Copy, Debug)]
pub struct PrimBox {
    /// The fourth lane is the triangle's number, bit for bit: it is only ever copied.
    min: Vec4,
    max: Vec4,
}

impl PrimBox {
    /// The box of (a part of) a triangle.
    #[inline(always)]
    pub fn new(bounds: &Bounds, prim: PrimRef) -> Self {
        Self { min: bounds.min.with_w(f32::from_bits(prim)), max: bounds.max }
    }

    /// The triangle.
    #[inline(always)]
    pub fn prim(&self) -> PrimRef {
        self.min.w.to_bits()
    }

    /// Its box.
    #[inline(always)]
    pub const fn bounds(&self) -> Bounds {
        Bounds { min: self.min, max: self.max }
    }

    /// Twice the centre: enough to compare and to bin by.
    #[inline(always)]
    pub fn centre_twice(&self) -> Vec4 {
        self.min + self.max
    }
}

/// Triangles handled between two looks at the cancel flag.
pub const CHUNK: usize = 1 << 14;

/// The boxes of all live triangles.
pub fn prim_boxes(geometry: &Geometry, cx: &BuildCx) -> Result<Vec<PrimBox>, BuildError> {
    in_chunks(geometry.live_count(), cx, |i| {
        let prim = geometry.live(i);
        PrimBox::new(&Bounds::from(&Aabb::of_triangle(&geometry.corners(prim))), prim)
    })
}

/// A list made in parallel by index, with a look at the cancel flag every chunk.
pub fn in_chunks<V: Send + Copy>(n: usize, cx: &BuildCx, make: impl Fn(usize) -> V + Sync) -> Result<Vec<V>, BuildError> {
    let mut list = Vec::new();
    // What is left of a cancelled list is filled with whatever some chunk began with.
    let entry = |filler: &mut Option<V>, i: usize| {
        if i.is_multiple_of(CHUNK) {
            cx.progress.advance(CHUNK as u64);
            if cx.cancel.is_cancelled() && filler.is_none() {
                *filler = Some(make(i));
            }
        }
        filler.unwrap_or_else(|| make(i))
    };
    cx.pool.run(|| (0..n).into_par_iter().with_min_len(CHUNK).map_init(|| None, entry).collect_into_vec(&mut list));
    cx.cancel.check()?;
    Ok(list)
}

/// A point in four lanes.
#[inline(always)]
pub const fn lanes(p: Vec3) -> Vec4 {
    Vec4::new(p.x, p.y, p.z, 0.0)
}
