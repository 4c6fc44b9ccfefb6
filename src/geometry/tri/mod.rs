//! Ray-triangle tests. A test is a type parameter of every structure; each brings the box test
//! that goes with it. A new test is one file here and one line in [`TestKind`]. [`Double`] and [`BaldwinWeber`] are
//! there to be compared with: brute force alone has them.
//!
//! All tests share the rule that makes every structure agree: a triangle is hit only if the test
//! accepts and the ray's interval in the triangle's own box is not empty; t is clamped into that
//! interval, and only then compared with the closed `[tmin, tmax]`.

mod baldwin_weber;
mod block;
pub mod bounds;
mod double;
mod exact;
mod fast;
mod plain;
mod watertight;

pub use baldwin_weber::{BaldwinWeber, Transformation};
pub use block::{Block, Eight, corners};
pub use double::Double;
pub use exact::Exact;
pub use fast::Fast;
pub use watertight::Watertight;

use super::eight::{Points, Rays};
use super::slabs::Boxes;
use super::{Aabb, EightSlabs, Ray, Slabs};
use crate::simd::Simd;
use glam::Vec3;

/// Where a ray meets a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TriHit {
    /// In units of the ray's direction.
    pub t: f32,
    /// Barycentric weight of the second corner.
    pub u: f32,
    /// Barycentric weight of the third corner.
    pub v: f32,
}

/// What a test keeps of a ray: up to seven numbers, or their bits.
pub type Own<F> = [F; 7];

/// The same numbers in all lanes.
#[inline(always)]
pub fn splat_own<S: Simd>(s: S, own: &Own<f32>) -> Own<S::F> {
    let &[a, b, c, d, e, f, g] = own;
    [s.splat(a), s.splat(b), s.splat(c), s.splat(d), s.splat(e), s.splat(f), s.splat(g)]
}

/// The boxes of eight triangles.
#[inline(always)]
pub fn boxes_of<S: Simd>(s: S, corners: &[Points<S::F>; 3]) -> Boxes<S::F> {
    let [a, b, c] = *corners;
    Boxes { min: a.min(s, b).min(s, c), max: a.max(s, b).max(s, c) }
}

/// A ray-triangle test and the box test that goes with it.
pub trait TriTest: Copy + Send + Sync + 'static {
    /// Which one it is, for the outside.
    const KIND: TestKind;

    /// What the test needs of a ray, worked out once a ray; `bounds` is the scene's box.
    fn prepare(ray: &Ray, bounds: &Aabb) -> Self;

    /// The box test's part.
    fn slabs(&self) -> &Slabs;

    /// The bare test, without regard to `[tmin, tmax]` or the triangle's box. Two-sided.
    fn meet(&self, tri: &[Vec3; 3]) -> Option<TriHit>;

    /// The same of eight triangles and as many rays, one of each in a lane, by the same operations in the same
    /// order and unfused; the corners come with the axes in the order of [`Self::axes`].
    fn meet_eight<S: Simd>(s: S, own: &Own<S::F>, slabs: &EightSlabs<S::F>, corners: &[Points<S::F>; 3]) -> Meets<S>;

    /// The order of the axes in which the test of eight takes coordinates.
    #[inline(always)]
    fn axes(&self) -> [usize; 3] {
        [0, 1, 2]
    }

    /// What the test needs of a ray besides the slabs, as numbers.
    fn own(&self) -> Own<f32>;

    /// The same of eight rays, as [`Self::prepare`] works it out.
    fn own_of_eight<S: Simd>(s: S, rays: &Rays<S::F>) -> Own<S::F>;

    /// Of such numbers.
    fn from_own(own: &Own<f32>, slabs: Slabs) -> Self;

    /// Which of eight triangles [`Self::meet`] may accept, a bit for each lane: all that it does
    /// accept are among them. The corners come with the axes in the order of [`Self::axes`].
    #[inline(always)]
    fn may_meet<S: Simd>(&self, s: S, corners: &[Points<S::F>; 3]) -> u32 {
        let meets = Self::meet_eight(s, &splat_own(s, &self.own()), &EightSlabs::splat(s, self.slabs()), corners);
        s.bits(meets.met) | meets.doubt(s)
    }

    /// As [`Self::hit`] of eight triangles and as many rays, whose `own` numbers, slabs and intervals these are;
    /// the axes in the order of [`Self::axes`].
    #[inline(always)]
    fn hit_eight<S: Simd>(
        s: S,
        own: &Own<S::F>,
        slabs: &EightSlabs<S::F>,
        interval: [S::F; 2],
        corners: &[Points<S::F>; 3],
    ) -> Hits<S> {
        Self::inside(s, &Self::meet_eight(s, own, slabs, corners), slabs, interval, corners)
    }

    /// Of those that are met the ones that are hit.
    #[inline(always)]
    fn inside<S: Simd>(
        s: S,
        meets: &Meets<S>,
        slabs: &EightSlabs<S::F>,
        interval: [S::F; 2],
        corners: &[Points<S::F>; 3],
    ) -> Hits<S> {
        meets.inside(s, slabs, interval, corners)
    }

    /// The whole test of a triangle that the look at eight left in doubt.
    #[inline(always)]
    fn hit_in_doubt(&self, tri: &[Vec3; 3], tmin: f32, tmax: f32) -> Option<TriHit> {
        self.hit(tri, tmin, tmax)
    }

    /// The whole test, by the rule above.
    #[inline(always)]
    fn hit(&self, tri: &[Vec3; 3], tmin: f32, tmax: f32) -> Option<TriHit> {
        let hit = self.meet(tri)?;
        let (entry, exit) = self.slabs().interval(&Aabb::of_triangle(tri));
        if entry > exit {
            return None;
        }
        let t = if hit.t < entry { entry } else { hit.t };
        let t = if t > exit { exit } else { t };
        (tmin <= t && t <= tmax).then_some(TriHit { t, ..hit })
    }
}

