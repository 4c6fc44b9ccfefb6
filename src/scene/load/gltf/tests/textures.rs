use super::*;
use crate::scene::texture::tests::png;
use crate::scene::texture::{Detail, Filter, ImageSource, Textures, Wrap};
use crate::scene::{Alpha, Material};
use glam::Vec2;

const RED: [u8; 4] = [255, 0, 0, 255];
const GREEN: [u8; 4] = [0, 255, 0, 255];

/// A strip of two triangles with two sets of texture coordinates, the second the other way round,
/// made of material 0.
pub(super) fn square(materials: &Value) -> Model {
    let mut model = Model::square();
    let uvs = [[0f32, 0.], [1., 0.], [0., 1.], [1., 1.]];
    let mut set = |uvs: [[f32; 2]; 4]| {
        let view = model.view(bytemuck::cast_slice(&uvs));
        model.accessor(json!({"bufferView": view, "componentType": FLOAT, "type": "VEC2", "count": 4}))
    };
    let (first, second) = (set(uvs), set(uvs.map(|[u, v]| [1.0 - u, v])));
    model.json["materials"] = materials.clone();
    model.json["textures"] = json!([{"source": 0}, {"source": 0, "sampler": 0}, {"source": 1}, {}]);
    model.json["samplers"] = json!([{"wrapS": 33071, "wrapT": 33648, "magFilter": 9728}]);
    model.json["images"] = json!([{"uri": data_uri(&png(2, &[RED, GREEN]))}, {"uri": data_uri(b"broken")}]);
    model.with(json!({"attributes": {"POSITION": 0, "TEXCOORD_0": first, "TEXCOORD_1": second}, "mode": 5, "material": 0}))
}

fn data_uri(bytes: &[u8]) -> String {
    format!("data:image/png;base64,{}", base64::engine::general_purpose::STANDARD.encode(bytes))
}

/// A material whose colour is texture 1, with these members in place of its own.
fn textured(more: &Value) -> Value {
    let mut material = json!({"pbrMetallicRoughness": {"baseColorTexture": {"index": 1}}});
    material.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
    json!([material])
}

pub(super) fn first(materials: &Value) -> (Scene, Material) {
    let scene = read(&square(materials).text());
    let material = scene.materials[0].clone();
    (scene, material)
}

#[test]
fn the_colour_is_an_image() {
    let (scene, material) = first(&textured(&json!({})));
    let texture = material.base_color_texture.expect("a texture");
    let sampler = texture.sampler;
    assert_eq!((sampler.wrap_u, sampler.wrap_v, sampler.filter), (Wrap::Clamp, Wrap::Mirror, Filter::Nearest));
    assert_eq!((texture.image, scene.images.len(), scene.meshes[0].uvs[1]), (0, 1, Vec2::X));
    assert_eq!((material.alpha, material.alpha_texture), (Alpha::Opaque, None));
    let textures = Textures::decode(&scene, Detail::Colors, &LoadCx::unattended()).expect("not cancelled");
    assert_eq!(textures.get(0).expect("an image").color(Vec2::new(0.75, 0.5), &sampler), [0.0, 1.0, 0.0, 1.0]);
}

#[test]
fn alpha_modes() {
    let (_, mask) = first(&textured(&json!({"alphaMode": "MASK"})));
    assert_eq!((mask.alpha, mask.alpha_texture.map(|a| a.texture)), (Alpha::Mask { cutoff: 0.5 }, mask.base_color_texture));
    let (_, own) = first(&textured(&json!({"alphaMode": "MASK", "alphaCutoff": 0.25})));
    assert_eq!(own.alpha, Alpha::Mask { cutoff: 0.25 });
    let (_, blend) = first(&json!([{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [1, 1, 1, 0.5]}}]));
    assert_eq!((blend.alpha, blend.base_color[3], blend.alpha_texture), (Alpha::Blend, 0.5, None));
}

