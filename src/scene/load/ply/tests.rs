use super::super::tests::{load, soup};
use super::*;

fn header(format: &str, lines: &[&str]) -> Vec<u8> {
    format!("ply\nformat {format} 1.0\n{}\nend_header\n", lines.join("\n")).into_bytes()
}

const XYZ: &str = "property float x\nproperty float y\nproperty float z";

#[test]
fn polygons_become_fans() {
    let mut file = header("ascii", &["element vertex 5", XYZ, "element face 2", "property list uchar int vertex_indices"]);
    file.extend(b"0 0 0\n1 0 0\n2 1 nan\n1 2 .5\n0 1 -inf\n5 0 1 2 3 4\n3 0 1 2\n");
    let scene = load(&Ply, &file).expect("a model");
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 1, 2]]);
    assert!(scene.meshes[0].positions[2].z.is_nan());
    assert_eq!(scene.up, Vec3::Y);
}

#[test]
fn both_byte_orders_give_the_same() {
    let lines = [
        "comment não é UTF-8: \u{e9}",
        "element vertex 3",
        XYZ,
        "property uchar red\nproperty uchar green\nproperty uchar blue",
        "property double s\nproperty double t",
        "element edge 1",
        "property list ushort short ends",
        "element face 1",
        "property uchar flag\nproperty list uchar uint vertex_index",
    ];
    let build = |big: bool| {
        let mut file = header(if big { "binary_big_endian" } else { "binary_little_endian" }, &lines);
        let mut put = |bytes: &[u8]| if big { file.extend(bytes.iter().rev()) } else { file.extend(bytes) };
        for v in 0u8..3 {
            [1.5, -2.0, f32::from(v)].iter().for_each(|x| put(&x.to_le_bytes()));
            [255, 0, v].iter().for_each(|c| put(&[*c]));
            [0.25, 0.5f64].iter().for_each(|x| put(&x.to_le_bytes()));
        }
        [2u16, 0, 1].iter().for_each(|i| put(&i.to_le_bytes()));
        put(&[7]);
        put(&[3]);
        [2u32, 1, 0].iter().for_each(|i| put(&i.to_le_bytes()));
        file
    };
    let [little, big] = [false, true].map(|big| load(&Ply, &build(big)).expect("a model"));
    assert_eq!(little.meshes, big.meshes);
    let mesh = &little.meshes[0];
    assert_eq!(mesh.triangles, [[2, 1, 0]]);
    assert_eq!((mesh.positions[2], mesh.uvs[2].y), (Vec3::new(1.5, -2.0, 2.0), 0.5));
    assert_eq!((mesh.colors[0][0], mesh.colors[0][3]), (1.0, 1.0));
    assert!(mesh.normals.is_empty());
}

#[test]
fn strips_turn_every_second_triangle() {
    let lines = ["element vertex 5", XYZ, "element tristrips 1", "property list int int vertex_indices"];
    let mut file = header("ascii", &lines);
    file.extend(b"0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 2 0\n8 0 1 2 3 -1 2 3 4\n");
    let scene = load(&Ply, &file).expect("a model");
    assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [2, 1, 3], [2, 3, 4]]);
}

#[test]
fn a_claimed_count_is_not_believed() {
    let most = usize::MAX.to_string();
    for format in ["ascii", "binary_little_endian"] {
        // Even of elements that take no bytes at all.
        for properties in [XYZ, "comment none"] {
            let file = header(
                format,
                &[&format!("element vertex {most}"), properties, "element face 0", "property list uchar int vertex_index"],
            );
            assert!(load(&Ply, &file).map_or(true, |scene| scene.triangle_count() == 0));
        }
        let mut file = header(format, &["element vertex 0", XYZ, "element face 1", "property list uint int vertex_index"]);
        file.extend(if format == "ascii" { &b"4294967295 1\n"[..] } else { b"\xFF\xFF\xFF\xFF\x01\0\0\0\n" });
        let error = load(&Ply, &file).expect_err("no such list").to_string();
        assert!(error.contains("4294967295"), "{error}");
    }
}

#[test]
fn errors_name_the_place() {
    let start = ["element vertex 1", XYZ, "element face 1", "property list uchar int vertex_index"];
    let error = |body: &[u8]| load(&Ply, &[header("ascii", &start), body.to_vec()].concat()).expect_err("broken").to_string();
    assert_eq!(error(b"0 0 0\n3 0 0 7\n"), "line 11: there is no vertex 7; there are 1");
    assert_eq!(error(b"0 0 0\n3 0 0 -1\n"), "line 11: there is no vertex -1; there are 1");
    assert_eq!(error(b"0 zero 0\n"), "line 10: 'zero' is no number");
    assert!(error(b"0 0 0\n").contains("the file ends"));
    assert_eq!(load(&Ply, b"ply\nformat ascii 1.0\n").expect_err("broken").to_string(), "header: there is no 'end_header'");
    assert!(load(&Ply, b"ply\nformat klingon 1.0\nend_header\n").expect_err("broken").to_string().starts_with("line 2: "));
}

