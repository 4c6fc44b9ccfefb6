//! The road of x86 processors since 2013. Every `unsafe` here calls an AVX2 instruction, or a load or
//! store of exactly the bytes of a reference: a value of [`Avx2`] exists only where [`Avx2::new`] has
//! asked the processor.
#![expect(unsafe_code)]

use std::arch::x86_64::*;

use super::{Kernel, LANES, Lanes, Portable, Simd};
use glam::Vec3;

/// AVX2, BMI and POPCNT are there.
#[derive(Clone, Copy, Debug)]
pub struct Avx2(());

impl Avx2 {
    /// If this processor has it.
    #[inline]
    pub fn new() -> Option<Self> {
        let has = is_x86_feature_detected!("avx2")
            && is_x86_feature_detected!("bmi1")
            && is_x86_feature_detected!("bmi2")
            && is_x86_feature_detected!("popcnt")
            && is_x86_feature_detected!("lzcnt");
        has.then_some(Self(()))
    }
}

#[target_feature(enable = "avx,avx2,bmi1,bmi2,popcnt,lzcnt")]
fn enter<K: Kernel>(s: Avx2, kernel: K) -> K::Out {
    kernel.run(s)
}

/// A point, and the one four further on, each in half a vector with one number more.
///
/// # Safety
/// AVX is there; all numbers in `which` are those of points that have another behind them.
#[inline(always)]
unsafe fn two(from: &[Vec3], which: &[u32; LANES], k: usize) -> __m256 {
    // SAFETY: as above.
    unsafe {
        let (low, high) = (from.as_ptr().add(which[k] as usize), from.as_ptr().add(which[k + 4] as usize));
        _mm256_insertf128_ps::<1>(_mm256_castps128_ps256(_mm_loadu_ps(low.cast())), _mm_loadu_ps(high.cast()))
    }
}

/// Points of which one is the last of the list, or not in it.
#[cold]
fn last(from: &[Vec3], which: &[u32; LANES]) -> [Lanes; 3] {
    Portable.gather(from, which)
}

impl Simd for Avx2 {
    type F = __m256;
    type M = __m256;
    type I = __m256i;
    type D = [__m256d; 2];

    const DOUBLES: bool = true;

    #[inline(always)]
    fn run<K: Kernel>(self, kernel: K) -> K::Out {
        // SAFETY: the processor has these instructions, or there were no `self`.
        unsafe { enter(self, kernel) }
    }

    #[inline(always)]
    fn splat(self, x: f32) -> __m256 {
        // SAFETY: as above.
        unsafe { _mm256_set1_ps(x) }
    }

    #[inline(always)]
    fn load(self, from: &Lanes) -> __m256 {
        // SAFETY: the reference is to 32 bytes; no alignment is asked for.
        unsafe { _mm256_loadu_ps(from.as_ptr()) }
    }

    #[inline(always)]
    fn store(self, x: __m256, to: &mut Lanes) {
        // SAFETY: the reference is to 32 bytes; no alignment is asked for.
        unsafe { _mm256_storeu_ps(to.as_mut_ptr(), x) }
    }

    #[inline(always)]
    fn load_bits(self, from: &[u32; LANES]) -> __m256 {
        // SAFETY: the reference is to 32 bytes; no alignment is asked for.
        unsafe { _mm256_castsi256_ps(_mm256_loadu_si256(from.as_ptr().cast())) }
    }

    #[inline(always)]
    fn store_bits(self, x: __m256, to: &mut [u32; LANES]) {
        // SAFETY: the reference is to 32 bytes; no alignment is asked for.
        unsafe { _mm256_storeu_si256(to.as_mut_ptr().cast(), _mm256_castps_si256(x)) }
    }

