//! The node hierarchy, flattened to where meshes stand, and the camera and lights do.

use glam::{Affine3A, DAffine3, DMat3, DQuat, DVec3, Mat3A, Vec3A};
use gltf::json::scene::Node;
use gltf::json::{Index, Root};

use super::buffers::Buffers;
use super::cameras::Cameras;
use super::lights::Lights;
use super::repeats;
use crate::scene::{Light, LoadCx, Reason, StoredCamera};
use crate::task::Charge;

/// A mesh of the document, and where it stands.
pub(super) type Placement = (usize, Affine3A);

/// What the nodes say.
pub(super) struct Walked {
    /// Where meshes stand.
    pub placements: Vec<Placement>,
    /// The first camera that makes a picture.
    pub camera: Option<StoredCamera>,
    /// The lights that shine.
    pub lights: Vec<Light>,
    /// Of repeated meshes and of lights: a short file may repeat a long list, or a long name, many times.
    pub _memory: Charge,
}

/// Walks the scene depth first. Transforms are multiplied in 64 bits and rounded once.
pub(super) fn walk(root: &Root, buffers: &Buffers, warnings: &mut Vec<String>, cx: &LoadCx) -> Result<Walked, Reason> {
    let mut memory = cx.budget.charge(0)?;
    let mut placements = Vec::new();
    // A stack of our own: a chain of nodes may be as long as the file.
    let mut stack: Vec<_> = roots(root)?.into_iter().rev().map(|node| (node, DAffine3::IDENTITY)).collect();
    let mut visited = vec![false; root.nodes.len()];
    let (mut left_out, mut cameras, mut lights) = (LeftOut::default(), Cameras::default(), Lights::default());
    while let Some((index, world_from_parent)) = stack.pop() {
        let place = format!("node {}", index.value());
        let node = root.get(index).ok_or_else(|| Reason::malformed(&place, "there is no such node"))?;
        if std::mem::replace(&mut visited[index.value()], true) {
            return Err(Reason::malformed(&place, "it has two parents, or is its own ancestor"));
        }
        let world_from_node = world_from_parent * transform(node);
        if let Some(mesh) = node.mesh {
            root.get(mesh).ok_or_else(|| Reason::malformed(&place, format_args!("there is no mesh {}", mesh.value())))?;
            match repeats::of(root, buffers, node, &place, cx)? {
                None => placements.push((mesh.value(), narrow(&world_from_node))),
                Some((repeated, _memory)) => {
                    memory.grow((repeated.len() * size_of::<Placement>()) as u64)?;
                    placements.extend(repeated.iter().map(|of_node| (mesh.value(), narrow(&(world_from_node * *of_node)))));
                }
            }
            left_out.count(node);
        }
        if let Some(camera) = node.camera {
            cameras.offer(root, index.value(), camera, &world_from_node);
        }
        if let Some(light) = node.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) {
            lights.offer(root, index.value(), light.light, &world_from_node, &mut memory)?;
        }
        stack.extend(node.children.iter().flatten().rev().map(|child| (*child, world_from_node)));
    }
    warnings.extend(left_out.sentences().chain(cameras.sentence()).chain(lights.sentence()));
    if root.nodes.is_empty() && !root.meshes.is_empty() {
        // Placed nowhere: show each once, where it is.
        placements.extend((0..root.meshes.len()).map(|mesh| (mesh, Affine3A::IDENTITY)));
    }
    Ok(Walked { placements, camera: cameras.found, lights: lights.found, _memory: memory })
}

/// The nodes that the walk begins with: of the default scene, or else the first, or else those
/// that are nobody's child.
fn roots(root: &Root) -> Result<Vec<Index<Node>>, Reason> {
    let scene = match root.scene {
        Some(index) => Some(root.get(index).ok_or_else(|| Reason::malformed("scene", "the default scene does not exist"))?),
        None => root.scenes.first(),
    };
    if let Some(scene) = scene {
        return Ok(scene.nodes.clone());
    }
    let mut is_child = vec![false; root.nodes.len()];
    for child in root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
        if let Some(is_child) = is_child.get_mut(child.value()) {
            *is_child = true;
        }
    }
    let indices = (0..).map(Index::new).zip(is_child);
    Ok(indices.filter(|(_, is_child)| !is_child).map(|(index, _)| index).collect())
}

fn transform(node: &Node) -> DAffine3 {
    if let Some(m) = node.matrix {
        let column = |c: usize| DVec3::new(m[4 * c].into(), m[4 * c + 1].into(), m[4 * c + 2].into());
        return DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) };
    }
    let vector = |v: Option<[f32; 3]>, or: DVec3| v.map_or(or, |v| DVec3::from_array(v.map(f64::from)));
    let [x, y, z, w] = node.rotation.unwrap_or_default().0.map(f64::from);
    let rotation = DQuat::from_xyzw(x, y, z, w);
    // Written with few digits, it is not quite of unit length, and would scale.
    let length = rotation.length();
    let rotation = if length > 0.0 { rotation / length } else { DQuat::IDENTITY };
    DAffine3::from_scale_rotation_translation(vector(node.scale, DVec3::ONE), rotation, vector(node.translation, DVec3::ZERO))
}

fn narrow(t: &DAffine3) -> Affine3A {
    let column = |c: DVec3| Vec3A::from(c.as_vec3());
    let m = &t.matrix3;
    let matrix3 = Mat3A::from_cols(column(m.x_axis), column(m.y_axis), column(m.z_axis));
    Affine3A { matrix3, translation: column(t.translation) }
}

/// What moves meshes and is not read.
#[derive(Default)]
struct LeftOut {
    skinned: usize,
    morphed: usize,
}

impl LeftOut {
    fn count(&mut self, node: &Node) {
        self.skinned += usize::from(node.skin.is_some());
        self.morphed += usize::from(node.weights.as_ref().is_some_and(|w| w.iter().any(|w| *w != 0.0)));
    }

    fn sentences(&self) -> impl Iterator<Item = String> + use<> {
        let left_out = [
            ("Meshes with a skeleton are shown as they were modelled", self.skinned),
            ("Meshes with morph targets are shown without them", self.morphed),
        ];
        left_out.into_iter().filter(|(_, n)| *n > 0).map(|(what, n)| format!("{what}: {n}."))
    }
}
