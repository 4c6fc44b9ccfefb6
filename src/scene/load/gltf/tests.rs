mod lights;
mod maps;
mod textures;

use super::super::tests::{Beside, check, load, soup};
use super::*;
use crate::geometry::Aabb;
use crate::scene::{Camera, Projection};
use base64::Engine;
use serde_json::{Value, json};

/// A document that is put together piece by piece; its buffer is in it or beside it.
struct Model {
    bin: Vec<u8>,
    json: Value,
}

const FLOAT: u32 = 5126;
const USHORT: u32 = 5123;
const SHORT: u32 = 5122;

impl Model {
    /// Four vertices of a unit square: accessor 0.
    fn square() -> Self {
        let mut model = Self { bin: Vec::new(), json: json!({"asset": {"version": "2.0"}, "bufferViews": [], "accessors": []}) };
        let positions = [[0f32, 0., 0.], [1., 0., 0.], [0., 1., 0.], [1., 1., 0.]];
        let view = model.view(bytemuck::cast_slice(&positions));
        model.accessor(json!({"bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": 4}));
        model
    }

    fn list(&mut self, name: &str) -> &mut Vec<Value> {
        if self.json[name].is_null() {
            self.json[name] = json!([]);
        }
        self.json[name].as_array_mut().expect("a list")
    }

    fn push(&mut self, name: &str, value: Value) -> usize {
        self.list(name).push(value);
        self.list(name).len() - 1
    }

    fn view(&mut self, bytes: &[u8]) -> usize {
        let offset = self.bin.len();
        self.bin.extend(bytes);
        self.bin.resize(self.bin.len().next_multiple_of(4), 0);
        self.push("bufferViews", json!({"buffer": 0, "byteOffset": offset, "byteLength": bytes.len()}))
    }

    fn accessor(&mut self, json: Value) -> usize {
        self.push("accessors", json)
    }

    fn indices(&mut self, indices: &[u16]) -> usize {
        let view = self.view(bytemuck::cast_slice(indices));
        self.accessor(json!({"bufferView": view, "componentType": USHORT, "type": "SCALAR", "count": indices.len()}))
    }

    /// One mesh of one primitive, placed once.
    fn with(mut self, primitive: Value) -> Self {
        self.push("meshes", json!({"primitives": [primitive]}));
        self.push("nodes", json!({"mesh": 0}));
        self
    }

    fn text(mut self) -> Vec<u8> {
        let data = base64::engine::general_purpose::STANDARD.encode(&self.bin);
        self.json["buffers"] =
            json!([{"byteLength": self.bin.len(), "uri": format!("data:application/octet-stream;base64,{data}")}]);
        self.json.to_string().into_bytes()
    }

    fn glb(mut self) -> Vec<u8> {
        self.json["buffers"] = json!([{"byteLength": self.bin.len()}]);
        let mut text = self.json.to_string().into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let word = |n: usize| u32::try_from(n).expect("small").to_le_bytes();
        let length = 12 + 8 + text.len() + 8 + self.bin.len();
        [&b"glTF"[..], &word(2), &word(length), &word(text.len()), b"JSON", &text, &word(self.bin.len()), b"BIN\0", &self.bin]
            .concat()
    }
}

fn read(bytes: &[u8]) -> Scene {
    load(&Gltf, bytes).expect("a model")
}

fn error(bytes: &[u8]) -> String {
    load(&Gltf, bytes).expect_err("broken").to_string()
}

#[test]
fn lists_strips_and_fans() {
    let triangles = |mode: u32, indices: &[u16]| {
        let mut model = Model::square();
        let indices = model.indices(indices);
        read(&model.with(json!({"attributes": {"POSITION": 0}, "indices": indices, "mode": mode})).text()).meshes[0]
            .triangles
            .clone()
    };
    assert_eq!(triangles(4, &[0, 1, 2, 2, 1, 3, 0]), [[0, 1, 2], [2, 1, 3]]);
    assert_eq!(triangles(5, &[0, 1, 2, 3, 0]), [[0, 1, 2], [1, 3, 2], [2, 3, 0]]);
    assert_eq!(triangles(6, &[0, 1, 3, 2]), [[1, 3, 0], [3, 2, 0]]);
    assert!(triangles(5, &[0]).is_empty());
    let unindexed = read(&Model::square().with(json!({"attributes": {"POSITION": 0}, "mode": 5})).glb());
    assert_eq!(unindexed.meshes[0].triangles, [[0, 1, 2], [1, 3, 2]]);
}

