//! What is under a click: the triangle, and the leaf of the structure that holds it.

use std::ops::ControlFlow;

use super::format;
use super::gpu::BoxInstance;
use crate::accel::cell::{Descend, walk};
use crate::accel::probe::Counts;
use crate::accel::{Accel, Hit, Mode};
use crate::geometry::{Aabb, Ray};
use crate::scene::Scene;
use glam::Vec3;

/// Something that was clicked.
#[derive(Clone, Debug, PartialEq)]
pub struct Picked {
    /// What it is, in a line.
    pub text: String,
    /// The box of its leaf, in the scaled space.
    pub leaf: Option<BoxInstance>,
}

/// Traces the ray of the click; `None` if it meets nothing.
pub fn pick(scene: &Scene, accel: &dyn Accel, ray: &Ray) -> Option<Picked> {
    let mut counts = Counts::default();
    let hit = accel.trace_watched(ray, Mode::Closest, &mut counts)?;
    let leaf = leaf_of(accel, ray, &hit);
    let mesh = &scene.meshes[scene.instances[hit.instance as usize].mesh];
    let name = if mesh.name.is_empty() { String::new() } else { format!(" of {}", mesh.name) };
    let depth = leaf.map(|(depth, _)| format!(", leaf at depth {depth}")).unwrap_or_default();
    let work = format!("{} nodes, {} tests", format::count(counts.nodes), format::count(counts.prims));
    let text = format!("Triangle {}{name}{depth}: this ray took {work}", format::count(u64::from(hit.primitive)));
    Some(Picked { text, leaf: leaf.map(|(_, bounds)| BoxInstance::new(&bounds, [u8::MAX; 4])) })
}

/// The leaf that holds the triangle and the point, and its depth.
fn leaf_of(accel: &dyn Accel, ray: &Ray, hit: &Hit) -> Option<(u32, Aabb)> {
    let geometry = accel.geometry();
    let prim = geometry.flat(hit.instance, hit.primitive);
    let point = geometry.space().point(ray.at(hit.t));
    let slack = Vec3::splat(1e-4 * geometry.bounds().size().max_element());
    let near = Aabb { min: point - slack, max: point + slack };
    let mut found = None;
    walk(accel, &mut |cell| {
        let bounds = *cell.shape.bounds();
        if bounds.intersection(near).is_empty() {
            return ControlFlow::Continue(Descend::No);
        }
        let mut holds = false;
        if cell.is_leaf() {
            accel.prims(cell, &mut |p| holds |= p == prim);
        }
        if holds {
            found = Some((cell.depth, bounds));
            return ControlFlow::Break(());
        }
        ControlFlow::Continue(Descend::Yes)
    });
    found
}
