//! One pass of a picture: bands of rows in parallel, each a batch of rays, traced and shaded.

use rayon::prelude::*;
use std::sync::Arc;

use super::film::Band;
use super::sampler::{Sampler, in_pixel, on_screen};
use super::shade::{occlusion_ray, shade};
use super::{Film, Looks, Mode};
use crate::accel::probe::Counts;
use crate::accel::{self, Accel, Hit};
use crate::geometry::Ray;
use crate::geometry::num::narrow;
use crate::scene::{Camera, Scene};
use crate::task::{Cancel, Cancelled, Pool};
use glam::Vec2;

/// What is to be seen, and through which structure.
#[derive(Clone)]
pub struct Job {
    /// What surfaces look like.
    pub scene: Arc<Scene>,
    /// What finds the hits.
    pub accel: Arc<dyn Accel>,
    /// From where.
    pub camera: Camera,
    /// What is shown.
    pub mode: Mode,
    /// Textures, and where surfaces let rays pass.
    pub looks: Arc<Looks>,
}

impl std::fmt::Debug for Job {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Job").field("scene", &self.scene.name).field("mode", &self.mode).finish_non_exhaustive()
    }
}

/// Rows of a band: one batch of a few thousand rays.
const ROWS: usize = 4;

impl Job {
    /// The camera ray of a sample.
    pub fn camera_rays(&self, width: u32, height: u32, rows: std::ops::Range<u32>, sample: u32) -> Vec<Ray> {
        let frame = self.camera.frame();
        let size = Vec2::new(width as f32, height as f32);
        let ray = |x: u32, y: u32| {
            let at = Vec2::new(x as f32, y as f32) + in_pixel(x, y, sample);
            self.camera.ray(&frame, on_screen(at, size), size.x / size.y)
        };
        rows.flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| ray(x, y)).collect()
    }

    /// Adds one sample to every pixel, and returns the number of rays traced.
    ///
    /// # Errors
    /// [`Cancelled`]; the film then holds a part of the pass and is of no use.
    pub fn pass(&self, film: &mut Film, pool: &Pool, cancel: &Cancel) -> Result<u64, Cancelled> {
        let (width, height, sample) = (film.width(), film.height(), film.samples());
        let bands: Vec<_> = film.bands_mut(ROWS).into_iter().enumerate().collect();
        let band = |(i, (sums, depth)): (usize, Band<'_>)| {
            let first = (i * ROWS) as u32;
            let rows = first..height.min(first + ROWS as u32);
            self.band(sums, depth, width, height, rows, sample, cancel)
        };
        let rays = pool.run(|| bands.into_par_iter().map(band).try_reduce(|| 0, |a, b| Ok(a + b)))?;
        film.pass_done();
        Ok(rays)
    }

    #[expect(clippy::too_many_arguments, reason = "one band of one pass")]
    fn band(
        &self,
        sums: &mut [[f32; 4]],
        depth: Option<&mut [f32]>,
        width: u32,
        height: u32,
        rows: std::ops::Range<u32>,
        sample: u32,
        cancel: &Cancel,
    ) -> Result<u64, Cancelled> {
        let first_row = rows.start;
        let rays = self.camera_rays(width, height, rows, sample);
        let mut samples = vec![[0.0; 4]; rays.len()];
        let mut hits = vec![None; rays.len()];
        if self.mode.is_heat() {
            self.watch(&rays, &mut hits, &mut samples, cancel)?;
        } else {
            self.trace(&rays, accel::Mode::Closest, &mut hits, cancel)?;
            for ((ray, hit), sample) in rays.iter().zip(&hits).zip(&mut samples) {
                if let Some(hit) = hit {
                    *sample = shade(self, ray, hit);
                }
            }
        }
        let mut traced = rays.len() as u64;
        if self.mode == Mode::Ao {
            let pixel = |i: usize| Sampler::new(i as u32 % width, first_row + i as u32 / width, sample);
            traced += self.occlude(&rays, &hits, pixel, &mut samples, cancel)?;
        }
        for (sum, sample) in sums.iter_mut().zip(&samples) {
            (0..4).for_each(|k| sum[k] += sample[k]);
        }
        if let Some(depth) = depth {
            // t is depth along the view: the camera's rays have unit length along it.
            let scale = self.accel.geometry().space().scale();
            let scaled = |hit: &Option<Hit>| hit.map_or(f32::INFINITY, |h| narrow(f64::from(h.t) * scale));
            depth.iter_mut().zip(&hits).for_each(|(depth, hit)| *depth = scaled(hit));
        }
        Ok(traced)
    }

    fn trace(&self, rays: &[Ray], mode: accel::Mode, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<(), Cancelled> {
        self.looks.trace(&self.scene, self.accel.as_ref(), rays, mode, hits, cancel).map(|_| ())
    }

    /// Traces and counts, one ray at a time. What a structure does is shown as if all surfaces were solid.
    fn watch(&self, rays: &[Ray], hits: &mut [Option<Hit>], samples: &mut [[f32; 4]], cancel: &Cancel) -> Result<(), Cancelled> {
        for ((ray, hit), sample) in rays.iter().zip(hits).zip(samples) {
            let mut counts = Counts::default();
            *hit = self.accel.trace_watched(ray, accel::Mode::Closest, &mut counts, cancel)?;
            let amount = if self.mode == Mode::Nodes { counts.nodes } else { counts.prims };
            // A ray that does nothing at all is background.
            *sample = [amount as f32, 0.0, 0.0, f32::from(u8::from(hit.is_some() || amount > 0))];
        }
        Ok(())
    }

    /// Darkens the samples whose occlusion ray meets something; returns how many rays that took.
    fn occlude(
        &self,
        rays: &[Ray],
        hits: &[Option<Hit>],
        sampler: impl Fn(usize) -> Sampler,
        samples: &mut [[f32; 4]],
        cancel: &Cancel,
    ) -> Result<u64, Cancelled> {
        let geometry = self.accel.geometry();
        let open = |(i, hit): (usize, &Option<Hit>)| hit.map(|hit| (i, occlusion_ray(geometry, &rays[i], &hit, &sampler(i))));
        let (at, probes): (Vec<usize>, Vec<Ray>) = hits.iter().enumerate().filter_map(open).unzip();
        let mut blocked = vec![None; probes.len()];
        self.trace(&probes, accel::Mode::Any, &mut blocked, cancel)?;
        for (i, _) in at.iter().zip(&blocked).filter(|(_, blocked)| blocked.is_some()) {
            samples[*i][..3].fill(0.0);
        }
        Ok(probes.len() as u64)
    }
}
