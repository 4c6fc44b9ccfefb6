//! What about a model's triangles is known to make ray tracers err: corners that are no numbers, slivers, copies, edges
//! where a surface ends or branches, sizes and places that leave coordinates few digits.
//!
//! Corners are compared in the scaled space, where structures see them; corners of equal coordinates are one, whatever
//! their indices. Equal keys are found by sorting, a share of them at a time: so the memory stays small, and no step that
//! cannot be cancelled is long.

use std::ops::Range;

use glam::{DVec3, Vec3};
use rayon::prelude::*;
use serde::Serialize;

use super::format::{count, number};
use crate::accel::BuildCx;
use crate::geometry::num;
use crate::scene::{Geometry, PrimRef, Reason};
use crate::task::{Cancelled, sort};

/// How many times as long as high a triangle is from which on it is a sliver. The weights of its corners then lose about
/// ten of the 24 bits that coordinates have.
pub const SLIVER: f64 = 1e3;
/// How many times its shortest edge a model's size is from which on that is said.
const FINE: f64 = 1e6;
/// How many of its sizes from the origin a model reaches from which on that is said.
const FAR: f64 = 1e3;
/// Slivers that are listed.
const KEPT: usize = 16;
/// Triangles or keys between two looks at the cancel flag. Few in tests, so that these have several chunks.
const CHUNK: usize = if cfg!(test) { 1 << 8 } else { 1 << 14 };
/// About so many keys are sorted at a time. Few in tests, so that these have several shares.
const SHARE: usize = if cfg!(test) { 1 << 10 } else { 1 << 22 };

/// What was found. "Live" are the triangles that structures hold: all but the dropped and the degenerate.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct MeshCheck {
    /// All triangles, dropped and degenerate ones counted.
    pub triangles: u64,
    /// Triangles that were dropped because a corner is NaN or infinite.
    pub non_finite: u64,
    /// Triangles whose area is exactly zero.
    pub degenerate: u64,
    /// Live triangles that are at least [`SLIVER`] times as long as high.
    pub slivers: u64,
    /// The greatest length of a live triangle over its height, see [`Sliver::aspect`]; 0 if there is none.
    pub worst_aspect: f64,
    /// The worst slivers, the worst first, 16 at most.
    pub worst: Vec<Sliver>,
    /// Live triangles that have the same three corners, in any order, as one before.
    pub duplicates: u64,
    /// Edges of live triangles, each counted once.
    pub edges: u64,
    /// Of those, the ones in one triangle alone.
    pub boundary_edges: u64,
    /// Of those, the ones in more than two triangles.
    pub non_manifold_edges: u64,
    /// The longest side of the bounds over the shortest edge that is not zero; 0 if there is no live triangle.
    pub extent_ratio: f64,
    /// The greatest absolute world coordinate over the longest side of the world bounds: how far from the origin the model
    /// reaches, in its sizes. 0 if there is no live triangle.
    pub distance_ratio: f64,
}

/// A triangle far longer than high.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Sliver {
    /// The instance that it belongs to.
    pub instance: u32,
    /// Its index within the instance's mesh.
    pub primitive: u32,
    /// Its longest edge over the height on it, worked out in 64 bits; where these see no height, 2^52.
    pub aspect: f64,
}

/// Something about the model that is worth saying.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What it is: a sentence with the figures.
    pub what: String,
    /// What the user can do: a sentence.
    pub remedy: &'static str,
    /// Whether ray tracers are known to err on it, rather than that it may well be meant.
    pub grave: bool,
}

