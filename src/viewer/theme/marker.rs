//! The shapes that stand for the families of structures in tables, plots and legends.

use eframe::egui::{Color32, Painter, Pos2, Rect, Shape, Stroke, Vec2, pos2};

/// A shape that stands for a family of structures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Marker {
    /// A filled circle.
    Circle,
    /// A filled square standing on a corner.
    Diamond,
    /// A filled square.
    Square,
    /// A filled triangle, point up.
    Triangle,
    /// Two crossing strokes.
    Cross,
    /// A circle, not filled.
    Ring,
}

impl Marker {
    /// Draws it around `centre`; `size` is the diameter of the circle, and the others are made to
    /// look as heavy as it.
    pub fn paint(self, painter: &Painter, centre: Pos2, size: f32, color: Color32) {
        painter.add(self.shape(centre, size, color));
    }

    fn shape(self, c: Pos2, size: f32, color: Color32) -> Shape {
        let r = size * 0.5;
        let stroke = Stroke::new(size * 0.22, color);
        match self {
            Self::Circle => Shape::circle_filled(c, r, color),
            Self::Ring => Shape::circle_stroke(c, r - stroke.width * 0.5, stroke),
            Self::Square => Shape::rect_filled(Rect::from_center_size(c, Vec2::splat(size * 0.88)), 0.0, color),
            Self::Diamond => polygon(&[(0.0, -1.2), (1.2, 0.0), (0.0, 1.2), (-1.2, 0.0)], c, r, color),
            Self::Triangle => polygon(&[(0.0, -1.15), (1.15, 0.85), (-1.15, 0.85)], c, r, color),
            Self::Cross => {
                let arm = |x: f32, y: f32| [pos2(c.x - x * r, c.y - y * r), pos2(c.x + x * r, c.y + y * r)];
                let stroke = Stroke::new(size * 0.26, color);
                Shape::Vec(vec![Shape::line_segment(arm(0.8, 0.8), stroke), Shape::line_segment(arm(0.8, -0.8), stroke)])
            }
        }
    }
}

/// A filled convex shape of corners in units of `r` around `c`.
fn polygon(corners: &[(f32, f32)], c: Pos2, r: f32, color: Color32) -> Shape {
    let points = corners.iter().map(|(x, y)| pos2(c.x + x * r, c.y + y * r)).collect();
    Shape::convex_polygon(points, color, Stroke::NONE)
}
