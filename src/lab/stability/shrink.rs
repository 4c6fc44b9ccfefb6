//! The smallest scene that still fails: halves, then quarters, and so on are left out as long as the ray is answered
//! wrongly without them (Zeller and Hildebrandt 2002, "Simplifying and Isolating Failure-Inducing Input").

use super::cases::Trial;
use super::ground::Ground;
use super::judge::Wrong;
use super::row::Tried;
use crate::accel::BuildCx;
use crate::accel::registry::Entry;
use crate::geometry::tri::TestKind;
use crate::scene::Reason;

/// What one structure answers with one test to the only ray of a trial: what is wrong with it, if anything is.
pub fn check(trial: &Trial, entry: &'static Entry, test: TestKind, cx: &BuildCx) -> Result<Option<Wrong>, Reason> {
    let ground = Ground::new("reproducer", trial, cx)?;
    let limited = BuildCx { indices: trial.indices.unwrap_or(cx.indices), ..cx.clone() };
    let mut tried = Tried::build(entry, test, &ground.geometry, 1, trial.indices.is_some(), &limited)?;
    let shots = ground.shots(0, &trial.rays, cx)?;
    let expected = shots.expected(test, cx)?;
    tried.shoot(&shots, &expected, 0.0, &cx.cancel)?;
    Ok(tried.finish().wrong.first().map(|wrong| wrong.why))
}

/// Leaves triangles out until none of those that are left can be. `trial` has one ray, which fails.
///
/// # Errors
/// Cancelled.
pub fn shrink(mut trial: Trial, fails: &dyn Fn(&Trial) -> Result<bool, Reason>) -> Result<Trial, Reason> {
    let mut size = trial.triangles.len().div_ceil(2);
    while size > 0 {
        let (mut first, mut smaller) = (0, false);
        while first < trial.triangles.len() {
            let last = (first + size).min(trial.triangles.len());
            let mut without = trial.clone();
            without.triangles.drain(first..last);
            if fails(&without)? {
                (trial, smaller) = (without, true);
            } else {
                first = last;
            }
        }
        size = match size {
            1 if smaller => 1,
            1 => 0,
            size => size.div_ceil(2),
        };
    }
    Ok(trial)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Ray;
    use glam::Vec3;

    #[test]
    fn what_does_not_matter_is_left_out() {
        let triangles = (0..97u8).map(|i| [Vec3::splat(f32::from(i)); 3]).collect();
        let trial = Trial { triangles, rays: vec![Ray::new(Vec3::ZERO, Vec3::X)], closed: false, ..Trial::default() };
        let has = |trial: &Trial, x: f32| trial.triangles.iter().any(|tri| tri[0].x == x);
        let small = shrink(trial, &|trial| Ok(has(trial, 13.0) && has(trial, 80.0))).expect("not cancelled");
        assert_eq!(small.triangles, [[Vec3::splat(13.0); 3], [Vec3::splat(80.0); 3]]);
    }
}
