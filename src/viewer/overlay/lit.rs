//! What stands out while a film of a build is shown.

use std::ops::ControlFlow;

use super::{Collected, Wanted, placed, plane_in};
use crate::accel::cell::Split;
use crate::accel::{Accel, Moved};
use crate::lab::film::Replay;
use crate::task::{Cancel, Cancelled};
use crate::viewer::gpu::{BoxInstance, Overlay};
use crate::viewer::{theme, wires};

/// The most parts that a cell is divided into that stand out.
const MOST_LIT: usize = 32;

/// The cell that was just divided or merged, and its parts; and the plane between them.
pub(super) fn light(
    accel: &dyn Accel,
    replay: &Replay,
    at: u32,
    (wanted, cancel): (&Wanted, &Cancel),
    collected: &mut Collected,
) -> Result<(), Cancelled> {
    let Some(row) = replay.just(at) else { return Ok(()) };
    let cells = replay.outline().cells(accel, row, cancel)?;
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

/// Nodes that were moved, with the parents that they had and have.
pub(super) fn light_moves(moves: &[Moved], overlay: &mut Overlay) {
    for moved in moves {
        let colored = [(&moved.from, theme::MOVED_FROM), (&moved.to, theme::MOVED_TO), (&moved.node, theme::TRIED)];
        overlay.lit.extend(colored.map(|(bounds, color)| BoxInstance::new(bounds, color.to_array())));
    }
}
