//! Which boxes and planes of a structure are drawn: worked out in the background for the present
//! view, since a tree has more cells than any screen shows.

use std::cmp::Reverse;
use std::ops::ControlFlow;

use super::gpu::{BoxInstance, Overlay, Ruler, View};
use super::settings::{BoxColor, OverlaySettings};
use super::theme;
use crate::accel::Accel;
use crate::accel::cell::{Cell, CellKind, Descend, Layout, Level, Shape, Split, bounds_in_scene, walk_below};
use crate::accel::outline::{Outline, Row};
use crate::geometry::{Aabb, Axis, HalfSpace};
use crate::lab::Visits;
use crate::lab::film::Film;
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
    /// Below which cell alone, with its row.
    pub top: Option<(Cell, u32)>,
    /// The rows of cells are known, for colours that need them.
    pub numbered: bool,
    /// Which count of visits colours stand for, if they do and there is one.
    pub counted: Option<u64>,
    /// The position of the film that is shown instead of depths.
    pub film_at: Option<u32>,
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
    /// What colours go from and to, if they do not stand for depths.
    pub range: Option<[f32; 2]>,
}

/// Boxes smaller than this many pixels are not drawn.
const LEAST_PX: f32 = 1.0;
/// So many more than twice as many as are drawn are kept until they are sorted out. Few in tests, so that it happens there.
const ROOM: usize = if cfg!(test) { 1 << 8 } else { 1 << 16 };
/// Cells looked at between two looks at the cancel flag.
const CELLS_PER_CHECK: u64 = 4096;

/// A box or plane that is in view, and how large it is there.
struct Found {
    px: f32,
    depth: u32,
    /// In the space of its level.
    bounds: Aabb,
    /// Which that is, as of [`crate::accel::CellId`].
    instance: u32,
    plane: bool,
    /// What its colour stands for.
    value: f32,
    /// Who goes first among those that are about as large.
    rank: u32,
}

impl Found {
    fn new(cell: &Cell, px: f32) -> Self {
        let (instance, bounds) = (cell.id.instance, *cell.shape.bounds());
        let rank = scatter(cell.id.node ^ scatter(instance));
        Self { px, depth: cell.depth, bounds, instance, plane: false, value: cell.depth as f32, rank }
    }

    fn order(&self) -> (Reverse<u32>, u32, bool) {
        (Reverse(size_class(self.px)), self.rank, self.plane)
    }
}

/// Sizes that differ by less than a factor of two are about the same: by size alone the cells of a
/// grid would all be taken from the corner that is nearest, or that rounding favours.
fn size_class(px: f32) -> u32 {
    // The binary exponent. Whole pixels are common sizes, so no limit of a class falls on one.
    (px * 1.3).to_bits() >> 23
}

/// Numbers cells anew without any pattern, so that the first so many of neighbours are spread evenly,
/// and do not look like a structure. They stay the same while the view turns. (The finaliser of
/// MurmurHash3, Appleby 2011: every bit of the number changes half of the bits.)
fn scatter(node: u32) -> u32 {
    let x = (node ^ node >> 16).wrapping_mul(0x85EB_CA6B);
    let x = (x ^ x >> 13).wrapping_mul(0xC2B2_AE35);
    x ^ x >> 16
}

struct Collector<'a> {
    wanted: &'a Wanted,
    /// How often rays enter cells, if it is known.
    visits: Option<&'a Visits>,
    ruler: Ruler,
    /// Cells along each axis, of a grid.
    resolution: Option<[u32; 3]>,
    found: Vec<Found>,
    total: usize,
    more: bool,
}

