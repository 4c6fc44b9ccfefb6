//! What surfaces look like besides their shape and plain colour: the scene's textures, and which meshes rays may pass in
//! places. A scene that has neither pays for neither.

use std::sync::{Arc, OnceLock};

use super::Mode;
use super::light::{Sources, Surroundings};
use crate::accel::visibility::{Seen, Visibility};
use crate::accel::{self, Accel, Filter, Hit, Traced};
use crate::geometry::Ray;
use crate::scene::coverage::{Surface, tested_meshes};
use crate::scene::texture::{Detail, Textures};
use crate::scene::{Feature, Geometry, Keep, LoadCx, Needs, Scene};
use crate::task::{Cancel, Cancelled};

/// The textures of a scene, as far as they are there, and what of its looks it needs.
#[derive(Debug)]
pub struct Looks {
    textures: Arc<Textures>,
    needs: Needs,
    /// By mesh, whether hits on it need the alpha test; empty if none does.
    tested: Vec<bool>,
    surroundings: Surroundings,
    /// Worked out when a path is first followed.
    sources: OnceLock<Arc<Sources>>,
}

impl Looks {
    /// With textures that are there; without them ([`Textures::none`]) surfaces have their plain colour and opacity.
    pub fn new(scene: &Scene, textures: Textures) -> Self {
        let needs = Needs::of(scene, &textures);
        let tested = if needs.has(Feature::AlphaTest) { tested_meshes(scene, &textures) } else { Vec::new() };
        Self {
            needs,
            textures: Arc::new(textures),
            tested: if tested.contains(&true) { tested } else { Vec::new() },
            surroundings: Surroundings::default(),
            sources: OnceLock::new(),
        }
    }

    /// Treats every surface as if it needed everything: every hit is asked whether it counts, every shading looks for
    /// normals, colours and images.
    pub fn of_everything(scene: &Scene, textures: Textures) -> Self {
        Self { tested: vec![true; scene.meshes.len()], textures: Arc::new(textures), ..Self::default() }
    }

    /// Decodes the scene's textures, as many as `detail` needs; where all is to be kept it treats every surface alike ([`Self::of_everything`]).
    ///
    /// # Errors
    /// [`Cancelled`] within 100 ms of the request.
    pub fn decode(scene: &Scene, detail: Detail, cx: &LoadCx) -> Result<Self, Cancelled> {
        let looks = match cx.keep {
            Keep::Needed => Self::new,
            Keep::All => Self::of_everything,
        };
        Ok(looks(scene, Textures::decode(scene, detail, cx)?))
    }

    /// The same with the shading of other needs: for measuring what it costs.
    pub fn with_shading(&self, needs: Needs) -> Self {
        Self {
            textures: Arc::clone(&self.textures),
            needs,
            tested: self.tested.clone(),
            surroundings: self.surroundings.clone(),
            sources: self.sources.clone(),
        }
    }

    /// The same with something else around it.
    pub fn within(self, surroundings: Surroundings) -> Self {
        Self { surroundings, sources: OnceLock::new(), ..self }
    }

    /// What is around.
    pub const fn surroundings(&self) -> &Surroundings {
        &self.surroundings
    }

    /// The same under other lights than the scene's.
    pub fn with_sources(self, sources: Sources) -> Self {
        Self { sources: Arc::new(sources).into(), ..self }
    }

    /// The lights of the scene. Runs on the threads of the pool that it is called in.
    pub(super) fn sources(&self, scene: &Scene, geometry: &Geometry, cancel: &Cancel) -> Result<Arc<Sources>, Cancelled> {
        match self.sources.get() {
            Some(sources) => Ok(Arc::clone(sources)),
            None => {
                let sources = Arc::new(Sources::of(scene, geometry, (&self.textures, &self.surroundings), cancel)?);
                Ok(Arc::clone(self.sources.get_or_init(|| sources)))
            }
        }
    }

    /// What the scene needs of its looks.
    pub const fn needs(&self) -> Needs {
        self.needs
    }

    /// The textures.
    pub fn textures(&self) -> &Textures {
        &self.textures
    }

    /// Whether rays may pass some mesh in places.
    pub fn has_holes(&self) -> bool {
        !self.tested.is_empty()
    }

    /// Traces rays through a structure; where surfaces are not there hits do not count, nor do those on what is hidden.
    pub(super) fn trace(
        &self,
        scene: &Scene,
        (accel, visible): (&dyn Accel, Option<&Visibility>),
        rays: &[Ray],
        mode: accel::Mode,
        hits: &mut [Option<Hit>],
        cancel: &Cancel,
    ) -> Result<Traced, Cancelled> {
        let holes = self.has_holes().then_some(Holes { scene, looks: self });
        match (holes, visible.map(|visible| visible.filter(accel.geometry()))) {
            (None, None) => accel.trace(rays, mode, hits, cancel),
            (Some(holes), None) => accel.trace_filtered(rays, mode, &holes, hits, cancel),
            (None, Some(seen)) => accel.trace_filtered(rays, mode, &seen, hits, cancel),
            (Some(holes), Some(seen)) => accel.trace_filtered(rays, mode, &SeenWithHoles { seen, holes }, hits, cancel),
        }
    }
}

impl Default for Looks {
    /// Solid surfaces without images, of any scene.
    fn default() -> Self {
        Self {
            textures: Arc::default(),
            needs: Needs::ALL,
            tested: Vec::new(),
            surroundings: Surroundings::default(),
            sources: OnceLock::new(),
        }
    }
}

/// Counts hits only where the surface is.
struct Holes<'a> {
    scene: &'a Scene,
    looks: &'a Looks,
}

impl Filter for Holes<'_> {
    fn accepts(&self, hit: &Hit) -> bool {
        let mesh = self.scene.instances[hit.instance as usize].mesh;
        !self.looks.tested[mesh]
            || Surface::new(self.scene, mesh, &self.looks.textures).covers(hit.instance, hit.primitive, hit.u, hit.v)
    }
}

/// Counts hits only where the surface is, and only on what is seen.
struct SeenWithHoles<'a> {
    seen: Seen<'a>,
    holes: Holes<'a>,
}

impl Filter for SeenWithHoles<'_> {
    fn accepts(&self, hit: &Hit) -> bool {
        self.seen.accepts(hit) && self.holes.accepts(hit)
    }
}

impl Mode {
    /// Whether it shows what surfaces look like.
    pub const fn shows_looks(self) -> bool {
        matches!(self, Self::Shaded | Self::Path | Self::Ao | Self::Normals | Self::Depth)
    }
}
