//! What a ray is asked, and what it answers.

use crate::scene::PrimRef;

/// Where a ray meets the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// In units of the ray's direction.
    pub t: f32,
    /// Barycentric weight of the triangle's second corner.
    pub u: f32,
    /// Barycentric weight of the third.
    pub v: f32,
    /// Index of the instance in the scene.
    pub instance: u32,
    /// Index of the triangle in the instance's mesh, in file order.
    pub primitive: u32,
}

/// The same inside a structure: t in the scaled space, the triangle by its flattened index.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PrimHit {
    /// In units of the scaled ray's direction.
    pub t: f32,
    /// Barycentric weight of the second corner.
    pub u: f32,
    /// Barycentric weight of the third corner.
    pub v: f32,
    /// The triangle.
    pub prim: PrimRef,
}

/// What is asked of a batch of rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Mode {
    /// The closest hit: camera and bounce rays.
    Closest,
    /// Whether there is any hit: shadow rays.
    Any,
}

/// The question as a type, so that each answer has a loop of its own.
pub trait Query: Copy + Sync {
    /// Whether every hit counts.
    const ACCEPTS_ALL: bool = false;

    /// Whether the first hit found will do.
    fn any(&self) -> bool;

    /// Whether a hit counts (an alpha test, say).
    #[inline(always)]
    fn accept(&self, hit: &PrimHit) -> bool {
        let _ = hit;
        true
    }
}

/// The closest hit of all.
#[derive(Clone, Copy, Debug)]
pub struct Closest;

impl Query for Closest {
    const ACCEPTS_ALL: bool = true;

    #[inline(always)]
    fn any(&self) -> bool {
        false
    }
}

/// Any hit.
#[derive(Clone, Copy, Debug)]
pub struct AnyHit;

impl Query for AnyHit {
    const ACCEPTS_ALL: bool = true;

    #[inline(always)]
    fn any(&self) -> bool {
        true
    }
}

/// Says which hits count: the alpha test of a scene, say.
pub trait Filter: Sync {
    /// Whether this one does. Its t says nothing.
    fn accepts(&self, hit: &Hit) -> bool;
}

/// The same inside a structure.
pub type Accepts<'a> = &'a (dyn Fn(&PrimHit) -> bool + Sync);

/// The closest hit of those that count, or any of them.
#[derive(Clone, Copy)]
pub struct Filtered<'a> {
    /// Which.
    pub mode: Mode,
    /// Those that count.
    pub accepts: Accepts<'a>,
}

impl Query for Filtered<'_> {
    #[inline(always)]
    fn any(&self) -> bool {
        self.mode == Mode::Any
    }

    fn accept(&self, hit: &PrimHit) -> bool {
        (self.accepts)(hit)
    }
}

/// A question that is settled when it is asked, for rays that are watched and not timed: they all
/// share one loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// As in [`Mode`].
    Mode(Mode),
    /// Nothing counts as a hit, so nothing cuts the traversal short: what the surface area heuristic
    /// assumes of a ray.
    Nothing,
}

impl Query for Asked {
    fn any(&self) -> bool {
        *self == Self::Mode(Mode::Any)
    }

    fn accept(&self, _: &PrimHit) -> bool {
        *self != Self::Nothing
    }
}