#[test]
fn points_and_lines_are_left_out_with_one_warning() {
    let mut model = Model::square();
    let primitives: Vec<_> = (0..5).map(|mode| json!({"attributes": {"POSITION": 0}, "mode": mode})).collect();
    model.push("meshes", json!({"primitives": primitives}));
    model.push("nodes", json!({"mesh": 0}));
    let scene = read(&model.text());
    assert_eq!(
        (scene.meshes.len(), scene.warnings.as_slice()),
        (1, ["Primitives of points or lines were left out: 4.".to_owned()].as_slice())
    );
}

#[test]
fn sparse_accessors_with_and_without_a_base() {
    for base in [true, false] {
        let mut model = Model::square();
        let at = model.view(bytemuck::cast_slice(&[1u16, 3]));
        let by = model.view(bytemuck::cast_slice(&[[7f32, 8., 9.], [4., 5., 6.]]));
        let sparse = json!({"count": 2, "indices": {"bufferView": at, "componentType": USHORT}, "values": {"bufferView": by}});
        let mut accessor = json!({"componentType": FLOAT, "type": "VEC3", "count": 4, "sparse": sparse});
        if base {
            accessor["bufferView"] = json!(0);
        }
        let positions = model.accessor(accessor);
        let scene = read(&model.with(json!({"attributes": {"POSITION": positions}, "mode": 5})).text());
        let second = if base { Vec3::Y } else { Vec3::ZERO };
        assert_eq!(scene.meshes[0].positions, [Vec3::ZERO, Vec3::new(7., 8., 9.), second, Vec3::new(4., 5., 6.)]);
    }
}

#[test]
fn quantised_and_interleaved_attributes() {
    let mut model = Model::square();
    let vertex = |p: [i16; 4], c: [u8; 4]| [bytemuck::cast::<_, [u8; 8]>(p), [c[0], c[1], c[2], c[3], 0, 0, 0, 0]].concat();
    let vertices =
        [vertex([32767, -32768, 0, 0], [255, 0, 51, 51]), vertex([0; 4], [0; 4]), vertex([-32767, 0, 0, 0], [0; 4])].concat();
    let view = model.view(&vertices);
    model.json["bufferViews"][view]["byteStride"] = json!(16);
    let positions =
        model.accessor(json!({"bufferView": view, "componentType": SHORT, "normalized": true, "type": "VEC3", "count": 3}));
    let colors = model.accessor(
        json!({"bufferView": view, "byteOffset": 8, "componentType": 5121, "normalized": true, "type": "VEC4", "count": 3}),
    );
    model.json["extensionsRequired"] = json!(["KHR_mesh_quantization"]);
    model.json["materials"] =
        json!([{"alphaMode": "BLEND", "pbrMetallicRoughness": {"baseColorFactor": [0.5, 1, 1, 0.25]}, "doubleSided": true}]);
    let scene = read(&model.with(json!({"attributes": {"POSITION": positions, "COLOR_0": colors}, "material": 0})).text());
    assert_eq!(scene.meshes[0].positions[0], Vec3::new(1.0, -1.0, 0.0));
    assert_eq!(scene.meshes[0].colors[0], [1.0, 0.0, 0.2, 0.2]);
    assert_eq!((scene.materials[0].base_color, scene.materials[0].double_sided), ([0.5, 1.0, 1.0, 0.25], true));
}

#[test]
fn nodes_place_meshes_depth_first() {
    let mut model = Model::square();
    model.push("meshes", json!({"primitives": [{"attributes": {"POSITION": 0}}, {"attributes": {"POSITION": 0}}]}));
    model.json["nodes"] = json!([
        {"mesh": 0, "scale": [2, 2, 2]},
        {"children": [3, 0], "translation": [10, 0, 0]},
        {"mesh": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,0,-1,0, 0,0,5,1]},
        {"mesh": 0, "rotation": [0, 0, 1, 0]},
        {"mesh": 0},
    ]);
    model.json["scenes"] = json!([{"nodes": [4]}, {"nodes": [1, 2]}]);
    model.json["scene"] = json!(1);
    let scene = read(&model.text());
    let placed: Vec<_> =
        scene.instances.iter().map(|i| (i.mesh, i.world_from_object.transform_point3(Vec3::ONE).to_array())).collect();
    let expected = [[9.0, -1.0, 1.0], [12.0, 2.0, 2.0], [1.0, 1.0, 4.0]];
    assert_eq!(placed, expected.into_iter().flat_map(|p| [(0, p), (1, p)]).collect::<Vec<_>>());
}

