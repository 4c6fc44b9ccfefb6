//! What a rasteriser may not get wrong: counts, shared edges, the eye's plane, extremes.

use super::*;
use crate::scene::{Instance, LoadCx, Mesh, Projection, Scene};
use glam::Vec3;

type Triangles = Vec<[Vec3; 3]>;

fn geometry(triangles: &[[Vec3; 3]]) -> Geometry {
    let mut mesh = Mesh::default();
    for tri in triangles {
        let first = crate::geometry::num::index(mesh.positions.len());
        mesh.positions.extend(tri);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    let scene = Scene { meshes: vec![mesh], instances: vec![Instance::identity(0)], ..Scene::default() };
    Geometry::new(&scene, &LoadCx::unattended()).expect("small")
}

fn draw_on(triangles: &[[Vec3; 3]], camera: &Camera, size: [u32; 2], threads: usize) -> (Raster, Counts) {
    let mut raster = Raster::new(size[0], size[1]);
    let pool = Pool::new("test", threads);
    let counts = raster.draw(&geometry(triangles), camera, &pool, &Cancel::new(), &Progress::new()).expect("not cancelled");
    (raster, counts)
}

fn draw(triangles: &[[Vec3; 3]], camera: &Camera) -> (Raster, Counts) {
    draw_on(triangles, camera, [64, 64], 2)
}

/// From (0, 0, 5) along -z, two units high.
fn parallel() -> Camera {
    Camera { eye: Vec3::Z * 5.0, target: Vec3::ZERO, up: Vec3::Y, projection: Projection::Orthographic { height: 2.0 } }
}

fn perspective(eye: Vec3, target: Vec3, fov_y: f32) -> Camera {
    Camera { eye, target, up: Vec3::Y, projection: Projection::Perspective { fov_y } }
}

/// The square from -1 to 1, in two triangles.
fn square(z: f32) -> Triangles {
    let [a, b, c, d] = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)].map(|(x, y)| Vec3::new(x, y, z));
    vec![[a, b, c], [a, c, d]]
}

/// A closed ball around the origin; neighbours share their corners to the bit.
fn ball(n: u16) -> Triangles {
    let at = |i: u16, j: u16| {
        let (a, b) = [i % (2 * n), j].map(|k| f32::from(k) / f32::from(n) * std::f32::consts::PI).into();
        // The poles are one point each.
        let s = if j == 0 || j == n { 0.0 } else { b.sin() };
        Vec3::new(s * a.cos(), b.cos(), s * a.sin())
    };
    let quads = (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j)));
    quads.flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]).collect()
}

#[test]
fn a_triangle_over_the_whole_screen_covers_each_sample_once() {
    let large = [[Vec3::new(-9.0, -9.0, 0.0), Vec3::new(9.0, -9.0, 0.0), Vec3::new(0.0, 9.0, 0.0)]];
    let (raster, counts) = draw(&large, &parallel());
    assert_eq!(counts, Counts { covered: 4096, drawn: 4096, set_up: 1, culled: 0, crossing: 0 });
    assert_eq!(raster.seen(77), Some(Seen { prim: 0, t: 5.0 }));
    assert_eq!((raster.seen(4096), raster.size()), (None, [64, 64]));
    let back: Triangles = large.iter().map(|[a, b, c]| [*c, *b, *a]).collect();
    assert_eq!(draw(&back, &parallel()).1.drawn, 4096, "triangles have two sides");
}

/// The diagonal runs through 64 samples, and each belongs to one of the two triangles.
#[test]
fn two_squares_over_each_other_are_drawn_twice() {
    for camera in [parallel(), perspective(Vec3::Z * 5.0, Vec3::ZERO, 2.0 * (1.0f32 / 5.0).atan())] {
        let both: Triangles = [square(-1.0), square(0.0)].concat();
        let (raster, counts) = draw(&both, &camera);
        assert!(counts.drawn == 4096 && counts.covered <= 8192 && counts.covered > 4096, "{counts:?}");
        assert!((0..4096).all(|i| raster.seen(i).is_some_and(|seen| seen.prim >= 2)), "the nearer is seen");
    }
    let (_, counts) = draw(&[square(-1.0), square(0.0)].concat(), &parallel());
    assert_eq!((counts.covered, counts.overdraw()), (8192, 2.0));
}

#[test]
fn of_equal_depths_the_lowest_is_seen() {
    let (raster, counts) = draw(&[square(0.5), square(0.5), square(0.0)].concat(), &parallel());
    assert_eq!(counts.overdraw(), 3.0);
    assert!((0..4096).all(|i| raster.seen(i).is_some_and(|seen| seen.prim < 2)));
}

/// From inside, triangles all around, behind the eye and through its plane: each sample is covered
/// once, so there is no crack and no edge that counts twice.
#[test]
fn a_closed_ball_around_the_eye_covers_each_sample_once() {
    let mut crossing = 0;
    for n in [3, 8, 40] {
        for eye in [Vec3::ZERO, Vec3::new(0.1, 0.2, -0.3), Vec3::new(0.0, 0.85, 0.0)] {
            for (target, fov) in [(Vec3::X, 1.0), (Vec3::NEG_Z, 2.5), (Vec3::new(0.3, 2.0, 0.1), 3.0)] {
                let (_, counts) = draw_on(&ball(n), &perspective(eye, target, fov), [90, 61], 2);
                assert_eq!((counts.drawn, counts.covered), (5490, 5490), "{n} {eye} {target} {fov} {counts:?}");
                crossing += counts.crossing;
            }
            let camera = Camera { eye, ..parallel() };
            let camera = Camera { target: eye - Vec3::Z, projection: Projection::Orthographic { height: 0.3 }, ..camera };
            let (_, counts) = draw(&ball(n), &camera);
            assert!(counts.drawn == counts.covered && (n < 8 || eye.y > 0.5 || counts.drawn == 4096), "{n} {eye} {counts:?}");
        }
    }
    assert!(crossing > 100, "{crossing}");
}

