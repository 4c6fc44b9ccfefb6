//! Renders: every structure with every sampler, several times, in turns.

use std::sync::Arc;
use std::time::Instant;

use super::witness::{Agreement, agreement};
use crate::accel::Accel;
use crate::render::sampler::{SamplerKind, Sampling};
use crate::render::{Film, Job, Work};
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget, Pool, Progress};

/// A structure that takes part.
#[derive(Clone)]
pub struct Runner {
    /// Its id.
    pub id: String,
    /// The structure.
    pub accel: Arc<dyn Accel>,
    /// Seconds that it took to build.
    pub build_secs: f64,
}

/// What is rendered, and for how long.
#[derive(Clone, Debug)]
pub struct ConvergeOptions {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Samples in each pixel, at most.
    pub spp: u32,
    /// Seconds that a structure may render for, at most; one that is slow gets to fewer samples.
    pub secs: Option<f64>,
    /// How often each is timed.
    pub runs: u32,
    /// The samplers.
    pub samplers: Vec<SamplerKind>,
    /// Of the samples.
    pub seed: u32,
    /// Pixels that have converged get no more samples: then errors are those of a biased picture.
    pub adaptive: bool,
}

/// How it is done.
#[derive(Clone, Debug)]
pub struct ConvergeCx {
    /// Threads.
    pub pool: Pool,
    /// The request to stop.
    pub cancel: Cancel,
    /// How far it is.
    pub progress: Progress,
    /// Memory, for pictures that are kept.
    pub budget: Budget,
}

