//! A view of the scene: where it is seen from, and how it is projected.

use crate::geometry::{Aabb, Ray};
use glam::{DVec2, Vec2, Vec3};

/// How depth becomes a picture.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub enum Projection {
    /// Rays leave from one point.
    Perspective {
        /// The full vertical angle of view in radians.
        fov_y: f32,
    },
    /// Rays are parallel.
    Orthographic {
        /// The height of the view in world units.
        height: f32,
    },
}

/// A camera that looks from `eye` at `target`.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Camera {
    /// Where it stands.
    pub eye: Vec3,
    /// The point it looks at and orbits around.
    pub target: Vec3,
    /// Roughly up; need not be perpendicular to the view.
    pub up: Vec3,
    /// Perspective or orthographic.
    pub projection: Projection,
}

/// Also of vectors whose squares 32 bits do not hold.
fn length(v: Vec3) -> f32 {
    crate::geometry::num::narrow(v.as_dvec3().length())
}

/// The axes of a camera, of unit length and perpendicular.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// To the right of the picture.
    pub right: Vec3,
    /// To the top of the picture.
    pub up: Vec3,
    /// Into the picture.
    pub forward: Vec3,
}

impl Camera {
    /// The angle of view used when nothing else is said: 40 degrees.
    pub const DEFAULT_FOV_Y: f32 = 40.0 * std::f32::consts::PI / 180.0;

    /// The axes; sensible ones even where eye and target fall together or `up` is along the view.
    pub fn frame(&self) -> Frame {
        let towards = (self.target.as_dvec3() - self.eye.as_dvec3()).try_normalize().map(|d| d.as_vec3());
        let forward = towards.unwrap_or(Vec3::NEG_Z);
        let aside = forward.cross(self.up.normalize_or(Vec3::Y));
        let right = if aside.length_squared() > 1e-12 { aside.normalize_or_zero() } else { forward.any_orthonormal_vector() };
        Frame { right, up: right.cross(forward), forward }
    }

    /// From the eye to what it looks at.
    pub fn distance(&self) -> f32 {
        length(self.target - self.eye)
    }

    /// Half the width and half the height of the picture: at unit distance for a perspective, in
    /// world units for an orthographic view.
    pub fn half_size(&self, aspect: f32) -> Vec2 {
        let half_height = match self.projection {
            Projection::Perspective { fov_y } => (fov_y * 0.5).tan(),
            Projection::Orthographic { height } => height * 0.5,
        };
        Vec2::new(half_height * aspect, half_height)
    }

    /// The ray through a point of the picture: (-1, -1) is the lower left corner, (1, 1) the upper
    /// right. `aspect` is width over height. A perspective ray starts at the eye; an orthographic
    /// one in the plane through the eye.
    pub fn ray(&self, frame: &Frame, ndc: Vec2, aspect: f32) -> Ray {
        let at = ndc * self.half_size(aspect);
        let aside = frame.right * at.x + frame.up * at.y;
        match self.projection {
            Projection::Perspective { .. } => Ray::new(self.eye, frame.forward + aside),
            Projection::Orthographic { .. } => Ray::new(self.eye + aside, frame.forward),
        }
    }

    /// The part of the picture outside of which rays surely miss a box: its lower left and upper right corner, where
    /// (-1, -1) and (1, 1) are those of the picture, which it may reach beyond. Everything where the box reaches beside
    /// the eye; `None` if it is empty or behind the eye altogether.
    pub fn window(&self, bounds: &Aabb, aspect: f32) -> Option<[DVec2; 2]> {
        /// What rays and axes lose to rounding, and more: in units of the screen at unit distance, or of its height.
        const SLACK: f64 = 1e-5;
        const EVERYTHING: [DVec2; 2] = [DVec2::NEG_INFINITY, DVec2::INFINITY];
        /// Depths that are less, over the distance, are beside the eye.
        const BESIDE: f64 = 1e-3;
        let (frame, half) = (self.frame(), self.half_size(aspect).as_dvec2());
        let [right, up, forward] = [frame.right, frame.up, frame.forward].map(Vec3::as_dvec3);
        let corners = bounds.corners().map(|corner| corner.as_dvec3() - self.eye.as_dvec3());
        if bounds.is_empty() || corners.iter().all(|to| to.dot(forward) < -BESIDE * to.length()) {
            return None;
        }
        let mut window = [DVec2::INFINITY, DVec2::NEG_INFINITY];
        for to in corners {
            let (aside, depth) = (DVec2::new(to.dot(right), to.dot(up)), to.dot(forward));
            let at = match self.projection {
                Projection::Perspective { .. } if depth > BESIDE * to.length() => aside / depth,
                Projection::Perspective { .. } => return Some(EVERYTHING),
                // The eye's and the target's digits are those of rays, which start in the plane of the eye.
                Projection::Orthographic { .. } => aside,
            };
            let slack = match self.projection {
                Projection::Perspective { .. } => SLACK * (1.0 + half.max_element() + at.abs().max_element()),
                Projection::Orthographic { .. } => SLACK * (half.max_element() + to.length() + self.eye.as_dvec3().length()),
            };
            window = [window[0].min((at - slack) / half), window[1].max((at + slack) / half)];
        }
        let is_number = window.iter().all(|corner| !corner.is_nan());
        Some(if is_number { window } else { EVERYTHING })
    }

    /// A camera that shows the whole box, seen from `direction` (from the target to the eye), with
    /// a little room around it.
    pub fn framing(bounds: &Aabb, direction: Vec3, up: Vec3, aspect: f32) -> Self {
        let fov_y = Self::DEFAULT_FOV_Y;
        let camera = Self { eye: direction, target: Vec3::ZERO, up, projection: Projection::Perspective { fov_y } };
        camera.reframed(bounds, aspect)
    }

    /// The same direction and projection, moved so that the whole box is seen.
    pub fn reframed(&self, bounds: &Aabb, aspect: f32) -> Self {
        let frame = self.frame();
        let bounds = if bounds.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } } else { *bounds };
        let centre = bounds.centre();
        let margin = 1.08;
        let corners = bounds.corners().map(|p| p - centre);
        let extent = corners.iter().map(|p| length(*p)).fold(0.0, f32::max).max(f32::MIN_POSITIVE * 1e6);
        let (x, y, z) = (|p: &Vec3| p.dot(frame.right).abs(), |p: &Vec3| p.dot(frame.up).abs(), |p: &Vec3| p.dot(frame.forward));
        let half = self.half_size(aspect);
        match self.projection {
            Projection::Perspective { .. } => {
                let need = |p: &Vec3| (x(p) / half.x).max(y(p) / half.y) * margin - z(p);
                let distance = corners.iter().map(need).fold(extent * 0.1, f32::max);
                Self { eye: centre - frame.forward * distance, target: centre, ..*self }
            }
            Projection::Orthographic { .. } => {
                let half_height = corners.iter().map(|p| (x(p) / aspect).max(y(p)) * margin).fold(extent * 0.1, f32::max);
                let projection = Projection::Orthographic { height: 2.0 * half_height };
                Self { eye: centre - frame.forward * extent * 2.0, target: centre, projection, ..*self }
            }
        }
    }
}