#[test]
fn points_alone_are_said_to_be_points() {
    let mut file = header("ascii", &["element vertex 1", XYZ]);
    file.extend(b"0 0 0\n");
    let scene = load(&Ply, &file).expect("readable");
    assert_eq!((soup(&scene).len(), scene.warnings.as_slice()), (0, ["There are only points.".to_owned()].as_slice()));
}

#[test]
fn headers_end_their_lines_in_any_way() {
    for end in ["\n", "\r\n", "\r"] {
        let text = "ply\nformat binary_little_endian 1.0\nelement vertex 10\nproperty uchar x\nproperty uchar y\nproperty uchar z\nend_header\n";
        let mut file = text.replace('\n', end).into_bytes();
        file.extend([b'\n'; 30]);
        let scene = load(&Ply, &file).expect("a model");
        assert_eq!(scene.meshes[0].positions[9], Vec3::splat(10.0));
    }
}

/// A row of triangles, with every attribute, in so many vertices of which each follows the one before.
fn row(format: &str, n: u32, change: impl Fn(u32, &mut [u32])) -> Vec<u8> {
    let lines = [
        &format!("element vertex {n}"),
        "property double x\nproperty float y\nproperty short z\nproperty float nx\nproperty float ny\nproperty float nz",
        "property float s\nproperty float t\nproperty uchar red\nproperty ushort green\nproperty float blue\nproperty float u",
        &format!("element face {}", n - 2),
        "property uchar flag\nproperty list uchar int vertex_indices\nproperty short last",
    ];
    let (mut file, big) = (header(format, &lines), format.contains("big"));
    let mut put = |bytes: &[u8]| if big { file.extend(bytes.iter().rev()) } else { file.extend(bytes) };
    for i in 0..n {
        let [low, middle, ..] = i.to_le_bytes();
        put(&(f64::from(i) * 0.1).to_le_bytes());
        put(&f32::from_bits(0x3F80_0000 | i << 3).to_le_bytes());
        put(&[low, middle]);
        [0.5, -1.5, 1e-40, 0.25, f32::NAN].iter().for_each(|x: &f32| put(&x.to_le_bytes()));
        put(&[low]);
        put(&[middle, low]);
        [f32::from(low) / 300.0, f32::from(middle)].iter().for_each(|x| put(&x.to_le_bytes()));
    }
    for i in 0..n - 2 {
        let mut corners = vec![i, i + 2, i + 1, i];
        change(i, &mut corners);
        let count = if corners[3] == i { 3 } else { 4 };
        put(&[9]);
        put(&[count]);
        corners.iter().take(usize::from(count)).for_each(|c| put(&c.to_le_bytes()));
        put(&[1, 2]);
    }
    file
}

#[test]
fn every_road_gives_the_same() {
    // The slow road is that of the other byte order.
    let both = |n: u32, change: &dyn Fn(u32, &mut [u32])| {
        let [quick, slow] = ["binary_little_endian", "binary_big_endian"].map(|format| load(&Ply, &row(format, n, change)));
        match (quick, slow) {
            (Ok(quick), Ok(slow)) => {
                let bits = |scene: &Scene| bytemuck::cast_slice::<_, u32>(&scene.meshes[0].uvs).to_vec();
                assert!(bits(&quick) == bits(&slow) && quick.meshes[0].positions == slow.meshes[0].positions);
                assert!(quick.meshes[0].normals == slow.meshes[0].normals && quick.meshes[0].colors == slow.meshes[0].colors);
                assert!(quick.meshes[0].triangles == slow.meshes[0].triangles);
                Ok(quick.meshes[0].triangles.len())
            }
            (quick, slow) => {
                let [quick, slow] = [quick, slow].map(|read| read.expect_err("both are wrong").to_string());
                assert_eq!(quick, slow);
                Err(quick)
            }
        }
    };
    for n in [3, 4, 80_000] {
        assert_eq!(both(n, &|_, _| ()), Ok(n as usize - 2));
        assert_eq!(
            both(n, &|i, corners| if i == n - 3 {
                corners[3] = i + 1
            }),
            Ok(n as usize - 1),
            "one quadrangle"
        );
        for wrong in [n, 1 << 31, u32::MAX] {
            let error = both(n, &|i, corners| {
                if i == n / 2 - 1 {
                    corners[1] = wrong
                }
            });
            assert!(
                error.as_ref().is_err_and(|e| e.starts_with(&format!("face {}: there is no vertex", n / 2 - 1))),
                "{error:?}"
            );
        }
    }
}
