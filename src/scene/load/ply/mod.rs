//! PLY (Greg Turk, "The PLY Polygon File Format", 1994): text, and binary of both byte orders.
//!
//! Only the header is read with `ply-rs-bw`. Its payload reader pushes as many elements as the
//! header claims, even where one takes no bytes at all, and its grammar for text knows neither
//! `nan` nor `.5`; both would make files fail, or never end, that we want to read or refuse.

mod faces;
mod header;
mod payload;
mod records;
mod triangles;
mod vertices;

use super::{Loader, Siblings, mesh_bytes};
use crate::scene::{Instance, LoadCx, Mesh, Reason, Scene};
use glam::Vec3;
use header::{Element, Encoding, Header};
use payload::{Binary, Payload, Text};

/// The reader of `.ply` files.
pub(super) struct Ply;

impl Loader for Ply {
    fn id(&self) -> &'static str {
        "ply"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["ply"]
    }

    fn load(&self, bytes: &[u8], _: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason> {
        cx.progress.start("parse", bytes.len() as u64);
        let (header, body) = header::read(bytes)?;
        let mesh = match header.encoding {
            Encoding::Ascii => elements(&header, Text::new(body, header.lines + 1, cx), cx)?,
            Encoding::BinaryBigEndian => elements(&header, Binary::<true>::new(body, cx), cx)?,
            Encoding::BinaryLittleEndian => elements(&header, Binary::<false>::new(body, cx), cx)?,
        };
        let warnings = warnings(&header, &mesh);
        Ok(Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], up: Vec3::Y, warnings, ..Scene::default() })
    }
}

/// Reads the elements in the order of the header, which is the only way to find them.
fn elements(header: &Header, mut payload: impl Payload, cx: &LoadCx) -> Result<Mesh, Reason> {
    let mut mesh = Mesh::default();
    let mut memory = cx.budget.charge(0)?;
    let vertex_count = header.elements.iter().find(|e| e.name == "vertex").map_or(0, |e| e.count);
    for element in header.elements.iter().filter(|e| e.count > 0 && !e.fields.is_empty()) {
        payload.enough_for(element)?;
        match element.name.as_str() {
            "vertex" => vertices::read(element, &mut payload, &mut mesh, &mut memory, cx)?,
            "face" | "tristrips" => {
                if !triangles::read(element, &mut payload, vertex_count, &mut mesh, cx)? {
                    faces::read(element, &mut payload, vertex_count, &mut mesh, &mut memory)?;
                }
            }
            _ => skip(element, &mut payload)?,
        }
    }
    if mesh.positions.len() < vertex_count && !mesh.triangles.is_empty() {
        return Err(Reason::malformed("header", "the vertices have no properties"));
    }
    memory.grow(mesh_bytes(&mesh).saturating_sub(memory.bytes()))?;
    Ok(mesh)
}

fn skip(element: &Element, payload: &mut impl Payload) -> Result<(), Reason> {
    for i in 0..element.count {
        payload.begin(element, i)?;
        for field in &element.fields {
            payload.skip(field)?;
        }
    }
    Ok(())
}

fn warnings(header: &Header, mesh: &Mesh) -> Vec<String> {
    let mut warnings = Vec::new();
    if mesh.triangles.is_empty() && !mesh.positions.is_empty() {
        warnings.push("There are only points.".to_owned());
    }
    let of_face = header.elements.iter().filter(|e| e.name == "face").flat_map(|e| &e.fields);
    if of_face.map(|f| f.name.as_str()).any(|name| matches!(name, "red" | "texcoord")) {
        warnings.push("Colours and texture coordinates of faces were left out; only those of vertices are read.".to_owned());
    }
    warnings
}

#[cfg(test)]
mod tests;
