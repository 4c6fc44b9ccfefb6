//! Paths of light against answers that are known.

mod common;

use std::sync::Arc;

use boxwood::accel::{Accel, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::render::light::{Sky, Sources, Surroundings};
use boxwood::render::{Job, Looks, Mode, Transport, Until, render};
use boxwood::scene::texture::Textures;
use boxwood::scene::{Alpha, Camera, Environment, Instance, Light, LightKind, Material, Mesh, Projection, Scene};
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

/// An image of the surroundings that is the same everywhere.
fn even_image(light: f32) -> Surroundings {
    let image = Environment::new(8, 4, vec![[light; 3]; 32]).expect("as many texels as it says");
    Surroundings::Image { image: Arc::new(image), turn: 0.0, strength: 1.0 }
}

fn within(scene: Scene, camera: Camera, surroundings: Surroundings) -> Job {
    let of_sky = job(scene, camera, None);
    let looks = Looks::new(&of_sky.scene, Textures::none()).within(surroundings);
    Job { looks: Arc::new(looks), ..of_sky }
}

#[test]
fn an_even_image_is_a_white_furnace_too_however_it_is_found() {
    // What is asked for and what is found are weighed: whatever one of them leaves out is missing here.
    for (metallic, roughness, transmission) in [
        (0.0, 0.0, 0.0),
        (0.0, 0.5, 0.0),
        (0.0, 1.0, 0.0),
        (1.0, 0.3, 0.0),
        (1.0, 1.0, 0.0),
        (0.0, 0.1, 1.0),
        (0.0, 0.5, 1.0),
        (0.0, 1.0, 0.6),
    ] {
        let white = Material { base_color: [1.0; 4], metallic, roughness, transmission, ..Material::PLAIN };
        let scene = pane_of(white);
        let camera = around(&scene);
        let seen = means(&within(scene, camera, even_image(1.0)), (32, 32), 64);
        let (mean, error) = mean_and_error(&seen);
        let which = format!("metallic {metallic}, roughness {roughness}, clear {transmission}");
        assert!((mean - 1.0).abs() < 0.01 + 4.0 * error && error < 0.02, "{which}: {mean} ±{error}");
    }
}

#[test]
fn light_over_one_surface_is_all_there_where_no_more_are_followed() {
    let scene = pane_of(matt(0.5));
    let camera = around(&scene);
    for surroundings in [even_image(2.0), Surroundings::Day { elevation: 1.0, azimuth: 0.0 }] {
        let all = within(scene.clone(), camera, surroundings);
        // A pane alone in the open: no path meets it twice.
        let one = Job { transport: Transport { surfaces: 1, ..all.transport }, ..all.clone() };
        let ((a, ea), (b, eb)) = (mean_and_error(&means(&all, (24, 24), 64)), mean_and_error(&means(&one, (24, 24), 64)));
        assert!((a - b).abs() < 4.0 * (ea * ea + eb * eb).sqrt() + 1e-6 && a > 0.1, "{a} ±{ea}, {b} ±{eb}");
        // Nothing of it came over two surfaces, so there is nothing to clamp.
        let clamped = Job { transport: Transport { clamp: Some(1e-3), ..all.transport }, ..all };
        assert!((mean_and_error(&means(&clamped, (24, 24), 64)).0 - a).abs() < 1e-6);
    }
}

/// The floor, seen from the side, and lights.
fn floor_under(lights: Vec<Light>) -> (Scene, Camera) {
    let meshes = vec![square(20.0, 0.0, 0)];
    let materials = vec![matt(0.6)];
    let scene = Scene { meshes, instances: vec![Instance::identity(0)], materials, lights, up: Vec3::Z, ..Scene::default() };
    let camera = Camera {
        eye: Vec3::new(3.0, 0.0, 1.0),
        target: Vec3::ZERO,
        up: Vec3::Z,
        projection: Projection::Orthographic { height: 1e-3 },
    };
    (scene, camera)
}

#[test]
fn points_spots_and_directions_light_a_floor_as_their_formula_says() {
    let light =
        |kind| Light { name: String::new(), kind, color: [5.0; 3], at: Vec3::new(0.0, 1.0, 2.0), towards: -Vec3::Z, range: None };
    let albedo = 0.6f64;
    // Intensity over the squared distance, times the cosine; of a direction, irradiance.
    let (distance, cosine) = (5f64.sqrt(), 2.0 / 5f64.sqrt());
    let of_point = albedo / std::f64::consts::PI * 5.0 / (distance * distance) * cosine;
    let spot = LightKind::Spot { inner: 0.2, outer: 0.9 };
    let cone = (((cosine - 0.9f64.cos()) / (0.2f64.cos() - 0.9f64.cos())).powi(2), spot);
    let of_direction = albedo / std::f64::consts::PI * 5.0;
    for (kind, expected) in [(LightKind::Point, of_point), (cone.1, of_point * cone.0), (LightKind::Directional, of_direction)] {
        for scale in [1.0f32, 1e-3, 1e3] {
            // The same in other units: what is measured in them is as much larger.
            let mut of_scale = light(kind);
            of_scale.at *= scale;
            of_scale.color = if kind == LightKind::Directional { [5.0; 3] } else { [5.0 * scale * scale; 3] };
            let (mut scene, mut camera) = floor_under(vec![of_scale]);
            scene.meshes[0].positions.iter_mut().for_each(|p| *p *= scale);
            camera.eye *= scale;
            camera.projection = Projection::Orthographic { height: 1e-3 * scale };
            let seen = means(&job(scene, camera, None), (4, 4), 4);
            let (mean, _) = mean_and_error(&seen);
            assert!((mean - expected).abs() < 1e-3 * expected, "{kind:?} at {scale}: {mean}, not {expected}");
        }
    }
}

#[test]
fn a_lamp_with_holes_shines_from_what_is_there_of_it() {
    let lamp = |alpha: f32| {
        let emission = [3.0; 3];
        Material { emission, base_color: [0.0, 0.0, 0.0, alpha], alpha: Alpha::Blend, ..matt(0.0) }
    };
    let seen = |alpha: f32| {
        let meshes = vec![square(20.0, 0.0, 0), square(0.5, 1.0, 1)];
        let instances = vec![Instance::identity(0), Instance::identity(1)];
        let scene = Scene { meshes, instances, materials: vec![matt(0.6), lamp(alpha)], up: Vec3::Z, ..Scene::default() };
        let eye = Vec3::new(0.3, 0.0, 0.1);
        let projection = Projection::Orthographic { height: 1e-3 };
        let camera = Camera { eye, target: Vec3::ZERO, up: Vec3::Z, projection };
        mean_and_error(&means(&job(scene, camera, None), (8, 8), 512))
    };
    let ((whole, ew), (half, eh)) = (seen(1.0), seen(0.5));
    assert!((half - 0.5 * whole).abs() < 4.0 * (eh * eh + 0.25 * ew * ew).sqrt(), "{half} ±{eh} is not half of {whole} ±{ew}");
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
