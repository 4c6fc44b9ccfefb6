mod textures;

use super::super::tests::{Beside, check, load, soup};
use super::*;

const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

fn error(text: &str) -> String {
    load(&Obj, text.as_bytes()).expect_err("broken").to_string()
}

#[test]
fn polygons_become_fans_and_negative_indices_count_back() {
    let scene =
        load(&Obj, format!("{SQUARE}f 1 2 3 4\nf -4 -3 -2 # a comment\nv 5 5 5\nf -1 \\\n -2 -3\n").as_bytes()).expect("a model");
    let [a, b, c, d, e] = [[0., 0., 0.], [1., 0., 0.], [1., 1., 0.], [0., 1., 0.], [5., 5., 5.]];
    assert_eq!(soup(&scene), [[a, b, c], [a, c, d], [a, b, c], [e, d, c]]);
    assert_eq!(scene.meshes[0].positions.len(), 5);
    assert!(scene.meshes[0].uvs.is_empty() && scene.meshes[0].normals.is_empty());
}

#[test]
fn a_face_may_come_before_its_vertices() {
    assert_eq!(load(&Obj, format!("f 1 2 3\n{SQUARE}").as_bytes()).expect("a model").triangle_count(), 1);
}

#[test]
fn corners_without_an_attribute_get_zeros() {
    let text = format!("{SQUARE}vt 0.5 0.25\nvn 0 0 1\nf 1/1/1 2/1 3//1\nf 1 2 3\n");
    let scene = load(&Obj, text.as_bytes()).expect("a model");
    let mesh = &scene.meshes[0];
    assert_eq!(mesh.triangles, [[0, 1, 2], [3, 4, 5]]);
    assert_eq!((mesh.uvs[0].x, mesh.uvs[2].x, mesh.normals[2].z, mesh.normals[1].z), (0.5, 0.0, 1.0, 0.0));
    let missing = load(&Obj, format!("{SQUARE}f 1/9 2/-7 3\n").as_bytes()).expect("still a model");
    assert!(missing.warnings[0].ends_with(": 2, the first in line 5."), "{:?}", missing.warnings);
}

#[test]
fn colours_and_what_is_not_finite_are_kept() {
    let scene = load(&Obj, b"v nan 0 0 1 0 0\nv inf 0 0\nv 0 0 -1.#IND 1\nf 1 2 3\n").expect("a model");
    let mesh = &scene.meshes[0];
    assert!(mesh.positions[0].x.is_nan() && mesh.positions[1].x.is_infinite() && mesh.positions[2].z.is_nan());
    assert_eq!(mesh.colors, [[1.0, 0.0, 0.0, 1.0], [1.0; 4], [1.0; 4]]);
}

#[test]
fn triangles_stay_in_file_order_across_groups_and_materials() {
    let mtl: &[u8] = b"newmtl red one\nKd 1 0 0\nd 0.5\nTr 1\nnewmtl grey\nKd 0.5\nTr 0.25\nnewmtl short\nKd 0.1 0.2\n";
    let text = format!(
        "mtllib the lib.mtl\n{SQUARE}g first\nusemtl red one\nf 1 2 3\nusemtl grey\nf 2 3 4\no second\nf 3 4 1\nusemtl red one\nf 4 1 2\n"
    );
    let scene = Obj.load(text.as_bytes(), &Beside(&[("the lib.mtl", mtl)]), &LoadCx::unattended()).expect("a model");
    check(&scene);
    let seen: Vec<_> = scene.meshes.iter().map(|m| (m.name.as_str(), m.material)).collect();
    assert_eq!(seen, [("first", Some(0)), ("first", Some(1)), ("second", Some(1)), ("second", Some(0))]);
    let colors: Vec<_> = scene.materials.iter().map(|m| m.base_color).collect();
    assert_eq!(colors, [[1.0, 0.0, 0.0, 0.5], [0.5, 0.5, 0.5, 0.75], [0.1, 0.2, 0.1, 1.0]]);
    assert!(scene.warnings.is_empty(), "{:?}", scene.warnings);
}

#[test]
fn a_missing_material_file_is_a_warning() {
    let text = format!("mtllib none.mtl\n{SQUARE}usemtl gold\nf 1 2 3\n");
    let scene = load(&Obj, text.as_bytes()).expect("a model");
    assert_eq!(scene.warnings, ["1 material file could not be read: none.mtl."]);
    let one_of_three = format!("mtllib a.mtl b\\ c.mtl d.mtl\n{SQUARE}usemtl gold\nf 1 2 3\n");
    let files = Beside(&[("b c.mtl", b"newmtl silver\n")]);
    let scene = Obj.load(one_of_three.as_bytes(), &files, &LoadCx::unattended()).expect("a model");
    assert_eq!(
        scene.warnings,
        ["2 material files could not be read: a.mtl, d.mtl.", "1 material is in none of the material files: gold."]
    );
}

#[test]
fn errors_name_the_line() {
    assert_eq!(error(&format!("{SQUARE}f 1 2 5\n")), "line 5: there is no vertex 5; the file has 4");
    assert_eq!(error(&format!("{SQUARE}f 0 1 2\n")), "line 5: there is no vertex 0; the file has 4");
    assert_eq!(
        error(&format!("{SQUARE}f -9223372036854775808 1 2\n")),
        "line 5: there is no vertex -9223372036854775808; the file has 4"
    );
    assert_eq!(error(&format!("{SQUARE}f 1 2 3/4/5/6\n")), "line 5: '3/4/5/6' is no corner of a face");
    assert_eq!(error("v 0 0\n"), "line 1: it has 2 numbers, not 3");
    assert_eq!(error("\n\nv 0 0 zero\n"), "line 3: 'zero' is no number");
}

#[test]
fn lines_and_points_are_counted_as_left_out() {
    let scene = load(&Obj, format!("{SQUARE}l 1 2\np 1\nf 1 2\nf 1// 2// 3//\n").as_bytes()).expect("a model");
    assert_eq!(scene.triangle_count(), 1);
    assert!(scene.warnings[0].ends_with(": 3."));
}

#[test]
fn text_that_is_not_utf8_is_read() {
    let scene = load(&Obj, b"# \xE9\ng caf\xE9\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("a model");
    assert_eq!(scene.meshes[0].name, "caf\u{FFFD}");
}

#[test]
fn many_corners_of_one_position_take_no_quadratic_time() {
    let n = 200_000;
    let mut text = String::from("v 0 0 0\n");
    (0..n).for_each(|_| text.push_str("vt 0 0\n"));
    (1..=n).for_each(|i| text.push_str(&format!("f 1/{i} 1/{i} 1/{i}\n")));
    let start = std::time::Instant::now();
    assert_eq!(load(&Obj, text.as_bytes()).expect("a model").triangle_count(), n);
    assert!(start.elapsed().as_secs() < 10);
}
