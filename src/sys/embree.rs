//! Intel's Embree, loaded when the program runs: what other structures are measured against. The C
//! interface of its versions 3 and 4, declared by hand, behind types that keep its rules.

#![expect(unsafe_code, reason = "Embree is a C library")]

mod abi;
mod functions;
mod mesh;

use std::ffi::{CString, c_void};
use std::ptr::NonNull;
use std::sync::atomic::Ordering;
use std::sync::{Arc, OnceLock};

use abi::{Context, Generation};
pub use abi::{NO_HIT, Packet, RayHit};
use functions::{Functions, Queries, Query8};
use mesh::Mesh;

/// Where a library may be named that is not among the usual ones.
pub const PATH_VARIABLE: &str = "BOXWOOD_EMBREE";

/// The names it goes by, the newest first.
const NAMES: &[&str] = &[
    "libembree4.so.4",
    "libembree4.so",
    "libembree4.4.dylib",
    "libembree4.dylib",
    "embree4.dll",
    "libembree3.so.3",
    "libembree3.so",
    "libembree3.3.dylib",
    "libembree3.dylib",
    "embree3.dll",
];

/// The loaded library.
#[derive(Debug)]
pub struct Library {
    functions: Functions,
    /// Keeps it loaded.
    _library: libloading::Library,
}

/// Why there is no scene.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum Error {
    /// No library was found.
    #[error("no Embree was found: install libembree3-3 (Debian), or name a library in {PATH_VARIABLE}")]
    NotFound,
    /// A library was found that lacks a function.
    #[error("this is no Embree that is known here: {0}")]
    Unknown(String),
    /// Embree reported an error.
    #[error("Embree reports error {0}")]
    Reported(u32),
    /// More triangles or vertices than 32 bits count, or an index past the last vertex.
    #[error("the triangles do not fit Embree's 32-bit indices")]
    Indices,
}

/// How a scene is built.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Spatial splits, which cost time and gain speed; Embree leaves them out where `robust` is set.
    pub high_quality: bool,
    /// No hit is lost between triangles.
    pub robust: bool,
    /// Threads of the build.
    pub threads: usize,
}

impl Library {
    /// Loads the library that the environment names, or the newest of those installed; once. It stays
    /// loaded: the threads that it starts outlive its devices.
    ///
    /// # Errors
    /// [`Error::NotFound`], or the library is none.
    pub fn find() -> Result<Arc<Self>, Error> {
        static LOADED: OnceLock<Result<Arc<Library>, Error>> = OnceLock::new();
        LOADED.get_or_init(Self::load).clone()
    }

    fn load() -> Result<Arc<Self>, Error> {
        let named = std::env::var(PATH_VARIABLE).ok();
        let names: Vec<&str> = named.as_deref().map_or_else(|| NAMES.to_vec(), |name| vec![name]);
        // SAFETY: loading runs the library's initialisers. Those of Embree and of what it needs have no
        // requirements; a file that only pretends to be Embree is beyond what can be checked.
        let load = |name: &&str| unsafe { libloading::Library::new(*name) }.ok();
        let library = names.iter().find_map(load).ok_or(Error::NotFound)?;
        // SAFETY: the functions are kept beside the library, which is never closed.
        let functions = unsafe { Functions::of(&library) }.map_err(|error| Error::Unknown(error.to_string()))?;
        Ok(Arc::new(Self { functions, _library: library }))
    }

    /// `3.13.5`.
    ///
    /// # Errors
    /// What Embree reports.
    pub fn version(&self) -> Result<String, Error> {
        let f = &self.functions;
        let device = f.device(1)?;
        // SAFETY: the device is alive, and released once.
        let parts = unsafe {
            let parts = abi::PROPERTY_VERSION.map(|property| (f.device_property)(device.as_ptr(), property).to_string());
            (f.release_device)(device.as_ptr());
            parts
        };
        Ok(parts.join("."))
    }
}

impl Functions {
    /// A new device that builds with so many threads.
    fn device(&self, threads: usize) -> Result<NonNull<c_void>, Error> {
        let config = CString::new(format!("threads={threads},set_affinity=0")).unwrap_or_default();
        // SAFETY: the text ends in a zero and lives through the call; without a device the error of the
        // calling thread is told.
        unsafe {
            let device = (self.new_device)(config.as_ptr());
            NonNull::new(device).ok_or_else(|| Error::Reported((self.device_error)(std::ptr::null_mut())))
        }
    }
}

/// Triangles that Embree holds, ready to be built over.
#[derive(Debug)]
pub struct Prepared(Mesh);

/// A built scene.
#[derive(Debug)]
pub struct Scene {
    mesh: Mesh,
    bytes: u64,
    coherent: Context,
    incoherent: Context,
}