#[test]
fn transforms_may_name_another_set() {
    let info = |more: Value| {
        let mut info = json!({"index": 0, "texCoord": 0});
        info.as_object_mut().expect("an object").extend(more.as_object().expect("an object").clone());
        first(&json!([{"pbrMetallicRoughness": {"baseColorTexture": info}}]))
    };
    let (scene, _) = info(json!({"texCoord": 1}));
    assert_eq!(scene.meshes[0].uvs[0], Vec2::X);
    let transform = json!({"offset": [0.5, 0.25], "scale": [2, 1], "texCoord": 1});
    let (scene, material) = info(json!({"extensions": {"KHR_texture_transform": transform}}));
    assert_eq!(scene.meshes[0].uvs[0], Vec2::X);
    let transform = material.base_color_texture.expect("a texture").transform;
    assert_eq!(transform.apply(Vec2::ONE), Vec2::new(2.5, 1.25));
    let (scene, _) = info(json!({"texCoord": 7}));
    assert!(scene.meshes[0].uvs.is_empty() && scene.images.is_empty(), "without coordinates nothing of the image is seen");
}

#[test]
fn specular_and_glossiness() {
    let glossy = json!({"diffuseTexture": {"index": 0}, "diffuseFactor": [0.5, 1, 1, 1]});
    let (scene, material) = first(&json!([{"extensions": {"KHR_materials_pbrSpecularGlossiness": glossy}}]));
    assert_eq!((material.base_color[0], scene.images.len()), (0.5, 1));
    assert!(material.base_color_texture.is_some());
}

#[test]
fn what_is_not_seen_is_not_kept() {
    let (plain, _) = first(&json!([{}]));
    assert!(plain.meshes[0].uvs.is_empty() && plain.images.is_empty());
    // The other material's mesh is not placed; the broken image is never looked at.
    let mut model = square(&json!([{}, {"pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}}]));
    model.push("meshes", json!({"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "mode": 5, "material": 1}]}));
    let scene = read(&model.text());
    assert!(scene.images.is_empty() && scene.materials[1].base_color_texture.is_none() && scene.warnings.is_empty());
    for nothing in [3, 99] {
        let (scene, material) = first(&json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": nothing}}}]));
        assert!(scene.meshes[0].uvs.is_empty() && material.base_color_texture.is_none(), "texture {nothing}");
    }
}

#[test]
fn a_broken_image_is_a_warning() {
    let broken = json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 2}}}]);
    let (scene, _) = first(&broken);
    let textures = Textures::decode(&scene, Detail::Colors, &LoadCx::unattended()).expect("not cancelled");
    assert!(textures.get(0).is_none() && textures.warnings()[0].starts_with("The image 1 can't be read, and is white: "));
    for (image, why) in [
        (json!({}), "image 1: it has neither a bufferView nor a URI"),
        (json!({"bufferView": 99}), "bufferView 99: there is no such view"),
        (
            json!({"uri": "data:image/png;base64,!"}),
            "image 1: its base64 data is wrong after character 0: Invalid symbol 33, offset 0",
        ),
    ] {
        let mut model = square(&broken);
        model.json["images"][1] = image;
        let scene = read(&model.text());
        assert_eq!(scene.warnings, [format!("An image can't be read, and is white: {why}.")]);
        assert!(scene.materials[0].base_color_texture.is_none() && scene.triangle_count() == 2);
    }
}

#[test]
fn images_in_the_buffer_and_beside_the_model() {
    let mut model = square(&textured(&json!({})));
    let bytes = png(1, &[GREEN]);
    let view = model.view(&bytes);
    model.json["images"][0] = json!({"bufferView": view, "mimeType": "image/png", "name": "leaf"});
    let scene = read(&model.glb());
    assert_eq!(scene.images[0].name, "leaf");
    assert!(matches!(&scene.images[0].source, ImageSource::Bytes(copy) if **copy == bytes));
    let mut model = square(&textured(&json!({})));
    model.json["images"][0] = json!({"uri": "a%20leaf.png"});
    let scene = read(&model.text());
    assert!(matches!(&scene.images[0].source, ImageSource::File(path) if path.as_os_str() == "a leaf.png"));
    let mut model = square(&json!([{"pbrMetallicRoughness": {"baseColorTexture": {"index": 3}}}]));
    model.json["textures"][3] = json!({"extensions": {"EXT_texture_webp": {"source": 0}}});
    assert_eq!(read(&model.text()).images.len(), 1);
}

#[test]
fn an_image_of_many_materials_is_kept_once() {
    let mut model = square(&textured(&json!({})));
    let another = model.json["materials"][0].clone();
    model.push("materials", another);
    model.push("meshes", json!({"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "mode": 5, "material": 1}]}));
    model.push("nodes", json!({"mesh": 1}));
    let scene = read(&model.text());
    assert_eq!((scene.images.len(), scene.materials[1].base_color_texture), (1, scene.materials[0].base_color_texture));
}
