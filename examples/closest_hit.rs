//! The closest triangle along a ray. Run with `cargo run --example closest_hit [MODEL]`.

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

    let camera = scene.first_camera(geometry.world_bounds(), 1.0);
    let rays = [Ray::new(camera.eye, camera.target - camera.eye)];
    let mut hits = [None];
    accel.trace(&rays, Mode::Closest, &mut hits, &Cancel::new())?;

    match hits[0] {
        Some(hit) => println!("{} is hit at {}, in triangle {}", scene.name, rays[0].at(hit.t), hit.primitive),
        None => println!("{} is missed", scene.name),
    }
    Ok(())
}
