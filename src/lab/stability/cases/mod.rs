//! Scenes and rays that are known to break ray tracers: one file each, made from a seed, with what each is, where it
//! bites, and what helps. A new case is one file and one line in [`ALL`].

mod centroids;
mod copies;
mod degenerate;
mod denormals;
mod diagonals;
mod ends;
mod far;
mod few;
mod flat;
mod grazing;
mod grid_lines;
mod indices;
mod layers;
mod non_finite;
mod planes;
mod scales;
mod series;
pub(super) mod shapes;
mod shared_edges;
mod slivers;
mod spanning;
mod stadium;
mod surface;
mod teapot;
mod zero_directions;

use crate::geometry::Ray;
use crate::scene::builtin::Random;
use crate::scene::{Instance, Mesh, Scene};
use glam::Vec3;

/// What is traced.
#[derive(Clone, Debug, Default)]
pub struct Trial {
    /// The scene.
    pub triangles: Vec<[Vec3; 3]>,
    /// World rays.
    pub rays: Vec<Ray>,
    /// Whether the triangles are the whole surface of one or more solids, neighbours sharing corners to the bit.
    pub closed: bool,
    /// The most entries of a list that structures may index, if it is not what 32 bits number: then one may say that it
    /// does not fit, and must be right if it does.
    pub indices: Option<usize>,
}

impl Trial {
    /// As a scene of one mesh.
    pub fn scene(&self, name: &str) -> Scene {
        let mut mesh = Mesh { name: name.to_owned(), ..Mesh::default() };
        for (first, tri) in (0u32..).step_by(3).zip(&self.triangles) {
            mesh.positions.extend(tri);
            mesh.triangles.push([first, first + 1, first + 2]);
        }
        Scene {
            name: name.to_owned(),
            meshes: vec![mesh],
            instances: vec![Instance::identity(0)],
            up: Vec3::Y,
            ..Scene::default()
        }
    }
}

/// A case.
#[derive(Clone, Copy, Debug)]
pub struct Case {
    /// The name used on the command line and in files.
    pub id: &'static str,
    /// What it is.
    pub what: &'static str,
    /// Where it is known to bite.
    pub bites: &'static str,
    /// What helps.
    pub remedy: &'static str,
    /// Makes about that many rays.
    make: fn(&mut Random, usize) -> Trial,
}

impl Case {
    /// The scene and about `rays` rays, the same for the same seed.
    pub fn trial(&self, seed: u64, rays: usize) -> Trial {
        (self.make)(&mut Random::new(seed, 0), rays)
    }
}

/// All of them.
pub static ALL: &[Case] = &[
    zero_directions::CASE,
    grid_lines::CASE,
    planes::CASE,
    flat::CASE,
    shared_edges::CASE,
    slivers::CASE,
    diagonals::CASE,
    grazing::CASE,
    scales::TINY,
    scales::SMALL,
    scales::LARGE,
    scales::HUGE,
    denormals::CASE,
    far::NEAR,
    far::FAR,
    far::FARTHEST,
    stadium::HUNDRED,
    stadium::HUNDRED_THOUSAND,
    stadium::HUNDRED_MILLION,
    teapot::HUNDRED,
    teapot::HUNDRED_THOUSAND,
    teapot::HUNDRED_MILLION,
    non_finite::CASE,
    degenerate::CASE,
    copies::CASE,
    layers::CASE,
    centroids::CASE,
    series::CASE,
    surface::CASE,
    ends::CASE,
    spanning::CASE,
    few::NONE,
    few::ONE,
    few::TWO,
    few::THREE,
    few::FIVE,
    indices::FEW,
    indices::SOME,
    indices::MANY,
];

/// The case of that id.
pub fn find(id: &str) -> Option<&'static Case> {
    ALL.iter().find(|case| case.id == id)
}
