//! Triangles of a leaf, eight at a time.

use super::unit::{self, Unit};
use crate::geometry::tri::{Block, Eight};
use crate::scene::{Geometry, PrimRef};
use crate::simd::{LANES, Lanes, Simd};
use bytemuck::Pod;
use glam::Vec3;

/// Stands in lanes without a triangle.
const NONE: PrimRef = PrimRef::MAX;

/// How triangles of a leaf are packed, up to eight together.
pub trait Pack: Eight + Pod + Send + Sync + std::fmt::Debug {
    /// Units that one takes.
    const UNITS: u32 = (size_of::<Self>() / unit::BYTES) as u32;

    /// The one at a place.
    fn at(units: &[Unit], place: u32) -> &Self;

    /// The triangles that one usually holds of a leaf that is large enough.
    const USUAL: u8;

    /// Packs as many triangles from the front of the list as fit, at least one, reordering it if that
    /// helps; how many.
    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, usize);

    /// The triangle of a lane that holds one.
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

impl Eight for Plain {
    #[inline(always)]
    fn corner<S: Simd>(&self, s: S, corner: usize, axis: usize) -> S::F {
        self.block.corner(s, corner, axis)
    }

    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.block.triangle(lane)
    }
}

impl Pack for Plain {
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
    fn prim(&self, lane: usize) -> PrimRef {
        self.prims[lane]
    }

    fn lanes(&self) -> u32 {
        (0..LANES).fold(0, |bits, i| bits | u32::from(self.prims[i] != NONE) << i)
    }
}

/// Neighbours share corners: eight corners at most, and the numbers of those of each triangle. 160
/// bytes, less than half as much a triangle on a mesh; a permutation brings a corner of eight triangles
/// into the lanes.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Patch {
    /// By axis.
    vertices: [Lanes; 3],
    /// By corner.
    corners: [[u8; LANES]; 3],
    lanes: [u8; 8],
    prims: [PrimRef; LANES],
}

impl Eight for Patch {
    #[inline(always)]
    fn corner<S: Simd>(&self, s: S, corner: usize, axis: usize) -> S::F {
        s.permute(s.load(&self.vertices[axis]), s.indices(&self.corners[corner]))
    }

    #[inline(always)]
    fn triangle(&self, lane: usize) -> [Vec3; 3] {
        self.corners.each_ref().map(|corner| {
            let i = usize::from(corner[lane]) % LANES;
            Vec3::new(self.vertices[0][i], self.vertices[1][i], self.vertices[2][i])
        })
    }
}

impl Pack for Patch {
    #[inline(always)]
    fn at(units: &[Unit], place: u32) -> &Self {
        unit::at::<Self, { Self::UNITS as usize }>(units, place as usize)
    }

    /// As on a mesh of about half as many vertices as triangles.
    const USUAL: u8 = 6;

    /// The next triangle is the one that brings the fewest new corners.
    fn pack(geometry: &Geometry, prims: &mut [PrimRef]) -> (Self, usize) {
        let mut patch = Self { vertices: [[f32::NAN; LANES]; 3], corners: [[0; LANES]; 3], lanes: [0; 8], prims: [NONE; LANES] };
        let (mut vertices, mut used, mut count) = ([Vec3::NAN; LANES], 0, 0);
        while count < prims.len().min(LANES) {
            let new = |prim: PrimRef| geometry.corners(prim).iter().filter(|p| !vertices[..used].contains(p)).count();
            let best = (count..prims.len()).map(|i| (new(prims[i]), i)).min();
            let Some((_, i)) = best.filter(|(new, _)| used + new <= LANES) else { break };
            prims.swap(count, i);
            for (corner, p) in geometry.corners(prims[count]).into_iter().enumerate() {
                let at = vertices[..used].iter().position(|v| *v == p).unwrap_or(used);
                if at == used {
                    vertices[used] = p;
                    used += 1;
                }
                patch.corners[corner][count] = at as u8;
            }
            patch.prims[count] = prims[count];
            count += 1;
        }
        for (i, v) in vertices.iter().enumerate() {
            (0..3).for_each(|axis| patch.vertices[axis][i] = v[axis]);
        }
        patch.lanes[0] = ((1u32 << count) - 1) as u8;
        (patch, count)
    }

    #[inline(always)]
    fn prim(&self, lane: usize) -> PrimRef {
        self.prims[lane]
    }

    #[inline(always)]
    fn lanes(&self) -> u32 {
        u32::from(self.lanes[0])
    }
}

const _: () = assert!(size_of::<Plain>() == 320 && size_of::<Patch>() == 160);