/// Walks the structure as deep as the settings want, or as the film of its build has come, skipping what is below a cell that cannot be
/// seen: a hierarchy's children lie inside it.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn collect(
    accel: &dyn Accel,
    (outline, visits, film): (Option<&Outline>, Option<&Visits>, Option<&Film>),
    wanted: &Wanted,
    cancel: &Cancel,
) -> Result<Collected, Cancelled> {
    let resolution = if let Layout::Flat { resolution, .. } = accel.layout() { Some(resolution) } else { None };
    let ruler = Ruler::new(&wanted.view, wanted.size_px);
    let mut collector = Collector { wanted, visits, ruler, resolution, found: Vec::new(), total: 0, more: false };
    let mut looked = 0u64;
    let mut stopped = Ok(());
    let film = film.zip(wanted.film_at);
    let mut visit = |cell: &Cell, at: Option<(&Outline, u32)>| {
        looked += 1;
        if looked.is_multiple_of(CELLS_PER_CHECK) {
            stopped = cancel.check();
        }
        let row = at.map(|(outline, row)| outline.row(row));
        let whole = film.zip(at).map(|((film, position), (_, row))| film.is_whole(row, position));
        if stopped.is_err() { ControlFlow::Break(()) } else { ControlFlow::Continue(collector.visit(accel, cell, row, whole)) }
    };
    let top = wanted.top.map_or_else(|| accel.root(), |top| top.0);
    match film.map(|film| film.0.outline()).or(outline.filter(|_| wanted.numbered)) {
        Some(outline) => {
            let row = wanted.top.map_or(0, |top| top.1);
            // Whether it broke off is known already.
            let _ = outline.walk_below(accel, &top, row, &mut |cell, row| visit(cell, Some((outline, row))));
        }
        None => walk_below(accel, top, &mut |cell| visit(cell, None)),
    }
    stopped?;
    let mut collected = collector.finish(accel);
    if let Some((film, at)) = film {
        light(accel, film, at, (wanted, cancel), &mut collected)?;
    }
    Ok(collected)
}

/// The most parts that a cell is divided into that stand out.
const MOST_LIT: usize = 32;

