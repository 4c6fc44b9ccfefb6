use super::*;
use crate::scene::LoadCx;
use crate::scene::texture::tests::{material, png, scene};
use crate::scene::texture::{Detail, UvTransform};

/// A material that reads colour and emission from image 0, values from image 1 and normals from image 2.
fn mapped() -> Material {
    let value = |channel| material(None, Some((1, channel))).alpha_texture;
    let texture = |image| material(Some(image), None).base_color_texture.expect("a texture");
    Material {
        base_color: [0.5, 1.0, 1.0, 1.0],
        metallic: 0.5,
        metallic_texture: value(Channel::Blue),
        roughness: 0.25,
        roughness_texture: value(Channel::Green),
        transmission: 0.75,
        transmission_texture: value(Channel::Red),
        normal_texture: Some(NormalTexture { texture: texture(2), scale: 2.0 }),
        emission: [2.0, 4.0, 8.0],
        emission_texture: Some(texture(0)),
        ..material(Some(0), None)
    }
}

/// Two texels a row; the second, right one is looked at.
fn images() -> [Vec<u8>; 3] {
    [[255, 0, 255, 255], [51, 102, 153, 255], [255, 128, 255, 255]].map(|right| png(2, &[[0, 0, 0, 255], right]))
}

fn decoded(scene: &Scene, detail: Detail) -> Textures {
    Textures::decode(scene, detail, &LoadCx::unattended()).expect("not cancelled")
}

fn near(a: [f32; 3], b: [f32; 3]) {
    assert!(Vec3::from(a).distance(Vec3::from(b)) < 1e-6, "{a:?}, not {b:?}");
}

#[test]
fn factors_times_texels() {
    let scene = scene(&images(), vec![mapped()]);
    let textures = decoded(&scene, Detail::Light);
    // uv is (u, v) on this triangle.
    let finished = Finish::new(&scene, 0, &textures).at(0, 0.75, 0.1);
    let Finished { base, metallic, roughness, transmission, ior, emission, bend } = finished;
    assert_eq!((base, emission, ior), ([0.5, 0.0, 1.0], [2.0, 0.0, 8.0], 1.5));
    near([metallic, roughness, transmission], [0.5 * 0.6, 0.25 * 0.4, 0.75 * 0.2]);
    // x and y twice as long, then all as long as 1.
    near(bend.expect("a normal").into(), Vec3::new(2.0, 2.0 / 255.0, 1.0).normalize_or_zero().into());
    let left = Finish::new(&scene, 0, &textures).at(0, 0.25, 0.1);
    assert_eq!((left.base, left.emission, left.roughness), ([0.0; 3], [0.0; 3], 0.0));
    let inward = left.bend.expect("a normal");
    assert!(inward.z > 0.0 && (inward.length() - 1.0).abs() < 1e-6, "{inward}");
}

#[test]
fn what_is_not_there_counts_as_absent() {
    let plain = |finished: Finished| {
        assert_eq!((finished.metallic, finished.roughness, finished.transmission), (0.5, 0.25, 0.75));
        assert_eq!((finished.emission, finished.bend), ([2.0, 4.0, 8.0], None));
    };
    let mut scene = scene(&images(), vec![mapped()]);
    let none = Textures::none();
    plain(Finish::new(&scene, 0, &none).at(0, 0.75, 0.1));
    let colors = decoded(&scene, Detail::Colors);
    let finished = Finish::new(&scene, 0, &colors).at(0, 0.75, 0.1);
    assert_eq!((finished.base, finished.metallic, finished.bend), ([0.5, 0.0, 1.0], 0.5, None));
    let light = decoded(&scene, Detail::Light);
    assert!(Finish::new(&scene, 0, &light).uvs(0).is_some() && Finish::new(&scene, 0, &none).uvs(0).is_none());
    scene.meshes[0].uvs.clear();
    scene.meshes[0].triangles.clear(); // as where nothing of vertices is left
    let finish = Finish::new(&scene, 0, &light);
    plain(finish.at(0, 0.75, 0.1));
    assert_eq!(finish.at(0, 0.75, 0.1).base, [0.5, 1.0, 1.0]);
    assert_eq!(finish.uvs(0), None);
    // An image of which only another channel is there says nothing.
    let mut holes = super::super::texture::tests::scene(&images(), vec![mapped()]);
    holes.materials[0].alpha_texture = material(None, Some((1, Channel::Red))).alpha_texture;
    holes.materials[0].alpha = crate::scene::Alpha::Blend;
    let colors = decoded(&holes, Detail::Colors);
    let finished = Finish::new(&holes, 0, &colors).at(0, 0.75, 0.1);
    assert_eq!((finished.metallic, finished.roughness), (0.5, 0.25));
}

#[test]
fn each_map_lies_as_it_is_told_to() {
    let mut scene = scene(&images(), vec![mapped()]);
    let shifted = UvTransform::khr([0.5, 0.0], 0.0, [1.0, 2.0]);
    let material = &mut scene.materials[0];
    material.roughness_texture.as_mut().expect("a texture").texture.transform = shifted;
    material.normal_texture.as_mut().expect("a texture").texture.transform = shifted;
    let textures = decoded(&scene, Detail::Light);
    let finish = Finish::new(&scene, 0, &textures);
    let left = finish.at(0, 0.25, 0.1);
    assert_eq!((left.roughness, left.metallic), (0.25 * 0.4, 0.0), "only one of them is moved");
    assert!(left.bend.is_some_and(|bend| bend.x > 0.5));
    assert_eq!(finish.uvs(0), Some([Vec2::new(0.5, 0.0), Vec2::new(1.5, 0.0), Vec2::new(0.5, 2.0)]));
}

#[test]
fn values_stay_within_their_ranges() {
    let wild = Material {
        base_color: [2.0, -1.0, f32::NAN, 1.0],
        metallic: 7.0,
        roughness: f32::NAN,
        transmission: -1.0,
        ior: f32::INFINITY,
        emission: [-1.0, f32::INFINITY, f32::NAN],
        normal_texture: mapped().normal_texture.map(|normal| NormalTexture { scale: f32::INFINITY, ..normal }),
        ..Material::PLAIN
    };
    let scene = scene(&images(), vec![wild, Material { ior: 0.5, ..Material::PLAIN }]);
    let textures = decoded(&scene, Detail::Light);
    let Finished { base, metallic, roughness, transmission, ior, emission, bend } =
        Finish::new(&scene, 0, &textures).at(0, 0.75, 0.1);
    assert_eq!((base, metallic, roughness, transmission), ([1.0, 0.0, 0.0], 1.0, 0.0, 0.0));
    assert_eq!((ior, emission, bend), (1.5, [0.0; 3], None));
    assert_eq!(Finish::new(&scene, 1, &textures).at(0, 0.0, 0.0).ior, 1.0);
}
