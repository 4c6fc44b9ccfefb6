//! Whether two points see each other. Run with `cargo run --example any_hit [MODEL]`.

use std::sync::Arc;

use boxwood::accel::{BuildCx, Mode, registry};
use boxwood::geometry::{Ray, tri::TestKind};
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::task::Cancel;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let model = std::env::args().nth(1).unwrap_or_else(|| "builtin:teapot".to_owned());
    let scene = scene::open(&model, &LoadCx::unattended())?;
    let geometry = Arc::new(Geometry::new(&scene, &LoadCx::unattended())?);
    let bvh = registry::find("bvh").ok_or("no bvh")?;
    let accel = bvh.build(&geometry, TestKind::Watertight, &bvh.defaults(), &BuildCx::unattended(0))?;

    let bounds = geometry.world_bounds();
    let segments = [Ray::segment(bounds.min, bounds.max)];
    let mut hits = [None];
    accel.trace(&segments, Mode::Any, &mut hits, &Cancel::new())?;

    let see = if hits[0].is_some() { "do not see" } else { "see" };
    println!("in {}, the points {} and {} {see} each other", scene.name, bounds.min, bounds.max);
    Ok(())
}