/// The cell that was just divided or merged, and its parts; and the plane between them.
fn light(
    accel: &dyn Accel,
    film: &Film,
    at: u32,
    (wanted, cancel): (&Wanted, &Cancel),
    collected: &mut Collected,
) -> Result<(), Cancelled> {
    let Some(row) = film.just(at) else { return Ok(()) };
    let cells = film.outline().cells(accel, row, cancel)?;
    let Some(cell) = cells.last() else { return Ok(()) };
    let white = |cell: &Cell| placed(accel, cell.id.instance, cell.shape.bounds(), [u8::MAX; 4]);
    let overlay = &mut collected.overlay;
    accel.children(cell, &mut |part| {
        overlay.lit.push(white(&part));
        if overlay.lit.len() <= MOST_LIT { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    if overlay.lit.len() > MOST_LIT {
        overlay.lit.clear();
    }
    overlay.lit.push(white(cell));
    if let Some(Split::Axis { axis, pos }) = cell.split.filter(|_| wanted.settings.planes) {
        let plane = plane_in(cell.shape.bounds(), axis, pos);
        overlay.planes.push(placed(accel, cell.id.instance, &plane, theme::TRIED.to_array()));
    }
    Ok(())
}

impl Collector<'_> {
    /// Of a film it is told whether the cell is whole: then it is drawn, and nothing below it.
    fn visit(&mut self, accel: &dyn Accel, cell: &Cell, row: Option<Row>, whole: Option<bool>) -> Descend {
        let s = &self.wanted.settings;
        let bounds = bounds_in_scene(accel, cell);
        // What the section cuts away is as good as out of view.
        let Some(px) = self.ruler.pixels(&bounds).filter(|_| !self.is_cut_away(&bounds)) else {
            self.more |= !cell.is_leaf() && whole != Some(true);
            self.total += usize::from(self.wants_box(cell, whole));
            return Descend::No;
        };
        if self.wants_box(cell, whole) {
            self.total += 1;
            if px >= LEAST_PX {
                let value = self.value(cell, row);
                self.keep(Found { value, ..Found::new(cell, px) });
            }
        }
        if let Some(Split::Axis { axis, pos }) = cell.split
            && s.planes
            && whole.is_none()
            && (s.from_depth..=s.depth).contains(&cell.depth)
        {
            self.total += 1;
            let plane = plane_in(cell.shape.bounds(), axis, pos);
            if px >= LEAST_PX && !self.is_cut_away(&bounds_in_scene(accel, &Cell { shape: Shape::Box(plane), ..*cell })) {
                let (bounds, value) = (plane, self.value(cell, row));
                self.keep(Found { bounds, value, plane: true, ..Found::new(cell, px) });
            }
        }
        let by_settings = || s.leaves_only || cell.depth < s.depth || self.resolution.is_some();
        let deeper = whole.map_or_else(by_settings, |whole| !whole);
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

    fn limit(&self) -> usize {
        self.wanted.limit.max(1)
    }

    fn is_cut_away(&self, bounds: &Aabb) -> bool {
        self.wanted.view.section.is_some_and(|section| section.misses(bounds))
    }

    /// Leaves as many as are drawn.
    fn leave_the_first(&mut self) {
        let limit = self.limit();
        if self.found.len() > limit {
            self.found.select_nth_unstable_by_key(limit - 1, Found::order);
            self.found.truncate(limit);
        }
    }

    fn wants_box(&self, cell: &Cell, whole: Option<bool>) -> bool {
        let s = &self.wanted.settings;
        let leaf = cell.is_leaf();
        s.boxes
            && match cell.kind {
                CellKind::Void | CellKind::Leaf { prims: 0 } if !s.empty_cells => false,
                _ if let Some(whole) = whole => whole,
                _ if self.resolution.is_some() => leaf && self.in_slice(cell),
                _ if s.leaves_only => leaf,
                _ => (s.from_depth..=s.depth).contains(&cell.depth),
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

    /// The largest on the screen, as many as are drawn fluently, of those about as large some from
    /// everywhere; deeper levels over higher ones.
    fn finish(mut self, accel: &dyn Accel) -> Collected {
        self.leave_the_first();
        self.found.sort_by_key(|f| f.depth);
        let depths = self.found.iter().map(|f| f.depth);
        let shown = depths.clone().min().unwrap_or(0)..=depths.max().unwrap_or(0);
        let by_depth = self.wanted.settings.color == BoxColor::Depth;
        let values = self.found.iter().map(|f| f.value).filter(|value| value.is_finite());
        let [low, high] = values.fold([f32::INFINITY, f32::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
        let mut overlay = Overlay::default();
        for f in &self.found {
            let color = match () {
                () if by_depth => theme::depth_color(f.depth, &shown),
                () if f.value.is_finite() => theme::amount_color(f.value, [low, high]),
                () => theme::UNKNOWN,
            };
            let instance = placed(accel, f.instance, &f.bounds, color.to_array());
            if f.plane { overlay.planes.push(instance) } else { overlay.boxes.push(instance) }
        }
        overlay.planes.extend(self.wanted.view.section.map(|section| section_in(&section, accel.geometry().space().bounds())));
        let range = (!by_depth && low <= high).then_some([low, high]);
        Collected { overlay, shown: self.found.len(), total: self.total, more: self.more, range }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::Side;
    use crate::geometry::tri::TestKind;
    use crate::scene::{Camera, Geometry, LoadCx, Projection, open};
    use glam::Vec3;
    use std::sync::Arc;

    /// At most `limit` cells of a grid of many, all of it in view.
    fn cells_of_a_grid(projection: Projection, limit: usize) -> (Collected, Aabb) {
        let cx = LoadCx::unattended();
        let scene = open("builtin:soup?triangles=20000", &cx).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &cx).expect("fits"));
        let entry = registry::find("grid").expect("registered");
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
        let settings = OverlaySettings { boxes: true, planes: false, empty_cells: true, slice: 0, ..OverlaySettings::default() };
        let camera = Camera { eye: Vec3::new(0.3, 0.4, 1.0), target: Vec3::ZERO, up: Vec3::Y, projection };
        let view = View::new(&camera.reframed(geometry.world_bounds(), 1.0), geometry.space(), 1.0);
        let wanted =
            Wanted { settings, view, size_px: [1000, 1000], limit, top: None, numbered: false, counted: None, film_at: None };
        (collect(accel.as_ref(), (None, None, None), &wanted, &Cancel::new()).expect("not cancelled"), *geometry.bounds())
    }

    #[test]
    fn a_few_cells_of_a_grid_are_from_everywhere() {
        const LIMIT: usize = 1000;
        for projection in [Projection::Orthographic { height: 1.0 }, Projection::Perspective { fov_y: 0.1 }] {
            let (collected, bounds) = cells_of_a_grid(projection, LIMIT);
            assert_eq!(collected.shown, LIMIT);
            assert!(collected.total > 10 * LIMIT, "{}", collected.total);
            // Of four by four by four parts, how many cells are in each.
            let mut parts = [0; 64];
            for cell in &collected.overlay.boxes {
                let at = (cell.at(Vec3::splat(0.5)) - bounds.min) / bounds.size();
                let [x, y, z] = at.to_array().map(|x| (x * 4.0) as usize);
                parts[x + 4 * y + 16 * z] += 1;
            }
            assert!(parts.iter().all(|n| (4..=36).contains(n)), "{projection:?}: about 16 in each: {parts:?}");
        }
    }

    #[test]
    fn boxes_that_are_cut_away_are_left_out_and_the_plane_is_drawn() {
        let cx = LoadCx::unattended();
        let scene = open("builtin:teapot?triangles=1000", &cx).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &cx).expect("fits"));
        for id in ["bvh", "kdtree"] {
            let entry = registry::find(id).expect("registered");
            let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
            let settings = OverlaySettings { depth: 6, from_depth: 0, ..OverlaySettings::default() };
            let camera = scene.first_camera(geometry.world_bounds(), 1.0);
            let whole = View::new(&camera, geometry.space(), 1.0);
            let collected = |view: View| {
                let (size_px, limit, top, counted, film_at) = ([1000, 1000], 10_000, None, None, None);
                let wanted = Wanted { settings, view, size_px, limit, top, numbered: false, counted, film_at };
                collect(accel.as_ref(), (None, None, None), &wanted, &Cancel::new()).expect("not cancelled").overlay
            };
            let all = collected(whole);
            // No plane of a cell, so that rounding decides nothing.
            let at = |place: f32| geometry.bounds().min.x + place * geometry.bounds().size().x;
            for side in [Side::Below, Side::Above] {
                let section = HalfSpace { axis: Axis::X, at: at(0.5123), side };
                let left = collected(whole.within(Some(section)));
                let bounds = |b: &BoxInstance| Aabb { min: b.at(Vec3::ZERO), max: b.at(Vec3::ONE) };
                let expected: Vec<&BoxInstance> = all.boxes.iter().filter(|b| !section.misses(&bounds(b))).collect();
                assert_eq!(left.boxes.len(), expected.len(), "{id}");
                assert!(left.boxes.len() < all.boxes.len());
                let plane = bounds(left.planes.last().expect("drawn"));
                assert_eq!((plane.min.x, plane.max.x), (section.at, section.at));
                let planes = all.planes.iter().filter(|plane| !section.misses(&bounds(plane))).count();
                assert_eq!(left.planes.len(), planes + 1, "{id}");
            }
        }
    }

    #[test]
    fn the_larger_go_first() {
        let cell = |px: f32, rank: u32| Found { px, depth: 0, bounds: Aabb::EMPTY, instance: 0, plane: false, value: 0.0, rank };
        assert!(cell(20.0, 9).order() < cell(9.0, 1).order() && cell(10.0, 9).order() > cell(11.0, 1).order());
        assert_eq!(size_class(64.0_f32.next_down()), size_class(64.0_f32.next_up()));
    }
}