/// Which of eight triangles are met, and where.
#[derive(Clone, Copy)]
pub struct Meets<S: Simd> {
    /// Those that are, if t is finite.
    met: S::M,
    /// Those that only the test of one triangle can tell about, if there may be any.
    doubt: Option<S::M>,
    t: S::F,
    u: S::F,
    v: S::F,
}

impl<S: Simd> Meets<S> {
    /// Nothing is known of any.
    #[inline(always)]
    fn doubtful(s: S) -> Self {
        let zero = s.splat(0.0);
        Self { met: s.lt(zero, zero), doubt: Some(s.le(zero, zero)), t: zero, u: zero, v: zero }
    }

    /// Whether any may be.
    #[inline(always)]
    pub fn any(&self, s: S) -> bool {
        s.bits(self.met) | self.doubt(s) != 0
    }

    /// Those that are hit: see [`TriTest::inside`].
    #[inline(always)]
    fn inside(&self, s: S, slabs: &EightSlabs<S::F>, interval: [S::F; 2], corners: &[Points<S::F>; 3]) -> Hits<S> {
        let (entry, exit) = slabs.intervals(s, &boxes_of(s, corners));
        // An empty interval holds no t.
        let t = s.min(exit, s.max(entry, self.t));
        let [tmin, tmax] = interval;
        let inside = s.and(s.le(entry, exit), s.and(s.le(tmin, t), s.le(t, tmax)));
        // As [`TriTest::meet`], which accepts no t that is infinite or none; only here is t asked for.
        let inside = s.and(inside, s.le(s.abs(self.t), s.splat(f32::MAX)));
        Hits { hit: s.and(self.met, inside), doubt: self.doubt(s), t, u: self.u, v: self.v }
    }

    #[inline(always)]
    fn doubt(&self, s: S) -> u32 {
        match self.doubt {
            Some(doubt) => s.bits(doubt),
            None => 0,
        }
    }
}

/// Which of eight triangles are hit, and where.
#[derive(Clone, Copy)]
pub struct Hits<S: Simd> {
    /// Those that are.
    pub hit: S::M,
    /// A bit for each of those that have to be tested one by one: they may be hit or not.
    pub doubt: u32,
    /// As in [`TriHit`].
    pub t: S::F,
    /// As in [`TriHit`].
    pub u: S::F,
    /// As in [`TriHit`].
    pub v: S::F,
}

/// The tests by name.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum TestKind {
    /// [`Watertight`]: no ray slips through a shared edge. The default.
    #[default]
    Watertight,
    /// [`Fast`]: fewer operations, but rays through edges may slip through.
    Fast,
    /// [`Exact`]: no rounding decides anything.
    Exact,
    /// [`Double`]: 64 bits throughout.
    Double,
    /// [`BaldwinWeber`]: a transformation stored with each triangle.
    #[serde(rename = "baldwin-weber")]
    BaldwinWeber,
}

impl TestKind {
    /// The tests that every structure has, the default first.
    pub const ALL: [Self; 3] = [Self::Watertight, Self::Fast, Self::Exact];
    /// Those that brute force has besides.
    pub const OTHERS: [Self; 2] = [Self::Double, Self::BaldwinWeber];

    /// Whether no ray slips through an edge or a corner that triangles share.
    pub const fn is_watertight(self) -> bool {
        matches!(self, Self::Watertight | Self::Exact)
    }

