//! The crate `parry3d`: the binary tree of a physics library.

use std::cell::Cell;
use std::sync::Arc;
use std::time::Instant;

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, Rays, Recipe, live_indices, not_empty};
use crate::accel::Mode;
use crate::scene::Geometry;
use crate::task::Pool;
use parry3d::math::Vector;
use parry3d::partitioning::{BvhNode, TraversalAction};
use parry3d::query::{Ray, RayCast};
use parry3d::shape::{CompositeShapeRef, TriMesh};

struct Parry;

/// One.
pub fn recipes() -> Vec<Box<dyn Recipe>> {
    vec![Box::new(Parry)]
}

impl Recipe for Parry {
    fn label(&self) -> Label {
        Label::peer("parry3d", "parry3d 0.31", false)
    }

    fn calls(&self) -> &'static [Call] {
        &[Call::Single]
    }

    fn build(&self, geometry: &Arc<Geometry>, pool: &Pool) -> Result<Built, NotBuilt> {
        not_empty(geometry)?;
        let positions: Vec<Vector> = geometry.indexed().0.iter().map(|p| Vector::from_array(p.to_array())).collect();
        let indices = live_indices(geometry);
        let start = Instant::now();
        let mesh = pool.run(|| TriMesh::new(positions, indices)).map_err(|error| NotBuilt::Because(error.to_string()))?;
        Ok(Built { secs: start.elapsed().as_secs_f64(), entrant: Box::new(Traced(mesh)) })
    }
}

struct Traced(TriMesh);

impl Entrant for Traced {
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64 {
        let vector = |v: glam::Vec3| Vector::from_array(v.to_array());
        super::one_by_one(rays, hits, |ray| {
            let (tmax, ray) = (ray.tmax.min(f32::MAX), Ray::new(vector(ray.origin), vector(ray.dir)));
            match ask.mode {
                Mode::Any => Found::any(self.any(&ray, tmax)),
                Mode::Closest => Found::of(CompositeShapeRef(&self.0).cast_local_ray(&ray, tmax, true).map(|(i, t)| (t, i))),
            }
        })
    }

    fn bytes(&self) -> Option<u64> {
        Some(self.0.total_memory_size() as u64)
    }
}

impl Traced {
    /// Goes down until a triangle is hit; the library itself offers the closest hit alone.
    fn any(&self, ray: &Ray, tmax: f32) -> bool {
        let hit = Cell::new(false);
        self.0.bvh().traverse(|node: &BvhNode| {
            let entry = node.cast_ray(ray, tmax);
            if entry > tmax || entry == f32::MAX {
                return TraversalAction::Prune;
            }
            if let Some(i) = node.leaf_data() {
                hit.set(self.0.triangle(i).cast_local_ray(ray, tmax, true).is_some());
            }
            if hit.get() { TraversalAction::EarlyExit } else { TraversalAction::Continue }
        });
        hit.get()
    }
}
