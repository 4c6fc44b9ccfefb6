//! A case made ready: its geometry, and rays with what each passes and what may be said of it.

use std::sync::Arc;

use rayon::prelude::*;

use super::cases::Trial;
use super::judge::{Expected, expected};
use super::oracle::{Passing, passings};
use crate::accel::BuildCx;
use crate::geometry::Ray;
use crate::geometry::space::Entered;
use crate::geometry::tri::TestKind;
use crate::scene::{Geometry, LoadCx, Reason};
use crate::task::Cancelled;

/// What the rays of a case are traced through.
pub struct Ground {
    /// The triangles.
    pub geometry: Arc<Geometry>,
    /// Whether they are a closed surface.
    pub closed: bool,
}

/// Some rays of a case.
pub struct Shots<'a> {
    /// What they are traced through.
    pub ground: &'a Ground,
    /// The number of the first within the case.
    pub first: usize,
    /// The rays in the world.
    pub rays: &'a [Ray],
    /// The same as structures see them; none of what is no ray.
    pub entered: Vec<Option<Entered>>,
    passings: Vec<Vec<Passing>>,
}

/// Triangles and rays, multiplied, that are looked at at once: what a ray passes is kept for as long.
const AT_ONCE: usize = 1 << 20;
/// The most rays at once.
const RAYS: usize = 1 << 16;

impl Ground {
    /// A case's scene.
    ///
    /// # Errors
    /// Cancelled, or it would not fit.
    pub fn new(name: &str, trial: &Trial, cx: &BuildCx) -> Result<Self, Reason> {
        let load = LoadCx::new(cx.cancel.clone(), cx.progress.clone(), cx.budget.clone(), cx.pool.clone());
        Ok(Self { geometry: Arc::new(Geometry::new(&trial.scene(name), &load)?), closed: trial.closed })
    }

    /// How many rays are looked at at once.
    pub fn rays_at_once(&self) -> usize {
        (AT_ONCE / self.geometry.live_count().max(1)).clamp(16, RAYS)
    }

    /// Works out what rays pass, exactly; the first has that number.
    ///
    /// # Errors
    /// Cancelled.
    pub fn shots<'a>(&'a self, first: usize, rays: &'a [Ray], cx: &BuildCx) -> Result<Shots<'a>, Cancelled> {
        let geometry = &self.geometry;
        let enter = |ray: &Ray| ray.is_valid().then(|| geometry.space().enter(ray)).filter(|e| e.ray.tmin <= e.ray.tmax);
        let entered: Vec<Option<Entered>> = rays.iter().map(enter).collect();
        let pass = |entered: &Option<Entered>| {
            cx.cancel.check()?;
            Ok(entered.as_ref().map(|entered| passings(geometry, &entered.ray)).unwrap_or_default())
        };
        let passings: Result<Vec<Vec<Passing>>, Cancelled> = cx.pool.run(|| entered.par_iter().map(pass).collect());
        Ok(Shots { ground: self, first, rays, entered, passings: passings? })
    }
}

impl Shots<'_> {
    /// What a test may report of each ray; of one that is not valid, nothing.
    ///
    /// # Errors
    /// Cancelled.
    pub fn expected(&self, test: TestKind, cx: &BuildCx) -> Result<Vec<Option<Expected>>, Cancelled> {
        let Ground { geometry, closed } = self.ground;
        let of = |(entered, passings): (&Option<Entered>, &Vec<Passing>)| {
            cx.cancel.check()?;
            Ok(entered.as_ref().map(|entered| expected(test, geometry, *closed, &entered.ray, passings)))
        };
        cx.pool.run(|| self.entered.par_iter().zip(&self.passings).map(of).collect())
    }
}
