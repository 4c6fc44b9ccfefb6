//! Checks a model: what about its triangles is known to make ray tracers err, and where structures err on the rays of a
//! view, held against exact arithmetic.

use std::sync::Arc;

use serde::Serialize;

use super::mesh_check::{MeshCheck, check};
use super::rays::{RayKind, RaySet};
use super::stability::{Reference, SceneRow, answers_of};
use crate::accel::{Accel, BuildCx, BuildError};
use crate::geometry::Ray;
use crate::geometry::tri::TestKind;
use crate::render::{Job, Mode};
use crate::scene::{Camera, Geometry, Reason, Scene};
use crate::task::Cancelled;

/// A structure that is checked.
#[derive(Clone)]
pub struct Checked {
    /// What its row is called.
    pub id: String,
    /// The triangle test that it was built with.
    pub test: TestKind,
    /// The structure.
    pub accel: Arc<dyn Accel>,
}

/// What was found.
#[derive(Clone, Debug, Serialize)]
pub struct ModelCheck {
    /// About the triangles.
    pub mesh: MeshCheck,
    /// Of each structure.
    pub structures: Vec<SceneRow>,
    /// The rays that were traced: those of the view, then diffuse ones from what it sees.
    #[serde(skip)]
    pub rays: Vec<Ray>,
}

/// Why a model was not checked.
#[derive(Debug, thiserror::Error)]
pub enum CheckError {
    /// Asked to stop.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// Looking at the triangles did not fit.
    #[error(transparent)]
    Mesh(Reason),
    /// The structure that others are compared with did not fit.
    #[error(transparent)]
    Build(BuildError),
}

impl From<Reason> for CheckError {
    fn from(reason: Reason) -> Self {
        match reason {
            Reason::Cancelled(cancelled) => Self::Cancelled(cancelled),
            reason => Self::Mesh(reason),
        }
    }
}

impl From<BuildError> for CheckError {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Cancelled(cancelled) => Self::Cancelled(cancelled),
            error => Self::Build(error),
        }
    }
}

/// Checks the triangles and all structures, which were built over them, on the rays of a picture, as many as each structure
/// takes in about `secs` seconds.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn check_model(
    (scene, geometry): (&Arc<Scene>, &Arc<Geometry>),
    structures: &[Checked],
    (camera, [width, height]): (Camera, [u32; 2]),
    secs: f64,
    cx: &BuildCx,
) -> Result<ModelCheck, CheckError> {
    let mesh = check(geometry, cx)?;
    let reference = Reference::build(geometry, mesh.is_closed(), cx)?;
    let job = Job::new(Arc::clone(scene), Arc::clone(&reference.accel), camera, Mode::Shaded, Arc::default());
    let mut rays = Vec::new();
    for kind in [RayKind::Primary, RayKind::Diffuse] {
        rays.extend(RaySet::generate(kind, &job, width, height, &cx.pool, &cx.cancel)?.rays);
    }
    cx.progress.start("compare", structures.len() as u64);
    let mut rows = Vec::with_capacity(structures.len());
    for Checked { id, test, accel } in structures {
        let answers = answers_of(accel.as_ref(), &cx.cancel);
        rows.push(reference.compare((id, *test), &answers, &rays, secs, &cx.pool, &cx.cancel)?);
        cx.progress.advance(1);
    }
    Ok(ModelCheck { mesh, structures: rows, rays })
}