    /// The name used on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Watertight => "watertight",
            Self::Fast => "fast",
            Self::Exact => "exact",
            Self::Double => "double",
            Self::BaldwinWeber => "baldwin-weber",
        }
    }

    /// The name in the window.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Watertight => "Watertight",
            Self::Fast => "Fast",
            Self::Exact => "Exact",
            Self::Double => "Double",
            Self::BaldwinWeber => "Baldwin-Weber",
        }
    }

    /// One sentence for the user.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Watertight => "Woop, Benthin and Wald 2013: rays through shared edges and vertices never slip through.",
            Self::Fast => "Möller and Trumbore 1997: fewer operations; rays through shared edges may slip through.",
            Self::Exact => "Shewchuk 1997: exact signs behind a filter, and t correctly rounded: no hit is a matter of rounding.",
            Self::Double => "64 bits throughout: smaller errors, none of them promised away.",
            Self::BaldwinWeber => {
                "Baldwin and Weber 2016: a transformation stored with each triangle; rays through shared edges may slip through."
            }
        }
    }
}

impl std::str::FromStr for TestKind {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let found = Self::ALL.into_iter().chain(Self::OTHERS).find(|kind| kind.id() == s);
        found.ok_or_else(|| {
            format!("there is no triangle test '{s}': use watertight, fast or exact, or with brute double or baldwin-weber")
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Aabb = Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) };
    const TRI: [Vec3; 3] = [Vec3::new(0.0, 0.0, 0.5), Vec3::new(1.0, 0.0, 0.5), Vec3::new(0.0, 1.0, 0.5)];

    fn shoot<T: TriTest>(origin: Vec3, dir: Vec3) -> Option<TriHit> {
        T::prepare(&Ray::new(origin, dir), &BOUNDS).hit(&TRI, 0.0, f32::INFINITY)
    }

    fn knows_the_simple_answers<T: TriTest>() {
        for side in [-1.0, 1.0] {
            let hit = shoot::<T>(Vec3::new(0.25, 0.5, 0.5 - side), Vec3::new(0.0, 0.0, 2.0 * side));
            assert_eq!(hit, Some(TriHit { t: 0.5, u: 0.25, v: 0.5 }));
        }
        assert_eq!(shoot::<T>(Vec3::new(0.75, 0.5, 0.0), Vec3::Z), None, "outside");
        assert_eq!(shoot::<T>(Vec3::new(0.25, 0.25, 1.0), Vec3::Z), None, "behind");
        assert_eq!(shoot::<T>(Vec3::new(-1.0, 0.25, 0.5), Vec3::X), None, "in the plane");
    }

    #[test]
    fn fast_knows_the_simple_answers() {
        knows_the_simple_answers::<Fast>();
    }

    #[test]
    fn watertight_knows_the_simple_answers() {
        knows_the_simple_answers::<Watertight>();
    }

    #[test]
    fn double_and_baldwin_weber_know_the_simple_answers() {
        knows_the_simple_answers::<Double>();
        knows_the_simple_answers::<BaldwinWeber>();
    }

    #[test]
    fn the_interval_is_closed() {
        let ray = Watertight::prepare(&Ray::new(Vec3::new(0.25, 0.25, 0.0), Vec3::Z), &BOUNDS);
        assert!(ray.hit(&TRI, 0.5, 0.5).is_some());
        assert!(ray.hit(&TRI, 0.0, 0.5f32.next_down()).is_none());
        assert!(ray.hit(&TRI, 0.5f32.next_up(), 1.0).is_none());
    }

    /// A fan of thin triangles around a point: a ray aimed at the hub or at any spoke must hit.
    #[test]
    fn watertight_leaves_no_gap_between_neighbours() {
        let hub = Vec3::new(0.123, -0.456, 0.1);
        let rim: Vec<Vec3> = (0..97u8)
            .map(|i| {
                let a = f32::from(i) / 97.0 * std::f32::consts::TAU;
                Vec3::new(a.cos(), a.sin(), (a * 3.0).sin() * 0.3)
            })
            .collect();
        let mut rays = 0;
        for i in 0..97 {
            for step in 0..200u8 {
                let target = hub.lerp(rim[i], f32::from(step) / 200.0);
                let origin = Vec3::new(0.4 - f32::from(step) / 150.0, 0.3, 2.0);
                let ray = Watertight::prepare(&Ray::new(origin, target - origin), &BOUNDS);
                let any = (0..97).any(|k| ray.hit(&[hub, rim[k], rim[(k + 1) % 97]], 0.0, f32::INFINITY).is_some());
                assert!(any, "slipped through spoke {i} at {target}");
                rays += 1;
            }
        }
        assert_eq!(rays, 97 * 200);
    }
}
