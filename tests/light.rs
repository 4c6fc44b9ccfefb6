//! Paths of light against answers that are known.

mod common;

use std::sync::Arc;

use boxwood::accel::{Accel, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::render::light::{Sky, Sources};
use boxwood::render::{Job, Looks, Mode, Until, render};
use boxwood::scene::texture::Textures;
use boxwood::scene::{Camera, Instance, Material, Mesh, Projection, Scene};
use boxwood::task::{Cancel, Pool, Progress};
use common::{build, geometry_of};
use glam::Vec3;

/// A matt surface without a coat.
fn matt(albedo: f32) -> Material {
    Material { base_color: [albedo, albedo, albedo, 1.0], ior: 1.0, ..Material::PLAIN }
}

fn job(scene: Scene, camera: Camera, sky: Option<Sky>) -> Job {
    let geometry = geometry_of(&scene);
    let accel: Arc<dyn Accel> = Arc::from(build(registry::find("bvh").expect("registered"), &geometry, TestKind::Watertight));
    let looks = Looks::new(&scene, Textures::none());
    let looks = if let Some(sky) = sky { looks.with_sources(Sources::sky(sky)) } else { looks };
    Job::new(Arc::new(scene), accel, camera, Mode::Path, Arc::new(looks))
}

/// The mean of each pixel that is wholly covered.
fn means(job: &Job, (width, height): (u32, u32), samples: u32) -> Vec<Vec3> {
    let (until, pool) = (Until::samples(samples), Pool::new("test", 2));
    let still = render(job, (width, height), &until, &pool, &Cancel::new(), &Progress::new()).expect("not cancelled");
    still.film.means().filter(|mean| mean[3] == 1.0).map(|[r, g, b, _]| Vec3::new(r, g, b)).collect()
}

/// A square, whose rays leave it for good.
fn pane_of(material: Material) -> Scene {
    let meshes = vec![square(1.0, 0.0, 0)];
    Scene { meshes, instances: vec![Instance::identity(0)], materials: vec![material], up: Vec3::Z, ..Scene::default() }
}

fn around(scene: &Scene) -> Camera {
    Camera::framing(geometry_of(scene).world_bounds(), Vec3::new(0.3, 0.4, 1.0), Vec3::Y, 1.0)
}

/// The mean of all pixels' red, and its standard error.
fn mean_and_error(pixels: &[Vec3]) -> (f64, f64) {
    let n = pixels.len() as f64;
    let mean = pixels.iter().map(|pixel| f64::from(pixel.x)).sum::<f64>() / n;
    let spread = pixels.iter().map(|pixel| (f64::from(pixel.x) - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean, (spread / n).sqrt())
}

#[test]
fn a_matt_surface_under_an_even_sky_shows_its_albedo() {
    for albedo in [0.2, 0.5, 1.0] {
        let scene = pane_of(matt(albedo));
        let camera = around(&scene);
        let seen = means(&job(scene, camera, Some(Sky::even(Vec3::splat(2.0)))), (40, 40), 16);
        assert!(seen.len() > 200, "{}", seen.len());
        // Every path leaves at once, with all that the surface gives back.
        assert!(seen.iter().all(|mean| (*mean - 2.0 * albedo).abs().max_element() < 1e-4), "{albedo}");
    }
}

#[test]
fn nothing_white_is_seen_in_a_white_furnace() {
    for metallic in [0.0, 1.0] {
        for roughness in [0.0, 0.3, 0.6, 1.0] {
            for transmission in [0.0, 1.0] {
                let white = Material { base_color: [1.0; 4], metallic, roughness, transmission, ..Material::PLAIN };
                let scene = pane_of(white);
                let camera = around(&scene);
                let seen = means(&job(scene, camera, Some(Sky::even(Vec3::ONE))), (32, 32), 64);
                let (mean, error) = mean_and_error(&seen);
                // Albedos are interpolated.
                let which = format!("metallic {metallic}, roughness {roughness}, clear {transmission}");
                assert!((mean - 1.0).abs() < 0.01 + 4.0 * error && error < 0.01, "{which}: {mean} ±{error}");
            }
        }
    }
}

fn quad(corners: [Vec3; 4], material: usize) -> Mesh {
    Mesh { positions: corners.to_vec(), triangles: vec![[0, 1, 2], [0, 2, 3]], material: Some(material), ..Mesh::default() }
}

/// A square of half the size `half` at a height over the floor.
fn square(half: f32, height: f32, material: usize) -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x * half, y * half, height);
    quad([corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)], material)
}

#[test]
fn a_floor_below_a_square_lamp_is_as_bright_as_its_form_factor_says() {
    for (half, albedo) in [(0.5f32, 0.5f32), (0.1, 0.8), (3.0, 1.0)] {
        let radiance = 3.0;
        let lamp = Material { emission: [radiance; 3], ..matt(0.0) };
        let scene = Scene {
            meshes: vec![square(20.0, 0.0, 0), square(half, 1.0, 1)],
            instances: vec![Instance::identity(0), Instance::identity(1)],
            materials: vec![matt(albedo), lamp],
            up: Vec3::Z,
            ..Scene::default()
        };
        // From the side, so that the lamp is not in the way; a spot around its middle.
        let camera = Camera {
            eye: Vec3::new(0.3, 0.0, 0.1),
            target: Vec3::ZERO,
            up: Vec3::Z,
            projection: Projection::Orthographic { height: 1e-3 },
        };
        let seen = means(&job(scene, camera, None), (8, 8), 512);
        assert_eq!(seen.len(), 64);
        let (mean, error) = mean_and_error(&seen);
        // Of a rectangle parallel to a small patch below its corner, four times (Howell, configuration B-3).
        let a = f64::from(half);
        let root = (1.0 + a * a).sqrt();
        let factor = 4.0 / std::f64::consts::TAU * 2.0 * (a / root) * (a / root).atan();
        let expected = f64::from(albedo * radiance) * factor;
        assert!((mean - expected).abs() < 4.0 * error + 1e-4 * expected, "half {half}: {mean} ±{error}, not {expected}");
        assert!(error < 0.02 * expected, "{error} of {expected}");
    }
}

#[test]
fn a_lamp_shows_what_it_sends_out() {
    let scene = pane_of(Material { emission: [5.0, 4.0, 3.0], ..matt(0.0) });
    let camera = around(&scene);
    let seen = means(&job(scene, camera, None), (16, 16), 4);
    assert!(seen.iter().all(|mean| (*mean - Vec3::new(5.0, 4.0, 3.0)).abs().max_element() < 1e-4));
}
