//! Tests of boxes side by side: whether a box that the ray meets exactly is missed, whether a hit of the watertight triangle
//! test is lost with the triangle's own box, how many boxes are entered in vain, and what a test costs.

use std::cmp::Ordering;
use std::hint::black_box;
use std::ops::ControlFlow;
use std::time::Instant;

use serde::Serialize;

use super::dyadic::Dyadic;
use super::ground::{Ground, Shots};
use crate::accel::cell::{Descend, Shape, walk};
use crate::accel::{BuildCx, BuildError, registry};
use crate::geometry::tri::{TestKind, TriTest, Watertight};
use crate::geometry::{Aabb, Ray, Slabs};
use crate::lab::statistics::median;
use crate::scene::Reason;

/// A test of a ray and a box.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum BoxTest {
    /// Kay and Kajiya 1986, as it stands: three slabs, nothing widened.
    Plain,
    /// Ize 2013, "Robust BVH Ray Traversal" (JCGT 2(2)): the far t is enlarged by two units of the last place.
    Ize,
    /// Pharr, Jakob and Humphreys, "Physically Based Rendering", 6.8.1: the far t is enlarged by `1 + 2 gamma(3)`.
    Pbrt,
    /// Ours: two origins a ray ([`crate::geometry::slabs`]).
    TwoOrigins,
}

impl BoxTest {
    /// All of them.
    pub const ALL: [Self; 4] = [Self::Plain, Self::Ize, Self::Pbrt, Self::TwoOrigins];

    /// The name in reports.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Ize => "ize",
            Self::Pbrt => "pbrt",
            Self::TwoOrigins => "two-origins",
        }
    }
}

/// What came out of one test of boxes in a case.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct BoxRow {
    /// Which test.
    pub id: BoxTest,
    /// Pairs of a ray and a box.
    pub asked: u64,
    /// Of those, the ones that meet exactly.
    pub met: u64,
    /// Of those that meet, the ones that the test calls missed.
    pub missed: u64,
    /// Triangles that the watertight test hits and whose own box is called missed.
    pub lost: u64,
    /// Of those that do not meet, the ones that the test calls met.
    pub in_vain: u64,
    /// Of a test, on one thread.
    pub ns_per_box: f64,
}

/// Rays and boxes that are looked at.
const RAYS: usize = 64;
const BOXES: usize = 2048;
/// Rounds that are timed.
const ROUNDS: usize = 5;

/// The rows of some rays of a case; none if it has no boxes.
///
/// # Errors
/// Cancelled.
pub fn box_rows(shots: &Shots<'_>, cx: &BuildCx) -> Result<Vec<BoxRow>, Reason> {
    let geometry = &shots.ground.geometry;
    let boxes = boxes(shots.ground, cx)?;
    let valid: Vec<Ray> = shots.entered.iter().flatten().map(|entered| entered.ray).collect();
    let rays: Vec<Ray> = valid.iter().step_by(valid.len().div_ceil(RAYS).max(1)).copied().collect();
    if boxes.is_empty() || rays.is_empty() {
        return Ok(Vec::new());
    }
    let row = |id| BoxRow { id, asked: 0, met: 0, missed: 0, lost: 0, in_vain: 0, ns_per_box: 0.0 };
    let mut rows = BoxTest::ALL.map(row);
    for ray in &rays {
        cx.cancel.check()?;
        let asker = Asker::new(ray, geometry.bounds());
        let test = Watertight::prepare(ray, geometry.bounds());
        let hit = |i: usize| {
            let tri = geometry.corners(geometry.live(i));
            test.meet(&tri).filter(|hit| ray.tmin <= hit.t && hit.t <= ray.tmax).map(|_| Aabb::of_triangle(&tri))
        };
        let hits: Vec<Aabb> = (0..geometry.live_count()).filter_map(hit).collect();
        let met: Vec<bool> = boxes.iter().map(|b| meets(ray, b)).collect();
        for row in &mut rows {
            row.asked += boxes.len() as u64;
            row.lost += hits.iter().filter(|b| !asker.ask(row.id, b)).count() as u64;
            for (b, met) in boxes.iter().zip(&met) {
                let entered = asker.ask(row.id, b);
                row.met += u64::from(*met);
                row.missed += u64::from(*met && !entered);
                row.in_vain += u64::from(!*met && entered);
            }
        }
    }
    let mut secs = BoxTest::ALL.map(|_| Vec::with_capacity(ROUNDS));
    for _ in 0..ROUNDS {
        for (test, secs) in BoxTest::ALL.into_iter().zip(&mut secs) {
            let start = Instant::now();
            for ray in &rays {
                cx.cancel.check()?;
                let asker = Asker::new(ray, geometry.bounds());
                black_box(boxes.iter().filter(|b| asker.ask(test, b)).count());
            }
            secs.push(start.elapsed().as_secs_f64());
        }
    }
    let asked = (rays.len() * boxes.len()) as f64;
    rows.iter_mut().zip(&secs).for_each(|(row, secs)| row.ns_per_box = median(secs) * 1e9 / asked);
    Ok(rows.into())
}

