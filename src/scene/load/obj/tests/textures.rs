use super::*;
use crate::scene::needs::drop_idle;
use crate::scene::texture::{Channel, ImageSource, Wrap};
use crate::scene::{Alpha, Material};

/// A triangle of each of these materials.
fn scene(library: &str, mtl: &str) -> Scene {
    let names = mtl.lines().filter_map(|line| line.strip_prefix("newmtl "));
    let faces: String = names.map(|name| format!("usemtl {name}\nf 1/1 2/2 3/3\n")).collect();
    let text = format!("mtllib {library}\n{SQUARE}vt 0 0\nvt 1 0\nvt 1 1\n{faces}");
    let mut scene = Obj.load(text.as_bytes(), &Beside(&[(library, mtl.as_bytes())]), &LoadCx::unattended()).expect("a model");
    drop_idle(&mut scene);
    check(&scene);
    scene
}

fn file(scene: &Scene, image: usize) -> String {
    match &scene.images[image].source {
        ImageSource::File(path) => path.to_string_lossy().into_owned(),
        ImageSource::Bytes(_) => unreachable!("an MTL file holds no images"),
    }
}

/// The image of a material's colour.
fn color_file(scene: &Scene, material: usize) -> Option<String> {
    scene.materials[material].base_color_texture.map(|texture| file(scene, texture.image))
}

/// tinyobjloader's texture-options-issue-85, a part of each material.
#[test]
fn options_of_maps() {
    let scene = scene(
        "x.mtl",
        "newmtl default\nKd 0 0 0\nmap_Ka -clamp on ambient.jpg\nmap_Kd -o 0.1 diffuse.jpg\nmap_bump -bm 3 bumpmap.jpg\n\n\
         newmtl bm2\nKd 0 0 0\n# blendu\nmap_Kd -blendu on diffuse.jpg\nmap_bump -imfchan r bumpmap2.jpg -bm 1.5\n\n\
         newmtl bm3\nKd 0 0 0\nmap_Kd -clamp on -type sphere diffuse.jpg\nmap_d -type cube_right alpha.jpg\n",
    );
    assert_eq!([0, 1, 2].map(|m| color_file(&scene, m).expect("a texture")), ["diffuse.jpg"; 3]);
    let [first, _, third] = scene.materials.as_slice() else { panic!("three materials") };
    assert_eq!(scene.images.len(), 2, "the same file is one image, and others are not looked at");
    assert_eq!(first.base_color, [1.0; 4], "black would hide the image");
    let texture = first.base_color_texture.expect("a texture");
    assert_eq!(texture.transform.apply(glam::Vec2::ZERO).to_array(), [0.1, 1.0]);
    assert_eq!(third.base_color_texture.map(|t| t.sampler.wrap_u), Some(Wrap::Clamp));
    let alpha = third.alpha_texture.expect("a texture");
    assert_eq!(
        (file(&scene, alpha.texture.image), alpha.channel, third.alpha),
        ("alpha.jpg".into(), Channel::Mask, Alpha::Blend)
    );
    assert_eq!((first.alpha, first.alpha_texture), (Alpha::Opaque, None));
}

/// tinyobjloader's texture-filename-with-whitespace.
#[test]
fn names_with_blanks_relative_to_the_library() {
    let mtl = "newmtl white\nKd 1 1 1\n# filename with white space.\nmap_Kd texture 01.png\n\nnewmtl red\nKd 1 0 0\n";
    let beside = scene("x.mtl", mtl);
    assert_eq!(color_file(&beside, 0).expect("a texture"), "texture 01.png");
    assert!(!beside.meshes[0].uvs.is_empty() && beside.meshes[1].uvs.is_empty(), "only where an image is looked up");
    assert_eq!(color_file(&scene("parts/x.mtl", mtl), 0).expect("a texture"), "parts/texture 01.png");
    assert_eq!(color_file(&scene("parts\\x.mtl", mtl), 0).expect("a texture"), "parts\\texture 01.png");
}