/// Looks at every triangle.
///
/// It takes four bytes for each vertex, and about 200 MiB for what it sorts at a time, or more where millions of
/// triangles have one corner in common.
///
/// # Errors
/// Cancelled, or over the memory budget.
pub fn check(geometry: &Geometry, cx: &BuildCx) -> Result<MeshCheck, Reason> {
    let ((positions, triangles), live) = (geometry.indexed(), geometry.live_count());
    // Each triangle by its shape, each position, each triangle by its corners, and its three edges.
    cx.progress.start("check mesh", (positions.len() + 5 * live) as u64);
    let shapes = Shapes::of(geometry, cx)?;
    let _memory = cx.budget.charge(positions.len() as u64 * 4)?;
    let numbers = numbers(positions, cx)?;
    let corners = |i: usize| triangles[geometry.live(i) as usize].map(|vertex| numbers[vertex as usize]);

    let mut duplicates = 0usize;
    let in_order = |i: usize| {
        let mut corners = corners(i);
        corners.sort_unstable();
        corners
    };
    in_shares(
        live,
        cx,
        in_order,
        |[a, b, c]| mixed(u128::from(*a) << 96 | u128::from(*b) << 64 | u128::from(*c) << 32),
        |sorted| duplicates += sorted.len() - runs(sorted).count(),
    )?;

    let (mut edges, mut boundary_edges, mut non_manifold_edges) = (0u64, 0, 0);
    let edge = |i: usize| {
        let corners = corners(i / 3);
        let (a, b) = (corners[i % 3], corners[(i + 1) % 3]);
        u64::from(a.min(b)) << 32 | u64::from(a.max(b))
    };
    let count_edges = |sorted: &[u64]| {
        for run in runs(sorted) {
            edges += 1;
            boundary_edges += u64::from(run.len() == 1);
            non_manifold_edges += u64::from(run.len() > 2);
        }
    };
    in_shares(3 * live, cx, edge, |edge| mixed(u128::from(*edge) << 64), count_edges)?;

    Ok(MeshCheck {
        triangles: geometry.triangle_count() as u64,
        non_finite: geometry.dropped().into(),
        degenerate: geometry.degenerate().into(),
        slivers: shapes.slivers,
        worst_aspect: shapes.worst_aspect,
        extent_ratio: shapes.extent_ratio(geometry),
        worst: shapes.worst,
        duplicates: duplicates as u64,
        edges,
        boundary_edges,
        non_manifold_edges,
        distance_ratio: distance_ratio(geometry),
    })
}

impl MeshCheck {
    /// Whether the live triangles are the whole surface of one or more solids: each edge is in two, and none is a copy.
    pub fn is_closed(&self) -> bool {
        let live = self.triangles.saturating_sub(self.non_finite + self.degenerate);
        live > 0 && self.boundary_edges == 0 && self.non_manifold_edges == 0 && self.duplicates == 0
    }

    /// What kind of surface it is, in a word or three.
    pub fn surface(&self) -> &'static str {
        match self {
            _ if self.is_closed() => "closed",
            Self { boundary_edges: 1.., .. } => "open",
            Self { edges: 0, .. } => "none",
            _ => "branching or copied",
        }
    }

    /// What is worth saying, each with what helps; nothing of an ordinary closed model.
    pub fn findings(&self) -> Vec<Finding> {
        let mut findings = Vec::new();
        let mut say = |what: String, grave, remedy| findings.push(Finding { what, remedy, grave });
        if self.non_finite > 0 {
            let what = counted(self.non_finite, "triangle has", "triangles have") + " a corner that is NaN or infinite.";
            say(what, true, "They are left out; export the model again, without them.");
        }
        if self.degenerate > 0 {
            let what = counted(self.degenerate, "triangle has", "triangles have") + " no area.";
            say(what, true, "They are left out, since no ray hits them; remove them from the mesh.");
        }
        if self.slivers > 0 {
            let slivers = counted(self.slivers, "triangle is a sliver", "triangles are slivers");
            let what = format!("{slivers}, the worst {} times as long as high.", number(self.worst_aspect));
            say(what, true, "Use the exact triangle test; best, mesh the surface again without slivers.");
        }
        if self.duplicates > 0 {
            let what = counted(self.duplicates, "triangle has", "triangles have") + " the same corners as one before.";
            say(what, true, "Remove the copies: no structure can part them, and which of them a ray hits is a convention.");
        }
        if self.boundary_edges > 0 {
            let what = format!("Open surface: {}.", counted(self.boundary_edges, "boundary edge", "boundary edges"));
            say(what, false, "If it is meant to be solid, close the holes, and merge corners that nearly meet.");
        }
        if self.non_manifold_edges > 0 {
            let what = counted(self.non_manifold_edges, "edge is", "edges are") + " in more than two triangles.";
            say(what, true, "Remove inner walls and copies where inside and outside are to be told apart.");
        }
        if self.extent_ratio >= FINE {
            let what = format!("The model is {} times as large as its shortest edge is long.", number(self.extent_ratio));
            say(what, true, "Use a structure that adapts (a BVH, a k-d tree, the two-level grid), and no fixed margins.");
        }
        if self.distance_ratio >= FAR {
            let (far, step) = (number(self.distance_ratio), number(self.distance_ratio * f64::from(f32::EPSILON)));
            let what =
                format!("The model reaches {far} of its sizes from the origin; coordinates step there by up to {step} of one.");
            say(what, true, "Move the model to the origin before its coordinates are rounded to 32 bits.");
        }
        findings
    }
}

