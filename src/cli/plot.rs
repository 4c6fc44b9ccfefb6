//! Plots as SVG: several curves over logarithmic axes, one panel beside the other.

use plotters::coord::Shift;
use plotters::prelude::*;

use crate::accel::registry::{self, Family};

/// One pair of axes.
#[derive(Clone, Debug)]
pub struct Panel {
    /// What it shows.
    pub title: String,
    /// What is along the axes, with units.
    pub axes: [&'static str; 2],
    /// What is drawn.
    pub curves: Vec<Curve>,
    /// A curve to compare with: its name and a function that is moved through the least point of all.
    pub guide: Option<Guide>,
}

/// Its name, and a function.
pub type Guide = (&'static str, fn(f64) -> f64);

/// One structure.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The structure's id.
    pub id: String,
    /// Both coordinates positive; others are left out.
    pub points: Vec<(f64, f64)>,
}

/// Pixels of a panel.
const SIZE: (u32, u32) = (640, 480);
const TEXT: i32 = 15;

type Failed = DrawingAreaErrorKind<std::io::Error>;

/// The panels side by side, on white.
///
/// # Errors
/// What the drawing says; there is none that an ordinary plot gives.
pub fn log_log(panels: &[Panel]) -> Result<String, Failed> {
    let mut svg = String::new();
    {
        let columns = panels.len().max(1);
        let root = SVGBackend::with_string(&mut svg, (SIZE.0 * columns as u32, SIZE.1)).into_drawing_area();
        root.fill(&WHITE)?;
        for (area, panel) in root.split_evenly((1, columns)).iter().zip(panels) {
            draw(area, panel)?;
        }
        root.present()?;
    }
    Ok(svg)
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), Failed> {
    let drawable = |p: &(f64, f64)| p.0 > 0.0 && p.1 > 0.0 && p.0.is_finite() && p.1.is_finite();
    let all: Vec<(f64, f64)> = panel.curves.iter().flat_map(|c| c.points.iter().copied().filter(drawable)).collect();
    let span = |of: fn(&(f64, f64)) -> f64| {
        let (low, high) = all.iter().map(of).fold((f64::INFINITY, 0.0f64), |(l, h), x| (l.min(x), h.max(x)));
        if low < high { low * 0.7..high * 1.4 } else { 0.1..10.0 }
    };
    let (xs, ys) = (span(|p| p.0), span(|p| p.1));
    let mut chart = ChartBuilder::on(area)
        .caption(&panel.title, ("sans-serif", TEXT + 3))
        .margin(12)
        .x_label_area_size(44)
        .y_label_area_size(72)
        .build_cartesian_2d(xs.clone().log_scale(), ys.clone().log_scale())?;
    let [x, y] = panel.axes;
    let text = ("sans-serif", TEXT);
    let mesh = &mut chart.configure_mesh();
    mesh.x_desc(x).y_desc(y).label_style(text).axis_desc_style(text).x_label_formatter(&short).y_label_formatter(&short);
    mesh.light_line_style(BLACK.mix(0.04)).bold_line_style(BLACK.mix(0.12)).draw()?;
    let least = all.iter().copied().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    if let Some((least, (name, law))) = least.zip(panel.guide) {
        let steps = (0..=32).map(|i| least.0 * (xs.end / least.0).powf(f64::from(i) / 32.0));
        let line = steps.map(|x| (x, least.1 * law(x) / law(least.0))).filter(|p| ys.contains(&p.1));
        let style = BLACK.mix(0.5).stroke_width(1);
        let guide = chart.draw_series(DashedLineSeries::new(line, 4, 4, style))?;
        guide.label(name).legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style));
    }
    for (i, curve) in panel.curves.iter().enumerate() {
        let (color, points) = (color_of(&curve.id), curve.points.iter().copied().filter(drawable));
        // Members of a family have one colour, and differ by how their points are filled.
        let filled = i % 2 == 0;
        let dot = move |at: (i32, i32)| Circle::new(at, 4, if filled { color.filled() } else { color.stroke_width(2) });
        let line = chart.draw_series(LineSeries::new(points.clone(), color.stroke_width(2)))?;
        let key =
            move |(x, y)| EmptyElement::at((x, y)) + PathElement::new([(0, 0), (20, 0)], color.stroke_width(2)) + dot((10, 0));
        line.label(&curve.id).legend(key);
        chart.draw_series(points.map(|p| EmptyElement::at(p) + dot((0, 0))))?;
    }
    let legend = &mut chart.configure_series_labels();
    legend.position(SeriesLabelPosition::UpperLeft).background_style(WHITE.mix(0.85)).border_style(BLACK.mix(0.2));
    legend.label_font(text).draw()
}

/// The colours of the light window.
fn color_of(id: &str) -> RGBColor {
    match registry::find(id).map(|entry| entry.family) {
        Some(Family::Bvh) => RGBColor(0x22, 0x85, 0xC4),
        Some(Family::KdTree) => RGBColor(0x97, 0x58, 0x0E),
        Some(Family::Grid) => RGBColor(0x0B, 0x4A, 0x29),
        Some(Family::Octree) => RGBColor(0x7A, 0x16, 0x79),
        Some(Family::Bsp) => RGBColor(0xA0, 0x8C, 0x1E),
        Some(Family::Brute) | None => RGBColor(0x6B, 0x72, 0x80),
    }
}

/// Powers of ten as people write them.
fn short(x: &f64) -> String {
    match *x {
        x if x >= 1e6 => format!("{} M", x / 1e6),
        x if x >= 1e3 => format!("{} k", x / 1e3),
        x if x >= 1e-3 => format!("{x}"),
        x => format!("{x:e}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_is_drawn_and_named() {
        let curve = |id: &str, power: f64| Curve {
            id: id.to_owned(),
            points: [1e3, 1e4, 1e5].map(|n: f64| (n, 1e-6 * n.powf(power))).into(),
        };
        let guide: (_, fn(f64) -> f64) = ("N log N", |n| n * n.ln());
        let mut panel = Panel { title: "Builds".to_owned(), axes: ["triangles", "s"], curves: vec![], guide: Some(guide) };
        let empty = log_log(&[panel.clone()]).expect("drawn");
        panel.curves = vec![curve("bvh", 1.1), curve("kdtree", 1.2)];
        panel.curves[1].points.push((1e6, f64::NAN));
        let svg = log_log(&[panel.clone(), panel]).expect("drawn");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
        for said in ["bvh", "kdtree", "N log N", "triangles"] {
            assert_eq!(svg.matches(&format!("\n{said}\n")).count(), 2, "{said}");
        }
        assert_eq!(svg.matches("<circle").count() - empty.matches("<circle").count(), 2 * (6 + 2));
    }
}