/// The first view, and the warnings, of a square followed by these nodes.
fn first_view(cameras: &Value, nodes: &Value) -> (Option<Camera>, Vec<String>) {
    let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    model.json["cameras"] = cameras.clone();
    model.json["nodes"].as_array_mut().expect("a list").extend(nodes.as_array().expect("a list").iter().cloned());
    let scene = read(&model.text());
    let unit = Aabb { min: Vec3::ZERO, max: Vec3::new(1.0, 1.0, 0.0) };
    (scene.camera.map(|_| scene.first_camera(&unit, 2.0)), scene.warnings)
}

#[test]
fn the_first_camera_is_the_first_view() {
    let cameras = json!([
        {"type": "perspective", "perspective": {"yfov": 1.0, "znear": 0.1}},
        {"type": "orthographic", "orthographic": {"xmag": 3, "ymag": 1, "znear": 0.1, "zfar": 100}},
    ]);
    // A quarter turn about y, so that -z looks along -x; then the child, further along its own z.
    let quarter = [0.0, std::f32::consts::FRAC_1_SQRT_2, 0.0, std::f32::consts::FRAC_1_SQRT_2];
    let nodes = |first: u8| {
        json!([
            {"children": [2], "rotation": quarter, "scale": [2, 2, 2], "translation": [0.5, 0.5, 0]},
            {"camera": first, "translation": [0, 0, 5]},
            {"camera": 1 - first},
        ])
    };
    let (camera, warnings) = first_view(&cameras, &nodes(0));
    let camera = camera.expect("a view");
    let near = |a: Vec3, b: Vec3| assert!(a.distance(b) < 1e-5, "{a}, not {b}");
    near(camera.eye, Vec3::new(10.5, 0.5, 0.0));
    near(camera.target, Vec3::new(0.5, 0.5, 0.0));
    assert_eq!((camera.up, camera.projection), (Vec3::Y, Projection::Perspective { fov_y: 1.0 }));
    assert!(warnings.is_empty(), "{warnings:?}");
    let (flat, _) = first_view(&cameras, &nodes(1));
    let flat = flat.expect("a view");
    near(flat.eye, camera.eye);
    // Six wide in a picture twice as wide as high.
    assert_eq!(flat.projection, Projection::Orthographic { height: 3.0 });
    assert_eq!(first_view(&json!([]), &json!([])), (None, Vec::new()));
}

#[test]
fn cameras_that_make_no_picture_are_left_out() {
    let perspective = |fov: f32| json!({"type": "perspective", "perspective": {"yfov": fov, "znear": 0.1}});
    let flat = |x: f32| json!({"type": "orthographic", "orthographic": {"xmag": x, "ymag": 1, "znear": 0.1, "zfar": 100}});
    let cameras =
        json!([perspective(0.8), perspective(0.0), perspective(3.2), flat(0.0), {"type": "fisheye"}, {"type": "perspective"}]);
    let here = |camera: u8| json!({"camera": camera, "translation": [0, 0, 3]});
    let bad = [
        (here(1), "node 1: its angle is not between 0 and 180 degrees"),
        (here(2), "node 1: its angle is not between 0 and 180 degrees"),
        (here(3), "node 1: its picture has no size"),
        (here(4), "node 1: it is neither perspective nor orthographic"),
        (here(5), "node 1: it has no perspective"),
        (here(6), "node 1: there is no such camera"),
        (json!({"camera": 0, "scale": [1, 1, 0]}), "node 1: it looks nowhere"),
        (json!({"camera": 0, "matrix": [1,0,0,0, 0,1,0,0, 0,1,0,0, 0,0,0,1]}), "node 1: it is flat"),
    ];
    for (node, why) in bad {
        let (camera, warnings) = first_view(&cameras, &json!([node, here(0), here(1)]));
        assert_eq!(camera.map(|c| c.projection), Some(Projection::Perspective { fov_y: 0.8 }), "the next is taken: {why}");
        assert_eq!(warnings, [format!("Cameras that make no picture were left out: 1 ({why}).")]);
    }
    let far = json!([{"children": [2], "translation": [3e38, 0, 0]}, {"camera": 0, "translation": [3e38, 0, 0]}]);
    let nowhere = "Cameras that make no picture were left out: 1 (node 2: it stands nowhere).";
    assert_eq!(first_view(&cameras, &far), (None, vec![nowhere.to_owned()]));
}

