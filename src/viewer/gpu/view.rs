//! From where and how the scene is seen, in the scaled space that geometry is stored in.

use glam::{Vec2, Vec3};

use crate::geometry::{Aabb, HalfSpace, Space, num::narrow};
use crate::scene::{Camera, Projection};

/// A camera in the scaled space, with the range of depths that the scene takes up.
///
/// Linear depth is the distance from the eye along `forward`; traced pictures, the raster preview
/// and everything drawn over them compare this one number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct View {
    /// Where it stands.
    pub eye: Vec3,
    /// To the right of the picture; of unit length, as the other two axes.
    pub right: Vec3,
    /// To the top of the picture.
    pub up: Vec3,
    /// Into the picture.
    pub forward: Vec3,
    /// Half the width and half the height of the picture: at unit distance for a perspective, in
    /// the scaled space for an orthographic view.
    pub half_size: Vec2,
    /// Whether rays are parallel.
    pub orthographic: bool,
    /// The least and the greatest linear depth that is drawn: positive and apart. A perspective has
    /// no far end.
    pub range: [f32; 2],
    /// What of the scaled space is seen, if not all of it.
    pub section: Option<HalfSpace>,
}

impl View {
    /// The camera's view of a scene; `aspect` is width over height.
    pub fn new(camera: &Camera, space: &Space, aspect: f32) -> Self {
        let frame = camera.frame();
        let half_size = camera.half_size(aspect);
        let orthographic = matches!(camera.projection, Projection::Orthographic { .. });
        let to_scaled = |length: f32| narrow(f64::from(length) * space.scale());
        let eye = space.point(camera.eye);
        let target_distance = (space.point(camera.target) - eye).length();
        Self {
            eye,
            right: frame.right,
            up: frame.up,
            forward: frame.forward,
            half_size: if orthographic { half_size.to_array().map(to_scaled).into() } else { half_size },
            orthographic,
            range: depth_range(eye, frame.forward, space.bounds(), orthographic, target_distance),
            section: None,
        }
    }

    /// The same where only a part of the scaled space is seen.
    pub fn within(self, section: Option<HalfSpace>) -> Self {
        Self { section, ..self }
    }

    /// To the right, to the top, and into the picture from the eye.
    pub fn seen(&self, p: Vec3) -> Vec3 {
        let d = p - self.eye;
        Vec3::new(d.dot(self.right), d.dot(self.up), d.dot(self.forward))
    }

    /// The pixel that a point falls on, from the upper left corner, and its linear depth; `None` for
    /// what is not in front of the eye. The pixel may lie outside the picture.
    pub fn project(&self, p: Vec3, size_px: [u32; 2]) -> Option<(Vec2, f32)> {
        let v = self.seen(p);
        if v.z <= 0.0 {
            return None;
        }
        let ndc = v.truncate() / (self.half_size * if self.orthographic { 1.0 } else { v.z });
        let size = Vec2::new(size_px[0] as f32, size_px[1] as f32);
        Some((Vec2::new(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * size, v.z))
    }

    /// What one of `rows` rows of the picture spans: at unit depth for a perspective, anywhere for
    /// an orthographic view; in the scaled space.
    pub fn row_span(&self, rows: f32) -> f32 {
        2.0 * self.half_size.y / rows.max(1.0)
    }
}

/// The depths that the depth buffer must tell apart.
fn depth_range(eye: Vec3, forward: Vec3, bounds: &Aabb, orthographic: bool, target_distance: f32) -> [f32; 2] {
    let depths = bounds.corners().map(|p| (p - eye).dot(forward));
    let (nearest, farthest) = depths.into_iter().fold((f32::INFINITY, f32::NEG_INFINITY), |(a, b), z| (a.min(z), b.max(z)));
    let extent = bounds.size().max_element().max(1e-6);
    let near = if orthographic {
        nearest - 0.01 * extent
    } else {
        // Outside the scene, half way to it. Inside, much nearer than what is looked at: reversed z
        // in 32-bit floats has digits to spare, but on OpenGL it may be squeezed through -1..1.
        (0.5 * nearest).max(1e-3 * target_distance.min(extent))
    };
    let near = if near.is_finite() { near.max(if orthographic { 0.0 } else { 1e-7 }) } else { 1e-7 };
    [near, (farthest + 0.01 * extent).max(near + 1e-3 * extent)]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn looking(eye: Vec3, projection: Projection) -> Camera {
        Camera { eye, target: Vec3::ZERO, up: Vec3::Y, projection }
    }

    #[test]
    fn the_target_is_in_the_middle_and_up_is_up() {
        let space = Space::new(&Aabb { min: Vec3::splat(-2.0), max: Vec3::splat(2.0) });
        for projection in [Projection::Perspective { fov_y: 0.7 }, Projection::Orthographic { height: 6.0 }] {
            let view = View::new(&looking(Vec3::new(0.0, 0.0, 8.0), projection), &space, 1.5);
            let (middle, depth) = view.project(Vec3::ZERO, [300, 200]).expect("in front");
            assert_eq!((middle, depth), (Vec2::new(150.0, 100.0), 2.0));
            let (above, _) = view.project(space.point(Vec3::new(1.0, 1.0, 0.0)), [300, 200]).expect("in front");
            assert!(above.x > middle.x && above.y < middle.y);
            assert!((above.x - middle.x - (middle.y - above.y)).abs() < 1e-3, "pixels are square");
            assert!(view.project(Vec3::Z * 9.0, [300, 200]).is_none());
        }
    }

    #[test]
    fn the_range_holds_the_scene_from_outside_and_from_within() {
        let space = Space::new(&Aabb { min: Vec3::ZERO, max: Vec3::ONE });
        for (eye, orthographic) in [(Vec3::splat(30.0), false), (Vec3::splat(0.5), false), (Vec3::splat(3.0), true)] {
            let projection =
                if orthographic { Projection::Orthographic { height: 2.0 } } else { Projection::Perspective { fov_y: 0.7 } };
            let view = View::new(&looking(eye, projection), &space, 1.0);
            let [near, far] = view.range;
            let ahead = space.bounds().corners().map(|p| view.seen(p).z).into_iter().filter(|z| *z > 0.0);
            assert!(near > 0.0 && ahead.clone().all(|z| near < z && z < far), "{view:?}");
        }
        let nothing = View::new(&looking(Vec3::Z, Projection::Perspective { fov_y: 1.0 }), &Space::new(&Aabb::EMPTY), 1.0);
        assert!(nothing.range[0] > 0.0 && nothing.range[1] > nothing.range[0]);
    }
}
