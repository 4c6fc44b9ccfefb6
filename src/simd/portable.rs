//! The road that every processor has: arrays and loops, and the oracle for the others.

use super::{Kernel, LANES, Lanes, Simd};
use glam::Vec3;

/// Plain code.
#[derive(Clone, Copy, Debug)]
pub struct Portable;

#[inline(always)]
fn each(f: impl Fn(usize) -> f32) -> Lanes {
    let mut lanes = [0.0; LANES];
    for (i, lane) in lanes.iter_mut().enumerate() {
        *lane = f(i);
    }
    lanes
}

#[inline(always)]
fn doubles(f: impl Fn(usize) -> f64) -> [f64; LANES] {
    let mut lanes = [0.0; LANES];
    for (i, lane) in lanes.iter_mut().enumerate() {
        *lane = f(i);
    }
    lanes
}

#[inline(always)]
fn mask(f: impl Fn(usize) -> bool) -> u32 {
    let mut bits = [0u32; LANES];
    for (i, bit) in bits.iter_mut().enumerate() {
        *bit = u32::from(f(i)) << i;
    }
    bits.iter().fold(0, |a, b| a | b)
}

impl Simd for Portable {
    type F = Lanes;
    type M = u32;
    type I = [u8; LANES];
    type D = [f64; LANES];

    const DOUBLES: bool = false;

    // Not inlined: compiled once, whoever asks for it.
    #[inline(never)]
    fn run<K: Kernel>(self, kernel: K) -> K::Out {
        kernel.run(self)
    }

    #[inline(always)]
    fn splat(self, x: f32) -> Lanes {
        [x; LANES]
    }

    #[inline(always)]
    fn load(self, from: &Lanes) -> Lanes {
        *from
    }

    #[inline(always)]
    fn store(self, x: Lanes, to: &mut Lanes) {
        *to = x;
    }

    #[inline(always)]
    fn load_bits(self, from: &[u32; LANES]) -> Lanes {
        bytemuck::cast(*from)
    }

    #[inline(always)]
    fn store_bits(self, x: Lanes, to: &mut [u32; LANES]) {
        *to = bytemuck::cast(x);
    }

    #[inline(always)]
    fn splat_bits(self, x: u32) -> Lanes {
        self.splat(f32::from_bits(x))
    }

    #[inline(always)]
    fn add_bits(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| f32::from_bits(a[i].to_bits().wrapping_add(b[i].to_bits())))
    }

    #[inline(always)]
    fn sub_bits(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| f32::from_bits(a[i].to_bits().wrapping_sub(b[i].to_bits())))
    }

    #[inline(always)]
    fn and_bits(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| f32::from_bits(a[i].to_bits() & b[i].to_bits()))
    }

    #[inline(always)]
    fn add(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| a[i] + b[i])
    }

    #[inline(always)]
    fn sub(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| a[i] - b[i])
    }

    #[inline(always)]
    fn mul(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| a[i] * b[i])
    }

    #[inline(always)]
    fn div(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| a[i] / b[i])
    }

    #[inline(always)]
    fn min(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn max(self, a: Lanes, b: Lanes) -> Lanes {
        each(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn select(self, m: u32, a: Lanes, b: Lanes) -> Lanes {
        each(|i| if m >> i & 1 == 1 { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn le(self, a: Lanes, b: Lanes) -> u32 {
        mask(|i| a[i] <= b[i])
    }

    #[inline(always)]
    fn lt(self, a: Lanes, b: Lanes) -> u32 {
        mask(|i| a[i] < b[i])
    }

    #[inline(always)]
    fn eq(self, a: Lanes, b: Lanes) -> u32 {
        mask(|i| a[i] == b[i])
    }

    #[inline(always)]
    fn and(self, a: u32, b: u32) -> u32 {
        a & b
    }

    #[inline(always)]
    fn or(self, a: u32, b: u32) -> u32 {
        a | b
    }

    #[inline(always)]
    fn bits(self, m: u32) -> u32 {
        m
    }

    #[inline(always)]
    fn widen(self, x: Lanes) -> [f64; LANES] {
        doubles(|i| f64::from(x[i]))
    }

    #[inline(always)]
    fn narrow(self, x: [f64; LANES]) -> Lanes {
        each(|i| x[i] as f32)
    }

    #[inline(always)]
    fn splat_double(self, x: f64) -> [f64; LANES] {
        [x; LANES]
    }

    #[inline(always)]
    fn add_double(self, a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
        doubles(|i| a[i] + b[i])
    }

    #[inline(always)]
    fn sub_double(self, a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
        doubles(|i| a[i] - b[i])
    }

    #[inline(always)]
    fn mul_double(self, a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
        doubles(|i| a[i] * b[i])
    }

    #[inline(always)]
    fn div_double(self, a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
        doubles(|i| a[i] / b[i])
    }

    #[inline(always)]
    fn min_double(self, a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
        doubles(|i| if a[i] < b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn max_double(self, a: [f64; LANES], b: [f64; LANES]) -> [f64; LANES] {
        doubles(|i| if a[i] > b[i] { a[i] } else { b[i] })
    }

    #[inline(always)]
    fn abs_double(self, x: [f64; LANES]) -> [f64; LANES] {
        x.map(f64::abs)
    }

    #[inline(always)]
    fn lt_double(self, a: [f64; LANES], b: [f64; LANES]) -> u32 {
        mask(|i| a[i] < b[i])
    }

    #[inline(always)]
    fn load_shorts(self, from: &[u16; LANES]) -> Lanes {
        each(|i| f32::from(from[i]))
    }

    #[inline(always)]
    fn gather(self, from: &[Vec3], which: &[u32; LANES]) -> [Lanes; 3] {
        let mut by_axis = [[0.0; LANES]; 3];
        for (lane, i) in which.iter().enumerate() {
            let p = from[*i as usize];
            (by_axis[0][lane], by_axis[1][lane], by_axis[2][lane]) = (p.x, p.y, p.z);
        }
        by_axis
    }

    #[inline(always)]
    fn indices(self, from: &[u8; LANES]) -> [u8; LANES] {
        *from
    }

    #[inline(always)]
    fn flip(self, i: [u8; LANES], with: u32) -> [u8; LANES] {
        i.map(|i| i ^ with as u8)
    }

    #[inline(always)]
    fn permute(self, x: Lanes, i: [u8; LANES]) -> Lanes {
        each(|k| x[usize::from(i[k] & 7)])
    }

    #[inline(always)]
    fn transpose(self, rows: [Lanes; LANES]) -> [Lanes; LANES] {
        let mut columns = [[0.0; LANES]; LANES];
        for (i, row) in rows.iter().enumerate() {
            for (k, x) in row.iter().enumerate() {
                columns[k][i] = *x;
            }
        }
        columns
    }

    #[inline(always)]
    fn prefetch(self, _: usize) {}
}
