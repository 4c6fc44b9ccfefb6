use std::f32::consts::{FRAC_1_SQRT_2, FRAC_PI_2, FRAC_PI_4};

use super::*;
use crate::scene::{Light, LightKind};

/// The lights, and the warnings, of a square followed by these nodes.
fn lights(lights: &Value, nodes: &Value) -> (Vec<Light>, Vec<String>) {
    let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    model.json["extensionsRequired"] = json!(["KHR_lights_punctual"]);
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": lights}});
    model.json["nodes"].as_array_mut().expect("a list").extend(nodes.as_array().expect("a list").iter().cloned());
    let scene = read(&model.text());
    (scene.lights, scene.warnings)
}

fn node(light: u8, mut more: Value) -> Value {
    more["extensions"] = json!({"KHR_lights_punctual": {"light": light}});
    more
}

#[test]
fn lights_shine_along_the_axis_of_their_node() {
    let all = json!([
        {"type": "point", "name": "bulb", "color": [1, 0.5, 0.25], "intensity": 8, "range": 3},
        {"type": "spot", "spot": {"innerConeAngle": 0.25, "outerConeAngle": 0.5}, "extensions": {"ACME_gobo": {}}},
        {"type": "directional", "intensity": 2},
    ]);
    // A quarter turn about y, so that -z points along -x; then the children, further along their own z.
    let quarter = [0.0, FRAC_1_SQRT_2, 0.0, FRAC_1_SQRT_2];
    let along = |light: u8| node(light, json!({"translation": [0, 0, 5]}));
    let nodes = json!([
        {"children": [2, 3, 4], "rotation": quarter, "scale": [2, 2, 3], "translation": [0.5, 0.25, 0]},
        along(0), along(1), along(2), node(0, json!({})),
    ]);
    let (found, warnings) = lights(&all, &nodes);
    assert!(warnings.is_empty(), "{warnings:?}");
    let [bulb, spot, sun, other] = found.as_slice() else { panic!("four lights, not {found:?}") };
    assert_eq!((bulb.name.as_str(), bulb.kind, bulb.color, bulb.range), ("bulb", LightKind::Point, [8.0, 4.0, 2.0], Some(3.0)));
    assert_eq!((spot.kind, spot.color, spot.range), (LightKind::Spot { inner: 0.25, outer: 0.5 }, [1.0; 3], None));
    assert_eq!((sun.kind, sun.color), (LightKind::Directional, [2.0; 3]));
    for light in [bulb, spot, sun] {
        assert!(light.at.distance(Vec3::new(15.5, 0.25, 0.0)) < 1e-5, "{}", light.at);
        assert!(light.towards.distance(Vec3::NEG_X) < 1e-6, "{}", light.towards);
    }
    assert_eq!((other.at, other.towards, other.name.as_str()), (Vec3::ZERO, Vec3::NEG_Z, "bulb"));
}

#[test]
fn broken_lights_are_left_out() {
    let point = |name: &str, value: Value| {
        let mut light = json!({"type": "point"});
        light[name] = value;
        light
    };
    let spot = |inner: f32, outer: f32| json!({"type": "spot", "spot": {"innerConeAngle": inner, "outerConeAngle": outer}});
    let (type_, intensity) = ("its type is not known", "its intensity is no number from 0 on");
    let (color, cones) =
        ("its colour is no number from 0 on", "its cones are not one within the other and both within a half space");
    let bad = [
        (point("type", json!("area")), type_),
        (point("intensity", json!(-1)), intensity),
        (point("intensity", json!(1e39)), intensity),
        (point("color", json!([1, -1, 1])), color),
        (json!({"type": "point", "color": [1e30, 1, 1], "intensity": 1e30}), color),
        (spot(0.5, 0.25), cones),
        (spot(-0.5, 0.25), cones),
        (spot(0.0, 0.0), cones),
        (spot(0.5, 1.6), cones),
    ];
    let good = json!({"type": "point"});
    for (light, why) in bad {
        let (found, warnings) =
            lights(&json!([good, light]), &json!([node(1, json!({})), node(0, json!({})), node(1, json!({}))]));
        assert_eq!(found.len(), 1, "{why}");
        assert_eq!(warnings, [format!("Broken lights were left out: 2 (node 1: {why}).")]);
    }
    let (found, warnings) = lights(&json!([good]), &json!([node(7, json!({})), node(0, json!({"translation": [1e39, 0, 0]}))]));
    assert_eq!((found.len(), warnings), (0, vec!["Broken lights were left out: 2 (node 1: there is no such light).".to_owned()]));
}

#[test]
fn only_what_shines_one_way_needs_a_direction() {
    let all = json!([{"type": "point"}, {"type": "spot"}, {"type": "directional"}]);
    let flat = |light: u8| node(light, json!({"scale": [1, 1, 0]}));
    let (found, warnings) = lights(&all, &json!([flat(0), flat(1), flat(2)]));
    assert_eq!(found.iter().map(|light| light.kind).collect::<Vec<_>>(), [LightKind::Point]);
    assert_eq!(warnings, ["Broken lights were left out: 2 (node 2: it shines nowhere)."]);
}

#[test]
fn what_is_not_said_of_lights() {
    let edge = json!({"innerConeAngle": FRAC_PI_2, "outerConeAngle": FRAC_PI_2});
    let all = json!([
        {"type": "spot"}, {"type": "spot", "spot": {}}, {"type": "spot", "spot": edge},
        {"type": "point", "range": 0}, {"type": "point", "intensity": 0},
    ]);
    let (found, warnings) = lights(&all, &(0..5).map(|light| node(light, json!({}))).collect());
    let kinds: Vec<LightKind> = found.iter().map(|light| light.kind).collect();
    let usual = LightKind::Spot { inner: 0.0, outer: FRAC_PI_4 };
    let hard = LightKind::Spot { inner: FRAC_PI_2.next_down(), outer: FRAC_PI_2 };
    assert_eq!(kinds, [usual, usual, hard, LightKind::Point], "one that sheds nothing is none");
    assert_eq!((found[3].range, warnings), (None, Vec::new()));
}

#[test]
fn a_long_name_of_many_nodes_runs_into_the_budget() {
    let mut model = Model::square().with(json!({"attributes": {"POSITION": 0}}));
    model.json["extensions"] = json!({"KHR_lights_punctual": {"lights": [{"type": "point", "name": "x".repeat(1 << 20)}]}});
    model.json["nodes"] = (0..200).map(|_| node(0, json!({}))).collect();
    let cx = LoadCx { budget: crate::task::Budget::new(100 << 20), ..LoadCx::unattended() };
    assert!(matches!(Gltf.load(&model.text(), &Beside(&[]), &cx), Err(Reason::Memory(_))));
    assert_eq!(cx.budget.used(), 0);
}
