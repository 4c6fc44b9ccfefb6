//! Boxwood's structures beside those of other libraries: the same triangles, the same rays, in turns.
//!
//! What takes part is a [`Recipe`], ours or a peer's; it builds a [`Entrant`], which traces. A peer gets
//! the flattened triangles and the rays of the scaled space, where ours work too, so that neither side
//! has the easier numbers; ours is given world rays and brings them there itself, as its users have it.
//! Inputs are brought into a peer's own form before its build is timed, its rays while they are traced.

mod bvh_rs;
mod embree;
mod lane;
mod obvhs;
mod ours;
mod parry;
mod race;
mod ratios;
mod same;
mod sets;
#[cfg(all(target_arch = "x86_64", not(target_env = "msvc")))]
mod tinybvh;

pub use ours::Ours;
pub use race::{BuildSecs, PeerRace, PeerRow, RayRow, race};
pub use ratios::Ratios;
pub use sets::RayPairs;

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::accel::params::Value;
use crate::accel::{Hit, Mode};
use crate::geometry::Ray;
use crate::scene::Geometry;
use crate::task::{Cancelled, Pool};
use glam::Vec3;

/// How rays are handed over.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Call {
    /// One at a time.
    Single,
    /// A list at a time.
    Batch,
    /// Eight at a time.
    Packet8,
}

impl Call {
    /// The name in tables and in JSON.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Single => "single",
            Self::Batch => "batch",
            Self::Packet8 => "packet8",
        }
    }
}

/// What is asked of rays, and how.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Ask {
    /// The closest hit or any.
    pub mode: Mode,
    /// One by one or together.
    pub call: Call,
    /// Whether neighbours in the list go the same way: some want to know.
    pub coherent: bool,
}

/// The same rays in the world and in the scaled space.
#[derive(Clone, Copy, Debug)]
pub struct Rays<'a> {
    /// As users have them.
    pub world: &'a [Ray],
    /// As structures trace them.
    pub scaled: &'a [Ray],
}

/// What a ray hit: t in the scaled space and the flattened triangle. Of any hit only whether there is one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Found {
    /// Infinite for a miss.
    pub t: f32,
    /// The triangle; [`Found::NONE`] for a miss.
    pub prim: u32,
}

impl Found {
    /// The triangle of a miss.
    pub const NONE: u32 = u32::MAX;
    /// Nothing was hit.
    pub const MISS: Self = Self { t: f32::INFINITY, prim: Self::NONE };
    /// Something was hit.
    pub const SOMETHING: Self = Self { t: 0.0, prim: 0 };

    /// Whether there is a hit.
    pub const fn is_hit(self) -> bool {
        self.prim != Self::NONE
    }

    /// That something was hit, or nothing.
    pub const fn any(hit: bool) -> Self {
        if hit { Self::SOMETHING } else { Self::MISS }
    }

    /// A hit by its t and triangle.
    pub fn of(hit: Option<(f32, u32)>) -> Self {
        hit.map_or(Self::MISS, |(t, prim)| Self { t, prim })
    }
}

/// Where hits are written, kept from chunk to chunk: ours as its users get them, a peer's as [`Found`],
/// the triangle by its place among the live ones.
#[derive(Debug, Default)]
pub struct Hits {
    /// A peer's.
    pub found: Vec<Found>,
    /// Ours.
    pub ours: Vec<Option<Hit>>,
}

/// A built structure, ours or a peer's.
pub trait Entrant: Send + Sync {
    /// Traces the rays and returns how many hit something.
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64;

    /// Brings what [`Self::trace`] wrote into one form, [`Hits::found`] with flattened triangles.
    fn settle(&self, rays: Rays<'_>, ask: Ask, geometry: &Geometry, hits: &mut Hits) {
        let _ = rays;
        for found in hits.found.iter_mut().filter(|found| ask.mode == Mode::Closest && found.is_hit()) {
            found.prim = geometry.live(found.prim as usize);
        }
    }

