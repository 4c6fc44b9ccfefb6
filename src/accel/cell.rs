//! A node or cell as the outside sees it. One way to walk feeds overlays, the tree, statistics and
//! validation; children are made on demand, so a structure of ten million nodes costs what is
//! looked at.

use std::ops::ControlFlow;

use crate::geometry::polytope::Plane;
use crate::geometry::{Aabb, Axis, Polyhedron, num};
use crate::scene::PrimRef;
use glam::{DAffine3, DVec3, Vec3};

/// Names a cell within its structure; `instance` is 0 where there is no lower level.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct CellId {
    /// 0 in the upper level, or the only one; see [`Cells::level`].
    pub instance: u32,
    /// Its number within the structure.
    pub node: u32,
}

/// What bounds a cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A box with faces parallel to the axes.
    Box(Aabb),
    /// Something convex of another form.
    Convex {
        /// The tightest box around it.
        bounds: Aabb,
        /// The area of its surface.
        area: f64,
    },
}

impl Shape {
    /// The tightest box around it.
    pub const fn bounds(&self) -> &Aabb {
        match self {
            Self::Box(bounds) | Self::Convex { bounds, .. } => bounds,
        }
    }

    /// The area of its surface: what the chance of a random line to meet it goes by.
    pub fn area(&self) -> f64 {
        match self {
            Self::Box(bounds) => bounds.area(),
            Self::Convex { area, .. } => *area,
        }
    }
}

/// What a cell looks like: more than walks over cells need, so it is made when somebody draws it.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A box with faces parallel to the axes.
    Box(Aabb),
    /// A ball.
    Sphere {
        /// Its centre.
        centre: DVec3,
        /// Its radius.
        radius: f64,
    },
    /// Plane faces of any direction.
    Polyhedron(Polyhedron),
}

impl Form {
    /// The area of its surface.
    pub fn area(&self) -> f64 {
        match self {
            Self::Box(bounds) => bounds.area(),
            Self::Sphere { radius, .. } => 4.0 * std::f64::consts::PI * radius * radius,
            Self::Polyhedron(polyhedron) => polyhedron.area(),
        }
    }

    /// The part of the plane that divides it, as a polygon; no corners where there is none, or it is a ball.
    pub fn section(&self, split: &Split) -> Vec<DVec3> {
        match self {
            Self::Box(bounds) => section(&Polyhedron::of_box(bounds), split),
            Self::Polyhedron(polyhedron) => section(polyhedron, split),
            Self::Sphere { .. } => Vec::new(),
        }
    }
}

fn section(polyhedron: &Polyhedron, split: &Split) -> Vec<DVec3> {
    let plane = match *split {
        Split::Axis { axis, pos } => Plane::new(DVec3::AXES[axis.index()], pos.into()),
        Split::Plane { normal, offset } => Plane::new(normal.as_dvec3(), offset.into()),
    };
    polyhedron.section(&plane, 0.0)
}

/// The plane that divides a cell, in the scaled space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Split {
    /// Perpendicular to an axis.
    Axis {
        /// Which one.
        axis: Axis,
        /// Where it crosses the axis.
        pos: f32,
    },
    /// Anywhere: the points p with `normal . p = offset`.
    Plane {
        /// Of unit length, within rounding.
        normal: Vec3,
        /// Its distance from the origin, along the normal.
        offset: f32,
    },
}

/// What a cell holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CellKind {
    /// Other cells.
    Inner,
    /// Primitives.
    Leaf {
        /// How many references.
        prims: u32,
    },
    /// Nothing, and there is no node: a part of a divided cell that rays pass by without a step.
    Void,
}

/// A node or cell.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Which one.
    pub id: CellId,
    /// Steps from the root, which has 0.
    pub depth: u32,
    /// What bounds it, in the scaled space of its level.
    pub shape: Shape,
    /// The plane that divides it, where one does.
    pub split: Option<Split>,
    /// What it holds.
    pub kind: CellKind,
}

impl Cell {
    /// Whether it holds no cells: primitives, or nothing.
    pub const fn is_leaf(&self) -> bool {
        !matches!(self.kind, CellKind::Inner)
    }

    /// How many references it holds itself.
    pub const fn prims(&self) -> u32 {
        match self.kind {
            CellKind::Inner | CellKind::Void => 0,
            CellKind::Leaf { prims } => prims,
        }
    }
}

/// Where cells below the upper level are.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// The instance of the scene that they belong to; `None` for what was flattened.
    pub instance: Option<u32>,
    /// From the space that their shapes are in to the scene's scaled space.
    pub scene_from_level: DAffine3,
}

/// A part of a structure's memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
pub struct MemoryPart {
    /// Of what: `nodes`, `references`, `packed triangles`.
    pub name: &'static str,
    /// How much.
    pub bytes: u64,
}

