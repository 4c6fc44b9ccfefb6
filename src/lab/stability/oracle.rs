//! What a ray meets, exactly: in 64 bits where those decide, and else with [`Dyadic`] numbers.

use super::dyadic::{Dyadic, Exactly, determinant, minus};
use crate::geometry::num::narrow;
use crate::geometry::tri::TestKind;
use crate::geometry::tri::bounds::bounds;
use crate::geometry::{Aabb, Ray, Slabs};
use crate::scene::{Geometry, PrimRef};
use glam::{DVec3, Vec3};

/// How the line of a ray passes a triangle that it meets or nearly meets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passing {
    /// The triangle.
    pub prim: PrimRef,
    /// `d.(B x C)`, `d.(C x A)`, `d.(A x B)` of the corners seen from the origin; see [`crate::geometry::tri::bounds`].
    pub sides: [f64; 3],
    /// Their exact signs.
    pub signs: [i8; 3],
    /// Where it meets the plane, within a few units of the last place of 64 bits, and correctly rounded to 32; `None`
    /// in the plane or parallel to it.
    pub t: Option<(f64, f32)>,
}

impl Passing {
    /// Whether the triangle, with its edges and corners, is met; not if the ray lies in its plane.
    pub fn meets(&self) -> bool {
        let [least, greatest] = [self.signs.iter().min(), self.signs.iter().max()].map(|s| s.copied().unwrap_or(0));
        self.t.is_some() && (least >= 0 || greatest <= 0)
    }

    /// Whether it goes through an edge or a corner, or lies in the plane, to the bit.
    pub fn is_boundary(&self) -> bool {
        self.t.is_none() || (self.meets() && self.signs.contains(&0))
    }
}

/// Of each product of three components: what 64 bits may be off by.
const OF_64: f64 = 64.0 * (f64::EPSILON / 2.0);

/// More than the bound of a side of the tests whose bounds are relative to it, of the greatest components of the ray's direction and of the corners: 43 u for
/// each of the three determinants of the fast test, whose edges are up to twice as long, and as much again.
const OF_ANY_TEST: f64 = 1024.0 * crate::geometry::num::UNIT_ROUNDOFF as f64;

/// All triangles that a ray of the scaled space passes so closely that some test might meet them.
pub fn passings(geometry: &Geometry, ray: &Ray) -> Vec<Passing> {
    passings_of(geometry, ray, (0..geometry.live_count()).map(|i| geometry.live(i)))
}

/// The same of some triangles.
pub fn passings_of(geometry: &Geometry, ray: &Ray, prims: impl Iterator<Item = PrimRef>) -> Vec<Passing> {
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let (long, slabs) = (d.abs().max_element(), Slabs::new(ray, geometry.bounds()));
    let close = |prim: PrimRef| {
        let tri = geometry.corners(prim);
        let [a, b, c] = tri.map(|p| p.as_dvec3() - o);
        let sides = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
        let size = a.abs().max(b.abs()).max(c.abs()).max_element();
        let (least, greatest) = (sides[0].min(sides[1]).min(sides[2]), sides[0].max(sides[1]).max(sides[2]));
        let near = OF_ANY_TEST * long * size * size;
        // What a test may report beyond that is still in the triangle's box.
        let reported = || {
            let (entry, exit) = slabs.interval(&Aabb::of_triangle(&tri));
            entry <= exit
        };
        (least >= -near || greatest <= near || reported()).then(|| passing(ray, prim, &tri))
    };
    prims.filter_map(close).collect()
}

fn passing(ray: &Ray, prim: PrimRef, tri: &[Vec3; 3]) -> Passing {
    let (o, d, points) = (ray.origin.as_dvec3(), ray.dir.as_dvec3(), tri.map(|p| p.as_dvec3()));
    let corners = points.map(|p| p - o);
    // From a corner along the edge to the next: `d.(B x C) = d.(B x (C - B))`, and its error is as small as the edge.
    let edge = |i: usize, j: usize| points[j] - points[i];
    let size = |p: DVec3| p.abs().max_element();
    let side = |i: usize, j: usize| {
        let edge = edge(i, j);
        (d.dot(corners[i].cross(edge)), OF_64 * size(d) * size(corners[i]) * size(edge))
    };
    let found = [side(1, 2), side(2, 0), side(0, 1)];
    let sides = found.map(|(value, _)| value);
    let (x, y) = (edge(0, 1), edge(0, 2));
    let normal = x.cross(y);
    let (above, below) = (corners[0].dot(normal), d.dot(normal));
    let of_above = OF_64 * size(corners[0]) * size(x) * size(y);
    let of_below = OF_64 * size(d) * size(x) * size(y);
    if found.iter().all(|(value, error)| value.abs() > *error) && below.abs() > 4.0 * of_below {
        let t = above / below;
        let of_t = 2.0 * (of_above + t.abs() * of_below) / below.abs() + f64::EPSILON * t.abs();
        let rounded = narrow(t);
        if narrow(t - of_t) == narrow(t + of_t) {
            return Passing { prim, sides, signs: sides.map(|s| s.signum() as i8), t: Some((t, rounded)) };
        }
    }
    exactly(ray, prim, tri)
}

