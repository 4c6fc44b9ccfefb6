//! What every command works with: the request to stop, the threads, the memory, the model.

use std::sync::Arc;

use super::args::MachineArgs;
use super::bar;
use super::failure::Failure;
use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::accel::{BuildCx, BuildError};
use crate::geometry::tri::TestKind;
use crate::lab::{BuiltRow, MachineFacts, SceneFacts, build_timed};
use crate::render::Looks;
use crate::scene::{self, Geometry, LoadCx, Reason, Scene};
use crate::task::{Budget, Cancel, Pool, Progress};

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
}

impl Context {
    pub fn new(machine: MachineArgs, cancel: Cancel) -> Self {
        const MIB: u64 = 1 << 20;
        let budget = machine.memory.map_or_else(Budget::half_of_machine, |mib| Budget::new(mib.saturating_mul(MIB)));
        Self { cancel, pool: Pool::new("work", machine.threads), budget }
    }

    /// Opens and flattens a model; its warnings go to standard error.
    pub fn load(&self, model: &str) -> Result<Model, Failure> {
        self.open(model, Geometry::new)
    }

    /// The same, but meshes that stand in several places are kept once, unless `flatten` says otherwise.
    pub fn load_with_instances(&self, model: &str, flatten: bool) -> Result<Model, Failure> {
        self.open(model, if flatten { Geometry::new } else { Geometry::with_instances })
    }

    fn open(&self, model: &str, gather: fn(&Scene, &LoadCx) -> Result<Geometry, Reason>) -> Result<Model, Failure> {
        let cx = self.load_cx();
        let opened = bar::watch("open", &cx.progress, || {
            let scene = scene::open(model, &cx)?;
            let geometry = gather(&scene, &cx).map_err(|reason| reason.of(model))?;
            Ok::<_, Failure>(Model { scene: Arc::new(scene), geometry: Arc::new(geometry) })
        })?;
        for warning in &opened.scene.warnings {
            super::output::warn(&format!("{model}: {warning}"));
        }
        Ok(opened)
    }

    /// Decodes the textures of a model; what cannot be read is told on standard error.
    pub fn looks(&self, model: &Model) -> Result<Looks, Failure> {
        let cx = self.load_cx();
        let looks = bar::watch("textures", &cx.progress, || Looks::decode(&model.scene, &cx))?;
        looks.textures().warnings().iter().for_each(|warning| super::output::warn(&format!("{}: {warning}", model.scene.name)));
        Ok(looks)
    }

    /// What loading and making scenes takes.
    pub fn load_cx(&self) -> LoadCx {
        LoadCx { cancel: self.cancel.clone(), progress: Progress::new(), budget: self.budget.clone(), pool: self.pool.clone() }
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
