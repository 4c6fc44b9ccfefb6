//! Meshes that stand in several places, each kept once: the lower level of a two-level structure, and
//! where its parts stand in the upper one.
//!
//! A mesh that stands in one place is flattened with the rest of the scene, and so is one that its
//! transform makes flat, or nearly so: rays could not be taken into its space.

use std::sync::Arc;

use glam::{Affine3A, DAffine3, DMat3, DVec3};
use rayon::prelude::*;

use super::extremes::Extremes;
use super::geometry::Piece;
use super::{Counts, Geometry, Keep, LoadCx, Reason, Scene};
use crate::geometry::num::{UNIT_ROUNDOFF, index, round_down, round_up};
use crate::geometry::space::FAR;
use crate::geometry::{Aabb, Space};
use crate::task::{Cancelled, Charge};

/// Meshes in several places.
#[derive(Debug)]
pub struct Placed {
    parts: Vec<Arc<Geometry>>,
    /// By part, and there by instance.
    places: Vec<Place>,
    /// Their numbers, by instance.
    by_instance: Vec<u32>,
    counts: Counts,
    _memory: Charge,
}

/// One place of a mesh.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    /// Which of [`Placed::parts`] stands here.
    pub part: u32,
    /// Index of the instance in the scene.
    pub instance: u32,
    /// The box around it in the scene's scaled space, with room for every rounding of a ray that is taken into the part's
    /// space and tested there.
    pub bounds: Aabb,
    /// From the scene's scaled space to the part's.
    part_from_scene: DAffine3,
}

impl Place {
    /// From the scene's scaled space to the part's.
    pub const fn part_from_scene(&self) -> &DAffine3 {
        &self.part_from_scene
    }

    /// And back.
    pub fn scene_from_part(&self) -> DAffine3 {
        self.part_from_scene.inverse()
    }
}

/// The instances of a scene, sorted by what becomes of them.
pub(super) struct Sorted {
    /// Those to be flattened, ascending.
    pub flat: Vec<u32>,
    /// Those that stand, each by its mesh and with what it is, meshes in order.
    standing: Vec<(usize, Vec<(u32, DAffine3)>)>,
    /// Triangles of instances that their transform makes a line or a point.
    pub vanished: u64,
}

impl Sorted {
    /// Sorts the instances of a scene: those of meshes that stand in one place are to be flattened, unless everything is
    /// to be kept as it is.
    pub fn new(scene: &Scene, keep: Keep) -> Self {
        let mut of_mesh = vec![Vec::new(); scene.meshes.len()];
        let mut sorted = Self { flat: Vec::new(), standing: Vec::new(), vanished: 0 };
        for (i, instance) in scene.instances.iter().enumerate() {
            let map = wide(&instance.world_from_object);
            if rank_at_most_one(&map.matrix3) {
                sorted.vanished += scene.meshes[instance.mesh].triangles.len() as u64;
            } else if is_well_conditioned(&map) {
                of_mesh[instance.mesh].push((index(i), map));
            } else {
                sorted.flat.push(index(i));
            }
        }
        for (mesh, places) in of_mesh.into_iter().enumerate() {
            match places.len() {
                0 => {}
                1 if keep == Keep::Needed => sorted.flat.push(places[0].0),
                _ => sorted.standing.push((mesh, places)),
            }
        }
        sorted.flat.sort_unstable();
        sorted
    }

    /// Whether nothing stands: a scene without a second level.
    pub fn all_flat(&self) -> bool {
        self.standing.is_empty()
    }

    /// Makes the parts, and finds the box around each place in the world. Instances for which 32 bits do not suffice join
    /// those to be flattened.
    pub fn place(&mut self, scene: &Scene, cx: &LoadCx) -> Result<(Standing, Aabb), Reason> {
        let count: usize = self.standing.iter().map(|(_, places)| places.len()).sum();
        let memory = cx.budget.charge((count * (size_of::<Place>() + 4)) as u64)?;
        let mut standing = Standing { parts: Vec::new(), places: Vec::with_capacity(count), memory };
        let mut bounds = Aabb::EMPTY;
        for (mesh, places) in std::mem::take(&mut self.standing) {
            let piece = Piece { mesh: &scene.meshes[mesh], world_from_object: &Affine3A::IDENTITY, instance: 0 };
            let part = Geometry::of_pieces(&[piece], Aabb::EMPTY, cx)?;
            if part.live_count() == 0 {
                self.flat.extend(places.iter().map(|(instance, _)| *instance));
                continue;
            }
            cx.progress.start("place", places.len() as u64);
            let number = index(standing.parts.len());
            for boxed in boxes(&part, &places, number, cx)? {
                let around = rounded(boxed.min, boxed.max);
                if around.min.is_finite() && around.max.is_finite() {
                    bounds = bounds.union(around);
                    standing.places.push(boxed);
                } else {
                    self.flat.push(boxed.instance);
                }
            }
            standing.parts.push(Arc::new(part));
        }
        self.flat.sort_unstable();
        Ok((standing, bounds))
    }
}

/// Parts and places before the scene's space is known.
pub(super) struct Standing {
    parts: Vec<Arc<Geometry>>,
    places: Vec<Boxed>,
    memory: Charge,
}