impl Prepared {
    /// Copies the triangles to a new device.
    ///
    /// # Errors
    /// An index past the last vertex, or what Embree reports.
    pub fn new(
        library: &Arc<Library>,
        settings: Settings,
        positions: &[[f32; 3]],
        triangles: &[[u32; 3]],
    ) -> Result<Self, Error> {
        if u32::try_from(positions.len()).is_err() || u32::try_from(triangles.len()).is_err() {
            return Err(Error::Indices);
        }
        if triangles.iter().flatten().any(|i| *i as usize >= positions.len()) {
            return Err(Error::Indices);
        }
        let mesh = Mesh::new(library, settings)?;
        mesh.fill(abi::BUFFER_VERTEX, abi::FORMAT_FLOAT3, positions)?;
        mesh.fill(abi::BUFFER_INDEX, abi::FORMAT_UINT3, triangles)?;
        Ok(Self(mesh))
    }

    /// Builds the structure over the triangles: all that a build's time should count.
    ///
    /// # Errors
    /// What Embree reports.
    pub fn commit(self) -> Result<Scene, Error> {
        let Self(mesh) = self;
        let f = &mesh.library.functions;
        let before = mesh.bytes.load(Ordering::Relaxed);
        // SAFETY: the handles are alive, and nobody else uses them yet.
        unsafe {
            (f.commit_geometry)(mesh.geometry.as_ptr());
            (f.attach_geometry)(mesh.scene.as_ptr(), mesh.geometry.as_ptr());
            (f.commit_scene)(mesh.scene.as_ptr());
        }
        mesh.check()?;
        let bytes = u64::try_from(mesh.bytes.load(Ordering::Relaxed) - before).unwrap_or(0);
        let context = |coherent| Context::new(f.generation, coherent);
        Ok(Scene { bytes, coherent: context(true), incoherent: context(false), mesh })
    }
}

impl Scene {
    /// Bytes that the build took and kept, the triangles' own buffers not counted.
    pub fn bytes(&self) -> u64 {
        self.bytes
    }

    fn context(&self, coherent: bool) -> &Context {
        if coherent { &self.coherent } else { &self.incoherent }
    }

    /// Finds the closest hit of one ray.
    #[inline]
    pub fn closest(&self, ray: &mut RayHit, coherent: bool) {
        let (scene, context) = (self.mesh.scene.as_ptr(), self.context(coherent).as_ptr());
        // SAFETY: the scene is committed; the ray is aligned and at least as large as either version wants.
        unsafe {
            match self.mesh.library.functions.queries {
                Queries::Three { intersect1, .. } => intersect1(scene, context, ray),
                Queries::Four { intersect1, .. } => intersect1(scene, ray, context),
            }
        }
    }

    /// Whether anything is hit by one ray.
    #[inline]
    pub fn any(&self, ray: &mut RayHit, coherent: bool) -> bool {
        let (scene, context) = (self.mesh.scene.as_ptr(), self.context(coherent).as_ptr());
        // SAFETY: as in `closest`; the ray comes first in the struct, and no more of it is asked for.
        unsafe {
            match self.mesh.library.functions.queries {
                Queries::Three { occluded1, .. } => occluded1(scene, context, ray),
                Queries::Four { occluded1, .. } => occluded1(scene, ray, context),
            }
        }
        ray.tfar < 0.0
    }

    /// Finds the closest hits of eight rays.
    #[inline]
    pub fn closest8(&self, packet: &mut Packet, coherent: bool) {
        let functions = &self.mesh.library.functions;
        let call: Query8 = match functions.queries {
            Queries::Three { intersect8, .. } | Queries::Four { intersect8, .. } => intersect8,
        };
        // SAFETY: as in `closest`.
        unsafe { self.call8(call, packet, coherent) };
    }

    /// Whether anything is hit by each of eight rays: its `tfar` is then negative.
    #[inline]
    pub fn any8(&self, packet: &mut Packet, coherent: bool) {
        let functions = &self.mesh.library.functions;
        let call: Query8 = match functions.queries {
            Queries::Three { occluded8, .. } | Queries::Four { occluded8, .. } => occluded8,
        };
        // SAFETY: as in `closest`.
        unsafe { self.call8(call, packet, coherent) };
    }

    /// # Safety
    /// The function must be one of this library that takes a packet.
    #[inline]
    unsafe fn call8(&self, call: Query8, packet: &mut Packet, coherent: bool) {
        let (scene, context) = (self.mesh.scene.as_ptr(), self.context(coherent).as_ptr());
        let valid = packet.valid();
        let packet = std::ptr::from_mut(packet).cast::<c_void>();
        // SAFETY: the mask and the packet are aligned to 32 bytes; version 3 takes the context before the
        // packet, version 4 after it.
        unsafe {
            match self.mesh.library.functions.generation {
                Generation::Three => call(valid.as_ptr(), scene, context, packet),
                Generation::Four => call(valid.as_ptr(), scene, packet, context),
            }
        }
    }
}

#[cfg(test)]
mod tests;
