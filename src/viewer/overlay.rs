//! Which cells and planes of a structure are drawn: worked out in the background for the present
//! view, since a tree has more cells than any screen shows.

mod found;
mod lit;
#[cfg(test)]
mod tests;

use std::ops::ControlFlow;
use std::sync::Arc;

use super::gpu::{BoxInstance, Overlay, Ruler, View};
use super::settings::{BoxColor, Levels, OverlaySettings};
use super::{theme, wires};
use crate::accel::Accel;
use crate::accel::cell::{Cell, CellKind, Descend, Layout, Level, Shape, Split, bounds_in_scene, walk_below};
use crate::accel::outline::{Outline, Row};
use crate::geometry::{Aabb, Axis, HalfSpace};
use crate::lab::Visits;
use crate::lab::film::{Film, Seen};
use crate::task::{Cancel, Cancelled};
use found::{BOX_EDGES, Drawn, Found};

/// What an overlay is made for.
#[derive(Clone, Debug, PartialEq)]
pub struct Wanted {
    /// What is switched on.
    pub settings: OverlaySettings,
    /// From where it is seen.
    pub view: View,
    /// The viewport in pixels.
    pub size_px: [u32; 2],
    /// The most boxes that are drawn fluently; of other forms so many that they have no more edges.
    pub limit: usize,
    /// Below which cell alone, with its row.
    pub top: Option<(Cell, u32)>,
    /// The root of the lower level that it is in, if it is: which, and its depth.
    pub root: Option<(u32, u32)>,
    /// The rows of cells are known, for colours that need them.
    pub numbered: bool,
    /// Which count of visits colours stand for, if they do and there is one.
    pub counted: Option<u64>,
    /// The position of the film that is shown instead of depths.
    pub film_at: Option<u32>,
    /// What colours of amounts go from and to, where several pictures share that; by themselves if `None`.
    pub range: Option<[f32; 2]>,
}

impl Wanted {
    /// All that the settings switch on, in colours that need no rows.
    pub const fn new(settings: OverlaySettings, view: View, size_px: [u32; 2], limit: usize) -> Self {
        let (top, root, counted, film_at, range) = (None, None, None, None, None);
        Self { settings, view, size_px, limit, top, root, numbered: false, counted, film_at, range }
    }
}

/// What is known of the structure besides.
#[derive(Clone, Default)]
pub struct Known {
    /// Its cells, for colours that need their rows.
    pub outline: Option<Arc<Outline>>,
    /// How often rays enter them.
    pub visits: Option<Arc<Visits>>,
    /// The film of its build.
    pub film: Option<Arc<Film>>,
}

/// An overlay, and how much of the structure it shows.
#[derive(Clone, Debug, Default)]
pub struct Collected {
    /// For the GPU; its generation is not set.
    pub overlay: Overlay,
    /// Cells and planes that are drawn.
    pub shown: usize,
    /// Cells and planes that match the settings in and out of view, as far as they were counted.
    pub total: usize,
    /// Some lie outside the view with all that is below them, and were not counted.
    pub more: bool,
    /// Some of them are no boxes.
    pub other_forms: bool,
    /// What colours go from and to, if they do not stand for depths.
    pub range: Option<[f32; 2]>,
    /// The least and the greatest of the amounts that they stand for.
    pub amounts: Option<[f32; 2]>,
}

/// Boxes smaller than this many pixels are not drawn.
const LEAST_PX: f32 = 1.0;
/// So many more than twice as many as are drawn are kept until they are sorted out. Few in tests, so that it happens there.
const ROOM: usize = if cfg!(test) { 1 << 8 } else { 1 << 16 };
/// Cells looked at between two looks at the cancel flag.
const CELLS_PER_CHECK: u64 = 4096;
/// Shapes made between two looks at the cancel flag.
const SHAPES_PER_CHECK: usize = 256;
/// The most edges of what is no box: to make them takes longer than to draw them.
const MOST_EDGES: usize = 1 << 18;

struct Collector<'a> {
    wanted: &'a Wanted,
    /// How often rays enter cells, if it is known.
    visits: Option<&'a Visits>,
    ruler: Ruler,
    /// Cells along each axis, of a grid.
    resolution: Option<[u32; 3]>,
    /// Where there are two of them.
    levels: Levels,
    /// The lower level that the walk is in, and the depth of its root.
    root: Option<(u32, u32)>,
    found: Vec<Found>,
    total: usize,
    more: bool,
}

