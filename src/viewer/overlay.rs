//! Which boxes and planes of a structure are drawn: worked out in the background for the present
//! view, since a tree has more cells than any screen shows.

use std::ops::ControlFlow;

use super::gpu::{BoxInstance, Overlay, Ruler, View};
use super::settings::OverlaySettings;
use super::theme;
use crate::accel::Accel;
use crate::accel::cell::{Cell, CellKind, Descend, Layout, Split, walk};
use crate::geometry::{Aabb, Axis};
use crate::task::{Cancel, Cancelled};

/// What an overlay is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// What is switched on.
    pub settings: OverlaySettings,
    /// From where it is seen.
    pub view: View,
    /// The viewport in pixels.
    pub size_px: [u32; 2],
    /// The most boxes that are drawn fluently.
    pub limit: usize,
}

/// An overlay, and how much of the structure it shows.
#[derive(Clone, Debug, Default)]
pub struct Collected {
    /// For the GPU; its generation is not set.
    pub overlay: Overlay,
    /// Boxes and planes that are drawn.
    pub shown: usize,
    /// Boxes and planes that match the settings in and out of view, as far as they were counted.
    pub total: usize,
    /// Some lie outside the view with all that is below them, and were not counted.
    pub more: bool,
}

/// Boxes smaller than this many pixels are not drawn.
const LEAST_PX: f32 = 1.0;
/// Cells looked at between two looks at the cancel flag.
const CELLS_PER_CHECK: u64 = 4096;

/// A box or plane that is in view, and how large it is there.
struct Found {
    px: f32,
    depth: u32,
    bounds: Aabb,
    plane: bool,
}

struct Collector<'a> {
    wanted: &'a Wanted,
    ruler: Ruler,
    /// Cells along each axis, of a grid.
    resolution: Option<[u32; 3]>,
    found: Vec<Found>,
    total: usize,
    more: bool,
}

/// Walks the structure as deep as the settings want, skipping what is below a cell that cannot be
/// seen: a hierarchy's children lie inside it.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn collect(accel: &dyn Accel, wanted: &Wanted, cancel: &Cancel) -> Result<Collected, Cancelled> {
    let resolution = if let Layout::Flat { resolution, .. } = accel.layout() { Some(resolution) } else { None };
    let ruler = Ruler::new(&wanted.view, wanted.size_px);
    let mut collector = Collector { wanted, ruler, resolution, found: Vec::new(), total: 0, more: false };
    let mut looked = 0u64;
    let mut stopped = Ok(());
    walk(accel, &mut |cell| {
        looked += 1;
        if looked.is_multiple_of(CELLS_PER_CHECK) {
            stopped = cancel.check();
        }
        if stopped.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(collector.visit(cell)) }
    });
    stopped?;
    Ok(collector.finish())
}

impl Collector<'_> {
    fn visit(&mut self, cell: &Cell) -> Descend {
        let s = &self.wanted.settings;
        let bounds = *cell.shape.bounds();
        let Some(px) = self.ruler.pixels(&bounds) else {
            self.more |= !cell.is_leaf();
            self.total += usize::from(self.wants_box(cell));
            return Descend::No;
        };
        if self.wants_box(cell) {
            self.total += 1;
            if px >= LEAST_PX {
                self.found.push(Found { px, depth: cell.depth, bounds, plane: false });
            }
        }
        if let Some(Split::Axis { axis, pos }) = cell.split
            && s.planes
            && (s.from_depth..=s.depth).contains(&cell.depth)
        {
            self.total += 1;
            if px >= LEAST_PX {
                self.found.push(Found { px, depth: cell.depth, bounds: plane_in(&bounds, axis, pos), plane: true });
            }
        }
        let deeper = s.leaves_only || cell.depth < s.depth || self.resolution.is_some();
        if px < LEAST_PX && !cell.is_leaf() && deeper {
            self.more = true;
            return Descend::No;
        }
        if deeper { Descend::Yes } else { Descend::No }
    }

    fn wants_box(&self, cell: &Cell) -> bool {
        let s = &self.wanted.settings;
        let leaf = cell.is_leaf();
        s.boxes
            && match cell.kind {
                CellKind::Void | CellKind::Leaf { prims: 0 } if !s.empty_cells => false,
                _ if self.resolution.is_some() => leaf && self.in_slice(cell),
                _ if s.leaves_only => leaf,
                _ => (s.from_depth..=s.depth).contains(&cell.depth),
            }
    }

    /// Cells of a grid are numbered from 1, x fastest.
    fn in_slice(&self, cell: &Cell) -> bool {
        let (s, Some([x, y, _])) = (&self.wanted.settings, self.resolution) else { return true };
        let index = cell.id.node.saturating_sub(1);
        let at = [index % x, index / x % y, index / (x * y)];
        s.slice == 0 || at.get(s.slice_axis).is_none_or(|layer| layer + 1 == s.slice)
    }

    /// The largest on the screen, as many as are drawn fluently; deeper levels over higher ones.
    fn finish(mut self) -> Collected {
        let limit = self.wanted.limit.max(1);
        if self.found.len() > limit {
            self.found.select_nth_unstable_by(limit - 1, |a, b| b.px.total_cmp(&a.px));
            self.found.truncate(limit);
        }
        self.found.sort_by_key(|f| f.depth);
        let depths = self.found.iter().map(|f| f.depth);
        let shown = depths.clone().min().unwrap_or(0)..=depths.max().unwrap_or(0);
        let mut overlay = Overlay::default();
        for f in &self.found {
            let instance = BoxInstance::new(&f.bounds, theme::depth_color(f.depth, &shown).to_array());
            if f.plane { overlay.planes.push(instance) } else { overlay.boxes.push(instance) }
        }
        Collected { overlay, shown: self.found.len(), total: self.total, more: self.more }
    }
}

/// The part of a plane that lies in a cell, as a flat box.
fn plane_in(cell: &Aabb, axis: Axis, pos: f32) -> Aabb {
    let mut plane = *cell;
    plane.min[axis.index()] = pos;
    plane.max[axis.index()] = pos;
    plane
}
