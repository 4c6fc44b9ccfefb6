//! The plots of the window as they are saved.

mod bars;
mod columns;

use super::errors::{Known, Live};
use super::panels::tradeoffs::{self, Spot};
use super::sheets::{What, curves};
use super::state::State;
use super::tradeoffs::Plot;
use crate::accel::registry;
use crate::geometry::Axis;
use crate::lab::SahCurves;
use crate::lab::plot::{Curve, Dot, Drawing, Guide, Panel, Scale};
use crate::lab::prediction;
use crate::lab::scaling::Point;

/// A plot as it is saved; `None` where there is nothing of it.
pub fn drawing(state: &State, what: What) -> Option<Drawing> {
    if !what.is_plotted(state) {
        return None;
    }
    let title = |about: &str| {
        let model = state.model.as_ref().map_or("", |model| &model.scene.name[..]);
        format!("{model}: {about}")
    };
    let one = |panel: Panel| Some(Drawing::Curves(vec![panel]));
    match what {
        What::Needs | What::Steps | What::Stability | What::Findings | What::Memory | What::Rays | What::Check => None,
        What::Timings => Some(Drawing::Bars(vec![bars::timings(state, &title)])),
        What::Volumes => Some(Drawing::Bars(bars::volumes(state.fitting()?.0, &title))),
        What::Heat => Some(Drawing::Columns(columns::heat(state, &title)?)),
        What::Statistics => Some(Drawing::Curves(histograms(state, &title))),
        What::Film => one(cost_of_film(state, &title)?),
        What::Division => one(curves_of_division(curves(state)?, title("SAH cost of dividing the selected node"))),
        What::Errors => Some(Drawing::Curves(curves_of_errors(state, &title))),
        What::Tests => one(spots(state, Plot::Intersection, title("errors of tests"))),
        What::Quality => one(spots(state, Plot::Model, title("quality against the time of the build"))),
        What::Prediction => one(prediction::plot::panel(&state.tradeoffs.rows, title("predicted against measured"))),
        What::Scaling => Some(Drawing::Curves(curves_of_scaling(state, &title))),
    }
}

/// What the model is called, before what a plot is about.
type Titles<'a> = dyn Fn(&str) -> String + 'a;

fn histograms(state: &State, title: &Titles<'_>) -> Vec<Panel> {
    let Some((shown, stats)) = state.shown.as_ref().and_then(|shown| Some((shown, shown.stats.as_ref()?))) else {
        return Vec::new();
    };
    let panel = |about: &str, x: &'static str, counts: &[u64]| Panel {
        title: title(about),
        axes: [x, "leaves"],
        curves: vec![Curve::of(shown.key.entry.id, counts.iter().enumerate().map(|(i, n)| (i as f64, *n as f64)))],
        scales: [Scale::Even; 2],
        ..Panel::default()
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
        scales: [Scale::Even; 2],
        ..Panel::default()
    }
}

/// The SAH cost along the film that is on the screen, and where that stands.
fn cost_of_film(state: &State, title: &Titles<'_>) -> Option<Panel> {
    let ((film, at), shown) = (state.film_on_screen()?, state.shown.as_ref()?);
    let all = film.costs().iter().zip(0u32..).map(|(cost, event)| (f64::from(event), *cost));
    let line = Curve { name: "SAH cost so far".to_owned(), mark: None, ..Curve::of(shown.key.entry.id, all) };
    let here = Dot { at: (f64::from(at), film.cost(at)), span: None, hollow: true };
    let stands = Curve { name: format!("event {at}"), points: vec![here], ..Curve::of("", []) };
    Some(Panel {
        title: title(&format!("film of {}", shown.key.entry.name)),
        axes: ["events so far", "SAH cost"],
        curves: vec![line, stands],
        scales: [Scale::Even, Scale::Log],
        ..Panel::default()
    })
}

fn curves_of_errors(state: &State, title: &Titles<'_>) -> Vec<Panel> {
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
        Panel { title: title(about), axes: [x, y], curves, guide: Some(guide), ..Panel::default() }
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
        labelled: true,
        ..Panel::default()
    }
}

fn curves_of_scaling(state: &State, title: &Titles<'_>) -> Vec<Panel> {
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
        ..Panel::default()
    };
    vec![panel("builds", "seconds of a build", |p| p.build_secs), panel("rays", "nanoseconds of a ray", |p| p.ray_secs * 1e9)]
}
