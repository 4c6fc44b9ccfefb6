//! One picture with boxes, planes, other forms and rays over it as lines, those behind a surface dashed.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::sync::Arc;

use base64::Engine;
use eframe::egui::Theme;
use glam::{Vec2, Vec3};

use super::{clip, png};
use crate::geometry::Space;
use crate::geometry::num::floor_index;
use crate::render::Picture;
use crate::task::Cancel;
use crate::viewer::checks::Mark;
use crate::viewer::gpu::{BoxInstance, Overlay, View};
use crate::viewer::rays_over;
use crate::viewer::theme::{DASH_PT, LineStyle, PLANE_FILL, Palette};

/// A piece of a line is looked at for each so many pixels of it, whether it is hidden.
const STEP_PX: f32 = 3.0;
/// Pieces of one line, at most.
const PIECES: usize = 512;
/// What is farther than the surface by less than this share is on it.
const ON_SURFACE: f32 = 2e-4;

/// A picture and what lies over it.
pub struct Drawing {
    /// The picture.
    pub picture: Arc<Picture>,
    /// Boxes and what else lies over it.
    pub overlay: Option<Arc<Overlay>>,
    /// Rays that are marked.
    pub marks: Vec<Mark>,
    /// From where it is seen.
    pub view: View,
    /// The space of what is drawn.
    pub space: Space,
    /// Columns and rows.
    pub size: [u32; 2],
    /// From where on boxes are drawn, as a part of the width.
    pub begin: f32,
    /// Whether what is behind a surface is drawn.
    pub hidden_lines: bool,
}

impl Drawing {
    /// Writes it as elements of an SVG, from its upper left corner on.
    ///
    /// # Errors
    /// In words; there is none that an ordinary picture gives, but that it was stopped.
    pub fn write(&self, out: &mut String, cancel: &Cancel) -> Result<(), String> {
        let [width, height] = self.size;
        let picture = base64::engine::general_purpose::STANDARD.encode(png(&self.picture)?);
        let _ = write!(
            out,
            "<image width=\"{width}\" height=\"{height}\" preserveAspectRatio=\"none\" href=\"data:image/png;base64,{picture}\"/>\n\
             <g fill=\"none\" stroke-linecap=\"round\">\n"
        );
        if let Some(overlay) = &self.overlay {
            // What is within is cut at its sides.
            let begin = (self.begin * width as f32).round();
            let rest = width as f32 - begin;
            let _ =
                writeln!(out, "<svg x=\"{begin}\" width=\"{rest}\" height=\"{height}\" viewBox=\"{begin} 0 {rest} {height}\">");
            self.boxes(overlay, out, cancel)?;
            out.push_str("</svg>\n");
        }
        self.rays(out);
        out.push_str("</g>\n");
        Ok(())
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
        let boxes = overlay.boxes.iter().chain(&overlay.planes).chain(&overlay.tried);
        self.by_color(boxes.chain(&overlay.lines).chain(&overlay.compared), &LineStyle::BOX, go_on, out)?;
        let lit = overlay.lit.iter().chain(&overlay.lit_lines);
        let lit = lit.chain(&overlay.selected).chain(&overlay.selected_lines);
        self.by_color(lit, &LineStyle::SELECTED, go_on, out)
    }

    /// The inside of a plane.
    pub(super) fn fill_plane(&self, plane: &BoxInstance, out: &mut String) {
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
    pub(super) fn edges(&self, instance: &BoxInstance, lines: &mut Lines) {
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

    /// The edges of boxes in one style.
    fn by_color<'a>(
        &self,
        boxes: impl Iterator<Item = &'a BoxInstance>,
        style: &LineStyle,
        go_on: impl Fn() -> Result<(), String>,
        out: &mut String,
    ) -> Result<(), String> {
        let mut by_color: BTreeMap<[u8; 4], Lines> = BTreeMap::new();
        for instance in boxes {
            go_on()?;
            self.edges(instance, by_color.entry(instance.color).or_default());
        }
        for ([r, g, b, _], lines) in &by_color {
            self.strokes(lines, style, [*r, *g, *b], out);
        }
        Ok(())
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

/// Paths of lines in one colour.
#[derive(Default)]
pub(super) struct Lines {
    pub(super) visible: String,
    pub(super) hidden: String,
}

/// The two directions in which a flat box is not flat.
fn flat_sides(plane: &BoxInstance) -> [Vec3; 2] {
    let mut sides = [Vec3::X, Vec3::Y, Vec3::Z].into_iter().enumerate();
    let mut next = || sides.find(|(axis, _)| plane.edges[*axis] != [0.0; 3]).map_or(Vec3::ZERO, |side| side.1);
    [next(), next()]
}
