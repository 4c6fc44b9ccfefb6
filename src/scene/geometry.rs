//! The triangles that structures are built over, in the scaled space, kept once and shared: every instance
//! of the scene flattened, or those of meshes that stand in one place, beside the meshes that stand in several.

use glam::{Affine3A, Vec3};

use super::placed::{Placed, Sorted, Standing};
use super::whose::{Owners, Whose};
use super::{LoadCx, Mesh, Reason, Scene};
use crate::geometry::{Aabb, Space, has_zero_area, num};
use crate::sys::list_in_large_pages;
use crate::task::Charge;

/// A flattened triangle: its index in file order, dropped ones counted.
pub type PrimRef = u32;

/// The scene as structures see it.
///
/// What concerns single triangles is about those that were flattened: all of them, unless [`Self::placed`] says that
/// there are others, which stand in several places and are kept once.
#[derive(Debug)]
pub struct Geometry {
    space: Space,
    world_bounds: Aabb,
    /// Of the flattened triangles, in the scaled space.
    bounds: Aabb,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Triangles that structures hold, in order; all of them where none is left out.
    live: Live,
    owners: Owners,
    dropped: u32,
    degenerate: u32,
    placed: Option<Placed>,
    /// Triangles of instances that their transform makes a line or a point.
    vanished: u64,
    _memory: Charge,
}

/// A mesh in one place, to be flattened.
pub(super) struct Piece<'a> {
    pub mesh: &'a Mesh,
    pub world_from_object: &'a Affine3A,
    /// Its number in the scene.
    pub instance: u32,
}

/// How many triangles a scene has, each counted as often as it stands somewhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// All of them.
    pub triangles: u64,
    /// Those with a vertex that is NaN or infinite.
    pub dropped: u64,
    /// Those whose area is exactly zero.
    pub degenerate: u64,
    /// Those that structures hold.
    pub live: u64,
}

#[derive(Debug)]
enum Live {
    All,
    Some(Vec<PrimRef>),
}

impl Counts {
    /// Adds those of something else.
    pub(super) const fn add(&mut self, other: &Self) {
        self.triangles += other.triangles;
        self.dropped += other.dropped;
        self.degenerate += other.degenerate;
        self.live += other.live;
    }
}

impl Geometry {
    /// Flattens the scene: every instance becomes triangles of its own.
    ///
    /// Triangles with a vertex that is not finite are dropped; those of zero area are kept out of
    /// the structures; both keep their index and are counted.
    ///
    /// # Errors
    /// Cancelled, over the memory budget, or more triangles or vertices than 32 bits can index.
    pub fn new(scene: &Scene, cx: &LoadCx) -> Result<Self, Reason> {
        let count = instance_count(scene)?;
        let pieces: Vec<Piece> = (0..count).map(|i| Piece::of(scene, i)).collect();
        Self::of_pieces(&pieces, Aabb::EMPTY, cx)
    }

    /// The same, but meshes that stand in several places are kept once (see [`Placed`]); where there are none it is the
    /// same altogether.
    ///
    /// # Errors
    /// As [`Self::new`]; the limit of 32 bits holds for what is flattened, and for each mesh.
    pub fn with_instances(scene: &Scene, cx: &LoadCx) -> Result<Self, Reason> {
        instance_count(scene)?;
        let mut sorted = Sorted::new(scene, cx.keep);
        if sorted.all_flat() {
            return Self::new(scene, cx);
        }
        let (standing, around) = sorted.place(scene, cx)?;
        let pieces: Vec<Piece> = sorted.flat.iter().map(|i| Piece::of(scene, *i)).collect();
        let flat = Self::of_pieces(&pieces, around, cx)?;
        let placed = Standing::settle(standing, &flat.space, cx)?;
        let placed = (!placed.places().is_empty()).then_some(placed);
        Ok(Self { placed, vanished: sorted.vanished, ..flat })
    }

    /// Flattens some meshes of a scene, of which the others lie in `beside` in the world.
    pub(super) fn of_pieces(pieces: &[Piece], beside: Aabb, cx: &LoadCx) -> Result<Self, Reason> {
        let sizes = |f: fn(&Mesh) -> usize| pieces.iter().map(|piece| f(piece.mesh) as u64).sum::<u64>();
        let (vertices, triangles) = (sizes(|m| m.positions.len()), sizes(|m| m.triangles.len()));
        for (count, what) in [(vertices, "vertices"), (triangles, "triangles")] {
            if count > num::MAX_INDEX as u64 {
                return Err(Reason::TooLarge(count, what));
            }
        }
        let memory = cx.budget.charge((vertices + triangles) * 12)?;
        cx.progress.start("flatten", triangles);
        let mut flat = Self {
            space: Space::new(&Aabb::EMPTY),
            world_bounds: beside,
            bounds: Aabb::EMPTY,
            // Leaves may refer to them from anywhere.
            positions: list_in_large_pages(num::floor_index(vertices as f64, num::MAX_INDEX)),
            triangles: Vec::with_capacity(num::floor_index(triangles as f64, num::MAX_INDEX)),
            live: Live::All,
            owners: Owners::new(pieces.iter().map(|piece| (piece.instance, piece.mesh.triangles.len()))),
            dropped: 0,
            degenerate: 0,
            placed: None,
            vanished: 0,
            _memory: memory,
        };
        flat.gather(pieces, cx)?;
        flat.classify_and_scale(cx)?;
        Ok(flat)
    }

