//! One volume around some triangles, without a tree: what kinds are compared by, node by node.

use super::points::{Points, SMALL};
use super::volume::{Loose, Volume};
use crate::accel::bvh::Packed;
use crate::accel::cell::{Form, Shape};
use crate::geometry::{Aabb, Line, Ray};
use crate::scene::{Geometry, PrimRef};
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// A volume that stands alone. Rays are in the scaled space of the geometry that it was made for, and valid.
pub trait Alone: Send + Sync {
    /// The area of its surface, in the scaled space.
    fn area(&self) -> f64;

    /// What it looks like.
    fn form(&self) -> Form;

    /// Whether it is looser than its name says.
    fn loose(&self) -> Loose;

    /// Whether something may be hit in it, within the ray's interval.
    fn meets(&self, ray: &Ray) -> bool;

    /// Makes ready to test it against rays. What is returned tests them all so many times, and says how often it was met.
    fn tests<'a>(&'a self, rays: &[Ray]) -> Box<dyn Fn(usize) -> usize + 'a>;
}

/// A volume with what it is stored with, in a scene.
struct Stored<V: Volume> {
    volume: V,
    shared: V::Shared,
    scene: Aabb,
}

/// Puts a volume around some triangles of a geometry.
pub fn around<V: Volume>(geometry: &Geometry, prims: &[PrimRef], cancel: &Cancel) -> Result<Box<dyn Alone>, Cancelled> {
    let triangles: Vec<Packed> = prims.iter().map(|prim| Packed { corners: geometry.corners(*prim), prim: *prim }).collect();
    let scene = *geometry.bounds();
    let (fit, _) = fit::<V>(&triangles, scene.centre(), cancel)?;
    let mut shared = V::Shared::default();
    let volume = V::store(fit, &mut shared);
    Ok(Box::new(Stored { volume, shared, scene }))
}

/// As around the nodes of a tree whose every node holds one half of its parent's triangles.
fn fit<V: Volume>(triangles: &[Packed], centre: Vec3, cancel: &Cancel) -> Result<(V::Fit, V::Up), Cancelled> {
    let below = if triangles.len() > SMALL {
        let (left, right) = triangles.split_at(triangles.len() / 2);
        Some([fit::<V>(left, centre, cancel)?.1, fit::<V>(right, centre, cancel)?.1])
    } else {
        None
    };
    let bounds = Aabb::of_points(triangles.iter().flat_map(|triangle| triangle.corners));
    V::around(&Points { triangles, bounds, centre, boxes: false, cancel }, below)
}

impl<V: Volume> Alone for Stored<V> {
    fn area(&self) -> f64 {
        match self.volume.shape(&self.shared, self.scene.centre()) {
            Shape::Box(bounds) => bounds.area(),
            Shape::Convex { area, .. } => area,
        }
    }

    fn form(&self) -> Form {
        self.volume.form(&self.shared, self.scene.centre())
    }

    fn loose(&self) -> Loose {
        V::loose(&self.shared)
    }

    fn meets(&self, ray: &Ray) -> bool {
        let interval = self.volume.interval(&self.shared, &V::ray(&Line::new(ray, &self.scene)));
        interval.is_some_and(|(entry, exit)| entry <= ray.tmax && exit >= ray.tmin)
    }

    fn tests<'a>(&'a self, rays: &[Ray]) -> Box<dyn Fn(usize) -> usize + 'a> {
        let ready: Vec<V::Ray> = rays.iter().map(|ray| V::ray(&Line::new(ray, &self.scene))).collect();
        Box::new(move |times| {
            let once =
                |_| ready.iter().filter(|ray| self.volume.interval(&self.shared, std::hint::black_box(ray)).is_some()).count();
            (0..times).map(once).sum()
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::volumes::{KINDS, Kind};
    use crate::scene::{LoadCx, open};

    fn teapot() -> Geometry {
        let cx = LoadCx::unattended();
        Geometry::new(&open("builtin:teapot?triangles=1000", &cx).expect("built in"), &cx).expect("fits")
    }

    fn made(kind: &Kind, geometry: &Geometry, prims: &[PrimRef]) -> Box<dyn Alone> {
        kind.around(geometry, prims, &Cancel::new()).expect("not cancelled")
    }

    #[test]
    fn forms_have_the_areas_of_their_volumes_and_the_formula_of_euler() {
        let geometry = teapot();
        let all: Vec<PrimRef> = (0..geometry.live_count()).map(|i| geometry.live(i)).collect();
        for count in [1, 2, 7, 40, all.len()] {
            for kind in KINDS {
                let volume = made(kind, &geometry, &all[..count]);
                let (form, area) = (volume.form(), volume.area());
                let size = Aabb::of_points(all[..count].iter().flat_map(|prim| geometry.corners(*prim))).size().max_element();
                let near = 1e-4 * f64::from(size * size);
                assert!((form.area() - area).abs() <= near, "{} of {count}: {} is not {area}", kind.id, form.area());
                if let Form::Polyhedron(p) = form {
                    assert_eq!(p.corners().len() + p.face_count() - p.edges().count(), 2, "{} of {count}", kind.id);
                }
            }
        }
    }

    #[test]
    fn tighter_kinds_are_smaller_and_all_are_met_where_a_triangle_is() {
        let geometry = teapot();
        let all: Vec<PrimRef> = (0..geometry.live_count()).map(|i| geometry.live(i)).collect();
        let area = |id: &str| made(KINDS.iter().find(|kind| kind.id == id).expect("a kind"), &geometry, &all[..200]).area();
        let order = [area("hull"), area("kdop26"), area("kdop14"), area("kdop6")];
        assert!(order.windows(2).all(|pair| pair[0] <= pair[1] * (1.0 + 1e-5)), "{order:?}");
        assert!(area("kdop26") <= area("kdop18") * (1.0 + 1e-5) && area("kdop14") <= area("kdop8") * (1.0 + 1e-5));
        let corners = geometry.corners(all[10]);
        let ray = Ray::new((corners[0] + corners[1] + corners[2]) / 3.0 + Vec3::new(0.0, 0.0, 2.0), Vec3::NEG_Z);
        let away = Ray { tmax: 0.5, ..ray };
        for kind in KINDS {
            let volume = made(kind, &geometry, &all[..200]);
            assert!(volume.meets(&ray) && !volume.meets(&away), "{}", kind.id);
            assert_eq!(volume.tests(&[ray, ray])(3), 6, "{}", kind.id);
        }
    }
}
