//! The test that is never wrong: signs are exact and t is correctly rounded, by a filter with exact arithmetic behind
//! it (Shewchuk 1997; the predicates of a line and an edge as in Plücker coordinates).
//!
//! With `A`, `B`, `C` the corners seen from the ray's origin, and `d` its direction, the line passes the three edges on
//! the sides that the signs of `d.(B x C)`, `d.(C x A)` and `d.(A x B)` say, and meets the plane at
//! `t = A.(B x C) / (their sum) = A.N / d.N` with `N = (A - C) x (B - A)`. Three steps, each for what the one before could not decide:
//!
//! 1. Eight triangles in 32 bits. A corner is moved and sheared as in the watertight test, but multiplied by `d_z`
//!    instead of divided, which displaces it by at most `r = 6uD` (u the unit roundoff, D the greatest distance from the
//!    origin to the scene in any component; see [`crate::geometry::slabs`]). With `m` the greatest coordinate of the
//!    three, an edge function of products is off by at most `4rm + 2r^2` for the displacements and `4u m^2 < 2rm` for its
//!    own roundings (`m < 2D`), so a sign is certain beyond `8r(m + r)`. Two certain signs that differ: a miss.
//! 2. In 64 bits, with u = 2^-53: `d.(B x C) = d.(B x (C - B))`, which is as small as the edge is, however far the origin
//!    is. Two differences of 32-bit numbers, two products and three sums make seven roundings in each of six
//!    terms, so it is off by at most `64u |d| |B| |C - B|`, greatest components taken; and `A.N` and `d.N` likewise.
//! 3. Exactly: [`Expansion`].
//!
//! A ray through an edge or a corner, to the bit, hits all triangles that share it, at the same t. A ray in a
//! triangle's plane misses it.

use super::watertight::{AXES, in_order, order_of, with_axes};
use super::{Hits, Meets, Own, TestKind, TriHit, TriTest, splat_own};
use crate::geometry::eight::{Points, Rays};
use crate::geometry::expansion::Expansion;
use crate::geometry::num::{max, min, narrow};
use crate::geometry::{Aabb, EightSlabs, Ray, Slabs};
use crate::simd::Simd;
use glam::{DVec3, Vec2, Vec3};

/// See above.
#[derive(Clone, Copy, Debug)]
pub struct Exact {
    origin: Vec3,
    dir: Vec3,
    /// The order of the axes in the first step: see [`AXES`].
    axes: u32,
    slabs: Slabs,
}

/// Eight times the displacement, of the widths of the slabs: those are at least `24uD`, less what rounding took.
const DISPLACED: f32 = 2.25;

impl TriTest for Exact {
    const KIND: TestKind = TestKind::Exact;

    #[inline(always)]
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self {
        Self { origin: ray.origin, dir: ray.dir, axes: order_of(ray.dir), slabs: Slabs::new(ray, bounds) }
    }

    #[inline(always)]
    fn slabs(&self) -> &Slabs {
        &self.slabs
    }

    #[inline(always)]
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit> {
        if self.surely_misses(tri) { None } else { self.meet_for_certain(tri, [f32::NEG_INFINITY, f32::INFINITY]) }
    }

    /// The interval of the triangle's box holds every exact t, and what that is rounded to: boxes are wider than any
    /// rounding. So nothing is asked about it.
    #[inline(always)]
    fn hit(&self, tri: &[Vec3; 3], tmin: f32, tmax: f32) -> Option<TriHit> {
        if self.surely_misses(tri) { None } else { self.hit_in_doubt(tri, tmin, tmax) }
    }

    #[inline(always)]
    fn hit_in_doubt(&self, tri: &[Vec3; 3], tmin: f32, tmax: f32) -> Option<TriHit> {
        self.meet_for_certain(tri, [tmin, tmax])
    }

    #[inline(always)]
    fn axes(&self) -> [usize; 3] {
        AXES[self.axes as usize % 8]
    }

    /// Those that are not missed for certain are in doubt; if there are several, they go through the second step side by side.
    /// Of what is in doubt after that, t and u are the least and the greatest t that it may have.
    #[inline(always)]
    fn meet_eight<S: Simd>(s: S, own: &Own<S::F>, slabs: &EightSlabs<S::F>, corners: &[Points<S::F>; 3]) -> Meets<S> {
        let doubt = in_doubt(s, own, slabs, corners);
        if S::DOUBLES && s.bits(doubt).count_ones() >= SIDE_BY_SIDE {
            return in_64_bits(s, own, corners, doubt);
        }
        let (zero, far) = (s.splat(0.0), s.splat(f32::INFINITY));
        Meets { met: s.lt(zero, zero), doubt: Some(doubt), t: s.sub(zero, far), u: far, v: zero }
    }

