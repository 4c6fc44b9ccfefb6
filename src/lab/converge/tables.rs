//! Comparisons of curves: at the same time, at the same error, and from when on a slower, better build pays.

use serde::Serialize;

use super::curve::{Curve, Point};
use crate::render::sampler::SamplerKind;

/// All of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Tables {
    /// Errors at the most seconds that all curves reach.
    pub equal_time: Vec<EqualTime>,
    /// Seconds to the least error that all curves reach.
    pub equal_error: Vec<EqualError>,
    /// For each pair where one builds faster and the other traces faster.
    pub break_even: Vec<BreakEven>,
}

/// The error of a curve at a time.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EqualTime {
    /// The structure's id.
    pub structure: String,
    /// The sampler.
    pub sampler: SamplerKind,
    /// Seconds from the end of the build.
    pub secs: f64,
    /// RMSE then, between points of the curve.
    pub rmse: f64,
}

/// The time of a curve at an error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct EqualError {
    /// The structure's id.
    pub structure: String,
    /// The sampler.
    pub sampler: SamplerKind,
    /// RMSE.
    pub rmse: f64,
    /// Seconds to get there from the end of the build.
    pub secs: f64,
    /// The same with the build.
    pub secs_with_build: f64,
}

/// When a build pays.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BreakEven {
    /// The id of the structure that is built faster.
    pub quick: String,
    /// That of the one that traces faster.
    pub better: String,
    /// Rays, of all kinds, after which the second is ahead, build and all.
    pub rays: f64,
    /// The same in samples of every pixel.
    pub spp: f64,
    /// The same in seconds from the start of the builds.
    pub secs: f64,
}

impl Tables {
    /// From all curves.
    pub fn of(curves: &[Curve]) -> Self {
        let last = |c: &Curve| c.points.last().map(|p| (p.secs, p.errors.rmse));
        let ends: Vec<(f64, f64)> = curves.iter().filter_map(last).collect();
        let secs = ends.iter().map(|end| end.0).fold(f64::INFINITY, f64::min);
        let rmse = ends.iter().map(|end| end.1).fold(0.0, f64::max);
        let names = |c: &Curve| (c.structure.clone(), c.sampler);
        let at_time = |c: &Curve| {
            let ((structure, sampler), at) = (names(c), |p: &Point| (p.secs, p.errors.rmse));
            Some(EqualTime { structure, sampler, secs, rmse: between(&c.points, at, secs)? })
        };
        let at_error = |c: &Curve| {
            let ((structure, sampler), at) = (names(c), |p: &Point| (p.errors.rmse, p.secs));
            let secs = between(&c.points, at, rmse)?;
            Some(EqualError { structure, sampler, rmse, secs, secs_with_build: secs + c.build_secs })
        };
        let (equal_time, equal_error) =
            (curves.iter().filter_map(at_time).collect(), curves.iter().filter_map(at_error).collect());
        Self { equal_time, equal_error, break_even: break_evens(curves) }
    }
}

/// The second of a point's coordinates where the first is `x`, straight between the points in logarithms; `None` where no
/// point is on one of the sides. Where a curve goes back and forth the first crossing counts.
fn between(points: &[Point], of: impl Fn(&Point) -> (f64, f64), x: f64) -> Option<f64> {
    let of: Vec<(f64, f64)> = points.iter().map(of).collect();
    if let Some(hit) = of.iter().find(|p| p.0 == x) {
        return Some(hit.1);
    }
    let pair = of.windows(2).find(|w| (w[0].0 < x) != (w[1].0 < x))?;
    let ([a, b], t) = ([pair[0], pair[1]], |a: f64, b: f64| (x.ln() - a.ln()) / (b.ln() - a.ln()));
    Some((a.1.ln() + (b.1.ln() - a.1.ln()) * t(a.0, b.0)).exp())
}

/// Of curves of the first sampler, all pairs where the one that traces faster is built more slowly.
fn break_evens(curves: &[Curve]) -> Vec<BreakEven> {
    let first = curves.first().map(|c| c.sampler);
    let of_first: Vec<&Curve> = curves.iter().filter(|c| Some(c.sampler) == first).collect();
    let mut found = Vec::new();
    for quick in &of_first {
        for better in &of_first {
            let [slow, fast] = [quick, better].map(|c| 1.0 / c.rays_per_sec);
            if better.build_secs > quick.build_secs && fast < slow {
                let rays = (better.build_secs - quick.build_secs) / (slow - fast);
                let secs = quick.build_secs + rays * slow;
                let (quick, better) = (quick.structure.clone(), better.structure.clone());
                found.push(BreakEven { quick, better, rays, spp: rays / of_first[0].rays_per_sample, secs });
            }
        }
    }
    found.sort_by(|a, b| a.rays.total_cmp(&b.rays));
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::ImageErrors;

    fn curve(structure: &str, build_secs: f64, secs_per_sample: f64) -> Curve {
        let point = |spp: u32| {
            let rmse = 1.0 / f64::from(spp).sqrt();
            let errors = ImageErrors { rmse, relmse: rmse, mae: rmse, smape: rmse, flip: None };
            let secs = f64::from(spp) * secs_per_sample;
            let (secs_min, secs_max) = (secs, secs);
            Point { spp, secs, secs_min, secs_max, errors, hollow: false, efficiency: 1.0 / secs_per_sample, share: 1.0 }
        };
        Curve {
            structure: structure.to_owned(),
            sampler: SamplerKind::Independent,
            build_secs,
            slope: None,
            efficiency: None,
            rays_per_sample: 1000.0,
            rays_per_sec: 1000.0 / secs_per_sample,
            shares: [1.0, 0.0, 0.0],
            points: [1, 2, 4, 8, 16].map(point).into(),
        }
    }

    #[test]
    fn times_and_errors_are_read_off_between_points() {
        // The second takes twice as long, and is half as far when the first is done.
        let curves = [curve("bvh", 1.0, 0.1), curve("grid", 0.5, 0.2)];
        let tables = Tables::of(&curves);
        assert!((tables.equal_time[0].rmse - 0.25).abs() < 1e-12 && (tables.equal_time[1].rmse - 8f64.powf(-0.5)).abs() < 1e-12);
        assert!((tables.equal_error[0].secs - 1.6).abs() < 1e-12 && (tables.equal_error[1].secs_with_build - 3.7).abs() < 1e-12);
        let [pays] = &tables.break_even[..] else { panic!("{:?}", tables.break_even) };
        // Half a second more, made good by a ten thousandth of a second a ray.
        assert_eq!((pays.quick.as_str(), pays.better.as_str()), ("grid", "bvh"));
        assert!((pays.rays - 5000.0).abs() < 1e-6 && (pays.spp - 5.0).abs() < 1e-9 && (pays.secs - 1.5).abs() < 1e-9);
        // 1.0 is between 0.8 and 1.6, half way in logarithms at their geometric mean.
        let middle = between(&curves[0].points, |p| (p.secs, p.errors.rmse), (0.8f64 * 1.6).sqrt()).expect("between");
        assert!((middle - (8f64.powf(-0.5) * 0.25).sqrt()).abs() < 1e-12);
        assert_eq!(between(&curves[0].points, |p| (p.secs, p.errors.rmse), 99.0), None);
    }
}
