//! `render`, `rays` and `trace`: what is in the files they leave.

use std::fs;
use std::io::Cursor;

use crate::support::{Folder, Hits, bad, good, hits, json};
use boxwood::accel::{BuildCx, Mode, registry};
use boxwood::geometry::Ray;
use boxwood::geometry::tri::TestKind;
use boxwood::render::LinearPicture;
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::task::Cancel;
use std::sync::Arc;

const SOUP: &str = "builtin:soup?triangles=300";

/// What the library says to the rays of a file.
fn expected(model: &str, rays: &str, id: &str, mode: Mode) -> (Vec<Ray>, Hits) {
    let bytes = fs::read(rays).expect("there");
    let npy = npyz::NpyFile::new(&bytes[..]).expect("an array");
    let (shape, numbers) = (npy.shape().to_vec(), npy.into_vec::<f32>().expect("float32"));
    assert_eq!(shape, [numbers.len() as u64 / 8, 8]);
    let rays: Vec<Ray> = bytemuck::cast_slice(&numbers).to_vec();

    let scene = scene::open(model, &LoadCx::unattended()).expect("opens");
    let geometry = Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"));
    let entry = registry::find(id).expect("registered");
    let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds");
    let mut found = vec![None; rays.len()];
    accel.trace(&rays, mode, &mut found, &Cancel::new()).expect("not cancelled");
    let hits = match mode {
        Mode::Closest => Hits {
            t: found.iter().map(|h| h.map_or(f32::INFINITY, |h| h.t)).collect(),
            u: found.iter().map(|h| h.map_or(0.0, |h| h.u)).collect(),
            v: found.iter().map(|h| h.map_or(0.0, |h| h.v)).collect(),
            primitive: found
                .iter()
                .map(|h| h.map_or(u32::MAX, |h| geometry.flat(h.instance, h.primitive).expect("flat")))
                .collect(),
        },
        Mode::Any => Hits {
            t: found.iter().map(|h| if h.is_some() { 0.0 } else { f32::INFINITY }).collect(),
            u: vec![0.0; rays.len()],
            v: vec![0.0; rays.len()],
            primitive: vec![u32::MAX; rays.len()],
        },
    };
    (rays, hits)
}

#[test]
fn every_structure_answers_rays_from_a_file_alike() {
    let folder = Folder::new();
    let (rays, out) = (folder.at("rays.npy"), folder.at("hits.npz"));
    for (kind, any) in [("primary", false), ("diffuse", false), ("shadow", true)] {
        good(&["rays", SOUP, "--kind", kind, "-o", &rays, "--size", "40x30"]);
        let mode = if any { Mode::Any } else { Mode::Closest };
        let (sent, answer) = expected(SOUP, &rays, "brute", mode);
        assert!(sent.len() > 100 && answer.t.contains(&f32::INFINITY) && answer.t.iter().any(|t| t.is_finite()), "{kind}");
        for entry in registry::ALL {
            let mut args = vec!["trace", SOUP, "--structure", entry.id, "--rays", &rays, "--hits", &out];
            args.extend(any.then_some("--any-hit"));
            let said = json(&[&args[..], &["--json"]].concat());
            assert!(hits(&out) == answer, "{} with {kind} rays", entry.id);
            let count = answer.t.iter().filter(|t| t.is_finite()).count();
            assert_eq!((said["rays"].as_u64(), said["hits"].as_u64()), (Some(sent.len() as u64), Some(count as u64)));
            assert_eq!(said["invalid"], 0);
        }
    }
    assert_eq!(folder.names(), ["hits.npz", "rays.npy"]);
}

