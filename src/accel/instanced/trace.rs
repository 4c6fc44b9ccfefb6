//! How a ray goes through both levels.
//!
//! The upper level works in the scene's scaled space. A place's ray is that one taken into the mesh's space in 64 bits and
//! rounded once ([`Space::enter_mapped`](crate::geometry::Space::enter_mapped)); t comes back the same way. So a hit does not
//! depend on which places were visited before: the closest is the same in any order, to the bit.

use super::{Below, Instanced};
use crate::accel::bvh::{MAX_DEPTH, Node};
use crate::accel::hit::{Accepts, Asked, Filter, Hit, Mode, PrimHit};
use crate::accel::probe::{Counts, Off, Probe, Prune, Watched};
use crate::accel::{Accel, Traced};
use crate::geometry::{Ray, Slabs};
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled};
use std::sync::Arc;

/// What the lower level answers.
type Answer = Result<Option<PrimHit>, Cancelled>;

/// Asks the structure of an entry: the second ray may be asked in another mode than the first.
trait Ask<P> {
    fn ask(&self, below: Below<'_>, ray: &Ray, mode: Mode, probe: &mut P) -> Answer;
}

/// The closest hit so far, in the scene's scaled space.
struct Nearest {
    t: f32,
    hit: Option<Hit>,
}

impl Nearest {
    /// Keeps a hit if it is closer, or as close with a lower index.
    fn offer(&mut self, hit: Hit) {
        let before = |kept: &Hit| (hit.instance, hit.primitive) < (kept.instance, kept.primitive);
        // The ray's own end is closed.
        let closer = hit.t < self.t || hit.t == self.t && self.hit.as_ref().is_none_or(before);
        if closer {
            (self.t, self.hit) = (hit.t, Some(hit));
        }
    }
}

/// One ray through both levels.
struct Walk<'a, P, A> {
    of: &'a Instanced,
    ray: &'a Ray,
    mode: Mode,
    asker: &'a A,
    probe: &'a mut P,
    nearest: Nearest,
}

impl<P: Probe, A: Ask<P>> Walk<'_, P, A> {
    /// Visits the entries whose boxes the ray meets, near ones first.
    fn run(mut self) -> Result<Option<Hit>, Cancelled> {
        let top = &self.of.top;
        self.probe.waiting(0);
        if top.nodes.is_empty() {
            for entry in &top.entries {
                if self.visit(*entry)? {
                    break;
                }
            }
            return Ok(self.nearest.hit);
        }
        let slabs = Slabs::new(self.ray, self.of.geometry.space().bounds());
        let mut stack = [(0u32, 0f32); MAX_DEPTH as usize + 1];
        let mut open = usize::from(self.enter(&slabs, 0).is_some());
        while open > 0 {
            open -= 1;
            let (at, entry) = stack[open];
            if entry > self.nearest.t {
                self.probe.pruned(at, Prune::BehindHit);
                continue;
            }
            self.probe.node();
            self.probe.at(at);
            self.probe.waiting(open);
            let node = &top.nodes[at as usize];
            let Some(left) = node.left() else {
                for entry in &top.entries[node.range()] {
                    if self.visit(*entry)? {
                        return Ok(self.nearest.hit);
                    }
                }
                continue;
            };
            let (a, b) = (self.enter(&slabs, left).map(|t| (left, t)), self.enter(&slabs, left + 1).map(|t| (left + 1, t)));
            let far_first = if matches!((a, b), (Some(a), Some(b)) if a.1 <= b.1) { [b, a] } else { [a, b] };
            for child in far_first.into_iter().flatten() {
                stack[open] = child;
                open += 1;
            }
        }
        Ok(self.nearest.hit)
    }

    /// Where the ray enters a node, if it does so before the nearest hit.
    fn enter(&mut self, slabs: &Slabs, at: u32) -> Option<f32> {
        let (entry, exit) = slabs.interval(&Node::bounds(&self.of.top.nodes[at as usize]));
        let inside = (entry <= exit) & (entry <= self.nearest.t) & (exit >= self.ray.tmin);
        if P::LISTENS && !inside {
            let outside = if entry > self.ray.tmax || exit < self.ray.tmin { Prune::Outside } else { Prune::BehindHit };
            self.probe.pruned(at, if entry > exit { Prune::Missed } else { outside });
        }
        inside.then_some(entry)
    }

    /// Asks an entry; true if the search is over.
    fn visit(&mut self, number: u32) -> Result<bool, Cancelled> {
        let Some(below) = self.of.below(number) else { return Ok(false) };
        self.probe.level(number + 1);
        match below {
            Below::Rest(_) => {
                let ray = Ray { tmax: self.nearest.t, ..*self.ray };
                if let Some(hit) = self.asker.ask(below, &ray, self.mode, self.probe)? {
                    let (instance, primitive) = self.of.geometry.locate(hit.prim);
                    self.nearest.offer(Hit { t: hit.t, u: hit.u, v: hit.v, instance, primitive });
                }
            }
            Below::Part(place, accel) => {
                let ray = Ray { tmax: self.nearest.t, ..*self.ray };
                let entered = accel.geometry().space().enter_mapped(&ray, place.part_from_scene());
                if entered.ray.tmin > entered.ray.tmax {
                    self.probe.level(0);
                    return Ok(false);
                }
                let in_scene = |hit: PrimHit| {
                    let t = entered.back.world_t(hit.t).max(ray.tmin);
                    Hit { t, u: hit.u, v: hit.v, instance: place.instance, primitive: hit.prim }
                };
                let mut hit = self.asker.ask(below, &entered.ray, self.mode, self.probe)?.map(in_scene);
                // The interval was widened by a rounding: what was found there may hide what is in the ray's own.
                if self.mode == Mode::Any && hit.is_some_and(|hit| hit.t > ray.tmax) {
                    hit = self.asker.ask(below, &entered.ray, Mode::Closest, self.probe)?.map(in_scene);
                }
                hit.into_iter().for_each(|hit| self.nearest.offer(hit));
            }
        }
        self.probe.level(0);
        Ok(self.mode == Mode::Any && self.nearest.hit.is_some())
    }
}

