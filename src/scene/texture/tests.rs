use std::io::Cursor;
use std::sync::Arc;

use glam::Vec2;
use image::{DynamicImage, GrayImage, ImageFormat, RgbImage, RgbaImage};

use super::*;
use crate::scene::{Alpha, Instance, Keep, LoadCx, Material, Mesh, NormalTexture, Scene, ValueTexture};
use crate::task::{Budget, Cancel};

/// An image in the PNG format, of rows of `width` texels.
pub(in crate::scene) fn png(width: u32, texels: &[[u8; 4]]) -> Vec<u8> {
    let height = u32::try_from(texels.len()).expect("small") / width;
    stored(RgbaImage::from_raw(width, height, texels.concat()).expect("whole rows").into(), ImageFormat::Png)
}

fn stored(image: DynamicImage, format: ImageFormat) -> Vec<u8> {
    let mut bytes = Vec::new();
    image.write_to(&mut Cursor::new(&mut bytes), format).expect("a vector takes it");
    bytes
}

/// A scene of one triangle for each material, and images of these bytes.
pub(in crate::scene) fn scene(images: &[Vec<u8>], materials: Vec<Material>) -> Scene {
    let images = images.iter().enumerate();
    let images = images.map(|(i, bytes)| Image { name: i.to_string(), source: ImageSource::Bytes(bytes.as_slice().into()) });
    let mesh = |m| Mesh {
        positions: vec![glam::Vec3::ZERO, glam::Vec3::X, glam::Vec3::Y],
        triangles: vec![[0, 1, 2]],
        uvs: vec![Vec2::ZERO, Vec2::X, Vec2::Y],
        material: Some(m),
        ..Mesh::default()
    };
    Scene {
        meshes: (0..materials.len()).map(mesh).collect(),
        instances: (0..materials.len()).map(Instance::identity).collect(),
        images: images.collect(),
        materials,
        ..Scene::default()
    }
}

/// A material whose colour is image `color`, and opacity that channel of image `alpha`.
pub(in crate::scene) fn material(color: Option<usize>, alpha: Option<(usize, Channel)>) -> Material {
    let use_of = |image| TextureUse { image, sampler: NEAREST, ..TextureUse::default() };
    Material {
        base_color: [1.0; 4],
        base_color_texture: color.map(use_of),
        alpha_texture: alpha.map(|(image, channel)| ValueTexture { texture: use_of(image), channel }),
        alpha: if alpha.is_some() { Alpha::Blend } else { Alpha::Opaque },
        ..Material::PLAIN
    }
}

const NEAREST: Sampler = Sampler { wrap_u: Wrap::Repeat, wrap_v: Wrap::Repeat, filter: Filter::Nearest };

fn sampler(wrap: Wrap, filter: Filter) -> Sampler {
    Sampler { wrap_u: wrap, wrap_v: wrap, filter }
}

fn decoded(scene: &Scene) -> Textures {
    Textures::decode(scene, Detail::Colors, &LoadCx::unattended()).expect("not cancelled")
}

/// A row of four greys, 0, 85, 170 and 255, whose red channel is read.
fn ramp() -> Arc<Texture> {
    let ramp = GrayImage::from_raw(4, 1, vec![0, 85, 170, 255]).expect("whole rows");
    let scene = scene(&[stored(ramp.into(), ImageFormat::Png)], vec![material(None, Some((0, Channel::Red)))]);
    decoded(&scene).get(0).expect("it is read").clone()
}

/// The texel in thirds.
fn thirds(texture: &Texture, wrap: Wrap, filter: Filter, u: f32) -> f32 {
    texture.value(Vec2::new(u, 0.5), &sampler(wrap, filter), Channel::Red) * 3.0
}

#[test]
fn beyond_the_edges() {
    let ramp = ramp();
    let at = [-1.125, -0.125, 0.125, 0.875, 1.125, 1.375];
    for (wrap, expected) in [
        (Wrap::Repeat, [3.0, 3.0, 0.0, 3.0, 0.0, 1.0]),
        (Wrap::Mirror, [3.0, 0.0, 0.0, 3.0, 3.0, 2.0]),
        (Wrap::Clamp, [0.0, 0.0, 0.0, 3.0, 3.0, 3.0]),
    ] {
        for filter in [Filter::Nearest, Filter::Linear] {
            // At their centres both filters see the texels themselves.
            assert_eq!(at.map(|u| thirds(&ramp, wrap, filter, u)), expected, "{wrap:?} {filter:?}");
        }
    }
}