/// Walks the structure as deep as the settings want, or as the film of its build has come, skipping what is below a cell that
/// cannot be seen: a hierarchy's children lie inside it.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn collect(accel: &dyn Accel, known: &Known, wanted: &Wanted, cancel: &Cancel) -> Result<Collected, Cancelled> {
    let (outline, visits) = (known.outline.as_deref(), known.visits.as_deref());
    let film = known.film.as_deref().zip(wanted.film_at).map(|(film, at)| film.seen(at));
    // Nobody counted who enters the cells of the tree that a film begins with.
    let (accel, visits) = match film {
        Some(Seen::Cells(_, _, Some(before))) => (before, None),
        _ => (accel, visits),
    };
    let resolution = if let Layout::Flat { resolution, .. } = accel.layout() { Some(resolution) } else { None };
    let ruler = Ruler::new(&wanted.view, wanted.size_px);
    let levels = if accel.levels().is_some() { wanted.settings.levels } else { Levels::Through };
    let root = wanted.root;
    let (found, total, more) = (Vec::new(), 0, false);
    let mut collector = Collector { wanted, visits, ruler, resolution, levels, root, found, total, more };
    let mut looked = 0u64;
    let mut stopped = Ok(());
    let mut visit = |cell: &Cell, at: Option<(&Outline, u32)>| {
        looked += 1;
        if looked.is_multiple_of(CELLS_PER_CHECK) {
            stopped = cancel.check();
        }
        let row = at.map(|(outline, row)| outline.row(row));
        let whole = film.zip(at).map(|(film, (_, row))| film.is_whole(row));
        if stopped.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(collector.visit(accel, cell, row, whole)) }
    };
    let top = wanted.top.map_or_else(|| accel.root(), |top| top.0);
    match film.map(|film| film.outline()).or(outline.filter(|_| wanted.numbered)) {
        Some(outline) => {
            let row = wanted.top.map_or(0, |top| top.1);
            // Whether it broke off is known already.
            let _ = outline.walk_below(accel, &top, row, &mut |cell, row| visit(cell, Some((outline, row))));
        }
        None => walk_below(accel, top, &mut |cell| visit(cell, None)),
    }
    stopped?;
    let mut collected = collector.finish(accel, cancel)?;
    match film {
        Some(Seen::Cells(replay, at, _)) => lit::light(accel, replay, at, (wanted, cancel), &mut collected)?,
        Some(Seen::Moves(moves, _)) => lit::light_moves(moves, &mut collected.overlay),
        Some(Seen::Finished(_)) | None => {}
    }
    Ok(collected)
}