#[test]
fn cycles_are_refused_and_long_chains_are_not() {
    let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    model.json["nodes"] = json!([{"children": [1]}, {"children": [0]}]);
    model.json["scenes"] = json!([{"nodes": [0]}]);
    assert_eq!(error(&model.text()), "node 0: it has two parents, or is its own ancestor");
    let mut chain = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    let nodes = (1..50_000).map(|i| json!({"children": [i], "translation": [1, 0, 0]}));
    chain.json["nodes"] = nodes.chain([json!({"mesh": 0})]).collect();
    assert_eq!(read(&chain.text()).instances[0].world_from_object.translation.x, 49_999.0);
}

#[test]
fn primitives_that_share_a_long_list_take_what_they_use() {
    let mut model = Model::square();
    let many: Vec<[f32; 3]> = (0..100u8).map(|i| [i.into(), 0.0, 0.0]).collect();
    let view = model.view(bytemuck::cast_slice(&many));
    let positions = model.accessor(json!({"bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": 100}));
    let indices = model.indices(&[90, 40, 50, 40, 50, 60]);
    let scene = read(&model.with(json!({"attributes": {"POSITION": positions}, "indices": indices})).text());
    assert_eq!(scene.meshes[0].positions.iter().map(|p| p.x).collect::<Vec<_>>(), [40.0, 50.0, 60.0, 90.0]);
    assert_eq!(scene.meshes[0].triangles, [[3, 0, 1], [0, 1, 2]]);
}

/// A long row of squares, as one reader of accessors takes it and as the other: tightly packed, with a
/// stride, with an element that is replaced by itself, and with a last index that makes no triangle.
#[test]
fn every_road_gives_the_same() {
    let n = 50_000u16;
    let positions: Vec<[f32; 3]> =
        (0..n).map(|i| [f32::from(i / 2), f32::from(i % 2), f32::from_bits(u32::from(i) << 15)]).collect();
    let indices: Vec<u32> = (0..u32::from(n) - 2).flat_map(|i| [i + i % 2, i + 1 - i % 2, i + 2]).collect();
    let with = |stride: usize, replaced: bool, left_over: usize, short: bool| {
        let mut model = Model::square();
        let apart: Vec<u8> = positions.iter().flat_map(|p| [bytemuck::bytes_of(p), &vec![7; stride - 12]].concat()).collect();
        let view = model.view(&apart);
        model.json["bufferViews"][view]["byteStride"] = json!(stride);
        let mut accessor = json!({"bufferView": view, "componentType": FLOAT, "type": "VEC3", "count": n});
        if replaced {
            let at = model.view(bytemuck::cast_slice(&[7u16]));
            let by = model.view(bytemuck::cast_slice(&[positions[7]]));
            let indices = json!({"bufferView": at, "componentType": USHORT});
            accessor["sparse"] = json!({"count": 1, "indices": indices, "values": {"bufferView": by}});
        }
        let vertices = model.accessor(accessor);
        let all = [&indices, &indices[..left_over]].concat();
        let corners = if short {
            model.indices(&Vec::from_iter(all.iter().map(|i| u16::try_from(*i).expect("few"))))
        } else {
            let view = model.view(bytemuck::cast_slice(&all));
            model.accessor(json!({"bufferView": view, "componentType": 5125, "type": "SCALAR", "count": all.len()}))
        };
        read(&model.with(json!({"attributes": {"POSITION": vertices, "NORMAL": vertices}, "indices": corners})).glb())
    };
    let scene = with(12, false, 0, false);
    assert!(bytemuck::cast_slice::<_, [u32; 3]>(&scene.meshes[0].positions) == bytemuck::cast_slice::<_, [u32; 3]>(&positions));
    assert!(scene.meshes[0].triangles.as_flattened() == indices);
    for (stride, replaced, left_over, short) in
        [(12, true, 0, true), (12, false, 1, false), (20, false, 2, true), (20, true, 1, false)]
    {
        assert!(with(stride, replaced, left_over, short).meshes == scene.meshes, "{stride} {replaced} {left_over} {short}");
    }
}

