//! Refines a picture on threads of its own: a coarse pass of the whole view first, fine enough to
//! come within [`FIRST_PASS_SECS`], then finer ones, then samples that accumulate to a limit, or until all
//! pixels have converged; then the processors rest.
//!
//! ```text
//! request ─► step 8 ─► 4 ─► 2 ─► 1 ─► 2nd sample ─► 3rd … limit ─► wait
//!               └─ each finished pass becomes a Picture; a new request stops the pass that runs
//! ```

use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Condvar, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use super::tile::Job;
use super::{Amounts, Development, Film, Mode, Picture, Progress, Range, Shot, Tone, auto_range};
use crate::accel;
use crate::accel::probe::Counts;
use crate::task::{Budget, Cancel, Cancelled, Pool};

/// The time in which the first, coarse pass should be there, so that a frame can hold on for it. It may
/// well take twice as long: the first rays through a cold structure foresee little.
pub const FIRST_PASS_SECS: f64 = 0.012;
/// The coarsest pass: one pixel for this many on each axis.
const COARSEST: u32 = 64;
/// What a pixel is thought to take besides its ray before anything was learnt, in seconds.
const FIRST_OVERHEAD_SECS: f64 = 2e-7;
/// Camera rays counted for the figures beside the picture.
const COUNTED: u32 = 48;

/// Counts pictures: those of several renderers are told apart, too.
static GENERATION: AtomicU64 = AtomicU64::new(1);

/// What the window wants to see.
#[derive(Clone, Debug)]
pub struct Request {
    /// The view.
    pub job: Job,
    /// Columns of the full picture.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples after which to rest.
    pub max_samples: u32,
    /// For amounts; `None` takes one that suits the first full pass.
    pub range: Option<Range>,
    /// For light.
    pub tone: Tone,
    /// Where to charge the light of 1, 2, 4, … samples that is kept beside the picture ([`Shot`]); `None` to keep none.
    pub keep: Option<Budget>,
}

impl Request {
    /// Whether its samples are those of another request: only what becomes of them differs.
    fn has_samples_of(&self, other: &Self) -> bool {
        let (a, b) = (&self.job, &other.job);
        let same = Arc::ptr_eq(&a.scene, &b.scene) && Arc::ptr_eq(&a.accel, &b.accel) && Arc::ptr_eq(&a.looks, &b.looks);
        let how = (a.camera, a.mode, a.sampling, a.transport) == (b.camera, b.mode, b.sampling, b.transport)
            && (a.section, a.heat_rays, &a.visible) == (b.section, b.heat_rays, &b.visible);
        same && how && (self.width, self.height) == (other.width, other.height) && self.keep.is_some() == other.keep.is_some()
    }
}

/// The background threads and what they were last asked for. Dropping it stops them.
#[derive(Debug)]
pub struct Renderer {
    shared: Arc<Shared>,
    thread: Option<std::thread::JoinHandle<()>>,
}

#[derive(Debug)]
struct Shared {
    state: Mutex<State>,
    wake: Condvar,
}

#[derive(Debug, Default)]
struct State {
    request: Option<Request>,
    /// Grows with every request.
    number: u64,
    /// Stops the pass that runs.
    cancel: Cancel,
    pauses: u32,
    running: bool,
    quit: bool,
    picture: Option<Arc<Picture>>,
}

/// While it lives, the renderer rests.
#[derive(Debug)]
pub struct Pause(Arc<Shared>);

impl Renderer {
    /// Starts the thread. `notify` is called from it whenever there is a new picture.
    ///
    /// # Errors
    /// If the system grants no thread.
    pub fn new(pool: Pool, notify: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let shared = Arc::new(Shared { state: Mutex::default(), wake: Condvar::new() });
        let worker = Worker { shared: Arc::clone(&shared), pool, overhead_secs: FIRST_OVERHEAD_SECS, notify };
        let thread = std::thread::Builder::new().name("render".into()).spawn(move || worker.run())?;
        Ok(Self { shared, thread: Some(thread) })
    }

