//! One pass of a picture: bands of rows in parallel, each a batch of rays, traced and shaded.

use rayon::prelude::*;
use std::ops::Range;
use std::sync::Arc;

use super::film::Band;
use super::light::Sources;
use super::sampler::{Sampler, Sampling, on_screen};
use super::shade::{occlusion_ray, shader};
use super::work::{Watch, Work};
use super::{Film, HeatRays, Looks, Mode, Transport};
use crate::accel::probe::Counts;
use crate::accel::{self, Accel, Hit, Visibility};
use crate::geometry::num::{floor_index, narrow};
use crate::geometry::{HalfSpace, Ray};
use crate::scene::{Camera, Frame, Scene};
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
    /// Which numbers samples are made of.
    pub sampling: Sampling,
    /// How far light is followed.
    pub transport: Transport,
    /// What of the world the camera's rays see, if not all of it; rays that leave what they meet see all.
    pub section: Option<HalfSpace>,
    /// Whose work is shown, where work is.
    pub heat_rays: HeatRays,
    /// Which triangles rays see, if not all; of what a structure does for a ray nothing is left out.
    pub visible: Option<Arc<Visibility>>,
}

impl std::fmt::Debug for Job {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Job").field("scene", &self.scene.name).field("mode", &self.mode).finish_non_exhaustive()
    }
}

/// Rows of a band: one batch of a few thousand rays.
const ROWS: usize = 4;

/// Columns and rows of pixels, in order, that get a sample.
type Pixels = Vec<(u32, u32)>;

impl Job {
    /// With independent samples, light followed as usual, and nothing cut away or hidden.
    pub fn new(scene: Arc<Scene>, accel: Arc<dyn Accel>, camera: Camera, mode: Mode, looks: Arc<Looks>) -> Self {
        let (sampling, transport, heat_rays) = (Sampling::default(), Transport::default(), HeatRays::default());
        Self { scene, accel, camera, mode, looks, sampling, transport, heat_rays, section: None, visible: None }
    }

    /// The camera rays of a sample, row by row.
    pub fn camera_rays(&self, width: u32, height: u32, rows: Range<u32>, sample: u32) -> Vec<Ray> {
        self.rays_of(rows.flat_map(|y| (0..width).map(move |x| (x, y))), [width, height], sample)
    }

    /// The camera's ray through the middle of a pixel.
    pub fn middle_ray(&self, (x, y): (u32, u32), [width, height]: [u32; 2]) -> Ray {
        let size = Vec2::new(width as f32, height as f32);
        self.ray_at(&self.camera.frame(), Vec2::new(x as f32, y as f32) + Vec2::splat(0.5), size)
    }

    /// The ray through a point of the picture, in pixels, as far as it is not cut away.
    fn ray_at(&self, frame: &Frame, at: Vec2, size: Vec2) -> Ray {
        let ray = self.camera.ray(frame, on_screen(at, size), size.x / size.y);
        self.section.map_or(ray, |section| section.cut(&ray))
    }

    /// Those of some pixels.
    pub(super) fn rays_of(&self, pixels: impl Iterator<Item = (u32, u32)>, [width, height]: [u32; 2], sample: u32) -> Vec<Ray> {
        let frame = self.camera.frame();
        let size = Vec2::new(width as f32, height as f32);
        let ray = |(x, y): (u32, u32)| {
            // The first sample is in the pixel's middle, where nothing is made of means.
            let middle = sample == 0 && self.mode != Mode::Path;
            let within = if middle { Vec2::splat(0.5) } else { self.sampling.of(x, y, sample).pair(0) };
            self.ray_at(&frame, Vec2::new(x as f32, y as f32) + within, size)
        };
        pixels.map(ray).collect()
    }

    /// Rays that a pixel takes for a sample, about: what a pass takes is foreseen by it.
    pub fn rays_per_pixel(&self) -> f64 {
        let leaving = self.mode.is_heat() && self.heat_rays != HeatRays::Primary;
        if leaving { 2.0 } else { self.mode.rays_per_pixel() }
    }

