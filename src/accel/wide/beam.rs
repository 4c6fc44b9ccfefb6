//! Eight rays that go the same way, as one: a beam.
//!
//! What the eight have in common is kept as bounds on their numbers, and boxes are met by the bounds (interval
//! arithmetic; Boulos, Wald and Shirley 2006, "Geometric and Arithmetic Culling Methods for Entire Ray Packets").
//! Rounding is monotone, so a box that any of the rays meets is met by the beam. At a leaf the triangles
//! whose own boxes the beam meets are tested for all eight rays at once.

use super::child::Child;
use super::leaf::Pack;
use super::node::{Met, Node};
use super::open::Open;
use super::slots::bits;
use crate::accel::best::{Best, NONE};
use crate::accel::probe::Off;
use crate::accel::{Hit, PrimHit, Query};
use crate::geometry::eight::{Points, Rays};
use crate::geometry::slabs::Boxes;
use crate::geometry::tri::{Hits, Own, TriTest, boxes_of};
use crate::geometry::{EightSlabs, Slabs};
use crate::scene::{PrimRef, Whose};
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// Eight rays and where they are.
#[derive(Clone, Debug)]
#[repr(align(64))]
pub struct Beam {
    /// By axis: what nearer planes are subtracted from, and farther ones.
    near: [f32; 3],
    far: [f32; 3],
    /// The least and the greatest one over the direction, by axis.
    inv: [[f32; 3]; 2],
    /// Which plane of an axis is met first: 0 for the least, 1 for the greatest.
    sides: [usize; 3],
    /// The order in which slots are visited: see [`super::slots`].
    order: u32,
    /// The last child that was met and not visited yet.
    pub last: u32,
    /// The least and the greatest t that is of interest to any of the rays.
    tmin: f32,
    end: f32,
    /// The order of axes of the triangle test.
    axes: [usize; 3],
    /// Which rays these are: the first.
    first: usize,
    slabs: [[Lanes; 3]; 3],
    own: Own<Lanes>,
    tmins: Lanes,
    /// Where each ray's interval of interest ends; before all t once it is done.
    ends: Lanes,
    t: Lanes,
    u: Lanes,
    v: Lanes,
    prims: [PrimRef; LANES],
    scales: Lanes,
    pub open: Open,
}

/// How far eight rays are apart.
#[derive(Clone, Copy, Debug)]
pub struct Spread {
    /// The least and the greatest `o_lo.x o_lo.y o_lo.z o_hi.x o_hi.y o_hi.z inv.x inv.y`.
    pub least: Lanes,
    pub greatest: Lanes,
    /// The least `inv.z -inv.z tmin -tmax`.
    pub others: Lanes,
}

/// How far apart the rays of a beam may be. A beam meets what is as near to any of its rays as it is wide, so it
/// pays while it is not much wider than the boxes of leaves are, and those shrink with the root of the
/// number of triangles. Ten times as wide, sorted diffuse rays took ten times as long as without beams.
#[derive(Clone, Copy, Debug)]
pub struct Limits {
    /// Between origins, in extents of the scene.
    origins: f32,
    /// Between directions.
    directions: f32,
}

impl Limits {
    /// For a scene of so many triangles. The factors are those at which camera and shadow rays were fastest on
    /// scenes of a million and of four million triangles; small scenes gain nothing beyond the ceilings.
    pub fn new(triangles: usize) -> Self {
        let leaf = 1.0 / (triangles.max(1) as f32).sqrt();
        Self { origins: (8.0 * leaf).min(1.0 / 32.0), directions: (16.0 * leaf).min(1.0 / 8.0) }
    }
}

impl Spread {
    /// The least and the greatest one over the direction.
    #[inline(always)]
    fn inv(&self) -> [[f32; 3]; 2] {
        let (least, greatest) = (&self.least, &self.greatest);
        [[least[6], least[7], self.others[0]], [greatest[6], greatest[7], -self.others[1]]]
    }

