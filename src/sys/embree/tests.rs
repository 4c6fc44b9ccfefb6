//! One triangle, hit by one ray and by eight.

use super::*;

#[test]
fn an_index_past_the_last_vertex_is_refused() {
    let settings = Settings { high_quality: false, robust: true, threads: 1 };
    let Ok(library) = Library::find() else { return };
    let refused = Prepared::new(&library, settings, &[[0.0; 3]; 3], &[[0, 1, 3]]);
    assert!(matches!(refused, Err(Error::Indices)));
}

#[test]
fn one_triangle_is_hit_by_one_ray_and_by_the_same_of_eight() {
    let Ok(library) = Library::find() else { return };
    let settings = Settings { high_quality: false, robust: true, threads: 1 };
    let corners = [[-1.0, -1.0, 2.0], [1.0, -1.0, 2.0], [0.0, 1.0, 2.0]];
    let scene = Prepared::new(&library, settings, &corners, &[[0, 1, 2]]).and_then(Prepared::commit).expect("builds");
    assert!(scene.bytes() > 0 && library.version().expect("a version").starts_with(['3', '4']));
    let ray = |x: f32| ([x, 0.0, 0.0], [0.0, 0.0, 1.0], 0.0, f32::INFINITY);
    for x in [0.0, 3.0] {
        let (origin, dir, tmin, tmax) = ray(x);
        let new = || RayHit::new(origin, dir, tmin, tmax);
        let (mut closest, mut any) = (new(), new());
        scene.closest(&mut closest, true);
        assert_eq!(closest.prim, if x == 0.0 { 0 } else { NO_HIT });
        // Embree divides by an approximate reciprocal.
        assert!(if x == 0.0 { (closest.tfar - 2.0).abs() < 1e-5 } else { closest.tfar == f32::INFINITY });
        assert_eq!(scene.any(&mut any, false), x == 0.0);
    }
    let (mut closest, mut any) = (Packet::default(), Packet::default());
    for (lane, x) in [0.0, 3.0, 0.1].into_iter().enumerate() {
        let (origin, dir, tmin, tmax) = ray(x);
        closest.set(lane, origin, dir, tmin, tmax);
        any.set(lane, origin, dir, tmin, tmax);
    }
    scene.closest8(&mut closest, true);
    scene.any8(&mut any, false);
    let hits: Vec<bool> = (0..8).map(|lane| closest.hit(lane).is_some()).collect();
    assert_eq!(hits, [true, false, true, false, false, false, false, false]);
    assert!(closest.hit(2).is_some_and(|(t, prim)| (t - 2.0).abs() < 1e-5 && prim == 0));
    assert_eq!((0..3).map(|lane| any.occluded(lane)).collect::<Vec<_>>(), [true, false, true]);
}