/// Nobody watches.
struct Fast<'a> {
    off: Off,
    cancel: &'a Cancel,
}

impl Ask<Off> for Fast<'_> {
    fn ask(&self, below: Below<'_>, ray: &Ray, mode: Mode, _: &mut Off) -> Answer {
        below.accel().trace_scaled(ray, mode, self.off, self.cancel)
    }
}

/// Only some hits count.
struct Sifted<'a> {
    geometry: &'a Geometry,
    filter: &'a dyn Filter,
    cancel: &'a Cancel,
}

impl Ask<Off> for Sifted<'_> {
    fn ask(&self, below: Below<'_>, ray: &Ray, mode: Mode, _: &mut Off) -> Answer {
        let accepts = |hit: &PrimHit| {
            let (instance, primitive) = match below {
                Below::Part(place, _) => (place.instance, hit.prim),
                Below::Rest(_) => self.geometry.locate(hit.prim),
            };
            self.filter.accepts(&Hit { t: hit.t, u: hit.u, v: hit.v, instance, primitive })
        };
        below.accel().trace_scaled_filtered(ray, mode, &accepts, self.cancel)
    }
}

/// Somebody does.
struct Heard<'a> {
    /// Whether hits count.
    hits: bool,
    cancel: &'a Cancel,
}

impl Ask<Watched<'_>> for Heard<'_> {
    fn ask(&self, below: Below<'_>, ray: &Ray, mode: Mode, watched: &mut Watched<'_>) -> Answer {
        let asked = if self.hits { Asked::Mode(mode) } else { Asked::Nothing };
        below.accel().trace_scaled_heard(ray, asked, watched, self.cancel)
    }
}

impl Instanced {
    fn walk<P: Probe, A: Ask<P>>(&self, ray: &Ray, mode: Mode, asker: &A, probe: &mut P) -> Result<Option<Hit>, Cancelled> {
        let nearest = Nearest { t: ray.tmax, hit: None };
        Walk { of: self, ray, mode, asker, probe, nearest }.run()
    }

    /// A world ray's hit, in the world.
    fn in_world(
        &self,
        ray: &Ray,
        traced: &mut Traced,
        trace: impl FnOnce(&Ray) -> Result<Option<Hit>, Cancelled>,
    ) -> Result<Option<Hit>, Cancelled> {
        if !ray.is_valid() {
            traced.invalid += 1;
            return Ok(None);
        }
        let entered = self.geometry.space().enter(ray);
        if entered.ray.tmin > entered.ray.tmax {
            return Ok(None);
        }
        Ok(trace(&entered.ray)?.map(|hit| Hit { t: entered.back.world_t(hit.t), ..hit }))
    }

    fn batch<A: Ask<Off>>(
        &self,
        rays: &[Ray],
        mode: Mode,
        hits: &mut [Option<Hit>],
        asker: &A,
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        let (mut traced, mut off) = (Traced::default(), Off::plain());
        for (ray, hit) in rays.iter().zip(hits) {
            cancel.check()?;
            *hit = self.in_world(ray, &mut traced, |ray| self.walk(ray, mode, asker, &mut off))?;
        }
        Ok(traced)
    }
}

impl Accel for Instanced {
    fn geometry(&self) -> &Arc<Geometry> {
        &self.geometry
    }

    fn trace(&self, rays: &[Ray], mode: Mode, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<Traced, Cancelled> {
        self.batch(rays, mode, hits, &Fast { off: Off::best(), cancel }, cancel)
    }

    fn trace_filtered(
        &self,
        rays: &[Ray],
        mode: Mode,
        filter: &dyn Filter,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        self.batch(rays, mode, hits, &Sifted { geometry: &self.geometry, filter, cancel }, cancel)
    }

    fn trace_like_for_like(
        &self,
        rays: &[Ray],
        mode: Mode,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        self.batch(rays, mode, hits, &Fast { off: Off::plain(), cancel }, cancel)
    }

    fn trace_heard(&self, ray: &Ray, mode: Mode, watched: &mut Watched<'_>, cancel: &Cancel) -> Result<Option<Hit>, Cancelled> {
        let local = |ray: &Ray| self.walk(ray, mode, &Heard { hits: true, cancel }, watched);
        self.in_world(ray, &mut Traced::default(), local)
    }

    fn count_uncut(&self, ray: &Ray, counts: &mut Counts, cancel: &Cancel) -> Result<(), Cancelled> {
        let mut watched = Watched { counts, listener: None };
        let local = |ray: &Ray| self.walk(ray, Mode::Closest, &Heard { hits: false, cancel }, &mut watched);
        self.in_world(ray, &mut Traced::default(), local).map(|_| ()) // there is no hit
    }

    fn trace_scaled(&self, _: &Ray, _: Mode, _: Off, _: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        Ok(None)
    }

    fn trace_scaled_filtered(&self, _: &Ray, _: Mode, _: Accepts<'_>, _: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        Ok(None)
    }

    fn trace_scaled_heard(&self, _: &Ray, _: Asked, _: &mut Watched<'_>, _: &Cancel) -> Result<Option<PrimHit>, Cancelled> {
        Ok(None)
    }

    fn geometry_of(&self, instance: u32) -> &Arc<Geometry> {
        self.geometry_below(instance)
    }

    fn levels(&self) -> Option<&Instanced> {
        Some(self)
    }
}
