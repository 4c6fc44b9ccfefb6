//! One structure and one set of rays: the hits compared, then its rounds.

use rayon::prelude::*;
use std::borrow::Cow;
use std::time::Instant;

use super::{Ask, Entrant, Found, Hits, RayPairs, RayRow, Rays, same};
use crate::geometry::num::floor_index;
use crate::lab::MeasureOptions;
use crate::lab::estimate::rays_within;
use crate::lab::measure::chunk_len;
use crate::lab::sample::spread;
use crate::lab::statistics::{half_iqr, median};
use crate::lab::turns::{self, DONE, Racer};
use crate::scene::Geometry;
use crate::task::{Cancel, Cancelled, Pool};

/// A structure with its rays and the rounds it has done.
pub(super) struct Lane<'a> {
    entrant: &'a dyn Entrant,
    ask: Ask,
    /// The whole set, or a part of it.
    set: Cow<'a, RayPairs>,
    of: usize,
    hits: u64,
    differing: u64,
    secs: Vec<f64>,
}

impl<'a> Lane<'a> {
    /// Takes as many rays as the time allows, and compares their hits, which also warms up.
    pub fn compared(
        entrant: &'a dyn Entrant,
        ask: Ask,
        set: &'a RayPairs,
        (options, geometry): (&MeasureOptions, &Geometry),
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        const TRIED: usize = 4096;
        let of = set.len();
        let mut lane = Self { entrant, ask, set: Cow::Borrowed(set), of, hits: 0, differing: 0, secs: Vec::new() };
        if of > TRIED {
            let few = Self { set: Cow::Owned(set.picked(&spread(of, TRIED))), secs: Vec::new(), ..lane };
            few.pass(pool, cancel)?;
            let start = Instant::now();
            few.pass(pool, cancel)?;
            let secs_per_ray = start.elapsed().as_secs_f64() / few.set.len().max(1) as f64;
            let most = rays_within(options.cap_secs, options.min_rounds + 1, secs_per_ray);
            lane = Self { set: Cow::Borrowed(set), ..few };
            if most < of {
                lane.set = Cow::Owned(set.picked(&spread(of, floor_index(most as f64, of))));
            }
        }
        lane.compare(geometry, pool, cancel)?;
        Ok(lane)
    }

    fn compare(&mut self, geometry: &Geometry, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let (entrant, ask) = (self.entrant, self.ask);
        let expected = self.set.expected().par_chunks(self.chunk(pool));
        let chunk = |hits: &mut Hits, (rays, expected): (Rays<'_>, &[Found])| {
            cancel.check()?;
            let met = entrant.trace(rays, ask, hits);
            entrant.settle(rays, ask, geometry, hits);
            let differing = expected.iter().zip(&hits.found).filter(|(a, b)| same::differs(**a, **b, ask.mode)).count();
            Ok((met, differing as u64))
        };
        let sum = |a: (u64, u64), b: (u64, u64)| Ok((a.0 + b.0, a.1 + b.1));
        let all = || self.chunks(pool).zip(expected).map_init(Hits::default, chunk).try_reduce(|| (0, 0), sum);
        (self.hits, self.differing) = pool.run(all)?;
        Ok(())
    }

    /// Rays of a chunk: packets of eight are not cut.
    fn chunk(&self, pool: &Pool) -> usize {
        chunk_len(self.set.len(), pool.threads()).next_multiple_of(8)
    }

    fn chunks(&self, pool: &Pool) -> impl IndexedParallelIterator<Item = Rays<'_>> {
        let (Rays { world, scaled }, chunk) = (self.set.rays(), self.chunk(pool));
        world.par_chunks(chunk).zip(scaled.par_chunks(chunk)).map(|(world, scaled)| Rays { world, scaled })
    }

    /// Traces all rays once; hits go to a buffer of each thread's, small enough for its cache.
    fn pass(&self, pool: &Pool, cancel: &Cancel) -> Result<u64, Cancelled> {
        let (entrant, ask) = (self.entrant, self.ask);
        let trace = |hits: &mut Hits, rays: Rays<'_>| cancel.check().map(|()| entrant.trace(rays, ask, hits));
        pool.run(|| self.chunks(pool).map_init(Hits::default, trace).try_reduce(|| 0, |a, b| Ok(a + b)))
    }

    pub fn row(&self) -> RayRow {
        let (secs, count) = (&self.secs, self.set.len());
        RayRow {
            count,
            of: self.of,
            hits: self.hits,
            rounds: secs.len(),
            secs: median(secs),
            secs_spread: half_iqr(secs),
            secs_min: secs.iter().copied().fold(f64::NAN, f64::min),
            secs_max: secs.iter().copied().fold(f64::NAN, f64::max),
            mrays_per_sec: count as f64 / median(secs) * 1e-6,
            differing_rays: self.differing,
        }
    }
}

impl Racer for Lane<'_> {
    fn round(&mut self, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        self.pass(pool, cancel)?;
        self.secs.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share_done(&self, options: &MeasureOptions) -> u64 {
        // No rays need nothing.
        if self.set.is_empty() { DONE } else { turns::share(&self.secs, options) }
    }
}
