//! Model files from the outside: small ones of every format, the same with their bytes changed,
//! and loading that is stopped.

mod common;

use std::path::PathBuf;
use std::time::{Duration, Instant};

use boxwood::scene::load::{Bytes, Loader, Siblings, loaders};
use boxwood::scene::{Geometry, LoadCx, Reason, Scene, open};
use boxwood::task::{Budget, Cancel};
use common::tiny;

/// Nothing lies beside the model.
struct Alone;

impl Siblings for Alone {
    fn read(&self, name: &str) -> Result<Bytes, Reason> {
        Err(Reason::Io { path: name.into(), error: std::io::ErrorKind::NotFound.into() })
    }

    fn locate(&self, name: &str) -> Result<PathBuf, Reason> {
        Ok(name.into())
    }
}

fn loader(id: &str) -> &'static dyn Loader {
    loaders().iter().copied().find(|loader| loader.id() == id).expect("a known format")
}

/// What every scene promises, and that it can be flattened.
fn check(scene: &Scene, cx: &LoadCx) {
    for mesh in &scene.meshes {
        let n = mesh.positions.len();
        assert!([mesh.normals.len(), mesh.uvs.len(), mesh.colors.len()].iter().all(|length| [0, n].contains(length)));
        assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < n));
        assert!(mesh.material.is_none_or(|m| m < scene.materials.len()));
    }
    assert!(scene.instances.iter().all(|i| i.mesh < scene.meshes.len()));
    let geometry = Geometry::new(scene, cx).expect("it is small");
    assert_eq!(geometry.triangle_count() as u64, scene.triangle_count());
}

#[test]
fn the_small_models_load() {
    let cx = LoadCx::unattended();
    for (name, id, bytes) in tiny::models() {
        let scene = loader(id).load(&bytes, &Alone, &cx).unwrap_or_else(|reason| panic!("{name}: {reason}"));
        check(&scene, &cx);
        assert_eq!(scene.triangle_count(), 2, "{name}");
    }
}

/// Numbers that look random and are the same every time (Marsaglia, "Xorshift RNGs", 2003).
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 >> 33).expect("31 bits") % n
    }
}

/// Changes up to four bytes to what tends to break things.
fn mutated(bytes: &[u8], random: &mut Random) -> Vec<u8> {
    const BAD: &[u8] = b"\x00\x01\x7F\x80\xFF 019-.eE/\n\r\"{}[],:#\\";
    let mut bytes = bytes.to_vec();
    for _ in 0..1 + random.below(4) {
        let at = random.below(bytes.len());
        match random.below(4) {
            0 => bytes[at] ^= 1 << random.below(8),
            1 => drop(bytes.remove(at)),
            2 => bytes.insert(at, BAD[random.below(BAD.len())]),
            _ => bytes[at] = BAD[random.below(BAD.len())],
        }
    }
    bytes
}

#[test]
fn no_bytes_make_a_loader_panic_or_hang() {
    const MUTATIONS: usize = 1000;
    let cx = LoadCx { budget: Budget::new(256 << 20), ..LoadCx::unattended() };
    let mut random = Random(0x9E37_79B9_7F4A_7C15);
    let mut tried = 0;
    let mut slowest = Duration::ZERO;
    for (name, id, bytes) in tiny::models() {
        let cut = (0..bytes.len()).map(|n| bytes[..n].to_vec());
        let changed: Vec<_> = (0..MUTATIONS).map(|_| mutated(&bytes, &mut random)).collect();
        for input in cut.chain(changed) {
            let start = Instant::now();
            match loader(id).load(&input, &Alone, &cx) {
                Ok(scene) => check(&scene, &cx),
                Err(reason) => assert!(!reason.to_string().is_empty()),
            }
            slowest = slowest.max(start.elapsed());
            assert!(start.elapsed() < Duration::from_secs(5), "{name}: {:?} for {input:?}", start.elapsed());
            assert_eq!(cx.budget.used(), 0, "{name} keeps memory charged");
            tried += 1;
        }
        // Bytes of another format.
        for other in loaders() {
            let _ = other.load(&bytes, &Alone, &cx);
        }
    }
    println!("{tried} broken files, the slowest took {slowest:?}");
}

/// Loads something large, cancels it after a `delay`, and returns how long it still went on;
/// `None` if it was loaded before.
fn time_to_stop(name: &str, id: &str, bytes: &[u8], delay: Duration) -> Option<Duration> {
    let cx = LoadCx::unattended();
    let cancel: Cancel = cx.cancel.clone();
    std::thread::scope(|scope| {
        let canceller = std::thread::Builder::new().name("canceller".into()).spawn_scoped(scope, move || {
            std::thread::sleep(delay);
            cancel.cancel();
            Instant::now()
        });
        let result = loader(id).load(bytes, &Alone, &cx);
        let end = Instant::now();
        let start = canceller.expect("a thread").join().expect("no panic");
        match result {
            Err(Reason::Cancelled(_)) => Some(end.saturating_duration_since(start)),
            Err(reason) => panic!("{name}: {reason}"),
            Ok(_) => None,
        }
    })
}

/// Cancels the loading of about `mib` mebibytes of every format, sooner and later.
fn all_stop(mib: usize, delays: impl Iterator<Item = u64> + Clone) {
    for (name, id, bytes) in tiny::repeated(mib << 20) {
        let stop = |ms| Some((ms, time_to_stop(name, id, &bytes, Duration::from_millis(ms))?));
        let stops: Vec<_> = delays.clone().map_while(stop).collect();
        assert!(!stops.is_empty(), "{name} was loaded before it could be cancelled");
        for (ms, took) in stops {
            println!("{name}, {mib} MiB, cancelled after {ms} ms: went on for {took:?}");
            assert!(took < Duration::from_millis(100), "{name}, cancelled after {ms} ms, went on for {took:?}");
        }
    }
}

#[test]
fn loading_stops_within_100_ms() {
    all_stop(48, [5, 30].into_iter()); // the quickest is done before the second
}

#[test]
#[ignore = "takes a minute and 4 GiB; for when a loader changes"]
fn loading_half_a_gigabyte_stops_within_100_ms() {
    all_stop(500, (0..8).map(|k| 25 << k));
}

#[test]
fn errors_are_sentences_with_the_file_the_place_and_the_reason() {
    let cx = LoadCx::unattended();
    let dir = tempfile::tempdir().expect("a folder");
    let path = dir.path().join("стул 椅子.obj");
    std::fs::write(&path, "v 0 0 0\nf 1 2 3\n").expect("written");
    let name = path.to_str().expect("Unicode");
    let error = open(name, &cx).expect_err("broken").to_string();
    assert_eq!(error, format!("Can't open {name}: line 2: there is no vertex 2; the file has 1"));
    std::fs::write(&path, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").expect("written");
    assert_eq!(open(name, &cx).expect("a model").triangle_count(), 1);
    std::fs::write(&path, "v 0 0 0\np 1\n").expect("written");
    assert!(open(name, &cx).expect_err("points").to_string().contains("it holds no triangles (Points, lines"));
    cx.cancel.cancel();
    assert!(open(name, &cx).expect_err("stopped").is_cancelled());
}
