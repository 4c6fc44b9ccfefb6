//! The decoded images of a scene.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::mpsc::{RecvTimeoutError, channel};
use std::time::Duration;

use super::decode::{Refusal, decode};
use super::pack::Wanted;
use super::source::Image;
use super::texels::Texture;
use super::uses::{self, Detail};
use crate::scene::{Keep, LoadCx, Scene};
use crate::task::{Cancelled, Charge};

/// The decoded images of a scene. Apart from it, because a scene is shown before they are there.
#[derive(Debug, Default)]
pub struct Textures {
    by_image: Vec<Option<Arc<Texture>>>,
    warnings: Vec<String>,
    _memory: Vec<Charge>,
}

/// An image to decode.
struct Job {
    image: usize,
    what: Image,
    wanted: Wanted,
}

type Outcome = Result<(Texture, Charge), Refusal>;

/// Time between two looks at the cancel flag.
const LOOK: Duration = Duration::from_millis(20);

impl Textures {
    /// No images: every surface has its plain colour.
    pub fn none() -> Self {
        Self::default()
    }

    /// Decodes the images that are seen (or all of them, see [`Keep`]) and needed for `detail`, each once, on as many threads
    /// as the pool has. One that cannot be read is a warning, and white.
    ///
    /// # Errors
    /// [`Cancelled`], at once: images that are being decoded are left to end by themselves.
    pub fn decode(scene: &Scene, detail: Detail, cx: &LoadCx) -> Result<Self, Cancelled> {
        let wanted = match cx.keep {
            Keep::Needed => uses::wanted(scene, detail),
            Keep::All => vec![Some(Wanted { whole: true, ..Wanted::default() }); scene.images.len()],
        };
        let wanted = scene.images.iter().zip(wanted).enumerate();
        let jobs = wanted.filter_map(|(image, (what, wanted))| Some(Job { image, what: what.clone(), wanted: wanted? }));
        let jobs: Arc<[Job]> = jobs.collect();
        cx.progress.start("textures", jobs.len() as u64);
        let mut outcomes = all(&jobs, (0..jobs.len()).collect(), cx.pool.threads(), cx)?;
        // What did not fit the budget may have done so because of what others took meanwhile.
        let crowded = |outcome: &Option<Outcome>| matches!(outcome, Some(Err(Refusal::Memory(_))));
        let again: Vec<usize> = (0..jobs.len()).filter(|i| crowded(&outcomes[*i])).collect();
        for (i, outcome) in all(&jobs, again, 1, cx)?.into_iter().enumerate().filter(|(_, outcome)| outcome.is_some()) {
            outcomes[i] = outcome;
        }
        Ok(Self::of(scene.images.len(), &jobs, outcomes))
    }

    fn of(images: usize, jobs: &[Job], outcomes: Vec<Option<Outcome>>) -> Self {
        let mut textures = Self { by_image: vec![None; images], ..Self::default() };
        let mut refused = 0;
        for (job, outcome) in jobs.iter().zip(outcomes) {
            match outcome.unwrap_or(Err(Refusal::Failed)) {
                Ok((texture, memory)) => {
                    textures.by_image[job.image] = Some(Arc::new(texture));
                    textures._memory.push(memory);
                }
                Err(why) => {
                    refused += 1;
                    if refused <= Self::TOLD {
                        let why = why.to_string();
                        let why = why.trim_end_matches('.'); // where a decoder ends its sentence itself
                        textures.warnings.push(format!("The image {} can't be read, and is white: {why}.", job.what.name));
                    }
                }
            }
        }
        if refused > Self::TOLD {
            textures.warnings.push(format!("More images can't be read, and are white: {}.", refused - Self::TOLD));
        }
        textures
    }

    /// Images that are left out and named.
    const TOLD: usize = 3;

    /// The texture of an image of the scene; `None` where there is none, or none yet.
    pub fn get(&self, image: usize) -> Option<&Arc<Texture>> {
        self.by_image.get(image)?.as_ref()
    }

    /// What could not be read, in words for the user. Each is one sentence.
    pub fn warnings(&self) -> &[String] {
        &self.warnings
    }

    /// Bytes of all texels.
    pub fn bytes(&self) -> u64 {
        self.by_image.iter().flatten().map(|texture| texture.bytes()).sum()
    }
}

/// Does the jobs `which`, on threads of their own: decoders cannot be stopped, but they can be left
/// alone, and give their memory back when they are done. A large image takes them longer than a
/// user who cancels wants to wait.
fn all(jobs: &Arc<[Job]>, which: Vec<usize>, threads: usize, cx: &LoadCx) -> Result<Vec<Option<Outcome>>, Cancelled> {
    let mut outcomes: Vec<Option<Outcome>> = jobs.iter().map(|_| None).collect();
    let (sender, receiver) = channel();
    let (which, next): (Arc<[usize]>, _) = (which.into(), Arc::new(AtomicUsize::new(0)));
    for _ in 0..threads.min(which.len()) {
        let (jobs, which, next, sender, cx) = (jobs.clone(), which.clone(), next.clone(), sender.clone(), cx.clone());
        let work = move || {
            while let Some(i) = which.get(next.fetch_add(1, Ordering::Relaxed)) {
                let job = || decode(&jobs[*i].what, &jobs[*i].wanted, &cx);
                // Nobody listens any more if it was cancelled.
                let done = catch_unwind(AssertUnwindSafe(job)).unwrap_or(Err(Refusal::Failed));
                if cx.cancel.is_cancelled() || sender.send((*i, done)).is_err() {
                    break;
                }
            }
        };
        // Without a thread its jobs are the others'; without any they count as failed.
        let _ = std::thread::Builder::new().name("texture".into()).spawn(work);
    }
    drop(sender);
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok((i, outcome)) => {
                outcomes[i] = Some(outcome);
                cx.progress.advance(1);
            }
            Err(RecvTimeoutError::Timeout) => {}
            Err(RecvTimeoutError::Disconnected) => break,
        }
        cx.cancel.check()?;
    }
    cx.cancel.check()?;
    Ok(outcomes)
}