    /// Appends the world positions and the triangles of every piece.
    fn gather(&mut self, pieces: &[Piece], cx: &LoadCx) -> Result<(), Reason> {
        for Piece { mesh, world_from_object, .. } in pieces {
            let base = num::index(self.positions.len());
            for chunk in mesh.positions.chunks(CHUNK) {
                cx.cancel.check()?;
                self.positions.extend(chunk.iter().map(|p| world_from_object.transform_point3(*p)));
            }
            for chunk in mesh.triangles.chunks(CHUNK) {
                cx.cancel.check()?;
                self.triangles.extend(chunk.iter().map(|t| t.map(|i| i + base)));
                cx.progress.advance(chunk.len() as u64);
            }
        }
        Ok(())
    }

    /// Finds the bounds of what is finite, scales the positions into the space they give, and sorts
    /// out what structures do not hold. Zero area is asked of the world positions: scaling could
    /// round denormals.
    fn classify_and_scale(&mut self, cx: &LoadCx) -> Result<(), Reason> {
        use rayon::prelude::*;
        let (positions, triangles) = (&self.positions, &self.triangles);
        let corners = |t: &[u32; 3]| t.map(|i| positions[i as usize]);
        let classify = |chunk: &[[u32; 3]]| {
            let mut found = Chunk::default();
            for (i, triangle) in chunk.iter().enumerate() {
                let tri = corners(triangle);
                if tri.iter().any(|p| !p.is_finite()) {
                    found.out.push((num::index(i), true));
                } else if has_zero_area(&tri) {
                    found.out.push((num::index(i), false));
                } else {
                    found.bounds = found.bounds.union(Aabb::of_triangle(&tri));
                }
            }
            cx.progress.advance(chunk.len() as u64);
            cx.cancel.check().map(|()| found)
        };
        cx.progress.start("classify", triangles.len() as u64);
        let parts: Result<Vec<Chunk>, _> = cx.pool.run(|| triangles.par_chunks(CHUNK).map(classify).collect());
        let parts = parts?;

        let own = parts.iter().fold(Aabb::EMPTY, |b, part| b.union(part.bounds));
        self.world_bounds = self.world_bounds.union(own);
        self.space = Space::new(&self.world_bounds);
        // Where there is nothing a structure has a box all the same.
        self.bounds = match own.is_empty() {
            true => *self.space.bounds(),
            false => Aabb { min: self.space.point(own.min), max: self.space.point(own.max) },
        };
        let out: Vec<(u32, bool)> = parts
            .iter()
            .enumerate()
            .flat_map(|(c, part)| part.out.iter().map(move |(i, bad)| (num::index(c * CHUNK) + i, *bad)))
            .collect();
        self.dropped = num::index(out.iter().filter(|(_, not_finite)| *not_finite).count());
        self.degenerate = num::index(out.len()) - self.dropped;
        if !out.is_empty() {
            let mut skip = out.iter().map(|(i, _)| *i).peekable();
            let all = 0..num::index(self.triangles.len());
            self.live = Live::Some(all.filter(|i| skip.next_if_eq(i).is_none()).collect());
        }
        let space = self.space;
        cx.pool
            .run(|| self.positions.par_chunks_mut(CHUNK).for_each(|chunk| chunk.iter_mut().for_each(|p| *p = space.point(*p))));
        Ok(cx.cancel.check()?)
    }

    /// The scaled space that the corners are in.
    pub fn space(&self) -> &Space {
        &self.space
    }

    /// The bounds of the flattened triangles that structures hold, in the scaled space.
    pub fn bounds(&self) -> &Aabb {
        &self.bounds
    }

    /// What stands in several places, if anything does.
    pub fn placed(&self) -> Option<&Placed> {
        self.placed.as_ref()
    }

    /// The bounds of the whole scene in the world; empty if there is nothing.
    pub fn world_bounds(&self) -> &Aabb {
        &self.world_bounds
    }

    /// The corners of a triangle in the scaled space.
    #[inline(always)]
    pub fn corners(&self, prim: PrimRef) -> [Vec3; 3] {
        let [a, b, c] = self.triangles[prim as usize];
        [self.positions[a as usize], self.positions[b as usize], self.positions[c as usize]]
    }