    /// Asks for a picture; what was asked before is dropped. Returns the request's number.
    pub fn request(&self, request: Request) -> u64 {
        let mut state = self.shared.lock();
        state.request = Some(request);
        state.number += 1;
        state.cancel.cancel();
        self.shared.wake.notify_all();
        state.number
    }

    /// Asks for nothing: the scene is gone.
    pub fn clear(&self) {
        let mut state = self.shared.lock();
        state.request = None;
        state.picture = None;
        state.number += 1;
        state.cancel.cancel();
        // Whoever waits with what was traced lets go of it.
        self.shared.wake.notify_all();
    }

    /// The newest picture.
    pub fn picture(&self) -> Option<Arc<Picture>> {
        self.shared.lock().picture.clone()
    }

    /// Holds on until there is a picture of a request or of a later one, or `patience` is at its end.
    pub fn wait_for(&self, request: u64, patience: Duration) {
        let end = Instant::now() + patience;
        let mut state = self.shared.lock();
        while state.picture.as_ref().is_none_or(|picture| picture.request < request) && state.pauses == 0 {
            let left = end.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return;
            }
            state = self.shared.wake.wait_timeout(state, left).unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Stops rendering until the guard is dropped; returns at once.
    pub fn pause(&self) -> Pause {
        let mut state = self.shared.lock();
        state.pauses += 1;
        state.cancel.cancel();
        Pause(Arc::clone(&self.shared))
    }
}

impl Pause {
    /// Waits until no pass runs any more: not for the window's thread.
    pub fn wait(&self) {
        let mut state = self.0.lock();
        while state.running {
            state = self.0.wake.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }
}

impl Drop for Pause {
    fn drop(&mut self) {
        self.0.lock().pauses -= 1;
        self.0.wake.notify_all();
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        {
            let mut state = self.shared.lock();
            state.quit = true;
            state.cancel.cancel();
        }
        self.shared.wake.notify_all();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Shared {
    fn lock(&self) -> MutexGuard<'_, State> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

struct Worker<N> {
    shared: Arc<Shared>,
    pool: Pool,
    /// Seconds that a pixel takes besides finding its hit: making the ray, shading, developing; learnt
    /// from pass to pass.
    overhead_secs: f64,
    notify: N,
}

/// A request on its way.
struct Task {
    request: Request,
    number: u64,
    start: Instant,
    /// The range that suits the first full pass.
    suits: Option<Range>,
    counts: Counts,
    counted: u64,
    /// Seconds to find a camera ray's hit, as foreseen.
    ray_secs: f64,
    /// Of the last pass.
    rays_per_sec: f64,
    /// The exposure that suits the picture.
    exposure: Option<f32>,
    /// The film of full resolution, kept over a pause.
    film: Option<Film>,
    /// Seconds of its passes.
    film_secs: f64,
    /// Whether its picture is to be made anew, without another sample.
    redevelop: bool,
    /// What is kept of it on the way.
    shots: Vec<Arc<Shot>>,
}

impl<N: Fn()> Worker<N> {
    fn run(mut self) {
        let mut task: Option<Task> = None;
        loop {
            let Some((next, cancel)) = self.next(task.take()) else { return };
            let mut current = next;
            let _ = self.refine(&mut current, &cancel); // stopped: the next request says why
            task = Some(current);
        }
    }

    /// Waits for something to do: a new request, or the present one if it is not done. `None` to quit.
    fn next(&self, mut present: Option<Task>) -> Option<(Task, Cancel)> {
        let mut state = self.shared.lock();
        state.running = false;
        self.shared.wake.notify_all();
        loop {
            if state.quit {
                return None;
            }
            // Nothing of a scene that is gone is held on to.
            present = present.filter(|_| state.request.is_some());
            let fresh = present.as_ref().is_none_or(|task| task.number != state.number);
            if state.pauses == 0
                && let Some(request) = &state.request
            {
                let unfinished = |task: &Task| task.film.as_ref().is_none_or(|f| !f.is_done(task.request.max_samples));
                let next = match present {
                    Some(task) if fresh => Task::after(task, request.clone(), state.number),
                    None => Task::new(request.clone(), state.number),
                    Some(done) if !unfinished(&done) => return self.wait_for_request(state, done),
                    Some(task) => task,
                };
                state.cancel = Cancel::new();
                state.running = true;
                return Some((next, state.cancel.clone()));
            }
            state = self.shared.wake.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// The picture is done: only a new request, or the end, goes on.
    fn wait_for_request(&self, mut state: MutexGuard<'_, State>, present: Task) -> Option<(Task, Cancel)> {
        let done = state.number;
        loop {
            state = self.shared.wake.wait(state).unwrap_or_else(PoisonError::into_inner);
            if state.quit {
                return None;
            }
            if state.number != done {
                drop(state);
                return self.next(Some(present));
            }
        }
    }

    fn refine(&mut self, task: &mut Task, cancel: &Cancel) -> Result<(), Cancelled> {
        if task.film.is_none() {
            let mut step = self.first_step(task, cancel)?;
            while step > 1 {
                let mut film = Film::new(task.request.width.div_ceil(step), task.request.height.div_ceil(step));
                self.pass(task, &mut film, step, cancel)?;
                step /= 2;
            }
            // Amounts are no colours: how sure they are is not asked. Where errors are looked at, no pixel rests, which would
            // bias them.
            let film = match (task.request.job.mode.is_scalar(), &task.request.keep) {
                (true, _) => Film::new,
                (false, None) => Film::converging,
                (false, Some(_)) => Film::estimating,
            };
            task.film = Some(film(task.request.width, task.request.height));
        }
        let Some(mut film) = task.film.take() else { return Ok(()) };
        if std::mem::take(&mut task.redevelop) {
            self.publish(task, &film, 1);
        }
        while !film.is_done(task.request.max_samples) {
            // A stopped pass has left parts of a sample behind: keep what was whole.
            let whole = film.clone();
            if let Err(stopped) = self.pass(task, &mut film, 1, cancel) {
                task.film = Some(whole);
                return Err(stopped);
            }
        }
        task.film = Some(film);
        Ok(())
    }

    /// One pass, and the picture it makes.
    fn pass(&mut self, task: &mut Task, film: &mut Film, step: u32, cancel: &Cancel) -> Result<(), Cancelled> {
        let start = Instant::now();
        let work = task.request.job.pass(film, &self.pool, cancel)?;
        let secs = start.elapsed().as_secs_f64();
        task.rays_per_sec = work.rays as f64 / secs.max(1e-9);
        if step == 1 {
            task.film_secs += secs;
            task.keep(film);
        }
        self.publish(task, film, step);
        let overhead_secs = start.elapsed().as_secs_f64() / film.pixels() as f64 - task.ray_secs;
        self.overhead_secs = (0.5 * (self.overhead_secs + overhead_secs)).max(0.0);
        Ok(())
    }

    /// Makes a picture of a film, for whoever asked.
    fn publish(&mut self, task: &mut Task, film: &Film, step: u32) {
        let mode = task.request.job.mode;
        if mode == Mode::Path && film.samples().is_power_of_two() {
            task.exposure = film.fitting_exposure();
        }
        let suits = match mode.is_scalar() {
            true => task.suits.unwrap_or_else(|| auto_range(film, mode)),
            false => Range { min: 0.0, max: 1.0 },
        };
        if step == 1 {
            task.suits = Some(suits); // a coarse pass does not settle it
        }
        let range = task.request.range.filter(|_| mode.is_scalar()).unwrap_or(suits);
        let done = step == 1 && film.is_done(task.request.max_samples);
        let progress = Progress {
            samples: film.samples(),
            share: film.share(),
            exposure: task.exposure,
            step,
            secs: task.start.elapsed().as_secs_f64(),
            rays_per_sec: task.rays_per_sec,
            counts: task.counts,
            counted: task.counted,
            done,
        };
        let development = Development { mode, range, tone: task.request.tone, background: None };
        let amounts = || mode.is_heat().then(|| Arc::new(Amounts::of(film)));
        let (rgba, amounts) = self.pool.run(|| (development.develop(film), amounts()));
        let picture = Picture {
            generation: GENERATION.fetch_add(1, Ordering::Relaxed),
            request: task.number,
            camera: task.request.job.camera,
            width: film.width(),
            height: film.height(),
            rgba,
            depth: Arc::clone(film.depth()),
            range,
            amounts,
            suits,
            progress,
            shots: task.shots.clone(),
        };
        let mut state = self.shared.lock();
        if state.number == task.number {
            state.picture = Some(Arc::new(picture));
        }
        drop(state);
        self.shared.wake.notify_all();
        (self.notify)();
    }

    /// How coarse the first pass has to be. A grid of camera rays is counted and timed: enough to
    /// foresee the time of a pass, and what the figures beside the picture need.
    fn first_step(&self, task: &mut Task, cancel: &Cancel) -> Result<u32, Cancelled> {
        let request = &task.request;
        let coarse = (COUNTED, (COUNTED * request.height).div_ceil(request.width.max(1)).clamp(1, COUNTED * 2));
        let rays = request.job.camera_rays(coarse.0, coarse.1, 0..coarse.1, 0);
        let start = Instant::now();
        let budget = FIRST_PASS_SECS / 3.0;
        // Every seventh ray, so that a slow structure's few are spread over the view.
        let mut hits = [None; 1];
        for i in 0..rays.len() {
            let ray = rays[i * 7 % rays.len()];
            request.job.accel.trace(&[ray], accel::Mode::Closest, &mut hits, cancel)?;
            request.job.accel.trace_watched(&ray, accel::Mode::Closest, &mut task.counts, cancel)?;
            task.counted += 1;
            if start.elapsed().as_secs_f64() > budget {
                break;
            }
        }
        // Both calls of each ray together are a little slower than one; occlusion takes a second ray.
        let weight = request.job.rays_per_pixel();
        task.ray_secs = weight * start.elapsed().as_secs_f64() / task.counted as f64 / self.pool.threads() as f64;
        let secs_per_pixel = task.ray_secs + self.overhead_secs;
        let pixels = f64::from(request.width) * f64::from(request.height);
        let mut step = 1;
        while step < COARSEST && pixels / f64::from(step * step) * secs_per_pixel > FIRST_PASS_SECS * 2.0 / 3.0 {
            step *= 2;
        }
        Ok(step)
    }
}

impl Task {
    fn new(request: Request, number: u64) -> Self {
        Self {
            number,
            start: Instant::now(),
            suits: None,
            counts: Counts::default(),
            counted: 0,
            ray_secs: 0.0,
            rays_per_sec: 0.0,
            exposure: None,
            film: None,
            film_secs: 0.0,
            redevelop: false,
            shots: Vec::new(),
            request,
        }
    }

    /// A new request after this one, which goes on with its samples where it can.
    fn after(self, request: Request, number: u64) -> Self {
        if self.film.as_ref().is_some_and(|film| film.samples() > 0) && request.has_samples_of(&self.request) {
            Self { number, redevelop: true, request, ..self }
        } else {
            Self::new(request, number)
        }
    }

    /// Keeps the light of 1, 2, 4, … samples; what does not fit the budget is kept without it.
    fn keep(&mut self, film: &Film) {
        let Some(budget) = self.request.keep.as_ref().filter(|_| film.samples().is_power_of_two()) else { return };
        let memory = budget.charge((film.pixels() * size_of::<[f32; 3]>()) as u64).ok();
        let light = memory.as_ref().map(|_| film.linear());
        let (samples, secs, noise) = (film.samples(), self.film_secs, film.noise());
        self.shots.push(Arc::new(Shot { samples, secs, noise, light, _memory: memory }));
    }
}
