//! Rays made ready eight at a time, and each on its way among others.

use super::beam::{Beam, Eight, Limits, Spread};
use super::child::Child;
use super::open::Open;
use super::ray::Found;
use crate::accel::best::Best;
use crate::accel::{Hit, Traced};
use crate::geometry::eight::Rays;
use crate::geometry::space::Back;
use crate::geometry::tri::{Own, TriTest};
use crate::geometry::{EightSlabs, Ray, Slabs};
use crate::scene::{Geometry, Whose};
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// What is asked of a ray at every step: twice eight numbers and four.
///
/// ```text
/// 0  o_lo.x o_lo.y o_lo.z o_hi.x o_hi.y o_hi.z inv.x inv.y     (see `Slabs`)
/// 1  inv.z  order  own[0 .. 6]                                 (see `slots`, and `Own`)
/// 2  own[6] tmin tmax scale
/// ```
type Numbers = [Lanes; 3];

/// A ray made ready: in the scaled space, and worked out for boxes and triangles.
#[derive(Clone, Copy, Debug)]
pub struct Ready {
    numbers: Numbers,
    back: Back,
    /// Which ray it is.
    at: usize,
}

impl Ready {
    const NONE: Self = Self { numbers: [[0.0; LANES]; 3], back: Back::NONE, at: 0 };
}

/// A ray on its way.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Way {
    numbers: Numbers,
    pub best: Best,
    /// The last child that was met and not visited yet.
    pub last: u32,
    /// The place of the block that was looked at last, and what was found there.
    pub block: u32,
    at: usize,
    back: Back,
    pub found: Found,
    pub open: Open,
}

impl Way {
    /// No ray.
    pub const fn idle() -> Self {
        let Ready { numbers, back, at } = Ready::NONE;
        Self { numbers, best: Best::new(0.0, 0.0), last: 0, block: 0, at, back, found: Found::NONE, open: Open::new() }
    }

    /// Begins with another ray.
    #[inline(always)]
    pub fn begin(&mut self, ready: &Ready, root: Child) {
        (self.numbers, self.back, self.at) = (ready.numbers, ready.back, ready.at);
        self.best = Best::new(ready.numbers[2][1], ready.numbers[2][2]);
        self.last = self.open.begin(root, ready.numbers[2][1]);
    }

    /// As one ray's test sees it.
    #[inline(always)]
    pub fn test<T: TriTest>(&self) -> T {
        T::from_own(&self.own(), self.slabs())
    }

    /// What the triangle test needs.
    #[inline(always)]
    pub const fn own(&self) -> Own<f32> {
        let [_, b, c] = &self.numbers;
        [b[2], b[3], b[4], b[5], b[6], b[7], c[0]]
    }

    /// What boxes need.
    #[inline(always)]
    pub fn slabs(&self) -> Slabs {
        let [a, b, _] = &self.numbers;
        Slabs::from_parts([a[0], a[1], a[2]], [a[3], a[4], a[5]], [a[6], a[7], b[0]])
    }

    /// The same with the axes in another order.
    #[inline(always)]
    pub fn slabs_in_order(&self, [x, y, z]: [usize; 3]) -> Slabs {
        // The three numbers of each part lie in a row.
        let numbers: &[f32; 3 * LANES] = bytemuck::cast_ref(&self.numbers);
        let (x, y, z) = (x % 3, y % 3, z % 3);
        let (lo, hi, inv) = (&numbers[0..3], &numbers[3..6], &numbers[6..9]);
        Slabs::from_parts([lo[x], lo[y], lo[z]], [hi[x], hi[y], hi[z]], [inv[x], inv[y], inv[z]])
    }

    /// The order in which slots are visited: see [`super::slots`].
    #[inline(always)]
    pub const fn order(&self) -> u32 {
        self.numbers[1][1].to_bits()
    }

    /// Writes what was found.
    #[inline(always)]
    pub fn end(&self, whose: &Whose<'_>, hits: &mut [Option<Hit>]) {
        hits[self.at] = if let Some(found) = self.best.found() {
            let (instance, primitive) = whose.locate(found.prim);
            Some(Hit { t: self.back.world_t(found.t), u: found.u, v: found.v, instance, primitive })
        } else {
            None
        };
    }
}

/// The rays of a batch that are made ready next.
#[derive(Debug)]
pub struct Rest<'a> {
    geometry: &'a Geometry,
    rays: &'a [Ray],
    limits: Limits,
    next: usize,
    ready: [Ready; LANES],
    /// Those of them that are not taken yet, a bit for each.
    left: u32,
    pub traced: Traced,
}

/// All eight.
const ALL: u32 = (1 << LANES) - 1;

/// The least and the greatest of each column.
#[inline(always)]
fn ends<S: Simd>(s: S, rows: &[S::F; LANES]) -> (S::F, S::F) {
    let [a, b, c, d, e, f, g, h] = *rows;
    let low = s.min(s.min(s.min(a, b), s.min(c, d)), s.min(s.min(e, f), s.min(g, h)));
    let high = s.max(s.max(s.max(a, b), s.max(c, d)), s.max(s.max(e, f), s.max(g, h)));
    (low, high)
}

/// Whether the bits of all lanes are the same.
#[inline(always)]
fn same<S: Simd>(s: S, x: S::F) -> bool {
    let mut lanes = [0; LANES];
    s.store_bits(x, &mut lanes);
    let differ = s.sub_bits(x, s.splat_bits(lanes[0]));
    s.bits(s.eq(differ, s.splat(0.0))) == ALL
}

/// Stands where there is no ray: it is not valid.
const NO_RAY: Ray = Ray::new(Vec3::ZERO, Vec3::ZERO);