#[test]
fn between_texels() {
    let ramp = ramp();
    let at = [0.25, 0.3125, 0.0, 1.0, -1.0, 2.0];
    for (wrap, expected) in [
        (Wrap::Repeat, [0.5, 0.75, 1.5, 1.5, 1.5, 1.5]),
        (Wrap::Mirror, [0.5, 0.75, 0.0, 3.0, 3.0, 0.0]),
        (Wrap::Clamp, [0.5, 0.75, 0.0, 3.0, 0.0, 3.0]),
    ] {
        let seen = at.map(|u| thirds(&ramp, wrap, Filter::Linear, u));
        assert!(seen.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-6), "{wrap:?}: {seen:?}");
    }
}

#[test]
fn whatever_the_coordinates_the_value_is_of_the_image() {
    let ramp = ramp();
    let tiny = f32::MIN_POSITIVE;
    let odd = [
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::MAX,
        f32::MIN,
        1e30,
        -1e9,
        tiny,
        -tiny,
        -1e-9,
        0.999_999_94,
        16_777_216.0,
    ];
    for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
        for filter in [Filter::Nearest, Filter::Linear] {
            for (u, v) in odd.iter().flat_map(|u| odd.iter().map(move |v| (*u, *v))) {
                let value = ramp.value(Vec2::new(u, v), &sampler(wrap, filter), Channel::Red);
                assert!((0.0..=1.0).contains(&value), "{value} at {u}, {v}, {wrap:?} {filter:?}");
            }
        }
    }
    assert_eq!(thirds(&ramp, Wrap::Repeat, Filter::Nearest, -1e-9), 3.0);
    assert_eq!(thirds(&ramp, Wrap::Clamp, Filter::Nearest, f32::INFINITY), 3.0);
}

#[test]
fn colours_are_filtered_as_light() {
    let scene = scene(&[png(2, &[[0, 0, 0, 255], [255, 188, 255, 255]])], vec![material(Some(0), None)]);
    let textures = decoded(&scene);
    let texture = textures.get(0).expect("it is read");
    let [r, g, b, a] = texture.color(Vec2::new(0.5, 0.5), &sampler(Wrap::Clamp, Filter::Linear));
    assert_eq!((r, b, a), (0.5, 0.5, 1.0));
    assert!((g - 0.25).abs() < 0.002, "188 is half the light of 255: {g}");
}

#[test]
fn only_what_is_read_is_kept() {
    let (varied, solid) = ([[9, 9, 9, 7], [1, 2, 3, 255]], [[9, 9, 9, 255], [1, 2, 3, 255]]);
    let cutout = material(Some(0), Some((0, Channel::Alpha)));
    let bytes = |texels: &[[u8; 4]], material: Material| {
        let textures = decoded(&scene(&[png(2, texels)], vec![material]));
        (textures.bytes(), textures.get(0).is_some_and(|texture| texture.is_one(Channel::Alpha)))
    };
    assert_eq!(bytes(&varied, material(Some(0), None)), (6, true), "an opaque surface needs no alpha");
    assert_eq!(bytes(&varied, cutout.clone()), (8, false));
    assert_eq!(bytes(&solid, cutout), (6, true), "nor does alpha that says nothing");
    assert_eq!(bytes(&varied, material(None, Some((0, Channel::Alpha)))), (2, false));
    assert_eq!(bytes(&solid, material(None, Some((0, Channel::Alpha)))), (2, true));
    let mut unseen = scene(&[png(2, &varied)], vec![material(Some(0), None)]);
    unseen.instances.clear();
    assert!(decoded(&unseen).get(0).is_none());
}

/// A material whose colour is image 0 and that reads its other maps from images 1 to 3.
fn finished(emission: usize) -> Material {
    let value = |image, channel| material(None, Some((image, channel))).alpha_texture;
    let texture = material(Some(2), None).base_color_texture.expect("a texture");
    Material {
        metallic_texture: value(1, Channel::Blue),
        roughness_texture: value(1, Channel::Green),
        normal_texture: Some(NormalTexture { texture, scale: 1.0 }),
        transmission_texture: value(3, Channel::Red),
        emission_texture: material(Some(emission), None).base_color_texture,
        ..material(Some(0), None)
    }
}

