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

/// What a text gives when it is cut into pieces of about `size` bytes.
fn cut_to(size: usize, text: &[u8]) -> Result<String, String> {
    let mtl: &[u8] = b"newmtl red\nKd 1 0 0\nnewmtl blue\nKd 0 0 1\n";
    let cx = LoadCx { budget: crate::task::Budget::new(1 << 30), ..LoadCx::unattended() };
    let result = in_pieces(text, size, &Beside(&[("a.mtl", mtl)]), &cx);
    assert_eq!(cx.budget.used(), 0, "memory stays charged");
    result.inspect(check).map(|scene| format!("{scene:?}")).map_err(|reason| reason.to_string())
}

#[test]
fn pieces_of_any_size_give_the_same() {
    let texts = [
        format!("f 1 2 3\nf 4/1 -1/-1 -2\nvt 0 1\n{SQUARE}f -4 -3 -2\nv 7 8 9\nf -1 -2 -3 1\nf 1 2 3 4\n"),
        format!(
            "{SQUARE}vn 0 0 1\ng a\nf 1//1 2//1 3//-1\nf 1 2 3\nusemtl red\nf 1 3 4\nf 1 2 4\no b c\nf 1 2 3\nmtllib a.mtl\nusemtl x\nf 1 2 3\n"
        ),
        "v 0 0 0\r\nv 1 0 0 1 0 0\rv 0 1 \\\n0\n# x \\\r\nv 9 9 9\n\n\r\nf 1 2\\\r\n 3\\\n\\\n 1\nl 1 2\nf 1 2\nf\n".into(),
        format!("{SQUARE}vt 0 0\nf 1/1 2/1 3/1\nf 1/1 2/2 3/1\nvt 1 1\nf 1/-3 2/9 3\nvn 1 0 0\nf 1//2 2 3\n"),
        format!("{SQUARE}f 1 2 3\n\nf 1 2 -5\nv 0 0 0\n"),
        format!("{SQUARE}f 1 2 3\n\nf 1 2 x\nf 1 2 9\nv 0 0 0\n"),
        format!("{SQUARE}f 1 2 x\nvn 0 0 0\n\nv 0 0 y\nvt\n"),
        "\u{FEFF}v 0 0 0\n\u{FEFF}v 1 0 0\nv 1 1 0\nv 2 2 0\nf 1 2 3 # 4\n".into(),
    ];
    for text in texts {
        let text = text.as_bytes();
        let whole = cut_to(text.len(), text);
        for size in 0..text.len() {
            assert_eq!(cut_to(size, text), whole, "{size} of {}", String::from_utf8_lossy(text));
        }
    }
}

#[test]
fn errors_name_the_line_in_any_piece() {
    for (size, lines) in [(PIECE, 50_000), (100, 100)] {
        let long = "v 1 2 3\n".repeat(lines);
        let said = |end: &str| cut_to(size, format!("{long}{end}").as_bytes()).expect_err("broken");
        assert_eq!(said("f 1 2 x\n"), format!("line {}: 'x' is no corner of a face", lines + 1));
        assert_eq!(said("\nf 1 -999999 2\n"), format!("line {}: there is no vertex -999999; the file has {lines}", lines + 2));
        assert_eq!(said("f 1 2 x\n\nv 1 2\n"), format!("line {}: it has 2 numbers, not 3", lines + 3));
        assert_eq!(said(&"x".repeat(7 << 20)), format!("line {}: it is longer than a mebibyte", lines + 1));
        assert!(said(&"x\\\n".repeat(3 << 20)).ends_with("it is joined to a line longer than a mebibyte"));
    }
}

#[test]
fn lines_as_usual_and_with_comments_are_the_same() {
    let usual = format!(
        "{SQUARE}v 1 2 3 .5 .25 0\nvt .5\nvt 1 2 3\nvn 1e0 -2 .3\nf 1 2 3\nf 5/1 -1/-1 3/2\nf 1//1 2//1 3//-1\nf 1/1/1 2/2/1 3/1/1 4/1/1\n"
    );
    let commented = usual.replace('\n', " # the long way\n");
    let spread = usual.replace(' ', "\t  ").replace('\n', " \r\n");
    assert!(cut_to(PIECE, usual.as_bytes()).is_ok());
    assert_eq!(cut_to(PIECE, commented.as_bytes()), cut_to(PIECE, usual.as_bytes()));
    assert_eq!(cut_to(PIECE, spread.as_bytes()), cut_to(PIECE, usual.as_bytes()));
}

#[test]
fn a_backslash_joins_whatever_number_it_follows() {
    assert_eq!(error("v 0 0 1.#IND\\\nx y z\n"), "line 2: 'x' is no number");
}

#[test]
fn memory_is_charged_before_it_is_taken() {
    let text = format!("{SQUARE}{}", "f 1 2 3\n".repeat(100_000));
    for kib in [1, 10, 100, 1000, 2000] {
        let cx = LoadCx { budget: crate::task::Budget::new(kib << 10), ..LoadCx::unattended() };
        assert!(matches!(Obj.load(text.as_bytes(), &Beside(&[]), &cx), Err(Reason::Memory(_))), "{kib}");
        assert_eq!(cx.budget.used(), 0);
    }
}
