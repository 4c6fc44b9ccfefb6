//! One structure with one sampler: its errors, how fast they fall, and what that costs.

use serde::Serialize;

use super::reference::Reference;
use super::run::Lane;
use crate::lab::ImageErrors;
use crate::lab::least_squares::line;
use crate::lab::statistics::median;
use crate::render::sampler::SamplerKind;

/// A curve.
#[derive(Clone, Debug, Serialize)]
pub struct Curve {
    /// The structure's id.
    pub structure: String,
    /// The sampler.
    pub sampler: SamplerKind,
    /// Seconds that the structure took to build; the curve begins after them.
    pub build_secs: f64,
    /// How RMSE falls with samples; `None` where too few points can be used.
    pub slope: Option<Slope>,
    /// The median over points that can be used of 1 / (MSE x seconds).
    pub efficiency: Option<f64>,
    /// Rays traced for a sample of every pixel, on average.
    pub rays_per_sample: f64,
    /// Rays a second, of all kinds, over the whole run.
    pub rays_per_sec: f64,
    /// The shares of thread time that tracing, shading, and the rest took.
    pub shares: [f64; 3],
    /// The fewest samples first.
    pub points: Vec<Point>,
}

/// A picture's errors and time.
#[derive(Clone, Debug, Serialize)]
pub struct Point {
    /// Samples in each pixel.
    pub spp: u32,
    /// Seconds from the end of the build, the median over runs.
    pub secs: f64,
    /// The least of them.
    pub secs_min: f64,
    /// The most.
    pub secs_max: f64,
    /// Against the reference.
    #[serde(flatten)]
    pub errors: ImageErrors,
    /// The reference is not sure enough to measure this: RMSE is below 4 times its noise.
    pub hollow: bool,
    /// 1 / (MSE x seconds).
    pub efficiency: f64,
    /// The share of pixels that got the last sample: less than those that see the scene where pixels rest.
    pub share: f64,
}

/// RMSE falls as samples to the power of this.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Slope {
    /// The power: -1/2 for independent samples.
    pub value: f64,
    /// The lower end of its 95 % interval.
    pub low: f64,
    /// The upper end.
    pub high: f64,
    /// Points that it goes through.
    pub points: usize,
}

/// Samples from which on RMSE falls as it should.
const FIRST: u32 = 4;
/// The reference has so many times the samples of what is measured.
pub const REFERENCE_FACTOR: u32 = 16;

impl Curve {
    /// Measures a lane's pictures.
    pub fn of(lane: &Lane, reference: &Reference) -> Self {
        let point = |shot: &super::run::Shot| {
            let (pixels, size) = (&shot.pixels, reference.facts.size);
            let errors = ImageErrors::of(pixels, &reference.pixels).with_flip(pixels, &reference.pixels, size);
            let secs = median(&shot.secs);
            Point {
                spp: shot.spp,
                secs,
                secs_min: shot.secs.iter().copied().fold(f64::INFINITY, f64::min),
                secs_max: shot.secs.iter().copied().fold(0.0, f64::max),
                hollow: reference.is_hollow(errors.rmse),
                efficiency: 1.0 / (errors.rmse * errors.rmse * secs),
                errors,
                share: shot.share,
            }
        };
        let points: Vec<Point> = lane.shots.iter().map(point).collect();
        let usable = |p: &&Point| !p.hollow && p.spp >= FIRST && p.spp <= reference.facts.spp / REFERENCE_FACTOR;
        let fitted: Vec<&Point> = points.iter().filter(usable).collect();
        let efficiencies: Vec<f64> = fitted.iter().map(|p| p.efficiency).collect();
        let (last, work) = (lane.shots.last(), lane.work);
        let (spp, secs) = last.map_or((1, f64::NAN), |shot| (shot.spp, shot.secs[0]));
        let parts = [work.tracing, work.shading, work.rest].map(|part| part.as_secs_f64());
        let all = parts.iter().sum::<f64>().max(f64::MIN_POSITIVE);
        Self {
            structure: lane.structure.clone(),
            sampler: lane.sampler,
            build_secs: lane.build_secs,
            slope: Slope::of(fitted.iter().map(|p| (f64::from(p.spp), p.errors.rmse))),
            efficiency: (!efficiencies.is_empty()).then(|| median(&efficiencies)),
            rays_per_sample: work.rays as f64 / f64::from(spp),
            rays_per_sec: work.rays as f64 / secs,
            shares: parts.map(|part| part / all),
            points,
        }
    }
}

impl Slope {
    /// Least squares through the logarithms; `None` for fewer than three points.
    pub fn of(points: impl Iterator<Item = (f64, f64)>) -> Option<Self> {
        let points: Vec<(f64, f64)> = points.map(|(x, y)| (x.ln(), y.ln())).collect();
        let line = line(&points).filter(|line| line.slope_error.is_finite())?;
        let half = student_t(points.len() - 2) * line.slope_error;
        Some(Self { value: line.slope, low: line.slope - half, high: line.slope + half, points: points.len() })
    }
}

/// The 97.5 % quantile of Student's distribution, of so many degrees of freedom.
fn student_t(freedom: usize) -> f64 {
    const TABLE: [f64; 20] = [
        12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228, 2.201, 2.179, 2.160, 2.145, 2.131, 2.120, 2.110,
        2.101, 2.093, 2.086,
    ];
    // Beyond the table by the expansion around the normal distribution (Abramowitz and Stegun, 26.7.5).
    let z: f64 = 1.959_964;
    let n = freedom as f64;
    let far = || z + (z.powi(3) + z) / (4.0 * n) + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * n * n);
    TABLE.get(freedom.max(1) - 1).copied().unwrap_or_else(far)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_power_is_found_with_its_interval() {
        let exact = Slope::of([4.0f64, 8.0, 16.0, 32.0].into_iter().map(|n| (n, 3.0 * n.powf(-0.5)))).expect("enough");
        assert!((exact.value + 0.5).abs() < 1e-12 && exact.high - exact.low < 1e-9 && exact.points == 4);
        // Of (0, 0), (1, 1), (2, 1): slope 1/2, error sqrt(1/6 / 2), one degree of freedom.
        let e = std::f64::consts::E;
        let rough = Slope::of([(1.0, 1.0), (e, e), (e * e, e)].into_iter()).expect("enough");
        assert!((rough.value - 0.5).abs() < 1e-12);
        assert!((rough.high - 0.5 - 12.706 * (1.0f64 / 12.0).sqrt()).abs() < 1e-9, "{rough:?}");
        assert_eq!(Slope::of([(1.0, 1.0), (2.0, 0.5)].into_iter()), None);
        assert!((student_t(21) - 2.080).abs() < 2e-3 && (student_t(1000) - 1.962).abs() < 1e-3);
    }
}