    /// Columns and rows outside of which no ray meets the scene's bounds. What a structure does with the camera's rays is shown
    /// for all of them.
    fn seen(&self, width: u32, height: u32) -> [Range<u32>; 2] {
        if self.mode.is_heat() && self.heat_rays == HeatRays::Primary {
            return [0..width, 0..height];
        }
        let Some([low, high]) = self.camera.window(self.accel.geometry().world_bounds(), width as f32 / height as f32) else {
            return [0..0, 0..0];
        };
        // Rays lie anywhere in their pixel.
        let span = |from: f64, to: f64, n: u32| {
            let pixel = |x: f64| floor_index((x * 0.5 + 0.5).clamp(0.0, 1.0) * f64::from(n), n as usize) as u32;
            pixel(from)..n.min(pixel(to) + 1)
        };
        [span(low.x, high.x, width), span(-high.y, -low.y, height)]
    }

    /// Adds one sample to every pixel but those that cannot see the scene, or have converged where the film asks for that
    /// ([`Film::converging`]).
    ///
    /// # Errors
    /// [`Cancelled`]; the film then holds a part of the pass and is of no use.
    pub fn pass(&self, film: &mut Film, pool: &Pool, cancel: &Cancel) -> Result<Work, Cancelled> {
        let (width, height, sample) = (film.width(), film.height(), film.samples());
        let [columns, seen] = self.seen(width, height);
        let converged = pool.run(|| film.converged());
        let sources = match self.mode {
            Mode::Path => Some(pool.run(|| self.looks.sources(&self.scene, self.accel.geometry(), cancel))?),
            _ => None,
        };
        let goes_on = |(x, y): &(u32, u32)| converged.as_ref().is_none_or(|converged| !converged[(y * width + x) as usize]);
        let bands: Vec<_> = film.bands_mut(ROWS).into_iter().enumerate().collect();
        let band = |(i, band): (usize, Band<'_>)| {
            let first = (i * ROWS) as u32;
            let rows = first.max(seen.start)..height.min(first + ROWS as u32).min(seen.end);
            let all = rows.flat_map(|y| columns.clone().map(move |x| (x, y)));
            let pixels: Pixels = all.filter(goes_on).collect();
            let work = self.band(band, first, (&pixels, sources.as_deref()), [width, height], sample, cancel)?;
            Ok((work, pixels.len()))
        };
        let sum = |a: (Work, usize), b: (Work, usize)| Ok((a.0 + b.0, a.1 + b.1));
        let (work, sampled) = pool.run(|| bands.into_par_iter().map(band).try_reduce(Default::default, sum))?;
        film.pass_done(sampled);
        Ok(work)
    }

    /// Adds a sample to some pixels of a band that begins with row `first`.
    fn band(
        &self,
        band: Band<'_>,
        first: u32,
        (pixels, sources): (&Pixels, Option<&Sources>),
        [width, height]: [u32; 2],
        sample: u32,
        cancel: &Cancel,
    ) -> Result<Work, Cancelled> {
        cancel.check()?;
        let (mut work, mut watch) = (Work::default(), Watch::start());
        let place = |(x, y): &(u32, u32)| ((y - first) * width + x) as usize;
        let rays = self.rays_of(pixels.iter().copied(), [width, height], sample);
        let mut samples = vec![[0.0; 4]; rays.len()];
        let mut hits = vec![None; rays.len()];
        work.rays = rays.len() as u64;
        watch.lap(&mut work.rest);
        let sampler = |i: usize| self.sampling.of(pixels[i].0, pixels[i].1, sample);
        if self.mode.is_heat() {
            work.rays += self.watch(&rays, sampler, &mut hits, &mut samples, cancel)?;
        } else {
            self.trace(&rays, accel::Mode::Closest, &mut hits, cancel)?;
        }
        watch.lap(&mut work.tracing);
        if !self.mode.is_heat() {
            self.shade(&rays, &hits, &mut samples);
        }
        if self.mode == Mode::Ao {
            watch.lap(&mut work.shading);
            work.rays += self.occlude(&rays, &hits, |i| sampler(i).pair(1), &mut samples, cancel)?;
            watch.lap(&mut work.tracing);
        }
        if let Some(sources) = sources {
            let first = (rays.clone(), hits.clone());
            self.follow(sources, first, sampler, &mut samples, (&mut work, &mut watch), cancel)?;
        }
        watch.lap(&mut work.shading);
        let Band { sums, depth, spreads } = band;
        if let Some(spreads) = spreads {
            let pixels = pixels.iter().map(place).zip(&samples);
            pixels.for_each(|(at, sample)| spreads[at].add(*sample, sums[at]));
        }
        for (at, sample) in pixels.iter().map(place).zip(&samples) {
            (0..4).for_each(|k| sums[at][k] += sample[k]);
        }
        if let Some(depth) = depth {
            // t is depth along the view: the camera's rays have unit length along it.
            let scale = self.accel.geometry().space().scale();
            let scaled = |hit: &Option<Hit>| hit.map_or(f32::INFINITY, |h| narrow(f64::from(h.t) * scale));
            pixels.iter().map(place).zip(&hits).for_each(|(at, hit)| depth[at] = scaled(hit));
        }
        watch.lap(&mut work.rest);
        Ok(work)
    }

