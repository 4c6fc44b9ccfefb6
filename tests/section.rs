//! A scene that is cut open: the camera's rays see what is left, and nothing else changes.

mod common;

use std::sync::Arc;

use boxwood::accel::probe::Counts;
use boxwood::accel::{self, Accel, Hit, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::geometry::{Axis, HalfSpace, Ray, Side};
use boxwood::render::{Film, HeatRays, Job, Mode, Until, render};
use boxwood::scene::{Camera, Projection, Section};
use boxwood::task::{Cancel, Pool, Progress};
use common::{ball, build, geometry_of, scene_of, soup};
use glam::Vec3;

const SIZE: [u32; 2] = [40, 30];

fn job(triangles: &[[Vec3; 3]], id: &str, mode: Mode) -> Job {
    let scene = scene_of(triangles);
    let geometry = geometry_of(&scene);
    let accel: Arc<dyn Accel> = Arc::from(build(registry::find(id).expect("registered"), &geometry, TestKind::Watertight));
    let camera = Camera::framing(geometry.world_bounds(), Vec3::new(1.0, 0.7, 2.0), Vec3::Y, 4.0 / 3.0);
    Job::new(Arc::new(scene), accel, camera, mode, Arc::default())
}

fn section(job: &Job, axis: Axis, place: f32, side: Side) -> HalfSpace {
    Section { axis, place, side }.of(job.accel.geometry().world_bounds())
}

fn film(job: &Job, samples: u32) -> Film {
    let (pool, until) = (Pool::new("test", 2), Until::samples(samples));
    render(job, (SIZE[0], SIZE[1]), &until, &pool, &Cancel::new(), &Progress::new()).expect("not cancelled").film
}

fn closest(accel: &dyn Accel, ray: &Ray) -> Option<Hit> {
    let mut hits = [None];
    accel.trace(&[*ray], accel::Mode::Closest, &mut hits, &Cancel::new()).expect("not cancelled");
    hits[0]
}

/// How far inside of what is left a point is.
fn inside(section: &HalfSpace, p: Vec3) -> f32 {
    let (normal, offset) = section.plane();
    normal.dot(p) + offset
}

/// The first of all hits of a whole ray that is left, and whether it is more than rounding that says so.
fn first_left(accel: &dyn Accel, section: &HalfSpace, whole: &Ray) -> (Option<Hit>, bool) {
    const ROUNDING: f32 = 1e-5;
    let (mut ray, mut sure) = (*whole, true);
    while let Some(hit) = closest(accel, &ray) {
        let by = inside(section, whole.at(hit.t));
        sure &= by.abs() > ROUNDING;
        if by >= 0.0 {
            return (Some(hit), sure);
        }
        ray.tmin = hit.t.next_up();
    }
    (None, sure)
}

#[test]
fn a_picture_shows_the_first_hit_that_is_left() {
    let (mut hits, mut changed, mut unsure) = (0, 0, 0);
    for triangles in [ball(8), soup(200, 0.3, 5)] {
        let brute = job(&triangles, "brute", Mode::Depth);
        let (bounds, scale) = (*brute.accel.geometry().world_bounds(), brute.accel.geometry().space().scale());
        for mut job in ["bvh", "kdtree"].map(|id| job(&triangles, id, Mode::Depth)) {
            // From outside, along an axis, so that rays are parallel to planes, and from within.
            for direction in [Vec3::new(1.0, 0.7, 2.0), Vec3::Z * 2.0, Vec3::new(-0.1, 0.05, 0.2)] {
                for projection in [Projection::Perspective { fov_y: 0.8 }, Projection::Orthographic { height: 2.0 }] {
                    job.camera = Camera { eye: bounds.centre() + direction, target: bounds.centre(), up: Vec3::Y, projection };
                    for (axis, side) in Axis::ALL.into_iter().flat_map(|axis| [(axis, Side::Below), (axis, Side::Above)]) {
                        let section = section(&job, axis, 0.4, side);
                        let whole = Job { section: None, ..job.clone() }.camera_rays(SIZE[0], SIZE[1], 0..SIZE[1], 0);
                        let film = film(&Job { section: Some(section), ..job.clone() }, 1);
                        for (ray, depth) in whole.iter().zip(film.depth().iter()) {
                            let (expected, sure) = first_left(brute.accel.as_ref(), &section, ray);
                            if !sure {
                                unsure += 1;
                                continue;
                            }
                            let expected = expected.map_or(f32::INFINITY, |hit| (f64::from(hit.t) * scale) as f32);
                            assert_eq!(*depth, expected, "{section:?}, {ray:?}");
                            let all =
                                closest(brute.accel.as_ref(), ray).map_or(f32::INFINITY, |hit| (f64::from(hit.t) * scale) as f32);
                            hits += usize::from(depth.is_finite());
                            changed += usize::from(*depth != all);
                        }
                    }
                }
            }
        }
    }
    assert!(hits > 5_000 && changed > 5_000 && unsure * 50 < hits, "{hits} hits, {changed} changed, {unsure} unsure");
}

#[test]
fn all_structures_give_the_same_picture_of_a_section() {
    let triangles = ball(10);
    for mode in [Mode::Shaded, Mode::Ao, Mode::Path] {
        let brute = job(&triangles, "brute", mode);
        let section = section(&brute, Axis::Z, 0.6, Side::Below);
        let cut = |job: Job| film(&Job { section: Some(section), ..job }, 2);
        let expected = cut(brute.clone());
        assert!(expected != film(&brute, 2) && expected.means().any(|m| m[3] > 0.9));
        for id in ["bvh", "wide", "kdtree", "grid", "octree", "bsp"] {
            assert!(cut(job(&triangles, id, mode)) == expected, "{id} differs in {mode:?}");
        }
    }
}

/// What a heat map shows of each pixel, ray by ray: the amount, and whether there is something.
fn watched(job: &Job) -> Vec<[f32; 4]> {
    let cancel = Cancel::new();
    let whole = Job { section: None, ..job.clone() };
    let cut = |ray: Ray| job.section.map_or(ray, |section| section.cut(&ray));
    let pixels = (0..SIZE[1]).flat_map(|y| (0..SIZE[0]).map(move |x| (x, y)));
    let of_pixel = |pixel: (u32, u32)| {
        let primary = job.heat_rays == HeatRays::Primary;
        let rays = if primary {
            vec![cut(whole.middle_ray(pixel, SIZE))]
        } else {
            job.heat_rays_of(std::iter::once(pixel), SIZE, &cancel).expect("not cancelled")
        };
        let Some(ray) = rays.first() else { return [0.0; 4] };
        let mut counts = Counts::default();
        let hit = job.accel.trace_watched(ray, job.heat_rays.mode(), &mut counts, &cancel).expect("not cancelled");
        let amount = match job.mode {
            Mode::Nodes => counts.nodes,
            Mode::Leaves => counts.leaves,
            Mode::Stack => counts.stack,
            _ => counts.prims,
        };
        // Where nothing ever waits a ray may still have entered nodes.
        let works = hit.is_some() || amount > 0 || (job.mode == Mode::Stack && counts.nodes > 0);
        [amount as f32, 0.0, 0.0, if !primary || works { 1.0 } else { 0.0 }]
    };
    pixels.map(of_pixel).collect()
}

#[test]
fn a_section_that_cuts_nothing_away_changes_nothing() {
    for mode in Mode::ALL {
        let job = job(&ball(8), "bvh", mode);
        for (place, side) in [(1.01, Side::Below), (-0.01, Side::Above)] {
            // Where the eye is on the other side rays begin at the plane, before everything.
            let section = Some(section(&job, Axis::Y, place, side));
            // Work of the camera's rays may differ: a ray that begins later meets fewer boxes.
            if !mode.is_heat() {
                assert!(film(&Job { section, ..job.clone() }, 2) == film(&job, 2), "{mode:?}");
            }
        }
        let nothing = HalfSpace { axis: Axis::Y, at: 1e6, side: Side::Above };
        assert!(film(&Job { section: Some(nothing), ..job.clone() }, 2).means().all(|mean| mean[3] == 0.0), "{mode:?}");
    }
}

#[test]
fn heat_maps_of_a_section_show_the_work_of_what_is_left_of_rays() {
    for mode in Mode::ALL.into_iter().filter(|mode| mode.is_heat()) {
        for heat_rays in HeatRays::ALL {
            let job = Job { heat_rays, ..job(&ball(8), "bvh", mode) };
            for (place, side) in [(0.6, Side::Below), (0.4, Side::Above), (1.01, Side::Below), (-0.01, Side::Above)] {
                let cut = Job { section: Some(section(&job, Axis::Y, place, side)), ..job.clone() };
                let made = film(&cut, 1);
                let means: Vec<[f32; 4]> = made.means().collect();
                assert!(means == watched(&cut), "{mode:?} {heat_rays:?} {place}");
                let cuts = (0.0..1.0).contains(&place);
                assert!(means.iter().any(|mean| mean[3] > 0.0) && (!cuts || made != film(&job, 1)), "{mode:?} {heat_rays:?}");
                // What leaves the first hit sees the whole model.
                assert!(cuts || heat_rays == HeatRays::Primary || made == film(&job, 1), "{mode:?} {heat_rays:?}");
            }
        }
    }
}
