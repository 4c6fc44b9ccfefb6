//! Triangles of a leaf, eight at a time.

use super::compressed::Compressed;
use super::node::{Full, Node};
use super::unit::{self, Unit};
use crate::geometry::eight::Points;
use crate::geometry::tri::{self, Block, Eight};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{LANES, Lanes, Simd};
use bytemuck::Pod;
use glam::Vec3;

/// Stands in lanes without a triangle.
const NONE: PrimRef = PrimRef::MAX;

/// How triangles of a leaf are packed, up to eight together. `points` are the geometry's.
pub trait Pack: Pod + Send + Sync + std::fmt::Debug {
    /// The nodes that go with it.
    type Node: Node;

    /// Units that one takes.
    const UNITS: u32 = (size_of::<Self>() / unit::BYTES) as u32;

    /// The triangles that one usually holds of a leaf that is large enough.
    const USUAL: u8;

    /// Whether it refers to points that lie elsewhere.
    const REFERS: bool = false;

    /// Asks for the points that it refers to.
    #[inline(always)]
    fn prefetch<S: Simd>(&self, _: S, _: &[Vec3]) {}

    /// The one at a place.
    fn at(units: &[Unit], place: u32) -> &Self;

    /// Packs as many triangles from the front of the list as fit, at least one, reordering it if that
    /// helps; how many.
    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, usize);

    /// Their corners, the axes in some order; lanes without a triangle hold anything.
    fn corners<S: Simd>(&self, s: S, points: &[Vec3], axes: [usize; 3]) -> [Points<S::F>; 3];

    /// The triangle in a lane.
    fn triangle(&self, points: &[Vec3], lane: usize) -> [Vec3; 3];

    /// The number of the triangle in a lane that holds one.
    fn prim(&self, lane: usize) -> PrimRef;

    /// One bit for each lane that holds a triangle.
    fn lanes(&self) -> u32;
}

/// Corners as they are: 40 bytes a triangle in a full block.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Plain {
    block: Block,
    prims: [PrimRef; LANES],
}

impl Pack for Plain {
    type Node = Full;

    #[inline(always)]
    fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { Self::UNITS as usize }>(units, place as usize)
    }

    const USUAL: u8 = LANES as u8;

    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, usize) {
        let count = prims.len().min(LANES);
        let block = Block::new(prims.iter().map(|prim| geometry.corners(*prim)));
        let mut all = [NONE; LANES];
        all[..count].copy_from_slice(&prims[..count]);
        (Self { block, prims: all }, count)
    }

    #[inline(always)]
    fn corners<S: Simd>(&self, s: S, _: &[Vec3], axes: [usize; 3]) -> [Points<S::F>; 3] {
        tri::corners(s, &self.block, axes)
    }

    #[inline(always)]
    fn triangle(&self, _: &[Vec3], lane: usize) -> [Vec3; 3] {
        self.block.triangle(lane)
    }

    #[inline(always)]
    fn prim(&self, lane: usize) -> PrimRef {
        self.prims[lane]
    }

    fn lanes(&self) -> u32 {
        (0..LANES).fold(0, |bits, i| bits | u32::from(self.prims[i] != NONE) << i)
    }
}

/// Which of eight points are the corners of which of eight triangles.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C)]
struct Corners {
    /// By corner.
    of: [[u8; LANES]; 3],
    /// A bit for each lane that holds a triangle, and nothing.
    lanes: [u8; 8],
    prims: [PrimRef; LANES],
}

/// Triangles of a leaf among which the next one of a patch is chosen.
const MOST_LEFT: usize = 16;

/// Stands for a point that is not yet among the eight.
const UNKNOWN: u8 = u8::MAX;

impl Corners {
    /// As many triangles from the front of the list as share eight points, and the numbers of these: at each step
    /// the triangle that brings the fewest new ones.
    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, [u32; LANES], usize) {
        let mut packed = Self { of: [[0; LANES]; 3], lanes: [0; 8], prims: [NONE; LANES] };
        let (mut points, mut used, mut count) = ([0; LANES], 0, 0);
        // Of each triangle: where its corners are, and which of the points each is.
        let mut left: [([Vec3; 3], [u8; 3]); MOST_LEFT] = [([Vec3::NAN; 3], [UNKNOWN; 3]); MOST_LEFT];
        let choice = prims.len().min(MOST_LEFT);
        for (to, prim) in left.iter_mut().zip(prims.iter()) {
            to.0 = geometry.corners(*prim);
        }
        while count < choice && count < LANES {
            let new = |at: usize| left[at].1.iter().filter(|known| **known == UNKNOWN).count();
            let best = (count..choice).map(|at| (new(at), at)).min();
            let Some((_, at)) = best.filter(|(new, _)| used + new <= LANES) else { break };
            prims.swap(count, at);
            left.swap(count, at);
            for corner in 0..3 {
                if left[count].1[corner] == UNKNOWN {
                    let p = left[count].0[corner];
                    points[used] = geometry.indexed().1[prims[count] as usize][corner];
                    // Points at one place are one, whatever their numbers are.
                    for (corners, known) in &mut left[count..choice] {
                        for (q, known) in corners.iter().zip(known) {
                            if *q == p {
                                *known = used as u8;
                            }
                        }
                    }
                    used += 1;
                }
                packed.of[corner][count] = left[count].1[corner];
            }
            packed.prims[count] = prims[count];
            count += 1;
        }
        let last = points[used.saturating_sub(1)];
        points[used..].fill(last);
        packed.lanes[0] = ((1u32 << count) - 1) as u8;
        (packed, points, count)
    }

    /// The corners of all, of the points by axis.
    #[inline(always)]
    fn all<S: Simd>(&self, s: S, points: Points<S::F>) -> [Points<S::F>; 3] {
        let [a, b, c] = &self.of;
        [points.permute(s, s.indices(a)), points.permute(s, s.indices(b)), points.permute(s, s.indices(c))]
    }

    /// The points that are the corners of one.
    #[inline(always)]
    fn of_lane(&self, lane: usize) -> [usize; 3] {
        let [a, b, c] = &self.of;
        [usize::from(a[lane]) % LANES, usize::from(b[lane]) % LANES, usize::from(c[lane]) % LANES]
    }
}

