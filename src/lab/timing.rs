//! The outcome of one structure with one set of rays.

use super::statistics::{half_iqr, median};
use serde::Serialize;

/// How long a structure took for a set of rays, and what its traversal did. Serialises as the row
/// that the command line prints, under the names there.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Timing {
    /// The contestant.
    #[serde(skip)]
    pub id: String,
    /// Rays traced in each round.
    #[serde(rename = "count")]
    pub rays: usize,
    /// Rays of the whole set; more than [`Self::rays`] where the row is capped.
    pub of: usize,
    /// Rays of a round that hit something.
    pub hits: u64,
    /// Rounds that were timed.
    pub rounds: usize,
    /// The median over rounds of the seconds of one; NaN (`null` in JSON) if there are no rays.
    #[serde(rename = "secs")]
    pub secs_median: f64,
    /// Half the interquartile range of those seconds.
    #[serde(rename = "secs_spread")]
    pub secs_half_iqr: f64,
    /// Rays of a round over its median seconds, in millions.
    pub mrays_per_sec: f64,
    /// Nodes and cells entered by a ray in the mean, counted in an untimed pass.
    pub nodes_per_ray: f64,
    /// Leaves entered by a ray in the mean.
    pub leaves_per_ray: f64,
    /// Primitives tested by a ray in the mean.
    pub prims_per_ray: f64,
    /// Leaf count variability: the standard deviation of the number of leaves that a ray enters (Aila,
    /// Karras and Laine 2013, §4). What it adds to the mean, rays traced together wait for.
    pub lcv: f64,
    /// Rays that were counted, spread evenly over the set.
    pub counted: usize,
    /// Why not all rays were traced, in words for the user.
    pub capped: Option<String>,
}

impl Timing {
    /// The spread of [`Self::mrays_per_sec`] that goes with that of the seconds.
    pub fn mrays_spread(&self) -> f64 {
        self.mrays_per_sec * self.secs_half_iqr / self.secs_median.max(f64::MIN_POSITIVE)
    }

    /// Sums up the rounds.
    pub(super) fn of_rounds(id: &str, rays: usize, of: usize, hits: u64, secs: &[f64]) -> Self {
        let secs_median = median(secs);
        Self {
            id: id.to_owned(),
            rays,
            of,
            hits,
            rounds: secs.len(),
            secs_median,
            secs_half_iqr: half_iqr(secs),
            mrays_per_sec: rays as f64 / secs_median * 1e-6,
            ..Self::default()
        }
    }

    /// Seconds for one ray: median and half the interquartile range.
    fn per_ray(&self) -> (f64, f64) {
        let rays = self.rays as f64;
        (self.secs_median / rays, self.secs_half_iqr / rays)
    }
}

/// Whether the difference of two timings of the same set lies inside their spreads, so that neither
/// can be called faster. Rows without rays tie with nothing.
pub fn is_tie(a: &Timing, b: &Timing) -> bool {
    let ((a, spread_a), (b, spread_b)) = (a.per_ray(), b.per_ray());
    (a - b).abs() <= spread_a + spread_b
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn differences_inside_the_spreads_are_ties() {
        let timing = |rays, secs: &[f64]| Timing::of_rounds("x", rays, 100, 50, secs);
        let a = timing(100, &[1.0, 1.1, 1.2]);
        assert!(is_tie(&a, &timing(100, &[1.1, 1.2, 1.3])));
        assert!(is_tie(&a, &timing(50, &[0.5, 0.55, 0.6])), "half the rays in half the time");
        assert!(!is_tie(&a, &timing(100, &[2.0, 2.1, 2.2])));
        assert!(!is_tie(&timing(0, &[]), &timing(0, &[])));
    }

    #[test]
    fn a_row_serialises_under_the_names_of_the_schema() {
        let row = serde_json::to_value(Timing::of_rounds("bvh", 2_000_000, 2_000_000, 7, &[0.5])).expect("serialises");
        assert_eq!((row["count"].as_u64(), row["hits"].as_u64()), (Some(2_000_000), Some(7)));
        assert_eq!((row["secs"].as_f64(), row["mrays_per_sec"].as_f64()), (Some(0.5), Some(4.0)));
        assert!(row.get("id").is_none() && row["capped"].is_null());
    }
}
