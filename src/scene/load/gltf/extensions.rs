//! Which glTF extensions a file may need, and what to say about the others.

use gltf::json::mesh::Primitive;
use gltf::json::{Root, buffer};

use crate::scene::Reason;

/// Those that are read.
const READ: &[&str] =
    &["KHR_mesh_quantization", "KHR_texture_transform", "EXT_texture_webp", super::lights::NAME, super::repeats::NAME];

/// Those that change only how a surface or a light looks: a model can be traced without them.
/// Beginnings of names, for they come in families.
const LOOKS_ONLY: &[&str] =
    &["KHR_materials_", "KHR_texture_", "KHR_techniques_", "KHR_lights_", "EXT_texture_", "EXT_lights_", "MSFT_texture_"];

/// Compression: the name, and what the user can do.
const COMPRESSION: &[(&str, &str)] = &[
    ("KHR_draco_mesh_compression", "Re-export without Draco."),
    ("EXT_meshopt_compression", "Re-export without meshopt compression."),
    ("KHR_meshopt_compression", "Re-export without meshopt compression."),
];

/// Refuses what the document requires and we cannot read. Returns warnings about what looks
/// different without it.
pub(super) fn check(root: &Root) -> Result<Vec<String>, Reason> {
    let mut warnings = Vec::new();
    for name in root.extensions_required.iter().map(String::as_str) {
        if READ.contains(&name) {
            continue;
        }
        if !LOOKS_ONLY.iter().any(|family| name.starts_with(family)) {
            return Err(unsupported(user_of(root, name), name));
        }
        if !name.starts_with("KHR_materials_") {
            warnings.push(format!("It needs {name}, which is not read; surfaces may look different."));
        }
    }
    Ok(warnings)
}

/// The refusal of an extension that `place` uses.
pub(super) fn unsupported(place: String, name: &str) -> Reason {
    let remedy = COMPRESSION.iter().find(|(known, _)| *known == name).map_or("Re-export without it.", |(_, remedy)| remedy);
    Reason::Unsupported { place, extension: name.to_owned(), remedy }
}

/// The first mesh that uses an extension, where it is one of meshes.
fn user_of(root: &Root, name: &str) -> String {
    let uses = |primitive: &Primitive| compression_of_primitive(primitive) == Some(name);
    let found = root.meshes.iter().position(|mesh| mesh.primitives.iter().any(uses));
    found.map_or_else(|| "it".to_owned(), |mesh| format!("mesh {mesh}"))
}

/// The compression of a primitive.
pub(super) fn compression_of_primitive(primitive: &Primitive) -> Option<&'static str> {
    let others = &primitive.extensions.as_ref()?.others;
    COMPRESSION.iter().map(|(name, _)| *name).find(|name| others.contains_key(*name))
}

/// The compression of a buffer view.
pub(super) fn compression_of_view(view: &buffer::View) -> Option<&'static str> {
    let others = &view.extensions.as_ref()?.others;
    COMPRESSION.iter().map(|(name, _)| *name).find(|name| others.contains_key(*name))
}
