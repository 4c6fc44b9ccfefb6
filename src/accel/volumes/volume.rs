//! What a bounding volume is to the tree. A volume is a file beside this one that implements
//! [`Volume`], and one line in [`super::KINDS`].

use std::fmt::Debug;

use super::points::Points;
use crate::accel::cell::{Form, Shape};
use crate::geometry::Line;
use crate::task::Cancelled;
use glam::Vec3;

/// A convex volume around the triangles of a node.
///
/// It must hold every point of [`Points`], in exact arithmetic, so its numbers are rounded outward;
/// and [`Self::interval`] must not lose a hit: see [`Line`] for what is known of one.
pub trait Volume: Copy + Debug + Send + Sync + 'static {
    /// The name used by `--set volume=` and in reports.
    const ID: &'static str;

    /// What a fit is stored as, besides one of `Self` a node: the faces of hulls.
    type Shared: Debug + Default + Send + Sync + 'static;

    /// A volume as it is fitted, before it is stored.
    type Fit: Send + Sync;

    /// What the fit around two nodes hands up to the one around their parent, so that large nodes need
    /// not look at every point often.
    type Up: Send + Sync;

    /// What depends on the ray only.
    type Ray: Copy + Send + Sync;

    /// The volume around some points; `below` is what the children's fits handed up.
    fn around(points: &Points<'_>, below: Option<[Self::Up; 2]>) -> Result<(Self::Fit, Self::Up), Cancelled>;

    /// Stores a fit; called for every node in order.
    fn store(fit: Self::Fit, shared: &mut Self::Shared) -> Self;

    /// Bytes of a fit besides its own size.
    fn fit_bytes(fit: &Self::Fit) -> u64 {
        let _ = fit;
        0
    }

    /// Works out what depends on the ray only.
    fn ray(line: &Line) -> Self::Ray;

    /// The earliest and latest t at which the ray may hit what is in the volume; `None` if it misses.
    fn interval(&self, shared: &Self::Shared, ray: &Self::Ray) -> Option<(f32, f32)>;

    /// The volume as the outside sees it; `centre` is that of the scene.
    fn shape(&self, shared: &Self::Shared, centre: Vec3) -> Shape;

    /// What it looks like, in the coordinates of the scene.
    fn form(&self, shared: &Self::Shared, centre: Vec3) -> Form;

    /// Bytes of what is shared.
    fn shared_bytes(shared: &Self::Shared) -> u64 {
        let _ = shared;
        0
    }

    /// The area of the true convex hull of the node, where it is known.
    fn hull_area(&self) -> Option<f64> {
        None
    }

    /// How many volumes are looser than their name says, and why.
    fn loose(shared: &Self::Shared) -> Loose {
        let _ = shared;
        Loose::default()
    }
}

/// Volumes that are looser than their name says.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Loose {
    /// Hulls with too many faces: the largest ones and a k-DOP instead.
    pub simplified: u64,
    /// Hulls that could not be made: a k-DOP instead.
    pub failed: u64,
}
