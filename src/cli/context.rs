//! What every command works with: the request to stop, the threads, the memory, the model.

use std::sync::Arc;

use super::args::{MachineArgs, SceneArgs};
use super::bar;
use super::failure::Failure;
use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::tri::TestKind;
use crate::lab::{BuiltRow, MachineFacts, SceneFacts, build_timed};
use crate::render::Looks;
use crate::scene::texture::Detail;
use crate::scene::{self, Geometry, Keep, LoadCx, Scene};
use crate::task::{Budget, Cancel, Phase, Pool, Progress};

/// How the work is done.
pub struct Context {
    pub cancel: Cancel,
    pub pool: Pool,
    pub budget: Budget,
}

/// An open model.
pub struct Model {
    pub scene: Arc<Scene>,
    pub geometry: Arc<Geometry>,
    /// How much of it was kept.
    pub keep: Keep,
    /// Seconds it took to open it, by phase.
    pub phases: Vec<Phase>,
}

impl Context {
    pub fn new(machine: MachineArgs, cancel: Cancel) -> Self {
        let budget = machine.memory.map_or_else(Budget::half_of_machine, Budget::of_mib);
        Self { cancel, pool: Pool::new("work", machine.threads), budget }
    }

    /// Opens and flattens a model; its warnings go to standard error.
    pub fn load(&self, model: &str) -> Result<Model, Failure> {
        self.load_with_instances(model, SceneArgs::FLAT)
    }

    /// The same, but meshes that stand in several places are kept once, unless `args` say otherwise.
    pub fn load_with_instances(&self, model: &str, args: SceneArgs) -> Result<Model, Failure> {
        self.open(model, args, false)
    }

    /// The same with the positions and indices of the scene's meshes beside those of the geometry.
    pub fn load_whole(&self, model: &str, args: SceneArgs) -> Result<Model, Failure> {
        self.open(model, args, true)
    }

    fn open(&self, model: &str, args: SceneArgs, whole: bool) -> Result<Model, Failure> {
        let cx = LoadCx { keep: args.keep(), ..self.load_cx() };
        let opened = bar::watch("open", &cx.progress, || {
            let mut scene = scene::open(model, &cx)?;
            let geometry = match (whole && cx.keep == Keep::Needed, args.flatten) {
                (true, true) => Geometry::new(&scene, &cx),
                (true, false) => Geometry::with_instances(&scene, &cx),
                (false, flatten) => scene.gather(flatten, &cx),
            };
            let geometry = geometry.map_err(|reason| reason.of(model))?;
            Ok::<_, Failure>(Model {
                scene: Arc::new(scene),
                geometry: Arc::new(geometry),
                keep: cx.keep,
                phases: cx.progress.finish(),
            })
        })?;
        for warning in &opened.scene.warnings {
            super::output::warn(&format!("{model}: {warning}"));
        }
        Ok(opened)
    }

    /// Decodes the textures of a model; what cannot be read is told on standard error.
    pub fn looks(&self, model: &Model, detail: Detail) -> Result<Looks, Failure> {
        let cx = LoadCx { keep: model.keep, ..self.load_cx() };
        let looks = bar::watch("textures", &cx.progress, || Looks::decode(&model.scene, detail, &cx))?;
        looks.textures().warnings().iter().for_each(|warning| super::output::warn(&format!("{}: {warning}", model.scene.name)));
        Ok(looks)
    }

    /// What loading and making scenes takes.
    pub fn load_cx(&self) -> LoadCx {
        LoadCx::new(self.cancel.clone(), Progress::new(), self.budget.clone(), self.pool.clone())
    }

    /// What building takes.
    pub fn build_cx(&self) -> BuildCx {
        BuildCx::new(self.cancel.clone(), Progress::new(), self.pool.clone(), self.budget.clone())
    }

    /// Builds a structure.
    pub fn build(&self, entry: &Entry, model: &Model, test: TestKind, params: &ParamValues) -> Result<BuiltRow, BuildError> {
        let cx = self.build_cx();
        let title = format!("build {}", entry.id);
        bar::watch(&title, &cx.progress, || build_timed(entry, &model.geometry, test, params, &cx))
    }

    /// What reports say of the machine.
    pub fn machine(&self) -> MachineFacts {
        MachineFacts::here(self.pool.threads())
    }
}

impl Model {
    /// What reports say of the model.
    pub fn facts(&self) -> SceneFacts {
        SceneFacts::of(&self.scene, &self.geometry)
    }
}
