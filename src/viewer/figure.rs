//! The view as a figure: the traced picture with boxes, planes, other forms and rays over it as lines, those behind a surface
//! dashed, and a caption that says what it shows.

mod clip;
#[cfg(test)]
mod tests;

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

use base64::Engine;
use eframe::egui::Theme;
use glam::{Vec2, Vec3};

use super::checks::Mark;
use super::format;
use super::gpu::{BoxInstance, Overlay, View};
use super::rays_over;
use super::state::State;
use super::theme::{self, DASH_PT, LineStyle, PLANE_FILL, Palette};
use crate::accel::cell::Layout;
use crate::geometry::Space;
use crate::geometry::num::floor_index;
use crate::render::{self, Picture};
use crate::task::Cancel;

/// What is drawn.
pub struct Figure {
    picture: Arc<Picture>,
    overlay: Option<Arc<Overlay>>,
    marks: Vec<Mark>,
    view: View,
    space: Space,
    /// Columns and rows.
    size: [u32; 2],
    hidden_lines: bool,
    caption: String,
}

/// A piece of a line is looked at for each so many pixels of it, whether it is hidden.
const STEP_PX: f32 = 3.0;
/// Pieces of one line, at most.
const PIECES: usize = 512;
/// What is farther than the surface by less than this share is on it.
const ON_SURFACE: f32 = 2e-4;

impl Figure {
    /// The present view; `None` while there is no picture.
    pub fn of(state: &State) -> Option<Self> {
        let (model, picture) = (state.model.as_ref()?, state.on_screen()?);
        let [width, height] = state.size_px;
        let space = *model.geometry.space();
        let section = state.section().map(|section| section.scaled(&space));
        Some(Self {
            picture: Arc::clone(picture),
            overlay: state.shown.as_ref().and(state.overlay.clone()),
            marks: rays_over::marks(state).into_owned(),
            view: View::new(&picture.camera, &space, width as f32 / height.max(1) as f32).within(section),
            space,
            size: [width.max(1), height.max(1)],
            hidden_lines: state.settings.overlay.hidden_lines,
            caption: caption(state),
        })
    }

