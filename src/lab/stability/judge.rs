//! Whether what a structure reports for a ray may be true: the rules of docs/stability.md.

use super::oracle::{Candidate, Passing, candidate};
use crate::accel::Hit;
use crate::geometry::space::Back;
use crate::geometry::tri::TestKind;
use crate::geometry::{Ray, Slabs};
use crate::scene::{Geometry, PrimRef};
use glam::{DVec3, Vec3};

/// What a test may report of one ray.
#[derive(Clone, Debug, PartialEq)]
pub struct Expected {
    /// Those that may be the closest; of the exact test just one.
    acceptable: Vec<Candidate>,
    /// Whether nothing may be reported.
    may_miss: bool,
    /// On a closed surface something must be reported up to here.
    must_by: f64,
    /// What is not a matter of rounding: the triangle, or a miss; `None` if rounding decides.
    pub clear: Option<Option<PrimRef>>,
    /// Whether the line goes through an edge or a corner of what it may hit, or lies in its plane, to the bit.
    pub boundary: bool,
}

/// What is found wrong with an answer.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Wrong {
    /// Another triangle than the only one that is possible, or none, or one where there is none.
    Clear,
    /// The triangle is right, its t is not.
    ClearT,
    /// None of those that rounding allows.
    Boundary,
    /// A closed surface let the ray through.
    Slipped,
}

impl Wrong {
    /// Whether no rounding was in the way.
    pub const fn is_clear(self) -> bool {
        matches!(self, Self::Clear | Self::ClearT)
    }
}

/// What a test may report of a ray of the scaled space that passes those triangles.
pub fn expected(test: TestKind, geometry: &Geometry, closed: bool, ray: &Ray, passings: &[Passing]) -> Expected {
    let slabs = Slabs::new(ray, geometry.bounds());
    let of = |passing: &Passing| candidate(test, ray, &slabs, &geometry.corners(passing.prim), passing);
    let candidates: Vec<Candidate> = passings.iter().filter_map(of).collect();
    let limit = candidates.iter().filter(|c| c.clear).map(|c| c.high).fold(f64::INFINITY, f64::min);
    let may_miss = limit == f64::INFINITY;
    let mut acceptable: Vec<Candidate> = candidates.iter().filter(|c| c.low <= limit).copied().collect();
    if test == TestKind::Exact {
        let first = acceptable.iter().min_by_key(|c| c.prim).copied();
        acceptable.clear();
        acceptable.extend(first);
    }
    let clear = match acceptable[..] {
        [] => Some(None),
        [only] if only.clear => Some(Some(only.prim)),
        _ => None,
    };
    let is_acceptable = |p: &Passing| acceptable.iter().any(|c| c.prim == p.prim);
    let boundary = passings.iter().any(|p| p.is_boundary() && is_acceptable(p));
    let must_by = if closed && clear.is_none() { must_by(geometry, ray, passings, &candidates) } else { f64::INFINITY };
    Expected { acceptable, may_miss, must_by, clear, boundary }
}

/// Where a ray cannot pass a closed surface: if all lines around it, as far off as rounding may put a corner, meet the
/// surface where the ray does, then one of its triangles there has to be hit.
fn must_by(geometry: &Geometry, ray: &Ray, passings: &[Passing], candidates: &[Candidate]) -> f64 {
    const AROUND: u32 = 16;
    let (from, to) = (f64::from(ray.tmin), f64::from(ray.tmax));
    let inside = |t: f64| from <= t && t <= to;
    let first = passings.iter().filter(|p| p.meets()).filter_map(|p| Some((p.t?.0, p.prim))).filter(|(t, _)| inside(*t));
    let Some((_, prim)) = first.min_by(|a, b| a.0.total_cmp(&b.0)) else { return f64::INFINITY };
    let Some(at) = candidates.iter().find(|c| c.prim == prim) else { return f64::INFINITY };
    let there: Vec<&Candidate> = candidates.iter().filter(|c| c.low <= at.high && at.low <= c.high).collect();
    let high = there.iter().map(|c| c.high).fold(at.high, f64::max);
    if there.iter().any(|c| c.low < from || to < c.high) {
        return f64::INFINITY;
    }
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let Some(along) = d.try_normalize() else { return f64::INFINITY };
    let x = along.any_orthonormal_vector();
    let y = along.cross(x);
    let bounds = geometry.bounds();
    let reach = (bounds.max - ray.origin).abs().max((bounds.min - ray.origin).abs()).max_element();
    let far = 24.0 * f64::from(crate::geometry::num::UNIT_ROUNDOFF) * f64::from(reach);
    let covered = |radius: f64| {
        (0..AROUND).all(|i| {
            let (sin, cos) = (f64::from(i) / f64::from(AROUND) * std::f64::consts::TAU + 0.1).sin_cos();
            let origin = o + (x * cos + y * sin) * radius;
            there.iter().any(|c| meets(origin, d, &geometry.corners(c.prim)))
        })
    };
    if covered(far) && covered(far / 16.0) { high } else { f64::INFINITY }
}