    /// Finds what rays hit; where surfaces have holes, and where triangles are hidden, they pass.
    ///
    /// # Errors
    /// As [`Accel::trace`].
    pub fn trace(&self, rays: &[Ray], mode: accel::Mode, hits: &mut [Option<Hit>], cancel: &Cancel) -> Result<(), Cancelled> {
        let through = (self.accel.as_ref(), self.visible.as_deref());
        self.looks.trace(&self.scene, through, rays, mode, hits, cancel).map(|_| ())
    }

    /// What is seen of the hits; samples of rays that hit nothing are left as they are.
    pub fn shade(&self, rays: &[Ray], hits: &[Option<Hit>], samples: &mut [[f32; 4]]) {
        let shade = shader(self.mode, self.looks.needs());
        for ((ray, hit), sample) in rays.iter().zip(hits).zip(samples) {
            if let Some(hit) = hit {
                *sample = shade(self, ray, hit);
            }
        }
    }

    /// Traces and counts, one ray at a time. What a structure does is shown as if all surfaces were solid. Returns how many rays
    /// left what the camera's met.
    fn watch(
        &self,
        rays: &[Ray],
        sampler: impl Fn(usize) -> Sampler,
        hits: &mut [Option<Hit>],
        samples: &mut [[f32; 4]],
        cancel: &Cancel,
    ) -> Result<u64, Cancelled> {
        let counted = |ray: &Ray, mode: accel::Mode| -> Result<(Option<Hit>, u64, bool), Cancelled> {
            let mut counts = Counts::default();
            let hit = self.accel.trace_watched(ray, mode, &mut counts, cancel)?;
            Ok((hit, self.mode.amount(&counts), counts.nodes > 0))
        };
        if self.heat_rays == HeatRays::Primary {
            for ((ray, hit), sample) in rays.iter().zip(hits).zip(samples) {
                let (met, amount, entered) = counted(ray, accel::Mode::Closest)?;
                *hit = met;
                // A ray that does nothing at all is background; one that enters nodes may still have none that wait.
                let works = met.is_some() || amount > 0 || (entered && self.mode == Mode::Stack);
                *sample = [amount as f32, 0.0, 0.0, f32::from(u8::from(works))];
            }
            return Ok(0);
        }
        self.accel.trace(rays, accel::Mode::Closest, hits, cancel)?;
        let mut leaving = 0;
        for (i, ((ray, hit), sample)) in rays.iter().zip(hits.iter()).zip(samples).enumerate() {
            let Some(hit) = hit else { continue };
            let (_, amount, _) = counted(&self.leaving(ray, hit, &sampler(i)), self.heat_rays.mode())?;
            *sample = [amount as f32, 0.0, 0.0, 1.0];
            leaving += 1;
        }
        Ok(leaving)
    }

    /// Darkens the samples whose occlusion ray meets something; returns how many rays that took.
    fn occlude(
        &self,
        rays: &[Ray],
        hits: &[Option<Hit>],
        numbers: impl Fn(usize) -> Vec2,
        samples: &mut [[f32; 4]],
        cancel: &Cancel,
    ) -> Result<u64, Cancelled> {
        let geometry = self.accel.geometry();
        let open = |(i, hit): (usize, &Option<Hit>)| hit.map(|hit| (i, occlusion_ray(geometry, &rays[i], &hit, numbers(i))));
        let (at, probes): (Vec<usize>, Vec<Ray>) = hits.iter().enumerate().filter_map(open).unzip();
        let mut blocked = vec![None; probes.len()];
        self.trace(&probes, accel::Mode::Any, &mut blocked, cancel)?;
        for (i, _) in at.iter().zip(&blocked).filter(|(_, blocked)| blocked.is_some()) {
            samples[*i][..3].fill(0.0);
        }
        Ok(probes.len() as u64)
    }
}
