//! The open model, and the job that opens one.

use std::sync::Arc;
use std::time::Instant;

use super::gpu::RasterMesh;
use crate::geometry::Aabb;
use crate::scene::{self, Geometry, LoadCx, LoadError, Scene};
use crate::task::{Budget, Cancel, Pool, Progress};

/// A model that is open.
#[derive(Clone, Debug)]
pub struct Model {
    /// What surfaces look like.
    pub scene: Arc<Scene>,
    /// What structures are built over.
    pub geometry: Arc<Geometry>,
    /// What is drawn until one is.
    pub raster: Arc<RasterMesh>,
    /// Seconds it took to load and flatten.
    pub load_secs: f64,
}

/// Loads and flattens a model.
///
/// # Errors
/// [`LoadError`], with the file, the place and the reason.
pub fn load(
    model: &str,
    generation: u64,
    budget: &Budget,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Model, LoadError> {
    let start = Instant::now();
    let cx = LoadCx { cancel: cancel.clone(), progress: progress.clone(), budget: budget.clone(), pool: pool.clone() };
    let scene = scene::open(model, &cx)?;
    let geometry = Geometry::new(&scene, &cx).map_err(|reason| reason.of(model))?;
    let geometry = Arc::new(geometry);
    let raster = Arc::new(RasterMesh::new(generation, Arc::clone(&geometry)));
    Ok(Model { scene: Arc::new(scene), geometry, raster, load_secs: start.elapsed().as_secs_f64() })
}

impl Model {
    /// The bounds of what is traced, in the world.
    pub fn bounds(&self) -> Aabb {
        *self.geometry.world_bounds()
    }
}
