//! Boxwood's own structures as they take part.

use std::sync::Arc;

use super::{Ask, Built, Call, Entrant, Found, Hits, Label, NotBuilt, Rays, Recipe};
use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::accel::{Accel, BuildCx, BuildError, Hit, Mode};
use crate::geometry::Ray;
use crate::geometry::tri::TestKind;
use crate::lab::build_timed;
use crate::scene::{Geometry, PrimRef};
use crate::task::{Budget, Cancel, Pool, Progress};

/// A registered structure, with its parameters and its triangle test.
#[derive(Clone, Debug)]
pub struct Ours {
    /// What its rows are called.
    pub id: String,
    /// Which.
    pub entry: &'static Entry,
    /// Its parameters.
    pub params: ParamValues,
    /// The triangle test.
    pub test: TestKind,
    /// What its memory is charged to.
    pub budget: Budget,
    /// Stops a build.
    pub cancel: Cancel,
}

impl Recipe for Ours {
    fn label(&self) -> Label {
        let library = format!("Boxwood {}", env!("CARGO_PKG_VERSION"));
        let params = self.params.iter().map(|(param, value)| (param.id, value)).collect();
        let watertight = self.test != TestKind::Fast;
        Label { id: self.id.clone(), library, peer: false, watertight, test: self.test.id(), params }
    }

    fn calls(&self) -> &'static [Call] {
        &[Call::Single, Call::Batch]
    }

    fn build(&self, geometry: &Arc<Geometry>, pool: &Pool) -> Result<Built, NotBuilt> {
        let cx = BuildCx::new(self.cancel.clone(), Progress::new(), pool.clone(), self.budget.clone());
        let built = build_timed(self.entry, geometry, self.test, &self.params, &cx).map_err(|error| match error {
            BuildError::Cancelled(cancelled) => cancelled.into(),
            error => NotBuilt::Because(error.to_string()),
        })?;
        Ok(Built { entrant: Box::new(Traced(built.accel)), secs: built.build_secs })
    }
}

struct Traced(Arc<dyn Accel>);

impl Entrant for Traced {
    fn trace(&self, rays: Rays<'_>, ask: Ask, hits: &mut Hits) -> u64 {
        // The race looks between chunks whether to stop.
        let never = Cancel::new();
        let hits = &mut hits.ours;
        hits.clear();
        hits.resize(rays.world.len(), None);
        if ask.call == Call::Single {
            for (ray, hit) in rays.world.iter().zip(&mut *hits) {
                let (ray, hit) = (std::slice::from_ref(ray), std::slice::from_mut(hit));
                let _ = self.0.trace(ray, ask.mode, hit, &never);
            }
        } else {
            let _ = self.0.trace(rays.world, ask.mode, hits, &never);
        }
        hits.iter().filter(|hit| hit.is_some()).count() as u64
    }

    fn settle(&self, rays: Rays<'_>, ask: Ask, geometry: &Geometry, hits: &mut Hits) {
        let Hits { found, ours } = hits;
        found.clear();
        found.extend(rays.world.iter().zip(&*ours).map(|(ray, hit)| self::found(ray, hit.as_ref(), ask.mode, geometry)));
    }

    fn bytes(&self) -> Option<u64> {
        Some(self.0.memory().iter().map(|part| part.bytes).sum())
    }
}

/// A hit as all are compared.
pub(super) fn found(ray: &Ray, hit: Option<&Hit>, mode: Mode, geometry: &Geometry) -> Found {
    match hit {
        None => Found::MISS,
        Some(_) if mode == Mode::Any => Found::SOMETHING,
        Some(hit) => {
            let t = geometry.space().enter(ray).back.scaled_t(hit.t);
            Found { t, prim: geometry.flat(hit.instance, hit.primitive).unwrap_or(PrimRef::MAX) }
        }
    }
}
