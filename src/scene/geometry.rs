//! The triangles that structures are built over: every instance of the scene, flattened into the
//! scaled space, kept once and shared.

use glam::Vec3;

use super::{LoadCx, Reason, Scene};
use crate::geometry::{Aabb, Space, has_zero_area, num};
use crate::sys::list_in_large_pages;
use crate::task::Charge;

/// A triangle of the flattened scene: its index in file order, dropped ones counted.
pub type PrimRef = u32;

/// The flattened scene.
#[derive(Debug)]
pub struct Geometry {
    space: Space,
    world_bounds: Aabb,
    positions: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    /// Triangles that structures hold, in order; all of them where none is left out.
    live: Live,
    /// The first triangle of each instance, and one past the last: ascending.
    first_prim: Vec<u32>,
    places: Places,
    dropped: u32,
    degenerate: u32,
    _memory: Charge,
}

#[derive(Debug)]
enum Live {
    All,
    Some(Vec<PrimRef>),
}

impl Geometry {
    /// Flattens the scene.
    ///
    /// Triangles with a vertex that is not finite are dropped; those of zero area are kept out of
    /// the structures; both keep their index and are counted.
    ///
    /// # Errors
    /// Cancelled, over the memory budget, or more triangles or vertices than 32 bits can index.
    pub fn new(scene: &Scene, cx: &LoadCx) -> Result<Self, Reason> {
        let sizes = |f: fn(&super::Mesh) -> usize| scene.instances.iter().map(|i| f(&scene.meshes[i.mesh]) as u64).sum::<u64>();
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
            world_bounds: Aabb::EMPTY,
            // Leaves may refer to them from anywhere.
            positions: list_in_large_pages(num::floor_index(vertices as f64, num::MAX_INDEX)),
            triangles: Vec::with_capacity(num::floor_index(triangles as f64, num::MAX_INDEX)),
            live: Live::All,
            first_prim: vec![0],
            places: Places::default(),
            dropped: 0,
            degenerate: 0,
            _memory: memory,
        };
        flat.gather(scene, cx)?;
        flat.places = Places::new(&flat.first_prim);
        flat.classify_and_scale(cx)?;
        Ok(flat)
    }

    /// Appends the world positions and the triangles of every instance.
    fn gather(&mut self, scene: &Scene, cx: &LoadCx) -> Result<(), Reason> {
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            let base = num::index(self.positions.len());
            for chunk in mesh.positions.chunks(CHUNK) {
                cx.cancel.check()?;
                self.positions.extend(chunk.iter().map(|p| instance.world_from_object.transform_point3(*p)));
            }
            for chunk in mesh.triangles.chunks(CHUNK) {
                cx.cancel.check()?;
                self.triangles.extend(chunk.iter().map(|t| t.map(|i| i + base)));
                cx.progress.advance(chunk.len() as u64);
            }
            self.first_prim.push(num::index(self.triangles.len()));
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
            let mut sorted = Sorted::default();
            for (i, triangle) in chunk.iter().enumerate() {
                let tri = corners(triangle);
                if tri.iter().any(|p| !p.is_finite()) {
                    sorted.out.push((num::index(i), true));
                } else if has_zero_area(&tri) {
                    sorted.out.push((num::index(i), false));
                } else {
                    sorted.bounds = sorted.bounds.union(Aabb::of_triangle(&tri));
                }
            }
            cx.progress.advance(chunk.len() as u64);
            cx.cancel.check().map(|()| sorted)
        };
        cx.progress.start("classify", triangles.len() as u64);
        let parts: Result<Vec<Sorted>, _> = cx.pool.run(|| triangles.par_chunks(CHUNK).map(classify).collect());
        let parts = parts?;

        self.world_bounds = parts.iter().fold(Aabb::EMPTY, |b, part| b.union(part.bounds));
        self.space = Space::new(&self.world_bounds);
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

    /// The bounds of what structures hold, in the scaled space.
    pub fn bounds(&self) -> &Aabb {
        self.space.bounds()
    }

    /// The same in the world; empty if there is nothing.
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

    /// How many triangles the scene has, dropped and degenerate ones counted.
    pub fn triangle_count(&self) -> usize {
        self.triangles.len()
    }

    /// How many triangles structures hold.
    pub fn live_count(&self) -> usize {
        match &self.live {
            Live::All => self.triangles.len(),
            Live::Some(list) => list.len(),
        }
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
        Whose { first_prim: &self.first_prim, shift: self.places.shift, instance: &self.places.instance }
    }

    /// The flattened index of a triangle of an instance.
    pub fn flat(&self, instance: u32, primitive: u32) -> PrimRef {
        self.first_prim[instance as usize] + primitive
    }

    /// Bytes of the shared geometry.
    pub fn bytes(&self) -> u64 {
        let live = match &self.live {
            Live::All => 0,
            Live::Some(list) => list.len() * 4,
        };
        (self.positions.len() * 12 + self.triangles.len() * 12 + live + (self.first_prim.len() + self.places.instance.len()) * 4)
            as u64
    }
}

/// Tells the instance of many triangles.
#[derive(Clone, Copy, Debug)]
pub struct Whose<'a> {
    first_prim: &'a [u32],
    shift: u32,
    instance: &'a [u32],
}

impl Whose<'_> {
    /// As [`Geometry::locate`].
    #[inline(always)]
    pub fn locate(&self, prim: PrimRef) -> (u32, u32) {
        let mut instance = self.instance[(prim >> (self.shift & 31)) as usize];
        while self.first_prim[instance as usize + 1] <= prim {
            instance += 1;
        }
        (instance, prim - self.first_prim[instance as usize])
    }
}

/// Where to begin the search for the instance of a triangle: for each run of `2^shift` triangles the
/// instance of the first.
#[derive(Debug, Default)]
struct Places {
    shift: u32,
    instance: Vec<u32>,
}

impl Places {
    /// About as many runs as instances.
    fn new(first_prim: &[u32]) -> Self {
        let (prims, instances) = (first_prim.last().copied().unwrap_or(0), first_prim.len() as u32);
        let shift = (prims / instances).max(1).ilog2();
        let run = |i: u32| first_prim.partition_point(|first| *first <= i << shift) - 1;
        Self { shift, instance: (0..=prims >> shift).map(|i| num::index(run(i))).collect() }
    }
}

/// Triangles between two looks at the cancel flag.
const CHUNK: usize = 1 << 14;

/// What one chunk of triangles holds: those left out (index in the chunk, and whether it is not
/// finite rather than of zero area), and the bounds of the rest.
struct Sorted {
    bounds: Aabb,
    out: Vec<(u32, bool)>,
}

impl Default for Sorted {
    fn default() -> Self {
        Self { bounds: Aabb::EMPTY, out: Vec::new() }
    }
}
