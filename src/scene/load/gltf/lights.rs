//! Lights of KHR_lights_punctual (Khronos, 2018): from the origin of their node, along its -z.

use std::f32::consts::FRAC_PI_2;

use glam::{DAffine3, Vec3};
use gltf::json::extensions::scene::khr_lights_punctual::{Light as Json, Type};
use gltf::json::validation::Checked;
use gltf::json::{Index, Root};

use crate::scene::{Light, LightKind};
use crate::task::{Charge, OverBudget};

/// The extension.
pub(super) const NAME: &str = "KHR_lights_punctual";

/// Collects the lights of a walk over nodes.
#[derive(Default)]
pub(super) struct Lights {
    /// Those that shine.
    pub found: Vec<Light>,
    /// How many are broken, and where the first of them is and why.
    broken: usize,
    why: Option<String>,
}

impl Lights {
    /// Takes the light of a node. Many nodes may have the same one, with a long name.
    pub fn offer(
        &mut self,
        root: &Root,
        node: usize,
        light: Index<Json>,
        world_from_node: &DAffine3,
        memory: &mut Charge,
    ) -> Result<(), OverBudget> {
        let found = root.get(light).ok_or("there is no such light").and_then(|json| Ok((json, placed(json, world_from_node)?)));
        match found {
            Ok((json, light)) => {
                // One that sheds nothing is left out without a word.
                if light.color.iter().any(|x| *x > 0.0) {
                    let name = json.name.as_deref().unwrap_or_default();
                    memory.grow((size_of::<Light>() + name.len()) as u64)?;
                    self.found.push(Light { name: name.to_owned(), ..light });
                }
            }
            Err(why) => {
                self.broken += 1;
                self.why.get_or_insert_with(|| format!("node {node}: {why}"));
            }
        }
        Ok(())
    }

    /// What to say of those that were left out.
    pub fn sentence(&self) -> Option<String> {
        self.why.as_ref().map(|why| format!("Broken lights were left out: {} ({why}).", self.broken))
    }
}

/// A light in the world, without its name. Scaling of its node counts for nothing, neither for how bright it is nor for
/// how far it reaches.
fn placed(json: &Json, world_from_node: &DAffine3) -> Result<Light, &'static str> {
    let kind = kind(json)?;
    let color = json.color.map(|x| x * json.intensity);
    let sane = |x: &f32| x.is_finite() && *x >= 0.0;
    if !sane(&json.intensity) {
        return Err("its intensity is no number from 0 on");
    }
    if !json.color.iter().chain(&color).all(sane) {
        return Err("its colour is no number from 0 on");
    }
    let at = world_from_node.translation.as_vec3();
    if !at.is_finite() {
        return Err("it stands nowhere");
    }
    let towards = (-world_from_node.matrix3.z_axis).try_normalize().map(|towards| towards.as_vec3());
    let towards = match kind {
        LightKind::Point => towards.unwrap_or(Vec3::NEG_Z),
        _ => towards.ok_or("it shines nowhere")?,
    };
    // One that is not above 0 says nothing.
    let range = json.range.filter(|range| range.is_finite() && *range > 0.0);
    Ok(Light { name: String::new(), kind, color, at, towards, range })
}

fn kind(json: &Json) -> Result<LightKind, &'static str> {
    match json.type_ {
        Checked::Valid(Type::Point) => Ok(LightKind::Point),
        Checked::Valid(Type::Directional) => Ok(LightKind::Directional),
        Checked::Valid(Type::Spot) => {
            // What is not said is as the extension has it.
            let (inner, outer) =
                json.spot.as_ref().map_or((0.0, FRAC_PI_2 / 2.0), |spot| (spot.inner_cone_angle, spot.outer_cone_angle));
            if !(0.0 < outer && outer <= FRAC_PI_2 && 0.0 <= inner && inner <= outer) {
                return Err("its cones are not one within the other and both within a half space");
            }
            // A cone with a hard edge is written as two that are the same.
            Ok(LightKind::Spot { inner: inner.min(outer.next_down()), outer })
        }
        Checked::Invalid => Err("its type is not known"),
    }
}