/// Boxes of a BVH, evenly spread if there are many.
fn boxes(ground: &Ground, cx: &BuildCx) -> Result<Vec<Aabb>, Reason> {
    let Some(entry) = registry::find("bvh") else { return Ok(Vec::new()) };
    let accel = match entry.build(&ground.geometry, TestKind::Watertight, &entry.defaults(), cx) {
        Ok(accel) => accel,
        Err(BuildError::Cancelled(cancelled)) => return Err(cancelled.into()),
        // What does not fit is told by the row of the structure.
        Err(_) => return Ok(Vec::new()),
    };
    let mut boxes = Vec::new();
    walk(accel.as_ref(), &mut |cell| {
        if let Shape::Box(bounds) = cell.shape {
            boxes.push(bounds);
        }
        if cx.cancel.is_cancelled() { ControlFlow::Break(()) } else { ControlFlow::Continue(Descend::Yes) }
    });
    cx.cancel.check()?;
    let step = boxes.len().div_ceil(BOXES).max(1);
    Ok(boxes.into_iter().step_by(step).filter(|b| !b.is_empty()).collect())
}

/// A ray of the scaled space, made ready for all of the tests.
pub struct Asker {
    origin: [f32; 3],
    inverse: [f32; 3],
    interval: [f32; 2],
    slabs: Slabs,
}

impl Asker {
    /// For a ray and a scene inside `bounds`.
    #[inline(always)]
    pub fn new(ray: &Ray, bounds: &Aabb) -> Self {
        Self {
            origin: ray.origin.to_array(),
            inverse: ray.dir.to_array().map(|d| 1.0 / d),
            interval: [ray.tmin, ray.tmax],
            slabs: Slabs::new(ray, bounds),
        }
    }

    #[inline(always)]
    fn ask(&self, test: BoxTest, b: &Aabb) -> bool {
        self.entry(test, b, self.interval[1]).is_some()
    }

    /// Where the ray enters a box that it meets before `end`, as a test has it.
    #[inline(always)]
    pub fn entry(&self, test: BoxTest, b: &Aabb, end: f32) -> Option<f32> {
        match test {
            BoxTest::Plain => self.slabs(b, 1.0, end),
            BoxTest::Ize => self.slabs(b, 1.0 + 2.0 * f32::EPSILON, end),
            BoxTest::Pbrt => self.slabs(b, PBRT, end),
            BoxTest::TwoOrigins => {
                let (entry, exit) = self.slabs.interval(b);
                (entry <= exit && entry <= end && self.interval[0] <= exit).then_some(entry)
            }
        }
    }

    /// Three slabs, the far t enlarged. Where the origin lies in a plane and the direction too, 0 times infinity is no number,
    /// and the slab is left out: the comparisons are written so that they fail then.
    #[inline(always)]
    fn slabs(&self, b: &Aabb, enlarged: f32, end: f32) -> Option<f32> {
        let (low, high) = (b.min.to_array(), b.max.to_array());
        let (mut entry, mut exit) = (self.interval[0], end);
        for k in 0..3 {
            let (a, b) = ((low[k] - self.origin[k]) * self.inverse[k], (high[k] - self.origin[k]) * self.inverse[k]);
            let (near, far) = if self.inverse[k].is_sign_negative() { (b, a) } else { (a, b) };
            let far = far * enlarged;
            entry = if near > entry { near } else { entry };
            exit = if far < exit { far } else { exit };
        }
        (entry <= exit).then_some(entry)
    }
}