    #[inline(always)]
    fn splat_bits(self, x: u32) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_castsi256_ps(_mm256_set1_epi32(x.cast_signed())) }
    }

    #[inline(always)]
    fn add_bits(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_castsi256_ps(_mm256_add_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
    }

    #[inline(always)]
    fn sub_bits(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_castsi256_ps(_mm256_sub_epi32(_mm256_castps_si256(a), _mm256_castps_si256(b))) }
    }

    #[inline(always)]
    fn and_bits(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_and_ps(a, b) }
    }

    #[inline(always)]
    fn add(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_add_ps(a, b) }
    }

    #[inline(always)]
    fn sub(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_sub_ps(a, b) }
    }

    #[inline(always)]
    fn mul(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_mul_ps(a, b) }
    }

    #[inline(always)]
    fn div(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_div_ps(a, b) }
    }

    #[inline(always)]
    fn min(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_min_ps(a, b) }
    }

    #[inline(always)]
    fn max(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_max_ps(a, b) }
    }

    #[inline(always)]
    fn select(self, m: __m256, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_blendv_ps(b, a, m) }
    }

    #[inline(always)]
    fn le(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_cmp_ps::<_CMP_LE_OQ>(a, b) }
    }

    #[inline(always)]
    fn lt(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_cmp_ps::<_CMP_LT_OQ>(a, b) }
    }

    #[inline(always)]
    fn eq(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_cmp_ps::<_CMP_EQ_OQ>(a, b) }
    }

    #[inline(always)]
    fn and(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_and_ps(a, b) }
    }

    #[inline(always)]
    fn or(self, a: __m256, b: __m256) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_or_ps(a, b) }
    }

    #[inline(always)]
    fn bits(self, m: __m256) -> u32 {
        // SAFETY: as in `run`.
        unsafe { _mm256_movemask_ps(m).cast_unsigned() }
    }

    #[inline(always)]
    fn widen(self, x: __m256) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_cvtps_pd(_mm256_castps256_ps128(x)), _mm256_cvtps_pd(_mm256_extractf128_ps::<1>(x))] }
    }

    #[inline(always)]
    fn narrow(self, [a, b]: [__m256d; 2]) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_set_m128(_mm256_cvtpd_ps(b), _mm256_cvtpd_ps(a)) }
    }

    #[inline(always)]
    fn splat_double(self, x: f64) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_set1_pd(x); 2] }
    }

    #[inline(always)]
    fn add_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_add_pd(a, c), _mm256_add_pd(b, d)] }
    }

    #[inline(always)]
    fn sub_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_sub_pd(a, c), _mm256_sub_pd(b, d)] }
    }

    #[inline(always)]
    fn mul_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_mul_pd(a, c), _mm256_mul_pd(b, d)] }
    }

    #[inline(always)]
    fn div_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_div_pd(a, c), _mm256_div_pd(b, d)] }
    }

    #[inline(always)]
    fn min_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_min_pd(a, c), _mm256_min_pd(b, d)] }
    }

    #[inline(always)]
    fn max_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe { [_mm256_max_pd(a, c), _mm256_max_pd(b, d)] }
    }

    #[inline(always)]
    fn abs_double(self, [a, b]: [__m256d; 2]) -> [__m256d; 2] {
        // SAFETY: as in `run`.
        unsafe {
            let sign = _mm256_set1_pd(-0.0);
            [_mm256_andnot_pd(sign, a), _mm256_andnot_pd(sign, b)]
        }
    }

    #[inline(always)]
    fn lt_double(self, [a, b]: [__m256d; 2], [c, d]: [__m256d; 2]) -> __m256 {
        // SAFETY: as in `run`.
        unsafe {
            let (low, high) = (_mm256_cmp_pd::<_CMP_LT_OQ>(a, c), _mm256_cmp_pd::<_CMP_LT_OQ>(b, d));
            // Half of each mask of 64 bits, and the four pairs in order.
            let halves = _mm256_shuffle_ps::<0x88>(_mm256_castpd_ps(low), _mm256_castpd_ps(high));
            _mm256_castpd_ps(_mm256_permute4x64_pd::<0xD8>(_mm256_castps_pd(halves)))
        }
    }

    #[inline(always)]
    fn load_shorts(self, from: &[u16; LANES]) -> __m256 {
        // SAFETY: the reference is to the 16 bytes that are loaded.
        unsafe { _mm256_cvtepi32_ps(_mm256_cvtepu16_epi32(_mm_loadu_si128(from.as_ptr().cast()))) }
    }

    #[inline(always)]
    fn gather(self, from: &[Vec3], which: &[u32; LANES]) -> [__m256; 3] {
        // SAFETY: the reference is to 32 bytes. Four floats are loaded where a point has three, so every
        // point must have another behind it: `others` is the greatest that does, and all were compared with it.
        unsafe {
            let i = _mm256_loadu_si256(which.as_ptr().cast());
            let others = u32::try_from(from.len()).unwrap_or(u32::MAX).wrapping_sub(2);
            let others = _mm256_set1_epi32(others.cast_signed());
            let within = _mm256_cmpeq_epi32(_mm256_max_epu32(i, others), others);
            if from.len() < 2 || _mm256_movemask_epi8(within) != -1 {
                let [x, y, z] = last(from, which);
                return [self.load(&x), self.load(&y), self.load(&z)];
            }
            let (a, b) = (two(from, which, 0), two(from, which, 1));
            let (c, d) = (two(from, which, 2), two(from, which, 3));
            let (ab, ab2) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd, cd2) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            [_mm256_shuffle_ps::<0x44>(ab, cd), _mm256_shuffle_ps::<0xEE>(ab, cd), _mm256_shuffle_ps::<0x44>(ab2, cd2)]
        }
    }

    #[inline(always)]
    fn indices(self, from: &[u8; LANES]) -> __m256i {
        // SAFETY: the reference is to the 8 bytes that are loaded.
        unsafe { _mm256_cvtepu8_epi32(_mm_loadl_epi64(from.as_ptr().cast())) }
    }

    #[inline(always)]
    fn flip(self, i: __m256i, with: u32) -> __m256i {
        // SAFETY: as in `run`.
        unsafe { _mm256_xor_si256(i, _mm256_set1_epi32(with.cast_signed())) }
    }

    #[inline(always)]
    fn permute(self, x: __m256, i: __m256i) -> __m256 {
        // SAFETY: as in `run`.
        unsafe { _mm256_permutevar8x32_ps(x, i) }
    }

    #[inline(always)]
    fn transpose(self, [a, b, c, d, e, f, g, h]: [__m256; LANES]) -> [__m256; LANES] {
        // SAFETY: as in `run`.
        unsafe {
            let (ab, ab2) = (_mm256_unpacklo_ps(a, b), _mm256_unpackhi_ps(a, b));
            let (cd, cd2) = (_mm256_unpacklo_ps(c, d), _mm256_unpackhi_ps(c, d));
            let (ef, ef2) = (_mm256_unpacklo_ps(e, f), _mm256_unpackhi_ps(e, f));
            let (gh, gh2) = (_mm256_unpacklo_ps(g, h), _mm256_unpackhi_ps(g, h));
            let (a0, a1) = (_mm256_shuffle_ps::<0x44>(ab, cd), _mm256_shuffle_ps::<0xEE>(ab, cd));
            let (a2, a3) = (_mm256_shuffle_ps::<0x44>(ab2, cd2), _mm256_shuffle_ps::<0xEE>(ab2, cd2));
            let (e0, e1) = (_mm256_shuffle_ps::<0x44>(ef, gh), _mm256_shuffle_ps::<0xEE>(ef, gh));
            let (e2, e3) = (_mm256_shuffle_ps::<0x44>(ef2, gh2), _mm256_shuffle_ps::<0xEE>(ef2, gh2));
            [
                _mm256_permute2f128_ps::<0x20>(a0, e0),
                _mm256_permute2f128_ps::<0x20>(a1, e1),
                _mm256_permute2f128_ps::<0x20>(a2, e2),
                _mm256_permute2f128_ps::<0x20>(a3, e3),
                _mm256_permute2f128_ps::<0x31>(a0, e0),
                _mm256_permute2f128_ps::<0x31>(a1, e1),
                _mm256_permute2f128_ps::<0x31>(a2, e2),
                _mm256_permute2f128_ps::<0x31>(a3, e3),
            ]
        }
    }

    #[inline(always)]
    fn prefetch(self, address: usize) {
        // SAFETY: as in `run`; a prefetch reads nothing, and no address is wrong for it.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(std::ptr::without_provenance(address)) }
    }
}
