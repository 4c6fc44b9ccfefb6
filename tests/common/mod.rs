//! Scenes and rays that several test files share.
#![allow(dead_code, reason = "each test file uses a part of it")]

pub mod tiny;

use std::io::Write;
use std::sync::Arc;

use boxwood::accel::probe::Counts;
use boxwood::accel::registry::Entry;
use boxwood::accel::{Accel, BuildCx, Hit, Mode};
use boxwood::geometry::Ray;
use boxwood::geometry::tri::TestKind;
use boxwood::scene::{Geometry, Instance, LoadCx, Mesh, Scene};
use boxwood::task::Cancel;
use glam::{DVec3, Vec3};

/// A small generator of the same numbers everywhere (PCG, O'Neill 2014).
pub struct Random(pub u64);

impl Random {
    pub fn bits(&mut self) -> u32 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        let word = ((self.0 >> ((self.0 >> 59) + 5)) ^ self.0).wrapping_mul(12_605_985_483_714_917_081);
        ((word >> 43) ^ word) as u32
    }

    /// In 0..1.
    pub fn unit(&mut self) -> f32 {
        (self.bits() >> 8) as f32 / (1u32 << 24) as f32
    }

    pub fn point(&mut self) -> Vec3 {
        Vec3::new(self.unit(), self.unit(), self.unit()) * 2.0 - 1.0
    }
}

/// A scene of one mesh from loose triangles.
pub fn scene_of(triangles: &[[Vec3; 3]]) -> Scene {
    let mut mesh = Mesh { name: "test".into(), ..Mesh::default() };
    for tri in triangles {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(tri);
        mesh.triangles.push([first, first + 1, first + 2]);
    }
    Scene { name: "test".into(), meshes: vec![mesh], instances: vec![Instance::identity(0)], up: Vec3::Y, ..Scene::default() }
}

pub fn geometry_of(scene: &Scene) -> Arc<Geometry> {
    Arc::new(Geometry::new(scene, &LoadCx::unattended()).expect("small"))
}

pub fn soup(n: usize, size: f32, seed: u64) -> Vec<[Vec3; 3]> {
    let mut random = Random(seed);
    (0..n)
        .map(|_| {
            let at = random.point();
            [at, at + random.point() * size, at + random.point() * size]
        })
        .collect()
}

/// A closed bumpy ball: neighbours share their corners to the bit.
pub fn ball(n: usize) -> Vec<[Vec3; 3]> {
    let at = |i: usize, j: usize| {
        let (a, b) = ((i % (2 * n)) as f32 / n as f32 * std::f32::consts::PI, j as f32 / n as f32 * std::f32::consts::PI);
        let r = 0.8 + 0.1 * (5.0 * a).sin() * (4.0 * b).sin();
        // The poles are one point each.
        let s = if j == 0 || j == n { 0.0 } else { b.sin() };
        Vec3::new(r * s * a.cos(), r * b.cos(), r * s * a.sin())
    };
    let quads = (0..2 * n).flat_map(|i| (0..n).map(move |j| (i, j)));
    quads.flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]).collect()
}

/// Rays of every sort against a scene: at random, along the axes, through corners and edges, from
/// inside, from far away, ending early.
pub fn rays_for(triangles: &[[Vec3; 3]], n: usize, seed: u64) -> Vec<Ray> {
    let mut random = Random(seed);
    let corner = |random: &mut Random| match triangles.len() {
        0 => random.point(),
        len => triangles[random.bits() as usize % len][random.bits() as usize % 3],
    };
    (0..n)
        .map(|i| {
            let origin = random.point() * 3.0;
            match i % 9 {
                0 => Ray::new(origin, random.point()),
                1 => Ray::new(origin, corner(&mut random) - origin),
                2 => Ray::new(origin, corner(&mut random).midpoint(corner(&mut random)) - origin),
                3 => {
                    let mut dir = Vec3::ZERO;
                    dir[i / 9 % 3] = if random.bits() & 1 == 0 { 1.0 } else { -1.0 };
                    Ray::new(corner(&mut random) - dir * 2.0, dir)
                }
                4 => Ray::new(corner(&mut random), random.point()),
                5 => Ray::segment(corner(&mut random), corner(&mut random)),
                6 => Ray::new(origin * 1e3, corner(&mut random) - origin * 1e3),
                7 => Ray { origin, dir: random.point() * 1e-3, tmin: random.unit() * 100.0, tmax: 1000.0 },
                _ => {
                    let (a, b) = (corner(&mut random), corner(&mut random));
                    Ray::new(a, b - a) // along an edge or a chord
                }
            }
        })
        .collect()
}

pub fn build(entry: &Entry, geometry: &Arc<Geometry>, test: TestKind) -> Box<dyn Accel> {
    entry.build(geometry, test, &entry.defaults(), &BuildCx::unattended(2)).expect("builds")
}

pub fn trace(accel: &dyn Accel, rays: &[Ray], mode: Mode) -> Vec<Option<Hit>> {
    let mut hits = vec![None; rays.len()];
    accel.trace(rays, mode, &mut hits, &Cancel::new()).expect("not cancelled");
    hits
}

/// Traces a ray and counts what that takes.
pub fn watch(accel: &dyn Accel, ray: &Ray, mode: Mode, counts: &mut Counts) -> Option<Hit> {
    accel.trace_watched(ray, mode, counts, &Cancel::new()).expect("not cancelled")
}

/// What 64 bits say of a ray and a triangle: t, and how far inside the edges it passes, relative to
/// the triangle's size (negative outside).
pub fn meet_in_f64(ray: &Ray, tri: &[Vec3; 3]) -> Option<(f64, f64)> {
    let [a, b, c] = tri.map(|p| p.as_dvec3());
    let (o, d) = (ray.origin.as_dvec3(), ray.dir.as_dvec3());
    let (e1, e2): (DVec3, DVec3) = (b - a, c - a);
    let n = e1.cross(e2);
    let det = -d.dot(n);
    if det.abs() <= 1e-9 * d.length() * n.length() {
        return None;
    }
    let s = o - a;
    let t = s.dot(n) / det;
    let q = d.cross(s);
    let (u, v) = (-e2.dot(q) / det, e1.dot(q) / det);
    Some((t, u.min(v).min(1.0 - u - v)))
}

/// Says that a check was left out, and what it takes. Straight to standard error: what tests print is
/// kept back when they pass.
pub fn left_out(want: &str, check: &str, remedy: &str) {
    let _ = writeln!(std::io::stderr(), "LEFT OUT for want of {want}: {check}. {remedy}");
}

/// Whether there is something that draws, be it a program; says so if there is not.
#[cfg(feature = "viewer")]
pub fn has_gpu(check: &str) -> bool {
    let instance = pollster::block_on(egui_kittest::wgpu::default_wgpu_setup().new_instance());
    let adapter = pollster::block_on(instance.request_adapter(&eframe::wgpu::RequestAdapterOptions::default()));
    if adapter.is_err() {
        left_out("a GPU driver", check, "Install mesa-vulkan-drivers libvulkan1 to run it.");
    }
    adapter.is_ok()
}
