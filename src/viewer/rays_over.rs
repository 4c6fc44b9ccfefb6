//! Draws marked rays over the view: where they run, and where they end.

use std::borrow::Cow;

use eframe::egui::{Color32, Painter, Pos2, Rect, Stroke, pos2};

use super::checks::{Mark, MarkKind};
use super::gpu::View;
use super::settings::Workspace;
use super::state::State;
use super::theme::{self, Marker, Palette};
use crate::geometry::Space;
use glam::{DVec3, Vec3};

/// Draws them in `rect`, which shows `view`.
pub fn paint(painter: &Painter, rect: Rect, marks: &[Mark], view: &View, space: &Space, palette: &Palette) {
    for mark in marks {
        let color = color(mark.kind, palette);
        let Some([from, to]) = in_view(mark, view, space, rect) else { continue };
        if from.distance(to) > theme::MARK {
            for stroke in [Stroke::new(theme::RAY_HALO, theme::plate(palette)), Stroke::new(theme::CURVE, color)] {
                painter.line_segment([from, to], stroke);
            }
            painter.circle_filled(from, theme::RAY_HALO, color);
        }
        let marker = if mark.kind == MarkKind::Wrong { Marker::Cross } else { Marker::Ring };
        if mark.kind != MarkKind::Plain {
            marker.paint(painter, to, theme::MARK + theme::RAY_HALO, theme::plate(palette));
            marker.paint(painter, to, theme::MARK, color);
        }
    }
}

/// The rays that are marked in the present workspace.
pub fn marks(state: &State) -> Cow<'_, [Mark]> {
    match state.settings.workspace {
        Workspace::Check => Cow::Borrowed(&state.checks.marks),
        Workspace::Ray => Cow::Owned(state.rays.marks()),
        Workspace::View | Workspace::Structure | Workspace::Compare => Cow::Borrowed(&[]),
    }
}

/// The colour of a marked ray.
pub const fn color(kind: MarkKind, palette: &Palette) -> Color32 {
    match kind {
        MarkKind::Wrong => palette.fail,
        MarkKind::Rounded => palette.warn,
        MarkKind::Plain => palette.accent_text,
        MarkKind::Here => palette.text,
    }
}

/// Both ends of what is seen of a ray, in points of the window; `None` if nothing is.
fn in_view(mark: &Mark, view: &View, space: &Space, rect: Rect) -> Option<[Pos2; 2]> {
    Some(before_eye(ends(mark, view, space)?, view)?.map(|p| on_screen(p, view, rect)))
}

/// Both ends of a ray, as [`View::seen`] says; `None` if they are nowhere.
pub fn ends(mark: &Mark, view: &View, space: &Space) -> Option<[Vec3; 2]> {
    let (o, d) = (mark.ray.origin.as_dvec3(), mark.ray.dir.as_dvec3());
    let at = |t: f64| o + d * t;
    let from = f64::from(mark.ray.tmin);
    let to = if mark.t.is_finite() { f64::from(mark.t) } else { f64::from(mark.ray.tmax).min(far(o, d, space)) };
    let both = [at(from), at(to)].map(|p| view.seen(space.point(p.as_vec3())));
    both.iter().all(|end| end.is_finite()).then_some(both)
}

/// The part of a segment that is before the eye, its ends as [`View::seen`] says.
pub fn before_eye([a, b]: [Vec3; 2], view: &View) -> Option<[Vec3; 2]> {
    let [near, _] = view.range;
    match (a.z >= near, b.z >= near) {
        (false, false) => None,
        (true, true) => Some([a, b]),
        (false, true) => Some([b + (a - b) * ((b.z - near) / (b.z - a.z)), b]),
        (true, false) => Some([a, a + (b - a) * ((a.z - near) / (a.z - b.z))]),
    }
}

/// Beyond this t a ray has left the scene, and some way more.
fn far(o: DVec3, d: DVec3, space: &Space) -> f64 {
    let corners = space.bounds().corners().map(|p| space.world_point(p).as_dvec3());
    let away = corners.into_iter().map(|p| p.distance(o)).fold(0.0, f64::max);
    1.05 * away / d.length().max(f64::MIN_POSITIVE)
}

fn on_screen(p: Vec3, view: &View, rect: Rect) -> Pos2 {
    let ndc = p.truncate() / (view.half_size * if view.orthographic { 1.0 } else { p.z });
    pos2(rect.center().x + 0.5 * ndc.x * rect.width(), rect.center().y - 0.5 * ndc.y * rect.height())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::{Aabb, Ray};
    use crate::scene::{Camera, Projection};

    #[test]
    fn a_ray_is_cut_off_at_the_eye_and_ends_where_it_hits() {
        let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
        let space = Space::new(&bounds);
        let projection = Projection::Perspective { fov_y: 1.0 };
        let camera = Camera { eye: Vec3::Z * 4.0, target: Vec3::ZERO, up: Vec3::Y, projection };
        let view = View::new(&camera, &space, 1.0);
        let rect = Rect::from_min_max(pos2(100.0, 100.0), pos2(300.0, 300.0));
        let seen = |origin: Vec3, dir: Vec3, t: f32| {
            in_view(&Mark { ray: Ray::new(origin, dir), t, kind: MarkKind::Plain }, &view, &space, rect)
        };
        let [from, to] = seen(Vec3::NEG_X, Vec3::X, 1.0).expect("in sight");
        assert_eq!(to, rect.center());
        assert!(from.x < to.x - 20.0 && (from.y - to.y).abs() < 1e-3);
        // From behind the eye towards the middle.
        let [from, to] = seen(Vec3::new(0.5, 0.0, 6.0), Vec3::new(-0.5, 0.0, -6.0), 1.0).expect("a part is in sight");
        assert!(from.is_finite() && from.x > to.x && to == rect.center());
        assert_eq!(seen(Vec3::Z * 6.0, Vec3::Z, f32::INFINITY), None);
    }
}
