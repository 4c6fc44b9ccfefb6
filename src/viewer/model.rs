//! The open model, and the job that opens one.

use std::sync::Arc;
use std::time::Instant;

use super::checks::{RAYS, SEED};
use super::gpu::RasterMesh;
use crate::geometry::{Aabb, Ray};
use crate::lab::stability::cases;
use crate::render::Looks;
use crate::scene::texture::Textures;
use crate::scene::{self, Geometry, LoadCx, LoadError, Reason, Scene};
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
    /// Its textures, as far as they are there.
    pub looks: Arc<Looks>,
    /// The rays of a case of the stability lab; none of anything else.
    pub rays: Arc<Vec<Ray>>,
}

/// What the name of a model begins with that is a case of the stability lab.
const CASE: &str = "case:";

/// The name that a case is opened by.
pub fn case_name(id: &str) -> String {
    format!("{CASE}{id}")
}

/// Whether a name is that of a case.
pub fn is_case(model: &str) -> bool {
    model.starts_with(CASE)
}

/// A case of the stability lab as a scene, and its rays.
fn case(model: &str) -> Option<Result<(Scene, Vec<Ray>), LoadError>> {
    let id = model.strip_prefix(CASE)?;
    let Some(case) = cases::find(id) else {
        let known: Vec<&str> = cases::ALL.iter().map(|case| case.id).collect();
        let reason = Reason::Builtin(format!("there is no case '{id}'; there are {}", known.join(", ")));
        return Some(Err(reason.of(model)));
    };
    let trial = case.trial(SEED, RAYS);
    Some(Ok((trial.scene(model), trial.rays)))
}

/// Loads a model; meshes that stand in several places are kept once.
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
    let (scene, rays) = case(model).unwrap_or_else(|| Ok((scene::open(model, &cx)?, Vec::new())))?;
    let geometry = Geometry::with_instances(&scene, &cx).map_err(|reason| reason.of(model))?;
    let geometry = Arc::new(geometry);
    let raster = Arc::new(RasterMesh::new(generation, Arc::clone(&geometry)));
    let looks = Arc::new(Looks::new(&scene, Textures::none()));
    Ok(Model { scene: Arc::new(scene), geometry, looks, raster, load_secs: start.elapsed().as_secs_f64(), rays: Arc::new(rays) })
}

impl Model {
    /// The bounds of what is traced, in the world.
    pub fn bounds(&self) -> Aabb {
        *self.geometry.world_bounds()
    }
}