    /// Whether eight rays of the same octant are worth a beam.
    #[inline(always)]
    pub fn is_narrow(&self, limits: &Limits) -> bool {
        let [least, greatest] = self.inv();
        // A direction is what it is divided by.
        let apart = |axis: usize| (1.0 / greatest[axis] - 1.0 / least[axis]).abs();
        let origins = |axis: usize| self.greatest[axis] - self.least[axis];
        (0..3).all(|axis| origins(axis) <= limits.origins && apart(axis) <= limits.directions)
    }
}

/// Eight rays made ready.
#[derive(Clone, Copy)]
pub struct Eight<F> {
    pub rays: Rays<F>,
    pub slabs: EightSlabs<F>,
    pub own: Own<F>,
    pub scales: F,
}

impl Beam {
    /// No rays.
    pub const fn idle() -> Self {
        Self {
            near: [0.0; 3],
            far: [0.0; 3],
            inv: [[0.0; 3]; 2],
            sides: [0; 3],
            order: 0,
            last: 0,
            tmin: 0.0,
            end: 0.0,
            axes: [0, 1, 2],
            first: 0,
            slabs: [[[0.0; LANES]; 3]; 3],
            own: [[0.0; LANES]; 7],
            tmins: [0.0; LANES],
            ends: [0.0; LANES],
            t: [0.0; LANES],
            u: [0.0; LANES],
            v: [0.0; LANES],
            prims: [NONE; LANES],
            scales: [0.0; LANES],
            open: Open::new(),
        }
    }

    /// Begins with eight rays of one octant.
    #[inline(always)]
    pub fn begin<T: TriTest, S: Simd>(&mut self, s: S, eight: &Eight<S::F>, spread: &Spread, first: usize, root: Child) {
        let Eight { rays, slabs, own, scales } = *eight;
        let EightSlabs { o_lo, o_hi, inv } = slabs;
        for (to, from) in self.slabs.iter_mut().zip([o_lo, o_hi, inv]) {
            from.store(s, to);
        }
        for (to, from) in self.own.iter_mut().zip(own) {
            s.store(from, to);
        }
        s.store(rays.tmin, &mut self.tmins);
        s.store(rays.tmax, &mut self.ends);
        s.store(scales, &mut self.scales);
        self.inv = spread.inv();
        for axis in 0..3 {
            let backward = self.inv[1][axis] < 0.0;
            self.sides[axis] = usize::from(backward);
            let (lo, hi) = (spread.greatest[axis], spread.least[3 + axis]);
            (self.near[axis], self.far[axis]) = if backward { (hi, lo) } else { (lo, hi) };
        }
        (self.tmin, self.end) = (spread.others[2], -spread.others[3]);
        let [x, y, z] = self.sides;
        self.order = 7 ^ (x | y << 1 | z << 2) as u32;
        self.axes = self.ray::<T>(0).axes();
        self.prims = [NONE; LANES];
        self.first = first;
        self.last = self.open.begin(root, self.tmin);
    }

    /// Visits a node.
    #[inline(always)]
    pub fn enter<S: Simd, N: Node>(&mut self, s: S, node: &N) {
        let [x, y, z] = self.sides;
        let mut met = self.meet(s, node.planes(s, [x, y, z]), node.planes(s, [x ^ 1, y ^ 1, z ^ 1]));
        met.slots = node.used(met.slots);
        self.last = self.open.replace(s, self.last, node.children(), &met, self.order);
    }