fn counted(n: u64, one: &str, many: &str) -> String {
    format!("{} {}", count(n), if n == 1 { one } else { many })
}

/// How long and how high triangles are.
struct Shapes {
    slivers: u64,
    worst_aspect: f64,
    /// The worst, the worst first; while a chunk is looked at, all.
    worst: Vec<Sliver>,
    /// The square of the shortest edge that is not zero; infinite if there is none.
    shortest: f64,
}

impl Shapes {
    const NONE: Self = Self { slivers: 0, worst_aspect: 0.0, worst: Vec::new(), shortest: f64::INFINITY };

    fn of(geometry: &Geometry, cx: &BuildCx) -> Result<Self, Cancelled> {
        let parts = in_chunks(geometry.live_count(), cx, |chunk| {
            cx.progress.advance(chunk.len() as u64);
            let mut shapes = Self::NONE;
            chunk.for_each(|i| shapes.add(geometry, geometry.live(i)));
            Self::NONE.with(shapes)
        })?;
        Ok(parts.into_iter().fold(Self::NONE, Self::with))
    }

    fn add(&mut self, geometry: &Geometry, prim: PrimRef) {
        let [a, b, c] = geometry.corners(prim).map(|p| p.as_dvec3());
        let (squares, twice_area) = ([b - a, c - b, a - c].map(DVec3::length_squared), (b - a).cross(c - a).length());
        let longest = squares.into_iter().fold(0.0, f64::max);
        let aspect = if twice_area > 0.0 { longest / twice_area } else { 1.0 / f64::EPSILON };
        self.worst_aspect = self.worst_aspect.max(aspect);
        self.shortest = squares.into_iter().filter(|square| *square > 0.0).fold(self.shortest, f64::min);
        if aspect >= SLIVER {
            let (instance, primitive) = geometry.locate(prim);
            self.slivers += 1;
            self.worst.push(Sliver { instance, primitive, aspect });
        }
    }

    /// Both; slivers that are equally bad in file order.
    fn with(mut self, other: Self) -> Self {
        self.slivers += other.slivers;
        self.worst_aspect = self.worst_aspect.max(other.worst_aspect);
        self.shortest = self.shortest.min(other.shortest);
        self.worst.extend(other.worst);
        let place = |sliver: &Sliver| (sliver.instance, sliver.primitive);
        self.worst.sort_unstable_by(|a, b| b.aspect.total_cmp(&a.aspect).then(place(a).cmp(&place(b))));
        self.worst.truncate(KEPT);
        self
    }

    fn extent_ratio(&self, geometry: &Geometry) -> f64 {
        let bounds = geometry.bounds();
        (bounds.max.as_dvec3() - bounds.min.as_dvec3()).max_element() / self.shortest.sqrt()
    }
}

fn distance_ratio(geometry: &Geometry) -> f64 {
    let bounds = geometry.world_bounds();
    let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
    let (far, extent) = (min.abs().max(max.abs()).max_element(), (max - min).max_element());
    if extent > 0.0 { far / extent } else { 0.0 }
}

/// A number for each position: the same for the same coordinates, and for no others.
fn numbers(positions: &[Vec3], cx: &BuildCx) -> Result<Vec<u32>, Reason> {
    let mut numbers = vec![0; positions.len()];
    let mut next = 0;
    // The bits of the coordinates, and the index. Adding 0 makes 0 of -0 and changes nothing else.
    let key = |i: usize| {
        let [x, y, z] = (positions[i] + 0.0).to_array().map(|x| u128::from(x.to_bits()));
        x << 96 | y << 64 | z << 32 | u128::from(num::index(i))
    };
    let number_them = |sorted: &[u128]| {
        for same in sorted.chunk_by(|a, b| *a >> 32 == *b >> 32) {
            same.iter().for_each(|key| numbers[(*key & 0xFFFF_FFFF) as usize] = next);
            next += 1;
        }
    };
    in_shares(positions.len(), cx, key, |key| mixed(*key), number_them)?;
    Ok(numbers)
}

/// Well mixed bits of a position's coordinates (multiplication by 2^64 over the golden ratio, Knuth 1998, §6.4).
const fn mixed(key: u128) -> u64 {
    const GOLDEN: u64 = 0x9E37_79B9_7F4A_7C15;
    let (x_y, z) = ((key >> 64) as u64, (key >> 32 & 0xFFFF_FFFF) as u64);
    (x_y.wrapping_mul(GOLDEN).rotate_left(32) ^ z).wrapping_mul(GOLDEN) >> 32
}