#[test]
fn opacity_blends() {
    let alpha = |statements: &str| {
        let Material { alpha, alpha_texture, base_color, .. } =
            scene("x.mtl", &format!("newmtl a\n{statements}\n")).materials[0].clone();
        (alpha, alpha_texture.map(|alpha| alpha.channel), base_color[3])
    };
    assert_eq!(alpha("Kd 1 1 1"), (Alpha::Opaque, None, 1.0));
    assert_eq!(alpha("d 0.5"), (Alpha::Blend, None, 0.5));
    assert_eq!(alpha("Tr 0.25"), (Alpha::Blend, None, 0.75));
    assert_eq!(alpha("Tr 1"), (Alpha::Opaque, None, 1.0), "as MeshLab writes it");
    assert_eq!(alpha("d 1\nTr 1"), (Alpha::Opaque, None, 1.0));
    assert_eq!(alpha("d 0.5\nmap_Kd leaf.png"), (Alpha::Blend, None, 0.5), "its alpha is not meant");
    assert_eq!(alpha("map_d leaf.png\nmap_Kd leaf.png"), (Alpha::Blend, Some(Channel::Alpha), 1.0));
    assert_eq!(alpha("map_d mask.png\nmap_Kd leaf.png"), (Alpha::Blend, Some(Channel::Mask), 1.0));
    assert_eq!(alpha("map_d -imfchan l leaf.png\nmap_Kd leaf.png"), (Alpha::Blend, Some(Channel::Luminance), 1.0));
}

#[test]
fn the_factor_of_an_image() {
    let color = |statements: &str| scene("x.mtl", &format!("newmtl a\n{statements}\n")).materials[0].base_color;
    assert_eq!(color("map_Kd x.png"), [1.0; 4]);
    assert_eq!(color("Kd 0.5\nmap_Kd x.png"), [0.5, 0.5, 0.5, 1.0]);
    assert_eq!(color("Kd 0 0 0"), [0.0, 0.0, 0.0, 1.0]);
}

#[test]
fn maps_of_what_paths_of_light_need() {
    let all = "map_Ke glow.png\nmap_Pr -imfchan g orm.png\nmap_Pm -imfchan b -o 0.5 orm.png\nnorm -clamp on bumps.png\nmap_Bump no.png\nbump no.png";
    let scene = scene("x.mtl", &format!("newmtl a\nKe 0 0 0\n{all}\n"));
    let material = &scene.materials[0];
    assert_eq!(scene.images.iter().map(|image| image.name.as_str()).collect::<Vec<_>>(), ["glow.png", "orm.png", "bumps.png"]);
    assert!(!scene.meshes[0].uvs.is_empty() && material.base_color_texture.is_none());
    assert_eq!((material.emission, material.emission_texture.map(|t| t.image)), ([1.0; 3], Some(0)));
    let [rough, metal] = [material.roughness_texture, material.metallic_texture].map(|map| map.expect("a texture"));
    assert_eq!((rough.texture.image, rough.channel), (1, Channel::Green));
    assert_eq!((metal.texture.image, metal.channel), (1, Channel::Blue));
    assert_eq!(metal.texture.transform.apply(glam::Vec2::ZERO).to_array(), [0.5, 1.0]);
    assert_eq!((material.roughness, material.metallic), (1.0, 1.0));
    let normal = material.normal_texture.expect("a texture");
    assert_eq!((normal.texture.image, normal.texture.sampler.wrap_u, normal.scale), (2, Wrap::Clamp, 1.0));
}

#[test]
fn factors_of_what_paths_of_light_need() {
    let of = |statements: &str| {
        let Material { emission, roughness, metallic, roughness_texture, .. } =
            scene("x.mtl", &format!("newmtl a\n{statements}\n")).materials[0].clone();
        (emission, roughness, metallic, roughness_texture.map(|map| map.channel))
    };
    let dark = [0.0; 3];
    assert_eq!(of("map_ke x.png\nKe 0.5 0.25 0"), ([0.5, 0.25, 0.0], 1.0, 0.0, None));
    assert_eq!(of("map_ke x.png"), ([1.0; 3], 1.0, 0.0, None));
    assert_eq!(of("Ks 1 1 1\nNs 100\nmap_Pr x.png"), (dark, 1.0, 0.0, Some(Channel::Luminance)));
    assert_eq!(of("Pr 0.5\nmap_Pr x.png\nPm 0.25\nmap_Pm y.png"), (dark, 0.5, 0.25, Some(Channel::Luminance)));
    assert_eq!(of("Pr 0\nmap_Pr x.png\nPm 0\nmap_Pm y.png"), (dark, 1.0, 1.0, Some(Channel::Luminance)));
    assert_eq!(of("Pr 0\nPm 0"), (dark, 0.0, 0.0, None));
}
