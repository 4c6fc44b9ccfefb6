//! Eight floats at a time: a small trait with one implementation per road. [`Avx2`] is taken where
//! the processor has it, [`Portable`] everywhere else; both give the same results to the bit, since no
//! operation here is fused or approximate.
//!
//! A kernel is written once, generic over [`Simd`], and everything beneath it is
//! `#[inline(always)]`: [`Simd::run`] is the one place where a road's instructions are switched on, so
//! it is called once a batch and not once an operation.

#[cfg(target_arch = "x86_64")]
mod avx2;
mod compress;
mod portable;

#[cfg(test)]
mod tests;

#[cfg(target_arch = "x86_64")]
pub use avx2::Avx2;
pub use compress::{LEFT, UNDER_XOR};
use glam::Vec3;
pub use portable::Portable;

/// Lanes of every vector.
pub const LANES: usize = 8;

/// One float for each lane, as it lies in memory.
pub type Lanes = [f32; LANES];

/// What is run on a road: a closure whose code the road's instructions are compiled into.
pub trait Kernel {
    /// What it returns.
    type Out;

    /// The work; must be `#[inline(always)]`.
    fn run<S: Simd>(self, s: S) -> Self::Out;
}

/// A road: what the processor can do at a time. Values of the type exist only where it can.
pub trait Simd: Copy + Send + Sync + 'static {
    /// Eight floats.
    type F: Copy;
    /// Eight times yes or no.
    type M: Copy;
    /// Eight numbers of lanes, 0 to 7.
    type I: Copy;
    /// Eight floats of 64 bits.
    type D: Copy;

    /// Whether eight lanes of 64 bits are more than a way to write loops.
    const DOUBLES: bool;

    /// Compiles a kernel for this road and runs it.
    fn run<K: Kernel>(self, kernel: K) -> K::Out;

    /// The same float in all lanes.
    fn splat(self, x: f32) -> Self::F;
    /// From memory.
    fn load(self, from: &Lanes) -> Self::F;
    /// To memory.
    fn store(self, x: Self::F, to: &mut Lanes);
    /// Eight integers from memory, as floats of the same bits: to be permuted and stored, not counted with.
    fn load_bits(self, from: &[u32; LANES]) -> Self::F;
    /// The same back.
    fn store_bits(self, x: Self::F, to: &mut [u32; LANES]);
    /// The same integer in all lanes, as floats of the same bits.
    fn splat_bits(self, x: u32) -> Self::F;
    /// The sum of the bits as integers, which may wrap.
    fn add_bits(self, a: Self::F, b: Self::F) -> Self::F;
    /// The difference of the bits as integers, which may wrap.
    fn sub_bits(self, a: Self::F, b: Self::F) -> Self::F;
    /// The bits that both have.
    fn and_bits(self, a: Self::F, b: Self::F) -> Self::F;
    /// The sum.
    fn add(self, a: Self::F, b: Self::F) -> Self::F;
    /// The difference.
    fn sub(self, a: Self::F, b: Self::F) -> Self::F;
    /// The product.
    fn mul(self, a: Self::F, b: Self::F) -> Self::F;
    /// The quotient.
    fn div(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a < b ? a : b`.
    fn min(self, a: Self::F, b: Self::F) -> Self::F;
    /// `a > b ? a : b`.
    fn max(self, a: Self::F, b: Self::F) -> Self::F;
    /// Without the sign.
    #[inline(always)]
    fn abs(self, x: Self::F) -> Self::F {
        self.and_bits(x, self.splat_bits(!(1 << 31)))
    }
    /// `m ? a : b`.
    fn select(self, m: Self::M, a: Self::F, b: Self::F) -> Self::F;
    /// Where `a <= b`.
    fn le(self, a: Self::F, b: Self::F) -> Self::M;
    /// Where `a < b`.
    fn lt(self, a: Self::F, b: Self::F) -> Self::M;
    /// Where `a == b`.
    fn eq(self, a: Self::F, b: Self::F) -> Self::M;
    /// Both.
    fn and(self, a: Self::M, b: Self::M) -> Self::M;
    /// Either.
    fn or(self, a: Self::M, b: Self::M) -> Self::M;
    /// One bit for each lane.
    fn bits(self, m: Self::M) -> u32;

    /// The same numbers in 64 bits.
    fn widen(self, x: Self::F) -> Self::D;
    /// Rounded to 32 bits, to the nearest, ties to even.
    fn narrow(self, x: Self::D) -> Self::F;
    /// The same float in all lanes.
    fn splat_double(self, x: f64) -> Self::D;
    /// The sum.
    fn add_double(self, a: Self::D, b: Self::D) -> Self::D;
    /// The difference.
    fn sub_double(self, a: Self::D, b: Self::D) -> Self::D;
    /// The product.
    fn mul_double(self, a: Self::D, b: Self::D) -> Self::D;
    /// The quotient.
    fn div_double(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a < b ? a : b`.
    fn min_double(self, a: Self::D, b: Self::D) -> Self::D;
    /// `a > b ? a : b`.
    fn max_double(self, a: Self::D, b: Self::D) -> Self::D;
    /// Without the sign.
    fn abs_double(self, x: Self::D) -> Self::D;
    /// Where `a < b`.
    fn lt_double(self, a: Self::D, b: Self::D) -> Self::M;

    /// Eight whole numbers from memory, as floats of the same value.
    fn load_shorts(self, from: &[u16; LANES]) -> Self::F;
    /// Eight points of a list, by axis. Panics if one of them is not there.
    fn gather(self, from: &[Vec3], which: &[u32; LANES]) -> [Self::F; 3];

    /// Numbers of lanes from memory; only the three lowest bits count.
    fn indices(self, from: &[u8; LANES]) -> Self::I;
    /// Each number with the bits of `with`, 0 to 7, flipped.
    fn flip(self, i: Self::I, with: u32) -> Self::I;
    /// Lane `i[k]` of `x` in lane `k`.
    fn permute(self, x: Self::F, i: Self::I) -> Self::F;

    /// Lane `k` of the eight in vector `k`.
    fn transpose(self, rows: [Self::F; LANES]) -> [Self::F; LANES];

    /// Asks for a cache line that is needed soon, at any address: nothing is read.
    fn prefetch(self, address: usize);
}

