//! What measuring bounding volumes needs to see of a tree, whatever its volumes are.

use std::ops::Range;
use std::sync::Mutex;

use super::points;
use super::tree::Tree;
use super::volume::{Loose, Volume};
use crate::accel::probe::Probe;
use crate::accel::{Accel, Asked, Mode, PrimHit, Query, Structure, Traced, in_scaled_space};
use crate::geometry::tri::TriTest;
use crate::geometry::{Line, Ray};
use crate::scene::PrimRef;

/// What the traversal of a ray did.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Seen {
    /// Nodes whose volume was tested, in order.
    pub tested: Vec<u32>,
    /// Nodes entered, in order.
    pub entered: Vec<u32>,
    /// Triangles tested.
    pub prims: u64,
}

impl Probe for Seen {
    fn prim(&mut self) {
        self.prims += 1;
    }

    fn bounds(&mut self, node: u32) {
        self.tested.push(node);
    }

    fn at(&mut self, node: u32) {
        self.entered.push(node);
    }
}

/// A tree of bounding volumes of some kind. Trees over the same geometry with the same parameters
/// but for the volume have the same nodes in the same order.
pub trait Volumes: Accel {
    /// How many nodes there are.
    fn node_count(&self) -> usize;

    /// Bytes of all nodes and what they share.
    fn node_bytes(&self) -> u64;

    /// The area of a node's volume, in the scaled space.
    fn area(&self, node: u32) -> f64;

    /// The area of the convex hull of a node's triangles, where the volumes know it.
    fn hull_area(&self, node: u32) -> Option<f64>;

    /// How many volumes are looser than their name says.
    fn loose(&self) -> Loose;

    /// For each node its triangles, as places in the packed list.
    fn ranges(&self) -> Vec<Range<u32>>;

    /// Traces a world ray and writes down what that did.
    fn watch(&self, ray: &Ray, mode: Mode, seen: &mut Seen);

    /// All triangles that a world ray hits, in no order.
    fn all_hits(&self, ray: &Ray) -> Vec<PrimRef>;

    /// The triangles in the order of the packed list.
    fn packed(&self) -> Vec<PrimRef>;

    /// Makes ready to test volumes against world rays, by pairs of a node and an index among the
    /// rays. What is returned tests them all once and says how many are met. Rays that are not
    /// valid, or end before the scene, are left out.
    fn tests<'a>(&'a self, rays: &[Ray], pairs: &'a [(u32, u32)]) -> Box<dyn Fn() -> usize + 'a>;
}

/// Hears of every hit and takes none, so that nothing is cut off.
#[derive(Clone, Copy)]
struct Every<'a>(&'a Mutex<Vec<PrimRef>>);

impl Query for Every<'_> {
    fn any(&self) -> bool {
        false
    }

    fn accept(&self, hit: &PrimHit) -> bool {
        if let Ok(mut list) = self.0.lock() {
            list.push(hit.prim);
        }
        false
    }
}

impl<T: TriTest, V: Volume> Volumes for Tree<T, V> {
    fn node_count(&self) -> usize {
        self.nodes.len()
    }

    fn node_bytes(&self) -> u64 {
        size_of_val(&self.nodes[..]) as u64 + V::shared_bytes(&self.shared)
    }

    fn area(&self, node: u32) -> f64 {
        self.nodes[node as usize].volume.shape(&self.shared, self.geometry.bounds().centre()).area()
    }

    fn hull_area(&self, node: u32) -> Option<f64> {
        self.nodes[node as usize].volume.hull_area()
    }

    fn loose(&self) -> Loose {
        V::loose(&self.shared)
    }

    fn ranges(&self) -> Vec<Range<u32>> {
        let nodes = self.nodes.iter().map(|node| (node.first, node.count));
        points::ranges(nodes)
    }

    fn watch(&self, ray: &Ray, mode: Mode, seen: &mut Seen) {
        let walk = |ray: &Ray| Ok(self.trace_one(ray, &Asked::Mode(mode), seen));
        let _ = in_scaled_space(&self.geometry, ray, &mut Traced::default(), walk);
    }

    fn packed(&self) -> Vec<PrimRef> {
        self.packed.iter().map(|tri| tri.prim).collect()
    }

    fn all_hits(&self, ray: &Ray) -> Vec<PrimRef> {
        let hits = Mutex::new(Vec::new());
        let walk = |ray: &Ray| Ok(self.trace_one(ray, &Every(&hits), &mut crate::accel::probe::Off::plain()));
        let _ = in_scaled_space(&self.geometry, ray, &mut Traced::default(), walk);
        hits.into_inner().unwrap_or_default()
    }

    fn tests<'a>(&'a self, rays: &[Ray], pairs: &'a [(u32, u32)]) -> Box<dyn Fn() -> usize + 'a> {
        let space = self.geometry.space();
        let ready = |ray: &Ray| V::ray(&Line::new(&space.enter(ray).ray, self.geometry.bounds()));
        let ready: Vec<V::Ray> = rays.iter().map(ready).collect();
        Box::new(move || {
            let met = |(node, ray): &&(u32, u32)| {
                let volume = &self.nodes[*node as usize].volume;
                volume.interval(&self.shared, &ready[*ray as usize]).is_some()
            };
            pairs.iter().filter(met).count()
        })
    }
}
