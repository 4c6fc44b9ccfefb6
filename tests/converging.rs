//! Image error against samples: what is known of how pictures converge.

mod common;

use std::sync::Arc;

use boxwood::accel::visibility::Change;
use boxwood::accel::{Accel, Visibility, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::geometry::{Axis, HalfSpace, Side};
use boxwood::lab::converge::{self, ConvergeCx, ConvergeOptions, Convergence, Reference, Rendered, Runner};
use boxwood::lab::rms_difference;
use boxwood::render::sampler::{SamplerKind, Sampling};
use boxwood::render::{Film, Job, Looks, Mode, Transport};
use boxwood::scene::texture::Textures;
use boxwood::scene::{self, Camera, LoadCx, Projection, Scene};
use boxwood::task::{Budget, Cancel, Pool, Progress};
use common::{build, geometry_of};

const SIZE: [u32; 2] = [32, 32];

fn cornell() -> Scene {
    scene::open("builtin:cornell-box", &LoadCx::unattended()).expect("a built-in scene")
}

/// A view of the floor: the edges of a lamp that is seen are so much brighter than all else that a few pixels are the error.
fn floor(job: Job) -> Job {
    let (low, size) = (job.accel.geometry().world_bounds().min, job.accel.geometry().world_bounds().size());
    let at = |x: f32, y: f32, z: f32| low + size * glam::Vec3::new(x, y, z);
    let camera = Camera {
        eye: at(0.5, 0.6, 0.9),
        target: at(0.5, 0.0, 0.3),
        up: glam::Vec3::Y,
        projection: Projection::Perspective { fov_y: 0.5 },
    };
    Job { camera, ..job }
}

fn job(scene: Scene, id: &str) -> Job {
    let geometry = geometry_of(&scene);
    let accel: Arc<dyn Accel> = Arc::from(build(registry::find(id).expect("registered"), &geometry, TestKind::Watertight));
    let looks = Arc::new(Looks::new(&scene, Textures::none()));
    let camera = scene.first_camera(geometry.world_bounds(), 1.0);
    Job::new(Arc::new(scene), accel, camera, Mode::Path, looks)
}

fn runner(job: &Job, id: &str) -> Runner {
    let entry = registry::find(id).expect("registered");
    Runner { id: id.to_owned(), accel: Arc::from(build(entry, job.accel.geometry(), TestKind::Watertight)), build_secs: 0.01 }
}

fn cx() -> ConvergeCx {
    ConvergeCx { pool: Pool::new("test", 2), cancel: Cancel::new(), progress: Progress::new(), budget: Budget::of_mib(256) }
}

fn converged(job: &Job, ids: &[&str], options: &ConvergeOptions) -> (Rendered, Reference, Convergence) {
    let runners: Vec<Runner> = ids.iter().map(|id| runner(job, id)).collect();
    let cx = cx();
    let rendered = converge::render(job, &runners, options, &cx).expect("done");
    let reference = Reference::render(job, options.size, 16 * options.spp, (&cx.pool, &cx.cancel, &cx.progress)).expect("done");
    let convergence = converge::evaluate(&rendered, &reference);
    (rendered, reference, convergence)
}

fn options(spp: u32, samplers: &[SamplerKind]) -> ConvergeOptions {
    ConvergeOptions { size: SIZE, spp, secs: None, runs: 1, samplers: samplers.to_vec(), seed: 0, adaptive: false }
}

#[test]
fn errors_fall_as_they_should_and_all_structures_make_the_same_pictures() {
    let job = floor(job(cornell(), "bvh"));
    let ids = ["bvh", "wide", "octree", "kdtree", "grid"];
    let (rendered, reference, convergence) = converged(&job, &ids, &options(64, &SamplerKind::ALL));
    for curve in &convergence.curves {
        let slope = curve.slope.expect("enough points");
        let what = format!("{} {}: {slope:?}", curve.structure, curve.sampler.id());
        match curve.sampler {
            SamplerKind::Independent => assert!((slope.value + 0.5).abs() <= 0.05, "{what}"),
            SamplerKind::Sobol | SamplerKind::BlueNoise => assert!(slope.value <= -0.48, "{what}"),
        }
        assert!(slope.low <= slope.value && slope.value <= slope.high && slope.points == 5, "{what}");
        assert!(curve.points.iter().all(|p| !p.hollow) && curve.points.len() == 7, "{what}");
        assert!(curve.points.is_sorted_by(|a, b| a.secs < b.secs), "{what}");
    }
    // Stratified numbers are better than independent ones.
    let last = |sampler: SamplerKind| {
        let curve = convergence.curves.iter().find(|c| c.sampler == sampler).expect("measured");
        curve.points.last().expect("points").errors.rmse
    };
    assert!(last(SamplerKind::Sobol) < last(SamplerKind::Independent));
    assert!(convergence.coincide, "{:?}", convergence.agreements);
    for agreement in &convergence.agreements {
        assert_eq!(agreement.rays.wrong, 0, "{agreement:?}");
        assert!(agreement.rays.rays > 1024 * 4, "bounces and shadow rays are compared too: {agreement:?}");
        let hierarchy = ["bvh", "wide"].contains(&agreement.structure.as_str());
        assert!(!hierarchy || agreement.identical, "{agreement:?}");
    }
    // The same pictures are kept once.
    let shared = |lane: usize| Arc::ptr_eq(&rendered.lanes[0].shots[3].pixels, &rendered.lanes[lane].shots[3].pixels);
    assert!(shared(3) && !shared(1));
    assert!(reference.suits(&job, SIZE, 1024) && !reference.suits(&job, SIZE, 1025) && !reference.suits(&job, [32, 31], 64));
    let darker = Job { transport: Transport { surfaces: 2, ..job.transport }, ..job.clone() };
    assert!(!reference.suits(&darker, SIZE, 64));
    // What is cut away or hidden is not the same scene, whichever of both is kept.
    let (accel, cx) = (job.accel.as_ref(), cx());
    let hidden = Visibility::change(None, accel, (&accel.root(), Change::Hide), &cx.budget, &cx.cancel).expect("some");
    let cut = |at: f32, side| Job { section: Some(HalfSpace { axis: Axis::X, at, side }), ..job.clone() };
    let others = [
        Job { visible: Some(Arc::new(hidden)), ..job.clone() },
        cut(0.5, Side::Below),
        cut(0.5, Side::Above),
        cut(0.5f32.next_up(), Side::Below),
    ];
    let of = |job: &Job| Reference::render(job, SIZE, 1, (&cx.pool, &cx.cancel, &cx.progress)).expect("done");
    for (i, other) in others.iter().enumerate() {
        let made = of(other);
        assert!(!reference.suits(other, SIZE, 64) && !made.suits(&job, SIZE, 1), "{other:?}");
        assert!(others[..i].iter().all(|other| !made.suits(other, SIZE, 1)), "{other:?}");
        assert_eq!(made.suits(other, SIZE, 1), other.visible.is_none(), "{other:?}");
    }
    let mut moved = job;
    moved.camera.eye.x += 1e-3;
    assert!(!reference.suits(&moved, SIZE, 64));
}

#[test]
fn a_structure_that_misses_triangles_is_told() {
    let scene = cornell();
    let whole = job(scene.clone(), "bvh");
    // The same model without most of a mesh: what it says of a ray is wrong, whatever the picture looks like.
    let mut lesser = scene;
    let largest = lesser.meshes.iter_mut().max_by_key(|mesh| mesh.triangles.len()).expect("there are some");
    largest.triangles.truncate(2);
    let broken = job(lesser, "bvh");
    let found = converge::agreement(&whole, &broken.accel, (32, 32), &Pool::new("test", 2), &Cancel::new()).expect("done");
    assert!(found.wrong > 10, "{found:?}");
}

/// The mean light of a picture.
fn mean(job: &Job, spp: u32) -> f64 {
    let mut film = Film::new(SIZE[0], SIZE[1]);
    let pool = Pool::new("test", 2);
    for _ in 0..spp {
        job.pass(&mut film, &pool, &Cancel::new()).expect("not cancelled");
    }
    let light = film.linear();
    light.iter().flatten().map(|x| f64::from(*x)).sum::<f64>() / (3 * light.len()) as f64
}

#[test]
fn all_samplers_converge_to_the_same_mean() {
    let job = job(cornell(), "wide");
    let of = |kind: SamplerKind| {
        let means: Vec<f64> = (0..12).map(|seed| mean(&Job { sampling: Sampling { kind, seed }, ..job.clone() }, 8)).collect();
        let n = means.len() as f64;
        let middle = means.iter().sum::<f64>() / n;
        let variance = means.iter().map(|mean| (mean - middle).powi(2)).sum::<f64>() / (n - 1.0);
        (middle, variance / n)
    };
    let all = SamplerKind::ALL.map(of);
    for (a, b) in [(0, 1), (0, 2), (1, 2)] {
        let ((a, va), (b, vb)) = (all[a], all[b]);
        // Of 22 degrees of freedom: one in a thousand lies farther.
        assert!((a - b).abs() < 3.8 * (va + vb).sqrt(), "{all:?}");
        assert!((va + vb).sqrt() < 0.01 * a, "{all:?}");
    }
}

#[test]
fn the_estimated_noise_is_the_error_of_independent_samples() {
    let job = job(cornell(), "wide");
    let cx = cx();
    let reference = Reference::render(&job, SIZE, 2048, (&cx.pool, &cx.cancel, &cx.progress)).expect("done");
    // Both are noisy: squares are compared on average over pictures that have nothing to do with each other.
    let (mut estimated, mut measured) = (0.0, 0.0);
    for seed in 0..32 {
        let job = Job { sampling: Sampling { kind: SamplerKind::Independent, seed }, ..job.clone() };
        let mut film = Film::estimating(SIZE[0], SIZE[1]);
        for spp in 1..=16 {
            job.pass(&mut film, &cx.pool, &cx.cancel).expect("not cancelled");
            assert_eq!(film.noise().is_some(), spp > 1);
        }
        estimated += film.noise().expect("estimated").powi(2);
        measured += rms_difference(&film.linear(), &reference.pixels).powi(2);
    }
    assert!((estimated / measured - 1.0).abs() < 0.1, "{estimated} is estimated, {measured} measured");
}

#[test]
fn clamped_light_is_counted_and_missing() {
    let job = job(cornell(), "wide");
    let clamped = Job { transport: Transport { clamp: Some(0.2), ..job.transport }, ..job.clone() };
    let pool = Pool::new("test", 2);
    let pass = |job: &Job| {
        let mut film = Film::new(SIZE[0], SIZE[1]);
        let work = job.pass(&mut film, &pool, &Cancel::new()).expect("not cancelled");
        (work, film.linear().iter().flatten().map(|x| f64::from(*x)).sum::<f64>())
    };
    let ((free, all), (cut, less)) = (pass(&job), pass(&clamped));
    assert_eq!((free.clamped, free.lost), (0, 0.0));
    // What is missing is what is said to be.
    assert!(cut.clamped > 10 && less < all && (all - less - cut.lost).abs() < 1e-3 * all, "{all} {less} {cut:?}");
}