    /// The vertex positions in the scaled space and the three indices of each triangle.
    pub fn indexed(&self) -> (&[Vec3], &[[u32; 3]]) {
        (&self.positions, &self.triangles)
    }

    /// The corners of the triangle that was hit, in the scaled space; those of a placed mesh are rounded once.
    pub fn corners_of(&self, instance: u32, primitive: u32) -> [Vec3; 3] {
        if let Some(prim) = self.owners.flat(instance, primitive) {
            return self.corners(prim);
        }
        let found = self.placed.as_ref().and_then(|placed| Some((placed, placed.of_instance(instance)?)));
        let Some((placed, place)) = found else { return [Vec3::ZERO; 3] };
        let map = place.scene_from_part();
        placed.parts()[place.part as usize].corners(primitive).map(|p| map.transform_point3(p.as_dvec3()).as_vec3())
    }

    /// How many triangles an instance has; 0 if its transform makes them lines or points.
    pub fn count_of(&self, instance: u32) -> usize {
        let placed =
            || self.placed.as_ref().and_then(|placed| Some(&placed.parts()[placed.of_instance(instance)?.part as usize]));
        self.owners.count(instance).or_else(|| placed().map(|part| part.triangle_count())).unwrap_or(0)
    }

    /// One more than the last instance that has triangles, flattened or where they stand.
    pub fn instance_end(&self) -> u32 {
        self.owners.end().max(self.placed.as_ref().map_or(0, Placed::instance_end))
    }

    /// How many triangles the whole scene has.
    pub fn counts(&self) -> Counts {
        let (triangles, live) = (self.triangles.len() as u64, self.live_count() as u64);
        let mut counts = Counts {
            triangles: triangles + self.vanished,
            dropped: self.dropped.into(),
            degenerate: u64::from(self.degenerate) + self.vanished,
            live,
        };
        self.placed.iter().for_each(|placed| counts.add(placed.counts()));
        counts
    }

    /// How many triangles were flattened, dropped and degenerate ones counted.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// How many of them structures hold.
    pub fn live_count(&self) -> usize {
        match &self.live {
            Live::All => self.triangles.len(),
            Live::Some(list) => list.len(),
        }
    }

    /// How many triangles structures hold of what is stored: each mesh once.
    pub fn stored_live(&self) -> usize {
        let parts = self.placed.as_ref().map_or(&[][..], Placed::parts);
        self.live_count() + parts.iter().map(|part| part.live_count()).sum::<usize>()
    }

    /// The `i`-th triangle that structures hold, ascending.
    #[inline(always)]
    pub fn live(&self, i: usize) -> PrimRef {
        match &self.live {
            Live::All => num::index(i),
            Live::Some(list) => list[i],
        }
    }

    /// Triangles dropped because a vertex is NaN or infinite.
    pub fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Triangles kept out of the structures because their area is exactly zero.
    pub fn degenerate(&self) -> u32 {
        self.degenerate
    }

    /// The instance that a triangle belongs to, and its index within the instance's mesh.
    #[inline]
    pub fn locate(&self, prim: PrimRef) -> (u32, u32) {
        self.whose().locate(prim)
    }

    /// What tells whose triangles are whose.
    #[inline(always)]
    pub fn whose(&self) -> Whose<'_> {
        self.owners.whose()
    }

    /// The flattened index of a triangle of an instance; `None` if that stands in several places, or there is none.
    pub fn flat(&self, instance: u32, primitive: u32) -> Option<PrimRef> {
        self.owners.flat(instance, primitive)
    }

    /// Bytes of the shared geometry.
    pub fn bytes(&self) -> u64 {
        let live = match &self.live {
            Live::All => 0,
            Live::Some(list) => list.len() * 4,
        };
        let own = (self.positions.len() * 12 + self.triangles.len() * 12 + live) as u64 + self.owners.bytes();
        own + self.placed.as_ref().map_or(0, Placed::bytes)
    }
}

/// How many instances there are, if they can be numbered.
fn instance_count(scene: &Scene) -> Result<u32, Reason> {
    let count = scene.instances.len();
    if count > num::MAX_INDEX { Err(Reason::TooLarge(count as u64, "instances")) } else { Ok(num::index(count)) }
}

impl<'a> Piece<'a> {
    fn of(scene: &'a Scene, instance: u32) -> Self {
        let placed = &scene.instances[instance as usize];
        Self { mesh: &scene.meshes[placed.mesh], world_from_object: &placed.world_from_object, instance }
    }
}

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// What one chunk of triangles holds: those left out (index in the chunk, and whether it is not
/// finite rather than of zero area), and the bounds of the rest.
struct Chunk {
    bounds: Aabb,
    out: Vec<(u32, bool)>,
}

impl Default for Chunk {
    fn default() -> Self {
        Self { bounds: Aabb::EMPTY, out: Vec::new() }
    }
}
