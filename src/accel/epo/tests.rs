//! End-point overlap of hierarchies small enough to be worked out by hand.

use std::ops::ControlFlow;

use super::*;
use crate::accel::cell::Layout;
use crate::accel::cell::{Cell, CellId, CellKind, MemoryPart};
use crate::accel::stats::Stats;
use crate::scene::{Instance, LoadCx, Mesh, Scene};
use glam::Vec3;

/// A root over leaves with given boxes and triangles.
struct Leaves(Vec<(Aabb, Vec<PrimRef>)>);

impl Leaves {
    fn cell(&self, node: u32, depth: u32, bounds: Aabb, kind: CellKind) -> Cell {
        Cell { id: CellId { instance: 0, node }, depth, shape: Shape::Box(bounds), split: None, kind }
    }
}

impl Cells for Leaves {
    fn root(&self) -> Cell {
        self.cell(0, 0, self.0.iter().fold(Aabb::EMPTY, |b, leaf| b.union(leaf.0)), CellKind::Inner)
    }

    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>) {
        let leaves = if cell.depth == 0 { &self.0[..] } else { &[] };
        for (node, (bounds, prims)) in (1..).zip(leaves) {
            if each(self.cell(node, 1, *bounds, CellKind::Leaf { prims: num::index(prims.len()) })).is_break() {
                return;
            }
        }
    }

    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef)) {
        if cell.depth == 1 {
            self.0[cell.id.node as usize - 1].1.iter().for_each(|prim| each(*prim));
        }
    }

    fn layout(&self) -> Layout {
        Layout::Hierarchy
    }

    fn memory(&self) -> Vec<MemoryPart> {
        Vec::new()
    }
}

fn geometry(triangles: &[[Vec3; 3]]) -> Geometry {
    let mut mesh = Mesh::default();
    for tri in triangles {
        let first = num::index(mesh.positions.len());
        mesh.positions.extend(tri);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
    Geometry::new(&scene, &LoadCx::unattended()).expect("small")
}

fn cx(most: usize) -> EpoCx {
    EpoCx { most, pool: Pool::new("test", 2), budget: Budget::unlimited(), cancel: Cancel::new() }
}

const WEIGHTS: SahWeights = SahWeights { c_trav: 3.0, c_isect: 2.0 };

/// Right triangles of area 1/2 at x, in the plane z = 0; the extent 1 keeps the scaled space the world.
fn at(x: f32) -> [Vec3; 3] {
    [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 0.25, 0.0, 0.0), Vec3::new(x, 0.5, 0.0)]
}

fn boxed(x0: f32, x1: f32) -> Aabb {
    Aabb { min: Vec3::new(x0, 0.0, 0.0), max: Vec3::new(x1, 0.5, 0.5) }
}

#[test]
fn leaves_that_are_apart_cost_a_ray_end_nothing() {
    let geometry = geometry(&[at(0.0), at(0.75)]);
    let apart = Leaves(vec![(boxed(0.0, 0.25), vec![0]), (boxed(0.75, 1.0), vec![1])]);
    let epo = Epo::of(&apart, &geometry, WEIGHTS, &cx(MOST)).expect("small");
    assert_eq!(epo, Epo { value: 0.0, error: 0.0, sampled: 2, of: 2 });
    let stats = Stats::of(&apart, WEIGHTS, &Cancel::new()).expect("not cancelled");
    assert_eq!((stats.overlap, stats.leaf_volume, stats.duplication(2)), (Some(0.0), Some(0.5), Some(1.0)));
    // The root is 1 x 1/2 x 1/2 of area 5/2, each leaf a quarter of it long, of area 1.
    assert_eq!(stats.expected_nodes, 1.0 + 2.0 / 2.5);
    assert_eq!(stats.expected_tests, 2.0 / 2.5);
    assert_eq!(stats.sah, 3.0 + 2.0 * 2.0 / 2.5);
    assert_eq!(stats.empty_volume(), Some(0.5));
}

#[test]
fn overlapping_leaves_have_the_overlap_that_is_drawn() {
    let geometry = geometry(&[at(0.0), at(0.75)]);
    let over = Leaves(vec![(boxed(0.0, 0.25), vec![0]), (boxed(0.0, 1.0), vec![1])]);
    let whole = Epo::of(&over, &geometry, WEIGHTS, &cx(MOST)).expect("small");
    // Half the surface lies wholly in a foreign leaf of cost 2.
    assert_eq!(whole.value, 0.5 * 2.0);
    let part = Leaves(vec![(boxed(0.0, 0.25), vec![0]), (boxed(0.125, 1.0), vec![1])]);
    let part = Epo::of(&part, &geometry, WEIGHTS, &cx(MOST)).expect("small");
    assert!((part.value - 0.5 * 0.25 * 2.0).abs() < 1e-12, "the tip beyond x = 1/8 is a quarter of it: {part:?}");
    assert_eq!(part.blend(4.0, 0.25), 0.75 * 4.0 + 0.25 * part.value);
    let stats = Stats::of(&over, WEIGHTS, &Cancel::new()).expect("not cancelled");
    assert_eq!((stats.overlap, stats.leaf_volume, stats.empty_volume()), (Some(1.0 / 2.5), Some(1.25), Some(0.0)));
}

#[test]
fn a_triangle_in_two_leaves_is_foreign_to_neither() {
    let geometry = geometry(&[at(0.0), at(0.75)]);
    let both = Leaves(vec![(boxed(0.0, 0.25), vec![0]), (boxed(0.0, 1.0), vec![1, 0])]);
    let epo = Epo::of(&both, &geometry, WEIGHTS, &cx(MOST)).expect("small");
    assert_eq!(epo.value, 0.0);
}

#[test]
fn a_sample_comes_near_and_says_how_near() {
    let triangles: Vec<_> = (0..512u16).map(|i| at(f32::from(i % 64) / 64.0)).collect();
    let geometry = geometry(&triangles);
    let leaves = |i: u16| {
        let bounds = Aabb::of_triangle(&geometry.corners(u32::from(i)));
        (bounds, vec![u32::from(i)])
    };
    let tree = Leaves((0..512).map(leaves).collect());
    let exact = Epo::of(&tree, &geometry, WEIGHTS, &cx(512)).expect("small");
    let sampled = Epo::of(&tree, &geometry, WEIGHTS, &cx(100)).expect("small");
    assert_eq!((exact.error, exact.sampled), (0.0, 512));
    assert!(sampled.error > 0.0 && sampled.sampled <= 100 && exact.value > 10.0, "{sampled:?} of {exact:?}");
    assert!((sampled.value - exact.value).abs() < 3.0 * sampled.error, "{sampled:?} of {exact:?}");
    assert_eq!(sampled, Epo::of(&tree, &geometry, WEIGHTS, &cx(100)).expect("small"), "the same every time");
}

#[test]
fn what_cannot_be_worked_out_is_refused() {
    let geometry = geometry(&[at(0.0), at(0.75)]);
    let tree = Leaves(vec![(boxed(0.0, 0.25), vec![0]), (boxed(0.75, 1.0), vec![1])]);
    let poor = EpoCx { budget: Budget::new(100), ..cx(MOST) };
    assert!(matches!(Epo::of(&tree, &geometry, WEIGHTS, &poor), Err(NoEpo::Memory(_))));
    let stopped = cx(MOST);
    stopped.cancel.cancel();
    assert_eq!(Epo::of(&tree, &geometry, WEIGHTS, &stopped), Err(NoEpo::Cancelled(Cancelled)));
    assert_eq!(poor.budget.used(), 0);
}
