//! Bicubic Bezier patches.

use glam::{DVec3, DVec4, Vec3};

/// The 16 control points, in rows: `points[r][c]`, where `u` runs over rows and `v` along them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch(pub [[DVec3; 4]; 4]);

/// A parameter `i / n`. Kept as a fraction, so that from the other end it is the same number:
/// `(n - i) / n` is rounded once, `1 - i / n` twice.
#[derive(Clone, Copy, Debug)]
pub(super) struct Fraction {
    pub i: u32,
    pub n: u32,
}

impl Fraction {
    /// What the four control points weigh at this parameter, and how fast that changes.
    fn weights(self) -> (DVec4, DVec4) {
        let t = f64::from(self.i) / f64::from(self.n);
        let s = f64::from(self.n - self.i) / f64::from(self.n);
        let value = DVec4::new(s * s * s, 3.0 * (s * s * t), 3.0 * (t * t * s), t * t * t);
        let (ss, st, tt) = (3.0 * s * s, 6.0 * s * t, 3.0 * t * t);
        (value, DVec4::new(-ss, ss - st, st - tt, tt))
    }
}

/// The outer two and the inner two first: the sum is the same to the bit when both lists are
/// reversed, so that two patches which run along their common edge in opposite directions agree.
fn weighted(weights: DVec4, points: [DVec3; 4]) -> DVec3 {
    (points[0] * weights.x + points[3] * weights.w) + (points[1] * weights.y + points[2] * weights.z)
}

impl Patch {
    fn blend(&self, u: DVec4, v: DVec4) -> DVec3 {
        weighted(u, self.0.map(|row| weighted(v, row)))
    }

    /// The point of the surface. On an edge it depends on the four control points of that edge
    /// alone, as every other weight is exactly 0.
    pub fn point(&self, u: Fraction, v: Fraction) -> Vec3 {
        // Adding 0 turns -0 into 0: neighbours that mirror each other agree to the bit.
        (self.blend(u.weights().0, v.weights().0) + DVec3::ZERO).as_vec3()
    }

    /// The unit normal, to the side from which `u` to `v` turns anticlockwise.
    ///
    /// Where the first row is a single point the derivative along it is 0 there. Close by it is
    /// `u` times the mixed derivative, which points the same way.
    pub fn normal(&self, u: Fraction, v: Fraction) -> Vec3 {
        let ((u, du), (v, dv)) = (u.weights(), v.weights());
        let down = self.blend(du, v);
        let normal = match self.blend(u, dv) {
            along if along.length_squared() > 1e-18 => down.cross(along),
            _ => down.cross(self.blend(du, dv)),
        };
        normal.try_normalize().unwrap_or(DVec3::Z).as_vec3()
    }

    /// Whether the first row is a single point.
    pub fn begins_in_a_point(&self) -> bool {
        self.0[0].iter().all(|p| *p == self.0[0][0])
    }

    /// Every control point moved by `to`.
    pub fn map(&self, to: impl Fn(DVec3) -> DVec3) -> Self {
        Self(self.0.map(|row| row.map(&to)))
    }

    /// The same surface seen from its other side: the rows read backwards.
    pub fn turned_over(&self) -> Self {
        Self(self.0.map(|[a, b, c, d]| [d, c, b, a]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn bowl() -> Patch {
        let at = |r: u8, c: u8| DVec3::new(f64::from(c) * 0.31, f64::from(r) * 0.77, f64::from(r * c) * 0.13);
        Patch(std::array::from_fn(|r| std::array::from_fn(|c| at(r as u8, c as u8))))
    }

    #[test]
    fn edges_do_not_depend_on_the_direction() {
        let (patch, over) = (bowl(), bowl().turned_over());
        for i in 0..=7 {
            let (u, v, back) = (Fraction { i: 3, n: 7 }, Fraction { i, n: 7 }, Fraction { i: 7 - i, n: 7 });
            assert_eq!(patch.point(u, v), over.point(u, back));
        }
    }

    #[test]
    fn the_normal_is_that_of_differences() {
        let (patch, n) = (bowl(), 1 << 12);
        let (u, v) = (Fraction { i: 1000, n }, Fraction { i: 2500, n });
        let at = |i, j| patch.point(Fraction { i, n }, Fraction { i: j, n }).as_dvec3();
        let differences = (at(1100, 2500) - at(900, 2500)).cross(at(1000, 2600) - at(1000, 2400));
        assert!(patch.normal(u, v).as_dvec3().angle_between(differences) < 1e-3);
    }
}
