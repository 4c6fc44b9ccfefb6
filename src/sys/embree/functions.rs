//! The functions of Embree's C interface, as far as they are used.

use std::ffi::{c_char, c_int, c_uint, c_void};

use libloading::{Error, Library};

use super::abi::{Generation, RayHit};

type Handle = *mut c_void;
type Monitor = unsafe extern "C" fn(*mut c_void, isize, bool) -> bool;
type One3 = unsafe extern "C" fn(Handle, *mut c_void, *mut RayHit);
type One4 = unsafe extern "C" fn(Handle, *mut RayHit, *mut c_void);
/// The mask, the scene, and then context and packet (version 3) or packet and arguments (version 4).
pub(super) type Query8 = unsafe extern "C" fn(*const c_int, Handle, *mut c_void, *mut c_void);

/// The queries, whose arguments changed their places.
#[derive(Clone, Copy, Debug)]
pub(super) enum Queries {
    Three { intersect1: One3, occluded1: One3, intersect8: Query8, occluded8: Query8 },
    Four { intersect1: One4, occluded1: One4, intersect8: Query8, occluded8: Query8 },
}

/// The functions of a loaded library.
#[derive(Debug)]
pub(super) struct Functions {
    pub generation: Generation,
    pub queries: Queries,
    pub new_device: unsafe extern "C" fn(*const c_char) -> Handle,
    pub release_device: unsafe extern "C" fn(Handle),
    pub device_error: unsafe extern "C" fn(Handle) -> c_uint,
    pub device_property: unsafe extern "C" fn(Handle, c_uint) -> isize,
    pub monitor_memory: unsafe extern "C" fn(Handle, Option<Monitor>, *mut c_void),
    pub new_geometry: unsafe extern "C" fn(Handle, c_uint) -> Handle,
    pub new_buffer: unsafe extern "C" fn(Handle, c_uint, c_uint, c_uint, usize, usize) -> *mut c_void,
    pub geometry_quality: unsafe extern "C" fn(Handle, c_uint),
    pub commit_geometry: unsafe extern "C" fn(Handle),
    pub release_geometry: unsafe extern "C" fn(Handle),
    pub new_scene: unsafe extern "C" fn(Handle) -> Handle,
    pub scene_quality: unsafe extern "C" fn(Handle, c_uint),
    pub scene_flags: unsafe extern "C" fn(Handle, c_uint),
    pub attach_geometry: unsafe extern "C" fn(Handle, Handle) -> c_uint,
    pub commit_scene: unsafe extern "C" fn(Handle),
    pub release_scene: unsafe extern "C" fn(Handle),
}

impl Functions {
    /// Takes the functions from a library.
    ///
    /// # Safety
    /// They must not be called once the library is gone.
    pub(super) unsafe fn of(library: &Library) -> Result<Self, Error> {
        /// # Safety
        /// `F` must be the type of the function of that name.
        unsafe fn get<F: Copy>(library: &Library, name: &str) -> Result<F, Error> {
            // SAFETY: the caller vouches for the type.
            unsafe { library.get::<F>(name.as_bytes()) }.map(|symbol| *symbol)
        }
        // SAFETY: the types are those of rtcore.h.
        unsafe {
            // Version 4 alone forwards queries, version 3 alone has streams of rays.
            let four = library.get::<unsafe extern "C" fn()>(b"rtcForwardIntersect1").is_ok();
            let (intersect8, occluded8) = (get(library, "rtcIntersect8")?, get(library, "rtcOccluded8")?);
            let queries = if four {
                let (intersect1, occluded1) = (get(library, "rtcIntersect1")?, get(library, "rtcOccluded1")?);
                Queries::Four { intersect1, occluded1, intersect8, occluded8 }
            } else {
                let (intersect1, occluded1) = (get(library, "rtcIntersect1")?, get(library, "rtcOccluded1")?);
                Queries::Three { intersect1, occluded1, intersect8, occluded8 }
            };
            Ok(Self {
                generation: if four { Generation::Four } else { Generation::Three },
                queries,
                new_device: get(library, "rtcNewDevice")?,
                release_device: get(library, "rtcReleaseDevice")?,
                device_error: get(library, "rtcGetDeviceError")?,
                device_property: get(library, "rtcGetDeviceProperty")?,
                monitor_memory: get(library, "rtcSetDeviceMemoryMonitorFunction")?,
                new_geometry: get(library, "rtcNewGeometry")?,
                new_buffer: get(library, "rtcSetNewGeometryBuffer")?,
                geometry_quality: get(library, "rtcSetGeometryBuildQuality")?,
                commit_geometry: get(library, "rtcCommitGeometry")?,
                release_geometry: get(library, "rtcReleaseGeometry")?,
                new_scene: get(library, "rtcNewScene")?,
                scene_quality: get(library, "rtcSetSceneBuildQuality")?,
                scene_flags: get(library, "rtcSetSceneFlags")?,
                attach_geometry: get(library, "rtcAttachGeometry")?,
                commit_scene: get(library, "rtcCommitScene")?,
                release_scene: get(library, "rtcReleaseScene")?,
            })
        }
    }
}
