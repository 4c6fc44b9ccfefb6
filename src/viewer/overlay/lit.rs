//! What stands out while a film of a build is shown.

use std::ops::ControlFlow;

use super::{Collected, Wanted, placed, plane_in};
use crate::accel::Accel;
use crate::accel::cell::Split;
use crate::lab::film::Film;
use crate::task::{Cancel, Cancelled};
use crate::viewer::{theme, wires};

/// The most parts that a cell is divided into that stand out.
const MOST_LIT: usize = 32;

/// The cell that was just divided or merged, and its parts; and the plane between them.
pub(super) fn light(
    accel: &dyn Accel,
    film: &Film,
    at: u32,
    (wanted, cancel): (&Wanted, &Cancel),
    collected: &mut Collected,
) -> Result<(), Cancelled> {
    let Some(row) = film.just(at) else { return Ok(()) };
    let cells = film.outline().cells(accel, row, cancel)?;
    let Some(cell) = cells.last() else { return Ok(()) };
    let mut lit = Vec::new();
    accel.children(cell, &mut |part| {
        lit.push(part);
        if lit.len() <= MOST_LIT { ControlFlow::Continue(()) } else { ControlFlow::Break(()) }
    });
    if lit.len() > MOST_LIT {
        lit.clear();
    }
    lit.push(*cell);
    let overlay = &mut collected.overlay;
    for cell in lit {
        let wires = wires::of_cell(accel, &cell, &wanted.view, [u8::MAX; 4]);
        overlay.lit.extend(wires.boxed);
        overlay.lit_lines.extend(wires.lines);
    }
    if let Some(Split::Axis { axis, pos }) = cell.split.filter(|_| wanted.settings.planes) {
        let plane = plane_in(cell.shape.bounds(), axis, pos);
        overlay.planes.push(placed(accel, cell.id.instance, &plane, theme::TRIED.to_array()));
    }
    Ok(())
}
