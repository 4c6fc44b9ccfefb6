//! Haines' sphere flake (Eric Haines 1987, "A proposal for standard graphics environments"): each
//! sphere carries nine of a third its size, six around its waist and three above. One mesh, placed
//! once for each sphere: what instancing and two-level structures are for.

use super::fill::{Sizes, fill};
use super::sphere;
use super::view;
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Material, Mesh, Reason, Scene};
use glam::{Affine3A, Quat, Vec3};

/// How many generations of spheres after the first, and how finely each is cut.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Plan {
    levels: u32,
    cuts: u32,
}

/// About so many triangles, the two of the ground included.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let plan = Plan::nearest(triangles);
    let cuts = plan.cuts as usize;
    let vertices = sphere::vertices(cuts);
    let instances = spheres(plan.levels);
    let sizes = Sizes { vertices, normals: vertices, triangles: sphere::triangles(cuts), instances, ..Sizes::default() };
    let _memory = sizes.begin(cx)?;
    let mut placed = vec![Instance::identity(1)];
    placed.extend(instances_of(plan.levels, cx)?);
    Ok(Scene {
        meshes: vec![ball(plan.cuts), ground()],
        instances: placed,
        materials: vec![material("copper", [0.56, 0.30, 0.19]), material("ground", [0.34, 0.36, 0.34])],
        up: Vec3::Z,
        camera: Some(view(Vec3::new(0.0, 0.0, 0.25), Vec3::new(2.3, -4.2, 2.0))),
        ..Scene::default()
    })
}

fn material(name: &str, [r, g, b]: [f32; 3]) -> Material {
    Material { name: name.into(), base_color: [r, g, b, 1.0], ..Material::PLAIN }
}

fn ball(cuts: u32) -> Mesh {
    let sphere::Sphere { points, triangles } = sphere::unit(cuts);
    Mesh { name: "sphere".into(), normals: points.clone(), positions: points, triangles, material: Some(0), ..Mesh::default() }
}

/// A square below the flake.
fn ground() -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, 0.0) * 12.0 - Vec3::Z;
    Mesh {
        name: "ground".into(),
        positions: vec![corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material: Some(1),
        ..Mesh::default()
    }
}

/// 1 + 9 + 81 + ...
fn spheres(levels: u32) -> usize {
    (9usize.pow(levels + 1) - 1) / 8
}

impl Plan {
    /// The most generations that come within a twelfth of the number with spheres that look round,
    /// or else what comes nearest.
    fn nearest(triangles: usize) -> Self {
        let plans = (0..=6).rev().map(|levels| Self::with(levels, triangles));
        let good = |plan: &Self| plan.cuts >= 4 && 12 * plan.triangles().abs_diff(triangles) <= triangles;
        let nearest = || plans.clone().min_by_key(|plan| plan.triangles().abs_diff(triangles));
        plans.clone().find(good).or_else(nearest).unwrap_or(Self { levels: 0, cuts: 1 })
    }

    fn with(levels: u32, triangles: usize) -> Self {
        let each = triangles as f64 / spheres(levels) as f64;
        let cuts = num::floor_index((each / 8.0).sqrt() + 0.5, 1 << 12).max(1);
        Self { levels, cuts: num::index(cuts) }
    }

    fn triangles(&self) -> usize {
        spheres(self.levels) * sphere::triangles(self.cuts as usize) + 2
    }
}

/// Where a sphere is, how large, and which way it grows: the z axis of `turn`.
#[derive(Clone, Copy, Debug)]
struct Ball {
    centre: Vec3,
    radius: f32,
    turn: Quat,
}

/// Generation after generation.
fn instances_of(levels: u32, cx: &LoadCx) -> Result<Vec<Instance>, Reason> {
    let directions = directions();
    let mut all = vec![Ball { centre: Vec3::ZERO, radius: 1.0, turn: Quat::IDENTITY }.instance()];
    let mut parents = vec![Ball { centre: Vec3::ZERO, radius: 1.0, turn: Quat::IDENTITY }];
    for _ in 0..levels {
        let children = fill(9 * parents.len(), cx, |i| parents[i / 9].child(directions[i % 9]))?;
        all.extend(fill(children.len(), cx, |i| children[i].instance())?);
        parents = children;
    }
    Ok(all)
}

/// Six around the waist and, between them, three as high as the face diagonal of a cube.
fn directions() -> [Vec3; 9] {
    let (h, s) = (0.5f32, 0.75f32.sqrt());
    let waist = [(1.0, 0.0), (h, s), (-h, s), (-1.0, 0.0), (-h, -s), (h, -s)].map(|(x, y)| Vec3::new(x, y, 0.0));
    let (out, high) = ((1.0f32 / 3.0).sqrt(), (2.0f32 / 3.0).sqrt());
    let upper = [(s, h), (-s, h), (0.0, -1.0)].map(|(x, y)| Vec3::new(x * out, y * out, high));
    let [a, b, c, d, e, f] = waist;
    [a, b, c, d, e, f, upper[0], upper[1], upper[2]]
}

impl Ball {
    /// The child in this direction, a third the size, touching.
    fn child(&self, direction: Vec3) -> Self {
        let radius = self.radius / 3.0;
        Self {
            centre: self.centre + self.turn * direction * (self.radius + radius),
            radius,
            turn: self.turn * Quat::from_rotation_arc(Vec3::Z, direction),
        }
    }

    fn instance(&self) -> Instance {
        let scale = Vec3::splat(self.radius);
        Instance { mesh: 0, world_from_object: Affine3A::from_scale_rotation_translation(scale, self.turn, self.centre) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn siblings_touch_their_parent_and_do_not_overlap() {
        let parent = Ball { centre: Vec3::ZERO, radius: 1.0, turn: Quat::IDENTITY };
        let children = directions().map(|d| parent.child(d));
        for (i, a) in children.iter().enumerate() {
            assert!((a.centre.length() - 4.0 / 3.0).abs() < 1e-6);
            for b in &children[i + 1..] {
                assert!(a.centre.distance(b.centre) > a.radius + b.radius);
            }
        }
    }

    #[test]
    fn plans_come_near() {
        assert_eq!(Plan::nearest(104_962), Plan { levels: 3, cuts: 4 });
        for n in [1_000, 5_000, 100_000, 1_000_000, 10_000_000, 50_000_000] {
            let made = Plan::nearest(n).triangles();
            assert!(made.abs_diff(n) * 8 <= n, "{n}: {made}");
        }
    }
}
