//! The stability lab in short: every case, every structure and every test, against the oracle; and that the lab would
//! notice a structure that is wrong.

mod common;

use std::sync::Arc;

use boxwood::accel::{Accel, BuildCx, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::stability::{Options, Verdict, cases, check_case};
use boxwood::lab::{RayKind, RaySet};
use boxwood::render::{Job, Mode};
use boxwood::scene::Camera;
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
                let mut job = Job { scene: Arc::clone(&scene), accel: Arc::clone(&accel), camera: outside, mode: Mode::Shaded };
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