    /// Who only asks who is to be tested by itself is not served by the second step, which would be taken twice.
    #[inline(always)]
    fn may_meet<S: Simd>(&self, s: S, corners: &[Points<S::F>; 3]) -> u32 {
        s.bits(in_doubt(s, &splat_own(s, &self.own()), &EightSlabs::splat(s, self.slabs()), corners))
    }

    /// Nothing has to be asked about boxes.
    #[inline(always)]
    fn inside<S: Simd>(s: S, meets: &Meets<S>, _: &EightSlabs<S::F>, [tmin, tmax]: [S::F; 2], _: &[Points<S::F>; 3]) -> Hits<S> {
        let Meets { t, u, v, .. } = *meets;
        let inside = s.and(s.and(s.le(tmin, t), s.le(t, tmax)), s.le(s.abs(t), s.splat(f32::MAX)));
        let may_be_inside = s.bits(s.and(s.le(tmin, u), s.le(t, tmax)));
        Hits { hit: s.and(meets.met, inside), doubt: meets.doubt(s) & may_be_inside, t, u, v }
    }

    #[inline(always)]
    fn own(&self) -> Own<f32> {
        let ([x, y, z], o, d) = (self.axes(), self.origin, self.dir);
        [o[x], o[y], o[z], d[x], d[y], d[z], f32::from_bits(self.axes)]
    }

    #[inline(always)]
    fn own_of_eight<S: Simd>(s: S, rays: &Rays<S::F>) -> Own<S::F> {
        let (o, d, axes) = in_order(s, rays);
        [o.x, o.y, o.z, d.x, d.y, d.z, axes]
    }

    #[inline(always)]
    fn from_own(own: &Own<f32>, slabs: Slabs) -> Self {
        let axes = own[6].to_bits();
        let (mut origin, mut dir) = (Vec3::ZERO, Vec3::ZERO);
        for (i, axis) in AXES[axes as usize % 8].into_iter().enumerate() {
            (origin[axis], dir[axis]) = (own[i], own[3 + i]);
        }
        Self { origin, dir, axes, slabs }
    }
}

/// The first step of eight: those that are not missed for certain.
#[inline(always)]
fn in_doubt<S: Simd>(s: S, own: &Own<S::F>, slabs: &EightSlabs<S::F>, corners: &[Points<S::F>; 3]) -> S::M {
    let [a, b, c] = *corners;
    let (a, b, c) = (seen(s, own, a), seen(s, own, b), seen(s, own, c));
    let u = s.sub(s.mul(c[0], b[1]), s.mul(c[1], b[0]));
    let v = s.sub(s.mul(a[0], c[1]), s.mul(a[1], c[0]));
    let w = s.sub(s.mul(b[0], a[1]), s.mul(b[1], a[0]));
    let (least, greatest) = (s.min(s.min(u, v), w), s.max(s.max(u, v), w));
    let x = s.max(s.max(s.abs(a[0]), s.abs(b[0])), s.abs(c[0]));
    let y = s.max(s.max(s.abs(a[1]), s.abs(b[1])), s.abs(c[1]));
    let displaced = s.mul(s.splat(DISPLACED), s.sub(slabs.o_lo.x, slabs.o_hi.x));
    let bound = s.mul(displaced, s.add(s.max(x, y), displaced));
    s.or(s.le(s.sub(s.splat(0.0), bound), least), s.le(greatest, bound))
}

/// From so many on it pays to take the second step with all eight.
const SIDE_BY_SIDE: u32 = 3;

/// Three coordinates in 64 bits.
type Doubles<S> = [<S as Simd>::D; 3];

