//! Moving the camera by hand: orbit, pan, zoom to the cursor.

use glam::{Quat, Vec2, Vec3};

use crate::scene::{Camera, Projection};

/// Radians for a drag across the height of the view.
const ORBIT: f32 = std::f32::consts::PI;
/// The view never comes nearer to straight up or down than this, in radians.
const POLE: f32 = 0.01;
/// How much one step of the wheel zooms.
const ZOOM_PER_POINT: f32 = 0.0025;

/// Turns around the target: a drag by `delta` points in a view `height` points high.
pub fn orbit(camera: &Camera, delta: Vec2, height: f32) -> Camera {
    let angle = delta * ORBIT / height.max(1.0);
    let up = camera.up.normalize_or(Vec3::Y);
    let arm = camera.eye - camera.target;
    let elevation = up.angle_between(arm); // 0 above, pi below
    let pitch = (elevation - angle.y).clamp(POLE, std::f32::consts::PI - POLE) - elevation;
    let turned = Quat::from_axis_angle(camera.frame().right, pitch) * arm;
    let turned = Quat::from_axis_angle(up, -angle.x) * turned;
    Camera { eye: camera.target + turned, ..*camera }
}

/// Moves along the picture: what is at the target's distance follows the pointer.
pub fn pan(camera: &Camera, delta: Vec2, height: f32) -> Camera {
    let frame = camera.frame();
    let per_point = height_at_target(camera) / height.max(1.0);
    let shift = (frame.up * delta.y - frame.right * delta.x) * per_point;
    Camera { eye: camera.eye + shift, target: camera.target + shift, ..*camera }
}

/// Zooms by `scroll` points of the wheel (up is closer), keeping what is under the pointer there.
/// `at` is the pointer in the picture, (-1, -1) lower left to (1, 1) upper right.
pub fn zoom(camera: &Camera, scroll: f32, at: Vec2, aspect: f32) -> Camera {
    zoom_by((-scroll * ZOOM_PER_POINT).exp(), camera, at, aspect)
}

/// The same by a factor: below 1 is closer.
pub fn zoom_by(factor: f32, camera: &Camera, at: Vec2, aspect: f32) -> Camera {
    let frame = camera.frame();
    let half = height_at_target(camera) * 0.5;
    let under = camera.target + frame.right * (at.x * half * aspect) + frame.up * (at.y * half);
    let towards = |p: Vec3| under + (p - under) * factor;
    match camera.projection {
        Projection::Perspective { .. } => {
            let closer = Camera { eye: towards(camera.eye), target: towards(camera.target), ..*camera };
            // At the end of 32 bits eye and target would fall together.
            if closer.distance() > 1e-6 * closer.target.length().max(f32::MIN_POSITIVE) { closer } else { *camera }
        }
        Projection::Orthographic { height } => {
            let shift = towards(camera.target) - camera.target;
            let projection = Projection::Orthographic { height: height * factor };
            Camera { eye: camera.eye + shift, target: camera.target + shift, projection, ..*camera }
        }
    }
}

/// Between perspective and orthographic, keeping the size of what is at the target.
pub fn toggle_projection(camera: &Camera) -> Camera {
    let height = height_at_target(camera);
    match camera.projection {
        Projection::Perspective { .. } => Camera { projection: Projection::Orthographic { height }, ..*camera },
        Projection::Orthographic { .. } => {
            let fov_y = Camera::DEFAULT_FOV_Y;
            let distance = height * 0.5 / (fov_y * 0.5).tan();
            let eye = camera.target - camera.frame().forward * distance;
            Camera { eye, projection: Projection::Perspective { fov_y }, ..*camera }
        }
    }
}

/// How much of the world the height of the view spans at the target's distance.
fn height_at_target(camera: &Camera) -> f32 {
    match camera.projection {
        Projection::Perspective { fov_y } => 2.0 * (fov_y * 0.5).tan() * camera.distance(),
        Projection::Orthographic { height } => height,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn camera() -> Camera {
        let projection = Projection::Perspective { fov_y: Camera::DEFAULT_FOV_Y };
        Camera { eye: Vec3::new(3.0, 2.0, 5.0), target: Vec3::new(1.0, 0.0, 0.0), up: Vec3::Y, projection }
    }

    #[test]
    fn orbiting_keeps_the_distance_and_stops_at_the_poles() {
        let start = camera();
        let turned = orbit(&start, Vec2::new(37.0, 12.0), 600.0);
        assert!((turned.eye.distance(turned.target) - start.eye.distance(start.target)).abs() < 1e-4);
        assert!(turned.eye != start.eye && turned.target == start.target);
        let top = orbit(&start, Vec2::new(0.0, 1e5), 600.0);
        assert!(top.frame().up.is_finite() && top.eye.y > 5.6, "dragging down looks from above: {top:?}");
    }

    #[test]
    fn zooming_keeps_what_is_under_the_pointer() {
        for start in [camera(), toggle_projection(&camera())] {
            let at = Vec2::new(0.4, -0.3);
            let point = |c: &Camera| {
                let ray = c.ray(&c.frame(), at, 1.5);
                let t = (start.target - ray.origin).dot(start.frame().forward) / ray.dir.dot(start.frame().forward);
                ray.at(t)
            };
            let closer = zoom(&start, 120.0, at, 1.5);
            assert!(point(&start).distance(point(&closer)) < 1e-4);
            assert!(height_at_target(&closer) < height_at_target(&start));
        }
    }

    #[test]
    fn toggling_the_projection_twice_comes_back() {
        let back = toggle_projection(&toggle_projection(&camera()));
        assert!(back.eye.distance(camera().eye) < 1e-4);
    }

    #[test]
    fn zooming_in_for_ever_stays_finite() {
        let mut c = camera();
        (0..2000).for_each(|_| c = zoom(&c, 100.0, Vec2::ZERO, 1.0));
        assert!(c.eye.is_finite() && c.eye != c.target);
    }
}
