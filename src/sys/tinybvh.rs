//! tinybvh's eight-wide layout for processors (`BVH8_CPU`), by its C++ functions.
//!
//! The crate `tinybvh-rs` compiles tinybvh for this very machine, but what it offers is less: closest hits
//! only where the whole program is compiled for AVX2, no query for any hit, a slower builder, and leaves
//! that are not filled up to four triangles. So the C++ functions are called by their names. The version
//! of the crate is pinned for that.

#![expect(unsafe_code, reason = "C++ functions are called")]

use std::ffi::c_void;
use std::mem::MaybeUninit;
use std::ptr::NonNull;

use tinybvh_rs::{Intersection, Ray};

/// A ray as C++ has it: on a line of the cache, and with room for the user's data behind what the
/// crate declares, which no query touches.
#[repr(C, align(64))]
struct Aligned {
    ray: Ray,
    rest: MaybeUninit<[u8; 192]>,
}

/// `tinybvh::bvhvec4slice`.
#[repr(C)]
struct Corners {
    data: *const [f32; 4],
    count: u32,
    stride: u32,
}

unsafe extern "C" {
    /// `std::unique_ptr<BVH8_CPU> tinybvh::BVH8_CPU_new()`, which comes back through memory of the caller.
    #[link_name = "_ZN7tinybvh12BVH8_CPU_newEv"]
    fn new(bvh: *mut Option<NonNull<c_void>>) -> *mut c_void;
    /// `tinybvh::BVH8_CPU::~BVH8_CPU()`.
    #[link_name = "_ZN7tinybvh8BVH8_CPUD1Ev"]
    fn destroy(bvh: *mut c_void);
    /// `operator delete(void*)`.
    #[link_name = "_ZdlPv"]
    fn delete(bvh: *mut c_void);
    /// `void tinybvh::BVH8_CPU::Build(const bvhvec4slice&)`.
    #[link_name = "_ZN7tinybvh8BVH8_CPU5BuildERKNS_12bvhvec4sliceE"]
    fn build(bvh: *mut c_void, corners: *const Corners);
    /// `void tinybvh::BVH8_CPU::BuildHQ(const bvhvec4slice&)`.
    #[link_name = "_ZN7tinybvh8BVH8_CPU7BuildHQERKNS_12bvhvec4sliceE"]
    fn build_hq(bvh: *mut c_void, corners: *const Corners);
    /// `int32_t tinybvh::BVH8_CPU::Intersect(Ray&) const`.
    #[link_name = "_ZNK7tinybvh8BVH8_CPU9IntersectERNS_3RayE"]
    fn intersect(bvh: *const c_void, ray: *mut Aligned) -> i32;
    /// `bool tinybvh::BVH8_CPU::IsOccluded(const Ray&) const`.
    #[link_name = "_ZNK7tinybvh8BVH8_CPU10IsOccludedERKNS_3RayE"]
    fn is_occluded(bvh: *const c_void, ray: *const Aligned) -> bool;
}

/// Whether this processor has what the layout needs; without it the C++ ends the program.
pub fn supported() -> bool {
    is_x86_feature_detected!("avx2") && is_x86_feature_detected!("fma")
}

/// A built structure.
#[derive(Debug)]
pub struct Wide {
    bvh: NonNull<c_void>,
    /// C++ keeps pointers to them.
    corners: Vec<[f32; 4]>,
}

// SAFETY: queries only read the structure, and nothing else can be done with it once it is built.
unsafe impl Send for Wide {}
// SAFETY: as above.
unsafe impl Sync for Wide {}

/// The version is that of the names and offsets here: the hit's t after its instance, at byte 48.
const _: () = assert!(std::mem::offset_of!(Ray, hit) == 48 && size_of::<Ray>() == 64);

