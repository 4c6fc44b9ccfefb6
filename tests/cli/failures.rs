//! How it ends when something is wrong: the exit code, one line with the reason, and nothing left.

use crate::support::{Folder, bad, good, program};

#[test]
fn a_bad_model_is_named_with_the_reason() {
    let folder = Folder::new();
    let whole = std::fs::read(folder.model()).expect("there");
    let cut = folder.file("kurz.ply", &whole[..whole.len() / 2]);
    let strange = folder.file("model.xyz", "1 2 3");
    let empty = folder.file("leer.obj", "v 0 0 0\n");
    let missing = folder.at("weg.stl");
    for (model, why) in [(&cut, "kurz.ply"), (&strange, "xyz"), (&empty, "triangles"), (&missing, "weg.stl")] {
        for args in [&["stats", model, "--structure", "bvh", "--json"][..], &["compare", model]] {
            let said = bad(args, 2);
            assert!(said.contains(&format!("Can't open {model}: ")) && said.contains(why), "{said}");
        }
    }
    assert!(bad(&["render", "builtin:oak", "-o", &folder.at("x.png")], 2).contains("teapot"), "the known ones are listed");
    assert!(!folder.names().contains(&"x.png".to_owned()));
}

#[test]
fn bad_arguments_are_explained() {
    let cases: [(&[&str], &str); 14] = [
        (&["stats", "builtin:lecture", "--structure", "oak"], "brute, bound, bvh, wide, volumes, kdtree, grid"),
        (&["stats", "builtin:lecture"], "--structure"),
        (&["stats", "builtin:lecture", "--structure", "bvh", "--set", "bins=1"], "a whole number from 2"),
        (&["stats", "builtin:lecture", "--structure", "bvh", "--set", "leaves=1"], "there is builder"),
        (&["stats", "builtin:lecture", "--structure", "bvh", "--test", "slow"], "watertight, fast or exact"),
        (&["compare", "builtin:lecture", "--rays", "gamma"], "primary, shadow, diffuse, lines or shuffled"),
        (&["stats", "builtin:lecture", "--structure", "bvh", "--alpha", "1.5"], "from 0 to 1"),
        (&["scaling", "builtin:soup", "--from", "1000", "--to", "500"], "two sizes"),
        (&["scaling", "builtin:lecture", "--to", "20"], "two sizes"),
        (&["compare", "builtin:lecture", "--best", "--like-for-like"], "cannot be used with"),
        (&["compare", "builtin:lecture", "--cap", "0"], "positive"),
        (&["render", "builtin:lecture", "-o", "x.png", "--size", "0x4"], "WIDTHxHEIGHT"),
        (&["render", "builtin:lecture", "-o", "x.jpg"], ".png"),
        (&["render", "builtin:lecture", "-o", "x.png", "--camera", "eye 1,2"], "X,Y,Z"),
    ];
    for (args, why) in cases {
        let said = bad(args, 2);
        assert!(said.contains(why), "{said}");
    }
    assert!(bad(&["rays", "builtin:lecture", "--kind", "primary", "-o", "no/such/folder/x.npy"], 2).contains("no such folder"));
}

#[test]
fn a_bad_ray_file_is_refused_before_anything_is_done() {
    let folder = Folder::new();
    let header = |shape: &str, descr: &str| {
        let text = format!("{{'descr': '{descr}', 'fortran_order': False, 'shape': {shape}, }}\n");
        [&b"\x93NUMPY\x01\x00"[..], &u16::try_from(text.len()).expect("short").to_le_bytes(), text.as_bytes()].concat()
    };
    let out = folder.at("hits.npz");
    let cases = [
        ("noise.npy", b"what rays?".to_vec(), "not a NumPy array"),
        ("flat.npy", header("(80,)", "<f4"), "rays are (N, 8)"),
        ("whole.npy", header("(1, 8)", "<i8"), "float32 or float64"),
        // Claims 32 TiB and holds nothing.
        ("huge.npy", header("(1099511627776, 8)", "<f4"), "0 bytes follow"),
        ("deep.npy", header(&"(".repeat(60_000), "<f4"), "shape"),
    ];
    for (name, bytes, why) in cases {
        let rays = folder.file(name, bytes);
        let said = bad(&["trace", "builtin:lecture", "--structure", "bvh", "--rays", &rays, "--hits", &out], 2);
        assert!(said.contains(name) && said.contains(why), "{said}");
    }
    let missing = folder.at("weg.npy");
    assert!(bad(&["trace", "builtin:lecture", "--structure", "bvh", "--rays", &missing, "--hits", &out], 2).contains("weg.npy"));
    assert!(!folder.names().contains(&"hits.npz".to_owned()));
}

#[test]
fn what_does_not_fit_is_refused_with_the_figure() {
    let said = bad(&["stats", "builtin:soup?triangles=20000", "--structure", "kdtree", "--memory", "2", "--json"], 1);
    assert!(said.contains("memory budget of 2.0 MiB"), "{said}");
}

#[test]
fn help_and_version_go_to_standard_output() {
    assert!(good(&["--help"]).contains("compare"));
    assert!(good(&["trace", "--help"]).contains("--any-hit"));
    assert_eq!(good(&["--version"]).trim(), concat!("boxwood ", env!("CARGO_PKG_VERSION")));
}

#[cfg(unix)]
#[test]
fn a_reader_that_goes_away_is_no_failure() {
    use std::process::Stdio;
    let mut child = program(&["stats", "builtin:teapot", "--structure", "bvh"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("it runs");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("it ends");
    assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(0), ""));
}

#[cfg(unix)]
#[test]
fn ctrl_c_ends_it_cleanly() {
    use std::process::{Command, Stdio};
    use std::time::{Duration, Instant};
    let folder = Folder::new();
    let out = folder.at("picture.png");
    let brute = ["render", "builtin:soup", "--structure", "brute", "--spp", "1000", "-o", &out];
    for wait in [150, 900] {
        let child = program(&brute).stderr(Stdio::piped()).spawn().expect("it runs");
        std::thread::sleep(Duration::from_millis(wait));
        let asked = Instant::now();
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status().expect("kill is there");
        assert!(sent.success());
        let output = child.wait_with_output().expect("it ends");
        assert_eq!((output.status.code(), String::from_utf8_lossy(&output.stderr).as_ref()), (Some(130), "boxwood: stopped\n"));
        assert!(asked.elapsed() < Duration::from_secs(2), "{:?}", asked.elapsed());
    }
    assert!(folder.names().is_empty(), "{:?}", folder.names());
}
