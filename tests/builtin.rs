//! Every built-in scene, at its own size and at others.

use boxwood::scene::builtin::{self, Builtin, Size};
use boxwood::scene::{Geometry, LoadCx, Reason, Scene};
use boxwood::task::{Budget, Pool};

fn make(spec: &str, cx: &LoadCx) -> Scene {
    builtin::generate(spec, cx).unwrap_or_else(|e| panic!("{spec}: {e}"))
}

fn scaling() -> impl Iterator<Item = &'static Builtin> {
    builtin::all().iter().filter(|scene| !matches!(scene.size, Size::Fixed(_)))
}

/// Sizes that are made again and again: small enough for a test, and odd.
const SIZES: [usize; 6] = [1, 7, 100, 2_500, 30_011, 200_000];

/// By what factor a scene may miss a number of triangles, from what number on.
fn tolerance(id: &str) -> (f64, usize) {
    match id {
        "soup" => (1.0, 1),
        "hair" => (1.001, 7_000),
        "terrain" => (1.02, 200),
        "teapot" | "teapot-in-stadium" => (1.15, 2_500),
        "cornell-box" => (1.2, 2_500),
        "sphere-flake" => (1.12, 2_500),
        // A level has twenty times the triangles of the last.
        "menger" => (4.6, 7),
        other => panic!("how exact is {other}?"),
    }
}

fn check(spec: &str, scene: &Scene, cx: &LoadCx) {
    for mesh in &scene.meshes {
        let n = mesh.positions.len();
        assert!(mesh.triangles.iter().flatten().all(|i| (*i as usize) < n), "{spec}: an index is out of range");
        for (length, what) in [(mesh.normals.len(), "normals"), (mesh.uvs.len(), "uvs"), (mesh.colors.len(), "colours")] {
            assert!(length == 0 || length == n, "{spec}: {length} {what} for {n} vertices");
        }
        assert!(mesh.positions.iter().all(|p| p.is_finite()), "{spec}: a position is not finite");
        assert!(mesh.normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-4), "{spec}: a normal is not of unit length");
        assert!(mesh.material.is_some_and(|m| m < scene.materials.len()), "{spec}: a mesh has no material");
    }
    assert!(scene.instances.iter().all(|i| i.mesh < scene.meshes.len()));
    assert!(scene.camera.is_some() && scene.up.length() == 1.0 && scene.warnings.is_empty());
    let geometry = Geometry::new(scene, cx).unwrap_or_else(|e| panic!("{spec}: {e}"));
    assert_eq!((geometry.dropped(), geometry.degenerate()), (0, 0), "{spec}");
}

#[test]
fn every_scene_has_the_size_that_it_claims() {
    let cx = LoadCx::unattended();
    for builtin in builtin::all() {
        let scene = make(builtin.id, &cx);
        assert_eq!(scene.triangle_count(), builtin.size.by_default() as u64, "{}", builtin.id);
        assert_eq!(scene.name, format!("builtin:{}", builtin.id));
        check(builtin.id, &scene, &cx);
    }
}

#[test]
fn scenes_come_near_the_size_that_is_asked_for() {
    let cx = LoadCx::unattended();
    for builtin in scaling() {
        for size in SIZES {
            let spec = format!("{}?triangles={size}", builtin.id);
            let scene = make(&spec, &cx);
            check(&spec, &scene, &cx);
            let count = scene.triangle_count();
            let (factor, from) = tolerance(builtin.id);
            let missed = (count as f64 / size as f64).ln().abs();
            assert!(count >= 1 && (size < from || missed <= f64::ln(factor) + 1e-12), "{spec}: {count}");
        }
    }
}

/// Everything of a scene that is floats, as bits.
fn bytes(scene: &Scene) -> Vec<Vec<u8>> {
    let mut all = Vec::new();
    for mesh in &scene.meshes {
        all.push(bytemuck::cast_slice(&mesh.positions).to_vec());
        all.push(bytemuck::cast_slice(&mesh.normals).to_vec());
        all.push(bytemuck::cast_slice(&mesh.colors).to_vec());
        all.push(bytemuck::cast_slice(&mesh.triangles).to_vec());
    }
    let placed = |i: &boxwood::scene::Instance| bytemuck::bytes_of(&i.world_from_object.to_cols_array()).to_vec();
    all.extend(scene.instances.iter().map(placed));
    all
}

#[test]
fn the_number_of_threads_leaves_no_trace() {
    let on = |threads| LoadCx { pool: Pool::new("test", threads), ..LoadCx::unattended() };
    for builtin in builtin::all() {
        let spec = match builtin.size {
            Size::Fixed(_) => builtin.id.to_owned(),
            Size::Scales(_) | Size::Places(_) => format!("{}?triangles=150000", builtin.id),
        };
        assert!(bytes(&make(&spec, &on(1))) == bytes(&make(&spec, &on(2))), "{spec}");
    }
}

#[test]
fn a_scene_that_does_not_fit_is_refused_before_it_is_made() {
    for builtin in builtin::all() {
        let cx = LoadCx { budget: Budget::new(100), ..LoadCx::unattended() };
        let refused = builtin::generate(builtin.id, &cx);
        assert!(matches!(refused, Err(Reason::Memory(_))), "{}", builtin.id);
        assert_eq!(cx.budget.used(), 0);
    }
    let cx = LoadCx { budget: Budget::new(1 << 20), ..LoadCx::unattended() };
    for builtin in scaling() {
        let refused = builtin::generate(&format!("{}?triangles=50000000", builtin.id), &cx);
        assert!(matches!(refused, Err(Reason::Memory(_))), "{}", builtin.id);
    }
}

#[test]
fn a_scene_can_be_stopped() {
    for builtin in builtin::all() {
        let cx = LoadCx::unattended();
        cx.cancel.cancel();
        assert!(matches!(builtin::generate(builtin.id, &cx), Err(Reason::Cancelled(_))), "{}", builtin.id);
        assert_eq!(cx.budget.used(), 0);
    }
}

#[test]
fn errors_say_what_to_do() {
    let said = |spec: &str| match builtin::generate(spec, &LoadCx::unattended()) {
        Err(Reason::Builtin(what)) => what,
        other => panic!("{spec}: {other:?}"),
    };
    assert!(said("soap").contains("soup"));
    assert!(said("soup?salt=off").contains("triangles=N"));
    assert!(said("soup?triangles=0").contains("from 1 to 50000000"));
}

#[test]
fn the_lecture_is_flat() {
    let scene = make("lecture", &LoadCx::unattended());
    assert!((14..=18).contains(&scene.triangle_count()));
    assert!(scene.meshes.iter().flat_map(|mesh| &mesh.positions).all(|p| p.z == 0.0));
}

#[test]
fn the_sphere_flake_is_one_sphere_placed_many_times() {
    let scene = make("sphere-flake", &LoadCx::unattended());
    assert_eq!(scene.meshes.len(), 2);
    assert_eq!(scene.instances.iter().filter(|i| i.mesh == 0).count(), 820);
}
