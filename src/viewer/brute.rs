//! What the window knows of comparing a part of the picture with brute force.

use std::sync::Arc;
use std::time::Instant;

use super::kept::{Built, Key};
use super::workers::{Shared, build_now};
use crate::accel::{BuildCx, BuildError, Visibility};
use crate::geometry::HalfSpace;
use crate::job::Job;
use crate::lab::{BruteCheck, PixelRect, UnlikePixel, check_by_brute_force};
use crate::render;
use crate::scene::Camera;
use crate::task::Progress;
use glam::Vec2;

/// The most seconds that it takes: its user waits.
pub const SECS: f64 = 20.0;

/// The comparison on its way, with brute force, which may have to be built for it; or why there is none: nothing to say where
/// it was stopped.
pub type Comparing = Job<Result<(BruteCheck, Built), String>>;

/// Starts comparing a rectangle of a view; brute force is there, or is built first.
pub fn compare(
    shared: &Shared,
    there: Result<Built, Key>,
    view: render::Job,
    size_px: [u32; 2],
    rect: PixelRect,
) -> std::io::Result<Comparing> {
    let Shared { pool, budget, .. } = shared.clone();
    Job::spawn("brute force", shared.waker(), move |cancel, progress| {
        let built = match there {
            Ok(built) => built,
            Err(key) => {
                // Its phases are not told.
                let cx = BuildCx::new(cancel.clone(), Progress::new(), pool.clone(), budget);
                match build_now(key, view.accel.geometry(), &cx) {
                    Ok(built) => built,
                    Err(BuildError::Cancelled(_)) => return Err(String::new()),
                    Err(why) => return Err(why.to_string()),
                }
            }
        };
        let found = check_by_brute_force(&view, &built.accel, (size_px, rect, SECS), &pool, cancel, progress);
        found.map(|found| (found, built)).map_err(|_| String::new())
    })
}

/// What is compared: a result says nothing of any other view.
#[derive(Clone, Debug, PartialEq)]
pub struct Of {
    /// The structure.
    pub key: Key,
    /// From where it is seen.
    pub camera: Camera,
    /// What of the world is left.
    pub section: Option<HalfSpace>,
    /// Which triangles are seen.
    pub visible: Option<Arc<Visibility>>,
    /// Columns and rows of the view.
    pub size_px: [u32; 2],
}

/// Everything of it.
#[derive(Default)]
pub struct Brute {
    /// The next drag in the view marks a rectangle.
    pub marking: bool,
    /// What is compared, or was.
    pub of: Option<(Of, PixelRect)>,
    /// The comparison and when it began, while it runs.
    pub running: Option<(Comparing, Instant)>,
    /// What it has found.
    pub found: Option<BruteCheck>,
    /// Which of the pixels that differ is followed next.
    pub next: usize,
}

impl Brute {
    /// Forgets what was found, and stops.
    pub fn clear(&mut self) {
        *self = Self { marking: self.marking, ..Self::default() };
    }

    /// The pixels that differ, with the size of the view.
    pub fn unlike(&self) -> (&[UnlikePixel], [u32; 2]) {
        match (&self.found, &self.of) {
            (Some(found), Some((of, _))) => (&found.examples, of.size_px),
            _ => (&[], [1; 2]),
        }
    }

    /// The nearest of them within some pixels of a place, which is (-1, -1) at the lower left corner of the view and (1, 1) at
    /// the upper right.
    pub fn near(&self, at: Vec2, within: f32) -> Option<usize> {
        let (pixels, [width, height]) = self.unlike();
        let at = Vec2::new(0.5 + 0.5 * at.x, 0.5 - 0.5 * at.y) * Vec2::new(width as f32, height as f32);
        let away = |e: &UnlikePixel| at.distance(Vec2::new(e.pixel[0] as f32, e.pixel[1] as f32) + 0.5);
        let near = pixels.iter().enumerate().map(|(i, e)| (away(e), i)).filter(|(away, _)| *away <= within);
        near.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, i)| i)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;
    use crate::geometry::Ray;
    use crate::geometry::tri::TestKind;
    use glam::Vec3;

    #[test]
    fn a_click_takes_the_nearest_pixel_that_differs() {
        let ray = Ray::new(Vec3::ZERO, Vec3::Z);
        let pixel = |x, y| UnlikePixel { pixel: [x, y], ray, brute: None, found: None, rounded: false };
        let entry = &registry::ALL[0];
        let key = Key { entry, params: entry.defaults(), test: TestKind::default() };
        let camera = Camera::framing(&crate::geometry::Aabb::EMPTY, Vec3::Z, Vec3::Y, 1.0);
        let of = Of { key, camera, section: None, visible: None, size_px: [200, 100] };
        let found = BruteCheck { examples: vec![pixel(99, 49), pixel(104, 49)], ..BruteCheck::default() };
        let brute = Brute { of: Some((of, PixelRect::whole([200, 100]))), found: Some(found), ..Brute::default() };
        assert_eq!(brute.near(Vec2::ZERO, 8.0), Some(0));
        assert_eq!(brute.near(Vec2::new(0.04, 0.0), 8.0), Some(1));
        assert_eq!(brute.near(Vec2::new(0.5, 0.5), 8.0), None);
        assert_eq!(Brute::default().near(Vec2::ZERO, 8.0), None);
    }
}
