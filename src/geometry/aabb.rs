//! Axis-aligned bounding boxes.

use glam::Vec3;

/// A closed box with faces parallel to the axes. Empty when any minimum exceeds its maximum.
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
pub struct Aabb {
    /// The least corner.
    pub min: Vec3,
    /// The greatest corner.
    pub max: Vec3,
}

/// One of the three coordinate axes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize)]
#[repr(u8)]
pub enum Axis {
    /// The first coordinate.
    X = 0,
    /// The second coordinate.
    Y = 1,
    /// The third coordinate.
    Z = 2,
}

impl Axis {
    /// All three, in order.
    pub const ALL: [Self; 3] = [Self::X, Self::Y, Self::Z];

    /// 0, 1 or 2.
    #[inline(always)]
    pub const fn index(self) -> usize {
        self as usize
    }

    /// `x`, `y` or `z`.
    pub const fn name(self) -> &'static str {
        ["x", "y", "z"][self as usize]
    }
}

impl Aabb {
    /// Holds nothing; the neutral element of [`Self::union`].
    pub const EMPTY: Self = Self { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The tightest box around some points.
    pub fn of_points(points: impl IntoIterator<Item = Vec3>) -> Self {
        points.into_iter().fold(Self::EMPTY, Self::with)
    }

    /// The tightest box around a triangle.
    #[inline(always)]
    pub fn of_triangle(tri: &[Vec3; 3]) -> Self {
        Self { min: min(min(tri[0], tri[1]), tri[2]), max: max(max(tri[0], tri[1]), tri[2]) }
    }

    /// This box grown to hold `point`.
    #[inline(always)]
    pub fn with(self, point: Vec3) -> Self {
        Self { min: min(self.min, point), max: max(self.max, point) }
    }

    /// The tightest box around both.
    #[inline(always)]
    pub fn union(self, other: Self) -> Self {
        Self { min: min(self.min, other.min), max: max(self.max, other.max) }
    }

    /// What both hold; empty when they are apart.
    #[inline(always)]
    pub fn intersection(self, other: Self) -> Self {
        Self { min: max(self.min, other.min), max: min(self.max, other.max) }
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        !self.min.cmple(self.max).all()
    }

    /// Whether `other` lies in this box. The empty box lies in every box.
    pub fn contains_box(&self, other: &Self) -> bool {
        other.is_empty() || (self.min.cmple(other.min).all() && self.max.cmpge(other.max).all())
    }

    /// Edge lengths; not meaningful for the empty box.
    pub fn size(&self) -> Vec3 {
        self.max - self.min
    }

    /// Twice the centre: enough to compare and to bin by, and exact where the sum is.
    #[inline(always)]
    pub fn centre_twice(&self) -> Vec3 {
        self.min + self.max
    }

    /// The centre.
    pub fn centre(&self) -> Vec3 {
        self.min * 0.5 + self.max * 0.5
    }

    /// The surface area, 0 for the empty box.
    #[inline(always)]
    pub fn area(&self) -> f64 {
        let d = (self.max - self.min).as_dvec3();
        if d.x < 0.0 || d.y < 0.0 || d.z < 0.0 { 0.0 } else { 2.0 * (d.x * d.y + d.y * d.z + d.z * d.x) }
    }

    /// The longest axis; the first of equals.
    pub fn longest_axis(&self) -> Axis {
        let d = self.size();
        if d.x >= d.y && d.x >= d.z {
            Axis::X
        } else if d.y >= d.z {
            Axis::Y
        } else {
            Axis::Z
        }
    }

    /// The box cut at `pos` along `axis`: what lies below, and what lies above.
    pub fn split(&self, axis: Axis, pos: f32) -> (Self, Self) {
        let (mut below, mut above) = (*self, *self);
        below.max[axis.index()] = pos;
        above.min[axis.index()] = pos;
        (below, above)
    }

    /// The eight corners; bit k of the index picks the maximum on axis k.
    pub fn corners(&self) -> [Vec3; 8] {
        std::array::from_fn(|i| {
            let pick = |k: usize| if i >> k & 1 == 1 { self.max[k] } else { self.min[k] };
            Vec3::new(pick(0), pick(1), pick(2))
        })
    }
}

/// Smaller of each component by one comparison (the standard `min` also looks for NaN, which
/// never reaches here).
#[inline(always)]
fn min(a: Vec3, b: Vec3) -> Vec3 {
    let m = |a: f32, b: f32| if a < b { a } else { b };
    Vec3::new(m(a.x, b.x), m(a.y, b.y), m(a.z, b.z))
}

#[inline(always)]
fn max(a: Vec3, b: Vec3) -> Vec3 {
    let m = |a: f32, b: f32| if a > b { a } else { b };
    Vec3::new(m(a.x, b.x), m(a.y, b.y), m(a.z, b.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_empty_box_is_neutral() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::ONE };
        assert_eq!(unit.union(Aabb::EMPTY), unit);
        assert!(Aabb::EMPTY.is_empty() && !unit.is_empty());
        assert_eq!(Aabb::EMPTY.area(), 0.0);
        assert_eq!(unit.area(), 6.0);
        assert!(unit.contains_box(&Aabb::EMPTY));
    }

    #[test]
    fn a_cut_box_covers_the_whole() {
        let unit = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 2.0, 3.0) };
        let (below, above) = unit.split(Axis::Z, 1.0);
        assert_eq!(below.union(above), unit);
        assert_eq!(unit.longest_axis(), Axis::Z);
        assert_eq!(Aabb::of_points(unit.corners()), unit);
    }
}
