//! Every structure there is, one line each. What is registered is what the window offers, what the
//! command line takes, and what the conformance suite tests.

use std::sync::Arc;

use super::params::{Param, ParamValues};
use super::{Accel, BuildCx, BuildError, Instanced, brute, bsp, bvh, grid, kdtree, octree, volumes, wide, would_fit};
use crate::geometry::tri::{BaldwinWeber, Double, Exact, Fast, TestKind, TriTest, Watertight};
use crate::scene::Geometry;

/// What kind of structure it is: raw SAH costs are comparable only within one family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Family {
    /// No structure.
    Brute,
    /// Bounding volume hierarchies.
    Bvh,
    /// k-d trees.
    KdTree,
    /// Grids.
    Grid,
    /// Octrees.
    Octree,
    /// Binary space partitions with planes of any direction.
    Bsp,
}

impl Family {
    /// Whether nodes wait on a stack while a ray is traced: not where every triangle is tested, or the ray goes from cell to cell.
    pub const fn has_stack(self) -> bool {
        match self {
            Self::Brute | Self::Grid => false,
            Self::Bvh | Self::KdTree | Self::Octree | Self::Bsp => true,
        }
    }
}

/// How a structure is built.
pub type Build = fn(&Arc<Geometry>, &ParamValues, &BuildCx) -> Result<Box<dyn Accel>, BuildError>;

/// A registered structure.
#[derive(Clone, Copy, Debug)]
pub struct Entry {
    /// The name used on the command line and in files.
    pub id: &'static str,
    /// The name in the window.
    pub name: &'static str,
    /// The name where there is little room.
    pub short: &'static str,
    /// Its kind.
    pub family: Family,
    /// One sentence that explains it.
    pub help: &'static str,
    /// What can be set.
    pub params: &'static [Param],
    watertight: Build,
    fast: Build,
    exact: Build,
    /// Tests that not every structure has.
    others: &'static [(TestKind, Build)],
}

impl Entry {
    /// The tests that it can be built for.
    pub fn tests(&self) -> impl Iterator<Item = TestKind> {
        TestKind::ALL.into_iter().chain(self.others.iter().map(|(test, _)| *test))
    }

    /// Builds it for a triangle test: where meshes stand in several places one for each mesh, and a level above
    /// ([`Instanced`]).
    ///
    /// # Errors
    /// Cancelled, it would not fit, or it does not have that test.
    pub fn build(
        &self,
        geometry: &Arc<Geometry>,
        test: TestKind,
        p: &ParamValues,
        cx: &BuildCx,
    ) -> Result<Box<dyn Accel>, BuildError> {
        match geometry.placed() {
            None => self.build_flat(geometry, test, p, cx),
            Some(placed) => Ok(Box::new(Instanced::build(self, geometry, placed, test, p, cx)?)),
        }
    }

    /// The same over the flattened triangles alone.
    pub(super) fn build_flat(
        &self,
        geometry: &Arc<Geometry>,
        test: TestKind,
        p: &ParamValues,
        cx: &BuildCx,
    ) -> Result<Box<dyn Accel>, BuildError> {
        let build = match test {
            TestKind::Watertight => self.watertight,
            TestKind::Fast => self.fast,
            TestKind::Exact => self.exact,
            other => match self.others.iter().find(|(test, _)| *test == other) {
                Some((_, build)) => *build,
                None => return Err(BuildError::NoSuchTest { structure: self.id, test }),
            },
        };
        build(geometry, p, cx).or_else(|error| match error {
            BuildError::Memory { structure, over, remedy, .. } => {
                let fits = would_fit::look(self.id, geometry, cx)?;
                Err(BuildError::Memory { structure, over, remedy, fits })
            }
            other => Err(other),
        })
    }

    /// The default parameters.
    pub fn defaults(&self) -> ParamValues {
        ParamValues::defaults(self.params)
    }
}

