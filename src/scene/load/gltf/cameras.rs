//! Cameras: the first that makes a picture is where the model is first seen from.

use glam::DAffine3;
use gltf::json::camera::{Camera, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

use crate::scene::{Projection, StoredCamera};

/// Looks for the first good camera of a walk over nodes.
#[derive(Default)]
pub(super) struct Cameras {
    /// The first good one.
    pub found: Option<StoredCamera>,
    /// How many before it were not, and where the first of them is and why.
    bad: usize,
    why: Option<String>,
}

impl Cameras {
    /// Takes the camera of a node, unless there is one already.
    pub fn offer(&mut self, root: &Root, node: usize, camera: Index<Camera>, world_from_node: &DAffine3) {
        if self.found.is_some() {
            return;
        }
        match stored(root, camera, world_from_node) {
            Ok(camera) => self.found = Some(camera),
            Err(why) => {
                self.bad += 1;
                self.why.get_or_insert_with(|| format!("node {node}: {why}"));
            }
        }
    }

    /// What to say of those that were left out.
    pub fn sentence(&self) -> Option<String> {
        self.why.as_ref().map(|why| format!("Cameras that make no picture were left out: {} ({why}).", self.bad))
    }
}

/// Where it stands and looks. Scaling of its node does not count (glTF 2.0, section 3.10), so a
/// mirrored camera mirrors nothing.
fn stored(root: &Root, camera: Index<Camera>, world_from_node: &DAffine3) -> Result<StoredCamera, &'static str> {
    let camera = root.get(camera).ok_or("there is no such camera")?;
    let (projection, aspect) = projection(camera)?;
    let (eye, axes) = (world_from_node.translation.as_vec3(), &world_from_node.matrix3);
    if !eye.is_finite() {
        return Err("it stands nowhere");
    }
    let unit = |axis: glam::DVec3| axis.try_normalize().ok_or("it looks nowhere");
    let (forward, up) = (unit(-axes.z_axis)?, unit(axes.y_axis)?);
    if forward.cross(up).length() < 1e-3 {
        return Err("it is flat");
    }
    Ok(StoredCamera { eye, forward: forward.as_vec3(), up: up.as_vec3(), projection, aspect })
}

/// The projection, and the shape of the picture it was made for.
fn projection(camera: &Camera) -> Result<(Projection, Option<f32>), &'static str> {
    let usable = |x: f32| x.is_finite() && x > 0.0;
    match camera.type_ {
        Checked::Valid(Type::Perspective) => {
            let perspective = camera.perspective.as_ref().ok_or("it has no perspective")?;
            let fov_y = perspective.yfov;
            // Below a hundredth of a degree nothing moves smoothly any more.
            let opens = (1e-4..std::f32::consts::PI - 1e-4).contains(&fov_y);
            let projection = opens.then_some(Projection::Perspective { fov_y });
            let aspect = perspective.aspect_ratio.filter(|aspect| usable(*aspect));
            projection.map(|p| (p, aspect)).ok_or("its angle is not between 0 and 180 degrees")
        }
        Checked::Valid(Type::Orthographic) => {
            let orthographic = camera.orthographic.as_ref().ok_or("it has no size")?;
            // A negative one would mirror, which files should not ask for.
            let (width, height) = (2.0 * orthographic.xmag.abs(), 2.0 * orthographic.ymag.abs());
            let all = usable(width) && usable(height) && usable(width / height);
            all.then_some((Projection::Orthographic { height }, Some(width / height))).ok_or("its picture has no size")
        }
        Checked::Invalid => Err("it is neither perspective nor orthographic"),
    }
}
