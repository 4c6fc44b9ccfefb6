//! Pictures: the same for every structure, finished in the order that was promised.

mod common;

use std::sync::Arc;
use std::time::{Duration, Instant};

use boxwood::accel::probe::Counts;
use boxwood::accel::{self, Accel, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::{RayKind, RaySet};
use boxwood::render::{Development, Film, HeatRays, Job, Mode, Picture, Range, Renderer, Request, Tone, Until, render};
use boxwood::scene::{Camera, Projection};
use boxwood::task::{Budget, Cancel, Pool, Progress};
use common::{ball, build, geometry_of, scene_of, soup};
use glam::{Vec2, Vec3};

fn job(triangles: &[[Vec3; 3]], id: &str, mode: Mode) -> Job {
    let scene = scene_of(triangles);
    let geometry = geometry_of(&scene);
    let accel: Arc<dyn Accel> = Arc::from(build(registry::find(id).expect("registered"), &geometry, TestKind::Watertight));
    let camera = Camera::framing(geometry.world_bounds(), Vec3::new(1.0, 0.7, 2.0), Vec3::Y, 1.5);
    Job::new(Arc::new(scene), accel, camera, mode, Arc::default())
}

fn film(job: &Job, threads: usize) -> Film {
    render(job, (90, 60), &Until::samples(3), &Pool::new("test", threads), &Cancel::new(), &Progress::new())
        .expect("not cancelled")
        .film
}

#[test]
fn all_structures_give_the_same_picture() {
    for triangles in [soup(400, 0.3, 7), ball(12)] {
        for mode in [Mode::Shaded, Mode::Path, Mode::Normals, Mode::Depth, Mode::Ao] {
            let expected = film(&job(&triangles, "brute", mode), 1);
            assert!(expected.means().any(|m| m[3] > 0.9) && expected.means().any(|m| m[3] < 0.1), "an edge is in view");
            for entry in registry::ALL {
                let same = film(&job(&triangles, entry.id, mode), 2) == expected;
                assert!(same, "{} differs in {mode:?}", entry.id);
            }
        }
    }
}

#[test]
fn only_pixels_that_cannot_see_the_scene_are_not_traced() {
    let around = [Vec3::new(1.0, 0.7, 2.0), Vec3::new(-3.0, 0.1, 0.2), Vec3::new(0.0, 0.0, 1.0)];
    let projections = [
        Projection::Perspective { fov_y: 0.7 },
        Projection::Perspective { fov_y: 3.0 },
        Projection::Perspective { fov_y: 1e-4 },
        Projection::Orthographic { height: 3.0 },
        Projection::Orthographic { height: 40.0 },
    ];
    let (mut left_out, mut all) = (0, 0);
    for triangles in [ball(8), soup(60, 0.3, 3)] {
        let mut job = job(&triangles, "bvh", Mode::Depth);
        for (i, direction) in around.into_iter().enumerate() {
            for projection in projections {
                for distance in [0.5f32, 3.0, 20.0, 1e5] {
                    // Beside the middle, so that the scene is cut by an edge of the picture or out of it.
                    let target = Vec3::new(0.4, -0.3, 0.2) * i as f32 * distance.min(4.0);
                    job.camera = Camera { eye: target + direction * distance, target, up: Vec3::Y, projection };
                    let (mut film, pool) = (Film::new(41, 30), Pool::new("test", 1));
                    let (mut traced, mut sums) = (0, vec![[0.0f32; 4]; 41 * 30]);
                    for sample in 0..2 {
                        let rays = job.camera_rays(41, 30, 0..30, sample);
                        let mut hits = vec![None; rays.len()];
                        job.trace(&rays, accel::Mode::Closest, &mut hits, &Cancel::new()).expect("not cancelled");
                        for (sum, hit) in sums.iter_mut().zip(hits).filter_map(|(sum, hit)| Some((sum, hit?))) {
                            [sum[0], sum[3]] = [sum[0] + hit.t, sum[3] + 1.0];
                        }
                        traced += job.pass(&mut film, &pool, &Cancel::new()).expect("not cancelled").rays;
                    }
                    let same = film.means().zip(&sums).all(|(mean, sum)| [mean[0], mean[3]] == [sum[0] * 0.5, sum[3] * 0.5]);
                    assert!(same, "{:?}", job.camera);
                    (left_out, all) = (left_out + 2 * 41 * 30 - traced, all + 2 * 41 * 30);
                }
            }
        }
    }
    assert!(left_out * 3 > all && left_out < all, "{left_out} of {all} rays were left out");
}

#[test]
fn heat_maps_tell_structures_apart() {
    let triangles = soup(400, 0.3, 7);
    let total = |id: &str, mode| film(&job(&triangles, id, mode), 1).means().map(|m| f64::from(m[0])).sum::<f64>();
    assert!(total("brute", Mode::Prims) > 4.0 * total("bvh", Mode::Prims));
    assert!(total("bvh", Mode::Nodes) > total("brute", Mode::Nodes));
    assert!(total("bvh", Mode::Stack) > 0.0 && total("grid", Mode::Stack) == 0.0);
}

#[test]
fn heat_maps_are_of_the_rays_that_are_asked_for() {
    let (pool, cancel) = (Pool::new("test", 2), Cancel::new());
    for id in ["bvh", "kdtree", "grid"] {
        let mut job = job(&soup(400, 0.3, 7), id, Mode::Nodes);
        let primary = film(&job, 1);
        for (heat_rays, kind) in [(HeatRays::Shadow, RayKind::Shadow), (HeatRays::Bounce, RayKind::Diffuse)] {
            job.heat_rays = heat_rays;
            let until = Until::samples(1);
            let still = render(&job, (90, 60), &until, &pool, &cancel, &Progress::new()).expect("not cancelled");
            // One amount for each ray that leaves a hit, in the order of pixels.
            let shown: Vec<f32> = still.film.means().filter(|m| m[3] > 0.0).map(|m| m[0]).collect();
            let set = RaySet::generate(kind, &job, 90, 60, &pool, &cancel).expect("not cancelled");
            let count = |ray| {
                let mut counts = Counts::default();
                job.accel.trace_watched(ray, set.mode, &mut counts, &cancel).expect("not cancelled");
                counts.nodes as f32
            };
            assert_eq!(shown, set.rays.iter().map(count).collect::<Vec<_>>(), "{id}, {kind:?}");
            assert!(!shown.is_empty() && shown.len() < 90 * 60 && still.film != primary);
            let depths = |film: &Film| film.depth().iter().map(|t| t.is_finite()).collect::<Vec<_>>();
            assert_eq!(depths(&still.film), depths(&primary), "depths are the camera's");
        }
    }
}

#[test]
fn amounts_stay_while_their_range_changes() {
    let renderer = Renderer::new(Pool::new("test", 1), || {}).expect("a thread");
    let job = job(&soup(400, 0.3, 7), "bvh", Mode::Nodes);
    let expected = render(&job, (80, 60), &Until::samples(1), &Pool::new("test", 1), &Cancel::new(), &Progress::new());
    let expected: Vec<f32> = expected.expect("not cancelled").film.means().map(|m| m[0] / m[3]).collect();
    let request = Request { job, width: 80, height: 60, max_samples: 1, range: None, tone: Tone::default(), keep: None };
    let wait = |number: u64| finished(&renderer, number);
    let fitted = wait(renderer.request(request.clone()));
    let range = Range { min: 3.0, max: 9.0 };
    let ranged = wait(renderer.request(Request { range: Some(range), ..request.clone() }));
    assert!(ranged.range == range && fitted.range.min == 0.0 && fitted.rgba != ranged.rgba);
    assert!(fitted.range == fitted.suits && ranged.suits == fitted.suits, "the range that suits is told with another");
    let same = |values: &[f32]| values.iter().zip(&expected).all(|(a, b)| a == b || a.is_nan() && b.is_nan());
    for picture in [&fitted, &ranged] {
        let amounts = picture.amounts.as_ref().expect("a heat map");
        assert!(same(&amounts.values));
        let seen = expected.iter().filter(|x| x.is_finite()).count();
        assert_eq!(amounts.histogram.counts.iter().sum::<u32>() as usize, seen);
    }
    // (-1, -1) is the lower left pixel, (1, 1) the upper right.
    for (at, pixel) in [([-1.0, -1.0], 59 * 80), ([1.0, 1.0], 79), ([0.01, 0.01], 29 * 80 + 40)] {
        assert_eq!(fitted.amount_at(Vec2::from_array(at)), Some(expected[pixel]).filter(|x| x.is_finite()));
    }
    assert_eq!((fitted.amount_at(Vec2::splat(1.1)), fitted.amount_at(Vec2::NAN)), (None, None));
    let mut shaded = request;
    shaded.job.mode = Mode::Shaded;
    assert!(wait(renderer.request(shaded)).amounts.is_none());
}

#[test]
fn a_closed_ball_is_lit_without_speckles() {
    let ao = film(&job(&ball(24), "bvh", Mode::Ao), 1);
    let dark = ao.means().filter(|m| m[3] > 0.99 && m[0] < 0.3).count();
    let inside = ao.means().filter(|m| m[3] > 0.99).count();
    assert!(dark * 50 < inside, "a convex surface shadows itself at {dark} of {inside} pixels");
}

#[test]
fn the_renderer_refines_rests_and_pauses() {
    let renderer = Renderer::new(Pool::new("test", 1), || {}).expect("a thread");
    let request = Request {
        job: job(&soup(400, 0.3, 7), "brute", Mode::Shaded),
        width: 240,
        height: 160,
        max_samples: 3,
        range: None,
        tone: Tone::default(),
        keep: None,
    };
    let wait = |number: u64, samples: u32| {
        let start = Instant::now();
        loop {
            assert!(start.elapsed() < Duration::from_secs(30), "no picture came");
            if let Some(p) =
                renderer.picture().filter(|p| p.request == number && p.progress.step == 1 && p.progress.samples >= samples)
            {
                return p;
            }
            std::thread::sleep(Duration::from_millis(2));
        }
    };
    let first = renderer.request(request.clone());
    let done = wait(first, 3);
    assert!(done.progress.done && done.progress.counted > 0 && (done.width, done.height) == (240, 160));
    std::thread::sleep(Duration::from_millis(30));
    assert_eq!(renderer.picture().map(|p| p.generation), Some(done.generation), "it rests at the limit");

    let second = renderer.request(Request { max_samples: 100_000, ..request });
    let running = wait(second, 2);
    let pause = renderer.pause();
    pause.wait();
    let held = renderer.picture().map(|p| p.generation);
    std::thread::sleep(Duration::from_millis(50));
    assert_eq!(renderer.picture().map(|p| p.generation), held, "a paused renderer makes no pictures");
    drop(pause);
    wait(second, running.progress.samples + 2);
    assert!(second > first);
}

/// The last picture that answers a request.
#[track_caller]
fn finished(renderer: &Renderer, number: u64) -> Arc<Picture> {
    let start = Instant::now();
    loop {
        assert!(start.elapsed() < Duration::from_secs(30), "no picture came");
        match renderer.picture().filter(|p| p.request == number && p.progress.done) {
            Some(picture) => return picture,
            None => std::thread::sleep(Duration::from_millis(2)),
        }
    }
}

#[test]
fn samples_are_kept_when_only_what_becomes_of_them_changes() {
    let renderer = Renderer::new(Pool::new("test", 1), || {}).expect("a thread");
    let budget = Budget::of_mib(64);
    let (job, keep) = (job(&soup(400, 0.3, 7), "bvh", Mode::Path), Some(budget.clone()));
    let request = Request { job, width: 80, height: 60, max_samples: 9, range: None, tone: Tone::default(), keep };
    let wait = |number: u64| finished(&renderer, number);
    let first = wait(renderer.request(request.clone()));
    let samples: Vec<u32> = first.shots.iter().map(|shot| shot.samples).collect();
    assert_eq!(samples, [1, 2, 4, 8]);
    assert!(first.shots.iter().all(|shot| shot.light.as_ref().is_some_and(|light| light.len() == 4800)));
    assert!(first.shots.is_sorted_by(|a, b| a.secs < b.secs) && budget.used() >= 4 * 4800 * 12);
    // The same samples, exposed otherwise: no new ones, and another picture.
    let brighter = wait(renderer.request(Request { tone: Tone { exposure: 2.0, ..request.tone }, ..request.clone() }));
    assert!(Arc::ptr_eq(&first.shots[3], &brighter.shots[3]) && first.rgba != brighter.rgba);
    // More samples go on from those that are there; others begin anew.
    let more = wait(renderer.request(Request { max_samples: 16, ..request.clone() }));
    assert!(Arc::ptr_eq(&first.shots[3], &more.shots[3]) && more.shots.len() == 5);
    let mut elsewhere = request;
    elsewhere.job.camera.eye.x += 0.1;
    elsewhere.keep = Some(Budget::of_mib(0));
    let other = wait(renderer.request(elsewhere));
    assert!(!Arc::ptr_eq(&first.shots[0], &other.shots[0]));
    assert!(other.shots.iter().all(|shot| shot.light.is_none()), "what does not fit the budget is not kept");
}

#[test]
fn pixels_that_have_converged_get_no_more_rays_and_look_the_same() {
    for (triangles, mode) in [(ball(12), Mode::Shaded), (soup(60, 0.3, 3), Mode::Shaded), (ball(12), Mode::Ao)] {
        let job = job(&triangles, "bvh", mode);
        let (pool, cancel) = (Pool::new("test", 2), Cancel::new());
        let (mut all, mut part) = (Film::new(90, 60), Film::converging(90, 60));
        let (mut rays, mut fewer) = (Vec::new(), Vec::new());
        for _ in 0..200 {
            rays.push(job.pass(&mut all, &pool, &cancel).expect("not cancelled").rays);
            fewer.push(job.pass(&mut part, &pool, &cancel).expect("not cancelled").rays);
        }
        assert_eq!(rays[..16], fewer[..16], "so many samples each pixel gets");
        let (last, first) = (fewer[199], fewer[0]);
        assert!(last < first && last > 0, "{mode:?}: {last} of {first} rays");
        if mode == Mode::Shaded {
            assert!(last * 10 < first * 9, "{last} of {first} rays are left");
        }
        let ranged = Development { mode, range: Range { min: 0.0, max: 1.0 }, tone: Tone::default(), background: None };
        let (all, part) = pool.run(|| (ranged.develop(&all), ranged.develop(&part)));
        let most = all.iter().zip(&part).map(|(a, b)| a.abs_diff(*b)).max();
        assert!(most <= Some(2), "{mode:?}: {most:?} steps");
        assert!(!Film::converging(9, 9).is_done(1));
    }
    // Nothing to be seen is done with the first pass.
    let mut job = job(&ball(4), "bvh", Mode::Shaded);
    job.camera.eye = Vec3::new(0.0, 0.0, 50.0);
    job.camera.target = Vec3::new(0.0, 0.0, 100.0);
    let mut film = Film::converging(30, 20);
    assert_eq!(job.pass(&mut film, &Pool::new("test", 1), &Cancel::new()).map(|work| work.rays), Ok(0));
    assert!(film.is_done(4096));
}
