use super::*;
use crate::scene::LoadCx;
use crate::scene::texture::tests::{material, png, scene};
use crate::scene::texture::{Channel, Detail};

/// Left half solid, right half not there.
const HALVES: [[u8; 4]; 2] = [[255, 255, 255, 255], [255, 0, 0, 0]];

fn decoded(scene: &Scene) -> Textures {
    Textures::decode(scene, Detail::Colors, &LoadCx::unattended()).expect("not cancelled")
}

fn with(alpha: Alpha, texels: &[[u8; 4]]) -> Scene {
    scene(&[png(2, texels)], vec![Material { alpha, ..material(Some(0), Some((0, Channel::Alpha))) }])
}

#[test]
fn opaque_cut_out_and_blended() {
    let half_there = [[255, 255, 255, 102], [255, 0, 0, 0]];
    for (alpha, expected) in [
        (Alpha::Opaque, [1.0, 1.0]),
        (Alpha::Mask { cutoff: 0.5 }, [0.0, 0.0]),
        (Alpha::Mask { cutoff: 0.4 }, [1.0, 0.0]),
        (Alpha::Mask { cutoff: 0.0 }, [1.0, 1.0]),
        (Alpha::Blend, [0.4, 0.0]),
    ] {
        let scene = with(alpha, &half_there);
        let textures = decoded(&scene);
        let surface = Surface::new(&scene, 0, &textures);
        // uv is (u, v) on this triangle.
        assert_eq!([surface.coverage(0, 0.25, 0.1), surface.coverage(0, 0.75, 0.1)], expected, "{alpha:?}");
        assert!(Textures::none().get(0).is_none());
        let white = Textures::none();
        assert_eq!(Surface::new(&scene, 0, &white).coverage(0, 0.75, 0.1), 1.0, "until textures are there");
    }
}

#[test]
fn factor_vertices_and_texture_multiply() {
    let mut scene = with(Alpha::Blend, &[[255, 255, 255, 51], [0; 4]]);
    scene.materials[0].base_color = [0.5, 1.0, 1.0, 0.5];
    scene.meshes[0].colors = vec![[1.0, 1.0, 0.5, 0.0], [1.0, 1.0, 0.5, 1.0], [1.0, 1.0, 0.5, 1.0]];
    let textures = decoded(&scene);
    let surface = Surface::new(&scene, 0, &textures);
    assert!((surface.alpha(0, 0.25, 0.25) - 0.5 * 0.5 * 0.2).abs() < 1e-7);
    assert_eq!(surface.color::<true, true>(0, 0.25, 0.25), [0.5, 1.0, 0.5]);
    scene.meshes[0].uvs.clear();
    assert_eq!(Surface::new(&scene, 0, &textures).alpha(0, 0.25, 0.25), 0.25, "no coordinates, no texture");
}

#[test]
fn only_what_can_be_passed_is_tested() {
    let tested = |scene: &Scene| tested_meshes(scene, &decoded(scene)) == [true];
    let solid = [[255; 4]; 2];
    assert!(tested(&with(Alpha::Blend, &HALVES)) && !tested(&with(Alpha::Opaque, &HALVES)));
    assert!(!tested(&with(Alpha::Blend, &solid)));
    let mut faded = with(Alpha::Blend, &solid);
    faded.materials[0].base_color[3] = 0.9;
    assert!(tested(&faded));
    faded.materials[0].alpha = Alpha::Mask { cutoff: 0.5 };
    assert!(!tested(&faded), "more than enough everywhere");
    let mut vertices = with(Alpha::Blend, &solid);
    vertices.meshes[0].colors = vec![[1.0, 1.0, 1.0, 0.5]; 3];
    assert!(tested(&vertices));
    vertices.meshes[0].colors = vec![[0.0, 0.0, 0.0, 1.0]; 3];
    assert!(!tested(&vertices));
    let plain = Scene { meshes: vec![Mesh::default()], ..Scene::default() };
    assert_eq!(tested_meshes(&plain, &Textures::none()), [false]);
}

#[test]
fn the_share_that_stops_is_the_coverage() {
    let mut scene = with(Alpha::Blend, &[[255; 4]; 2]);
    let share = |scene: &Scene| {
        let textures = Textures::none();
        let surface = Surface::new(scene, 0, &textures);
        let hits = (0..100u16).flat_map(|i| (0..100u16).map(move |j| (f32::from(i) / 200.0, f32::from(j) / 200.0)));
        hits.filter(|(u, v)| surface.covers(3, 0, *u, *v)).count()
    };
    assert_eq!(share(&scene), 10_000);
    scene.materials[0].base_color[3] = 0.3;
    assert!((2_850..3_150).contains(&share(&scene)), "{}", share(&scene));
    scene.materials[0].base_color[3] = 0.0;
    assert_eq!(share(&scene), 0);
    scene.materials[0].base_color[3] = f32::NAN;
    assert_eq!(share(&scene), 0);
}

#[test]
fn thresholds_are_of_the_hit_alone() {
    let hits = (0..64u32).flat_map(|i| (0..64u32).map(move |p| threshold(i, p, 0.25, 0.5)));
    let thresholds: Vec<f32> = hits.collect();
    assert!(thresholds.iter().all(|t| (0.0..1.0).contains(t)));
    let mean = thresholds.iter().sum::<f32>() / thresholds.len() as f32;
    assert!((mean - 0.5).abs() < 0.02, "{mean}");
    assert_eq!(threshold(1, 2, 0.0, 0.5), threshold(1, 2, -0.0, 0.5));
    assert_ne!(threshold(1, 2, 0.5, 0.25), threshold(1, 2, 0.25, 0.5));
    assert_ne!(threshold(1, 2, 0.5, 0.5), threshold(2, 1, 0.5, 0.5));
}
