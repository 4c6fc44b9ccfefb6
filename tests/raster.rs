//! The rasteriser sees what primary rays hit: the same triangle at the same depth, but for pixels where
//! an edge, a tie or the eye's own plane leaves it to rounding.

mod common;

use std::sync::Arc;

use boxwood::accel::{Accel, Mode, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::{Contestant, MeasureOptions, RasterRow, RayKind, RaySet, differing, measure_with_raster};
use boxwood::render::raster::{Counts, Raster};
use boxwood::render::{self, Job};
use boxwood::scene::{Camera, CameraSpec, Geometry, LoadCx, Projection, Scene, open};
use boxwood::task::{Cancel, Pool, Progress};
use common::{ball, build, scene_of, soup, trace};
use glam::Vec3;

const SIZE: [u32; 2] = [160, 100];

fn job(scene: Scene, camera: impl FnOnce(&Scene, &Geometry) -> Camera) -> Job {
    let geometry = Arc::new(Geometry::new(&scene, &LoadCx::unattended()).expect("small"));
    let entry = registry::find("bvh").expect("registered");
    let accel: Arc<dyn Accel> = Arc::from(build(entry, &geometry, TestKind::Watertight));
    let camera = camera(&scene, &geometry);
    Job::new(Arc::new(scene), accel, camera, render::Mode::Shaded, Arc::default())
}

/// A built-in scene from a camera in words, or from its own.
fn built_in(model: &str, camera: Option<&str>) -> Job {
    let spec = camera.map(|words| words.parse::<CameraSpec>().expect("a camera"));
    let scene = open(model, &LoadCx::unattended()).expect("built in");
    job(scene, |scene, geometry| CameraSpec::or_first(spec.as_ref(), scene, geometry, 1.6))
}

/// Draws, compares with what the rays hit, and says by how much the two differ.
fn check(name: &str, job: &Job) -> (Counts, u64) {
    let (pool, cancel) = (Pool::new("test", 2), Cancel::new());
    let mut raster = Raster::new(SIZE[0], SIZE[1]);
    let geometry = job.accel.geometry();
    let counts = raster.draw(geometry, &job.camera, &pool, &cancel, &Progress::new()).expect("not cancelled");
    let set = RaySet::generate(RayKind::Primary, job, SIZE[0], SIZE[1], &pool, &cancel).expect("not cancelled");
    let found = differing(&raster, job.accel.as_ref(), &set.rays, &pool, &cancel).expect("not cancelled");
    let hits = trace(job.accel.as_ref(), &set.rays, Mode::Closest);
    let traced = hits.iter().flatten().count() as u64;
    println!("{name}: {counts:?}, overdraw {:.3}, traced {traced}, {found:?}", counts.overdraw());
    assert_eq!(found.other, 0, "{name}: {found:?} {counts:?}");
    assert!(counts.drawn.abs_diff(traced) <= found.edge && counts.covered >= counts.drawn, "{name}");
    // Where both see the same triangle they see it at the same t; at a grazing angle rounding is magnified.
    let same = hits.iter().enumerate().filter_map(|(i, hit)| {
        let (seen, hit) = (raster.seen(i)?, hit.as_ref()?);
        (Some(seen.prim) == geometry.flat(hit.instance, hit.primitive)).then_some((seen.t, hit.t))
    });
    let far = same.filter(|(seen, hit)| (seen - hit).abs() > 1e-4 * hit.abs()).count() as u64;
    assert!(far * 1000 <= counts.drawn, "{name}: t differs at {far} of {} pixels", counts.drawn);
    (counts, found.edge)
}

#[test]
fn built_in_scenes_look_as_they_are_traced() {
    let scenes = [
        ("builtin:lecture", None),
        ("builtin:teapot", None),
        ("builtin:teapot", Some("eye 0.1,0.2,0.5 target 1,1,0.7 fov 100")),
        ("builtin:teapot", Some("eye 3,-9,4 target 0,0,0.5 height 4")),
        ("builtin:teapot-in-stadium", None),
        ("builtin:cornell-box", None),
        // From inside, walls all around and behind.
        ("builtin:cornell-box", Some("eye 0.3,0.3,0.3 target 0.1,0.2,0.5 fov 120")),
        ("builtin:cornell-box?triangles=3000", Some("eye 0.25,0.4,0.3 target 0.3,0.1,0.1 fov 150")),
        ("builtin:sphere-flake?triangles=20000", None),
        ("builtin:menger?triangles=2000", None),
        // Along an axis, with the faces of the sponge edge on and its edges on pixel centres.
        ("builtin:menger?triangles=2000", Some("eye 0,-4,0 target 0,0,0 height 1.6")),
        ("builtin:menger?triangles=2000", Some("eye 0,-0.1,0.05 target 0.1,1,0 fov 110")),
        ("builtin:terrain?triangles=8000", None),
        ("builtin:hair?triangles=10000", None),
        ("builtin:soup?triangles=5000", Some("eye 0.5,0.5,0.5 target 1,1,0.6 fov 90")),
    ];
    for (model, camera) in scenes {
        let (counts, edge) = check(model, &built_in(model, camera));
        assert!(counts.drawn > 300, "{model} {camera:?}: something is seen");
        assert!(edge * 100 <= counts.drawn, "{model} {camera:?}: {edge} edge pixels of {}", counts.drawn);
    }
}

#[test]
fn a_closed_ball_has_no_cracks_from_any_side() {
    let triangles = ball(24);
    for (i, eye) in [Vec3::new(1.0, 0.7, 2.0), Vec3::X * 3.0, Vec3::Y * 2.0, Vec3::new(0.1, 0.0, 0.2)].into_iter().enumerate() {
        for projection in [Projection::Perspective { fov_y: 1.0 }, Projection::Orthographic { height: 1.5 }] {
            let camera = Camera { eye, target: Vec3::new(0.0, 0.05, 0.0), up: Vec3::Y, projection };
            let (counts, edge) = check(&format!("ball {i}"), &job(scene_of(&triangles), |_, _| camera));
            assert!(edge * 200 <= counts.drawn, "{edge} of {}", counts.drawn);
        }
    }
}

#[test]
fn extreme_scales_and_far_eyes_are_compared_within_rounding() {
    for scale in [1e-30, 1e-12, 1e12, 1e30] {
        for distance in [2.0, 30.0, 1e4] {
            let at = |p: Vec3| p * scale;
            let triangles: Vec<[Vec3; 3]> = [ball(8), soup(60, 0.5, 3)].concat().into_iter().map(|tri| tri.map(at)).collect();
            let fov_y = 2.0 * (1.5f32 / distance).atan();
            let eye = at(Vec3::new(0.3, 0.4, 0.866) * distance);
            let camera = Camera { eye, target: Vec3::ZERO, up: Vec3::Y, projection: Projection::Perspective { fov_y } };
            let (counts, _) = check(&format!("{scale} from {distance}"), &job(scene_of(&triangles), |_, _| camera));
            assert!(counts.drawn > 2000, "{counts:?}");
        }
    }
}

#[test]
fn the_rasteriser_takes_turns_with_the_structures() {
    let job = built_in("builtin:teapot?triangles=1000", None);
    let (pool, cancel, progress) = (Pool::new("test", 2), Cancel::new(), Progress::new());
    let set = RaySet::generate(RayKind::Primary, &job, SIZE[0], SIZE[1], &pool, &cancel).expect("not cancelled");
    let all = [Contestant { id: "bvh".into(), accel: Arc::clone(&job.accel) }];
    let options = MeasureOptions { min_rounds: 3, min_secs: 0.01, ..MeasureOptions::default() };
    let measured = measure_with_raster(&all, &set, &job, SIZE, &options, &pool, &cancel, &progress);
    let (timings, row) = measured.expect("not cancelled");
    assert!(timings.len() == 1 && timings[0].rounds >= 3 && row.rounds >= 3, "{row:?}");
    assert_eq!((row.count, row.differing.other), (set.rays.len(), 0));
    assert!(row.hits.abs_diff(timings[0].hits) <= row.differing.edge && row.overdraw > 1.0, "{row:?}");
    assert_eq!((row.timing().id.as_str(), row.timing().nodes_per_ray.is_nan()), (RasterRow::ID, true));
    assert!((row.mrays_per_sec * row.secs * 1e6 - row.count as f64).abs() < 1.0);

    let alone = measure_with_raster(&[], &set, &job, SIZE, &options, &pool, &cancel, &progress).expect("not cancelled");
    assert!(alone.0.is_empty() && alone.1.covered == row.covered);
    cancel.cancel();
    assert!(measure_with_raster(&all, &set, &job, SIZE, &options, &pool, &cancel, &progress).is_err());
}