#[test]
fn only_paths_of_light_need_more_than_colours() {
    let images = [(); 4].map(|()| png(2, &[[10, 20, 30, 255], [40, 50, 60, 70]]));
    let scene_of = |emission| scene(&images, vec![finished(emission)]);
    let bytes = |scene: &Scene, detail| {
        let textures = Textures::decode(scene, detail, &LoadCx::unattended()).expect("not cancelled");
        [0, 1, 2, 3].map(|image| textures.get(image).map_or(0, |texture| texture.bytes()))
    };
    assert_eq!(bytes(&scene_of(0), Detail::Colors), [6, 0, 0, 0]);
    // Two channels of one image take all three; one alone takes itself.
    assert_eq!(bytes(&scene_of(0), Detail::Light), [6, 6, 6, 2]);
    assert_eq!(bytes(&scene_of(3), Detail::Light), [6, 6, 6, 6], "a colour and a value of one image");
    let mut cutout = scene_of(0);
    cutout.materials[0].alpha_texture = material(None, Some((3, Channel::Alpha))).alpha_texture;
    assert_eq!(bytes(&cutout, Detail::Light), [6, 6, 6, 2], "an opaque surface has no opacity");
    cutout.materials[0].alpha = Alpha::Blend;
    assert_eq!(bytes(&cutout, Detail::Colors), [6, 0, 0, 2]);
    assert_eq!(bytes(&cutout, Detail::Light), [6, 6, 6, 8]);
    cutout.instances.clear();
    assert_eq!(bytes(&cutout, Detail::Light), [0; 4]);
    let all = LoadCx { keep: Keep::All, ..LoadCx::unattended() };
    assert_eq!(Textures::decode(&scene_of(0), Detail::Colors, &all).expect("not cancelled").bytes(), 4 * 8);
}

#[test]
fn values_are_as_stored_and_colours_are_light() {
    let images = [(); 4].map(|()| png(1, &[[51, 102, 153, 255]]));
    let textures = Textures::decode(&scene(&images, vec![finished(0)]), Detail::Light, &LoadCx::unattended()).expect("decoded");
    let at = |image: usize| textures.get(image).expect("it is read");
    let uv = Vec2::splat(0.5);
    assert_eq!((at(1).value(uv, &NEAREST, Channel::Green), at(1).value(uv, &NEAREST, Channel::Blue)), (0.4, 0.6));
    assert_eq!(at(2).stored(uv, &NEAREST), [0.2, 0.4, 0.6]);
    assert_eq!(at(3).value(uv, &NEAREST, Channel::Red), 0.2);
    let [red, ..] = at(0).color(uv, &NEAREST);
    assert!((red - 0.0331).abs() < 1e-4, "{red}");
    assert!(at(2).has_colors() && !at(3).has_colors() && at(3).has(Channel::Red) && !at(3).has(Channel::Green));
}

#[test]
fn the_mean_is_of_light() {
    let mean =
        |texels: &[[u8; 4]]| decoded(&scene(&[png(2, texels)], vec![material(Some(0), None)])).get(0).unwrap().mean_color();
    assert_eq!(mean(&[[0, 255, 7, 255], [255, 255, 7, 255]])[..2], [0.5, 1.0]);
    let [r, g, b] = mean(&[[0, 188, 0, 255], [0, 188, 0, 255], [255, 0, 0, 255], [0, 0, 0, 255]]);
    assert_eq!((r, b), (0.25, 0.0));
    assert!((g - 0.25).abs() < 0.002, "188 is half the light of 255: {g}");
}

#[test]
fn masks_are_alpha_or_brightness() {
    let value = |texels: &[[u8; 4]], channel| {
        let textures = decoded(&scene(&[png(2, texels)], vec![material(None, Some((0, channel)))]));
        textures.get(0).expect("it is read").value(Vec2::new(0.25, 0.5), &NEAREST, Channel::Mask) * 255.0
    };
    let (varied, solid) = ([[10, 20, 30, 40], [0; 4]], [[10, 20, 30, 255], [0, 0, 0, 255]]);
    assert_eq!([Channel::Red, Channel::Green, Channel::Blue].map(|c| value(&varied, c)), [10.0, 20.0, 30.0]);
    assert_eq!([Channel::Alpha, Channel::Mask].map(|c| value(&varied, c)), [40.0, 40.0]);
    assert_eq!([Channel::Alpha, Channel::Mask, Channel::Luminance].map(|c| value(&solid, c)), [255.0, 19.0, 19.0]);
    assert_eq!(value(&[[255; 4], [255; 4]], Channel::Luminance), 255.0);
}

#[test]
fn one_image_may_be_read_in_several_ways() {
    let materials =
        vec![material(Some(0), None), material(None, Some((0, Channel::Alpha))), material(None, Some((0, Channel::Green)))];
    let textures = decoded(&scene(&[png(1, &[[255, 51, 0, 102]])], materials));
    let texture = textures.get(0).expect("it is read");
    let uv = Vec2::splat(0.5);
    assert_eq!(texture.color(uv, &NEAREST)[0], 1.0);
    assert_eq!((texture.alpha(uv, &NEAREST), texture.value(uv, &NEAREST, Channel::Green)), (0.4, 0.2));
}