    /// Tests the triangles of a block. False if no ray is left.
    #[inline(always)]
    pub fn test<S: Simd, T: TriTest, B: Pack, Q: Query>(&mut self, s: S, (block, points): (&B, &[Vec3]), query: &Q) -> bool {
        let all = block.corners(s, points, [0, 1, 2]);
        let Boxes { min, max } = boxes_of(s, &all);
        let backward = Points::splat(s, Vec3::from(self.inv[1]));
        let near = max.where_negative(s, backward, min);
        let far = min.where_negative(s, backward, max);
        let mut left = self.meet(s, near, far).slots & block.lanes();
        if left == 0 {
            return true;
        }
        let (own, slabs) = (self.own(s), self.slabs_in_order(s));
        let axes = self.axes.map(|axis| axis % 3);
        let mut in_memory = [[[0.0; LANES]; 3]; 3];
        let [a, b, c] = all;
        a.store(s, &mut in_memory[0]);
        b.store(s, &mut in_memory[1]);
        c.store(s, &mut in_memory[2]);
        let mut any = false;
        while left != 0 {
            let lane = left.trailing_zeros() as usize % LANES;
            left &= left - 1;
            let [a, b, c] = &in_memory;
            let corner = [splat(s, a, axes, lane), splat(s, b, axes, lane), splat(s, c, axes, lane)];
            // Most are met by none of the rays.
            let meets = T::meet_eight(s, &own, &slabs, &corner);
            if !meets.any(s) {
                continue;
            }
            let interval = [s.load(&self.tmins), s.load(&self.ends)];
            let hits = T::inside(s, &meets, &slabs, interval, &corner);
            if self.keep::<S, T, B, Q>(s, &hits, (block, points), lane, query) {
                any = true;
                // Rays that are done end before they begin.
                if query.any() && s.bits(s.le(interval[0], s.load(&self.ends))) == 0 {
                    return false;
                }
            }
        }
        if any {
            self.end = greatest_of(&self.ends);
            self.last = self.open.forget_behind(s, self.last, self.end, &mut Off::plain());
        }
        true
    }

    /// Keeps what is closer than what was found before. Whether there is anything.
    #[inline(always)]
    fn keep<S: Simd, T: TriTest, B: Pack, Q: Query>(
        &mut self,
        s: S,
        hits: &Hits<S>,
        (block, points): (&B, &[Vec3]),
        lane: usize,
        query: &Q,
    ) -> bool {
        let hit = s.bits(hits.hit);
        if hit | hits.doubt == 0 {
            return false;
        }
        let (ends, prim) = (s.load(&self.ends), block.prim(lane));
        let equal = if query.any() { 0 } else { s.bits(s.eq(hits.t, ends)) & hit };
        if !Q::ACCEPTS_ALL || equal | hits.doubt != 0 {
            let (mut t, mut u, mut v) = ([0.0; LANES], [0.0; LANES], [0.0; LANES]);
            s.store(hits.t, &mut t);
            s.store(hits.u, &mut u);
            s.store(hits.v, &mut v);
            return self.keep_one_by_one::<T, Q>([&t, &u, &v], hit, hits.doubt, &block.triangle(points, lane), prim, query);
        }
        let (t, u, v) = (s.load(&self.t), s.load(&self.u), s.load(&self.v));
        s.store(s.select(hits.hit, hits.t, t), &mut self.t);
        s.store(s.select(hits.hit, hits.u, u), &mut self.u);
        s.store(s.select(hits.hit, hits.v, v), &mut self.v);
        let prims = s.select(hits.hit, s.splat_bits(prim), s.load_bits(&self.prims));
        s.store_bits(prims, &mut self.prims);
        let done = if query.any() { s.splat(f32::NEG_INFINITY) } else { hits.t };
        s.store(s.select(hits.hit, done, ends), &mut self.ends);
        true
    }

    /// The same for hits that have to be asked about, lanes with a tie, and lanes in doubt.
    #[cold]
    fn keep_one_by_one<T: TriTest, Q: Query>(
        &mut self,
        [t, u, v]: [&Lanes; 3],
        hit: u32,
        doubt: u32,
        tri: &[Vec3; 3],
        prim: PrimRef,
        query: &Q,
    ) -> bool {
        let mut any = false;
        for lane in bits(hit | doubt) {
            let found = PrimHit { t: self.ends[lane], u: self.u[lane], v: self.v[lane], prim: self.prims[lane] };
            let mut best = Best::with(self.tmins[lane], found);
            let over = if doubt >> lane & 1 == 1 {
                best.test_in_doubt(&self.ray::<T>(lane), tri, prim, query, &mut Off::plain())
            } else {
                best.offer(PrimHit { t: t[lane], u: u[lane], v: v[lane], prim }, query)
            };
            if let Some(now) = best.found().filter(|now| *now != found) {
                (self.t[lane], self.u[lane], self.v[lane], self.prims[lane]) = (now.t, now.u, now.v, now.prim);
                self.ends[lane] = if over { f32::NEG_INFINITY } else { now.t };
                any = true;
            }
        }
        any
    }