/// `1 + 2 gamma(3)`, with `gamma(n) = n u / (1 - n u)`.
const PBRT: f32 = {
    let of_three = 3.0 * f32::EPSILON * 0.5;
    1.0 + 2.0 * (of_three / (1.0 - of_three))
};

/// A t: a difference over a positive number, none of them rounded.
#[derive(Clone, Copy)]
struct Quotient {
    of: [f64; 2],
    over: f64,
}

impl Quotient {
    /// Whether it is at most another: in 64 bits, exactly where those do not decide.
    fn at_most(&self, other: &Self) -> bool {
        let product = |a: &Self, b: &Self| (a.of[0] - a.of[1]) * b.over;
        let (left, right) = (product(self, other), product(other, self));
        // A difference and a product are rounded on either side.
        if (left - right).abs() > 4.0 * f64::EPSILON * (left.abs() + right.abs()) {
            return left < right;
        }
        let exactly = |a: &Self, b: &Self| &(&Dyadic::new(a.of[0]) - &Dyadic::new(a.of[1])) * &Dyadic::new(b.over);
        exactly(self, other).compare(&exactly(other, self)) != Ordering::Greater
    }
}

/// Whether a ray's interval has a point in a box, exactly; ends and faces belong to both.
fn meets(ray: &Ray, b: &Aabb) -> bool {
    let end = |t: f32| Quotient { of: [f64::from(t), 0.0], over: 1.0 };
    // An infinite end is farther than all.
    let (mut near, mut far) = ([end(ray.tmin); 4], [end(ray.tmax.min(f32::MAX)); 4]);
    for k in 0..3 {
        let (o, d) = (f64::from(ray.origin[k]), f64::from(ray.dir[k]));
        let (low, high) = (f64::from(b.min[k]), f64::from(b.max[k]));
        if d == 0.0 {
            if o < low || high < o {
                return false;
            }
            continue;
        }
        let (enter, leave) = if d > 0.0 { ([low, o], [high, o]) } else { ([o, high], [o, low]) };
        (near[k], far[k]) = (Quotient { of: enter, over: d.abs() }, Quotient { of: leave, over: d.abs() });
    }
    near.iter().all(|n| far.iter().all(|f| n.at_most(f)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_box_is_met_exactly() {
        let b = Aabb { min: Vec3::new(1.0, 0.0, 0.0), max: Vec3::new(2.0, 1.0, 1.0) };
        let met = |origin: Vec3, dir: Vec3| meets(&Ray::new(origin, dir), &b);
        assert!(met(Vec3::ZERO, Vec3::X), "along an edge");
        assert!(met(Vec3::ZERO, Vec3::new(1.0, 1.0, 0.5)), "through a point of an edge");
        assert!(!met(Vec3::ZERO, Vec3::new(1.0, 1.0f32.next_up(), 0.5)));
        assert!(met(Vec3::ZERO, Vec3::new(2.0, 1.0f32.next_up(), 0.5)));
        assert!(!met(Vec3::ZERO, Vec3::NEG_X));
        assert!(!met(Vec3::new(0.0, -f32::MIN_POSITIVE, 0.0), Vec3::X));
        assert!(met(Vec3::new(1.5, 0.5, 0.5), Vec3::new(0.0, -0.0, 1.0)));
        assert!(!meets(&Ray { tmax: 1.0f32.next_down(), ..Ray::new(Vec3::ZERO, Vec3::X) }, &b));
        assert!(meets(&Ray { tmin: 2.0, ..Ray::new(Vec3::ZERO, Vec3::X) }, &b));
        assert!(!meets(&Ray { tmin: 2.0f32.next_up(), ..Ray::new(Vec3::ZERO, Vec3::X) }, &b));
    }
}