    /// As SVG.
    ///
    /// # Errors
    /// In words; there is none that an ordinary picture gives, but that it was stopped.
    pub fn svg(&self, cancel: &Cancel) -> Result<Vec<u8>, String> {
        let [width, height] = self.size;
        let picture = base64::engine::general_purpose::STANDARD.encode(png(&self.picture)?);
        let (caption, below) = (escaped(&self.caption), height + CAPTION_PX);
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{below}\" viewBox=\"0 0 {width} {below}\">\n\
             <title>{caption}</title>\n<rect width=\"{width}\" height=\"{below}\" fill=\"white\"/>\n\
             <svg width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <image width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{picture}\"/>\n\
             <g fill=\"none\" stroke-linecap=\"round\">\n"
        );
        if let Some(overlay) = &self.overlay {
            self.boxes(overlay, &mut out, cancel)?;
        }
        self.rays(&mut out);
        let middle = height + CAPTION_PX * 2 / 3;
        let _ = write!(
            out,
            "</g>\n</svg>\n<text x=\"{}\" y=\"{middle}\" font-family=\"sans-serif\" font-size=\"{}\">{caption}</text>\n</svg>\n",
            theme::GUTTER,
            theme::BODY
        );
        Ok(out.into_bytes())
    }

    /// Boxes, planes and lines by colour, then what stands out over all.
    fn boxes(&self, overlay: &Overlay, out: &mut String, cancel: &Cancel) -> Result<(), String> {
        let go_on = || cancel.check().map_err(|_| "Stopped.".to_owned());
        for plane in overlay.planes.iter().chain(&overlay.tried) {
            go_on()?;
            self.fill_plane(plane, out);
        }
        for triangle in &overlay.fills {
            go_on()?;
            self.fill_triangle(triangle, out);
        }
        let mut by_color: BTreeMap<[u8; 4], Lines> = BTreeMap::new();
        let boxes = overlay.boxes.iter().chain(&overlay.planes).chain(&overlay.tried);
        for instance in boxes.chain(&overlay.lines).chain(&overlay.compared) {
            go_on()?;
            self.edges(instance, by_color.entry(instance.color).or_default());
        }
        for (color, lines) in &by_color {
            self.strokes(lines, &LineStyle::BOX, [color[0], color[1], color[2]], out);
        }
        let mut lines = Lines::default();
        let lit = overlay.lit.iter().chain(&overlay.lit_lines);
        for instance in lit.chain(&overlay.selected).chain(&overlay.selected_lines) {
            go_on()?;
            self.edges(instance, &mut lines);
        }
        self.strokes(&lines, &LineStyle::SELECTED, LineStyle::SELECTED.color.unwrap_or_default(), out);
        Ok(())
    }

    /// The inside of a plane.
    fn fill_plane(&self, plane: &BoxInstance, out: &mut String) {
        let [a, b] = flat_sides(plane);
        self.fill(&[Vec3::ZERO, a, a + b, b].map(|along| plane.at(along)), plane.color, out);
    }

    /// The inside of a triangle.
    fn fill_triangle(&self, triangle: &BoxInstance, out: &mut String) {
        self.fill(&[Vec3::ZERO, Vec3::X, Vec3::Y].map(|along| triangle.at(along)), triangle.color, out);
    }

    /// What the section leaves of a convex polygon, if all of that is before the eye.
    fn fill(&self, corners: &[Vec3], [r, g, b, _]: [u8; 4], out: &mut String) {
        let corners = clip::polygon(self.view.section.as_ref(), corners);
        let seen: Vec<Vec3> = corners.into_iter().map(|corner| self.view.seen(corner)).collect();
        if seen.is_empty() || !seen.iter().all(|corner| corner.z >= self.view.range[0]) {
            return;
        }
        let points: String = seen.iter().map(|c| self.on_figure(*c)).map(|p| format!("{:.1},{:.1} ", p.x, p.y)).collect();
        let _ = writeln!(
            out,
            "<polygon points=\"{}\" fill=\"#{r:02x}{g:02x}{b:02x}\" fill-opacity=\"{PLANE_FILL}\"/>",
            points.trim_end()
        );
    }

    /// The edges of a box, of a flat one those of its face, of a line the one that it is; as far as the section leaves them.
    fn edges(&self, instance: &BoxInstance, lines: &mut Lines) {
        let thick = |axis: usize| instance.edges[axis] != [0.0; 3];
        for axis in (0..3).filter(|axis| thick(*axis)) {
            let others = [(axis + 1) % 3, (axis + 2) % 3];
            for corner in 0..4usize {
                // An edge along which there is nothing would be drawn twice.
                if (0..2).any(|k| corner >> k & 1 == 1 && !thick(others[k])) {
                    continue;
                }
                let mut from = Vec3::ZERO;
                (0..2).for_each(|k| from[others[k]] = (corner >> k & 1) as f32);
                let mut to = from;
                to[axis] = 1.0;
                let ends = [from, to].map(|along| instance.at(along));
                if let Some(ends) = clip::line(self.view.section.as_ref(), ends) {
                    self.line(ends.map(|end| self.view.seen(end)), lines);
                }
            }
        }
    }

    /// Cuts a line where it goes behind a surface or comes out again.
    fn line(&self, ends: [Vec3; 2], lines: &mut Lines) {
        let Some([a, b]) = rays_over::before_eye(ends, &self.view) else { return };
        let [pa, pb] = [a, b].map(|p| self.on_figure(p));
        let size = Vec2::new(self.size[0] as f32, self.size[1] as f32);
        if !pa.is_finite() || !pb.is_finite() || pa.max(pb).min_element() < 0.0 || (pa.min(pb) - size).max_element() > 0.0 {
            return;
        }
        let pieces = floor_index(f64::from(pa.distance(pb) / STEP_PX), PIECES).max(1);
        let at = |i: usize| a + (b - a) * (i as f32 / pieces as f32);
        let mut start = 0;
        let mut hidden = self.is_hidden((a + at(1)) * 0.5);
        for i in 1..=pieces {
            let next = if i < pieces { self.is_hidden((at(i) + at(i + 1)) * 0.5) } else { !hidden };
            if next != hidden {
                let [from, to] = [start, i].map(|i| self.on_figure(at(i)));
                let path = if hidden { &mut lines.hidden } else { &mut lines.visible };
                let _ = write!(path, "M{:.1} {:.1}L{:.1} {:.1}", from.x, from.y, to.x, to.y);
                (start, hidden) = (i, next);
            }
        }
    }

    /// Whether a surface of the picture is in front of a point, at its pixel and at those beside: on a slanted surface the depth
    /// changes from one to the next, and a line that lies on it would come and go. The window draws by the same rule.
    fn is_hidden(&self, p: Vec3) -> bool {
        let at = self.on_figure(p) / Vec2::new(self.size[0] as f32, self.size[1] as f32);
        if !(0.0..1.0).contains(&at.x) || !(0.0..1.0).contains(&at.y) {
            return false;
        }
        let (columns, rows) = (self.picture.width as usize, self.picture.height as usize);
        let index = |share: f32, n: usize| floor_index(f64::from(share) * n as f64, n.saturating_sub(1));
        let (x, y) = (index(at.x, columns), index(at.y, rows));
        let behind = |x: usize, y: usize| {
            let depth = self.picture.depth.get(y.min(rows.saturating_sub(1)) * columns + x.min(columns.saturating_sub(1)));
            depth.is_some_and(|depth| p.z > depth * (1.0 + ON_SURFACE))
        };
        let beside = [(x + 1, y), (x.saturating_sub(1), y), (x, y + 1), (x, y.saturating_sub(1))];
        behind(x, y) && beside.into_iter().all(|(x, y)| behind(x, y))
    }

    /// Where a point that is seen stands on the figure, in pixels from the upper left corner.
    fn on_figure(&self, p: Vec3) -> Vec2 {
        let view = &self.view;
        let ndc = p.truncate() / (view.half_size * if view.orthographic { 1.0 } else { p.z });
        Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * Vec2::new(self.size[0] as f32, self.size[1] as f32)
    }

    /// Hidden parts, halos, lines.
    fn strokes(&self, lines: &Lines, style: &LineStyle, [r, g, b]: [u8; 3], out: &mut String) {
        let [dash, gap] = DASH_PT;
        let color = format!("#{r:02x}{g:02x}{b:02x}");
        if !lines.hidden.is_empty() && (self.hidden_lines || style.on_top) {
            let (width, alpha, d) = (style.hidden_width, style.hidden_alpha, &lines.hidden);
            let _ = writeln!(
                out,
                "<path d=\"{d}\" stroke=\"{color}\" stroke-width=\"{width}\" stroke-opacity=\"{alpha}\" stroke-dasharray=\"{dash} {gap}\"/>"
            );
        }
        if !lines.visible.is_empty() {
            let ([hr, hg, hb], d) = (style.halo, &lines.visible);
            let (halo, alpha, width) = (style.halo_width, style.halo_alpha, style.width);
            let _ = writeln!(
                out,
                "<path d=\"{d}\" stroke=\"#{hr:02x}{hg:02x}{hb:02x}\" stroke-width=\"{halo}\" stroke-opacity=\"{alpha}\"/>\n\
                 <path d=\"{d}\" stroke=\"{color}\" stroke-width=\"{width}\"/>"
            );
        }
    }

    /// Marked rays.
    fn rays(&self, out: &mut String) {
        let palette = Palette::of(Theme::Dark);
        for mark in &self.marks {
            let Some(ends) = rays_over::ends(mark, &self.view, &self.space) else { continue };
            let mut lines = Lines::default();
            self.line(ends, &mut lines);
            let [r, g, b, _] = rays_over::color(mark.kind, palette).to_array();
            let style = LineStyle { on_top: true, ..LineStyle::BOX };
            self.strokes(&lines, &style, [r, g, b], out);
        }
    }
}

