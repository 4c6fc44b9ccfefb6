//! Where EXT_mesh_gpu_instancing (Khronos, 2020) repeats the mesh of a node: lists of translations, rotations and scales,
//! each as long as the others, in the node's own space.

use glam::{DAffine3, DQuat, DVec3};
use gltf::json::scene::Node;
use gltf::json::{Index, Root};

use super::accessor::Accessor;
use super::buffers::Buffers;
use crate::scene::{LoadCx, Reason};
use crate::task::Charge;

/// The extension.
pub(super) const NAME: &str = "EXT_mesh_gpu_instancing";

/// Where a node repeats its mesh, from there to the node's space, and the memory of the list; `None` if it does not.
pub(super) fn of(
    root: &Root,
    buffers: &Buffers,
    node: &Node,
    place: &str,
    cx: &LoadCx,
) -> Result<Option<(Vec<DAffine3>, Charge)>, Reason> {
    let Some(extension) = node.extensions.as_ref().and_then(|e| e.others.get(NAME)) else { return Ok(None) };
    let open = |name: &str, width: usize| {
        let Some(index) = extension["attributes"][name].as_u64() else { return Ok(None) };
        let there_is_none =
            || Reason::malformed(place, format_args!("{name} of {NAME} names accessor {index}, which is not there"));
        let index = Index::new(u32::try_from(index).map_err(|_| there_is_none())?);
        let accessor = Accessor::open(root, buffers, index, place)?;
        match accessor.width == width {
            true => Ok(Some(accessor)),
            false => Err(Reason::malformed(place, format_args!("{name} of {NAME} is not of VEC{width}"))),
        }
    };
    let (translations, rotations, scales) = (open("TRANSLATION", 3)?, open("ROTATION", 4)?, open("SCALE", 3)?);
    let mut counts = [&translations, &rotations, &scales].into_iter().flatten().map(|list| list.count);
    let Some(count) = counts.next() else { return Ok(None) };
    if counts.any(|other| other != count) {
        return Err(Reason::malformed(place, format_args!("the lists of its {NAME} are not of one length")));
    }
    let memory = cx.budget.charge((count * size_of::<DAffine3>()) as u64)?;
    let vector = |list: &Option<Accessor>, i: usize, or: DVec3| {
        list.as_ref().map_or(or, |list| DVec3::from_array(list.vector(i, [0.0f32; 3]).map(f64::from)))
    };
    let turn = |i: usize| {
        let read = rotations.as_ref().map(|list| DQuat::from_array(list.vector(i, [0.0f32; 4]).map(f64::from)));
        read.filter(|q| q.length() > 0.0).map_or(DQuat::IDENTITY, DQuat::normalize)
    };
    let mut repeats = Vec::with_capacity(count);
    for i in 0..count {
        if i.is_multiple_of(1 << 14) {
            cx.cancel.check()?;
        }
        let (scale, at) = (vector(&scales, i, DVec3::ONE), vector(&translations, i, DVec3::ZERO));
        repeats.push(DAffine3::from_scale_rotation_translation(scale, turn(i), at));
    }
    Ok(Some((repeats, memory)))
}
