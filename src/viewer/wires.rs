//! The lines that a cell is drawn with: edges of polyhedra, circles of spheres.

use std::f64::consts::TAU;

use super::gpu::{BoxInstance, View};
use super::overlay::placed;
use crate::accel::Accel;
use crate::accel::cell::{Cell, Form, Level};
use crate::geometry::Polyhedron;
use glam::{DAffine3, DVec3};

/// A cell over the picture.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Wires {
    /// Its box, if it is one.
    pub boxed: Option<BoxInstance>,
    /// Its lines otherwise.
    pub lines: Vec<BoxInstance>,
}

/// The circles of a sphere: three in the planes of the axes, and its outline.
const CIRCLES: usize = 4;
/// Sides of a circle of a sphere that stands alone.
pub const ROUND: usize = 96;

/// Sides of a circle of so many pixels across: straight lines of about twelve pixels.
pub fn sides(px: f32) -> usize {
    ((0.25 * px) as usize).clamp(12, ROUND)
}

/// How many lines a form takes, with circles of so many sides.
pub fn line_count(form: &Form, sides: usize) -> usize {
    match form {
        Form::Box(_) => 12,
        Form::Sphere { .. } => CIRCLES * sides,
        Form::Polyhedron(polyhedron) => polyhedron.edges().count(),
    }
}

/// What is drawn of a cell that stands out.
pub fn of_cell(accel: &dyn Accel, cell: &Cell, view: &View, color: [u8; 4]) -> Wires {
    of_form(accel, cell.id.instance, &accel.form(cell), (view, ROUND), color)
}

/// What is drawn of a form in the space of a level (see [`crate::accel::CellId`]), as it is seen in a view; circles have so many
/// sides.
pub fn of_form(accel: &dyn Accel, instance: u32, form: &Form, seen: (&View, usize), color: [u8; 4]) -> Wires {
    match form {
        Form::Box(bounds) => Wires { boxed: Some(placed(accel, instance, bounds, color)), lines: Vec::new() },
        _ => Wires { boxed: None, lines: lines_of(accel, instance, form, seen, color) },
    }
}

/// The same of a form that may be a box, as lines in any case.
pub fn lines_of(
    accel: &dyn Accel,
    instance: u32,
    form: &Form,
    (view, sides): (&View, usize),
    color: [u8; 4],
) -> Vec<BoxInstance> {
    let map = scene_from(accel, instance);
    let line = |[a, b]: [DVec3; 2]| {
        let [a, b] = [a, b].map(|p| map.transform_point3(p).as_vec3());
        BoxInstance::line(a, b, color)
    };
    match form {
        Form::Box(bounds) => Polyhedron::of_box(bounds).edges().map(line).collect(),
        Form::Sphere { centre, radius } => {
            circles(*centre, *radius, &eye(view, &map)).flat_map(|circle| circle.lines(sides)).map(line).collect()
        }
        Form::Polyhedron(polyhedron) => polyhedron.edges().map(line).collect(),
    }
}

/// A convex polygon in the space of a level: the triangles that fill it, and the lines around it.
pub fn of_polygon(accel: &dyn Accel, instance: u32, polygon: &[DVec3], color: [u8; 4]) -> [Vec<BoxInstance>; 2] {
    let map = scene_from(accel, instance);
    let corners: Vec<_> = polygon.iter().map(|p| map.transform_point3(*p).as_vec3()).collect();
    let Some((first, rest)) = corners.split_first() else { return Default::default() };
    let fills = rest.windows(2).map(|pair| BoxInstance::triangle([*first, pair[0], pair[1]], color)).collect();
    let next = corners.iter().cycle().skip(1);
    let lines = corners.iter().zip(next).map(|(a, b)| BoxInstance::line(*a, *b, color)).collect();
    [fills, lines]
}

/// From the space of a level to the scene's scaled space.
fn scene_from(accel: &dyn Accel, instance: u32) -> DAffine3 {
    match accel.level(instance) {
        Some(Level { instance: Some(_), scene_from_level }) => scene_from_level,
        _ => DAffine3::IDENTITY,
    }
}

/// From where spheres are seen, in the space that they are in.
enum Eye {
    At(DVec3),
    /// From far away, along this direction.
    Along(DVec3),
}

fn eye(view: &View, scene_from_level: &DAffine3) -> Eye {
    let level_from_scene = scene_from_level.inverse();
    if view.orthographic {
        Eye::Along(level_from_scene.transform_vector3(view.forward.as_dvec3()))
    } else {
        Eye::At(level_from_scene.transform_point3(view.eye.as_dvec3()))
    }
}

/// A circle about `centre` through `centre + u` and `centre + v`, which are at a right angle.
struct Circle {
    centre: DVec3,
    u: DVec3,
    v: DVec3,
}

impl Circle {
    /// In the plane upright on a direction of some length.
    fn upright(centre: DVec3, radius: f64, normal: DVec3) -> Option<Self> {
        let (u, v) = normal.try_normalize()?.any_orthonormal_pair();
        Some(Self { centre, u: u * radius, v: v * radius })
    }

    fn lines(self, sides: usize) -> impl Iterator<Item = [DVec3; 2]> {
        let at = move |i: usize| {
            let (sin, cos) = (TAU * (i % sides) as f64 / sides as f64).sin_cos();
            self.centre + self.u * cos + self.v * sin
        };
        (0..sides).map(move |i| [at(i), at(i + 1)])
    }
}

/// The circles that a sphere is drawn with; from within it has no outline.
fn circles(centre: DVec3, radius: f64, eye: &Eye) -> impl Iterator<Item = Circle> {
    let great = DVec3::AXES.into_iter().filter_map(move |axis| Circle::upright(centre, radius, axis));
    let outline = match *eye {
        Eye::Along(direction) => Circle::upright(centre, radius, direction),
        Eye::At(eye) => {
            // Where lines from the eye touch: nearer than the centre by as much as the square of the radius over the distance.
            let towards = eye - centre;
            let part = radius * radius / towards.length_squared();
            let small = (part < 1.0).then(|| Circle::upright(centre + towards * part, radius * (1.0 - part).sqrt(), towards));
            small.flatten()
        }
    };
    great.chain(outline)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn circles_lie_on_the_sphere_and_lines_from_the_eye_touch_its_outline() {
        let (centre, radius, from) = (DVec3::new(0.1, 0.2, 0.3), 0.5, DVec3::new(2.0, 1.0, -1.0));
        let on = |p: DVec3| (p.distance(centre) - radius).abs() < 1e-12;
        let all: Vec<Circle> = circles(centre, radius, &Eye::At(from)).collect();
        assert_eq!(all.len(), CIRCLES);
        for (i, circle) in all.into_iter().enumerate() {
            let lines: Vec<_> = circle.lines(16).collect();
            assert!(lines.len() == 16 && lines.iter().flatten().all(|p| on(*p)));
            assert!(lines.windows(2).all(|pair| pair[0][1] == pair[1][0]) && lines[15][1] == lines[0][0]);
            let touches = |p: DVec3| (p - centre).dot(p - from).abs() < 1e-12;
            assert_eq!(lines.iter().all(|line| touches(line[0])), i == 3);
        }
        assert_eq!(circles(centre, radius, &Eye::At(centre + DVec3::X * 0.1)).count(), 3, "no outline from within");
        assert_eq!(circles(centre, radius, &Eye::Along(DVec3::Z)).count(), CIRCLES);
    }

    #[test]
    fn circles_are_as_round_as_they_are_large() {
        assert_eq!([0.0, 100.0, 1e9, f32::NAN].map(sides), [12, 25, ROUND, 12]);
    }
}
