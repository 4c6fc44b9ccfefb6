//! What is predicted of a ray beside what rays took, and by how much that is off.
//!
//! The predictor is one for all kinds of rays: the nodes and tests that the areas of the cells promise a random line that
//! nothing cuts short, times the costs that [`fit_costs`](super::fit_costs) finds. So random lines are what it is for; of rays
//! that end early it tells too much.
//!
//! What is measured is the wall time that all threads take together, times their number, over the rays: nanoseconds of a thread
//! while all are at work. Costs are fitted to one thread while the others idle. Where threads share cores, caches or the clock,
//! or the machine has other work, a ray takes longer beside others than alone, and all marks may lie above the line for that.

#[cfg(feature = "plots")]
pub mod plot;

use super::rays::RayKind;
use super::tradeoffs::TradeoffRow;

/// The kinds of rays that are measured, and that costs are fitted to.
pub const KINDS: [RayKind; 4] = [RayKind::Lines, RayKind::Primary, RayKind::Shadow, RayKind::Diffuse];

/// What is along the axes where one is plotted against the other.
pub const AXES: [&str; 2] = ["predicted ns a ray", "measured ns a ray"];
/// The line on which both are equal.
pub const EQUAL: &str = "predicted = measured";

/// One structure and kind of ray.
#[derive(Clone, Copy, Debug)]
pub struct Point<'a> {
    /// The structure.
    pub row: &'a TradeoffRow,
    /// The kind of ray.
    pub kind: RayKind,
    /// Predicted nanoseconds of a ray: more than nothing.
    pub predicted: f64,
    /// Measured ones of a thread while all are at work: more than nothing.
    pub measured: f64,
}

impl Point<'_> {
    /// By how much the prediction is above what was measured, as a share of that.
    pub fn off(&self) -> f64 {
        self.predicted / self.measured - 1.0
    }
}

/// All of which both figures are known.
pub fn points(rows: &[TradeoffRow]) -> Vec<Point<'_>> {
    let point = |row, kind| of(row, kind).ok();
    rows.iter().flat_map(|row| KINDS.into_iter().filter_map(move |kind| point(row, kind))).collect()
}

/// Why there is no point of the others, in words for the user: once for a structure that has none.
pub fn missing(rows: &[TradeoffRow]) -> Vec<String> {
    let mut missing = Vec::new();
    for row in rows {
        let whys: Vec<(RayKind, String)> = KINDS.into_iter().filter_map(|kind| Some((kind, of(row, kind).err()?))).collect();
        if whys.len() == KINDS.len() {
            missing.extend(whys.first().map(|(_, why)| format!("{}: {why}", row.name)));
        } else {
            missing.extend(whys.iter().map(|(kind, why)| format!("{}, {}: {why}", row.name, kind.id())));
        }
    }
    missing
}

/// A point, or why there is none.
fn of(row: &TradeoffRow, kind: RayKind) -> Result<Point<'_>, String> {
    // What went wrong elsewhere in the row is no reason where both figures are there.
    let unknown = |why: &str| row.error.clone().unwrap_or_else(|| why.to_owned());
    let Some(predicted) = row.predicted_ns else {
        return Err(unknown("no costs could be fitted, as it is too slow or its rays are too much alike."));
    };
    let Some(measured) = row.ns.get(&kind).copied() else { return Err(unknown("it was not measured.")) };
    let placed = |ns: f64| ns.is_finite() && ns > 0.0;
    if placed(predicted) && placed(measured) {
        Ok(Point { row, kind, predicted, measured })
    } else {
        Err(format!("{predicted} ns predicted and {measured} ns measured have no place on logarithmic axes."))
    }
}

/// The range of both axes, in nanoseconds, with some room around all points.
pub fn range(points: &[Point<'_>]) -> Option<[f64; 2]> {
    let all = || points.iter().flat_map(|point| [point.predicted, point.measured]);
    let (low, high) = (all().reduce(f64::min)?, all().reduce(f64::max)?);
    Some([low * 0.7, high * 1.4])
}

/// How well predictions agree with what was measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Agreement {
    /// Points that it is over.
    pub points: usize,
    /// The factor between predicted and measured, whichever is more, in the geometric mean: 1 where all are right.
    pub factor: f64,
    /// The correlation (Pearson) of the logarithms; no number where one of them is the same everywhere.
    pub correlation: f64,
}

impl Agreement {
    /// Over points, if there are any.
    pub fn of<'a>(points: impl IntoIterator<Item = &'a Point<'a>>) -> Option<Self> {
        let logs: Vec<(f64, f64)> = points.into_iter().map(|point| (point.predicted.ln(), point.measured.ln())).collect();
        let mean = |of: &dyn Fn(&(f64, f64)) -> f64| logs.iter().map(of).sum::<f64>() / logs.len() as f64;
        let (x, y) = (mean(&|p| p.0), mean(&|p| p.1));
        let [xx, yy, xy] = [mean(&|p| (p.0 - x).powi(2)), mean(&|p| (p.1 - y).powi(2)), mean(&|p| (p.0 - x) * (p.1 - y))];
        let factor = mean(&|p| (p.0 - p.1).abs()).exp();
        (!logs.is_empty()).then(|| Self { points: logs.len(), factor, correlation: xy / (xx * yy).sqrt() })
    }
}

