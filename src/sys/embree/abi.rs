//! Embree's C interface, as far as it is used: `rtcore_*.h` of versions 3.13 and 4.

use std::ffi::{c_char, c_int, c_uint, c_void};

use libloading::{Error, Library};

/// `RTC_INVALID_GEOMETRY_ID`: nothing was hit.
pub const NO_HIT: u32 = u32::MAX;

pub(super) const GEOMETRY_TRIANGLE: c_uint = 0;
pub(super) const BUFFER_INDEX: c_uint = 0;
pub(super) const BUFFER_VERTEX: c_uint = 1;
pub(super) const FORMAT_UINT3: c_uint = 0x5003;
pub(super) const FORMAT_FLOAT3: c_uint = 0x9003;
pub(super) const QUALITY_MEDIUM: c_uint = 1;
pub(super) const QUALITY_HIGH: c_uint = 2;
pub(super) const SCENE_ROBUST: c_uint = 1 << 2;
/// The properties that hold the parts of the version.
pub(super) const PROPERTY_VERSION: [c_uint; 3] = [1, 2, 3];

/// `RTCRayHit`: the ray, then the hit. Version 4.4 writes one word more than version 3; the struct has
/// room for it.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct RayHit {
    origin: [f32; 3],
    tnear: f32,
    dir: [f32; 3],
    time: f32,
    /// The greatest t that counts; of a hit its t, and negative infinity once occluded.
    pub tfar: f32,
    mask: u32,
    id: u32,
    flags: u32,
    normal: [f32; 3],
    /// Barycentric weight of the second corner of a hit.
    pub u: f32,
    /// Barycentric weight of the third.
    pub v: f32,
    /// The triangle that was hit, or [`NO_HIT`].
    pub prim: u32,
    geometry: u32,
    instance: u32,
    instance_prim: u32,
}

impl RayHit {
    /// A ray that has hit nothing yet.
    #[inline(always)]
    pub const fn new(origin: [f32; 3], dir: [f32; 3], tnear: f32, tfar: f32) -> Self {
        Self {
            origin,
            tnear,
            dir,
            time: 0.0,
            tfar,
            mask: u32::MAX,
            id: 0,
            flags: 0,
            normal: [0.0; 3],
            u: 0.0,
            v: 0.0,
            prim: NO_HIT,
            geometry: NO_HIT,
            instance: NO_HIT,
            instance_prim: NO_HIT,
        }
    }
}

/// `RTCRayHit8`: eight of them, field by field.
#[derive(Clone, Debug)]
#[repr(C, align(32))]
pub struct Packet {
    origin: [[f32; 8]; 3],
    tnear: [f32; 8],
    dir: [[f32; 8]; 3],
    time: [f32; 8],
    tfar: [f32; 8],
    mask: [u32; 8],
    id: [u32; 8],
    flags: [u32; 8],
    normal: [[f32; 8]; 3],
    u: [f32; 8],
    v: [f32; 8],
    prim: [u32; 8],
    geometry: [u32; 8],
    instance: [u32; 8],
    instance_prim: [u32; 8],
}

impl Default for Packet {
    /// Eight rays with nothing in their intervals.
    fn default() -> Self {
        Self {
            origin: [[0.0; 8]; 3],
            tnear: [0.0; 8],
            dir: [[0.0; 8], [0.0; 8], [1.0; 8]],
            time: [0.0; 8],
            tfar: [f32::NEG_INFINITY; 8],
            mask: [u32::MAX; 8],
            id: [0; 8],
            flags: [0; 8],
            normal: [[0.0; 8]; 3],
            u: [0.0; 8],
            v: [0.0; 8],
            prim: [NO_HIT; 8],
            geometry: [NO_HIT; 8],
            instance: [NO_HIT; 8],
            instance_prim: [NO_HIT; 8],
        }
    }
}

/// Which of eight rays count, as Embree wants to be told.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(32))]
pub(super) struct Valid([c_int; 8]);

impl Valid {
    pub(super) fn as_ptr(&self) -> *const c_int {
        self.0.as_ptr()
    }
}

impl Packet {
    /// Puts a ray into a lane (below 8) that has hit nothing yet.
    #[inline(always)]
    pub fn set(&mut self, lane: usize, origin: [f32; 3], dir: [f32; 3], tnear: f32, tfar: f32) {
        for axis in 0..3 {
            self.origin[axis][lane] = origin[axis];
            self.dir[axis][lane] = dir[axis];
        }
        self.tnear[lane] = tnear;
        self.tfar[lane] = tfar;
        self.prim[lane] = NO_HIT;
        self.geometry[lane] = NO_HIT;
    }