/// Makes `count` keys and hands them on, sorted, in lists of about [`SHARE`]: those whose `share_of` is the same, and so
/// all that are equal, in the same list.
fn in_shares<T: Copy + Ord + Send + Sync>(
    count: usize,
    cx: &BuildCx,
    key: impl Fn(usize) -> T + Sync,
    share_of: impl Fn(&T) -> u64 + Sync,
    mut each: impl FnMut(&[T]),
) -> Result<(), Reason> {
    let shares = count.div_ceil(SHARE) as u64;
    // Gathered in lists that grow, joined, and sorted from one list into another: three times at once, at most.
    let bytes = |keys: usize| (3 * keys * size_of::<T>()) as u64;
    let mut memory = cx.budget.charge(bytes(count.min(SHARE)))?;
    for share in 0..shares {
        let is_in = |key: &T| share_of(key) % shares == share;
        let keys: usize = in_chunks(count, cx, |chunk| chunk.map(&key).filter(is_in).count())?.into_iter().sum();
        memory.grow(bytes(keys).saturating_sub(memory.bytes()))?;
        let parts: Vec<Vec<T>> = in_chunks(count, cx, |chunk| {
            let keys: Vec<T> = chunk.map(&key).filter(is_in).collect();
            cx.progress.advance(keys.len() as u64);
            keys
        })?;
        let mut list = parts.concat();
        drop(parts);
        cx.pool.run(|| sort::by_value(&mut list, &cx.cancel))?;
        each(&list);
    }
    Ok(())
}

/// Works through `0..count` in chunks, on the pool; the results are in order.
fn in_chunks<T: Send>(count: usize, cx: &BuildCx, of: impl Fn(Range<usize>) -> T + Sync) -> Result<Vec<T>, Cancelled> {
    let chunk = |c: usize| cx.cancel.check().map(|()| of(c * CHUNK..count.min((c + 1) * CHUNK)));
    cx.pool.run(|| (0..count.div_ceil(CHUNK)).into_par_iter().map(chunk).collect())
}

