//! The data of Embree's C interface, as far as it is used: `rtcore_*.h` of versions 3.13 and 4.

use std::ffi::{c_int, c_uint, c_void};

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
