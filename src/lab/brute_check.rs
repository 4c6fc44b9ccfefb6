//! A part of a picture traced by brute force as well: whether a structure is to blame for what is seen there.

use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;

use super::rounding_explains;
use crate::accel::{Accel, Hit, Mode};
use crate::geometry::{Ray, num};
use crate::render::Job;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// A rectangle of pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PixelRect {
    /// Its upper left pixel: column and row.
    pub at: [u32; 2],
    /// Columns and rows.
    pub size: [u32; 2],
}

impl PixelRect {
    /// All of a picture of that size.
    pub const fn whole(size: [u32; 2]) -> Self {
        Self { at: [0; 2], size }
    }

    /// How many pixels it has.
    pub fn pixels(&self) -> u64 {
        self.size.into_iter().map(u64::from).product()
    }

    /// The pixel of that number, row by row.
    fn pixel(&self, number: u64) -> (u32, u32) {
        let columns = u64::from(self.size[0]).max(1);
        let within = |n: u64| u32::try_from(n).unwrap_or(u32::MAX);
        (self.at[0].saturating_add(within(number % columns)), self.at[1].saturating_add(within(number / columns)))
    }
}

/// A pixel whose ray a structure answers otherwise than brute force does.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnlikePixel {
    /// Column and row.
    pub pixel: [u32; 2],
    /// The ray through its middle.
    pub ray: Ray,
    /// What brute force finds.
    pub brute: Option<Hit>,
    /// What the structure finds.
    pub found: Option<Hit>,
    /// Whether rounding explains it ([`rounding_explains`]).
    pub rounded: bool,
}

/// What comparing a rectangle with brute force has found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BruteCheck {
    /// Pixels that were compared, spread over the rectangle where time did not suffice for all.
    pub pixels: u64,
    /// Pixels of the rectangle.
    pub all: u64,
    /// Those that differ in anything: triangle, t, u or v.
    pub unlike: u64,
    /// Those of them that rounding explains.
    pub rounded: u64,
    /// Those where one of both finds nothing.
    pub one_sided: u64,
    /// The greatest difference of t where both find something, in units of the rays' directions.
    pub largest: f32,
    /// Some of those that differ, at most `MOST`, row by row.
    pub examples: Vec<UnlikePixel>,
    /// Seconds that it took.
    pub secs: f64,
}

/// The most pixels that are kept of those that differ.
pub const MOST: usize = 1000;
/// Neighbouring pixels whose rays are one batch, as those of a picture are: some structures trace many rays at once otherwise
/// than one.
const RUN: u64 = 64;