    /// Leaves a lane (below 8) out of the next query.
    #[inline(always)]
    pub fn leave_out(&mut self, lane: usize) {
        self.tfar[lane] = f32::NEG_INFINITY;
        self.geometry[lane] = NO_HIT;
    }

    /// The t and the triangle of a lane's hit.
    #[inline(always)]
    pub fn hit(&self, lane: usize) -> Option<(f32, u32)> {
        (self.geometry[lane] != NO_HIT).then_some((self.tfar[lane], self.prim[lane]))
    }

    /// Whether a lane that counted is occluded.
    #[inline(always)]
    pub fn occluded(&self, lane: usize) -> bool {
        self.tfar[lane] < 0.0
    }

    /// The lanes whose interval holds anything.
    #[inline(always)]
    pub(super) fn valid(&self) -> Valid {
        Valid(std::array::from_fn(|lane| -c_int::from(self.tnear[lane] <= self.tfar[lane])))
    }
}

/// `RTCIntersectContext` of version 3.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Context3 {
    flags: c_uint,
    filter: Option<unsafe extern "C" fn()>,
    /// One level of instances, and room for what builds with more of them, or of least widths, have.
    instance: [c_uint; 16],
}

/// `RTCIntersectArguments` of version 4, which begins as `RTCOccludedArguments` does.
#[derive(Debug)]
#[repr(C)]
pub(super) struct Arguments4 {
    flags: c_uint,
    features: c_uint,
    context: *mut c_void,
    filter: Option<unsafe extern "C" fn()>,
    intersect: Option<unsafe extern "C" fn()>,
    /// Room for what builds with least widths have.
    width: [f32; 4],
}

/// What a query takes besides the rays, whichever version it is.
#[derive(Debug)]
pub(super) enum Context {
    Three(Box<Context3>),
    Four(Box<Arguments4>),
}

// SAFETY: queries only read it, and its pointer is null.
unsafe impl Send for Context {}
// SAFETY: as above.
unsafe impl Sync for Context {}

impl Context {
    pub(super) fn new(generation: Generation, coherent: bool) -> Self {
        match generation {
            Generation::Three => {
                Self::Three(Box::new(Context3 { flags: u32::from(coherent), filter: None, instance: [NO_HIT; 16] }))
            }
            Generation::Four => Self::Four(Box::new(Arguments4 {
                flags: u32::from(coherent) << 16,
                features: u32::MAX,
                context: std::ptr::null_mut(),
                filter: None,
                intersect: None,
                width: [0.0; 4],
            })),
        }
    }

    #[inline(always)]
    pub(super) fn as_ptr(&self) -> *mut c_void {
        match self {
            Self::Three(context) => std::ptr::from_ref(&**context).cast_mut().cast(),
            Self::Four(arguments) => std::ptr::from_ref(&**arguments).cast_mut().cast(),
        }
    }
}

/// The major version, which decides how queries are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Generation {
    Three,
    Four,
}

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

#[cfg(test)]
mod tests {
    use super::*;

    /// `offsetof` as the headers have it: 48 bytes of ray, then the hit.
    #[test]
    fn structs_lie_as_the_headers_say() {
        use std::mem::offset_of;
        assert_eq!((size_of::<RayHit>(), align_of::<RayHit>()), (96, 16));
        assert_eq!([offset_of!(RayHit, tfar), offset_of!(RayHit, flags), offset_of!(RayHit, normal)], [32, 44, 48]);
        assert_eq!([offset_of!(RayHit, prim), offset_of!(RayHit, instance_prim)], [68, 80]);
        assert_eq!((size_of::<Packet>(), align_of::<Packet>()), (21 * 32, 32));
        assert_eq!([offset_of!(Packet, tfar), offset_of!(Packet, normal), offset_of!(Packet, prim)], [256, 384, 544]);
        assert_eq!((size_of::<Valid>(), align_of::<Valid>()), (32, 32));
        assert_eq!([offset_of!(Context3, filter), offset_of!(Context3, instance)], [8, 16]);
        assert_eq!([offset_of!(Arguments4, context), offset_of!(Arguments4, intersect)], [8, 24]);
    }
}
