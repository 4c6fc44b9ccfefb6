//! The crate `obvhs`: PLOC with reinsertion. Its binary tree, at the presets that build fastest for what
//! they trace and that trace fastest for what they build, over triangles in the order of the leaves.

use std::sync::Arc;
use std::time::{Duration, Instant};

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, Rays, Recipe, live_corners, not_empty};
use crate::accel::Mode;
use crate::scene::Geometry;
use crate::task::Pool;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use obvhs::triangle::Triangle;

struct Obvhs {
    id: &'static str,
    params: BvhBuildParams,
}

/// The presets that matter.
pub fn recipes() -> Vec<Box<dyn Recipe>> {
    vec![
        Box::new(Obvhs { id: "obvhs", params: BvhBuildParams::very_fast_build() }),
        Box::new(Obvhs { id: "obvhs-medium", params: BvhBuildParams::medium_build() }),
    ]
}

impl Recipe for Obvhs {
    fn label(&self) -> Label {
        Label::peer(self.id, "obvhs 0.4", false)
    }

    fn calls(&self) -> &'static [Call] {
        &[Call::Single]
    }

    fn build(&self, geometry: &Arc<Geometry>, pool: &Pool) -> Result<Built, NotBuilt> {
        not_empty(geometry)?;
        let triangle = |[v0, v1, v2]: [glam::Vec3; 3]| Triangle { v0: v0.into(), v1: v1.into(), v2: v2.into() };
        let triangles: Vec<Triangle> = live_corners(geometry).map(triangle).collect();
        let start = Instant::now();
        let (bvh, triangles) = pool.run(|| {
            let bvh = build_bvh2_from_tris(&triangles, self.params, &mut Duration::default());
            let ordered = bvh.primitive_indices.iter().map(|i| (&triangles[*i as usize]).into()).collect();
            (bvh, ordered)
        });
        Ok(Built { secs: start.elapsed().as_secs_f64(), entrant: Box::new(Traced { bvh, triangles }) })
    }
}

struct Traced {
    bvh: Bvh2,
    triangles: Vec<RtTriangle>,
}

impl Entrant for Traced {
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64 {
        let Self { bvh, triangles } = self;
        let ray = |ray: &crate::geometry::Ray| Ray::new(ray.origin.into(), ray.dir.into(), ray.tmin, ray.tmax);
        super::one_by_one(rays, hits, |world| match ask.mode {
            Mode::Any => Found::any(!bvh.ray_traverse_miss(ray(world), |ray, i| triangles[i].intersect(ray))),
            Mode::Closest => {
                let mut hit = RayHit::none();
                let met = bvh.ray_traverse(ray(world), &mut hit, |ray, i| triangles[i].intersect(ray));
                Found::of(met.then(|| (hit.t, bvh.primitive_indices[hit.primitive_id as usize])))
            }
        })
    }

    fn bytes(&self) -> Option<u64> {
        let Self { bvh, triangles } = self;
        Some((size_of_val(&bvh.nodes[..]) + size_of_val(&bvh.primitive_indices[..]) + size_of_val(&triangles[..])) as u64)
    }
}