#[test]
fn other_formats() {
    let rgb = DynamicImage::from(RgbImage::from_raw(2, 2, [200u8; 12].to_vec()).expect("whole rows"));
    for format in [ImageFormat::Jpeg, ImageFormat::Bmp, ImageFormat::Tga, ImageFormat::WebP] {
        let mut scene = scene(&[stored(rgb.clone(), format)], vec![material(Some(0), None)]);
        // A TGA is told by its name alone.
        scene.images[0].name = format!("x.{}", format.extensions_str()[0]);
        let textures = decoded(&scene);
        let seen = textures.get(0).unwrap_or_else(|| panic!("{:?}", textures.warnings()));
        assert!((seen.color(Vec2::splat(0.5), &NEAREST)[1] - 0.578).abs() < 0.01, "{format:?}");
    }
    let deep = DynamicImage::from(rgb.to_rgba16());
    let textures = decoded(&scene(&[stored(deep, ImageFormat::Png)], vec![material(Some(0), None)]));
    assert_eq!(textures.bytes(), 12);
}

#[test]
fn broken_images_are_warnings() {
    let good = png(2, &[[255; 4]; 4]);
    let rgb = DynamicImage::from(RgbImage::from_raw(2, 2, [200u8; 12].to_vec()).expect("whole rows"));
    let mut huge = stored(rgb, ImageFormat::Tga);
    huge[12..14].copy_from_slice(&40_000u16.to_le_bytes()); // the width
    let cut = good[..good.len() / 2].to_vec();
    let images = [good, huge, cut, b"no image".to_vec(), Vec::new()];
    let mut scene = scene(&images, (0..6).map(|i| material(Some(i), None)).collect());
    scene.images[1].name = "huge.tga".into();
    scene.images.push(Image { name: "none.png".into(), source: ImageSource::File("/nowhere/none.png".into()) });
    let textures = decoded(&scene);
    assert_eq!((0..7).map(|i| textures.get(i).is_some()).collect::<Vec<_>>(), [true, false, false, false, false, false, false]);
    assert_eq!(textures.warnings().len(), 4);
    let told = textures.warnings();
    let too_large = "it has 40000 by 2 texels, and no side may have more than 32768";
    assert_eq!(told[0], format!("The image huge.tga can't be read, and is white: {too_large}."));
    assert_eq!(told[3], "More images can't be read, and are white: 2.");
    assert!(textures.warnings().iter().all(|w| w.ends_with('.') && w.len() < 200), "{:?}", textures.warnings());
}

#[test]
fn what_does_not_fit_the_budget_is_left_out() {
    let images = [png(100, &[[1; 4]; 10_000]), png(2, &[[255; 4]; 4])];
    let scene = scene(&images, vec![material(Some(0), None), material(Some(1), None)]);
    let cx = LoadCx { budget: Budget::new(20_000), ..LoadCx::unattended() };
    let textures = Textures::decode(&scene, Detail::Colors, &cx).expect("not cancelled");
    assert!(textures.get(0).is_none() && textures.get(1).is_some());
    assert!(textures.warnings()[0].contains("memory budget"), "{:?}", textures.warnings());
    assert_eq!(cx.budget.used(), textures.bytes());
    drop(textures);
    assert_eq!(cx.budget.used(), 0);
}

#[test]
fn it_stops_when_cancelled() {
    let scene = scene(&[png(1, &[[0; 4]])], vec![material(Some(0), None)]);
    let cx = LoadCx { cancel: Cancel::new(), ..LoadCx::unattended() };
    cx.cancel.cancel();
    assert!(Textures::decode(&scene, Detail::Colors, &cx).is_err());
}

#[test]
fn transforms_scale_then_turn_then_move() {
    let quarter = std::f32::consts::FRAC_PI_2;
    let near = |a: Vec2, b: [f32; 2]| assert!(a.distance(Vec2::from_array(b)) < 1e-6, "{a}");
    near(UvTransform::khr([0.0; 2], quarter, [1.0; 2]).apply(Vec2::X), [0.0, -1.0]);
    near(UvTransform::khr([0.0; 2], quarter, [1.0; 2]).apply(Vec2::Y), [1.0, 0.0]);
    near(UvTransform::khr([0.25, 0.5], quarter, [2.0, 3.0]).apply(Vec2::ONE), [3.25, -1.5]);
    near(UvTransform::mtl([0.0, 0.25], [1.0, 2.0]).apply(Vec2::new(0.5, 0.25)), [0.5, 0.25]);
    assert_eq!(UvTransform::default().apply(Vec2::new(0.1, 0.2)), Vec2::new(0.1, 0.2));
}