impl Collector<'_> {
    /// Of a film it is told whether the cell is whole: then it is drawn, and nothing below it.
    fn visit(&mut self, accel: &dyn Accel, cell: &Cell, row: Option<Row>, whole: Option<bool>) -> Descend {
        let s = &self.wanted.settings;
        let depth = self.depth_of(cell);
        let bounds = bounds_in_scene(accel, cell);
        // What the section cuts away is as good as out of view.
        let Some(px) = self.ruler.pixels(&bounds).filter(|_| !self.is_cut_away(&bounds)) else {
            self.more |= !cell.is_leaf() && whole != Some(true);
            self.total += usize::from(self.wants_box(cell, depth, whole));
            return Descend::No;
        };
        if self.wants_box(cell, depth, whole) {
            self.total += 1;
            if px >= LEAST_PX {
                let value = self.value(cell, row);
                self.keep(Found { value, ..Found::new(cell, depth, px) });
            }
        }
        if cell.split.is_some() && s.planes && whole.is_none() && (s.from_depth..=s.depth).contains(&depth) {
            self.total += 1;
            if px >= LEAST_PX && !self.is_plane_cut_away(accel, cell) {
                let value = self.value(cell, row);
                self.keep(Found { value, plane: true, ..Found::new(cell, depth, px) });
            }
        }
        let deeper = whole.map_or_else(|| self.wants_deeper(cell, depth), |whole| !whole);
        if px < LEAST_PX && !cell.is_leaf() && deeper {
            self.more = true;
            return Descend::No;
        }
        if deeper { Descend::Yes } else { Descend::No }
    }

    /// Takes it in. Of far more than are drawn only the first are kept: a large grid has millions in view.
    fn keep(&mut self, found: Found) {
        self.found.push(found);
        if self.found.len() >= 2 * self.limit() + ROOM {
            self.leave_the_first();
        }
    }

    fn is_cut_away(&self, bounds: &Aabb) -> bool {
        self.wanted.view.section.is_some_and(|section| section.misses(bounds))
    }

    /// Whether the section cuts all of a cell's plane away; planes in any direction go by their cell.
    fn is_plane_cut_away(&self, accel: &dyn Accel, cell: &Cell) -> bool {
        let Some(Split::Axis { axis, pos }) = cell.split else { return false };
        let plane = plane_in(cell.shape.bounds(), axis, pos);
        self.is_cut_away(&bounds_in_scene(accel, &Cell { shape: Shape::Box(plane), ..*cell }))
    }

    fn limit(&self) -> usize {
        self.wanted.limit.max(1)
    }

    /// Leaves as many as are drawn.
    fn leave_the_first(&mut self) {
        let limit = self.limit();
        if self.found.len() > limit {
            self.found.select_nth_unstable_by_key(limit - 1, Found::order);
            self.found.truncate(limit);
        }
    }

    /// How deep a cell is below the root that depths count from. A walk is in one instance at a time.
    fn depth_of(&mut self, cell: &Cell) -> u32 {
        let instance = cell.id.instance;
        if self.levels == Levels::Through || instance == 0 {
            return cell.depth;
        }
        let root = self.root.filter(|root| root.0 == instance).unwrap_or((instance, cell.depth));
        self.root = Some(root);
        cell.depth.saturating_sub(root.1)
    }

    fn wants_deeper(&self, cell: &Cell, depth: u32) -> bool {
        let s = &self.wanted.settings;
        let deeper = s.leaves_only || depth < s.depth || self.resolution.is_some();
        match (self.levels, cell.id.instance) {
            (Levels::Both | Levels::Lower, 0) => true,
            (Levels::Upper, 1..) => false,
            _ => deeper,
        }
    }

    fn wants_box(&self, cell: &Cell, depth: u32, whole: Option<bool>) -> bool {
        let s = &self.wanted.settings;
        let leaf = cell.is_leaf();
        s.boxes
            && match cell.kind {
                CellKind::Void | CellKind::Leaf { prims: 0 } if !s.empty_cells => false,
                _ if let Some(whole) = whole => whole,
                _ if self.resolution.is_some() => leaf && cell.prims() >= s.occupancy && self.in_slice(cell),
                _ => self.wants_of_level(cell, depth),
            }
    }

    fn wants_of_level(&self, cell: &Cell, depth: u32) -> bool {
        let s = &self.wanted.settings;
        let wanted = if s.leaves_only { cell.is_leaf() } else { (s.from_depth..=s.depth).contains(&depth) };
        let upper = cell.id.instance == 0;
        // What stands in a place is the root of a lower level.
        let instance = !upper && depth == 0;
        match self.levels {
            Levels::Through => wanted,
            Levels::Both => instance || (!upper && wanted),
            Levels::Upper if s.leaves_only => instance,
            Levels::Upper => upper && wanted,
            Levels::Lower => !upper && wanted,
        }
    }

    /// What the colour of a cell stands for; no number where it is not known.
    fn value(&self, cell: &Cell, row: Option<Row>) -> f32 {
        let of_row = |of: fn(Row) -> f64| row.map_or(f32::NAN, |row| of(row) as f32);
        match self.wanted.settings.color {
            BoxColor::Depth => cell.depth as f32,
            BoxColor::Triangles => of_row(|row| row.references.into()),
            BoxColor::Cost => of_row(|row| row.share),
            BoxColor::Overlap => of_row(|row| row.overlap.unwrap_or(f64::NAN)),
            BoxColor::Visits => self.visits.map_or(f32::NAN, |visits| visits.a_ray(cell.id) as f32),
        }
    }

    /// Cells of a grid are numbered from 1, x fastest.
    fn in_slice(&self, cell: &Cell) -> bool {
        let (s, Some([x, y, _])) = (&self.wanted.settings, self.resolution) else { return true };
        let index = cell.id.node.saturating_sub(1);
        let at = [index % x, index / x % y, index / (x * y)];
        s.slice == 0 || at.get(s.slice_axis).is_none_or(|layer| layer + 1 == s.slice)
    }

    /// What is drawn of those that were found: the first of them, as long as they have no more edges than are drawn fluently.
    fn shapes(&mut self, accel: &dyn Accel, cancel: &Cancel) -> Result<Vec<(Found, Drawn)>, Cancelled> {
        let boxes = self.found.iter().all(Found::is_of_box);
        if !boxes {
            self.found.sort_by_key(Found::order);
        }
        let mut left = if boxes { usize::MAX } else { self.limit().saturating_mul(BOX_EDGES).min(MOST_EDGES) };
        let mut shapes = Vec::with_capacity(self.found.len());
        for (i, found) in std::mem::take(&mut self.found).into_iter().enumerate() {
            if i.is_multiple_of(SHAPES_PER_CHECK) {
                cancel.check()?;
            }
            let Some(drawn) = Drawn::of(&found, accel) else { continue };
            let edges = drawn.edges(wires::sides(found.px));
            if edges > left && !shapes.is_empty() {
                break;
            }
            left = left.saturating_sub(edges);
            shapes.push((found, drawn));
        }
        Ok(shapes)
    }

    /// The largest on the screen, as many as are drawn fluently, of those about as large some from
    /// everywhere; deeper levels over higher ones.
    fn finish(mut self, accel: &dyn Accel, cancel: &Cancel) -> Result<Collected, Cancelled> {
        self.leave_the_first();
        let mut shapes = self.shapes(accel, cancel)?;
        shapes.sort_by_key(|(found, _)| found.depth);
        let depths = shapes.iter().map(|(found, _)| found.depth);
        let shown = depths.clone().min().unwrap_or(0)..=depths.max().unwrap_or(0);
        let by_depth = self.wanted.settings.color == BoxColor::Depth;
        let values = shapes.iter().map(|(found, _)| found.value).filter(|value| value.is_finite());
        let [low, high] = values.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        let amounts = (!by_depth && low <= high).then_some([low, high]);
        let range = amounts.map(|amounts| self.wanted.range.unwrap_or(amounts));
        let mut overlay = Overlay::default();
        for (found, drawn) in &shapes {
            let color = match () {
                () if by_depth => theme::depth_color(found.depth, &shown),
                () if found.value.is_finite() => theme::amount_color(found.value, range.unwrap_or([low, high])),
                () => theme::UNKNOWN,
            };
            self.draw(accel, found, drawn, color.to_array(), &mut overlay);
        }
        let other_forms = !overlay.lines.is_empty();
        overlay.planes.extend(self.wanted.view.section.map(|section| section_in(&section, accel.geometry().space().bounds())));
        Ok(Collected { overlay, shown: shapes.len(), total: self.total, more: self.more, other_forms, range, amounts })
    }

    fn draw(&self, accel: &dyn Accel, found: &Found, drawn: &Drawn, color: [u8; 4], overlay: &mut Overlay) {
        let instance = found.cell.id.instance;
        match drawn {
            Drawn::Cell(form) => {
                let wires = wires::of_form(accel, instance, form, (&self.wanted.view, wires::sides(found.px)), color);
                overlay.boxes.extend(wires.boxed);
                overlay.lines.extend(wires.lines);
            }
            Drawn::Plane(bounds) => overlay.planes.push(placed(accel, instance, bounds, color)),
            Drawn::Polygon(corners) => {
                let [fills, lines] = wires::of_polygon(accel, instance, corners, color);
                overlay.fills.extend(fills);
                overlay.lines.extend(lines);
            }
        }
    }
}

/// The plane of a section where it goes through the scene, as a flat box.
fn section_in(section: &HalfSpace, bounds: &Aabb) -> BoxInstance {
    BoxInstance::new(&plane_in(bounds, section.axis, section.at), theme::SECTION.to_array())
}

/// A box in the space of a level (see [`crate::accel::CellId`]), where it is in the scene.
pub fn placed(accel: &dyn Accel, instance: u32, bounds: &Aabb, color: [u8; 4]) -> BoxInstance {
    match accel.level(instance) {
        Some(Level { instance: Some(_), scene_from_level }) => BoxInstance::turned(bounds, &scene_from_level, color),
        _ => BoxInstance::new(bounds, color),
    }
}

/// The part of a plane that lies in a cell, as a flat box.
pub fn plane_in(cell: &Aabb, axis: Axis, pos: f32) -> Aabb {
    let mut plane = *cell;
    plane.min[axis.index()] = pos;
    plane.max[axis.index()] = pos;
    plane
}
