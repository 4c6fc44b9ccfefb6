//! tinybvh: its fastest layout for processors, eight-wide with AVX2, from binned SAH builds and from ones
//! with spatial splits. It builds on all cores, however many threads are asked for.

use std::sync::Arc;
use std::time::Instant;

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, Rays, Recipe, live_corners, not_empty};
use crate::accel::Mode;
use crate::scene::Geometry;
use crate::sys::tinybvh::{Wide, supported};
use crate::task::Pool;

struct TinyBvh {
    id: &'static str,
    spatial_splits: bool,
}

/// Without and with spatial splits; `None` where the processor can't.
pub fn recipes() -> Option<Vec<Box<dyn Recipe>>> {
    supported().then(|| {
        vec![
            Box::new(TinyBvh { id: "tinybvh", spatial_splits: false }) as Box<dyn Recipe>,
            Box::new(TinyBvh { id: "tinybvh-hq", spatial_splits: true }),
        ]
    })
}

impl Recipe for TinyBvh {
    fn label(&self) -> Label {
        Label::peer(self.id, "tinybvh 1.6.8", false)
    }

    fn calls(&self) -> &'static [Call] {
        &[Call::Single]
    }

    fn build(&self, geometry: &Arc<Geometry>, _: &Pool) -> Result<Built, NotBuilt> {
        not_empty(geometry)?;
        let corners: Vec<[f32; 4]> = live_corners(geometry).flatten().map(|p| p.extend(0.0).to_array()).collect();
        let start = Instant::now();
        let wide = Wide::new(corners, self.spatial_splits);
        let secs = start.elapsed().as_secs_f64();
        let why = || NotBuilt::Because("more triangles than tinybvh counts".to_owned());
        Ok(Built { entrant: Box::new(Traced(wide.ok_or_else(why)?)), secs })
    }
}

struct Traced(Wide);

impl Entrant for Traced {
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64 {
        super::one_by_one(rays, hits, |ray| {
            let (origin, dir) = (ray.origin.to_array(), ray.dir.to_array());
            match ask.mode {
                Mode::Any => Found::any(self.0.any(origin, dir, ray.tmax)),
                Mode::Closest => Found::of(self.0.closest(origin, dir, ray.tmax)),
            }
        })
    }

    fn bytes(&self) -> Option<u64> {
        None
    }
}
