use super::textures::{first, square};
use super::*;
use crate::scene::texture::{Channel, Filter, TextureUse};
use glam::Vec2;

fn transform(x: f32) -> Value {
    json!({"KHR_texture_transform": {"offset": [x, 0.25], "scale": [2, 1]}})
}

/// Where a texture is looked up for the origin of the mesh's coordinates.
fn origin(texture: TextureUse) -> [f32; 2] {
    texture.transform.apply(Vec2::ZERO).to_array()
}

#[test]
fn each_map_has_its_channel_its_factor_and_its_place() {
    let (scene, material) = first(&json!([{
        "pbrMetallicRoughness": {
            "metallicFactor": 0.5, "roughnessFactor": 0.25,
            "metallicRoughnessTexture": {"index": 1, "extensions": transform(0.125)},
        },
        "normalTexture": {"index": 0, "scale": 0.5, "extensions": transform(0.25)},
        "emissiveFactor": [1, 0.5, 0],
        "emissiveTexture": {"index": 0, "extensions": transform(0.375)},
        "extensions": {
            "KHR_materials_emissive_strength": {"emissiveStrength": 4},
            "KHR_materials_transmission": {
                "transmissionFactor": 0.75, "transmissionTexture": {"index": 0, "extensions": transform(0.5)},
            },
        },
    }]));
    let [metallic, roughness, transmission] =
        [material.metallic_texture, material.roughness_texture, material.transmission_texture].map(|map| map.expect("a map"));
    assert_eq!((metallic.channel, roughness.channel, transmission.channel), (Channel::Blue, Channel::Green, Channel::Red));
    assert_eq!((material.metallic, material.roughness, material.transmission), (0.5, 0.25, 0.75));
    assert_eq!(material.emission, [4.0, 2.0, 0.0]);
    let (normal, emission) = (material.normal_texture.expect("a map"), material.emission_texture.expect("a map"));
    assert_eq!(normal.scale, 0.5);
    let all = [metallic.texture, roughness.texture, normal.texture, emission, transmission.texture];
    assert_eq!(all.map(origin), [0.125, 0.125, 0.25, 0.375, 0.5].map(|x| [x, 0.25]));
    assert_eq!(normal.texture.transform.apply(Vec2::ONE).to_array(), [2.25, 1.25]);
    assert_eq!((metallic.texture.sampler.filter, emission.sampler.filter), (Filter::Nearest, Filter::Linear));
    assert!(all.iter().all(|texture| texture.image == 0) && material.base_color_texture.is_none());
    assert_eq!((scene.images.len(), scene.meshes[0].uvs[1], scene.warnings.len()), (1, Vec2::X, 0));
}

#[test]
fn maps_of_another_set_of_coordinates_are_left_out() {
    let told = |n: usize| [format!("Maps that go by a second set of texture coordinates were left out: {n}.")];
    let other = json!({"index": 0, "extensions": {"KHR_texture_transform": {"texCoord": 1}}});
    let (scene, material) = first(&json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicRoughnessTexture": {"index": 0, "texCoord": 1}},
        "normalTexture": other,
        "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0},
    }]));
    assert_eq!((scene.meshes[0].uvs[0], scene.warnings.as_slice()), (Vec2::ZERO, told(2).as_slice()));
    assert!(material.metallic_texture.is_none() && material.roughness_texture.is_none() && material.normal_texture.is_none());
    assert!(material.base_color_texture.is_some() && material.emission_texture.is_some());
    // Without a colour the first of the others has the choice. What would shine somewhere does not shine everywhere.
    let mut second = json!([{
        "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0, "texCoord": 1}},
        "normalTexture": other,
        "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0},
    }]);
    let (scene, material) = first(&second);
    assert_eq!((scene.meshes[0].uvs[0], scene.warnings.as_slice()), (Vec2::X, told(1).as_slice()));
    assert!(material.metallic_texture.is_some() && material.normal_texture.is_some());
    assert_eq!((material.emission, material.emission_texture), ([0.0; 3], None));
    // A material that nothing shown is made of is not worth a word.
    let unseen = second[0].take();
    let (scene, _) = first(&json!([{}, unseen]));
    assert!(scene.warnings.is_empty() && scene.images.is_empty());
}

#[test]
fn what_is_multiplied_by_nothing_is_not_read() {
    let rough = |metallic: f32, roughness: f32| {
        let texture = json!({"index": 0});
        let factors = json!({"metallicFactor": metallic, "roughnessFactor": roughness, "metallicRoughnessTexture": texture});
        let (scene, material) = first(&json!([{"pbrMetallicRoughness": factors}]));
        (material.metallic_texture.is_some(), material.roughness_texture.is_some(), scene.images.len())
    };
    assert_eq!(rough(1.0, 0.5), (true, true, 1));
    assert_eq!(rough(0.0, 0.5), (false, true, 1));
    assert_eq!(rough(0.5, 0.0), (true, false, 1));
    assert_eq!(rough(0.0, 0.0), (false, false, 0));
    let clear = json!({"KHR_materials_transmission": {"transmissionTexture": {"index": 0}}});
    let (scene, material) = first(&json!([{"emissiveTexture": {"index": 0}, "extensions": clear}]));
    assert!(material.emission_texture.is_none() && material.transmission_texture.is_none());
    assert!(scene.images.is_empty() && scene.meshes[0].uvs.is_empty());
}

#[test]
fn glossiness_has_no_map() {
    let glossy = json!({"glossinessFactor": 0.75, "specularGlossinessTexture": {"index": 0}});
    let (scene, material) = first(&json!([{
        "pbrMetallicRoughness": {"metallicRoughnessTexture": {"index": 0}},
        "extensions": {"KHR_materials_pbrSpecularGlossiness": glossy},
    }]));
    assert_eq!((material.roughness, material.is_textured(), scene.images.len()), (0.25, false, 0));
    assert!(scene.warnings.is_empty());
}

#[test]
fn the_images_of_all_maps_are_taken_and_those_not_there_dropped() {
    let materials = json!([{
        "pbrMetallicRoughness": {"baseColorTexture": {"index": 2}, "metallicRoughnessTexture": {"index": 2}},
        "normalTexture": {"index": 0, "scale": 1e39},
        "emissiveFactor": [1, 1, 1], "emissiveTexture": {"index": 0},
    }]);
    let (scene, material) = first(&materials);
    assert_eq!(scene.images.iter().map(|image| image.name.as_str()).collect::<Vec<_>>(), ["1", "0"]);
    let [base, emission] = [material.base_color_texture, material.emission_texture].map(|texture| texture.expect("a map").image);
    assert_eq!((base, material.metallic_texture.map(|map| map.texture.image), emission), (0, Some(0), 1));
    assert_eq!(material.normal_texture.map(|map| (map.texture.image, map.scale)), Some((1, 1.0)));
    let mut model = square(&materials);
    model.json["images"][1] = json!({});
    let scene = read(&model.text());
    let material = &scene.materials[0];
    assert_eq!((scene.images.len(), scene.warnings.len()), (1, 1), "{:?}", scene.warnings);
    assert!(material.base_color_texture.is_none() && material.metallic_texture.is_none() && material.roughness_texture.is_none());
    assert_eq!((material.emission_texture.map(|texture| texture.image), material.emission), (Some(0), [1.0; 3]));
}
