//! How far off each ray-triangle test may be: forward error bounds, worked out in 64 bits for one ray and one
//! triangle. docs/stability.md derives them.
//!
//! With `A`, `B`, `C` the corners seen from the ray's origin and `d` its direction, a test decides by the signs of
//! `d.(B x C)`, `d.(C x A)`, `d.(A x B)`. Its decision is certain where each of the three is farther from zero than
//! its bound; t, before it is brought into the interval of the triangle's box, is then within its bound as well.

use super::TestKind;
use super::baldwin_weber::{Number, Transformation};
use crate::geometry::Ray;
use crate::geometry::num::UNIT_ROUNDOFF;
use glam::{DVec3, Vec3};

/// See above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    /// Of `d.(B x C)`, `d.(C x A)` and `d.(A x B)`.
    pub sides: [f64; 3],
    /// Of t; infinite if the triangle may be seen edge on.
    pub t: f64,
}

/// u.
const U: f64 = UNIT_ROUNDOFF as f64;

/// The bounds of a test, for a ray of the scaled space and a triangle.
pub fn bounds(test: TestKind, ray: &Ray, tri: &[Vec3; 3]) -> Bounds {
    let (d, corners) = (ray.dir.as_dvec3(), tri.map(|p| p.as_dvec3() - ray.origin.as_dvec3()));
    match test {
        TestKind::Exact => Bounds { sides: [0.0; 3], t: 0.0 },
        TestKind::Fast => fast(d, corners),
        TestKind::Watertight => watertight(d, corners),
        TestKind::Double => double(d, corners),
        TestKind::BaldwinWeber => baldwin_weber(ray, tri),
    }
}

/// The sum of the six products of a determinant, without their signs.
fn permanent(x: DVec3, y: DVec3, z: DVec3) -> f64 {
    let (x, y, z) = (x.abs(), y.abs(), z.abs());
    x.x * (y.y * z.z + y.z * z.y) + x.y * (y.z * z.x + y.x * z.z) + x.z * (y.x * z.y + y.y * z.x)
}

/// Möller and Trumbore: each determinant is a sum of six products with seven roundings each; the third weight is one
/// less the others, whose quotients are rounded three times each.
fn fast(d: DVec3, [a, b, c]: [DVec3; 3]) -> Bounds {
    const SEVEN: f64 = 7.01 * U;
    let (e1, e2) = (b - a, c - a);
    let whole = SEVEN * permanent(d, e1, e2);
    let (of_b, of_c) = (SEVEN * permanent(d, a, e2), SEVEN * permanent(d, a, e1));
    let (v, w, det) = (d.dot(c.cross(a)), d.dot(a.cross(b)), d.dot(e1.cross(e2)));
    let of_a = of_b + of_c + whole + 6.0 * U * (v.abs() + w.abs());
    let sides = [of_a, of_b, of_c];
    if det.abs() <= whole {
        return Bounds { sides: [f64::INFINITY; 3], t: f64::INFINITY };
    }
    let t = a.dot(b.cross(c)) / det;
    let of_t = (SEVEN * permanent(a, e1, e2) + t.abs() * whole) / (det.abs() - whole) + 3.01 * U * t.abs();
    Bounds { sides, t: of_t }
}

/// Woop, Benthin and Wald: moving and shearing displaces each corner, the signs are right for what is displaced; the
/// values that t is weighted with are rounded besides.
fn watertight(d: DVec3, corners: [DVec3; 3]) -> Bounds {
    let z = if d.x.abs() > d.y.abs() && d.x.abs() > d.z.abs() {
        0
    } else if d.y.abs() > d.z.abs() {
        1
    } else {
        2
    };
    let (x, y) = ((z + 1) % 3, (z + 2) % 3);
    let shear = |p: DVec3| [p[x] - d[x] / d[z] * p[z], p[y] - d[y] / d[z] * p[z]];
    let at = corners.map(shear);
    let depth = corners.map(|p| p[z]);
    // A rounded difference, three roundings of the product, the last difference.
    let displaced = |i: usize| {
        let p = corners[i];
        let of = |k: usize, seen: f64| 1.01 * U * (p[k].abs() + 4.0 * (d[k] / d[z] * p[z]).abs() + seen.abs());
        [of(x, at[i][0]), of(y, at[i][1])]
    };
    let moved = [displaced(0), displaced(1), displaced(2)];
    let (mut sides, mut values, mut sizes) = ([0.0; 3], [0.0; 3], [0.0; 3]);
    for side in 0..3 {
        let (p, q) = ((side + 1) % 3, (side + 2) % 3);
        let [[px, py], [qx, qy]] = [at[p], at[q]];
        let [[pdx, pdy], [qdx, qdy]] = [moved[p], moved[q]];
        let of_sign = pdx * (qy.abs() + qdy) + qdy * px.abs() + pdy * (qx.abs() + qdx) + qdx * py.abs();
        sides[side] = of_sign * d[z].abs();
        values[side] = of_sign + 3.01 * U * ((px * qy).abs() + (py * qx).abs() + of_sign);
        sizes[side] = (px * qy - py * qx).abs();
    }
    let det: f64 = d.dot((corners[1] - corners[0]).cross(corners[2] - corners[0])) / d[z];
    let whole: f64 = values.iter().sum::<f64>() + 2.01 * U * sizes.iter().sum::<f64>();
    if det.abs() <= whole {
        return Bounds { sides, t: f64::INFINITY };
    }
    let t = corners[0].dot(corners[1].cross(corners[2])) / (det * d[z]);
    let seen = t * d[z];
    // What is wrong with the weights moves t by how far each corner is from where the ray meets the plane.
    let weights: f64 = (0..3).map(|i| values[i] * (depth[i] - seen).abs()).sum();
    let rounded: f64 = (0..3).map(|i| (sizes[i] + values[i]) * (5.0 * depth[i].abs() + 3.0 * seen.abs())).sum::<f64>() * U;
    let of_t = ((weights + rounded) / (det.abs() - whole) + 5.05 * U * seen.abs()) / d[z].abs();
    Bounds { sides, t: of_t }
}

