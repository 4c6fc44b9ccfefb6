//! The rasteriser beside the structures: the same view, the same samples, the same threads, its
//! rounds among theirs.

use serde::Serialize;
use std::time::Instant;

use super::differing::{Differing, differing};
use super::measure::{Contestant, MeasureOptions, measure_beside};
use super::rays::RaySet;
use super::timing::Timing;
use super::turns::{Racer, share};
use crate::accel::Accel;
use crate::render::Job;
use crate::render::raster::{Counts, Raster};
use crate::scene::{Camera, Geometry};
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// How long a picture took to rasterise, and what was drawn. Field names are the schema: they stay.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct RasterRow {
    /// Samples: one for each primary ray.
    pub count: usize,
    /// Samples where something is seen.
    pub hits: u64,
    /// Rounds that were timed.
    pub rounds: usize,
    /// The median over rounds of the seconds of one.
    pub secs: f64,
    /// Half the interquartile range of those seconds.
    pub secs_spread: f64,
    /// Samples of a round over its median seconds, in millions: what a tracer's rays are.
    pub mrays_per_sec: f64,
    /// Total pixels covered: samples that triangles cover, hidden ones too.
    pub covered: u64,
    /// The same for each sample where something is seen; NaN (`null` in JSON) if there are none.
    pub overdraw: f64,
    /// Triangles drawn.
    pub set_up: u64,
    /// Triangles not drawn: behind the eye, off the screen, between samples, or edge on.
    pub culled: u64,
    /// Triangles drawn that reach behind the eye.
    pub crossing: u64,
    /// Samples where a traced primary ray hits another triangle.
    pub differing: Differing,
}

impl RasterRow {
    /// The name in tables.
    pub const ID: &'static str = "raster";

    /// As a row of a table of structures; what only structures have is missing.
    pub fn timing(&self) -> Timing {
        let none = f64::NAN;
        Timing {
            id: Self::ID.to_owned(),
            rays: self.count,
            of: self.count,
            hits: self.hits,
            rounds: self.rounds,
            secs_median: self.secs,
            secs_half_iqr: self.secs_spread,
            mrays_per_sec: self.mrays_per_sec,
            nodes_per_ray: none,
            leaves_per_ray: none,
            prims_per_ray: none,
            lcv: none,
            ..Timing::default()
        }
    }
}

/// Measures structures with the primary rays of a view of `size` pixels, and the rasteriser with the
/// view itself, in turns. The job's structure finds what the picture is compared with.
///
/// A picture cannot be drawn in part: a rasteriser that is too slow does fewer rounds, one at least.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
#[expect(clippy::too_many_arguments, reason = "what measuring takes, and a view")]
pub fn measure_with_raster(
    contestants: &[Contestant],
    set: &RaySet,
    job: &Job,
    size: [u32; 2],
    options: &MeasureOptions,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<(Vec<Timing>, RasterRow), Cancelled> {
    let geometry = job.accel.geometry();
    let mut lane = Lane::warmed_up(geometry, &job.camera, size, pool, cancel, progress)?;
    let timings = measure_beside(contestants, Some(&mut lane), set, options, pool, cancel, progress)?;
    let row = lane.row(job.accel.as_ref(), set, pool, cancel)?;
    Ok((timings, row))
}

/// The rasteriser and the rounds that it has done.
struct Lane<'a> {
    geometry: &'a Geometry,
    camera: &'a Camera,
    raster: Raster,
    counts: Counts,
    secs: Vec<f64>,
}

impl<'a> Lane<'a> {
    fn warmed_up(
        geometry: &'a Geometry,
        camera: &'a Camera,
        [width, height]: [u32; 2],
        pool: &Pool,
        cancel: &Cancel,
        progress: &Progress,
    ) -> Result<Self, Cancelled> {
        let mut raster = Raster::new(width, height);
        let counts = raster.draw(geometry, camera, pool, cancel, progress)?;
        Ok(Self { geometry, camera, raster, counts, secs: Vec::new() })
    }

    fn row(&self, accel: &dyn Accel, set: &RaySet, pool: &Pool, cancel: &Cancel) -> Result<RasterRow, Cancelled> {
        let counts = self.counts;
        let timing = Timing::of_rounds(RasterRow::ID, set.rays.len(), set.rays.len(), counts.drawn, &self.secs);
        Ok(RasterRow {
            count: timing.rays,
            hits: timing.hits,
            rounds: timing.rounds,
            secs: timing.secs_median,
            secs_spread: timing.secs_half_iqr,
            mrays_per_sec: timing.mrays_per_sec,
            covered: counts.covered,
            overdraw: counts.overdraw(),
            set_up: counts.set_up,
            culled: counts.culled,
            crossing: counts.crossing,
            differing: differing(&self.raster, accel, &set.rays, pool, cancel)?,
        })
    }
}

impl Racer for Lane<'_> {
    fn round(&mut self, pool: &Pool, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        // Nobody listens: the rounds' own progress is told by whoever gives out turns.
        self.raster.draw(self.geometry, self.camera, pool, cancel, &Progress::new())?;
        self.secs.push(start.elapsed().as_secs_f64());
        Ok(())
    }

    fn share_done(&self, options: &MeasureOptions) -> u64 {
        let capped = !self.secs.is_empty() && self.secs.iter().sum::<f64>() >= options.cap_secs;
        if capped { super::turns::DONE } else { share(&self.secs, options) }
    }
}
