//! Which nodes a ray enters: none whose box, widened by the stated bound, it misses; and if no hit cuts the ray short, all
//! whose box it meets.

use std::collections::HashMap;
use std::ops::ControlFlow;

use crate::accel::cell::{Descend, Shape, walk};
use crate::accel::probe::{Counts, Watched};
use crate::accel::{Accel, Mode, Step};
use crate::geometry::num::UNIT_ROUNDOFF;
use crate::geometry::{Aabb, Ray, Slabs};
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// What some rays did.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Visits {
    /// The most nodes that one entered.
    pub most: u64,
    /// Nodes entered whose widened box was missed, and rays that entered fewer nodes than boxes are met.
    pub astray: u64,
}

/// Nodes looked at: of larger structures nothing but the visits is counted.
const MOST_NODES: usize = 1 << 17;

/// Follows world rays through a structure.
///
/// # Errors
/// Cancelled.
pub fn visits<'a>(accel: &dyn Accel, rays: impl Iterator<Item = &'a Ray>, cancel: &Cancel) -> Result<Visits, Cancelled> {
    let boxes = boxes(accel, cancel)?;
    let mut visits = Visits::default();
    for ray in rays {
        cancel.check()?;
        let (mut counts, mut entered) = (Counts::default(), Vec::new());
        let mut listen = |step: Step| {
            if let Step::Entered(node) = step {
                entered.push(node);
            }
        };
        accel.trace_heard(ray, Mode::Closest, &mut Watched { counts: &mut counts, listener: Some(&mut listen) }, cancel)?;
        visits.most = visits.most.max(counts.nodes);
        if let Some(boxes) = &boxes {
            visits.astray += astray(accel, ray, &entered, boxes, cancel)?;
        }
    }
    Ok(visits)
}

/// The boxes of all nodes that are boxes, if there are not too many.
fn boxes(accel: &dyn Accel, cancel: &Cancel) -> Result<Option<HashMap<u32, Aabb>>, Cancelled> {
    // Of one leaf there is nothing to find out; brute force looks at it whatever its box is.
    if accel.root().is_leaf() {
        return Ok(None);
    }
    let mut boxes = HashMap::new();
    walk(accel, &mut |cell| {
        if let Shape::Box(bounds) = cell.shape {
            boxes.insert(cell.id.node, bounds);
        }
        if boxes.len() > MOST_NODES || cancel.is_cancelled() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(Descend::Yes)
        }
    });
    cancel.check()?;
    Ok((boxes.len() <= MOST_NODES).then_some(boxes))
}

fn astray(accel: &dyn Accel, ray: &Ray, entered: &[u32], boxes: &HashMap<u32, Aabb>, cancel: &Cancel) -> Result<u64, Cancelled> {
    let geometry = accel.geometry();
    if !ray.is_valid() {
        return Ok(entered.len() as u64);
    }
    let scaled = geometry.space().enter(ray).ray;
    // The widening, and the three roundings of a plane's t. A walk from cell to cell begins four times the slack before
    // the ray does, and enters cells that it passes within the slack.
    let of_cells = accel.layout().slack().unwrap_or(0.0) * 6.0;
    let pad = (Slabs::pad(scaled.origin, geometry.bounds()) * 1.5).max(Vec3::splat(of_cells));
    // The root may be entered without a look at its box: those of its children say as much.
    let root = accel.root().id.node;
    let met = |bounds: &Aabb, pad| meets(&scaled, bounds, pad);
    let may = |node: &u32, bounds: &Aabb| *node == root || met(bounds, pad);
    let missed = entered.iter().filter(|node| boxes.get(node).is_some_and(|bounds| !may(node, bounds))).count();
    let mut astray = missed as u64;
    if accel.layout().nests() {
        let mut counts = Counts::default();
        accel.count_uncut(ray, &mut counts, cancel)?;
        let (least, most) = boxes.iter().fold((0, 0), |(least, most), (node, bounds)| {
            (least + u64::from(met(bounds, Vec3::ZERO)), most + u64::from(may(node, bounds)))
        });
        astray += u64::from(counts.nodes < least || most < counts.nodes);
    }
    Ok(astray)
}

/// Whether a ray's interval has a part inside of a box that is widened by `pad`, in 64 bits; ends belong to it.
fn meets(ray: &Ray, bounds: &Aabb, pad: Vec3) -> bool {
    let (mut entry, mut exit) = (f64::from(ray.tmin), f64::from(ray.tmax));
    for k in 0..3 {
        let (o, d, pad) = (f64::from(ray.origin[k]), f64::from(ray.dir[k]), f64::from(pad[k]));
        let (low, high) = (f64::from(bounds.min[k]) - pad - o, f64::from(bounds.max[k]) + pad - o);
        if d == 0.0 {
            if low > 0.0 || high < 0.0 {
                return false;
            }
        } else {
            let (a, b) = (low / d, high / d);
            (entry, exit) = (entry.max(a.min(b)), exit.min(a.max(b)));
        }
    }
    // The ends of the ray's interval are compared with rounded numbers.
    let slack = if pad == Vec3::ZERO { 0.0 } else { 8.0 * f64::from(UNIT_ROUNDOFF) };
    entry <= exit + slack * exit.abs()
}