/// Neighbours share corners: eight points at most, and which of them each triangle has. 160 bytes, less than half
/// as much a triangle on a mesh; a permutation brings a corner of eight triangles into the lanes.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Patch {
    /// By axis.
    points: [Lanes; 3],
    corners: Corners,
}

impl Pack for Patch {
    type Node = Full;

    #[inline(always)]
    fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { Self::UNITS as usize }>(units, place as usize)
    }

    /// As on a mesh of about half as many vertices as triangles.
    const USUAL: u8 = 6;

    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, usize) {
        let (corners, points, count) = Corners::pack(geometry, prims);
        let points = points.map(|number| geometry.indexed().0[number as usize]);
        (Self { points: [0, 1, 2].map(|axis| points.map(|p| p[axis])), corners }, count)
    }

    #[inline(always)]
    fn corners<S: Simd>(&self, s: S, _: &[Vec3], [x, y, z]: [usize; 3]) -> [Points<S::F>; 3] {
        let Self { points, corners } = self;
        corners.all(s, Points { x: s.load(&points[x]), y: s.load(&points[y]), z: s.load(&points[z]) })
    }

    #[inline(always)]
    fn triangle(&self, _: &[Vec3], lane: usize) -> [Vec3; 3] {
        let ([x, y, z], [a, b, c]) = (&self.points, self.corners.of_lane(lane));
        [Vec3::new(x[a], y[a], z[a]), Vec3::new(x[b], y[b], z[b]), Vec3::new(x[c], y[c], z[c])]
    }

    #[inline(always)]
    fn prim(&self, lane: usize) -> PrimRef {
        self.corners.prims[lane]
    }

    #[inline(always)]
    fn lanes(&self) -> u32 {
        u32::from(self.corners.lanes[0])
    }
}

/// The same with the numbers of the geometry's points in place of the points. 96 bytes.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Indexed {
    points: [u32; LANES],
    corners: Corners,
}

impl Pack for Indexed {
    type Node = Compressed;

    #[inline(always)]
    fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { Self::UNITS as usize }>(units, place as usize)
    }

    const USUAL: u8 = Patch::USUAL;

    const REFERS: bool = true;

    #[inline(always)]
    fn prefetch<S: Simd>(&self, s: S, points: &[Vec3]) {
        let first = points.as_ptr().addr();
        for i in self.points {
            s.prefetch(first + i as usize * size_of::<Vec3>());
        }
    }

    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, usize) {
        let (corners, points, count) = Corners::pack(geometry, prims);
        (Self { points, corners }, count)
    }

    #[inline(always)]
    fn corners<S: Simd>(&self, s: S, points: &[Vec3], [x, y, z]: [usize; 3]) -> [Points<S::F>; 3] {
        let all = s.gather(points, &self.points);
        let mut by_axis = [[0.0; LANES]; 3];
        s.store(all[0], &mut by_axis[0]);
        s.store(all[1], &mut by_axis[1]);
        s.store(all[2], &mut by_axis[2]);
        self.corners.all(s, Points { x: s.load(&by_axis[x]), y: s.load(&by_axis[y]), z: s.load(&by_axis[z]) })
    }

    #[inline(always)]
    fn triangle(&self, points: &[Vec3], lane: usize) -> [Vec3; 3] {
        let [a, b, c] = self.corners.of_lane(lane);
        [points[self.points[a] as usize], points[self.points[b] as usize], points[self.points[c] as usize]]
    }

    #[inline(always)]
    fn prim(&self, lane: usize) -> PrimRef {
        self.corners.prims[lane]
    }

    #[inline(always)]
    fn lanes(&self) -> u32 {
        u32::from(self.corners.lanes[0])
    }
}

const _: () = assert!(size_of::<Plain>() == 320 && size_of::<Patch>() == 160 && size_of::<Indexed>() == 96);
