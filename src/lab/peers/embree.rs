//! Embree: eight-wide SAH trees with AVX2, the fastest that is free; single rays and packets of eight.

use std::sync::Arc;
use std::time::Instant;

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, Rays, Recipe, live_indices, not_empty};
use crate::accel::Mode;
use crate::geometry::Ray;
use crate::scene::Geometry;
use crate::sys::embree::{Error, Library, NO_HIT, Packet, Prepared, RayHit, Scene, Settings};
use crate::task::Pool;

/// One of Embree's ways to build.
struct Embree {
    library: Arc<Library>,
    version: String,
    id: &'static str,
    high_quality: bool,
    robust: bool,
}

/// Medium and high quality, each fast and robust.
pub fn recipes() -> Result<Vec<Box<dyn Recipe>>, Error> {
    let library = Library::find()?;
    let version = library.version()?;
    let recipe = |(id, high_quality, robust)| {
        let (library, version) = (Arc::clone(&library), version.clone());
        Box::new(Embree { library, version, id, high_quality, robust }) as Box<dyn Recipe>
    };
    let all = [
        ("embree", false, false),
        ("embree-robust", false, true),
        ("embree-high", true, false),
        // Embree leaves spatial splits out of robust scenes, so this differs little from the second.
        ("embree-high-robust", true, true),
    ];
    Ok(all.map(recipe).into())
}

impl Recipe for Embree {
    fn label(&self) -> Label {
        Label::peer(self.id, &format!("Embree {}", self.version), self.robust)
    }

    fn calls(&self) -> &'static [Call] {
        &[Call::Single, Call::Packet8]
    }

    fn build(&self, geometry: &Arc<Geometry>, pool: &Pool) -> Result<Built, NotBuilt> {
        not_empty(geometry)?;
        let because = |error: Error| NotBuilt::Because(error.to_string());
        let settings = Settings { high_quality: self.high_quality, robust: self.robust, threads: pool.threads() };
        let (positions, indices) = (bytemuck::cast_slice(geometry.indexed().0), live_indices(geometry));
        let prepared = Prepared::new(&self.library, settings, positions, &indices).map_err(because)?;
        let start = Instant::now();
        let scene = prepared.commit().map_err(because)?;
        Ok(Built { secs: start.elapsed().as_secs_f64(), entrant: Box::new(Traced(scene)) })
    }
}

struct Traced(Scene);

impl Entrant for Traced {
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64 {
        let Self(scene) = self;
        let new = |ray: &Ray| RayHit::new(ray.origin.to_array(), ray.dir.to_array(), ray.tmin, ray.tmax);
        match (ask.call, ask.mode) {
            (Call::Packet8, _) => self.packets(rays.scaled, ask, &mut hits.found),
            (_, Mode::Any) => super::one_by_one(rays, hits, |ray| Found::any(scene.any(&mut new(ray), ask.coherent))),
            (_, Mode::Closest) => super::one_by_one(rays, hits, |ray| {
                let mut ray = new(ray);
                scene.closest(&mut ray, ask.coherent);
                Found::of((ray.prim != NO_HIT).then_some((ray.tfar, ray.prim)))
            }),
        }
    }

    fn bytes(&self) -> Option<u64> {
        Some(self.0.bytes())
    }
}

impl Traced {
    /// Eight neighbours of the list at a time; the last packet may have fewer.
    fn packets(&self, rays: &[Ray], ask: Ask, found: &mut Vec<Found>) -> u64 {
        found.clear();
        let mut packet = Packet::default();
        for eight in rays.chunks(8) {
            for (lane, ray) in eight.iter().enumerate() {
                packet.set(lane, ray.origin.to_array(), ray.dir.to_array(), ray.tmin, ray.tmax);
            }
            (eight.len()..8).for_each(|lane| packet.leave_out(lane));
            if ask.mode == Mode::Any {
                self.0.any8(&mut packet, ask.coherent);
                found.extend((0..eight.len()).map(|lane| Found::any(packet.occluded(lane))));
            } else {
                self.0.closest8(&mut packet, ask.coherent);
                found.extend((0..eight.len()).map(|lane| Found::of(packet.hit(lane))));
            }
        }
        found.iter().filter(|found| found.is_hit()).count() as u64
    }
}
