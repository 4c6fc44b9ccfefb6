//! The crate `bvh`: a binary SAH tree with one triangle a leaf.
//!
//! Its own iterators either give every box along the ray, take memory for each ray, or fail on trees
//! deeper than 32. So its nodes are walked here, nearer child first, with its own box test, and what lies
//! behind the best hit is left out: faster than what it offers. Its triangle test passes by one side; this
//! is the same for both.

use std::sync::Arc;
use std::time::Instant;

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, Rays, Recipe, live_corners, not_empty};
use crate::accel::Mode;
use crate::scene::Geometry;
use crate::task::Pool;
use bvh::aabb::{Aabb, Bounded};
use bvh::bounding_hierarchy::{BHShape, BoundingHierarchy};
use bvh::bvh::{Bvh, BvhNode};
use bvh::ray::Ray;
use glam::Vec3;
use nalgebra::{Point3, Vector3};

struct BvhCrate;

/// One.
pub fn recipes() -> Vec<Box<dyn Recipe>> {
    vec![Box::new(BvhCrate)]
}

#[derive(Clone, Debug)]
struct Triangle {
    corners: [Vec3; 3],
    node: usize,
}

fn point(p: Vec3) -> Point3<f32> {
    Point3::new(p.x, p.y, p.z)
}

impl Bounded<f32, 3> for Triangle {
    fn aabb(&self) -> Aabb<f32, 3> {
        let [a, b, c] = self.corners;
        Aabb::with_bounds(point(a.min(b).min(c)), point(a.max(b).max(c)))
    }
}

impl BHShape<f32, 3> for Triangle {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

impl Recipe for BvhCrate {
    fn label(&self) -> Label {
        Label::peer("bvh-crate", "bvh 0.13", false)
    }

    fn calls(&self) -> &'static [Call] {
        &[Call::Single]
    }

    fn build(&self, geometry: &Arc<Geometry>, pool: &Pool) -> Result<Built, NotBuilt> {
        not_empty(geometry)?;
        let mut shapes: Vec<Triangle> = live_corners(geometry).map(|corners| Triangle { corners, node: 0 }).collect();
        let one_thread = pool.threads() == 1;
        let start = Instant::now();
        let bvh = pool.run(|| if one_thread { Bvh::build(&mut shapes) } else { Bvh::build_par(&mut shapes) });
        Ok(Built { secs: start.elapsed().as_secs_f64(), entrant: Box::new(Traced { bvh, shapes }) })
    }
}

struct Traced {
    bvh: Bvh<f32, 3>,
    shapes: Vec<Triangle>,
}

impl Entrant for Traced {
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64 {
        let mut stack = Vec::with_capacity(64);
        super::one_by_one(rays, hits, |ray| {
            let found = self.first(ray, ask.mode == Mode::Any, &mut stack);
            if ask.mode == Mode::Any { Found::any(found.is_hit()) } else { found }
        })
    }

    fn bytes(&self) -> Option<u64> {
        Some((size_of_val(&self.bvh.nodes[..]) + size_of_val(&self.shapes[..])) as u64)
    }
}

impl Traced {
    /// The closest hit, or with `any` the first that is found.
    fn first(&self, world: &crate::geometry::Ray, any: bool, stack: &mut Vec<(usize, f32)>) -> Found {
        let direction = Vector3::new(world.dir.x, world.dir.y, world.dir.z);
        let ray = Ray { origin: point(world.origin), direction, inv_direction: direction.map(|x| 1.0 / x) };
        let mut best = Found { t: world.tmax, prim: Found::NONE };
        stack.clear();
        stack.push((0, 0.0));
        while let Some((node, entry)) = stack.pop() {
            if entry > best.t {
                continue;
            }
            match &self.bvh.nodes[node] {
                BvhNode::Leaf { shape_index, .. } => {
                    if let Some(t) = meet(&self.shapes[*shape_index].corners, world).filter(|t| *t <= best.t) {
                        best = Found { t, prim: crate::geometry::num::index(*shape_index) };
                        if any {
                            break;
                        }
                    }
                }
                BvhNode::Node { child_l_index, child_l_aabb, child_r_index, child_r_aabb, .. } => {
                    let entry = |aabb| ray.intersection_slice_for_aabb(aabb).map(|(entry, _)| entry).filter(|t| *t <= best.t);
                    match (entry(child_l_aabb), entry(child_r_aabb)) {
                        (Some(l), Some(r)) if l < r => stack.extend([(*child_r_index, r), (*child_l_index, l)]),
                        (Some(l), Some(r)) => stack.extend([(*child_l_index, l), (*child_r_index, r)]),
                        (Some(l), None) => stack.push((*child_l_index, l)),
                        (None, Some(r)) => stack.push((*child_r_index, r)),
                        (None, None) => {}
                    }
                }
            }
        }
        if best.is_hit() { best } else { Found::MISS }
    }
}

/// Möller and Trumbore 1997, from both sides.
#[inline(always)]
fn meet([a, b, c]: &[Vec3; 3], ray: &crate::geometry::Ray) -> Option<f32> {
    let (ab, ac) = (*b - *a, *c - *a);
    let p = ray.dir.cross(ac);
    let det = ab.dot(p);
    if det == 0.0 {
        return None;
    }
    let (inv, s) = (1.0 / det, ray.origin - *a);
    let u = s.dot(p) * inv;
    if !(0.0..=1.0).contains(&u) {
        return None;
    }
    let q = s.cross(ab);
    let v = ray.dir.dot(q) * inv;
    let t = ac.dot(q) * inv;
    (v >= 0.0 && u + v <= 1.0 && t >= ray.tmin && t <= ray.tmax).then_some(t)
}