impl<'a> Rest<'a> {
    pub fn new(geometry: &'a Geometry, rays: &'a [Ray]) -> Self {
        let limits = Limits::new(geometry.live_count());
        Self { geometry, rays, limits, next: 0, ready: [Ready::NONE; LANES], left: 0, traced: Traced::default() }
    }

    /// The next that may hit anything and is to go its own way.
    #[inline(always)]
    pub fn take(&mut self) -> Option<&Ready> {
        if self.left == 0 {
            return None;
        }
        let lane = self.left.trailing_zeros() as usize % LANES;
        self.left &= self.left - 1;
        Some(&self.ready[lane])
    }

    /// Whether more can be made ready: all that were are taken, and there are others.
    #[inline(always)]
    pub const fn can_prepare(&self) -> bool {
        self.left == 0 && self.next < self.rays.len()
    }

    /// Whether all were made ready and taken.
    pub const fn is_done(&self) -> bool {
        self.left == 0 && self.next == self.rays.len()
    }

    /// Makes the next eight ready, or begins a beam with them: whether it was that.
    #[inline(always)]
    pub fn prepare<T: TriTest, S: Simd>(&mut self, s: S, hits: &mut [Option<Hit>], beam: &mut Beam, root: Child) -> bool {
        let first = self.next;
        let rest = &self.rays[first..];
        let count = rest.len().min(LANES);
        self.next += count;
        let mut last = [NO_RAY; LANES];
        let rays = match rest.first_chunk::<LANES>() {
            Some(rays) => rays,
            None => {
                last[..count].copy_from_slice(rest);
                &last
            }
        };
        let coming = rest.as_ptr().addr() + size_of_val(rays);
        s.prefetch(coming);
        s.prefetch(coming + 64);
        s.prefetch(coming + 128);
        s.prefetch(coming + 192);
        let eight = Rays::load(s, rays);
        let valid = eight.valid(s);
        self.traced.invalid += (count - valid.count_ones() as usize) as u64;
        let (bounds, mut lanes) = (self.geometry.bounds(), valid);
        if let Some((eight, scales)) = self.geometry.space().enter_eight(s, &eight, valid) {
            lanes &= s.bits(s.le(eight.tmin, eight.tmax));
            let slabs = EightSlabs::new(s, &eight, bounds);
            let EightSlabs { o_lo, o_hi, inv } = slabs;
            let own = T::own_of_eight(s, &eight);
            let zero = s.splat(0.0);
            let a = s.transpose([o_lo.x, o_lo.y, o_lo.z, o_hi.x, o_hi.y, o_hi.z, inv.x, inv.y]);
            let order = slabs.forward(s);
            if lanes == ALL {
                let (least, greatest) = ends(s, &a);
                let others = [inv.z, s.sub(zero, inv.z), eight.tmin, s.sub(zero, eight.tmax), zero, zero, zero, zero];
                let (others, _) = ends(s, &s.transpose(others));
                let mut spread = Spread { least: [0.0; LANES], greatest: [0.0; LANES], others: [0.0; LANES] };
                s.store(least, &mut spread.least);
                s.store(greatest, &mut spread.greatest);
                s.store(others, &mut spread.others);
                // One octant, and one order of axes.
                let alike = same(s, order) && same(s, own[6]);
                if alike && spread.is_narrow(&self.limits) {
                    beam.begin::<T, S>(s, &Eight { rays: eight, slabs, own, scales }, &spread, first, root);
                    self.traced.in_beams += LANES as u64;
                    return true;
                }
            }
            let [o0, o1, o2, o3, o4, o5, o6] = own;
            let b = s.transpose([inv.z, order, o0, o1, o2, o3, o4, o5]);
            let c = s.transpose([o6, eight.tmin, eight.tmax, scales, zero, zero, zero, zero]);
            for lane in 0..LANES {
                let ready = &mut self.ready[lane];
                s.store(a[lane], &mut ready.numbers[0]);
                s.store(b[lane], &mut ready.numbers[1]);
                s.store(c[lane], &mut ready.numbers[2]);
                ready.back = Back::scaled(ready.numbers[2][3]);
                ready.at = first + lane;
            }
        } else {
            lanes &= self.prepare_one_by_one::<T>(first, rays, valid);
        }
        self.left = lanes;
        let mut misses = ((1u32 << count) - 1) & !lanes;
        while misses != 0 {
            hits[first + misses.trailing_zeros() as usize] = None;
            misses &= misses - 1;
        }
        false
    }

    /// The same the long way: the lanes of rays that may hit anything.
    #[cold]
    fn prepare_one_by_one<T: TriTest>(&mut self, first: usize, rays: &[Ray; LANES], valid: u32) -> u32 {
        let mut lanes = 0;
        for (lane, ray) in rays.iter().enumerate().filter(|(lane, _)| valid >> lane & 1 == 1) {
            let entered = self.geometry.space().enter(ray);
            let test = T::prepare(&entered.ray, self.geometry.bounds());
            let slabs = test.slabs();
            let [lo, hi, inv] = slabs.parts();
            let own = test.own();
            let a = [lo[0], lo[1], lo[2], hi[0], hi[1], hi[2], inv[0], inv[1]];
            let b = [inv[2], f32::from_bits(slabs.forward()), own[0], own[1], own[2], own[3], own[4], own[5]];
            let c = [own[6], entered.ray.tmin, entered.ray.tmax, 0.0, 0.0, 0.0, 0.0, 0.0];
            self.ready[lane] = Ready { numbers: [a, b, c], back: entered.back, at: first + lane };
            lanes |= u32::from(entered.ray.tmin <= entered.ray.tmax) << lane;
        }
        lanes
    }
}