/// The second step for those of eight that are in doubt, by the operations of [`meet`]: which are met for certain and where,
/// and which are still in doubt.
#[inline(always)]
fn in_64_bits<S: Simd>(s: S, own: &Own<S::F>, corners: &[Points<S::F>; 3], doubt: S::M) -> Meets<S> {
    let &[ox, oy, oz, dx, dy, dz, _] = own;
    let (o, d) = (wide(s, Points { x: ox, y: oy, z: oz }), wide(s, Points { x: dx, y: dy, z: dz }));
    let [a, b, c] = *corners;
    let (a, b, c) = (wide(s, a), wide(s, b), wide(s, c));
    let (ab, bc, ca) = (less(s, b, a), less(s, c, b), less(s, a, c));
    let (a, b, c) = (less(s, a, o), less(s, b, o), less(s, c, o));
    let (u, v, w) = (dot(s, d, cross(s, b, bc)), dot(s, d, cross(s, c, ca)), dot(s, d, cross(s, a, ab)));
    let (of_a, of_b, of_c) = (sizes(s, a), sizes(s, b), sizes(s, c));
    let (of_ab, of_bc, of_ca) = (sizes(s, ab), sizes(s, bc), sizes(s, ca));
    let factor = s.splat_double(BOUND);
    let bound = s.mul_double(factor, sizes(s, d));
    let bounds = [
        s.mul_double(s.mul_double(bound, of_b), of_bc),
        s.mul_double(s.mul_double(bound, of_c), of_ca),
        s.mul_double(s.mul_double(bound, of_a), of_ab),
    ];
    let (size_u, size_v, size_w) = (s.abs_double(u), s.abs_double(v), s.abs_double(w));
    let certain = s.and(s.lt_double(bounds[0], size_u), s.and(s.lt_double(bounds[1], size_v), s.lt_double(bounds[2], size_w)));
    let zero = s.splat_double(0.0);
    let least = s.min_double(s.min_double(u, v), w);
    let most = s.max_double(s.max_double(u, v), w);
    let one_sign = s.or(s.lt_double(zero, least), s.lt_double(most, zero));
    let normal = cross(s, ca, ab);
    let (above, below) = (dot(s, a, normal), dot(s, d, normal));
    let of_above = s.mul_double(s.mul_double(s.mul_double(factor, of_a), of_ca), of_ab);
    let of_below = s.mul_double(s.mul_double(bound, of_ca), of_ab);
    let inverse = s.div_double(s.splat_double(1.0), below);
    let t = s.mul_double(above, inverse);
    let size_t = s.abs_double(t);
    let of_both = s.add_double(of_above, s.mul_double(size_t, of_below));
    let relative = s.mul_double(s.splat_double(2.0 * f64::EPSILON), size_t);
    let error = s.add_double(s.mul_double(s.mul_double(s.splat_double(2.0), of_both), s.abs_double(inverse)), relative);
    let (low, high) = (s.narrow(s.sub_double(t, error)), s.narrow(s.add_double(t, error)));
    let known = s.lt_double(s.mul_double(s.splat_double(2.0), of_below), s.abs_double(below));
    let sure = s.and(s.and(certain, known), s.eq(low, high));
    // Where signs are certain and differ, it is missed.
    let missed = s.and(certain, unlike(s, one_sign));
    let settled = s.or(sure, missed);
    // Where not even the divisor is known, t may be anything.
    let far = s.splat(f32::INFINITY);
    let (low, high) = (s.select(known, low, s.sub(s.splat(0.0), far)), s.select(known, high, far));
    Meets {
        met: s.and(doubt, s.and(sure, one_sign)),
        doubt: Some(s.and(doubt, unlike(s, settled))),
        t: low,
        u: s.select(settled, weight(s, v, inverse), high),
        v: weight(s, w, inverse),
    }
}

/// The weight of a corner, from 0 to 1.
#[inline(always)]
fn weight<S: Simd>(s: S, x: S::D, inverse: S::D) -> S::F {
    let share = s.max_double(s.mul_double(x, inverse), s.splat_double(0.0));
    s.narrow(s.min_double(share, s.splat_double(1.0)))
}

/// Where a mask does not hold.
#[inline(always)]
fn unlike<S: Simd>(s: S, m: S::M) -> S::M {
    let (zero, one) = (s.splat(0.0), s.splat(1.0));
    s.eq(s.select(m, one, zero), zero)
}

#[inline(always)]
fn wide<S: Simd>(s: S, p: Points<S::F>) -> Doubles<S> {
    [s.widen(p.x), s.widen(p.y), s.widen(p.z)]
}

