//! From where a model is first seen.

use super::{Camera, Projection};
use crate::geometry::Aabb;
use glam::Vec3;

/// A view that suits a model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum FirstView {
    /// From here.
    From(Camera),
    /// From this direction, as near as the whole model is seen.
    Whole(Camera),
    /// From where a camera of the model's file stands.
    Stored(StoredCamera),
}

/// A camera as files have it: it looks somewhere, but at nothing in particular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StoredCamera {
    /// Where it stands.
    pub eye: Vec3,
    /// Where it looks: of unit length.
    pub forward: Vec3,
    /// Up in its picture: of unit length, not along `forward`.
    pub up: Vec3,
    /// Perspective or orthographic.
    pub projection: Projection,
    /// The width over the height of the picture it was made for, if that was said.
    pub aspect: Option<f32>,
}

/// The orbit's centre is never nearer than this share of the model's extent.
const NEAREST: f64 = 0.05;
/// Nor than this share of the eye's distance from the origin, which 32 bits could not tell apart.
const RESOLVED: f64 = 1e-4;
/// The cosine of a roll that is none but rounded.
const UPRIGHT: f32 = 1.0 - 1e-5;

impl FirstView {
    /// The camera in a scene with these bounds, where `up` is up and `aspect` is the picture's width
    /// over its height; `None` if nothing of the scene would be seen.
    pub fn camera(&self, bounds: &Aabb, up: Vec3, aspect: f32) -> Option<Camera> {
        match self {
            Self::From(camera) => Some(*camera),
            Self::Whole(camera) => Some(camera.reframed(bounds, aspect)),
            Self::Stored(stored) => Some(stored.camera(bounds, up, aspect)).filter(|camera| sees(camera, bounds, aspect)),
        }
    }
}

impl StoredCamera {
    fn camera(&self, bounds: &Aabb, up: Vec3, aspect: f32) -> Camera {
        let target = (self.eye.as_dvec3() + self.forward.as_dvec3() * self.target_distance(bounds)).as_vec3();
        // Orbiting keeps the scene upright, unless the camera itself is not.
        let upright = self.forward.cross(up).normalize_or_zero().dot(self.forward.cross(self.up).normalize_or_zero()) > UPRIGHT;
        let up = if upright { up } else { self.up };
        Camera { eye: self.eye, target, up, projection: self.projection_for(aspect) }
    }