impl Standing {
    /// Puts them into the scene's scaled space.
    pub fn settle(self, space: &Space, cx: &LoadCx) -> Result<Placed, Reason> {
        // A power of two: boxes are scaled without rounding.
        let scale = space.scale();
        let settle = |boxed: &Boxed| {
            cx.cancel.check()?;
            let scene_from_part = DAffine3::from_scale(DVec3::splat(scale)) * boxed.world_from_part;
            let pad = pad(&self.parts[boxed.part as usize], &scene_from_part.matrix3);
            Ok(Place {
                part: boxed.part,
                instance: boxed.instance,
                bounds: rounded(boxed.min * scale - pad, boxed.max * scale + pad),
                part_from_scene: scene_from_part.inverse(),
            })
        };
        let places: Result<Vec<Place>, Cancelled> = cx.pool.run(|| self.places.par_iter().map(settle).collect());
        let places = places?;
        let mut by_instance: Vec<u32> = (0..index(places.len())).collect();
        by_instance.sort_unstable_by_key(|place| places[*place as usize].instance);
        let mut counts = Counts::default();
        places.iter().for_each(|place| counts.add(&self.parts[place.part as usize].counts()));
        Ok(Placed { parts: self.parts, places, by_instance, counts, _memory: self.memory })
    }
}

impl Placed {
    /// The meshes, each in its own scaled space.
    pub fn parts(&self) -> &[Arc<Geometry>] {
        &self.parts
    }

    /// Where they stand.
    pub fn places(&self) -> &[Place] {
        &self.places
    }

    /// Where a part stands.
    pub fn places_of(&self, part: usize) -> &[Place] {
        let of = |place: &Place| place.part as usize;
        let first = self.places.partition_point(|place| of(place) < part);
        &self.places[first..first + self.places[first..].partition_point(|place| of(place) == part)]
    }

    /// The place of an instance.
    pub fn of_instance(&self, instance: u32) -> Option<&Place> {
        let at = self.by_instance.binary_search_by_key(&instance, |place| self.places[*place as usize].instance).ok()?;
        self.places.get(self.by_instance[at] as usize)
    }

    /// One more than the last instance that has a place.
    pub fn instance_end(&self) -> u32 {
        let last = self.by_instance.last().and_then(|place| self.places.get(*place as usize));
        last.map_or(0, |place| place.instance + 1)
    }

    /// How many triangles all places together have.
    pub const fn counts(&self) -> &Counts {
        &self.counts
    }

    /// Bytes of meshes and places.
    pub fn bytes(&self) -> u64 {
        self.parts.iter().map(|part| part.bytes()).sum::<u64>()
            + (size_of_val(&self.places[..]) + size_of_val(&self.by_instance[..])) as u64
    }
}

/// A place, with the box around it in the world.
#[derive(Clone, Copy)]
struct Boxed {
    part: u32,
    instance: u32,
    world_from_part: DAffine3,
    min: DVec3,
    max: DVec3,
}

fn boxes(part: &Geometry, places: &[(u32, DAffine3)], number: u32, cx: &LoadCx) -> Result<Vec<Boxed>, Reason> {
    let extremes = Extremes::new(part, cx)?;
    let object_from_part = DAffine3::from_scale(DVec3::splat(1.0 / part.space().scale()));
    let boxed = |(instance, world_from_object): &(u32, DAffine3)| {
        cx.cancel.check()?;
        cx.progress.advance(1);
        let world_from_part = *world_from_object * object_from_part;
        let (min, max) = extremes.bounds(&world_from_part);
        Ok(Boxed { part: number, instance: *instance, world_from_part, min, max })
    };
    let boxes: Result<Vec<Boxed>, Cancelled> = cx.pool.run(|| places.par_iter().map(boxed).collect());
    Ok(boxes?)
}

/// How far outside the box around a place a ray may meet it, for being rounded in the part's space.
///
/// There an origin lies within [`FAR`] extents of the part, or is moved to within a few; let D be the greatest distance
/// (in any component) from it to a corner of the part. The origin, the direction and t are rounded once each (1uD each,
/// by axis of the part), boxes and triangle tests allow for `12uD + 2u|o|` (see [`crate::geometry::slabs`]): 17uD at
/// most, taken as 24.
fn pad(part: &Geometry, scene_from_part: &DMat3) -> DVec3 {
    let bounds = part.bounds();
    let extent = f64::from(bounds.size().max_element());
    let reach = f64::from(bounds.min.abs().max(bounds.max.abs()).max_element()) + (FAR + 2.0) * extent;
    let m = scene_from_part;
    (m.x_axis.abs() + m.y_axis.abs() + m.z_axis.abs()) * (24.0 * f64::from(UNIT_ROUNDOFF) * reach)
}

fn rounded(min: DVec3, max: DVec3) -> Aabb {
    let (down, up) = (min.to_array().map(round_down), max.to_array().map(round_up));
    Aabb { min: down.into(), max: up.into() }
}

/// A transform in 64 bits.
fn wide(map: &Affine3A) -> DAffine3 {
    map.as_daffine3()
}

/// Whether all points are brought onto one line: then no triangle has an area.
fn rank_at_most_one(m: &DMat3) -> bool {
    [m.x_axis, m.y_axis, m.z_axis].iter().filter(|axis| **axis != DVec3::ZERO).count() <= 1
}

/// Whether rays can be taken into the space of the mesh and lose next to nothing of their 32 bits.
fn is_well_conditioned(map: &DAffine3) -> bool {
    const MOST: f64 = (1u32 << 20) as f64;
    let size = |m: &DMat3| m.x_axis.length().max(m.y_axis.length()).max(m.z_axis.length());
    let back = map.inverse();
    let condition = size(&map.matrix3) * size(&back.matrix3);
    map.is_finite() && back.is_finite() && condition <= MOST
}