#[test]
fn buffers_beside_the_model_have_escaped_names() {
    let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    model.json["buffers"] = json!([{"byteLength": model.bin.len(), "uri": "m%C3%BCll%20x.bin"}]);
    let text = model.json.to_string().into_bytes();
    let load = |bytes: &[u8]| Gltf.load(&text, &Beside(&[("müll x.bin", bytes)]), &LoadCx::unattended());
    check(&load(&model.bin).expect("a model"));
    let short = load(&model.bin[1..]).expect_err("cut short").to_string();
    assert_eq!(short, "buffer 0 (m%C3%BCll%20x.bin): it declares 48 bytes, but has 47: it was cut short");
    assert!(matches!(super::super::tests::load(&Gltf, &text), Err(Reason::Io { .. })));
}

#[test]
fn a_file_that_was_cut_short_says_so() {
    let whole = Model::square().with(json!({"attributes": {"POSITION": 0}})).glb();
    read(&whole);
    assert!(error(&whole[..whole.len() - 10]).contains("it was cut short"));
    assert!(error(&whole[..11]).contains("it was cut short"));
    let mut lying = whole;
    lying[8..12].copy_from_slice(&[0; 4]); // a length below that of the header
    assert!(error(&lying).contains("GLB header"));
    assert!(error(b"{\"asset\": {\"version\": \"2.0\"}").starts_with("JSON, line 1 column 28: EOF"));
    assert!(error(br#"{"asset": {"version": "1.0"}, "meshes": {}}"#).contains("glTF 1.0"));
}

#[test]
fn draco_is_refused_by_name_unless_there_is_plain_data() {
    let mut model = Model::square();
    let empty = model.accessor(json!({"componentType": FLOAT, "type": "VEC3", "count": 4}));
    let draco = json!({"KHR_draco_mesh_compression": {"bufferView": 0, "attributes": {"POSITION": 0}}});
    let mut model = model.with(json!({"attributes": {"POSITION": empty}, "extensions": draco}));
    model.json["extensionsUsed"] = json!(["KHR_draco_mesh_compression"]);
    let mut required = Model { bin: model.bin.clone(), json: model.json.clone() };
    required.json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let text = "needs KHR_draco_mesh_compression, which Boxwood can't read. Re-export without Draco.";
    assert_eq!(error(&required.glb()), format!("mesh 0 {text}"));
    let plain = Model { bin: model.bin.clone(), json: model.json.clone() };
    assert_eq!(error(&model.glb()), format!("mesh 0 primitive 0 {text}"));
    let mut plain = plain;
    plain.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = json!(0);
    assert_eq!(read(&plain.text()).meshes[0].triangles.len(), 1);
}

#[test]
fn extensions_of_looks_may_be_required_others_not() {
    let with = |name: &str| {
        let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
        model.json["extensionsRequired"] = json!([name]);
        load(&Gltf, &model.text())
    };
    assert!(with("KHR_materials_unlit").is_ok_and(|scene| scene.warnings.is_empty()));
    assert!(with("KHR_texture_basisu").is_ok_and(|scene| scene.warnings.len() == 1));
    let refused = with("ACME_teapots").expect_err("unknown").to_string();
    assert_eq!(refused, "it needs ACME_teapots, which Boxwood can't read. Re-export without it.");
}

#[test]
fn meshopt_without_fallback_data_is_refused() {
    let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    model.json["bufferViews"][0]["buffer"] = json!(1);
    model.json["bufferViews"][0]["extensions"] = json!({"EXT_meshopt_compression": {"buffer": 0}});
    model.json["buffers"] = json!([{"byteLength": 0, "uri": "data:,"}, {"byteLength": 48}]);
    let refused = error(&model.json.to_string().into_bytes());
    assert_eq!(
        refused,
        "bufferView 0 needs EXT_meshopt_compression, which Boxwood can't read. Re-export without meshopt compression."
    );
}

#[test]
fn every_reference_is_checked() {
    let model = || {
        let mut model = Model::square();
        let indices = model.indices(&[0, 1, 2]);
        model.with(json!({"attributes": {"POSITION": 0}, "indices": indices}))
    };
    read(&model().text());
    let huge = json!(u64::MAX);
    let wrong: &[(&str, Value)] = &[
        ("/accessors/0/count", json!(5)),
        ("/accessors/0/count", huge.clone()),
        ("/accessors/0/byteOffset", json!(4)),
        ("/accessors/0/byteOffset", huge.clone()),
        ("/accessors/0/bufferView", json!(9)),
        ("/accessors/0/type", json!("VEC2")),
        ("/accessors/0/componentType", json!(1)),
        ("/accessors/1/componentType", json!(FLOAT)),
        ("/bufferViews/0/byteLength", huge.clone()),
        ("/bufferViews/0/byteOffset", huge),
        ("/bufferViews/0/buffer", json!(1)),
        ("/bufferViews/1/byteOffset", json!(36)), // where the floats are
        ("/meshes/0/primitives/0/attributes/POSITION", json!(99)),
        ("/meshes/0/primitives/0/indices", json!(99)),
        ("/meshes/0/primitives/0/material", json!(0)),
        ("/meshes/0/primitives/0/mode", json!(9)),
        ("/nodes/0/mesh", json!(1)),
        ("/scene", json!(0)),
    ];
    for (path, value) in wrong {
        let mut model = model();
        let (parent, key) = path.rsplit_once('/').expect("a path");
        model.json.pointer_mut(parent).expect("there")[key] = value.clone();
        let reason = load(&Gltf, &model.glb()).map(|scene| soup(&scene).len());
        assert!(matches!(reason, Err(Reason::Malformed { .. } | Reason::TooLarge(..))), "{path} = {value}: {reason:?}");
    }
}

#[test]
fn many_nodes_times_many_primitives_run_into_the_budget() {
    let mut model = Model::square();
    model.push("meshes", json!({"primitives": vec![json!({"attributes": {"POSITION": 0}}); 2000]}));
    model.json["nodes"] = vec![json!({"mesh": 0}); 20_000].into();
    let cx = LoadCx { budget: crate::task::Budget::new(100 << 20), ..LoadCx::unattended() };
    assert!(matches!(Gltf.load(&model.text(), &Beside(&[]), &cx), Err(Reason::Memory(_))));
    assert_eq!(cx.budget.used(), 0);
}

#[test]
fn a_node_may_repeat_its_mesh() {
    let repeated = |edit: &dyn Fn(&mut Value)| {
        let mut model = Model::square();
        let indices = model.indices(&[0, 1, 2]);
        let at = model.view(bytemuck::cast_slice(&[[1f32, 0., 0.], [0., 2., 0.], [0., 0., 3.]]));
        let at = model.accessor(json!({"bufferView": at, "componentType": FLOAT, "type": "VEC3", "count": 3}));
        let turn = model.view(bytemuck::cast_slice(&[[0i16, 0, 0, i16::MAX], [0, 0, i16::MAX, 0], [0, 0, 0, i16::MAX]]));
        let turn =
            model.accessor(json!({"bufferView": turn, "componentType": SHORT, "normalized": true, "type": "VEC4", "count": 3}));
        let mut model = model.with(json!({"attributes": {"POSITION": 0}, "indices": indices}));
        let attributes = json!({"TRANSLATION": at, "ROTATION": turn, "_ID": 0});
        model.json["nodes"] = json!([{
            "mesh": 0, "scale": [2, 2, 2], "extensions": {"EXT_mesh_gpu_instancing": {"attributes": attributes}}
        }]);
        model.json["extensionsRequired"] = json!(["EXT_mesh_gpu_instancing"]);
        edit(&mut model.json);
        load(&Gltf, &model.text())
    };
    let scene = repeated(&|_| ()).expect("a model");
    let (o, x, y) = ([2., 0., 0.], [4., 0., 0.], [2., 2., 0.]);
    assert_eq!(scene.instances.len(), 3);
    assert_eq!((soup(&scene)[0], scene.meshes.len()), ([o, x, y], 1));
    // Half a turn about z, then up by two, then twice as large.
    assert_eq!(soup(&scene)[1], [[0., 4., 0.], [-2., 4., 0.], [0., 2., 0.]]);
    let attributes = |json: &mut Value| json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"].take();
    let wrong = repeated(&|json| {
        let mut all = attributes(json);
        all["TRANSLATION"] = json!(0);
        json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = all;
    });
    assert!(wrong.expect_err("lists of two lengths").to_string().contains("not of one length"));
    let missing = repeated(&|json| {
        let mut all = attributes(json);
        all["SCALE"] = json!(99);
        json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"] = all;
    });
    assert!(missing.is_err());
    assert_eq!(repeated(&|json| drop(attributes(json))).expect("nothing to repeat by").instances.len(), 1);
}