/// Whether a line meets a triangle, in 64 bits.
fn meets(origin: DVec3, d: DVec3, tri: &[Vec3; 3]) -> bool {
    let [a, b, c] = tri.map(|p| p.as_dvec3() - origin);
    let sides = [d.dot(b.cross(c)), d.dot(c.cross(a)), d.dot(a.cross(b))];
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}

impl Expected {
    /// Whether the triangle that was reported has a stated t, and how many units of the last place it is off; nothing
    /// to say of a right miss.
    ///
    /// # Errors
    /// What is wrong.
    pub fn judge(&self, geometry: &Geometry, back: &Back, hit: Option<&Hit>) -> Result<Option<f64>, Wrong> {
        let wrong = if self.clear.is_some() { Wrong::Clear } else { Wrong::Boundary };
        let Some(hit) = hit else {
            return match self {
                Self { may_miss: true, must_by: f64::INFINITY, .. } => Ok(None),
                Self { must_by, .. } if must_by.is_finite() => Err(Wrong::Slipped),
                _ => Err(wrong),
            };
        };
        let prim = geometry.flat(hit.instance, hit.primitive);
        let Some(candidate) = self.acceptable.iter().find(|c| Some(c.prim) == prim) else { return Err(wrong) };
        // Written in the world, t was rounded again.
        let t = f64::from(back.scaled_t(hit.t));
        let spare = back.rounding(hit.t);
        if t < candidate.low - spare || candidate.high + spare < t {
            return Err(if self.clear.is_some() { Wrong::ClearT } else { Wrong::Boundary });
        }
        if t > self.must_by + spare {
            return Err(Wrong::Slipped);
        }
        Ok(candidate.t.filter(|_| candidate.clear && spare == 0.0).map(|exact| (t - exact).abs() / ulp(exact)))
    }
}

/// The distance between neighbours among 32-bit floats near `x`.
fn ulp(x: f64) -> f64 {
    let x = crate::geometry::num::narrow(x.abs());
    f64::from(x.next_up()) - f64::from(x)
}

#[cfg(test)]
mod tests {
    use super::super::cases;
    use super::super::oracle::passings;
    use super::*;
    use crate::accel::{BuildCx, Mode, registry};
    use crate::scene::LoadCx;
    use crate::task::Cancel;

    /// Judges the answers of brute force after something was done to them; how many are wrong, of how many.
    fn wrong(case: &str, test: TestKind, spoil: impl Fn(usize, &mut Option<Hit>)) -> (usize, usize) {
        let trial = cases::find(case).expect("a case").trial(11, 600);
        let geometry = std::sync::Arc::new(Geometry::new(&trial.scene(case), &LoadCx::unattended()).expect("small"));
        let entry = &registry::ALL[0];
        let accel = entry.build(&geometry, test, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
        let mut hits = vec![None; trial.rays.len()];
        accel.trace(&trial.rays, Mode::Closest, &mut hits, &Cancel::new()).expect("not cancelled");
        let mut wrong = 0;
        for (i, (ray, hit)) in trial.rays.iter().zip(&mut hits).enumerate() {
            spoil(i, hit);
            let entered = geometry.space().enter(ray);
            let expected = expected(test, &geometry, trial.closed, &entered.ray, &passings(&geometry, &entered.ray));
            wrong += usize::from(expected.judge(&geometry, &entered.back, hit.as_ref()).is_err());
        }
        (wrong, hits.len())
    }

    #[test]
    fn what_is_right_is_called_right() {
        for test in [TestKind::Watertight, TestKind::Exact] {
            assert_eq!(wrong("shared-edges", test, |_, _| ()).0, 0);
        }
    }

    #[test]
    fn every_lost_hit_of_a_closed_surface_is_noticed() {
        // Each ray aims at the surface, from outside at its silhouette now and then.
        let (found, of) = wrong("shared-edges", TestKind::Watertight, |_, hit| *hit = None);
        assert!(found * 100 >= of * 95, "{found} of {of}");
    }

    #[test]
    fn another_triangle_is_noticed() {
        let (found, of) = wrong("shared-edges", TestKind::Exact, |_, hit| {
            if let Some(hit) = hit {
                hit.primitive ^= 1;
            }
        });
        assert!(found * 100 >= of * 95, "{found} of {of}");
    }

    #[test]
    fn a_t_that_is_a_little_off_is_noticed() {
        let nudge = |steps: u32| {
            move |_: usize, hit: &mut Option<Hit>| {
                if let Some(hit) = hit {
                    hit.t = f32::from_bits(hit.t.to_bits() + steps);
                }
            }
        };
        let (found, of) = wrong("shared-edges", TestKind::Exact, nudge(1));
        assert!(found * 100 >= of * 95, "{found} of {of}");
        let (found, of) = wrong("shared-edges", TestKind::Watertight, nudge(64));
        assert!(found * 100 >= of * 80, "{found} of {of}");
    }
}