/// 64 bits throughout: at most nine roundings in each of six terms of a determinant, and t is rounded once to 32.
fn double(d: DVec3, [a, b, c]: [DVec3; 3]) -> Bounds {
    const OF_64: f64 = 64.0 * (f64::EPSILON / 2.0);
    let [of_a, of_b, of_c] = [a, b, c].map(|p| p.abs().max_element());
    let long = OF_64 * d.abs().max_element();
    let sides = [long * of_b * of_c, long * of_c * of_a, long * of_a * of_b];
    let values = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
    let det: f64 = values.iter().sum();
    let whole = sides.iter().sum::<f64>() + 2.0 * f64::EPSILON * values.iter().map(|v| v.abs()).sum::<f64>();
    if det.abs() <= 2.0 * whole {
        return Bounds { sides, t: f64::INFINITY };
    }
    let t = a.dot(b.cross(c)) / det;
    Bounds { sides, t: 2.0 * (OF_64 * of_a * of_b * of_c + t.abs() * whole) / det.abs() + 1.01 * U * t.abs() + TINY }
}

/// Baldwin and Weber: the error is carried along with the operations of the test. It may be as large as one likes for
/// slivers, of which the stored transformation is hardly known.
fn baldwin_weber(ray: &Ray, tri: &[Vec3; 3]) -> Bounds {
    let axis = Transformation::<f32>::new(tri).axis as usize;
    let [t, u, v] = Transformation::<Rounded>::along(tri, |_| axis).meet(ray.origin, ray.dir);
    // Of the points as they are: seen from a far origin, a tiny triangle has no edges in 64 bits either.
    let [a, b, c] = tri.map(|p| p.as_dvec3());
    let det = ray.dir.as_dvec3().dot((b - a).cross(c - a)).abs();
    let side = |error: f64| if error.is_finite() { error * det } else { f64::INFINITY };
    let third = u.error + v.error + U * (u.value + v.value).abs();
    let of_t = if t.error.is_finite() { t.error } else { f64::INFINITY };
    Bounds { sides: [side(third), side(u.error), side(v.error)], t: of_t }
}

/// Half of the least denormal number of 32 bits, which a result may be off by however small it is.
const TINY: f64 = 0.5 / (1u128 << 126) as f64 / (1u32 << 23) as f64;

/// A number, and how far off it may be if it is worked out in 32 bits.
#[derive(Clone, Copy)]
struct Rounded {
    value: f64,
    error: f64,
}

impl Rounded {
    /// Rounded once more.
    fn once_more(value: f64, error: f64) -> Self {
        Self { value, error: error + 1.01 * U * (value.abs() + error) + TINY }
    }
}

impl Number for Rounded {
    fn of(x: f32) -> Self {
        Self { value: f64::from(x), error: 0.0 }
    }

    fn plus(self, other: Self) -> Self {
        Self::once_more(self.value + other.value, self.error + other.error)
    }

    fn minus(self, other: Self) -> Self {
        Self::once_more(self.value - other.value, self.error + other.error)
    }

    fn times(self, other: Self) -> Self {
        let error = self.value.abs() * other.error + other.value.abs() * self.error + self.error * other.error;
        Self::once_more(self.value * other.value, error)
    }

    fn over(self, other: Self) -> Self {
        let (value, least) = (self.value / other.value, other.value.abs() - other.error);
        let error = if least > 0.0 { (self.error + value.abs() * other.error) / least } else { f64::INFINITY };
        Self::once_more(value, error)
    }

    fn size(self) -> f64 {
        self.value.abs()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Found by the stability lab: seen from the ray's origin the triangle had no area in 64 bits, and its bounds were 0, where
    /// baldwin-weber hits it by underflow alone.
    #[test]
    fn a_tiny_triangle_far_away_has_bounds() {
        let (x, y) = (4.1788916e-22, 4.1788916e-23);
        let tri = [Vec3::new(x, 0.0, y), Vec3::new(y, x, 0.0), Vec3::new(0.0, y, x)];
        let origin = Vec3::new(-0.15030468, -1.2171865, -1.4570856);
        let dir = Vec3::new(0.15030476, 1.2171866, 1.4570856);
        let bounds = bounds(TestKind::BaldwinWeber, &Ray::new(origin, dir), &tri);
        assert!(Transformation::<f32>::new(&tri).hit(origin, dir).is_some(), "by underflow");
        assert!(bounds.sides.iter().all(|side| *side > 1e-43), "{bounds:?}");
    }
}
