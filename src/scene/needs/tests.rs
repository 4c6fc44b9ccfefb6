use super::*;
use crate::scene::{Alpha, Instance, Light, LightKind, NormalTexture};

fn scene() -> Scene {
    let mesh = Mesh { positions: vec![Vec3::ZERO, Vec3::X, Vec3::Y], triangles: vec![[0, 1, 2]], ..Mesh::default() };
    Scene { meshes: vec![mesh.clone(), mesh], instances: vec![Instance::identity(0)], ..Scene::default() }
}

fn needs(scene: &Scene) -> Needs {
    Needs::of(scene, &Textures::none())
}

#[test]
fn a_plain_scene_needs_nothing_but_indices() {
    assert_eq!(needs(&scene()), Needs::default().with(Feature::Indices));
}

#[test]
fn what_only_an_unplaced_mesh_has_is_not_needed() {
    let mut scene = scene();
    scene.meshes[1].normals = vec![Vec3::Z; 3];
    assert!(!needs(&scene).has(Feature::Normals));
    scene.instances.push(Instance::identity(1));
    assert!(needs(&scene).has(Feature::Normals) && !needs(&scene).has(Feature::Transforms));
    scene.instances[1].world_from_object = Affine3A::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    assert!(needs(&scene).has(Feature::Transforms) && !needs(&scene).has(Feature::Instancing));
    scene.instances.push(Instance::identity(1));
    assert!(needs(&scene).has(Feature::Instancing));
}

#[test]
fn holes_are_needed_only_where_opacity_is_short_of_what_is_asked() {
    let mut scene = scene();
    let color = |alpha: f32| Material { base_color: [1.0, 1.0, 1.0, alpha], alpha: Alpha::Blend, ..Material::PLAIN };
    scene.meshes[0].material = Some(0);
    scene.materials = vec![color(1.0)];
    assert!(!needs(&scene).has(Feature::AlphaTest));
    scene.materials = vec![color(0.5)];
    assert!(needs(&scene).has(Feature::AlphaTest));
}

#[test]
fn white_colours_and_coordinates_that_nothing_reads_are_dropped() {
    let mut scene = scene();
    scene.meshes[0].colors = vec![WHITE; 3];
    scene.meshes[0].uvs = vec![Vec2::ZERO; 3];
    scene.meshes[1].colors = vec![WHITE, WHITE, [1.0, 1.0, 1.0, 0.5]];
    drop_idle(&mut scene);
    assert!(scene.meshes[0].colors.is_empty() && scene.meshes[0].uvs.is_empty() && scene.meshes[1].colors.len() == 3);
}

fn value(image: usize) -> ValueTexture {
    ValueTexture { texture: TextureUse { image, ..TextureUse::default() }, channel: Channel::Green }
}

#[test]
fn maps_of_surfaces_are_used_where_there_are_coordinates() {
    let mut scene = scene();
    let texture = value(0).texture;
    let maps = [
        Material { metallic_texture: Some(value(0)), ..Material::PLAIN },
        Material { roughness_texture: Some(value(0)), ..Material::PLAIN },
        Material { transmission_texture: Some(value(0)), ..Material::PLAIN },
        Material { normal_texture: Some(NormalTexture { texture, scale: 1.0 }), ..Material::PLAIN },
    ];
    for material in maps {
        scene.materials = vec![material];
        scene.meshes[0].material = Some(0);
        scene.meshes[0].uvs = Vec::new();
        assert!(!needs(&scene).has(Feature::SurfaceMaps), "no coordinates, no map");
        scene.meshes[0].uvs = vec![Vec2::ZERO; 3];
        drop_idle(&mut scene);
        let needs = needs(&scene);
        assert!(needs.has(Feature::SurfaceMaps) && needs.has(Feature::Uvs) && !needs.has(Feature::ColorMaps));
        let finding = needs.findings(&scene).into_iter().find(|f| f.feature == Feature::SurfaceMaps).expect("all are told");
        assert!(finding.why.ends_with(": 1 of 1 meshes."), "{}", finding.why);
    }
    scene.materials = vec![Material { emission: [1.0; 3], emission_texture: Some(texture), ..Material::PLAIN }];
    drop_idle(&mut scene);
    let needs = needs(&scene);
    assert!(needs.has(Feature::Emission) && needs.has(Feature::Uvs) && !needs.has(Feature::SurfaceMaps));
    scene.materials = vec![Material::PLAIN];
    drop_idle(&mut scene);
    assert!(scene.meshes[0].uvs.is_empty());
}

#[test]
fn lights_are_used_where_there_are_any() {
    let mut scene = scene();
    assert!(!needs(&scene).has(Feature::Lights));
    let (kind, before) = (LightKind::Point, scene.bytes().rest);
    scene.lights = vec![Light { name: String::new(), kind, color: [1.0; 3], at: Vec3::ZERO, towards: Vec3::X, range: None }];
    assert!(needs(&scene).has(Feature::Lights) && !needs(&scene).has(Feature::Emission));
    assert!(scene.bytes().rest > before);
    let why = |feature| needs(&scene).findings(&scene).into_iter().find(|f| f.feature == feature).expect("all are told").why;
    assert!(why(Feature::Lights).ends_with(": 1.") && !why(Feature::Emission).contains("sky"));
}

#[test]
fn filling_in_leaves_maps_and_coordinates_as_they_are() {
    let mut scene = scene();
    scene.images = vec![Image::white()];
    scene.materials = vec![Material { roughness_texture: Some(value(0)), ..Material::PLAIN }];
    scene.meshes[0].material = Some(0);
    scene.meshes[0].uvs = vec![Vec2::Y; 3];
    scene.fill_in();
    assert_eq!((scene.meshes[0].uvs[0], scene.meshes[1].uvs[0]), (Vec2::Y, Vec2::ZERO));
    let [first, second] = scene.materials.as_slice() else { panic!("two materials") };
    assert_eq!((first.roughness_texture, first.normal_texture), (Some(value(0)), None));
    for map in [first.metallic_texture, first.transmission_texture, second.roughness_texture] {
        assert_eq!(map.map(|map| map.texture.image), Some(1), "the white one");
    }
    assert_eq!(first.base_color_texture.map(|texture| texture.image), Some(1));
}

#[test]
fn every_feature_has_a_sentence_and_a_name_of_its_own() {
    for set in [Needs::default(), Needs::ALL] {
        let findings = set.findings(&scene());
        assert_eq!(findings.len(), Feature::ALL.len());
        assert!(findings.iter().all(|finding| finding.why.ends_with('.') && finding.used == set.has(finding.feature)));
    }
    for (i, feature) in Feature::ALL.into_iter().enumerate() {
        assert!(Feature::ALL[..i].iter().all(|other| other.id() != feature.id() && other.name() != feature.name()));
    }
}

#[test]
fn bytes_are_those_of_the_lists() {
    let mut scene = scene();
    let before = scene.bytes();
    assert_eq!((before.corners, before.unplaced, before.normals), (48, 48, 0));
    scene.fill_in();
    let filled = scene.bytes();
    assert_eq!((filled.normals, filled.colors, filled.uvs, filled.unplaced), (36, 48, 24, 48 + 36 + 48 + 24));
    assert!(filled.total() > before.total());
    scene.give_up_corners();
    assert_eq!(scene.bytes().corners, 12, "the indices of what vertices have");
}