/// Pixels below the picture.
const CAPTION_PX: u32 = 28;

/// Paths of lines in one colour.
#[derive(Default)]
struct Lines {
    visible: String,
    hidden: String,
}

/// The two directions in which a flat box is not flat.
fn flat_sides(plane: &BoxInstance) -> [Vec3; 2] {
    let mut sides = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate();
    let mut next = || sides.find(|(axis, _)| plane.edges[*axis] != [0.0; 3]).map_or(Vec3::ZERO, |side| side.1);
    [next(), next()]
}

/// `BVH, boxes at depth 3, SAH cost 31.2. builtin:teapot, 1 000 triangles.`; while a film of the build is shown, where that stands
/// and the cost there.
fn caption(state: &State) -> String {
    let overlay = &state.settings.overlay;
    let mut text = state.shown.as_ref().map_or_else(String::new, |shown| shown.key.entry.name.to_owned());
    let is_tree = !matches!(state.layout(), Some(Layout::Flat { .. } | Layout::Nested { .. }));
    let film = state.film_on_screen();
    if let Some((film, at)) = film {
        let [at, last] = [at, film.last()].map(|event| format::count(event.into()));
        text += &format!(", reconstructed order, event {at} of {last}");
    } else if overlay.boxes && overlay.leaves_only {
        text += ", boxes of leaves";
    } else if overlay.boxes && is_tree {
        let to = overlay.depth;
        text += &match overlay.from_depth {
            from if from < to => format!(", boxes at depths {from} to {to}"),
            _ => format!(", boxes at depth {to}"),
        };
    } else if overlay.boxes {
        text += ", cells";
    }
    let finished = state.shown.as_ref().and_then(|shown| shown.stats.as_ref()).map(|stats| stats.sah);
    if let Some(cost) = film.map(|(film, at)| film.cost(at)).or(finished) {
        text += &format!(", SAH cost {}", format::number(cost));
    }
    if let Some(model) = &state.model {
        text += &format!(". {}, {} triangles.", model.scene.name, format::count(model.geometry.counts().live));
    }
    text
}

/// The bytes of a picture as a PNG file.
///
/// # Errors
/// In words; there is none that an ordinary picture gives.
pub fn png(picture: &Picture) -> Result<Vec<u8>, String> {
    encoded(&picture.rgba, [picture.width, picture.height])
}

/// The same of four bytes a pixel, as [`render::png`] takes them.
///
/// # Errors
/// In words, if there are not as many bytes.
pub fn encoded(rgba: &[u8], size: [u32; 2]) -> Result<Vec<u8>, String> {
    render::png(rgba, size).map_err(|why| format!("Can't make the picture: {why}."))
}

/// Text between tags.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
