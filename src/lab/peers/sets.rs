//! The rays of a race, once in the world and once in the scaled space.

use super::{Found, Rays, ours};
use crate::accel::{Accel, Hit, Mode};
use crate::geometry::Ray;
use crate::lab::{RayKind, RaySet};
use crate::task::{Cancel, Cancelled, Pool};
use rayon::prelude::*;

/// Rays of one kind as everybody gets them, with what the reference hits.
#[derive(Clone, Debug)]
pub struct RayPairs {
    /// What they are for.
    pub kind: RayKind,
    /// What is asked of them.
    pub mode: Mode,
    world: Vec<Ray>,
    scaled: Vec<Ray>,
    expected: Vec<Found>,
}

/// Rays looked at between two looks at the cancel flag.
const CHUNK: usize = 4096;

impl RayPairs {
    /// Bytes of so many rays.
    pub const fn bytes(rays: u64) -> u64 {
        rays * (2 * size_of::<Ray>() + size_of::<Found>()) as u64
    }

    /// Brings the rays into the scaled space, and traces them with the reference. Left out are those
    /// that cannot hit anything or do not start at t = 0: some peers know no other start.
    ///
    /// # Errors
    /// [`Cancelled`] within 100 ms of the request.
    pub fn of(set: &RaySet, reference: &dyn Accel, pool: &Pool, cancel: &Cancel) -> Result<Self, Cancelled> {
        let geometry = reference.geometry();
        let enter = |ray: &Ray| {
            let scaled = ray.is_valid().then(|| geometry.space().enter(ray).ray)?;
            (scaled.tmin == 0.0 && scaled.tmax >= 0.0).then_some((*ray, scaled))
        };
        let (world, scaled): (Vec<Ray>, Vec<Ray>) = pool.run(|| set.rays.par_iter().filter_map(enter).unzip());
        let expect = |rays: &[Ray]| expected(reference, set.mode, rays, cancel);
        let expected: Result<Vec<Vec<Found>>, Cancelled> = pool.run(|| world.par_chunks(CHUNK).map(expect).collect());
        Ok(Self { kind: set.kind, mode: set.mode, expected: expected?.concat(), world, scaled })
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.world.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.world.is_empty()
    }

    /// All of them.
    pub fn rays(&self) -> Rays<'_> {
        Rays { world: &self.world, scaled: &self.scaled }
    }

    /// What the reference hits.
    pub fn expected(&self) -> &[Found] {
        &self.expected
    }

    /// Those at some places.
    pub fn picked(&self, places: &[usize]) -> Self {
        let pick = |rays: &[Ray]| places.iter().map(|i| rays[*i]).collect();
        let expected = places.iter().map(|i| self.expected[*i]).collect();
        Self { kind: self.kind, mode: self.mode, world: pick(&self.world), scaled: pick(&self.scaled), expected }
    }
}

fn expected(reference: &dyn Accel, mode: Mode, world: &[Ray], cancel: &Cancel) -> Result<Vec<Found>, Cancelled> {
    let mut hits = vec![None; world.len()];
    reference.trace(world, mode, &mut hits, cancel)?;
    let found = |(ray, hit): (&Ray, &Option<Hit>)| ours::found(ray, hit.as_ref(), mode, reference.geometry());
    Ok(world.iter().zip(&hits).map(found).collect())
}