#[test]
fn a_triangle_through_the_plane_of_the_eye_is_seen_before_it_alone() {
    let floor = [[Vec3::new(-50.0, -1.0, 50.0), Vec3::new(50.0, -1.0, 50.0), Vec3::new(0.0, -1.0, -90.0)]];
    let (raster, counts) = draw(&floor, &perspective(Vec3::ZERO, Vec3::NEG_Z, 1.0));
    assert_eq!((counts.set_up, counts.crossing), (1, 1));
    let row = |y: usize| (0..64).filter(|x| raster.seen(y * 64 + x).is_some()).count();
    assert!((0..32).all(|y| row(y) == 0) && row(63) == 64, "below the horizon");
    let seen = raster.seen(63 * 64 + 32).expect("the floor");
    let down = 0.5f32.tan() * 63.0 / 64.0;
    assert!((seen.t - 1.0 / down).abs() < 1e-5, "{seen:?}");
    // In the plane of the eye it has no area.
    assert_eq!(draw(&floor, &perspective(Vec3::NEG_Y, Vec3::new(0.0, -1.0, -1.0), 1.0)).1.culled, 1);
}

#[test]
fn nothing_is_a_picture_too() {
    let (raster, counts) = draw(&[], &parallel());
    assert!(counts == Counts::default() && counts.overdraw().is_nan() && raster.seen(0).is_none());
    assert_eq!(draw_on(&square(0.0), &parallel(), [0, 9], 1).1.culled, 2);
    assert_eq!(draw_on(&square(0.0), &parallel(), [9, 0], 1).1.culled, 2);
}

#[test]
fn a_picture_does_not_depend_on_the_threads_or_on_what_was_drawn_before() {
    let camera = perspective(Vec3::new(0.5, 1.0, 2.0), Vec3::ZERO, 1.0);
    let (one, counts) = draw_on(&ball(20), &camera, [301, 211], 1);
    let (mut three, same) = draw_on(&ball(20), &camera, [301, 211], 3);
    assert!(one.texels == three.texels && counts == same);
    let pool = Pool::new("test", 2);
    let again = three.draw(&geometry(&ball(20)), &camera, &pool, &Cancel::new(), &Progress::new());
    assert!(again == Ok(counts) && one.texels == three.texels);
}

#[test]
fn scale_changes_nothing_but_t() {
    let scaled = |s: f32| {
        let triangles: Triangles = ball(9).iter().map(|tri| tri.map(|p| p * s)).collect();
        let cameras = [
            perspective(Vec3::new(0.5, 1.0, 2.0) * s, Vec3::ZERO, 1.0),
            Camera {
                eye: Vec3::ONE * s,
                target: Vec3::ZERO,
                up: Vec3::Y,
                projection: Projection::Orthographic { height: 2.5 * s },
            },
        ];
        cameras.map(|camera| draw(&triangles, &camera))
    };
    let plain = scaled(1.0);
    for k in [-100, -40, 40, 100] {
        for ((a, counts), (b, same)) in scaled(2.0f32.powi(k)).iter().zip(&plain) {
            assert!(counts == same && a.texels == b.texels, "2^{k}");
        }
    }
    for s in [1e-30, 1e30] {
        for ((a, counts), (b, same)) in scaled(s).iter().zip(&plain) {
            assert!(counts.drawn.abs_diff(same.drawn) < 5 && counts.drawn > 1000, "{s}: {counts:?} {same:?}");
            let pairs = (0..4096).filter_map(|i| Some((a.seen(i)?, b.seen(i)?)));
            assert!(pairs.filter(|(a, b)| (a.t / s / b.t - 1.0).abs() > 1e-4).count() < 5);
        }
    }
}

#[test]
fn no_camera_makes_it_panic() {
    let odd = [0.0, -0.0, 1.0, -1.0, 1e-45, f32::MIN_POSITIVE, 1e30, f32::MAX, f32::INFINITY, f32::NAN, std::f32::consts::PI];
    for x in odd {
        for y in odd {
            for projection in [Projection::Perspective { fov_y: y }, Projection::Orthographic { height: y }] {
                for up in [Vec3::Y, Vec3::splat(x)] {
                    let camera = Camera { eye: Vec3::new(x, 0.3, y), target: Vec3::splat(0.1), up, projection };
                    let (_, counts) = draw_on(&ball(4), &camera, [9, 7], 1);
                    assert!(counts.drawn <= 63 && counts.covered >= counts.drawn && counts.set_up + counts.culled == 48);
                }
            }
        }
    }
}

#[test]
fn drawing_stops_when_it_is_cancelled() {
    let cancel = Cancel::new();
    cancel.cancel();
    let drawn = Raster::new(9, 9).draw(&geometry(&square(0.0)), &parallel(), &Pool::new("test", 1), &cancel, &Progress::new());
    assert_eq!(drawn, Err(Cancelled));
}
