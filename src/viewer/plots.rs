//! The plots of the window as they are saved.

use super::errors::{Known, Live};
use super::panels::tradeoffs::{self, Spot};
use super::sheets::{What, curves};
use super::state::State;
use super::tradeoffs::Plot;
use crate::accel::registry;
use crate::geometry::Axis;
use crate::lab::SahCurves;
use crate::lab::plot::{Curve, Dot, Guide, Panel, Scale};
use crate::lab::scaling::Point;

/// A plot as it is saved; `None` where there is nothing of it.
pub fn panels(state: &State, what: What) -> Option<Vec<Panel>> {
    if !what.is_there(state) {
        return None;
    }
    let title = |about: &str| {
        let model = state.model.as_ref().map_or("", |model| &model.scene.name[..]);
        format!("{model}: {about}")
    };
    match what {
        What::Timings | What::Needs | What::Steps | What::Stability => None,
        What::Findings | What::Memory | What::Volumes | What::Rays | What::Check => None,
        What::Statistics => Some(histograms(state, &title)),
        What::Division => Some(vec![curves_of_division(curves(state)?, title("SAH cost of dividing the selected node"))]),
        What::Errors => Some(curves_of_errors(state, &title)),
        What::Tests => Some(vec![spots(state, Plot::Intersection, title("errors of tests"))]),
        What::Quality => Some(vec![spots(state, Plot::Model, title("quality against the time of the build"))]),
        What::Scaling => Some(curves_of_scaling(state, &title)),
    }
}

fn histograms(state: &State, title: &impl Fn(&str) -> String) -> Vec<Panel> {
    let Some((shown, stats)) = state.shown.as_ref().and_then(|shown| Some((shown, shown.stats.as_ref()?))) else {
        return Vec::new();
    };
    let panel = |about: &str, x: &'static str, counts: &[u64]| Panel {
        title: title(about),
        axes: [x, "leaves"],
        curves: vec![Curve::of(shown.key.entry.id, counts.iter().enumerate().map(|(i, n)| (i as f64, *n as f64)))],
        guide: None,
        labelled: false,
        scale: Scale::Even,
    };
    vec![
        panel("leaf size", "triangles, the last and more", &stats.leaf_sizes),
        panel("leaf depth", "steps from the root", &stats.leaf_depths),
    ]
}

/// Structures whose colours the axes have, as in the window.
const AXES: [&str; 3] = ["bvh", "kdtree", "grid"];

fn curves_of_division(curves: &SahCurves, title: String) -> Panel {
    let mut drawn = Vec::new();
    for ((axis, id), candidates) in Axis::ALL.into_iter().zip(AXES).zip(&curves.axes) {
        drawn.push(Curve { name: axis.name().to_owned(), ..Curve::of(id, candidates.iter().copied()) });
    }
    drawn.push(Curve { dash: 1, name: "leaf".to_owned(), ..Curve::of("", [(0.0, curves.leaf), (1.0, curves.leaf)]) });
    if let Some((chosen, (_, place))) = curves.chosen.and_then(|chosen| Some((chosen, chosen.plane?))) {
        let dot = Dot { at: (place, chosen.cost), span: None, hollow: true };
        drawn.push(Curve { points: vec![dot], name: "chosen".to_owned(), ..Curve::of("", []) });
    }
    Panel {
        title,
        axes: ["place of the plane along the node", "SAH cost"],
        curves: drawn,
        guide: None,
        labelled: false,
        scale: Scale::Even,
    }
}

fn curves_of_errors(state: &State, title: &impl Fn(&str) -> String) -> Vec<Panel> {
    let errors = &state.errors;
    let y = if errors.reference.is_some() { "RMSE of linear light" } else { "estimated noise" };
    let panel = |about: &str, x: &'static str, of_secs: bool| {
        let curve = |(c, live): (usize, &Live)| {
            let points = live.shots.iter().enumerate().filter_map(|(p, shot)| {
                let known = errors.known(c, p)?;
                let x = if of_secs { shot.secs } else { f64::from(shot.samples) };
                let hollow = matches!(known, Known::Error { hollow: true, .. });
                Some(Dot { at: (x, known.value()), span: None, hollow })
            });
            Curve { points: points.collect(), ..Curve::of(live.key.entry.id, []) }
        };
        let curves = errors.curves.iter().enumerate().map(curve).collect();
        let guide: Guide = ("slope -1/2", |x| x.powf(-0.5));
        Panel { title: title(about), axes: [x, y], curves, guide: Some(guide), labelled: false, scale: Scale::Log }
    };
    vec![panel("error against samples", "samples a pixel", false), panel("error against seconds", "seconds of rendering", true)]
}

/// A point for each, named, as in the window.
fn spots(state: &State, plot: Plot, title: String) -> Panel {
    let spots = tradeoffs::spots(state, plot);
    let point = |spot: Spot| Curve { name: spot.name, ..Curve::of(spot.structure, [spot.at]) };
    Panel {
        title,
        axes: tradeoffs::axes(state, plot),
        curves: spots.into_iter().map(point).collect(),
        guide: None,
        labelled: true,
        scale: Scale::Log,
    }
}

fn curves_of_scaling(state: &State, title: &impl Fn(&str) -> String) -> Vec<Panel> {
    let panel = |about: &str, y: &'static str, secs: fn(&Point) -> f64| Panel {
        title: title(about),
        axes: ["triangles", y],
        curves: state
            .tradeoffs
            .scaling
            .iter()
            .filter(|structure| registry::find(&structure.id).is_some())
            .map(|structure| Curve::of(&structure.id, structure.points.iter().map(|p| (p.triangles as f64, secs(p)))))
            .collect(),
        guide: None,
        labelled: false,
        scale: Scale::Log,
    };
    vec![panel("builds", "seconds of a build", |p| p.build_secs), panel("rays", "nanoseconds of a ray", |p| p.ray_secs * 1e9)]
}