    /// Writes what was found.
    #[inline(always)]
    pub fn end<S: Simd>(&self, s: S, whose: &Whose<'_>, hits: &mut [Option<Hit>]) {
        // As `Back::world_t` of rays that were not moved: the product is rounded once.
        let mut t = [0.0; LANES];
        s.store(s.mul(s.add(s.load(&self.t), s.splat(0.0)), s.load(&self.scales)), &mut t);
        let Some(hits) = hits[self.first..].first_chunk_mut::<LANES>() else { return };
        for (lane, hit) in hits.iter_mut().enumerate() {
            let prim = self.prims[lane];
            *hit = if prim == NONE {
                None
            } else {
                let (instance, primitive) = whose.locate(prim);
                Some(Hit { t: t[lane], u: self.u[lane], v: self.v[lane], instance, primitive })
            };
        }
    }

    /// Boxes that a ray may meet in its interval of interest, and the least t at which one may enter.
    #[inline(always)]
    fn meet<S: Simd>(&self, s: S, near: Points<S::F>, far: Points<S::F>) -> Met<S::F> {
        let least = Points::splat(s, Vec3::from(self.inv[0]));
        let greatest = Points::splat(s, Vec3::from(self.inv[1]));
        let near = near.minus(s, Points::splat(s, Vec3::from(self.near)));
        let far = far.minus(s, Points::splat(s, Vec3::from(self.far)));
        let entry = near.scaled(s, least).min(s, near.scaled(s, greatest)).greatest(s);
        let exit = far.scaled(s, least).max(s, far.scaled(s, greatest)).least(s);
        let (entry, exit) = (s.max(s.splat(self.tmin), entry), s.min(exit, s.splat(self.end)));
        Met { slots: s.bits(s.le(entry, exit)), entry }
    }

    #[inline(always)]
    fn own<S: Simd>(&self, s: S) -> Own<S::F> {
        let [a, b, c, d, e, f, g] = &self.own;
        [s.load(a), s.load(b), s.load(c), s.load(d), s.load(e), s.load(f), s.load(g)]
    }

    #[inline(always)]
    fn slabs_in_order<S: Simd>(&self, s: S) -> EightSlabs<S::F> {
        let ([x, y, z], [lo, hi, inv]) = (self.axes.map(|axis| axis % 3), &self.slabs);
        EightSlabs {
            o_lo: Points { x: s.load(&lo[x]), y: s.load(&lo[y]), z: s.load(&lo[z]) },
            o_hi: Points { x: s.load(&hi[x]), y: s.load(&hi[y]), z: s.load(&hi[z]) },
            inv: Points { x: s.load(&inv[x]), y: s.load(&inv[y]), z: s.load(&inv[z]) },
        }
    }

    /// One of the rays.
    fn ray<T: TriTest>(&self, lane: usize) -> T {
        let ([a, b, c, d, e, f, g], [lo, hi, inv]) = (&self.own, &self.slabs);
        let own = [a[lane], b[lane], c[lane], d[lane], e[lane], f[lane], g[lane]];
        T::from_own(&own, Slabs::from_parts(of_lane(lo, lane), of_lane(hi, lane), of_lane(inv, lane)))
    }
}

/// One of eight, of each axis.
#[inline(always)]
fn of_lane([x, y, z]: &[Lanes; 3], lane: usize) -> [f32; 3] {
    [x[lane], y[lane], z[lane]]
}

/// The corner of one triangle of eight in all lanes, the axes in some order.
#[inline(always)]
fn splat<S: Simd>(s: S, corners: &[Lanes; 3], [x, y, z]: [usize; 3], lane: usize) -> Points<S::F> {
    Points { x: s.splat(corners[x][lane]), y: s.splat(corners[y][lane]), z: s.splat(corners[z][lane]) }
}

#[inline(always)]
fn greatest_of(lanes: &Lanes) -> f32 {
    let &[a, b, c, d, e, f, g, h] = lanes;
    max(max(max(a, b), max(c, d)), max(max(e, f), max(g, h)))
}

#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