impl Wide {
    /// Builds over triangles, three corners each, with spatial splits if asked for. `None` where there
    /// are none, or more than 32 bits count, or where the processor lacks what it needs.
    pub fn new(corners: Vec<[f32; 4]>, spatial_splits: bool) -> Option<Self> {
        let count = u32::try_from(corners.len()).ok().filter(|n| *n > 0 && n % 3 == 0 && *n < u32::MAX / 4)?;
        if !supported() {
            return None;
        }
        let mut bvh = None;
        // SAFETY: a `unique_ptr` is a pointer, written to `bvh`; the structure is empty then.
        unsafe { new(&raw mut bvh) };
        let wide = Self { bvh: bvh?, corners };
        let slice = Corners { data: wide.corners.as_ptr(), count, stride: 16 };
        // SAFETY: the structure is new, and the corners live as long as it does.
        unsafe { (if spatial_splits { build_hq } else { build })(wide.bvh.as_ptr(), &raw const slice) };
        Some(wide)
    }

    /// The t and the triangle of the closest hit with t above 0 and below `tmax`.
    #[inline]
    pub fn closest(&self, origin: [f32; 3], dir: [f32; 3], tmax: f32) -> Option<(f32, u32)> {
        let mut ray = ray(origin, dir, tmax);
        // SAFETY: the structure lives, and the ray lies as C++ wants it.
        unsafe { intersect(self.bvh.as_ptr(), &raw mut ray) };
        (ray.ray.hit.t < ray_end(tmax)).then_some((ray.ray.hit.t, ray.ray.hit.prim))
    }

    /// Whether there is any hit in that interval.
    #[inline]
    pub fn any(&self, origin: [f32; 3], dir: [f32; 3], tmax: f32) -> bool {
        let ray = ray(origin, dir, tmax);
        // SAFETY: as in `closest`.
        unsafe { is_occluded(self.bvh.as_ptr(), &raw const ray) }
    }
}

impl Drop for Wide {
    fn drop(&mut self) {
        // SAFETY: the structure was made by `new`, C++'s own, and nobody else has it.
        unsafe {
            destroy(self.bvh.as_ptr());
            delete(self.bvh.as_ptr());
        }
    }
}

/// tinybvh's infinity.
#[inline(always)]
const fn ray_end(tmax: f32) -> f32 {
    tmax.min(tinybvh_rs::INFINITE)
}

#[inline(always)]
fn ray(origin: [f32; 3], dir: [f32; 3], tmax: f32) -> Aligned {
    /// `RAY_MASK_INTERSECT_ALL`.
    const ALL: u32 = 0xFFFF;
    // As `tinybvh_safercp`: an infinite reciprocal would make 0 * infinity at a box's face.
    let far = |d: f32| if d >= 0.0 { tinybvh_rs::INFINITE } else { -tinybvh_rs::INFINITE };
    let r_d = dir.map(|d| if d.abs() > 1e-12 { 1.0 / d } else { far(d) });
    let hit = Intersection { t: ray_end(tmax), ..Intersection::default() };
    let ray = Ray { origin, padding_0: ALL, dir, padding_1: 0, r_d, padding_2: 0, hit };
    Aligned { ray, rest: MaybeUninit::uninit() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_triangle_is_hit_from_both_sides() {
        let corners = vec![[-1.0, -1.0, 2.0, 0.0], [1.0, -1.0, 2.0, 0.0], [0.0, 1.0, 2.0, 0.0]];
        assert!(Wide::new(Vec::new(), false).is_none() && Wide::new(corners[..2].to_vec(), true).is_none());
        for spatial_splits in [false, true] {
            let Some(wide) = Wide::new(corners.clone(), spatial_splits) else { return };
            for (z, dz) in [(0.0, 1.0), (4.0, -1.0)] {
                let (t, prim) = wide.closest([0.0, 0.0, z], [0.0, 0.0, dz], f32::INFINITY).expect("a hit");
                assert!((t - 2.0).abs() < 1e-3 && prim == 0, "{t}");
                assert!(wide.any([0.0, 0.0, z], [0.0, 0.0, dz], 3.0) && !wide.any([0.0, 0.0, z], [0.0, 0.0, dz], 1.0));
                assert!(wide.closest([3.0, 0.0, z], [0.0, 0.0, dz], f32::INFINITY).is_none());
            }
        }
    }
}