#[inline(always)]
fn less<S: Simd>(s: S, a: Doubles<S>, b: Doubles<S>) -> Doubles<S> {
    [s.sub_double(a[0], b[0]), s.sub_double(a[1], b[1]), s.sub_double(a[2], b[2])]
}

#[inline(always)]
fn cross<S: Simd>(s: S, a: Doubles<S>, b: Doubles<S>) -> Doubles<S> {
    [
        s.sub_double(s.mul_double(a[1], b[2]), s.mul_double(b[1], a[2])),
        s.sub_double(s.mul_double(a[2], b[0]), s.mul_double(b[2], a[0])),
        s.sub_double(s.mul_double(a[0], b[1]), s.mul_double(b[0], a[1])),
    ]
}

#[inline(always)]
fn dot<S: Simd>(s: S, a: Doubles<S>, b: Doubles<S>) -> S::D {
    s.add_double(s.add_double(s.mul_double(a[0], b[0]), s.mul_double(a[1], b[1])), s.mul_double(a[2], b[2]))
}

/// As [`greatest`].
#[inline(always)]
fn sizes<S: Simd>(s: S, p: Doubles<S>) -> S::D {
    s.max_double(s.max_double(s.abs_double(p[0]), s.abs_double(p[1])), s.abs_double(p[2]))
}

/// Where eight corners are beside the ray, as [`Exact::surely_misses`] has it.
#[inline(always)]
fn seen<S: Simd>(s: S, own: &Own<S::F>, p: Points<S::F>) -> [S::F; 2] {
    let &[ox, oy, oz, dx, dy, dz, _] = own;
    let p = p.minus(s, Points { x: ox, y: oy, z: oz });
    [s.sub(s.mul(p.x, dz), s.mul(dx, p.z)), s.sub(s.mul(p.y, dz), s.mul(dy, p.z))]
}

impl Exact {
    /// The second and the third step, with the axes in the order of the first: so their operations are the same for one
    /// triangle and for eight.
    #[inline(always)]
    fn meet_for_certain(&self, tri: &[Vec3; 3], interval: [f32; 2]) -> Option<TriHit> {
        let (axes, [a, b, c]) = (self.axes(), *tri);
        let tri = [with_axes(a, axes), with_axes(b, axes), with_axes(c, axes)];
        meet(with_axes(self.origin, axes), with_axes(self.dir, axes), &tri, interval)
    }

    /// The first step.
    #[inline(always)]
    fn surely_misses(&self, tri: &[Vec3; 3]) -> bool {
        let (axes, o, [a, b, c]) = (self.axes(), self.origin, *tri);
        let d = with_axes(self.dir, axes);
        let (a, b, c) = (beside(with_axes(a - o, axes), d), beside(with_axes(b - o, axes), d), beside(with_axes(c - o, axes), d));
        let u = c.x * b.y - c.y * b.x;
        let v = a.x * c.y - a.y * c.x;
        let w = b.x * a.y - b.y * a.x;
        let (x, y) = (max(max(a.x.abs(), b.x.abs()), c.x.abs()), max(max(a.y.abs(), b.y.abs()), c.y.abs()));
        let displaced = DISPLACED * self.slabs.width_of_x();
        let bound = displaced * (max(x, y) + displaced);
        min(min(u, v), w) < -bound && bound < max(max(u, v), w)
    }
}

/// Where a corner is beside the ray, which both are seen from the ray's origin.
#[inline(always)]
fn beside(p: Vec3, d: Vec3) -> Vec2 {
    Vec2::new(p.x * d.z - d.x * p.z, p.y * d.z - d.y * p.z)
}

/// The bound of the second step, of the product of the three greatest components.
const BOUND: f64 = 64.0 * (f64::EPSILON / 2.0);

/// The greatest coordinate without its sign.
#[inline(always)]
fn greatest(p: DVec3) -> f64 {
    p.abs().max_element()
}