/// Without any rounding but the last.
fn exactly(ray: &Ray, prim: PrimRef, tri: &[Vec3; 3]) -> Passing {
    let of = |v: Vec3| -> Exactly { v.as_dvec3().to_array().map(Dyadic::new) };
    let (o, d) = (of(ray.origin), of(ray.dir));
    let [a, b, c] = tri.map(|p| minus(&of(p), &o));
    let sides = [determinant(&d, &b, &c), determinant(&d, &c, &a), determinant(&d, &a, &b)];
    let (above, below) = (determinant(&a, &b, &c), &(&sides[0] + &sides[1]) + &sides[2]);
    let one = Dyadic::new(1.0);
    let t = (below.sign() != 0).then(|| (above.over(&below), rounded(&above, &below)));
    Passing { prim, signs: sides.each_ref().map(Dyadic::sign), sides: sides.each_ref().map(|s| s.over(&one)), t }
}

/// The quotient, correctly rounded to 32 bits.
fn rounded(above: &Dyadic, below: &Dyadic) -> f32 {
    let near = narrow(above.over(below));
    // One of three neighbours: the one whose half steps to either side hold the quotient.
    let beyond = |middle: f64| {
        let difference = above - &(below * &Dyadic::new(middle));
        difference.sign() * below.sign()
    };
    let step = |x: f32| if x.is_finite() { f64::from(x) } else { 2.0f64.powi(128).copysign(f64::from(x)) };
    for x in [near, near.next_down(), near.next_up()] {
        let (low, high) = (0.5 * (step(x.next_down()) + step(x)), 0.5 * (step(x) + step(x.next_up())));
        let even = x.to_bits() & 1 == 0;
        let (from_low, from_high) = (beyond(low), beyond(high));
        if (from_low > 0 || (from_low == 0 && even)) && (from_high < 0 || (from_high == 0 && even)) {
            return x;
        }
    }
    near
}

/// A triangle that a test may report, and the t that it may report for it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Candidate {
    /// The triangle.
    pub prim: PrimRef,
    /// Whether it must: no bound reaches an edge, or an end of the ray's interval.
    pub clear: bool,
    /// The least t.
    pub low: f64,
    /// The greatest.
    pub high: f64,
    /// The exact one, if there is one.
    pub t: Option<f64>,
}

/// What a test may report of a triangle; `None` if it surely misses it or its interval.
pub fn candidate(test: TestKind, ray: &Ray, slabs: &Slabs, tri: &[Vec3; 3], passing: &Passing) -> Option<Candidate> {
    let (from, to) = (f64::from(ray.tmin), f64::from(ray.tmax));
    if test == TestKind::Exact {
        let (t, rounded) = passing.t.filter(|_| passing.meets())?;
        let at = f64::from(rounded);
        return (from <= at && at <= to && at.is_finite()).then_some(Candidate {
            prim: passing.prim,
            clear: true,
            low: at,
            high: at,
            t: Some(t),
        });
    }
    let bounds = bounds(test, ray, tri);
    let [mut above, mut below, mut near] = [false; 3];
    for (side, bound) in passing.sides.into_iter().zip(bounds.sides) {
        above |= side > bound;
        below |= side < -bound;
        near |= side.abs() <= bound;
    }
    if above && below {
        return None;
    }
    let (entry, exit) = slabs.interval(&Aabb::of_triangle(tri));
    let (entry, exit) = (f64::from(entry), f64::from(exit));
    if entry > exit {
        return None;
    }
    // t is brought into the interval of the box, and so are its bounds.
    let (t, low, high) = match passing.t {
        Some((t, _)) if bounds.t.is_finite() => (Some(t), (t - bounds.t).clamp(entry, exit), (t + bounds.t).clamp(entry, exit)),
        Some((t, _)) => (Some(t), entry, exit),
        None => (None, entry, exit),
    };
    if high < from || to < low {
        return None;
    }
    let clear = !near && passing.t.is_some() && from <= low && high <= to;
    Some(Candidate { prim: passing.prim, clear, low, high, t })
}

#[cfg(test)]
mod tests {
    use super::super::cases;
    use super::*;
    use crate::scene::LoadCx;

    /// What 64 bits decide is what big integers say, on every case.
    #[test]
    fn the_filter_says_what_is_exact() {
        let mut passed = 0;
        for case in cases::ALL {
            let trial = case.trial(5, 40);
            let geometry = Geometry::new(&trial.scene(case.id), &LoadCx::unattended()).expect("small");
            for ray in trial.rays.iter().filter(|ray| ray.is_valid()).take(40) {
                let ray = geometry.space().enter(ray).ray;
                for passing in passings(&geometry, &ray).into_iter().take(20) {
                    let exact = exactly(&ray, passing.prim, &geometry.corners(passing.prim));
                    assert_eq!(passing.signs, exact.signs, "{}: {ray:?}", case.id);
                    let rounded = |p: &Passing| p.t.map(|(_, rounded)| rounded.to_bits());
                    assert_eq!(rounded(&passing), rounded(&exact), "{}: {ray:?}", case.id);
                    passed += 1;
                }
            }
        }
        assert!(passed > 5000, "{passed}");
    }
}