/// The stretches of equal keys.
fn runs<T: PartialEq>(sorted: &[T]) -> impl Iterator<Item = &[T]> {
    sorted.chunk_by(|a, b| a == b)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::stability::cases::Trial;
    use crate::scene::LoadCx;
    use crate::task::{Budget, Cancel, Pool, Progress};

    const O: Vec3 = Vec3::ZERO;
    const TETRAHEDRON: [[Vec3; 3]; 4] =
        [[O, Vec3::Y, Vec3::X], [O, Vec3::X, Vec3::Z], [O, Vec3::Z, Vec3::Y], [Vec3::X, Vec3::Y, Vec3::Z]];

    fn geometry(triangles: &[[Vec3; 3]]) -> Geometry {
        let trial = Trial { triangles: triangles.to_vec(), ..Trial::default() };
        Geometry::new(&trial.scene("test"), &LoadCx::unattended()).expect("small")
    }

    fn checked(triangles: &[[Vec3; 3]]) -> MeshCheck {
        check(&geometry(triangles), &BuildCx::unattended(2)).expect("small")
    }

    /// Of `2 n^2` triangles, which meet in `3 n^2` edges.
    fn torus(n: u16) -> Vec<[Vec3; 3]> {
        let turn = |k: u16| f32::from(k % n) / f32::from(n) * std::f32::consts::TAU;
        let at = |i: u16, j: u16| {
            let (a, b) = (turn(i), turn(j));
            let r = 2.0 + b.cos();
            Vec3::new(r * a.cos(), b.sin(), r * a.sin())
        };
        let quads = (0..n).flat_map(|i| (0..n).map(move |j| (i, j)));
        quads
            .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
            .collect()
    }

    fn edges(check: &MeshCheck) -> [u64; 3] {
        [check.edges, check.boundary_edges, check.non_manifold_edges]
    }

    #[test]
    fn a_closed_surface_is_told_from_one_with_a_hole() {
        for (mut triangles, all) in [(TETRAHEDRON.to_vec(), 6), (torus(40), 4800)] {
            let closed = checked(&triangles);
            assert_eq!((edges(&closed), closed.duplicates), ([all, 0, 0], 0));
            assert!(closed.is_closed() && closed.findings().is_empty(), "{closed:?}");
            triangles.pop();
            let open = checked(&triangles);
            assert_eq!(edges(&open), [all, 3, 0]);
            assert!(!open.is_closed());
            let said: Vec<(String, bool)> = open.findings().into_iter().map(|f| (f.what, f.grave)).collect();
            assert_eq!(said, [("Open surface: 3 boundary edges.".to_owned(), false)]);
        }
        let tetrahedron = checked(&TETRAHEDRON);
        assert_eq!((tetrahedron.worst_aspect, tetrahedron.extent_ratio, tetrahedron.distance_ratio), (2.0, 1.0, 1.0));
    }

    #[test]
    fn copies_are_counted_however_they_are_turned() {
        let mut triangles = torus(40);
        let [a, b, c] = triangles[7];
        triangles.extend([[a, b, c], [b, c, a], [c, b, a]]);
        let check = checked(&triangles);
        assert_eq!((check.duplicates, edges(&check)), (3, [4800, 0, 3]));
        assert!(!check.is_closed());
        // Being placed turns -0 into 0 most of the time, so that it is asked for here.
        let zeros = numbers(&[O, -O, Vec3::new(-0.0, 0.0, 1e-45), O], &BuildCx::unattended(1)).expect("small");
        assert!(zeros[0] == zeros[1] && zeros[0] == zeros[3] && zeros[0] != zeros[2]);
    }

    #[test]
    fn an_edge_of_three_triangles_is_counted_once() {
        let check = checked(&[[O, Vec3::X, Vec3::Y], [O, Vec3::X, Vec3::Z], [Vec3::X, O, -Vec3::Y]]);
        assert_eq!((check.duplicates, edges(&check)), (0, [7, 6, 1]));
    }

    #[test]
    fn slivers_are_listed_the_worst_first() {
        let high = |y: f32| [O, Vec3::X, Vec3::new(0.5, y, 0.0)];
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.extend((0..1000).map(|_| high(2f32.powi(-12))).chain([high(2f32.powi(-20)), high(2f32.powi(-9))]));
        let check = checked(&triangles);
        assert_eq!((check.slivers, check.worst_aspect, check.worst.len()), (1001, 2f64.powi(20), KEPT));
        let expected = [(1004, 20), (4, 12), (5, 12)];
        let expected = expected.map(|(primitive, bits)| Sliver { instance: 0, primitive, aspect: 2f64.powi(bits) });
        assert_eq!(check.worst[..3], expected);
    }

    #[test]
    fn sizes_and_places_are_measured() {
        let far = checked(&TETRAHEDRON.map(|tri| tri.map(|p| p + 1024.0)));
        assert_eq!((far.distance_ratio, far.findings().len()), (1025.0, 1));
        let mut triangles = TETRAHEDRON.to_vec();
        triangles.extend(TETRAHEDRON.map(|tri| tri.map(|p| p * 2f32.powi(-20) + 0.5)));
        let fine = checked(&triangles);
        assert_eq!((fine.extent_ratio, fine.findings().len()), (2f64.powi(20), 1));
    }

    #[test]
    fn what_is_left_out_is_counted_and_nothing_gives_zeros() {
        let left_out = [[O, Vec3::X, Vec3::X * 2.0], [O, Vec3::NAN, Vec3::X], [O, Vec3::X, Vec3::INFINITY]];
        let check = checked(&left_out);
        assert_eq!((check.triangles, check.non_finite, check.degenerate, check.findings().len()), (3, 2, 1, 2));
        let nothing = MeshCheck { triangles: 0, non_finite: 0, degenerate: 0, ..check };
        assert_eq!(checked(&[]), nothing);
        assert_eq!((edges(&nothing), nothing.slivers, nothing.duplicates, nothing.worst.len()), ([0; 3], 0, 0, 0));
        assert_eq!([nothing.worst_aspect, nothing.extent_ratio, nothing.distance_ratio], [0.0; 3]);
        assert!(!nothing.is_closed() && nothing.findings().is_empty());
    }

    #[test]
    fn it_stops_when_cancelled_and_keeps_to_the_budget() {
        let (geometry, cx) = (geometry(&TETRAHEDRON), BuildCx::unattended(1));
        cx.cancel.cancel();
        assert!(matches!(check(&geometry, &cx), Err(Reason::Cancelled(_))));
        let cx = BuildCx::new(Cancel::new(), Progress::new(), Pool::new("test", 1), Budget::new(100));
        assert!(matches!(check(&geometry, &cx), Err(Reason::Memory(_))));
        assert_eq!(cx.budget.used(), 0);
    }
}
