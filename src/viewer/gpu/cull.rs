//! Which boxes are worth drawing: those in the view and not smaller than a pixel. A software GPU
//! draws some thousand boxes fluently; a tree has millions.

use glam::Vec3;

use super::View;
use crate::geometry::{Aabb, num};

/// The boxes left to draw, and what became of the others.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Culled {
    /// Indices of the boxes to draw, ascending.
    pub visible: Vec<u32>,
    /// How many boxes there were.
    pub total: usize,
    /// How many lie outside the view, or are empty.
    pub outside: usize,
    /// How many are smaller than asked for on the screen.
    pub too_small: usize,
    /// How many fell to the limit; the largest on the screen were kept.
    pub over_limit: usize,
}

/// Sorts out the boxes that cannot be seen in `view` or would be smaller than `min_px` pixels, and
/// then, if more than `limit` are left, the smallest of those.
///
/// A box is only dropped if it is surely outside or too small: its extent on the screen is judged
/// at its nearest depth.
pub fn cull(boxes: &[Aabb], view: &View, size_px: [u32; 2], min_px: f32, limit: usize) -> Culled {
    let ruler = Ruler::new(view, size_px);
    let mut culled = Culled { total: boxes.len(), ..Culled::default() };
    let mut sized: Vec<(f32, u32)> = Vec::with_capacity(boxes.len().min(limit.saturating_mul(2)));
    for (i, cell) in boxes.iter().enumerate() {
        match ruler.pixels(cell) {
            None => culled.outside += 1,
            Some(px) if px < min_px => culled.too_small += 1,
            Some(px) => sized.push((px, num::index(i))),
        }
    }
    if sized.len() > limit {
        culled.over_limit = sized.len() - limit;
        if limit > 0 {
            sized.select_nth_unstable_by(limit - 1, |a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        }
        sized.truncate(limit);
    }
    culled.visible = sized.into_iter().map(|(_, i)| i).collect();
    culled.visible.sort_unstable();
    culled
}

/// Tests and measures boxes, with what depends only on the view worked out once.
pub struct Ruler {
    eye: Vec3,
    right: Vec3,
    up: Vec3,
    forward: Vec3,
    /// Normals of the four sides of the view, pointing out, and how far each side is from the eye.
    sides: [(Vec3, f32); 4],
    /// Pixels per unit of the scaled space, at unit depth for a perspective.
    scale: f32,
    orthographic: bool,
    near: f32,
}

impl Ruler {
    /// For a view of that many pixels.
    pub fn new(view: &View, size_px: [u32; 2]) -> Self {
        let side = |axis: Vec3, half: f32| if view.orthographic { (axis, half) } else { (axis - view.forward * half, 0.0) };
        let (right, up, half) = (view.right, view.up, view.half_size);
        Self {
            eye: view.eye,
            right: right.abs(),
            up: up.abs(),
            forward: view.forward,
            sides: [side(right, half.x), side(-right, half.x), side(up, half.y), side(-up, half.y)],
            scale: 1.0 / view.row_span(size_px[1] as f32),
            orthographic: view.orthographic,
            near: view.range[0],
        }
    }

    /// The greater extent of the box on the screen, at its nearest depth; `None` if it is outside.
    #[inline]
    pub fn pixels(&self, cell: &Aabb) -> Option<f32> {
        let centre = cell.centre() - self.eye;
        let half = cell.size() * 0.5;
        let (depth, reach) = (centre.dot(self.forward), half.dot(self.forward.abs()));
        let seen = depth + reach > 0.0
            && half.min_element() >= 0.0
            && self.sides.iter().all(|(out, at)| centre.dot(*out) - half.dot(out.abs()) <= *at);
        if !seen {
            return None;
        }
        let extent = 2.0 * half.dot(self.right).max(half.dot(self.up)) * self.scale;
        Some(if self.orthographic { extent } else { extent / (depth - reach).max(self.near) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::Space;
    use crate::scene::{Camera, Projection};

    fn view(eye: Vec3, projection: Projection) -> View {
        let space = Space::new(&Aabb { min: Vec3::ZERO, max: Vec3::ONE });
        View::new(&Camera { eye, target: Vec3::splat(0.5), up: Vec3::Y, projection }, &space, 1.0)
    }

    fn cube(centre: Vec3, size: f32) -> Aabb {
        Aabb { min: centre - size * 0.5, max: centre + size * 0.5 }
    }

    const SIZE: [u32; 2] = [100, 100];

    #[test]
    fn what_is_behind_beside_or_tiny_goes() {
        for projection in [Projection::Perspective { fov_y: 1.0 }, Projection::Orthographic { height: 1.0 }] {
            let view = view(Vec3::new(0.5, 0.5, 3.0), projection);
            let boxes = [
                cube(Vec3::splat(0.5), 0.2),
                cube(Vec3::new(0.5, 0.5, 9.0), 0.2),
                cube(Vec3::new(50.0, 0.5, 0.5), 0.2),
                cube(Vec3::splat(0.5), 1e-4),
                Aabb::EMPTY,
            ];
            let culled = cull(&boxes, &view, SIZE, 1.0, usize::MAX);
            let expected = Culled { visible: vec![0], total: 5, outside: 3, too_small: 1, over_limit: 0 };
            assert_eq!(culled, expected, "{projection:?}");
        }
    }

    #[test]
    fn the_largest_are_kept_in_their_order() {
        let view = view(Vec3::new(0.5, 0.5, 3.0), Projection::Orthographic { height: 1.0 });
        let boxes = [0.3, 0.1, 0.5, 0.2, 0.4].map(|size| cube(Vec3::splat(0.5), size));
        let culled = cull(&boxes, &view, SIZE, 1.0, 3);
        assert_eq!((culled.visible, culled.over_limit), (vec![0, 2, 4], 2));
        assert!(cull(&boxes, &view, SIZE, 1.0, 0).visible.is_empty());
    }

    #[test]
    fn a_box_around_the_eye_and_a_flat_one_are_seen() {
        let view = view(Vec3::splat(0.4), Projection::Perspective { fov_y: 1.0 });
        let boxes = [cube(Vec3::splat(0.5), 1.0), Aabb { min: Vec3::new(0.45, 0.5, 0.5), max: Vec3::new(0.55, 0.5, 0.6) }];
        assert_eq!(cull(&boxes, &view, SIZE, 1.0, 10).visible, [0, 1]);
    }

    /// No box with a corner in the picture is called outside.
    #[test]
    fn nothing_that_shows_is_dropped() {
        let view = view(Vec3::new(0.2, 1.5, 2.0), Projection::Perspective { fov_y: 0.6 });
        let mut seed = 7u32;
        let mut random = || {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 8) as f32 / 16_777_216.0
        };
        for _ in 0..5000 {
            let cell = cube(Vec3::new(random(), random(), random()) * 4.0 - 1.5, random() * 0.3);
            let shows = cell.corners().iter().any(|p| {
                let on = |v: f32, max: u32| v >= 0.0 && v <= max as f32;
                view.project(*p, SIZE).is_some_and(|(at, _)| on(at.x, SIZE[0]) && on(at.y, SIZE[1]))
            });
            assert!(!shows || cull(&[cell], &view, SIZE, 0.0, 1).outside == 0, "{cell:?}");
        }
    }
}
