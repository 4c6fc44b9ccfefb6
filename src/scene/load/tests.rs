//! What the tests of the formats share, and the tests of what the formats share.

use super::text::{float, words};
use super::*;
use std::fs;

/// Files beside a model, by name.
pub(super) struct Beside<'a>(pub &'a [(&'a str, &'a [u8])]);

impl Siblings for Beside<'_> {
    fn read(&self, name: &str) -> Result<Bytes, Reason> {
        let found = self.0.iter().find(|(known, _)| *known == name);
        let missing = || Reason::Io { path: name.into(), error: std::io::ErrorKind::NotFound.into() };
        found.map(|(_, bytes)| bytes.to_vec().into()).ok_or_else(missing)
    }

    fn locate(&self, name: &str) -> Result<PathBuf, Reason> {
        Ok(name.into())
    }
}

/// Loads a model that stands alone, and checks what every mesh promises.
pub(super) fn load(loader: &dyn Loader, bytes: &[u8]) -> Result<Scene, Reason> {
    let scene = loader.load(bytes, &Beside(&[]), &LoadCx::unattended())?;
    check(&scene);
    Ok(scene)
}

/// Lists are empty or as long as the positions, and indices are below their number.
pub(super) fn check(scene: &Scene) {
    for mesh in &scene.meshes {
        let n = mesh.positions.len();
        for length in [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()] {
            assert!(length == 0 || length == n, "{length} of {n} in {}", mesh.name);
        }
        assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < n));
        assert!(mesh.material.is_none_or(|m| m < scene.materials.len()));
    }
    assert!(scene.instances.iter().all(|i| i.mesh < scene.meshes.len()));
}

/// The corners of every triangle, instance by instance, in the world.
pub(super) fn soup(scene: &Scene) -> Vec<[[f32; 3]; 3]> {
    let of = |i: &crate::scene::Instance| {
        let (mesh, t) = (&scene.meshes[i.mesh], i.world_from_object);
        mesh.triangles
            .iter()
            .map(move |tri| tri.map(|v| t.transform_point3(mesh.positions[v as usize]).to_array()))
            .collect::<Vec<_>>()
    };
    scene.instances.iter().flat_map(of).collect()
}

#[test]
fn the_ending_chooses_the_loader_in_any_case() {
    let id = |name: &str| by_extension(Path::new(name)).map(|loader| loader.id()).map_err(|reason| reason.to_string());
    assert_eq!(id("a/B.GLB"), Ok("gltf"));
    assert_eq!(id("Würfel.Ply"), Ok("ply"));
    assert_eq!(id("a.tar.stl"), Ok("stl"));
    assert_eq!(id("a.obj"), Ok("obj"));
    assert!(id("a.off").is_err_and(|text| text.starts_with("the format 'off' is not known")));
    assert!(id("noending").is_err_and(|text| text.contains("'noending'")));
}

#[test]
fn what_is_no_file_is_refused_before_it_is_opened() {
    let cx = LoadCx::unattended();
    let dir = tempfile::tempdir().expect("a folder");
    assert!(matches!(file(dir.path(), &cx), Err(Reason::Io { .. })));
    assert!(matches!(file(&dir.path().join("none.glb"), &cx), Err(Reason::Io { .. })));
    #[cfg(unix)]
    assert!(matches!(file(Path::new("/dev/zero"), &cx), Err(Reason::Io { .. })));
}

#[test]
fn a_model_reads_only_what_is_named_relative_to_it() {
    let cx = LoadCx::unattended();
    let dir = tempfile::tempdir().expect("a folder");
    let inner = dir.path().join("modèles");
    fs::create_dir(&inner).expect("a folder in it");
    fs::write(dir.path().join("up.bin"), b"up").expect("written");
    fs::write(inner.join("a b.bin"), b"ab").expect("written");
    let folder = disk::Folder::new(&inner, &cx);
    assert_eq!(*folder.read("../up.bin").expect("beside"), *b"up");
    assert_eq!(*folder.read("..\\up.bin").expect("beside"), *b"up");
    assert_eq!(*folder.read("a b.bin").expect("here"), *b"ab");
    for name in ["/etc/passwd", "\\\\server\\share", "C:\\a.bin", "http://example.org/a.bin", "file:///etc/passwd"] {
        let refused = folder.read(name).expect_err("must not be read").to_string();
        assert!(refused.contains("only files named relative to the model"), "{refused}");
    }
}

#[test]
fn large_files_are_mapped_and_the_same() {
    let cx = LoadCx { budget: crate::task::Budget::new(6 << 20), ..LoadCx::unattended() };
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("file");
    for length in [0, 3, 2 << 20, 10 << 20] {
        let content: Vec<u8> = (0..=250).cycle().take(length).collect();
        fs::write(&path, &content).expect("written");
        let heard = std::cell::Cell::new(0);
        let (bytes, memory) = disk::read(&path, &cx, |n| heard.set(heard.get() + n)).expect("readable");
        assert!(*bytes == content && heard.get() == content.len() as u64);
        assert_eq!((memory.bytes(), bytes.held()), if length < 4 << 20 { (length as u64, length as u64) } else { (0, 0) });
    }
}

#[test]
fn memory_is_charged_before_it_is_taken() {
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("large.stl");
    fs::write(&path, vec![0; 5000]).expect("written");
    let cx = LoadCx { budget: crate::task::Budget::new(4000), ..LoadCx::unattended() };
    assert!(matches!(file(&path, &cx), Err(Reason::Memory(_))));
    assert_eq!(cx.budget.used(), 0);
}

#[test]
fn lines_end_in_any_way_and_are_counted() {
    let cx = LoadCx::unattended();
    let mut lines = text::Lines::new(b"a b\r\n\n\rc", 7, &cx);
    let mut seen = Vec::new();
    while let Some(line) = lines.next().expect("short lines") {
        seen.push((line.number, line.words().count()));
    }
    assert_eq!(seen, [(7, 2), (8, 0), (9, 0), (10, 1)]);
    assert_eq!(words(b"  a\tb ").count(), 2);
    let mut endless = text::Lines::new(&[b'x'; 2 << 20], 1, &cx);
    assert!(endless.next().is_err());
}

#[test]
fn numbers_are_read_as_c_writes_them() {
    for (word, value) in
        [("1", 1.0), ("-.5", -0.5), ("2.", 2.0), ("+1e-3", 1e-3), ("-1.#INF", f32::NEG_INFINITY), ("1e99", f32::INFINITY)]
    {
        assert_eq!(float(word.as_bytes()), Some(value), "{word}");
    }
    assert!(["nan", "-nan", "1.#QNAN", "-1.#IND", "-nan(ind)"].iter().all(|w| float(w.as_bytes()).is_some_and(f32::is_nan)));
    assert!(["", "x", "1,5", "0x1", "1f"].iter().all(|w| float(w.as_bytes()).is_none()));
    assert_eq!(linear_from_srgb([f32::NAN, 2.0, 0.0]), [0.0, 1.0, 0.0]);
}