/// Every structure, the simplest first.
pub static ALL: &[Entry] = &[
    Entry {
        id: "brute",
        name: "Brute force",
        short: "Brute",
        family: Family::Brute,
        help: "No structure: every ray is tested against every triangle.",
        params: &[],
        watertight: brute::<Watertight, false>,
        fast: brute::<Fast, false>,
        exact: brute::<Exact, false>,
        others: &[(TestKind::Double, brute::<Double, false>), (TestKind::BaldwinWeber, brute::<BaldwinWeber, false>)],
    },
    Entry {
        id: "bound",
        name: "Bounding box",
        short: "Box",
        family: Family::Brute,
        help: "Brute force behind one box: rays that miss the box test nothing.",
        params: &[],
        watertight: brute::<Watertight, true>,
        fast: brute::<Fast, true>,
        exact: brute::<Exact, true>,
        others: &[],
    },
    Entry {
        id: "bvh",
        name: "BVH",
        short: "BVH",
        family: Family::Bvh,
        help: "Bounding volume hierarchy: a binary tree of boxes, divided where the surface area heuristic says or in simpler ways.",
        params: bvh::PARAMS,
        watertight: bvh::build::<Watertight>,
        fast: bvh::build::<Fast>,
        exact: bvh::build::<Exact>,
        others: &[],
    },
    Entry {
        id: "wide",
        name: "Wide BVH",
        short: "Wide",
        family: Family::Bvh,
        help: "The tree of the BVH with eight children a node, all met at once, and many rays on their way at a time.",
        params: wide::PARAMS,
        watertight: wide::build::<Watertight>,
        fast: wide::build::<Fast>,
        exact: wide::build::<Exact>,
        others: &[],
    },
    Entry {
        id: "volumes",
        name: "Volumes (BVH)",
        short: "Volumes",
        family: Family::Bvh,
        help: "The tree of the BVH with spheres, turned boxes, k-DOPs or convex hulls around its nodes: tightness against cost.",
        params: volumes::PARAMS,
        watertight: volumes::build::<Watertight>,
        fast: volumes::build::<Fast>,
        exact: volumes::build::<Exact>,
        others: &[],
    },
    Entry {
        id: "kdtree",
        name: "k-d tree",
        short: "k-d",
        family: Family::KdTree,
        help: "Space divided by axis-parallel planes; a ray visits the cells front to back and stops at the first hit.",
        params: kdtree::PARAMS,
        watertight: kdtree::build::<Watertight>,
        fast: kdtree::build::<Fast>,
        exact: kdtree::build::<Exact>,
        others: &[],
    },
    Entry {
        id: "grid",
        name: "Grid",
        short: "Grid",
        family: Family::Grid,
        help: "Space cut into equal cells; a ray steps from cell to cell.",
        params: grid::PARAMS,
        watertight: grid::build::<Watertight>,
        fast: grid::build::<Fast>,
        exact: grid::build::<Exact>,
        others: &[],
    },
    Entry {
        id: "grid2",
        name: "Two-level grid",
        short: "Grid 2",
        family: Family::Grid,
        help: "A coarse grid whose cells are cut into grids of their own, finer where there is more.",
        params: grid::TWO_LEVEL_PARAMS,
        watertight: grid::build_two_level::<Watertight>,
        fast: grid::build_two_level::<Fast>,
        exact: grid::build_two_level::<Exact>,
        others: &[],
    },
    Entry {
        id: "octree",
        name: "Octree",
        short: "Octree",
        family: Family::Octree,
        help: "Space divided in the middle on every axis, again and again where there are triangles.",
        params: octree::PARAMS,
        watertight: octree::build::<Watertight>,
        fast: octree::build::<Fast>,
        exact: octree::build::<Exact>,
        others: &[],
    },
    Entry {
        id: "bsp",
        name: "BSP",
        short: "BSP",
        family: Family::Bsp,
        help: "Binary space partition: space divided by planes of any direction, along the faces and edges of the triangles.",
        params: bsp::PARAMS,
        watertight: bsp::build::<Watertight>,
        fast: bsp::build::<Fast>,
        exact: bsp::build::<Exact>,
        others: &[],
    },
];

fn brute<T: TriTest, const BOUND: bool>(
    geometry: &Arc<Geometry>,
    _: &ParamValues,
    cx: &BuildCx,
) -> Result<Box<dyn Accel>, BuildError> {
    Ok(Box::new(brute::Brute::<T, BOUND>::build(geometry, cx)?))
}

/// The structure of that id.
pub fn find(id: &str) -> Option<&'static Entry> {
    ALL.iter().find(|entry| entry.id == id)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ids_and_parameters_are_unique_and_explained() {
        for (i, entry) in ALL.iter().enumerate() {
            assert!(ALL[..i].iter().all(|other| other.id != entry.id));
            assert!(entry.help.ends_with('.'));
            for (k, param) in entry.params.iter().enumerate() {
                assert!(entry.params[..k].iter().all(|other| other.id != param.id));
                assert!(param.help.ends_with('.'), "{} {}", entry.id, param.id);
                assert_eq!(param.parse(&param.default().to_string()), Ok(param.default()));
            }
        }
    }
}
