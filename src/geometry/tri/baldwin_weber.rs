//! Baldwin and Weber 2016, "Fast Ray-Triangle Intersections by Coordinate Transformation" (JCGT 5(3)). For comparison;
//! brute force has it.

use super::plain::Plain;
use super::{Meets, Own, TestKind, TriHit, TriTest};
use crate::geometry::eight::{Points, Rays};
use crate::geometry::num;
use crate::geometry::{Aabb, EightSlabs, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// What takes a triangle to (0, 0), (1, 0), (0, 1) in the plane, along the axis that its normal is nearest to: the
/// rows of a matrix, without the three entries that are always 0, 0 and 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transformation<F> {
    /// That axis; the others follow in turn.
    pub axis: u32,
    /// Barycentric weight of the second corner: of the two other axes, and what is added.
    pub u: [F; 3],
    /// Of the third corner.
    pub v: [F; 3],
    /// The distance from the plane along the axis: of the two other axes, and what is added.
    pub w: [F; 3],
}

const _: () = assert!(size_of::<Transformation<f32>>() == 40);

/// The operations that the test takes, so that its error can be worked out by the same lines that run it.
pub trait Number: Copy {
    /// A coordinate.
    fn of(x: f32) -> Self;
    /// The sum.
    fn plus(self, other: Self) -> Self;
    /// The difference.
    fn minus(self, other: Self) -> Self;
    /// The product.
    fn times(self, other: Self) -> Self;
    /// The quotient.
    fn over(self, other: Self) -> Self;
    /// Without its sign, to find the greatest.
    fn size(self) -> f64;
}

impl Number for f32 {
    #[inline(always)]
    fn of(x: f32) -> Self {
        x
    }

    #[inline(always)]
    fn plus(self, other: Self) -> Self {
        self + other
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        self - other
    }

    #[inline(always)]
    fn times(self, other: Self) -> Self {
        self * other
    }

    #[inline(always)]
    fn over(self, other: Self) -> Self {
        self / other
    }

    #[inline(always)]
    fn size(self) -> f64 {
        f64::from(self.abs())
    }
}

impl<F: Number> Transformation<F> {
    /// Of a triangle.
    #[inline(always)]
    pub fn new(tri: &[Vec3; 3]) -> Self {
        Self::along(tri, |size| {
            if size[0] > size[1] && size[0] > size[2] {
                0
            } else if size[1] > size[2] {
                1
            } else {
                2
            }
        })
    }

    /// Along the axis that is chosen by the sizes of the normal's components.
    #[inline(always)]
    pub fn along(tri: &[Vec3; 3], axis: impl Fn([f64; 3]) -> usize) -> Self {
        let [a, b, c] = tri.map(|p| p.to_array().map(F::of));
        let less = |p: [F; 3]| [p[0].minus(a[0]), p[1].minus(a[1]), p[2].minus(a[2])];
        let (e1, e2) = (less(b), less(c));
        let minor = |p: &[F; 3], q: &[F; 3], x: usize, y: usize| p[x].times(q[y]).minus(p[y].times(q[x]));
        let normal = [minor(&e1, &e2, 1, 2), minor(&e1, &e2, 2, 0), minor(&e1, &e2, 0, 1)];
        let axis = axis(normal.map(F::size));
        let (x, y) = ((axis + 1) % 3, (axis + 2) % 3);
        let n = normal[axis];
        let zero = F::of(0.0);
        let row = |px: F, py: F, added: F| [px.over(n), py.over(n), added.over(n)];
        let along = normal[0].times(a[0]).plus(normal[1].times(a[1])).plus(normal[2].times(a[2]));
        Self {
            axis: num::index(axis),
            u: row(e2[y], zero.minus(e2[x]), minor(&e2, &a, x, y)),
            v: row(zero.minus(e1[y]), e1[x], minor(&a, &e1, x, y)),
            w: row(normal[x], normal[y], zero.minus(along)),
        }
    }

    /// The t of the plane and the weights of the second and the third corner there.
    #[inline(always)]
    pub fn meet(&self, origin: Vec3, dir: Vec3) -> [F; 3] {
        let z = self.axis as usize;
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let (o, d) = (origin.to_array().map(F::of), dir.to_array().map(F::of));
        let linear = |row: &[F; 3], p: &[F; 3]| row[0].times(p[x]).plus(row[1].times(p[y]));
        let from = o[z].plus(linear(&self.w, &o)).plus(self.w[2]);
        let step = d[z].plus(linear(&self.w, &d));
        let t = F::of(0.0).minus(from.over(step));
        let weight = |row: &[F; 3]| linear(row, &o).plus(row[2]).plus(t.times(linear(row, &d)));
        [t, weight(&self.u), weight(&self.v)]
    }
}

impl Transformation<f32> {
    /// Whether a ray meets the triangle, and where.
    #[inline(always)]
    pub fn hit(&self, origin: Vec3, dir: Vec3) -> Option<TriHit> {
        let [t, u, v] = self.meet(origin, dir);
        (t.is_finite() && u >= 0.0 && v >= 0.0 && u + v <= 1.0).then_some(TriHit { t, u, v })
    }
}

/// The transformation is worked out at each test here; where triangles are tested often it is stored, which is what the lab
/// times.
#[derive(Clone, Copy, Debug)]
pub struct BaldwinWeber(Plain);

impl TriTest for BaldwinWeber {
    const KIND: TestKind = TestKind::BaldwinWeber;

    #[inline(always)]
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        Self(Plain::prepare(ray, bounds))
    }

    #[inline(always)]
    fn slabs(&self) -> &Slabs {
        &self.0.slabs
    }

    #[inline(always)]
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit> {
        Transformation::<f32>::new(tri).hit(self.0.origin, self.0.dir)
    }

    /// Each is tested by itself.
    #[inline(always)]
    fn meet_eight<S: Simd>(s: S, _: &Own<S::F>, _: &EightSlabs<S::F>, _: &[Points<S::F>; 3]) -> Meets<S> {
        Meets::doubtful(s)
    }

    #[inline(always)]
    fn own(&self) -> Own<f32> {
        self.0.own()
    }

    #[inline(always)]
    fn own_of_eight<S: Simd>(s: S, rays: &Rays<S::F>) -> Own<S::F> {
        Plain::own_of_eight(s, rays)
    }

    #[inline(always)]
    fn from_own(own: &Own<f32>, slabs: Slabs) -> Self {
        Self(Plain::from_own(own, slabs))
    }
}
