//! The open model, and the job that opens one.

use std::sync::Arc;
use std::time::Instant;

use super::checks::{RAYS, SEED};
use super::gpu::RasterMesh;
use crate::geometry::{Aabb, Ray};
use crate::lab::stability::cases;
use crate::render::Looks;
use crate::scene::texture::Textures;
use crate::scene::{self, Finding, Geometry, LoadCx, LoadError, Reason, Scene};

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
    /// What it uses and what is left out, by what is known of its textures.
    pub needs: Arc<[Finding]>,
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

/// What is made of the instances of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub enum Instances {
    /// Meshes that stand in several places are kept once.
    #[default]
    Kept,
    /// Every instance becomes triangles of its own.
    Flattened,
}

/// Loads a model.
///
/// # Errors
/// [`LoadError`], with the file, the place and the reason.
pub fn load(model: &str, generation: u64, instances: Instances, cx: &LoadCx) -> Result<Model, LoadError> {
    let start = Instant::now();
    let (mut scene, rays) = case(model).unwrap_or_else(|| Ok((scene::open(model, cx)?, Vec::new())))?;
    let geometry = scene.gather(instances == Instances::Flattened, cx).map_err(|reason| reason.of(model))?;
    let geometry = Arc::new(geometry);
    let raster = Arc::new(RasterMesh::new(generation, Arc::clone(&geometry)));
    let looks = Arc::new(Looks::new(&scene, Textures::none()));
    let needs = looks.needs().findings(&scene).into();
    let load_secs = start.elapsed().as_secs_f64();
    Ok(Model { scene: Arc::new(scene), geometry, looks, needs, raster, load_secs, rays: Arc::new(rays) })
}

impl Model {
    /// The bounds of what is traced, in the world.
    pub fn bounds(&self) -> Aabb {
        *self.geometry.world_bounds()
    }
}
