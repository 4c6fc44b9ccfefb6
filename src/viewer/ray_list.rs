//! What the Ray workspace knows of a file of rays: all of them, what each does in the shown structure, and which is followed.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::Receiver;

use super::kept::{Built, Key};
use super::workers::Shared;
use crate::accel::stats::SahWeights;
use crate::geometry::{Ray, num};
use crate::job::Job;
use crate::lab::ray_file::{self, RayFile, RayWork, dearest_first, work};
use crate::task::{Cancel, Cancelled, Charge, Progress};

/// Endings of such files: lines of text, or NumPy arrays.
pub const ENDINGS: [&str; 3] = ["rays", "txt", "npy"];

/// Everything of it.
#[derive(Default)]
pub struct RayList {
    /// The rays, and what the file is called; nothing if none is open.
    pub file: Option<Listed>,
    /// What they do in a structure.
    pub traced: Option<Arc<Traced>>,
    /// The file, on its way.
    pub reading: Option<Reading>,
    /// What they do, on its way, and in which structure.
    pub tracing: Option<(Key, Tracing)>,
    /// The row of the ray that was followed last.
    pub chosen: Option<u32>,
    /// Grows whenever that row is to be brought into sight.
    pub moved: u64,
    /// A file to read once a model is open.
    pub awaited: Option<PathBuf>,
    /// The file that is awaited or read belongs to a workspace file, which says what is looked at.
    pub brought: Option<Brought>,
    /// The number of the ray that is followed, until its row is known.
    pub followed: Option<u32>,
    /// The answer of the dialog.
    pub asked: Option<Receiver<Option<PathBuf>>>,
}

/// What a workspace file says of its file of rays.
pub struct Brought {
    /// Its path.
    pub path: PathBuf,
    /// The number of the ray that is followed.
    pub followed: Option<u32>,
}

/// The rays of a file.
pub struct Listed {
    /// What the file is called.
    pub name: String,
    /// Where it is.
    pub path: PathBuf,
    /// The rays.
    pub rays: Arc<Vec<Ray>>,
    /// There are more in the file than are listed.
    pub more: bool,
    /// What they and their work take.
    _memory: Charge,
}

/// What rays do in a structure.
pub struct Traced {
    /// Which.
    pub of: Key,
    /// By the number of the ray.
    pub work: Vec<RayWork>,
    /// The numbers of the rays, the dearest first.
    pub order: Vec<u32>,
}

/// A file on its way, or why it can't be read.
pub type Reading = Job<Result<Listed, String>>;
/// What rays do, on its way.
pub type Tracing = Job<Result<Traced, Cancelled>>;

impl RayList {
    /// Whether a file of that name is one of rays.
    pub fn is_one(name: &str) -> bool {
        let ending = Path::new(name).extension();
        ending.is_some_and(|ending| ENDINGS.iter().any(|known| ending.eq_ignore_ascii_case(known)))
    }

    /// Whether something of it is on its way.
    pub const fn is_busy(&self) -> bool {
        self.reading.is_some() || self.tracing.is_some() || self.awaited.is_some()
    }

    /// Whether it is known what they do in that structure.
    pub fn is_traced_in(&self, structure: Option<&Key>) -> bool {
        self.traced.as_ref().is_some_and(|traced| Some(&traced.of) == structure)
    }

    /// How far it is.
    pub fn progress(&self) -> Option<&Progress> {
        let reading = self.reading.as_ref().map(|job| &job.progress);
        reading.or_else(|| self.tracing.as_ref().map(|(_, job)| &job.progress))
    }

    /// Chooses the row of the ray that is followed, if that is known by its number alone and still is the one in the file.
    pub fn find_followed(&mut self, followed: Option<Ray>) {
        let Some(number) = self.followed.take() else { return };
        let same = self.file.as_ref().is_some_and(|file| file.rays.get(number as usize).copied() == followed);
        let row = self.traced.as_ref().and_then(|traced| traced.order.iter().position(|of| *of == number));
        if let Some(row) = row.filter(|_| same) {
            (self.chosen, self.moved) = (Some(num::index(row)), self.moved + 1);
        }
    }

    /// The number of the ray that is followed, if it is one of the file.
    pub fn number_followed(&self) -> Option<u32> {
        let brought = self.brought.as_ref().and_then(|brought| brought.followed);
        let row = || self.chosen.and_then(|row| Some(self.row(row)?.0));
        brought.or(self.followed).or_else(row)
    }

    /// What a row shows: the number of its ray, the ray, and what that does.
    pub fn row(&self, row: u32) -> Option<(u32, Ray, RayWork)> {
        let (file, traced) = (self.file.as_ref()?, self.traced.as_ref()?);
        let number = *traced.order.get(row as usize)?;
        Some((number, *file.rays.get(number as usize)?, *traced.work.get(number as usize)?))
    }
}

/// Starts reading a file.
///
/// # Errors
/// If the system grants no thread.
pub fn read(shared: &Shared, path: PathBuf) -> std::io::Result<Reading> {
    let budget = shared.budget.clone();
    Job::spawn("rays", shared.waker(), move |cancel, _| {
        let wrong = |why: &dyn std::fmt::Display| format!("Can't open {}: {why}", path.display());
        let (bytes, _while_read) = ray_file::read(&path, &budget, cancel).map_err(|why| wrong(&why))?;
        let file = RayFile::parse(&bytes, cancel).map_err(|why| wrong(&why))?;
        let each = (size_of::<Ray>() + size_of::<RayWork>() + size_of::<u32>()) as u64;
        let memory = budget.charge(file.rays.len() as u64 * each).map_err(|why| wrong(&why))?;
        let name = path.file_name().map_or_else(|| path.to_string_lossy(), |name| name.to_string_lossy()).into_owned();
        Ok(Listed { name, path, rays: Arc::new(file.rays), more: file.more, _memory: memory })
    })
}

/// Starts tracing the rays of a file through a structure.
///
/// # Errors
/// If the system grants no thread.
pub fn trace(shared: &Shared, shown: &Built, rays: Arc<Vec<Ray>>) -> std::io::Result<Tracing> {
    let (accel, of, pool) = (Arc::clone(&shown.accel), shown.key.clone(), shared.pool.clone());
    Job::spawn("trace rays", shared.waker(), move |cancel: &Cancel, progress: &Progress| {
        let work = work(accel.as_ref(), &rays, &pool, cancel, progress)?;
        let order = dearest_first(&work, SahWeights::of(&of.params));
        Ok(Traced { of, work, order })
    })
}