/// Why there is no outcome.
#[derive(Debug, thiserror::Error)]
pub enum ConvergeError {
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// The pictures do not fit the memory budget.
    #[error(transparent)]
    Memory(#[from] OverBudget),
}

/// What was rendered.
#[derive(Debug)]
pub struct Rendered {
    /// One for each structure and sampler.
    pub lanes: Vec<Lane>,
    /// How each structure agreed with the first, ray by ray, in the order of structures.
    pub agreements: Vec<(String, Agreement)>,
    _memory: Charge,
}

/// A structure with a sampler.
#[derive(Clone, Debug)]
pub struct Lane {
    /// The structure's id.
    pub structure: String,
    /// The sampler.
    pub sampler: SamplerKind,
    /// Seconds that the structure took to build.
    pub build_secs: f64,
    /// Its pictures, the one of the fewest samples first.
    pub shots: Vec<Shot>,
    /// What the longest took, of one run.
    pub work: Work,
}

/// The picture of so many samples.
#[derive(Clone, Debug)]
pub struct Shot {
    /// Samples in each pixel.
    pub spp: u32,
    /// Linear red, green and blue.
    pub pixels: Arc<Vec<[f32; 3]>>,
    /// Seconds to get there, of each run.
    pub secs: Vec<f64>,
    /// The share of pixels that got the last sample.
    pub share: f64,
}

impl Shot {
    /// Pixels that are not the same to the bit.
    pub fn differing(&self, other: &Self) -> u64 {
        if Arc::ptr_eq(&self.pixels, &other.pixels) {
            return 0;
        }
        let bits = |pixel: &[f32; 3]| pixel.map(f32::to_bits);
        self.pixels.iter().zip(other.pixels.iter()).filter(|(a, b)| bits(a) != bits(b)).count() as u64
    }
}

/// Renders the view of `job` through all structures with all samplers.
///
/// # Errors
/// It was stopped, or pictures do not fit into the memory.
pub fn render(job: &Job, runners: &[Runner], options: &ConvergeOptions, cx: &ConvergeCx) -> Result<Rendered, ConvergeError> {
    let mut memory = cx.budget.charge(0)?;
    let mut lanes: Vec<Lane> = Vec::new();
    let mut jobs: Vec<Job> = Vec::new();
    for runner in runners {
        for kind in &options.samplers {
            let sampling = Sampling { kind: *kind, seed: options.seed };
            jobs.push(Job { accel: Arc::clone(&runner.accel), sampling, ..job.clone() });
            let (structure, build_secs) = (runner.id.clone(), runner.build_secs);
            lanes.push(Lane { structure, sampler: *kind, build_secs, shots: Vec::new(), work: Work::default() });
        }
    }
    let rounds = lanes.len() as u64 * u64::from(options.runs);
    cx.progress.start("curves", rounds * STEPS);
    // What is worked out once, for whoever comes first, is not timed.
    for job in &jobs {
        job.pass(&mut Film::new(WARM, WARM), &cx.pool, &cx.cancel)?;
    }
    for run in 0..options.runs {
        for i in 0..lanes.len() {
            // In turns, so that whatever drifts meets everybody.
            let lane = (i + run as usize) % lanes.len();
            if run == 0 {
                let (before, rest) = lanes.split_at_mut(lane);
                first_run(&jobs[lane], &mut rest[0], before, options, cx, &mut memory)?;
            } else {
                again(&jobs[lane], &mut lanes[lane], options, cx)?;
            }
        }
    }
    let mut agreements = Vec::new();
    let of_first = Job { sampling: Sampling { kind: SamplerKind::Independent, seed: options.seed }, ..job.clone() };
    cx.progress.start("agreement", runners.len() as u64);
    for runner in runners {
        let of_first = Job { accel: Arc::clone(&runners[0].accel), ..of_first.clone() };
        let agreement = agreement(&of_first, &runner.accel, (options.size[0], options.size[1]), &cx.pool, &cx.cancel)?;
        agreements.push((runner.id.clone(), agreement));
        cx.progress.advance(1);
    }
    Ok(Rendered { lanes, agreements, _memory: memory })
}

/// Columns and rows of a pass that is not timed.
const WARM: u32 = 16;

/// Parts of a run that progress is told in.
const STEPS: u64 = 1000;

/// Tells the progress of one run.
struct Told(u64);

impl Told {
    fn tell(&mut self, share: f64, progress: &Progress) {
        let now = crate::geometry::num::floor_index(share.min(1.0) * STEPS as f64, STEPS as usize) as u64;
        progress.advance(now.saturating_sub(self.0));
        self.0 = now.max(self.0);
    }
}

fn film(options: &ConvergeOptions) -> Film {
    let [width, height] = options.size;
    if options.adaptive { Film::converging(width, height) } else { Film::new(width, height) }
}

/// Renders until there are enough samples or seconds, and keeps pictures. One that an earlier lane has made is shared.
fn first_run(
    job: &Job,
    lane: &mut Lane,
    before: &[Lane],
    options: &ConvergeOptions,
    cx: &ConvergeCx,
    memory: &mut Charge,
) -> Result<(), ConvergeError> {
    let (mut film, mut secs, mut told) = (film(options), 0.0, Told(0));
    let enough = |secs: f64| options.secs.is_some_and(|most| secs >= most);
    while film.samples() == 0 || !(film.is_done(options.spp) || enough(secs)) {
        let start = Instant::now();
        let work = job.pass(&mut film, &cx.pool, &cx.cancel)?;
        secs += start.elapsed().as_secs_f64();
        lane.work += work;
        let spp = film.samples();
        let by_samples = f64::from(spp) / f64::from(options.spp);
        told.tell(by_samples.max(options.secs.map_or(0.0, |most| secs / most)), &cx.progress);
        // Of a slow structure the last picture counts too, though it is of an odd number of samples.
        if spp.is_power_of_two() || film.is_done(options.spp) || enough(secs) {
            let pixels = film.linear();
            let same = |other: &&Shot| other.spp == spp && *other.pixels == pixels;
            let known = before.iter().filter(|other| other.sampler == lane.sampler).flat_map(|other| &other.shots).find(same);
            let pixels = match known {
                Some(known) => Arc::clone(&known.pixels),
                None => {
                    memory.grow(size_of_val(&pixels[..]) as u64)?;
                    Arc::new(pixels)
                }
            };
            lane.shots.push(Shot { spp, pixels, secs: vec![secs], share: film.share() });
        }
    }
    told.tell(1.0, &cx.progress);
    Ok(())
}

/// Renders the same once more, for the times alone.
fn again(job: &Job, lane: &mut Lane, options: &ConvergeOptions, cx: &ConvergeCx) -> Result<(), ConvergeError> {
    let (mut film, mut secs, mut told) = (film(options), 0.0, Told(0));
    let last = lane.shots.last().map_or(0, |shot| shot.spp);
    while film.samples() < last {
        let start = Instant::now();
        job.pass(&mut film, &cx.pool, &cx.cancel)?;
        secs += start.elapsed().as_secs_f64();
        told.tell(f64::from(film.samples()) / f64::from(last), &cx.progress);
        if let Some(shot) = lane.shots.iter_mut().find(|shot| shot.spp == film.samples()) {
            shot.secs.push(secs);
        }
    }
    Ok(())
}