/// What the predictions of these points took in the mean, in seconds a structure: the walk over its cells and the fit.
pub fn cost(rows: &[TradeoffRow]) -> Option<f64> {
    let secs: Vec<f64> = rows.iter().filter_map(|row| row.prediction_secs).collect();
    (!secs.is_empty()).then(|| secs.iter().sum::<f64>() / secs.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    fn row(name: &str, predicted_ns: Option<f64>, ns: &[(RayKind, f64)]) -> TradeoffRow {
        let ns: BTreeMap<RayKind, f64> = ns.iter().copied().collect();
        TradeoffRow { name: name.to_owned(), structure: "bvh".to_owned(), predicted_ns, ns, ..TradeoffRow::default() }
    }

    #[test]
    fn every_figure_is_a_point_or_is_told_to_be_none() {
        let all = KINDS.map(|kind| (kind, 100.0));
        let rows = [
            row("whole", Some(150.0), &all),
            row("part", Some(50.0), &all[..1]),
            row("no costs", None, &all),
            TradeoffRow { error: Some("It does not fit.".to_owned()), ..row("no room", None, &[]) },
            row("nothing", Some(0.0), &all),
        ];
        let points = points(&rows);
        assert_eq!(points.iter().map(|p| &p.row.name[..]).collect::<Vec<_>>(), ["whole", "whole", "whole", "whole", "part"]);
        assert_eq!(points.iter().map(Point::off).collect::<Vec<_>>(), [0.5, 0.5, 0.5, 0.5, -0.5]);
        let missing = missing(&rows);
        assert_eq!(missing.len(), 3 + 1 + 1 + 1, "{missing:?}");
        assert!(missing[0].starts_with("part, primary: ") && missing[3].starts_with("no costs: "), "{missing:?}");
        assert_eq!(missing[4], "no room: It does not fit.");
        assert!(missing[5].contains("0 ns predicted"), "{missing:?}");
        let [low, high] = range(&points).expect("there are some");
        assert!(points.iter().all(|p| [p.predicted, p.measured].iter().all(|ns| low < *ns && *ns < high)));
        assert_eq!(range(&[]), None);
    }

    #[test]
    fn an_error_elsewhere_in_a_row_takes_no_point_of_it() {
        let error = || Some("The tree of tests of boxes does not fit.".to_owned());
        let rows = [TradeoffRow { error: error(), ..row("bvh", Some(150.0), &[(RayKind::Lines, 100.0)]) }];
        assert_eq!(points(&rows).iter().map(|point| point.kind).collect::<Vec<_>>(), [RayKind::Lines]);
        let missing = missing(&rows);
        assert_eq!(missing.len(), KINDS.len() - 1, "{missing:?}");
        assert!(missing.iter().all(|why| why.contains("does not fit")), "{missing:?}");
    }

    #[test]
    fn the_error_is_a_factor_that_favours_neither_side() {
        let both = [(RayKind::Lines, 100.0), (RayKind::Diffuse, 50.0)];
        let rows = [row("a", Some(200.0), &both[..1]), row("b", Some(50.0), &both[..1]), row("c", Some(50.0), &both[1..])];
        let points = points(&rows);
        let all = Agreement::of(&points).expect("three");
        // Twice as much, half as much, and right: the mean of two doublings in three.
        assert!(all.points == 3 && (all.factor - 2f64.powf(2.0 / 3.0)).abs() < 1e-12, "{all:?}");
        let right = Agreement::of(&points[2..]).expect("one");
        assert!((right.factor - 1.0).abs() < 1e-12 && right.correlation.is_nan());
        assert_eq!(Agreement::of(&[]), None);
        let rows = [row("a", Some(20.0), &[(RayKind::Lines, 40.0)]), row("b", Some(200.0), &[(RayKind::Lines, 400.0)])];
        let scaled = Agreement::of(&super::points(&rows)).expect("two");
        assert!((scaled.correlation - 1.0).abs() < 1e-12 && (scaled.factor - 2.0).abs() < 1e-12, "in step, all half as much");
    }

    #[test]
    fn the_cost_of_predicting_is_that_of_structures_that_have_a_prediction() {
        let of = |secs| TradeoffRow { prediction_secs: secs, ..TradeoffRow::default() };
        assert_eq!(cost(&[of(Some(1.0)), of(None), of(Some(2.0))]), Some(1.5));
        assert_eq!(cost(&[of(None)]), None);
    }
}
