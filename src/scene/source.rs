//! Opening what the user named: a file, or a built-in scene.

use std::path::Path;

use super::{Keep, LoadError, Reason, Scene, builtin, load};
use crate::task::{Budget, Cancel, Pool, Progress};

/// What loading takes besides the name.
#[derive(Clone, Debug)]
pub struct LoadCx {
    /// Stops it.
    pub cancel: Cancel,
    /// Hears how far it is.
    pub progress: Progress,
    /// Limits its memory.
    pub budget: Budget,
    /// The threads it may use.
    pub pool: Pool,
    /// How much of the model is kept.
    pub keep: Keep,
}

impl LoadCx {
    /// Loading that can be stopped, listened to, and limited in memory, and keeps what is needed.
    pub const fn new(cancel: Cancel, progress: Progress, budget: Budget, pool: Pool) -> Self {
        Self { cancel, progress, budget, pool, keep: Keep::Needed }
    }

    /// Nothing can stop it, nobody listens, all cores: for tests and small tools.
    pub fn unattended() -> Self {
        Self::new(Cancel::new(), Progress::new(), Budget::half_of_machine(), Pool::new("load", 0))
    }
}

/// Opens `model`: a path to a file, or `builtin:NAME`, or `builtin:NAME?triangles=N`.
///
/// # Errors
/// A [`LoadError`] that names the model, the place and the reason.
pub fn open(model: &str, cx: &LoadCx) -> Result<Scene, LoadError> {
    let scene = match model.strip_prefix(builtin::SCHEME) {
        Some(spec) => builtin::generate(spec, cx),
        None => load::file(Path::new(model), cx),
    };
    let mut scene = scene.map_err(|reason| reason.of(model))?;
    scene.name = model.to_owned();
    if scene.triangle_count() == 0 {
        return Err(Reason::NoTriangles(scene.warnings.first().cloned()).of(model));
    }
    Ok(scene)
}
