//! A figure for a lecture: sixteen flat triangles, on which boxes and split planes can be drawn
//! and followed by eye.

use super::fill::Sizes;
use crate::scene::{Camera, FirstView, Instance, LoadCx, Material, Mesh, Projection, Reason, Scene};
use glam::Vec3;

type Triangle = [(f32, f32); 3];

/// What one colour shows.
struct Group {
    name: &'static str,
    color: [f32; 4],
    triangles: &'static [Triangle],
}

/// On a sheet of 16 by 10. The groups differ in size and in distance from each other, so that the
/// median of the centres, the middle of the space and the SAH cut in different places; the long
/// one in the middle lies across every good plane.
#[rustfmt::skip]
static GROUPS: [Group; 5] = [
    Group { name: "slate", color: [0.125, 0.205, 0.290, 1.0], triangles: &[
        [(0.9, 1.0), (2.1, 1.2), (1.3, 2.1)],
        [(2.5, 0.7), (3.6, 1.2), (2.6, 1.7)],
        [(0.8, 2.6), (1.9, 2.3), (1.6, 3.5)],
        [(2.3, 2.3), (3.3, 2.0), (3.0, 3.1)],
        [(4.1, 1.5), (4.8, 2.3), (3.8, 2.7)],
    ] },
    Group { name: "ochre", color: [0.520, 0.330, 0.105, 1.0], triangles: &[
        [(10.3, 6.5), (12.0, 6.1), (11.1, 7.8)],
        [(12.6, 6.7), (14.3, 6.2), (13.7, 7.6)],
        [(11.6, 8.3), (13.2, 8.0), (12.0, 9.4)],
        [(14.0, 8.3), (15.3, 7.6), (14.8, 9.3)],
    ] },
    Group { name: "sage", color: [0.215, 0.300, 0.165, 1.0], triangles: &[
        [(0.7, 5.2), (5.3, 5.8), (1.9, 9.3)],
        [(8.3, 1.0), (12.9, 0.6), (11.4, 4.5)],
    ] },
    Group { name: "clay", color: [0.430, 0.160, 0.105, 1.0], triangles: &[
        [(5.6, 2.9), (6.0, 2.6), (9.6, 8.6)],
        [(6.3, 8.3), (7.7, 8.9), (6.5, 9.5)],
    ] },
    Group { name: "plum", color: [0.260, 0.130, 0.250, 1.0], triangles: &[
        [(14.1, 1.2), (14.9, 1.5), (14.3, 2.1)],
        [(15.0, 2.2), (15.6, 2.7), (14.8, 3.0)],
        [(13.9, 2.8), (14.4, 3.3), (13.8, 3.6)],
    ] },
];

/// Always the same sixteen, in the plane z = 0, seen straight from the front.
pub(super) fn generate(_triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let number = GROUPS.iter().map(|group| group.triangles.len()).sum();
    let _memory = Sizes { vertices: 3 * number, triangles: number, ..Sizes::default() }.begin(cx)?;
    let meshes: Vec<Mesh> = GROUPS.iter().enumerate().map(|(i, group)| group.mesh(i)).collect();
    let target = Vec3::new(8.0, 5.0, 0.0);
    Ok(Scene {
        instances: (0..meshes.len()).map(Instance::identity).collect(),
        meshes,
        materials: GROUPS.iter().map(Group::material).collect(),
        up: Vec3::Y,
        camera: Some(FirstView::Whole(Camera {
            eye: target + Vec3::Z * 20.0,
            target,
            up: Vec3::Y,
            projection: Projection::Orthographic { height: 11.0 },
        })),
        ..Scene::default()
    })
}

impl Group {
    fn mesh(&self, material: usize) -> Mesh {
        let corners = self.triangles.as_flattened();
        Mesh {
            name: self.name.into(),
            positions: corners.iter().map(|(x, y)| Vec3::new(*x, *y, 0.0)).collect(),
            triangles: (0u32..).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).take(self.triangles.len()).collect(),
            material: Some(material),
            ..Mesh::default()
        }
    }

    fn material(&self) -> Material {
        Material { name: self.name.into(), base_color: self.color, ..Material::PLAIN }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec2;

    /// Whether some edge of `a` has all of `b` on its right (all triangles run anticlockwise).
    fn parts(a: &Triangle, b: &Triangle) -> bool {
        (0..3).any(|i| {
            let (p, q) = (Vec2::from(a[i]), Vec2::from(a[(i + 1) % 3]));
            b.iter().all(|r| (q - p).perp_dot(Vec2::from(*r) - p) < 0.0)
        })
    }

    #[test]
    fn it_is_a_sheet_of_separate_triangles() {
        let all: Vec<&Triangle> = GROUPS.iter().flat_map(|group| group.triangles).collect();
        assert_eq!(all.len(), 16);
        for (i, a) in all.iter().enumerate() {
            let [p, q, r] = a.map(Vec2::from);
            assert!((q - p).perp_dot(r - p) > 0.0, "{a:?} runs clockwise");
            assert!(a.iter().all(|(x, y)| (0.0..=16.0).contains(x) && (0.0..=10.0).contains(y)));
            for b in &all[i + 1..] {
                assert!(parts(a, b) || parts(b, a), "{a:?} overlaps {b:?}");
            }
        }
    }
}