    /// Bytes of the structure, where they are known.
    fn bytes(&self) -> Option<u64>;
}

/// Writes what `one` finds for each ray, and counts the hits: how a peer that takes one ray at a time is
/// called.
#[inline(always)]
fn one_by_one(rays: Rays<'_>, hits: &mut Hits, one: impl FnMut(&Ray) -> Found) -> u64 {
    hits.found.clear();
    hits.found.extend(rays.scaled.iter().map(one));
    hits.found.iter().filter(|found| found.is_hit()).count() as u64
}

/// What takes part, in words.
#[derive(Clone, Debug, PartialEq)]
pub struct Label {
    /// What its rows are called.
    pub id: String,
    /// Whose it is and which version: `Embree 3.13.5`.
    pub library: String,
    /// Whether it is another library's.
    pub peer: bool,
    /// Whether no ray slips between triangles that share an edge.
    pub watertight: bool,
    /// The triangle test, or what a peer calls it.
    pub test: &'static str,
    /// The parameters of ours.
    pub params: BTreeMap<&'static str, Value>,
}

impl Label {
    /// Of a peer.
    fn peer(id: &str, library: &str, watertight: bool) -> Self {
        let test = if watertight { "robust" } else { "fast" };
        Self { id: id.to_owned(), library: library.to_owned(), peer: true, watertight, test, params: BTreeMap::new() }
    }
}

/// A structure and the seconds of its build.
pub struct Built {
    /// The structure.
    pub entrant: Box<dyn Entrant>,
    /// Wall-clock seconds, without bringing the triangles into the library's form.
    pub secs: f64,
}

/// Why there is no structure.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum NotBuilt {
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// In words for the user.
    #[error("{0}")]
    Because(String),
}

/// How something that takes part is built.
pub trait Recipe: Send + Sync {
    /// What it is called.
    fn label(&self) -> Label;

    /// The ways its rays can be handed over.
    fn calls(&self) -> &'static [Call];

    /// Builds it on the threads of the pool.
    ///
    /// # Errors
    /// [`NotBuilt`].
    fn build(&self, geometry: &Arc<Geometry>, pool: &Pool) -> Result<Built, NotBuilt>;
}

/// Some that take part.
pub type Recipes = Vec<Box<dyn Recipe>>;

/// Every peer there is here, and a word on each that is not.
pub fn peers() -> (Recipes, Vec<String>) {
    let (mut recipes, mut missing) = (Recipes::new(), Vec::new());
    match embree::recipes() {
        Ok(embree) => recipes.extend(embree),
        Err(error) => missing.push(format!("embree: {error}")),
    }
    #[cfg(all(target_arch = "x86_64", not(target_env = "msvc")))]
    match tinybvh::recipes() {
        Some(tinybvh) => recipes.extend(tinybvh),
        None => missing.push("tinybvh: this processor has no AVX2 and FMA".to_owned()),
    }
    #[cfg(not(all(target_arch = "x86_64", not(target_env = "msvc"))))]
    missing.push("tinybvh: its layout for processors needs AVX2".to_owned());
    recipes.extend(obvhs::recipes());
    recipes.extend(parry::recipes());
    recipes.extend(bvh_rs::recipes());
    (recipes, missing)
}

/// The corners of the triangles that structures hold, in order.
fn live_corners(geometry: &Geometry) -> impl ExactSizeIterator<Item = [Vec3; 3]> + '_ {
    (0..geometry.live_count()).map(|i| geometry.corners(geometry.live(i)))
}

/// The indices of those.
fn live_indices(geometry: &Geometry) -> Vec<[u32; 3]> {
    let (_, triangles) = geometry.indexed();
    (0..geometry.live_count()).map(|i| triangles[geometry.live(i) as usize]).collect()
}

/// For libraries that cannot build over nothing.
fn not_empty(geometry: &Geometry) -> Result<(), NotBuilt> {
    if geometry.live_count() == 0 { Err(NotBuilt::Because("there are no triangles".to_owned())) } else { Ok(()) }
}