/// The roads, to choose one once a batch.
#[derive(Clone, Copy, Debug)]
pub enum Road {
    /// AVX2.
    #[cfg(target_arch = "x86_64")]
    Avx2(Avx2),
    /// Plain code, which compilers turn into whatever vectors every processor of a kind has.
    Portable(Portable),
}

impl Road {
    /// The fastest that this processor has.
    #[inline]
    pub fn best() -> Self {
        #[cfg(target_arch = "x86_64")]
        if let Some(avx2) = Avx2::new() {
            return Self::Avx2(avx2);
        }
        Self::Portable(Portable)
    }

    /// All that this processor has.
    pub fn all() -> Vec<Self> {
        let mut all = vec![Self::Portable(Portable)];
        #[cfg(target_arch = "x86_64")]
        all.extend(Avx2::new().map(Self::Avx2));
        all
    }

    /// What it is called in reports.
    pub const fn id(self) -> &'static str {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(_) => "avx2",
            Self::Portable(_) => "portable",
        }
    }

    /// Whether vectors of eight lanes are more than a way to write loops.
    pub const fn is_wide(self) -> bool {
        !matches!(self, Self::Portable(_))
    }

    /// Runs a kernel that is for eight lanes side by side, many of them at a time; gives it back on the plain
    /// road, where such kernels take minutes to compile.
    #[inline]
    pub fn run_wide<K: Kernel>(self, kernel: K) -> Result<K::Out, K> {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(s) => Ok(s.run(kernel)),
            Self::Portable(_) => Err(kernel),
        }
    }

    /// Runs a kernel on it.
    #[inline]
    pub fn run<K: Kernel>(self, kernel: K) -> K::Out {
        match self {
            #[cfg(target_arch = "x86_64")]
            Self::Avx2(s) => s.run(kernel),
            Self::Portable(s) => s.run(kernel),
        }
    }
}
