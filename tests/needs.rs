//! Leaving out what a scene does not need changes no picture, and is charged for what it saves.

mod common;

use std::sync::Arc;

use boxwood::accel::{Accel, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::needs::{Kept, needs};
use boxwood::render::{Film, Job, Looks, Mode, Until, render};
use boxwood::scene::texture::{Channel, Detail, Image, ImageSource, TextureUse};
use boxwood::scene::{Alpha, Camera, Feature, Geometry, Instance, Keep, LoadCx, Material, Mesh, Scene, ValueTexture};
use boxwood::task::{Cancel, Pool, Progress};
use common::{ball, build, scene_of};
use glam::{Affine3A, Quat, Vec2, Vec3};

/// Four by one texels: red, green, blue and white, opaque but for the second.
fn image() -> Image {
    let mut png = Vec::new();
    let texels = [[255, 0, 0, 255], [0, 255, 0, 0], [0, 0, 255, 255], [255, 255, 255, 255u8]].concat();
    let encoder = image::codecs::png::PngEncoder::new(&mut png);
    image::ImageEncoder::write_image(encoder, &texels, 4, 1, image::ExtendedColorType::Rgba8).expect("encodes");
    Image { name: "stripes".to_owned(), source: ImageSource::Bytes(png.into()) }
}

/// A ball with all that a mesh can have, one with nothing, one that stands nowhere; materials to choose from.
fn scene(first: Mesh, instances: Vec<Instance>, materials: Vec<Material>, images: Vec<Image>) -> Scene {
    let plain = scene_of(&ball(10)).meshes.remove(0);
    let meshes = vec![first, plain.clone(), Mesh { normals: plain.positions.clone(), ..plain }];
    Scene { name: "test".to_owned(), meshes, instances, materials, images, up: Vec3::Y, ..Scene::default() }
}

fn rich() -> Mesh {
    let ball = scene_of(&ball(10)).meshes.remove(0);
    let positions = ball.positions.clone();
    Mesh {
        normals: positions.iter().map(|p| (*p + Vec3::new(0.1, 0.0, 0.0)).normalize_or_zero()).collect(),
        colors: positions.iter().map(|p| [p.x.abs(), 1.0, 0.5, 1.0]).collect(),
        uvs: positions.iter().map(|p| Vec2::new(p.x * 3.0, p.y)).collect(),
        material: Some(0),
        ..ball
    }
}

fn place(mesh: usize, x: f32) -> Instance {
    let turn = Quat::from_rotation_z(0.4);
    let world_from_object = Affine3A::from_scale_rotation_translation(Vec3::new(1.0, 0.6, -1.3), turn, Vec3::new(x, 0.0, 0.0));
    Instance { mesh, world_from_object }
}

fn textured(alpha: Alpha) -> Material {
    let texture = TextureUse::default();
    let alpha_texture = Some(ValueTexture { texture, channel: Channel::Alpha });
    Material { base_color_texture: Some(texture), alpha_texture, alpha, ..Material::PLAIN }
}

/// Scenes that use nothing, some of it, all of it; none of them has a mesh in two places.
fn scenes() -> Vec<Scene> {
    let plain = scene_of(&ball(10)).meshes.remove(0);
    let straight =
        || vec![Instance::identity(0), Instance { world_from_object: Affine3A::from_translation(Vec3::X * 3.0), mesh: 1 }];
    let turned = || vec![place(0, 0.0), place(1, 3.0)];
    vec![
        scene(plain.clone(), straight(), vec![], vec![]),
        scene(Mesh { normals: rich().normals, ..plain.clone() }, straight(), vec![], vec![]),
        scene(Mesh { colors: rich().colors, ..plain }, turned(), vec![], vec![]),
        scene(Mesh { colors: vec![], ..rich() }, turned(), vec![textured(Alpha::Opaque)], vec![image(), image()]),
        scene(rich(), turned(), vec![textured(Alpha::Mask { cutoff: 0.5 })], vec![image(), image()]),
    ]
}

fn cx(keep: Keep) -> LoadCx {
    LoadCx { keep, ..LoadCx::unattended() }
}

/// A scene as it is kept; where all is kept its instances stay flattened if `flat`, so that hits are the same to the bit.
fn kept(mut scene: Scene, keep: Keep, flat: bool) -> Kept {
    let geometry = Arc::new(scene.gather(flat, &cx(keep)).expect("fits"));
    let accel: Arc<dyn Accel> = Arc::from(build(registry::find("bvh").expect("registered"), &geometry, TestKind::Watertight));
    let looks = Arc::new(Looks::decode(&scene, Detail::Colors, &cx(keep)).expect("not cancelled"));
    assert!(looks.textures().warnings().is_empty(), "{:?}", looks.textures().warnings());
    Kept { scene: Arc::new(scene), geometry, accel, looks }
}

fn camera(kept: &Kept) -> Camera {
    Camera::framing(kept.geometry.world_bounds(), Vec3::new(0.3, 0.4, 1.0), Vec3::Y, 1.5)
}

fn film(kept: &Kept, mode: Mode) -> Film {
    let Kept { scene, accel, looks, .. } = kept.clone();
    let job = Job::new(scene, accel, camera(kept), mode, looks);
    render(&job, (90, 60), &Until::samples(2), &Pool::new("test", 2), &Cancel::new(), &Progress::new())
        .expect("not cancelled")
        .film
}

#[test]
fn what_is_left_out_is_seen_in_no_picture() {
    let mut seen = Vec::new();
    for (i, scene) in scenes().into_iter().enumerate() {
        let (ours, forced) = (kept(scene.clone(), Keep::Needed, true), kept(scene, Keep::All, true));
        for mode in [Mode::Shaded, Mode::Normals, Mode::Ao] {
            assert!(film(&ours, mode) == film(&forced, mode), "scene {i} in {mode:?}");
        }
        seen.push(film(&ours, Mode::Shaded));
    }
    for (i, film) in seen.iter().enumerate() {
        assert!(seen[..i].iter().all(|other| other != film), "scene {i} shows what it has");
    }
}

#[test]
fn each_scene_uses_what_it_has() {
    use Feature::{AlphaMaps, AlphaTest, ColorMaps, Indices, Normals, Transforms, Uvs, VertexColors};
    let used = |scene: Scene| -> Vec<Feature> {
        let needs = kept(scene, Keep::Needed, true).looks.needs();
        Feature::ALL.into_iter().filter(|feature| needs.has(*feature)).collect()
    };
    let expected: [&[Feature]; 5] = [
        &[Indices],
        &[Normals, Indices],
        &[VertexColors, Indices],
        &[Normals, Uvs, ColorMaps, Transforms, Indices],
        &[Normals, VertexColors, Uvs, ColorMaps, AlphaMaps, AlphaTest, Transforms, Indices],
    ];
    for (scene, expected) in scenes().into_iter().zip(expected) {
        assert_eq!(used(scene), expected);
    }
}

#[test]
fn savings_add_up_to_what_everything_takes() {
    for scene in scenes() {
        let (ours, forced) = (kept(scene.clone(), Keep::Needed, false), kept(scene, Keep::All, false));
        assert!(ours.geometry.placed().is_none() && forced.geometry.placed().is_some(), "all is kept, and a level above it");
        let report = needs(&ours, &forced, (camera(&ours), [60, 40]), &Cancel::new(), &Progress::new()).expect("not cancelled");
        assert_eq!((report.rays, report.features.len()), (2400, Feature::ALL.len()));
        assert!(report.hits > 100 && report.hits < report.rays);
        let sum: i64 = report.features.iter().map(|row| row.bytes_saved).sum();
        assert_eq!(report.total_bytes.checked_add_signed(sum), Some(report.forced_bytes));
        let timed = ["normals", "vertex-colors", "color-maps", "transforms", "alpha-test", "instancing"];
        for row in &report.features {
            assert!(row.ns_per_ray_saved.is_finite() && row.ns_spread.is_finite());
            let is_timed = !row.used && timed.contains(&row.id);
            assert!(is_timed || row.ns_per_ray_saved == 0.0, "{} takes no time that was measured", row.id);
        }
    }
}

#[test]
fn a_scene_without_corners_shows_the_same() {
    // Given up above in every scene that is kept as needed; here beside one that holds on to them.
    let scene = scenes().remove(4);
    let whole = {
        let geometry = Arc::new(Geometry::new(&scene, &cx(Keep::Needed)).expect("fits"));
        let accel: Arc<dyn Accel> = Arc::from(build(registry::find("bvh").expect("registered"), &geometry, TestKind::Watertight));
        let looks = Arc::new(Looks::decode(&scene, Detail::Colors, &cx(Keep::Needed)).expect("not cancelled"));
        Kept { scene: Arc::new(scene.clone()), geometry, accel, looks }
    };
    let ours = kept(scene, Keep::Needed, true);
    assert!(ours.scene.bytes().corners < whole.scene.bytes().corners);
    assert!(film(&ours, Mode::Shaded) == film(&whole, Mode::Shaded));
}