#[test]
fn primitives_are_counted_in_file_order_with_dropped_ones() {
    let folder = Folder::new();
    let (model, out) = (folder.model(), folder.at("hits.npz"));
    // Down onto the top face (the 4th triangle, index 3), from the side (index 9 after a dropped one), and by.
    let rows: [[f32; 8]; 4] = [
        [0.75, 0.25, 5.0, 0.0, 0.0, -2.0, 0.0, f32::INFINITY],
        [3.0, 0.25, 0.75, -1.0, 0.0, 0.0, 0.0, 10.0],
        [3.0, 0.25, 0.75, -1.0, 0.0, 0.0, 0.0, 1.5],
        [3.0, 0.25, 0.75, 0.0, 0.0, 0.0, 0.0, 1.5],
    ];
    let mut bytes = Vec::new();
    write(&mut bytes, &rows);
    let rays = folder.file("rays.npy", &bytes);
    let said = json(&["trace", &model, "--structure", "bvh", "--rays", &rays, "--hits", &out, "--json", "--test", "fast"]);
    assert_eq!((&said["invalid"], &said["test"]), (&1.into(), &"fast".into()));
    let found = hits(&out);
    assert_eq!(found.primitive, [3, 9, u32::MAX, u32::MAX]);
    assert_eq!(found.t, [2.0, 2.0, f32::INFINITY, f32::INFINITY]);
}

fn write(bytes: &mut Vec<u8>, rows: &[[f32; 8]]) {
    use npyz::WriterBuilder;
    let shape = [rows.len() as u64, 8];
    let mut npy = npyz::WriteOptions::new().default_dtype().shape(&shape).writer(bytes).begin_nd().expect("begins");
    npy.extend(rows.iter().flatten().copied()).expect("written");
    npy.finish().expect("ends");
}

#[test]
fn a_picture_has_its_size_and_shows_something() {
    let folder = Folder::new();
    let out = folder.at("picture.png");
    let camera = "eye 3,2,4 target 0.5,0.5,0.5 fov 35";
    for (mode, range) in [("shaded", false), ("nodes", true)] {
        let said =
            good(&["render", &folder.model(), "-o", &out, "--mode", mode, "--size", "64x48", "--spp", "2", "--camera", camera]);
        assert!(said.contains("Mrays/s") && said.contains("nodes visited by a ray") == range, "{said}");
        let picture = image::open(&out).expect("a PNG").to_rgba8();
        assert_eq!(picture.dimensions(), (64, 48));
        let opaque = picture.pixels().filter(|p| p[3] == 255).count();
        assert!(opaque > 100 && opaque < 64 * 48, "{opaque} pixels show something");
    }
    assert_eq!(folder.names(), ["Würfel.ply", "picture.png"]);
}

#[test]
fn a_heat_map_says_of_which_rays_it_is() {
    let folder = Folder::new();
    let (model, out) = (folder.model(), folder.at("picture.exr"));
    let render =
        |mode, rays| ["render", &model, "-o", &out, "--mode", mode, "--size", "16x12", "--spp", "1", "--heat-rays", rays];
    assert!(good(&render("prims", "shadow")).contains("triangles tested by a shadow ray"));
    assert!(good(&render("stack", "bounce")).contains("entries on the stack at once, a bounce"));
    let notes = || {
        let picture = LinearPicture::read(Cursor::new(fs::read(&out).expect("there"))).expect("an EXR");
        ["heat_rays", "section"].map(|name| picture.note(name).map(str::to_owned))
    };
    assert_eq!(notes(), [Some("bounce".to_owned()), None]);
    good(&["render", &model, "-o", &out, "--size", "16x12", "--spp", "1", "--section", "-y,0.25"]);
    assert_eq!(notes(), [None, Some("-y,0.25".to_owned())], "what it does not show is not noted");
    let said = bad(&render("nodes", "diffuse"), 2);
    assert!(said.contains("primary, shadow or bounce"), "{said}");
    let said = bad(&render("shaded", "shadow"), 2);
    assert!(said.contains("nodes, leaves, prims or stack"), "{said}");
}

#[cfg(unix)]
#[test]
fn outputs_have_ordinary_rights_and_spare_devices() {
    use std::os::unix::fs::{FileTypeExt, PermissionsExt};
    let folder = Folder::new();
    let out = folder.at("rays.npy");
    good(&["rays", "builtin:cornell-box", "--kind", "primary", "--size", "4x4", "-o", &out]);
    let plain = folder.file("plain", "");
    let mode = |path: &str| fs::metadata(path).expect("there").permissions().mode();
    assert_eq!(mode(&out), mode(&plain));
    good(&["rays", "builtin:cornell-box", "--kind", "primary", "--size", "4x4", "-o", "/dev/null"]);
    assert!(fs::metadata("/dev/null").expect("there").file_type().is_char_device());
}
