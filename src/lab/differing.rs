//! Where a rasterised picture is not the traced one, and whether rounding explains it.
//!
//! A primary ray is a sample of the screen with a direction rounded to 32 bits, and the tracer's
//! tests round again. So the two may see different triangles where the ray passes an edge, where two
//! triangles are as deep, or where one begins at the eye; anywhere else one of them would be wrong.

use rayon::prelude::*;
use serde::Serialize;

use crate::accel::{Accel, Mode};
use crate::geometry::Ray;
use crate::geometry::num::UNIT_ROUNDOFF;
use crate::render::raster::Raster;
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled, Pool};
use glam::DVec3;

/// Samples at which another triangle is seen than hit.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Differing {
    /// Edge pixels: the ray meets an edge, two triangles at the same depth, or one at its own start,
    /// within rounding.
    pub edge: u64,
    /// Others; there should be none.
    pub other: u64,
}

/// Rays compared at a time.
const CHUNK: usize = 1024;

/// Compares what is seen with what the primary rays of the same view, in the order of pixels, hit.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
pub fn differing(raster: &Raster, accel: &dyn Accel, rays: &[Ray], pool: &Pool, cancel: &Cancel) -> Result<Differing, Cancelled> {
    let geometry = accel.geometry();
    let compare = |(chunk, rays): (usize, &[Ray])| {
        let (mut hits, mut found) = (vec![None; rays.len()], Differing::default());
        accel.trace(rays, Mode::Closest, &mut hits, cancel)?;
        for (i, (ray, hit)) in rays.iter().zip(hits).enumerate() {
            let seen = raster.seen(chunk * CHUNK + i).map(|seen| seen.prim);
            let hit = hit.and_then(|hit| geometry.flat(hit.instance, hit.primitive));
            if seen != hit {
                let prims = [seen, hit].into_iter().flatten();
                let count = if explained(geometry, ray, prims) { &mut found.edge } else { &mut found.other };
                *count += 1;
            }
        }
        Ok(found)
    };
    let add = |a: Differing, b: Differing| Ok(Differing { edge: a.edge + b.edge, other: a.other + b.other });
    pool.run(|| rays.par_chunks(CHUNK).enumerate().map(compare).try_reduce(Differing::default, add))
}

/// Whether rounding explains that not all of these triangles are the nearest.
fn explained(geometry: &Geometry, ray: &Ray, prims: impl Iterator<Item = PrimRef>) -> bool {
    let scale = geometry.space().scale();
    let (origin, dir) = (ray.origin.as_dvec3() * scale, ray.dir.as_dvec3().normalize_or_zero());
    let met: Vec<Met> = prims.map(|prim| Met::new(origin, dir, geometry.corners(prim).map(|p| p.as_dvec3()))).collect();
    let hit = met.iter().all(|m| m.inside >= -m.pad);
    let at_edge_or_eye = met.iter().any(|m| m.inside <= m.pad || m.t.abs() <= m.t_pad);
    let tie = |a: &Met, b: &Met| (a.t - b.t).abs() <= a.t_pad + b.t_pad;
    hit && (at_edge_or_eye || matches!(&met[..], [a, b] if tie(a, b)))
}

/// How a ray meets a triangle, in 64 bits; lengths are those of the scaled space.
struct Met {
    /// How far from the nearest edge, negative outside.
    inside: f64,
    /// How far off rounding may put the ray, across it.
    pad: f64,
    /// Where it meets the plane, and how far off rounding may put that.
    t: f64,
    t_pad: f64,
}

impl Met {
    /// Of a direction of unit length.
    fn new(origin: DVec3, dir: DVec3, corners: [DVec3; 3]) -> Self {
        let [a, b, c] = corners.map(|p| p - origin);
        let reach = a.length().max(b.length()).max(c.length());
        // The direction's components carry three roundings, the origin one, the test's shear six
        // (`geometry/slabs.rs`): about 12 along each axis, and some room.
        let pad = 32.0 * f64::from(UNIT_ROUNDOFF) * (reach + origin.length());
        let distances = [(a, b), (b, c), (c, a)].map(|(p, q)| {
            // Of the lines of the ray and the edge; 0 where they are parallel.
            let across = dir.cross(q - p).length();
            if across > 0.0 { dir.dot(p.cross(q)) / across } else { 0.0 }
        });
        let least = |sign: f64| distances.iter().fold(f64::INFINITY, |least, d| least.min(d * sign));
        let normal = (b - a).cross(c - a);
        let towards = normal.dot(dir);
        let t_pad = pad * normal.length() / towards.abs();
        Self { inside: least(1.0).max(least(-1.0)), pad, t: normal.dot(a) / towards, t_pad }
    }
}