/// Traces the rays through the middles of pixels through a view's structure, those of neighbouring ones at once, and one by one
/// through `brute`, and compares the hits to the bit. No ray begins after `secs` seconds.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
pub fn check_by_brute_force(
    view: &Job,
    brute: &Arc<dyn Accel>,
    (size, rect, secs): ([u32; 2], PixelRect, f64),
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<BruteCheck, Cancelled> {
    let (start, all) = (Instant::now(), rect.pixels());
    let reference = Job { accel: Arc::clone(brute), ..view.clone() };
    let runs = all.div_ceil(RUN);
    let stride = stride(runs);
    progress.start("pixels", all);
    let run = |number: u64| {
        let mut found = BruteCheck::default();
        if start.elapsed().as_secs_f64() >= secs {
            return Ok(found);
        }
        // In 128 bits, so that any picture will do.
        let scattered = u64::try_from(u128::from(number) * u128::from(stride) % u128::from(runs)).unwrap_or(0);
        let pixels: Vec<(u32, u32)> = (scattered * RUN..all.min((scattered + 1) * RUN)).map(|n| rect.pixel(n)).collect();
        let rays: Vec<Ray> = pixels.iter().map(|pixel| view.middle_ray(*pixel, size)).collect();
        let mut own = vec![None; rays.len()];
        view.trace(&rays, Mode::Closest, &mut own, cancel)?;
        for ((pixel, ray), own) in pixels.iter().zip(&rays).zip(own) {
            if start.elapsed().as_secs_f64() >= secs {
                break;
            }
            let brute = hit(&reference, ray, cancel)?;
            found.add([pixel.0, pixel.1], *ray, [brute, own], view.accel.as_ref());
            progress.advance(1);
        }
        Ok(found)
    };
    let all_runs = (0..runs).into_par_iter();
    let mut found = pool.run(|| all_runs.map(run).try_reduce(BruteCheck::default, |a, b| Ok(a.with(b))))?;
    (found.all, found.secs) = (all, start.elapsed().as_secs_f64());
    Ok(found)
}

fn hit(job: &Job, ray: &Ray, cancel: &Cancel) -> Result<Option<Hit>, Cancelled> {
    let mut hits = [None];
    job.trace(&[*ray], Mode::Closest, &mut hits, cancel)?;
    Ok(hits[0])
}

/// Steps of so many, from the last to the first of `n`, visit all of them once, and the first few are spread over all: near
/// the golden section, and with no divisor in common.
fn stride(n: u64) -> u64 {
    let golden = num::floor_index(n as f64 * 0.618_033_988_749_895, usize::MAX) as u64;
    (golden.max(1)..).find(|step| gcd(*step, n) == 1).unwrap_or(1)
}

const fn gcd(a: u64, b: u64) -> u64 {
    let (mut a, mut b) = (a, b);
    while b != 0 {
        (a, b) = (b, a % b);
    }
    a
}

impl BruteCheck {
    fn add(&mut self, pixel: [u32; 2], ray: Ray, [brute, found]: [Option<Hit>; 2], accel: &dyn Accel) {
        self.pixels += 1;
        if brute == found {
            return;
        }
        let rounded = rounding_explains(&ray, [brute, found], accel.geometry());
        self.unlike += 1;
        self.rounded += u64::from(rounded);
        match (brute, found) {
            (Some(a), Some(b)) => self.largest = self.largest.max((a.t - b.t).abs()),
            _ => self.one_sided += 1,
        }
        self.keep([UnlikePixel { pixel, ray, brute, found, rounded }]);
    }

    fn with(mut self, other: Self) -> Self {
        self.pixels += other.pixels;
        self.unlike += other.unlike;
        self.rounded += other.rounded;
        self.one_sided += other.one_sided;
        self.largest = self.largest.max(other.largest);
        self.keep(other.examples);
        self
    }

    /// Keeps examples, of those that rounding does not explain first.
    fn keep(&mut self, more: impl IntoIterator<Item = UnlikePixel>) {
        self.examples.extend(more);
        let (row_by_row, first) = (|e: &UnlikePixel| [e.pixel[1], e.pixel[0]], |e: &UnlikePixel| e.rounded);
        if self.examples.len() > MOST {
            self.examples.sort_by_key(|e| (first(e), row_by_row(e)));
            self.examples.truncate(MOST);
        }
        self.examples.sort_by_key(row_by_row);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::render;
    use crate::scene::{Geometry, LoadCx, open};

    fn view(model: &str, id: &str) -> (Job, Arc<dyn Accel>) {
        let load = LoadCx::unattended();
        let scene = Arc::new(open(model, &load).expect("built in"));
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let [accel, brute] = [id, "brute"].map(|id| -> Arc<dyn Accel> {
            let entry = registry::find(id).expect("registered");
            let cx = BuildCx::unattended(1);
            entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("fits").into()
        });
        let camera = scene.first_camera(geometry.world_bounds(), 1.5);
        (Job::new(scene, accel, camera, render::Mode::Shaded, Arc::default()), brute)
    }

    fn check(view: &Job, brute: &Arc<dyn Accel>, rect: PixelRect, secs: f64) -> BruteCheck {
        let (pool, cancel, progress) = (Pool::new("test", 2), Cancel::new(), Progress::new());
        check_by_brute_force(view, brute, ([60, 40], rect, secs), &pool, &cancel, &progress).expect("not cancelled")
    }

    #[test]
    fn boxes_answer_as_brute_force_does() {
        let rect = PixelRect { at: [10, 5], size: [31, 17] };
        for id in ["bvh", "wide"] {
            let (view, brute) = view("builtin:teapot?triangles=1000", id);
            let found = check(&view, &brute, rect, f64::INFINITY);
            assert_eq!((found.pixels, found.all, found.unlike), (31 * 17, 31 * 17, 0), "{id}");
            assert!(found.examples.is_empty() && found.largest == 0.0, "{id}");
        }
        let (view, brute) = view("builtin:teapot?triangles=1000", "bvh");
        let nothing = check(&view, &brute, PixelRect { at: [10, 5], size: [0, 17] }, f64::INFINITY);
        assert_eq!((nothing.pixels, nothing.all), (0, 0));
        let at_once = check(&view, &brute, rect, 0.0);
        assert_eq!((at_once.pixels, at_once.all), (0, 31 * 17));
    }

    #[test]
    fn what_differs_is_found_pixel_by_pixel() {
        let (mut view, brute) = view("builtin:teapot?triangles=1000", "bvh");
        // A structure of another scene: everything is wrong where the teapot is.
        let (other, _) = self::view("builtin:teapot?triangles=3000", "bvh");
        view.accel = other.accel;
        let found = check(&view, &brute, PixelRect::whole([60, 40]), f64::INFINITY);
        assert!(found.unlike > 100 && found.unlike < found.pixels && found.pixels == 2400, "{}", found.unlike);
        assert_eq!(found.examples.len(), MOST.min(found.unlike as usize));
        assert!(found.examples.is_sorted_by_key(|e| [e.pixel[1], e.pixel[0]]) && found.largest > 0.0);
        assert!(
            found.examples.iter().all(|e| e.brute != e.found && e.ray == view.middle_ray((e.pixel[0], e.pixel[1]), [60, 40]))
        );
    }

    #[test]
    fn steps_visit_every_run_once() {
        for runs in [1, 2, 3, 12, 2400, 4099] {
            let step = stride(runs);
            let mut seen: Vec<u64> = (0..runs).map(|n| n * step % runs).collect();
            seen.sort_unstable();
            assert!(seen.into_iter().eq(0..runs), "{runs}");
        }
    }

    #[test]
    fn it_stops_when_asked() {
        let (view, brute) = view("builtin:teapot?triangles=1000", "bvh");
        let cancel = Cancel::new();
        cancel.cancel();
        let rect = PixelRect::whole([60, 40]);
        let stopped =
            check_by_brute_force(&view, &brute, ([60, 40], rect, 1.0), &Pool::new("test", 1), &cancel, &Progress::new());
        assert_eq!(stopped, Err(Cancelled));
    }
}