/// How a structure's cells relate; statistics and overlays read it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Layout {
    /// Nodes bound their children, which may overlap; every triangle is in one leaf.
    Hierarchy,
    /// The same, but a triangle may be in several leaves, each of which bounds a part of it.
    SplitHierarchy,
    /// Cells divide space and do not overlap; a triangle is in every leaf it overlaps.
    Partition,
    /// The same, but all cells are children of the root, and the ray steps from cell to cell.
    Flat {
        /// Cells along each axis.
        resolution: [u32; 3],
        /// A cell also holds triangles that come this near to it, in the scaled space.
        slack: f32,
    },
    /// The same in two levels: a cell may be cut into cells of its own, which the ray steps through
    /// while it is inside.
    Nested {
        /// As in [`Layout::Flat`].
        slack: f32,
    },
}

impl Layout {
    /// Whether nodes bound what is in them and may overlap, rather than divide space.
    pub const fn nests(&self) -> bool {
        matches!(self, Self::Hierarchy | Self::SplitHierarchy)
    }

    /// How near to a cell a triangle has to come to be held by it, where the ray steps from cell to
    /// cell; `None` where it descends a tree.
    pub const fn slack(&self) -> Option<f32> {
        match self {
            Self::Hierarchy | Self::SplitHierarchy | Self::Partition => None,
            Self::Flat { slack, .. } | Self::Nested { slack } => Some(*slack),
        }
    }
}

/// What overlays, the tree, statistics and validation walk.
pub trait Cells: Send + Sync {
    /// The cell that holds everything.
    fn root(&self) -> Cell;

    /// Calls `each` for the children of a cell, near the root of memory first, until it breaks.
    fn children(&self, cell: &Cell, each: &mut dyn FnMut(Cell) -> ControlFlow<()>);

    /// Calls `each` for every reference that a leaf holds.
    fn prims(&self, cell: &Cell, each: &mut dyn FnMut(PrimRef));

    /// What a cell looks like, in the space that its shape is in.
    fn form(&self, cell: &Cell) -> Form {
        Form::Box(*cell.shape.bounds())
    }

    /// Where the cells of that instance are; `None` for the upper level, or the only one.
    fn level(&self, instance: u32) -> Option<Level> {
        let _ = instance;
        None
    }

    /// How the cells relate.
    fn layout(&self) -> Layout;

    /// The same of the cells of an instance (see [`CellId`]): structures below an upper level may be of another kind.
    fn layout_of(&self, instance: u32) -> Layout {
        let _ = instance;
        self.layout()
    }

    /// What the builder decided by itself, in words for the user; each is one sentence.
    fn remarks(&self) -> Vec<String> {
        Vec::new()
    }

    /// Bytes by part, the shared geometry not counted.
    fn memory(&self) -> Vec<MemoryPart>;
}

/// Walks all cells below and including the root, parents first, until `visit` breaks or says not to
/// go deeper.
pub fn walk(cells: &dyn Cells, visit: &mut dyn FnMut(&Cell) -> ControlFlow<(), Descend>) {
    walk_below(cells, cells.root(), visit);
}

/// The same below and including one cell.
pub fn walk_below(cells: &dyn Cells, top: Cell, visit: &mut dyn FnMut(&Cell) -> ControlFlow<(), Descend>) {
    let _ = step_into(cells, &top, visit);
}

/// One cell and what is below it. The children of a cell are not gathered: a grid has millions.
fn step_into(cells: &dyn Cells, cell: &Cell, visit: &mut dyn FnMut(&Cell) -> ControlFlow<(), Descend>) -> ControlFlow<()> {
    match visit(cell) {
        ControlFlow::Break(()) => ControlFlow::Break(()),
        ControlFlow::Continue(Descend::No) => ControlFlow::Continue(()),
        ControlFlow::Continue(Descend::Yes) => {
            let mut onwards = ControlFlow::Continue(());
            cells.children(cell, &mut |child| {
                if onwards.is_continue() {
                    onwards = step_into(cells, &child, visit);
                }
                onwards
            });
            onwards
        }
    }
}

/// The box around a cell in the scene's scaled space, whatever level it is on.
pub fn bounds_in_scene(cells: &dyn Cells, cell: &Cell) -> Aabb {
    let own = *cell.shape.bounds();
    match cells.level(cell.id.instance) {
        Some(Level { instance: Some(_), scene_from_level }) => {
            let corners = own.corners().map(|p| scene_from_level.transform_point3(p.as_dvec3()));
            let (min, max) = corners.into_iter().fold((DVec3::INFINITY, DVec3::NEG_INFINITY), |(a, b), p| (a.min(p), b.max(p)));
            Aabb { min: min.to_array().map(num::round_down).into(), max: max.to_array().map(num::round_up).into() }
        }
        _ => own,
    }
}

/// Whether a walk goes on below a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Descend {
    /// To its children.
    Yes,
    /// To its siblings only.
    No,
}