    /// How far along its view the model is: where the view passes the middle of the box, or else, as
    /// indoors, where it leaves the box.
    fn target_distance(&self, bounds: &Aabb) -> f64 {
        let (eye, forward) = (self.eye.as_dvec3(), self.forward.as_dvec3());
        let resolved = (RESOLVED * eye.length()).max(f64::from(f32::MIN_POSITIVE));
        if bounds.is_empty() {
            return resolved.max(1.0);
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let nearest = NEAREST * (max - min).length();
        let middle = ((min + max) * 0.5 - eye).dot(forward);
        // Of each axis the plane that the view leaves by; an axis that it does not move along has none.
        let leaves = |axis: usize| {
            let plane = if forward[axis] > 0.0 { max[axis] } else { min[axis] };
            if forward[axis] == 0.0 { f64::INFINITY } else { (plane - eye[axis]) / forward[axis] }
        };
        let exit = (0..3).map(leaves).fold(f64::INFINITY, f64::min);
        let distance = if middle > nearest || exit <= 0.0 { middle } else { exit };
        distance.max(nearest).max(resolved)
    }

    /// A picture narrower than the one it was made for shows all of its width.
    fn projection_for(&self, aspect: f32) -> Projection {
        let higher = self.aspect.map_or(1.0, |made_for| (made_for / aspect).max(1.0));
        match self.projection {
            Projection::Perspective { fov_y } if higher > 1.0 => {
                Projection::Perspective { fov_y: 2.0 * ((fov_y * 0.5).tan() * higher).atan() }
            }
            Projection::Orthographic { height } => Projection::Orthographic { height: height * higher },
            projection @ Projection::Perspective { .. } => projection,
        }
    }
}

/// Whether the box may be in the picture: it is not, if all of it is behind the camera or beyond the
/// same side of the picture.
fn sees(camera: &Camera, bounds: &Aabb, aspect: f32) -> bool {
    let (frame, half) = (camera.frame(), camera.half_size(aspect));
    let beyond = |p: Vec3| {
        let p = p - camera.eye;
        let (x, y, z) = (p.dot(frame.right), p.dot(frame.up), p.dot(frame.forward));
        let reach = if matches!(camera.projection, Projection::Perspective { .. }) { half * z } else { half };
        [-z, x - reach.x, -x - reach.x, y - reach.y, -y - reach.y]
    };
    let corners = bounds.corners().map(beyond);
    !(0..5).any(|side| corners.iter().all(|distances| distances[side] > 0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: Aabb = Aabb { min: Vec3::new(-4.0, 0.0, -2.0), max: Vec3::new(4.0, 2.0, 2.0) };

    fn stored(eye: Vec3, forward: Vec3) -> StoredCamera {
        let forward = forward.normalize_or_zero();
        let up = forward.any_orthonormal_vector();
        StoredCamera { eye, forward, up, projection: Projection::Perspective { fov_y: 1.0 }, aspect: None }
    }

    fn camera(stored: StoredCamera) -> Option<Camera> {
        FirstView::Stored(stored).camera(&BOUNDS, Vec3::Y, 1.5)
    }

    #[test]
    fn the_orbit_goes_around_what_is_looked_at() {
        let target = |eye, forward| camera(stored(eye, forward)).expect("the box is seen").target;
        let outside = target(Vec3::new(1.0, 1.0, 20.0), Vec3::NEG_Z);
        assert!(outside.distance(Vec3::new(1.0, 1.0, 0.0)) < 1e-4, "beside the middle: {outside}");
        let inside = target(Vec3::new(3.0, 1.0, 0.0), Vec3::X);
        assert!(inside.distance(Vec3::new(4.0, 1.0, 0.0)) < 1e-4, "on the wall it looks at: {inside}");
        let close = target(Vec3::new(3.99, 1.0, 0.0), Vec3::X);
        assert!(close.x - 3.99 > 0.3 && close.x < 5.0, "not in front of the lens: {close}");
    }

    #[test]
    fn who_sees_nothing_is_not_asked() {
        assert_eq!(camera(stored(Vec3::new(0.0, 1.0, 20.0), Vec3::Z)), None, "it looks away");
        assert_eq!(camera(stored(Vec3::new(0.0, 1.0, 20.0), Vec3::new(1.0, 0.0, -0.5))), None, "it looks past");
        assert!(camera(stored(Vec3::new(0.0, 1.0, 0.0), Vec3::Z)).is_some(), "it stands inside");
        let flat = StoredCamera { projection: Projection::Orthographic { height: 1.0 }, ..stored(Vec3::ZERO, Vec3::NEG_Z) };
        assert!(camera(StoredCamera { eye: Vec3::new(0.0, 1.0, 9.0), ..flat }).is_some());
        assert_eq!(camera(StoredCamera { eye: Vec3::new(9.0, 1.0, 9.0), ..flat }), None, "parallel rays pass by");
    }

    #[test]
    fn a_camera_that_is_rolled_stays_so() {
        let upright =
            StoredCamera { up: Vec3::new(0.0, 0.8, -0.6), ..stored(Vec3::new(0.0, 9.0, 9.0), Vec3::new(0.0, -0.6, -0.8)) };
        assert_eq!(camera(upright).expect("seen").up, Vec3::Y);
        let rolled = StoredCamera { up: Vec3::X, ..upright };
        let frame = camera(rolled).expect("seen").frame();
        assert!(frame.up.dot(Vec3::X) > 0.999 && frame.forward.dot(upright.forward) > 0.999, "{frame:?}");
        let down = StoredCamera { up: Vec3::NEG_Z, ..stored(Vec3::new(0.0, 9.0, 0.0), Vec3::NEG_Y) };
        assert!(camera(down).expect("seen").frame().up.dot(Vec3::NEG_Z) > 0.999);
    }

    #[test]
    fn a_narrow_picture_shows_the_whole_width() {
        let wide = StoredCamera { aspect: Some(3.0), ..stored(Vec3::new(0.0, 1.0, 20.0), Vec3::NEG_Z) };
        let flat = StoredCamera { projection: Projection::Orthographic { height: 4.0 }, ..wide };
        for stored in [wide, flat] {
            let half = |aspect| FirstView::Stored(stored).camera(&BOUNDS, Vec3::Y, aspect).expect("seen").half_size(aspect);
            assert!((half(1.5).x - half(3.0).x).abs() < 1e-5, "as wide");
            assert_eq!(half(6.0).y, half(3.0).y, "as high");
        }
    }
}
