//! The stability lab in short: every case, every structure and every test, against the oracle; and that the lab would
//! notice a structure that is wrong.

mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use boxwood::accel::{Accel, BuildCx, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::stability::{Options, Verdict, cases, check_case};
use boxwood::lab::{CheckError, Checked, RayKind, RaySet, check_model};
use boxwood::render::{Job, Mode};
use boxwood::scene::{Camera, LoadCx, Reason, builtin};
use boxwood::task::{Cancel, Pool};
use glam::Vec3;

fn options(rays: usize) -> Options {
    let tests = TestKind::ALL.into_iter().chain(TestKind::OTHERS).collect();
    Options { seed: 3, rays, structures: registry::ALL.iter().collect(), tests, secs: 1e-4 }
}

#[test]
fn no_structure_is_wrong_on_any_case() {
    let (mut rays, mut near, mut boundary, mut slipped) = (0, 0, 0, 0);
    for case in cases::ALL {
        let outcome = check_case(case, &options(120), &BuildCx::unattended(2), &|| ()).expect("fits");
        assert_eq!(outcome.structures.len(), registry::ALL.len() * TestKind::ALL.len() + TestKind::OTHERS.len());
        for row in &outcome.structures {
            assert_ne!(row.verdict, Verdict::Fail, "{}: {row:?}", case.id);
            let refused = row.error.is_some() && case.id.starts_with("indices");
            assert!(row.rays > 0 && row.max_nodes > 0 || case.id == "few-0" || refused, "{}: {row:?}", case.id);
            if row.test == TestKind::Exact {
                assert!(row.max_ulps <= 0.5 && row.near == 0, "{}: {row:?}", case.id);
            }
            if row.id == "brute" && row.test == TestKind::Watertight {
                (rays, near, boundary) = (rays + row.rays, near + row.near, boundary + row.boundary);
            }
            slipped += row.slipped;
        }
    }
    println!("{rays} rays, {near} near, {boundary} through edges, {slipped} slipped through in fast");
    assert!(3 * near < 2 * rays, "a lab in which rounding explains everything proves nothing");
    assert!(boundary > rays / 20 && slipped > 0, "{boundary} of {rays} through edges, {slipped} slipped");
}

#[test]
fn cases_are_explained_and_the_same_for_the_same_seed() {
    for (i, case) in cases::ALL.iter().enumerate() {
        assert!(cases::ALL[..i].iter().all(|other| other.id != case.id), "{}", case.id);
        assert!([case.what, case.bites, case.remedy].iter().all(|text| text.ends_with('.')), "{}", case.id);
        let (a, b) = (case.trial(5, 40), case.trial(5, 40));
        let bits = |t: &cases::Trial| format!("{:?} {:?}", t.triangles, t.rays);
        assert_eq!(bits(&a), bits(&b));
        assert_ne!(bits(&a), bits(&case.trial(6, 40)), "{}", case.id);
        assert!(cases::find(case.id).is_some());
    }
}

/// Where lists may have hardly any entries, structures refuse, and not only when it is too late.
#[test]
fn structures_refuse_what_they_cannot_index() {
    let refused = |case: &str| {
        let case = cases::find(case).expect("a case");
        let outcome = check_case(case, &options(20), &BuildCx::unattended(2), &|| ()).expect("fits");
        let refused = outcome.structures.iter().filter(|row| row.error.is_some() && row.test == TestKind::Watertight);
        refused.map(|row| row.id).collect::<Vec<_>>()
    };
    assert_eq!(refused("indices-300"), ["bvh", "wide", "volumes", "kdtree", "grid", "grid2", "octree", "bsp"]);
    assert_eq!(refused("indices-1000"), ["kdtree", "grid", "grid2", "octree", "bsp"]);
    assert!(refused("indices-3000").len() < 5, "{:?}", refused("indices-3000"));
}

/// Runs something on a thread, stops it in the middle, and says how long it took to answer.
fn stopped<T: Send>(cancel: &Cancel, work: impl FnOnce() -> T + Send) -> (T, Duration) {
    std::thread::scope(|scope| {
        let job = scope.spawn(work);
        std::thread::sleep(Duration::from_millis(150));
        let asked = Instant::now();
        cancel.cancel();
        let out = job.join().expect("no panic");
        (out, asked.elapsed())
    })
}

#[test]
fn the_lab_and_the_check_of_a_model_stop_when_asked() {
    let cx = BuildCx::unattended(2);
    let all = Options { seed: 1, ..options(20_000) };
    let run = || cases::ALL.iter().try_for_each(|case| check_case(case, &all, &cx, &|| ()).map(drop));
    let (out, took) = stopped(&cx.cancel, run);
    assert!(matches!(out, Err(Reason::Cancelled(_))) && took < Duration::from_millis(100), "{took:?}");

    let cx = BuildCx::unattended(2);
    let scene = Arc::new(builtin::generate("terrain?triangles=200000", &LoadCx::unattended()).expect("fits"));
    let geometry = common::geometry_of(&scene);
    let entry = registry::find("brute").expect("registered");
    let accel: Arc<dyn Accel> = Arc::from(common::build(entry, &geometry, TestKind::Watertight));
    let checked = [Checked { id: "brute".into(), test: TestKind::Watertight, accel }];
    let camera = Camera::framing(geometry.world_bounds(), Vec3::ONE, Vec3::Z, 1.0);
    let (out, took) =
        stopped(&cx.cancel, || check_model((&scene, &geometry), &checked, (camera, [400, 400]), f64::INFINITY, &cx));
    assert!(matches!(out, Err(CheckError::Cancelled(_))) && took < Duration::from_millis(100), "{took:?}");
}

/// Eight triangles, each cut into four again and again, its corners on the sphere: every edge bends outwards.
fn sphere(levels: u32) -> Vec<[Vec3; 3]> {
    let axes = [Vec3::X, Vec3::NEG_X].into_iter().flat_map(|x| [Vec3::Y, Vec3::NEG_Y].map(|y| (x, y)));
    let mut triangles: Vec<_> = axes.flat_map(|(x, y)| [Vec3::Z, Vec3::NEG_Z].map(|z| [x, y, z])).collect();
    for _ in 0..levels {
        let cut = |[a, b, c]: [Vec3; 3]| {
            let [ab, bc, ca] = [a + b, b + c, c + a].map(|p| p / p.length());
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(cut).collect();
    }
    triangles
}

/// Rays that leave a surface start as far off as the hit's own error says: at no scale, and nowhere, does a convex body meet
/// its own light, nor does any pass out through the wall of a closed room.
#[test]
fn rays_that_leave_a_surface_neither_meet_it_nor_pass_it() {
    let pool = Pool::new("test", 2);
    let generate = |job: &Job, kind| RaySet::generate(kind, job, 96, 96, &pool, &Cancel::new()).expect("not cancelled").rays;
    for scale in [1e-30f32, 1e-6, 1.0, 1e6, 1e30] {
        for away in [0.0f32, 100.0, 1000.0] {
            let at = Vec3::new(1.0, -0.6, 0.3) * away;
            let place = |p: Vec3| (p + at) * scale;
            let triangles: Vec<_> = sphere(4).into_iter().map(|tri| tri.map(place)).collect();
            let scene = Arc::new(common::scene_of(&triangles));
            let geometry = common::geometry_of(&scene);
            for test in TestKind::ALL {
                let entry = registry::find("wide").expect("registered");
                let accel: Arc<dyn Accel> = Arc::from(common::build(entry, &geometry, test));
                let what = format!("{} at {scale:e}, {away} away", test.id());
                let outside = Camera::framing(geometry.world_bounds(), Vec3::new(0.5, 0.4, 1.0), Vec3::Y, 1.0);
                let mut job = Job::new(Arc::clone(&scene), Arc::clone(&accel), outside, Mode::Shaded, Arc::default());
                let rays = generate(&job, RayKind::Diffuse);
                let met = common::trace(accel.as_ref(), &rays, boxwood::accel::Mode::Closest).iter().flatten().count();
                assert!(rays.len() > 2000 && met == 0, "{met} of {} rays meet the body that they leave, {what}", rays.len());
                (job.camera.eye, job.camera.target) = (place(Vec3::new(0.1, 0.2, -0.1)), place(Vec3::new(0.5, 0.1, 0.6)));
                let rays = generate(&job, RayKind::Diffuse);
                let met = common::trace(accel.as_ref(), &rays, boxwood::accel::Mode::Closest).iter().flatten().count();
                assert!(rays.len() == 96 * 96 && met == rays.len(), "{met} of {} rays stay in the room, {what}", rays.len());
            }
        }
    }
}