/// The second and the third step.
#[inline(never)]
fn meet(origin: Vec3, dir: Vec3, tri: &[Vec3; 3], [tmin, tmax]: [f32; 2]) -> Option<TriHit> {
    let (o, d) = (origin.as_dvec3(), dir.as_dvec3());
    let (a, b, c) = (tri[0].as_dvec3(), tri[1].as_dvec3(), tri[2].as_dvec3());
    // Before the origin is taken off: afterwards the edges would be rounded as the corners are.
    let (ab, bc, ca) = (b - a, c - b, a - c);
    let (a, b, c) = (a - o, b - o, c - o);
    let (u, v, w) = (d.dot(b.cross(bc)), d.dot(c.cross(ca)), d.dot(a.cross(ab)));
    let (of_a, of_b, of_c) = (greatest(a), greatest(b), greatest(c));
    let (of_ab, of_bc, of_ca) = (greatest(ab), greatest(bc), greatest(ca));
    let bound = BOUND * greatest(d);
    let bounds = [bound * of_b * of_bc, bound * of_c * of_ca, bound * of_a * of_ab];
    let certain = |value: f64, bound: f64| value.abs() > bound;
    let signs = if certain(u, bounds[0]) && certain(v, bounds[1]) && certain(w, bounds[2]) {
        [u, v, w]
    } else {
        let exactly = |[p, q]: [Vec3; 2]| side(origin, dir, p, q).sign();
        let [a, b, c] = *tri;
        [[b, c], [c, a], [a, b]].map(exactly)
    };
    let (least, most) = (signs[0].min(signs[1]).min(signs[2]), signs[0].max(signs[1]).max(signs[2]));
    if least < 0.0 && most > 0.0 || (least == 0.0 && most == 0.0) {
        return None;
    }
    let normal = ca.cross(ab);
    let (above, below) = (a.dot(normal), d.dot(normal));
    let (of_above, of_below) = (BOUND * of_a * of_ca * of_ab, bound * of_ca * of_ab);
    let inverse = 1.0 / below;
    let [low, high] = limits([above * inverse, of_above], [below, of_below], inverse);
    // Most of what is in doubt lies before the ray's begin, where it leaves a surface, or behind what was hit already.
    if high < tmin || tmax < low {
        return None;
    }
    let t = if low == high { low } else { exact_t(origin, dir, tri) };
    // Of a sliver seen edge on 64 bits may not even know the sign.
    let weight = |x: f64| narrow((x * inverse).clamp(0.0, 1.0));
    let (u, v) = if below.abs() > of_below { (weight(v), weight(w)) } else { (1.0 / 3.0, 1.0 / 3.0) };
    (t.is_finite() && tmin <= t && t <= tmax).then_some(TriHit { t, u, v })
}

/// What a quotient of a number with an error and a divisor with an error may be rounded to, at least and at most: `t` is
/// rounded twice.
#[inline(always)]
fn limits([t, of_above]: [f64; 2], [below, of_below]: [f64; 2], inverse: f64) -> [f32; 2] {
    if below.abs() <= 2.0 * of_below {
        return [f32::NEG_INFINITY, f32::INFINITY];
    }
    // Twice the first order covers the higher ones, as the divisor is at least half of what it seems.
    let error = 2.0 * (of_above + t.abs() * of_below) * inverse.abs() + 2.0 * f64::EPSILON * t.abs();
    [narrow(t - error), narrow(t + error)]
}

/// `d.((p - o) x (q - o))`.
fn side(o: Vec3, d: Vec3, p: Vec3, q: Vec3) -> Expansion<36> {
    let [o, d, p, q] = [o, d, p, q].map(|v| v.as_dvec3().to_array());
    let mut sum = Expansion::zero();
    sum.add_determinant(1.0, [d, p, q]);
    sum.add_determinant(-1.0, [d, o, q]);
    sum.add_determinant(-1.0, [d, p, o]);
    sum
}

/// The t of the plane, correctly rounded. The triangle is not seen edge on.
#[cold]
fn exact_t(origin: Vec3, dir: Vec3, tri: &[Vec3; 3]) -> f32 {
    let [o, d, a, b, c] = [origin, dir, tri[0], tri[1], tri[2]].map(|v| v.as_dvec3().to_array());
    let (mut above, mut below) = (Expansion::<48>::zero(), Expansion::<36>::zero());
    above.add_determinant(1.0, [a, b, c]);
    above.add_determinant(-1.0, [o, b, c]);
    above.add_determinant(-1.0, [a, o, c]);
    above.add_determinant(-1.0, [a, b, o]);
    below.add_determinant(1.0, [d, b, c]);
    below.add_determinant(-1.0, [d, b, a]);
    below.add_determinant(-1.0, [d, a, c]);
    let t = above.estimate() / below.estimate();
    let error = 16.0 * f64::EPSILON * t.abs();
    let (low, high) = (narrow(t - error), narrow(t + error));
    if low == high {
        return low;
    }
    // Two neighbours: which side of the middle between them is it on?
    let end = |x: f32| if x.is_finite() { f64::from(x) } else { TOO_LARGE.copysign(f64::from(x)) };
    let middle = 0.5 * (end(low) + end(high));
    let mut beyond = Expansion::<120>::zero();
    for part in above.parts() {
        beyond.add(*part);
    }
    beyond.add_scaled(&below, -middle);
    match beyond.sign() * below.sign() {
        side if side > 0.0 => high,
        side if side < 0.0 => low,
        _ if low.to_bits() & 1 == 0 => low,
        _ => high,
    }
}

