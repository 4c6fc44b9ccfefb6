//! Timings, and the bounding volumes of a node, as bars.

use super::Titles;
use crate::lab::plot::{Bar, Bars};
use crate::lab::{FitRow, Fitting, Timing};
use crate::viewer::panels::fitting::volume_name;
use crate::viewer::state::State;

/// Camera rays a second with their spread, a bar a structure in the order of the table, and one for the rasteriser.
pub fn timings(state: &State, title: &Titles<'_>) -> Bars {
    let mut bars = Vec::new();
    for (entry, row) in state.timings.sorted(&state.terms_of_timings) {
        // The reason is a sentence, which the table has room for.
        let why = if row.failed.is_some() { "not built" } else { "not measured" };
        bars.push(rate(entry.id, entry.short, row.timing.as_ref(), why));
    }
    let raster = state.timings.raster.as_ref().map(crate::lab::RasterRow::timing);
    bars.push(rate("", "Raster", raster.as_ref(), "not measured"));
    let about = format!("timings, {}", state.timings.fairness.name().to_lowercase());
    Bars { title: title(&about), axis: "millions of camera rays a second, median ± half the interquartile range", bars }
}

fn rate(id: &str, name: &str, timing: Option<&Timing>, why: &str) -> Bar {
    let (id, name) = (id.to_owned(), name.to_owned());
    match timing {
        Some(t) => {
            let note = if t.capped.is_some() { "a part of the rays" } else { "" };
            Bar { id, name, length: t.mrays_per_sec, spread: t.mrays_spread(), note: note.to_owned() }
        }
        None => Bar { id, name, length: f64::NAN, spread: 0.0, note: why.to_owned() },
    }
}

/// The area, the rays in vain and the time of a test of each kind of volume around a node.
pub fn volumes(fitting: &Fitting, title: &Titles<'_>) -> Vec<Bars> {
    let bar = |row: &FitRow, length: f64, spread: f64, why: &str| {
        let note = if length.is_finite() { "" } else { why };
        let spread = if spread.is_finite() { spread } else { 0.0 };
        Bar { id: "volumes".to_owned(), name: volume_name(row.id).to_owned(), length, spread, note: note.to_owned() }
    };
    let bars = |bar: &dyn Fn(&FitRow) -> Bar| fitting.rows.iter().map(bar).collect();
    let hull = fitting.rows.iter().find(|row| row.id == "hull").map(|row| row.area).filter(|area| *area > 0.0);
    let (times, axis) = match hull {
        Some(hull) => (hull, "area, as a multiple of the convex hull's"),
        None => (1.0, "area, in units in which the scene is about 1 long"),
    };
    vec![
        Bars {
            title: title("areas of volumes around the selected node"),
            axis,
            bars: bars(&|row| bar(row, row.area / times, 0.0, "no area")),
        },
        Bars {
            title: title("rays that they let in for nothing"),
            axis: "rays in vain, % of those let in",
            bars: bars(&|row| bar(row, 100.0 * row.false_positives(), 0.0, "lets none in")),
        },
        Bars {
            title: title("time of a test"),
            axis: "nanoseconds of a test, median ± half the interquartile range",
            bars: bars(&|row| bar(row, row.test_ns, row.spread_ns, "no ray comes near")),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::cell::Form;
    use crate::geometry::Aabb;
    use crate::lab::plot::Drawing;

    #[test]
    fn each_volume_has_a_bar_in_each_of_three_plots() {
        let row = |id: &'static str, area: f64, met: usize, test_ns: f64| FitRow {
            id,
            area,
            met,
            in_vain: met / 4,
            test_ns,
            spread_ns: 0.5,
            loose: false,
            form: Form::Box(Aabb::EMPTY),
        };
        let rows = vec![row("sphere", 6.0, 8, 3.0), row("hull", 2.0, 0, f64::NAN)];
        let mut fitting = Fitting { rows, triangles: 9, taken: 9, rays: 70, followed: 60 };
        let lengths = |fitting: &Fitting| -> Vec<Vec<f64>> {
            let plots = volumes(fitting, &|about| format!("Teapot: {about}"));
            plots.iter().map(|plot| plot.bars.iter().map(|bar| bar.length).collect()).collect()
        };
        let of = lengths(&fitting);
        assert_eq!((&of[0], of[1][0], of[2][0]), (&vec![3.0, 1.0], 25.0, 3.0));
        assert!(of[1][1].is_nan() && of[2][1].is_nan(), "what is not known is told, not drawn");
        let svg = Drawing::Bars(volumes(&fitting, &|about| format!("Teapot: {about}"))).svg().expect("drawn");
        for said in ["Sphere", "Convex hull"] {
            assert_eq!(svg.matches(&format!("\n{said}\n")).count(), 3, "{said}");
        }
        for said in ["3.00 ±0.500", "25.0", "– lets none in", "– no ray comes near"] {
            assert!(svg.contains(&format!("\n{said}\n")), "{said}: {svg}");
        }
        fitting.rows.pop();
        assert_eq!(lengths(&fitting)[0], [6.0], "no hull to compare with");
    }
}
