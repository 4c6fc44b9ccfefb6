//! What is under a click: the triangle, and the leaf of the structure that holds it.

use std::ops::ControlFlow;

use super::format;
use crate::accel::cell::{Cell, CellId, Descend, bounds_in_scene, walk};
use crate::accel::outline::{Outline, cells_along};
use crate::accel::probe::Counts;
use crate::accel::{Accel, Hit, Mode, Visibility};
use crate::geometry::{Aabb, Ray};
use crate::scene::Scene;
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// Something that was clicked.
#[derive(Clone, Debug, PartialEq)]
pub struct Picked {
    /// What it is, in a line.
    pub text: String,
    /// The cells that hold the point, from the root to the leaf.
    pub path: Vec<Cell>,
    /// Which of them is selected.
    pub level: usize,
}

impl Picked {
    /// A cell by its row.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of_row(accel: &dyn Accel, outline: &Outline, row: u32, cancel: &Cancel) -> Result<Self, Cancelled> {
        let path = outline.cells(accel, row, cancel)?;
        let facts = outline.row(row);
        let kind = if facts.is_leaf() { "Leaf" } else { "Node" };
        let (references, share) = (format::count(facts.references.into()), format::share(facts.share));
        let text = format!("{kind} {} at depth {}: {references} triangles, {share} of the SAH cost", facts.id.node, facts.depth);
        Ok(Self::at_end(path, text))
    }

    /// A cell by those from the root to it.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn of_path(accel: &dyn Accel, path: &[CellId], cancel: &Cancel) -> Result<Self, Cancelled> {
        let path = cells_along(accel, path, cancel)?;
        let text = path.last().map(|cell| {
            let kind = if cell.is_leaf() { "Leaf" } else { "Node" };
            format!("{kind} {} at depth {}", cell.id.node, cell.depth)
        });
        let text = text.unwrap_or_else(|| "The cell that was selected is not there any more".to_owned());
        Ok(Self::at_end(path, text))
    }

    /// The last of cells within each other.
    const fn at_end(path: Vec<Cell>, text: String) -> Self {
        Self { text, level: path.len().saturating_sub(1), path }
    }

    /// The numbers of the cells from the root to the selected one.
    pub fn ids(&self) -> Vec<CellId> {
        self.path.iter().take(self.level + 1).map(|cell| cell.id).collect()
    }

    /// The root of the lower level that the selected cell is in, if it is in one: which level (see [`CellId`]), and its depth.
    pub fn lower_root(&self) -> Option<(u32, u32)> {
        let level = self.selected()?.id.instance;
        let root = self.path.iter().find(|cell| cell.id.instance == level && level != 0)?;
        Some((level, root.depth))
    }

    /// The selected cell.
    pub fn selected(&self) -> Option<&Cell> {
        self.path.get(self.level)
    }
}

/// Traces the ray of the click; `None` if it meets nothing that is seen.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn pick(
    scene: &Scene,
    (accel, visible): (&dyn Accel, Option<&Visibility>),
    ray: &Ray,
    cancel: &Cancel,
) -> Result<Option<Picked>, Cancelled> {
    let mut counts = Counts::default();
    let mut hit = accel.trace_watched(ray, Mode::Closest, &mut counts, cancel)?;
    if let Some(visible) = visible {
        let mut hits = [None];
        accel.trace_filtered(&[*ray], Mode::Closest, &visible.filter(accel.geometry()), &mut hits, cancel)?;
        hit = hits[0];
    }
    let Some(hit) = hit else { return Ok(None) };
    let path = path_to(accel, ray, &hit);
    let mesh = &scene.meshes[scene.instances[hit.instance as usize].mesh];
    let name = if mesh.name.is_empty() { String::new() } else { format!(" of {}", mesh.name) };
    let depth = path.last().map(|leaf| format!(", leaf at depth {}", leaf.depth)).unwrap_or_default();
    let text = format!("Triangle {}{name}{depth}", format::count(u64::from(hit.primitive)));
    // The ray that passes what is hidden is none that is counted.
    let work = format!(": this ray took {} nodes, {} tests", format::count(counts.nodes), format::count(counts.prims));
    let text = if visible.is_some() { text } else { text + &work };
    Ok(Some(Picked::at_end(path, text)))
}

/// The cells from the root to the leaf that holds the triangle and the point; empty if none does.
fn path_to(accel: &dyn Accel, ray: &Ray, hit: &Hit) -> Vec<Cell> {
    let geometry = accel.geometry();
    // What was flattened has numbers of its own.
    let flat = geometry.flat(hit.instance, hit.primitive);
    let prim = flat.unwrap_or(hit.primitive);
    let is_of = |cell: &Cell| match accel.level(cell.id.instance) {
        None => true,
        Some(level) if flat.is_some() => level.instance.is_none(),
        Some(level) => level.instance == Some(hit.instance),
    };
    let point = geometry.space().point(ray.at(hit.t));
    let slack = Vec3::splat(1e-4 * geometry.space().bounds().size().max_element());
    let near = Aabb { min: point - slack, max: point + slack };
    let (mut path, mut found) = (Vec::new(), false);
    walk(accel, &mut |cell| {
        path.truncate(cell.depth as usize);
        if !is_of(cell) || bounds_in_scene(accel, cell).intersection(near).is_empty() {
            return ControlFlow::Continue(Descend::No);
        }
        path.push(*cell);
        let mut holds = false;
        if cell.is_leaf() {
            accel.prims(cell, &mut |p| holds |= p == prim);
        }
        found = holds;
        if holds { ControlFlow::Break(()) } else { ControlFlow::Continue(Descend::Yes) }
    });
    if found { path } else { Vec::new() }
}