/// What stands for infinity where 32-bit numbers are rounded: one step beyond the greatest.
const TOO_LARGE: f64 = (1u128 << 127) as f64 * 2.0;

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simd::{Kernel, LANES, Lanes, Road};

    /// Numbers at random (Steele, Lea and Flood 2014, SplitMix64).
    struct Random(u64);

    impl Random {
        fn unit(&mut self) -> f32 {
            self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
            let mut z = self.0;
            z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
            z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
            ((z ^ (z >> 31)) >> 40) as f32 / (1u32 << 24) as f32
        }

        fn in_cube(&mut self) -> Vec3 {
            Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
        }
    }

    /// Eight triangles.
    struct Look {
        ray: Exact,
        triangles: [[Vec3; 3]; LANES],
        interval: [f32; 2],
    }

    impl Kernel for Look {
        type Out = (u32, u32, [Lanes; 3]);

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Out {
            let axes = self.ray.axes();
            let corner = |k: usize| {
                let of = |axis: usize| s.load(&std::array::from_fn(|lane| self.triangles[lane][k][axis]));
                Points { x: of(axes[0]), y: of(axes[1]), z: of(axes[2]) }
            };
            let own = splat_own(s, &self.ray.own());
            let slabs = EightSlabs::splat(s, &self.ray.slabs.in_order(axes));
            let interval = self.interval.map(|t| s.splat(t));
            let hits = Exact::hit_eight(s, &own, &slabs, interval, &[corner(0), corner(1), corner(2)]);
            let store = |x: S::F| {
                let mut lanes = [0.0; LANES];
                s.store(x, &mut lanes);
                lanes
            };
            (s.bits(hits.hit), hits.doubt, [store(hits.t), store(hits.u), store(hits.v)])
        }
    }

    /// What eight are told for certain is to the bit what one is told; what is neither hit nor in doubt is missed.
    #[test]
    fn eight_side_by_side_are_as_one_by_one() {
        let mut random = Random(11);
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let (mut settled, mut left) = (0, 0);
        for round in 0..4000 {
            let origin = random.in_cube() * if round % 3 == 0 { 3.0 } else { 0.5 };
            let at = random.in_cube() * 0.5;
            let ray = Exact::prepare(&Ray::new(origin, at - origin), &bounds);
            // Around the point aimed at, from large to tiny; now and then a corner is hit to the bit.
            let size = [1.0, 1e-2, 1e-4][round % 3];
            let triangles = std::array::from_fn(|lane| {
                let away = (at - origin) * (lane as f32 * 0.1 - 0.3);
                let corners = [0; 3].map(|_| at + away + random.in_cube() * size);
                if round % 7 == 0 { [at + away, corners[1], corners[2]] } else { corners }
            });
            let interval = [0.0, if round % 2 == 0 { f32::INFINITY } else { 1.0 }];
            for road in Road::all() {
                let (hit, doubt, [t, u, v]) = road.run(Look { ray, triangles, interval });
                for lane in 0..LANES {
                    let alone = ray.hit(&triangles[lane], interval[0], interval[1]);
                    if hit >> lane & 1 == 1 {
                        let bits = |hit: TriHit| [hit.t, hit.u, hit.v].map(f32::to_bits);
                        assert_eq!(alone.map(bits), Some(bits(TriHit { t: t[lane], u: u[lane], v: v[lane] })));
                        settled += 1;
                    } else if doubt >> lane & 1 == 0 {
                        assert_eq!(alone, None, "{} {:?}", road.id(), triangles[lane]);
                    } else {
                        left += 1;
                    }
                }
            }
        }
        let wide = Road::all().len() > 1;
        assert!((settled > 1000 || !wide) && left > 100, "{settled} settled side by side, {left} left in doubt");
    }
}
