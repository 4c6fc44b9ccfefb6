//! Bounding volumes: tightness against cost. One tree, built as the BVH's with boxes, and around
//! its nodes a volume of choice. All volumes give the same hits, to the bit.
//!
//! `Volume` says what a volume is; each is a file of its own (`aabb`, `sphere`, `obb`,
//! `kdop`, `hull`) and one line in `KINDS`. `fit` puts them around the nodes, `tree` holds
//! the nodes and the traversal, `inspect` is what measuring looks at, `alone` one volume without a tree.

mod aabb;
mod alone;
mod fit;
mod hull;
mod inspect;
mod kdop;
mod obb;
mod points;
mod sphere;
mod tree;
mod volume;

#[cfg(test)]
mod tests;

pub use alone::Alone;
pub use inspect::{Seen, Volumes};
pub use volume::Loose;

use std::marker::PhantomData;
use std::sync::Arc;

use super::bvh::{self, Built};
use super::params::{Kind as ParamKind, Param, ParamValues};
use super::{Accel, BuildCx, BuildError};
use crate::geometry::Aabb;
use crate::geometry::kdop::Octahedron;
use crate::geometry::obb::Obb;
use crate::geometry::sphere::Sphere;
use crate::geometry::tri::{Exact, Fast, TestKind, TriTest, Watertight};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};
use fit::too_large;
use glam::DVec3;
use tree::{Node, Tree};
use volume::Volume;

/// A kind of volume: its name, and how a tree of it is put together.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    /// The name used by `--set volume=` and in reports.
    pub id: &'static str,
    watertight: Make,
    fast: Make,
    exact: Make,
    alone: MakeAlone,
}

type MakeAlone = fn(&Geometry, &[PrimRef], &Cancel) -> Result<Box<dyn Alone>, Cancelled>;
type Make = fn(Built, &BuildCx) -> Result<Box<dyn Volumes>, BuildError>;

impl Kind {
    const fn of<V: Volume>() -> Self {
        let alone = alone::around::<V>;
        Self { id: V::ID, watertight: make::<Watertight, V>, fast: make::<Fast, V>, exact: make::<Exact, V>, alone }
    }

    /// Puts one volume of this kind around some triangles of a geometry, at least one.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn around(&self, geometry: &Geometry, prims: &[PrimRef], cancel: &Cancel) -> Result<Box<dyn Alone>, Cancelled> {
        (self.alone)(geometry, prims, cancel)
    }
}

/// Every kind, the one that others are compared with first.
pub const KINDS: &[Kind] = &[
    Kind::of::<Aabb>(),
    Kind::of::<Sphere>(),
    Kind::of::<Obb>(),
    Kind::of::<kdop::Kdop6>(),
    Kind::of::<Octahedron>(),
    Kind::of::<kdop::Kdop14>(),
    Kind::of::<kdop::Kdop18>(),
    Kind::of::<kdop::Kdop26>(),
    Kind::of::<hull::Hull>(),
];

const IDS: &[&str] = &{
    let mut ids = [""; KINDS.len()];
    let mut i = 0;
    while i < ids.len() {
        ids[i] = KINDS[i].id;
        i += 1;
    }
    ids
};

/// What can be set.
pub const PARAMS: &[Param] = &[
    Param {
        id: "volume",
        label: "Volume",
        help: "What bounds a node: a tighter volume is entered less often, and costs more to store and to test.",
        unit: "",
        kind: ParamKind::Choice { options: IDS },
    },
    bvh::PARAMS[0],
    bvh::PARAMS[1],
    bvh::PARAMS[2],
    bvh::PARAMS[3],
    bvh::PARAMS[4],
    bvh::PARAMS[5],
];

/// Builds the BVH's tree and puts the volumes around its nodes that the parameters ask for.
pub fn build<T: TriTest>(geometry: &Arc<Geometry>, p: &ParamValues, cx: &BuildCx) -> Result<Box<dyn Accel>, BuildError> {
    Ok(build_volumes(geometry, T::KIND, p, cx)?)
}

/// The same, to be looked into.
///
/// # Errors
/// Cancelled, or it would not fit.
pub fn build_volumes(
    geometry: &Arc<Geometry>,
    test: TestKind,
    p: &ParamValues,
    cx: &BuildCx,
) -> Result<Box<dyn Volumes>, BuildError> {
    let id = p.choice("volume");
    let kind = KINDS.iter().find(|kind| kind.id == id).unwrap_or(&KINDS[0]);
    let make = match test {
        TestKind::Watertight => kind.watertight,
        TestKind::Fast => kind.fast,
        TestKind::Exact => kind.exact,
        TestKind::Double | TestKind::BaldwinWeber => return Err(BuildError::NoSuchTest { structure: "volumes", test }),
    };
    make(bvh::tree(geometry, p, cx)?, cx)
}

/// Puts volumes around the nodes. Those traced with `Fast` hold the boxes of the triangles: see
/// [`Line`](crate::geometry::Line) for why.
fn make<T: TriTest, V: Volume>(built: Built, cx: &BuildCx) -> Result<Box<dyn Volumes>, BuildError> {
    let count = built.nodes.len();
    let fitting = count * (size_of::<V::Fit>() + size_of::<V::Up>() + size_of::<Node<V>>());
    // What is handed up is at most every point, of two levels at a time; with boxes, eight a triangle.
    let boxes = T::KIND == TestKind::Fast;
    let handed_up =
        if size_of::<V::Up>() == 0 { 0 } else { built.packed.len() * if boxes { 8 } else { 3 } * size_of::<DVec3>() * 2 };
    let mut charge = cx.budget.charge((fitting + handed_up) as u64).map_err(too_large)?;
    let fits = fit::fit::<V>(&built, boxes, &mut charge, cx)?;
    let mut shared = V::Shared::default();
    let mut nodes = Vec::with_capacity(count);
    for (fit, node) in fits.into_iter().zip(&built.nodes) {
        let (first, count) = node.first_and_count();
        nodes.push(Node { volume: V::store(fit, &mut shared), first, count });
    }
    charge.grow(V::shared_bytes(&shared)).map_err(too_large)?;
    let Built { geometry, packed, _charge: of_tree, nodes: tree, splits, remarks } = built;
    drop((tree, of_tree));
    let bytes = size_of_val(&nodes[..]) as u64 + V::shared_bytes(&shared) + size_of_val(&packed[..]) as u64;
    drop(charge);
    let charge = cx.budget.charge(bytes).map_err(too_large)?;
    Ok(Box::new(Tree::<T, V> { geometry, nodes, shared, packed, splits, remarks, _charge: charge, test: PhantomData }))
}
