//! The faces of a PLY file: polygons, cut into fans, and triangle strips.

use super::header::{Element, Shape};
use super::payload::Payload;
use crate::geometry::num;
use crate::scene::{Mesh, Reason};
use crate::task::Charge;

/// Faces between two charges to the budget.
const BATCH: usize = 1 << 12;

/// Which property holds the indices.
pub(super) fn list_of(element: &Element) -> Option<usize> {
    element.fields.iter().position(|f| matches!(f.name.as_str(), "vertex_indices" | "vertex_index"))
}

/// Reads every face of `element`, whose indices must be below `vertex_count`.
pub(super) fn read(
    element: &Element,
    payload: &mut impl Payload,
    vertex_count: usize,
    mesh: &mut Mesh,
    memory: &mut Charge,
) -> Result<(), Reason> {
    let Some(list) = list_of(element) else {
        return Err(Reason::malformed("header", format_args!("the element {} has no vertex_indices", element.name)));
    };
    let strip = element.name == "tristrips";
    let mut corners = Vec::new();
    let mut charged = mesh.triangles.len();
    for i in 0..element.count {
        payload.begin(element, i)?;
        for (f, field) in element.fields.iter().enumerate() {
            if f == list {
                indices(&field.shape, payload, vertex_count, strip, &mut corners)?;
            } else {
                payload.skip(field)?;
            }
        }
        if strip {
            strips(&corners, &mut mesh.triangles)
        } else {
            fan(&corners, &mut mesh.triangles)
        }
        if i % BATCH == 0 || mesh.triangles.len() > charged + BATCH {
            memory.grow((mesh.triangles.len() - charged) as u64 * 12)?;
            charged = mesh.triangles.len();
        }
    }
    Ok(())
}

/// What parts two strips.
const RESTART: u32 = u32::MAX;

fn indices(
    shape: &Shape,
    payload: &mut impl Payload,
    vertex_count: usize,
    restarts: bool,
    out: &mut Vec<u32>,
) -> Result<(), Reason> {
    let Shape::List { count, item } = shape else {
        return Err(Reason::malformed("header", "the vertex_indices are no list"));
    };
    out.clear();
    for _ in 0..payload.length(count, item)? {
        let value = payload.scalar(item)?;
        let index = num::floor_index(value, num::MAX_INDEX);
        if value >= 0.0 && value.fract() == 0.0 && index < vertex_count {
            out.push(num::index(index));
        } else if restarts && value == -1.0 {
            out.push(RESTART);
        } else {
            return Err(payload.error(format!("there is no vertex {value}; there are {vertex_count}")));
        }
    }
    Ok(())
}

fn fan(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    if let [first, rest @ ..] = corners {
        triangles.extend(rest.windows(2).map(|pair| [*first, pair[0], pair[1]]));
    }
}

/// Every second triangle of a strip is turned round.
fn strips(corners: &[u32], triangles: &mut Vec<[u32; 3]>) {
    for strip in corners.split(|i| *i == RESTART) {
        let turned = |(k, t): (usize, &[u32])| if k % 2 == 0 { [t[0], t[1], t[2]] } else { [t[1], t[0], t[2]] };
        triangles.extend(strip.windows(3).enumerate().map(turned));
    }
}
