//! Plots as SVG and PNG: several curves over logarithmic or even axes, one panel beside the other.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::coord::types::RangedCoordf64;
use plotters::prelude::*;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg;

use crate::accel::registry::{self, Family};
use crate::geometry::num::floor_index;

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
    /// Whether curves are named at their first point, instead of in a list.
    pub labelled: bool,
    /// How axes are divided.
    pub scale: Scale,
}

/// How axes are divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// By powers of ten; what is not positive has no place.
    #[default]
    Log,
    /// Evenly.
    Even,
}

/// Its name, and a function.
pub type Guide = (&'static str, fn(f64) -> f64);

/// What is measured of one thing.
#[derive(Clone, Debug)]
pub struct Curve {
    /// The id of the structure whose colour it has.
    pub id: String,
    /// What it is called.
    pub name: String,
    /// How its line is broken: not at all for 0.
    pub dash: usize,
    /// From left to right.
    pub points: Vec<Dot>,
}

/// A point of a curve. One that has no place on the axes is left out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dot {
    /// Where it is.
    pub at: (f64, f64),
    /// The least and the most of its first coordinate, if it was measured several times.
    pub span: Option<(f64, f64)>,
    /// It is not to be relied on: drawn hollow.
    pub hollow: bool,
}

impl Curve {
    /// Of one structure, called by its id.
    pub fn of(id: &str, points: impl IntoIterator<Item = (f64, f64)>) -> Self {
        let points = points.into_iter().map(|at| Dot { at, span: None, hollow: false }).collect();
        Self { id: id.to_owned(), name: id.to_owned(), dash: 0, points }
    }
}

/// Pixels of a panel.
const SIZE: (u32, u32) = (640, 480);
const TEXT: i32 = 15;
/// Numbers along an axis, at most.
const LABELS: usize = 11;

type Failed = DrawingAreaErrorKind<std::io::Error>;

/// The panels side by side, on white.
///
/// # Errors
/// What the drawing says; there is none that an ordinary plot gives.
pub fn svg_of(panels: &[Panel]) -> Result<String, Failed> {
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

/// An SVG picture as PNG, with the text in the window's typeface: nothing of the machine's is used.
///
/// # Errors
/// In words; there is none that a plot from here gives.
pub fn png_of(svg: &str) -> Result<Vec<u8>, String> {
    /// Enlarged, so that text is sharp.
    const SCALE: f32 = 2.0;
    let mut options = usvg::Options { font_family: "Ubuntu".to_owned(), ..usvg::Options::default() };
    let fonts = options.fontdb_mut();
    fonts.load_font_data(epaint_default_fonts::UBUNTU_LIGHT.to_vec());
    fonts.set_sans_serif_family("Ubuntu");
    let tree = usvg::Tree::from_str(svg, &options).map_err(|error| error.to_string())?;
    let size = tree.size().to_int_size().scale_by(SCALE).ok_or("it has no size")?;
    let mut picture = Pixmap::new(size.width(), size.height()).ok_or("it has no size")?;
    resvg::render(&tree, Transform::from_scale(SCALE, SCALE), &mut picture.as_mut());
    picture.encode_png().map_err(|error| error.to_string())
}

fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), Failed> {
    let curves = panel.curves.iter().flat_map(|c| &c.points);
    let all: Vec<(f64, f64)> = curves.filter(|dot| panel.scale.has(dot)).map(|d| d.at).collect();
    let (xs, ys) = (panel.scale.around(all.iter().map(|p| p.0)), panel.scale.around(all.iter().map(|p| p.1)));
    let mut builder = ChartBuilder::on(area);
    builder.caption(&panel.title, ("sans-serif", TEXT + 3)).margin(12).x_label_area_size(44).y_label_area_size(72);
    let spans = (xs.clone(), ys.clone());
    match panel.scale {
        Scale::Log => fill(builder.build_cartesian_2d(xs.log_scale(), ys.log_scale())?, panel, &all, spans),
        Scale::Even => fill(builder.build_cartesian_2d(xs, ys)?, panel, &all, spans),
    }
}

impl Scale {
    /// Whether a point has a place.
    fn has(self, dot: &Dot) -> bool {
        self.fits(dot.at.0) && self.fits(dot.at.1)
    }

    /// Whether a coordinate has one.
    fn fits(self, x: f64) -> bool {
        x.is_finite() && (self == Self::Even || x > 0.0)
    }

    /// What is written along an axis.
    fn labels(self, axis: &Range<f64>) -> Box<dyn Fn(&f64) -> String> {
        match self {
            Self::Log => Box::new(short),
            Self::Even => Box::new(even(axis.clone())),
        }
    }

    /// An axis that holds all of these, with some room.
    fn around(self, values: impl Iterator<Item = f64>) -> Range<f64> {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        match self {
            Self::Log if low <= high => low * 0.7..high * 1.4,
            Self::Log => 0.1..10.0,
            Self::Even if low <= high => {
                let room = if high > low { (high - low) * 0.05 } else { low.abs().max(1.0) * 0.5 };
                low - room..high + room
            }
            Self::Even => 0.0..1.0,
        }
    }
}

/// Draws what is over the axes.
fn fill<'a, 'b: 'a, X, Y>(
    mut chart: ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>,
    panel: &Panel,
    all: &[(f64, f64)],
    (xs, ys): (Range<f64>, Range<f64>),
) -> Result<(), Failed>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let [x, y] = panel.axes;
    let text = ("sans-serif", TEXT);
    let labels = [&xs, &ys].map(|axis| panel.scale.labels(axis));
    let mesh = &mut chart.configure_mesh();
    mesh.x_labels(LABELS).y_labels(LABELS).x_label_formatter(&*labels[0]).y_label_formatter(&*labels[1]);
    mesh.x_desc(x).y_desc(y).label_style(text).axis_desc_style(text);
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
        let mut family: Vec<&str> = Vec::new();
        for other in panel.curves[..=i].iter().filter(|other| family_of(&other.id) == family_of(&curve.id)) {
            if !family.contains(&other.id.as_str()) {
                family.push(&other.id);
            }
        }
        let color = shaded(color_of(&curve.id), family.iter().position(|id| *id == curve.id).unwrap_or(0));
        let dots: Vec<Dot> = curve.points.iter().copied().filter(|dot| panel.scale.has(dot)).collect();
        let ends = |end: fn((f64, f64)) -> f64| {
            dots.iter().filter_map(move |dot| {
                Some((dot.span.map(end).filter(|x| panel.scale.fits(*x))?.clamp(xs.start, xs.end), dot.at.1))
            })
        };
        let band: Vec<(f64, f64)> =
            ends(|span| span.0).chain(ends(|span| span.1).collect::<Vec<_>>().into_iter().rev()).collect();
        if !band.is_empty() {
            chart.draw_series(std::iter::once(Polygon::new(band, color.mix(0.18))))?;
        }
        let (at, style) = (dots.iter().map(|dot| dot.at), color.stroke_width(2));
        let series = match curve.dash {
            0 => chart.draw_series(LineSeries::new(at, style))?,
            1 => chart.draw_series(DashedLineSeries::new(at, 6, 4, style))?,
            _ => chart.draw_series(DashedLineSeries::new(at, 2, 3, style))?,
        };
        let gap = [0, 4, 9][curve.dash.min(2)];
        let key = move |at| {
            let part = |from: i32, to: i32| PathElement::new([(from, 0), (to, 0)], style);
            let ends = EmptyElement::at(at) + part(-10, -gap) + part(20 + gap, 30);
            ends + part(0, 20) + Circle::new((10, 0), 4, color.filled())
        };
        series.label(&curve.name).legend(key);
        let dot = |dot: &Dot| {
            let inside = if dot.hollow { WHITE.filled() } else { color.filled() };
            EmptyElement::at(dot.at) + Circle::new((0, 0), 4, inside) + Circle::new((0, 0), 4, color.stroke_width(2))
        };
        chart.draw_series(dots.iter().map(dot))?;
        if let (true, Some(first)) = (panel.labelled, dots.first()) {
            let place = EmptyElement::at(first.at) + Text::new(curve.name.clone(), (7, -6), ("sans-serif", TEXT - 3));
            chart.draw_series(std::iter::once(place))?;
        }
    }
    if panel.labelled {
        return Ok(());
    }
    // Where there are no curves.
    let falls = panel.guide.is_some_and(|(_, law)| law(4.0) < law(2.0));
    let legend = &mut chart.configure_series_labels();
    legend
        .position(if falls { SeriesLabelPosition::LowerLeft } else { SeriesLabelPosition::UpperLeft })
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.2));
    legend.label_font(text).legend_area_size(44).draw()
}

fn family_of(id: &str) -> Option<Family> {
    registry::find(id).map(|entry| entry.family)
}

/// Members of a family have one colour, the second darker and the third lighter.
fn shaded(color: RGBColor, which: usize) -> RGBColor {
    let toward = |end: u16, share: u16| move |c: u8| ((u16::from(c) * (4 - share) + end * share) / 4) as u8;
    let mix = |end, share| RGBColor(toward(end, share)(color.0), toward(end, share)(color.1), toward(end, share)(color.2));
    match which {
        0 => color,
        1 => mix(0, 2),
        2 => mix(255, 2),
        n => mix(if n.is_multiple_of(2) { 255 } else { 0 }, 1),
    }
}

/// The colours of the light window.
fn color_of(id: &str) -> RGBColor {
    match family_of(id) {
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
        // Not to the last bit: 0.4, not 0.4000000000000001.
        x if x >= 1e-3 => format!("{}", (x * 1e6).round() / 1e6),
        0.0 => "0".to_owned(),
        x if x < 0.0 => format!("-{}", short(&-x)),
        x => format!("{x:.0e}"),
    }
}

/// Numbers along an even axis, with the decimals that tell neighbours apart.
fn even(axis: Range<f64>) -> impl Fn(&f64) -> String {
    /// The most decimals that are written out.
    const MOST: f64 = 6.0;
    let span = axis.end - axis.start;
    let step = match RangedCoordf64::from(axis).key_points(LABELS)[..] {
        [a, b, ..] => b - a,
        _ => span,
    };
    // Steps are 1, 2 or 5 times a power of ten, but for rounding.
    let power = |x: f64| (x.log10() + 1e-6).floor();
    let digits = |n: f64| floor_index(n.max(0.0), 15);
    move |x| {
        let (unit, name) = match x.abs() {
            x if x < span * 1e-6 => return "0".to_owned(),
            x if x >= 1e6 => (1e6, " M"),
            x if x >= 1e3 => (1e3, " k"),
            _ => (1.0, ""),
        };
        let decimals = -power(step / unit);
        if decimals > MOST {
            let digits = digits(power(x.abs()) - power(step));
            return format!("{x:.digits$e}");
        }
        format!("{:.*}{name}", digits(decimals), x / unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_is_drawn_and_named() {
        let curve = |id: &str, power: f64| Curve::of(id, [1e3, 1e4, 1e5].map(|n: f64| (n, 1e-6 * n.powf(power))));
        let guide: (_, fn(f64) -> f64) = ("N log N", |n| n * n.ln());
        let mut panel = Panel {
            title: "Builds".to_owned(),
            axes: ["triangles", "s"],
            curves: vec![],
            guide: Some(guide),
            labelled: false,
            scale: Scale::Log,
        };
        let empty = svg_of(&[panel.clone()]).expect("drawn");
        panel.curves = vec![curve("bvh", 1.1), curve("kdtree", 1.2)];
        panel.curves[1].points.push(Dot { at: (1e6, f64::NAN), span: None, hollow: false });
        panel.curves[0].points[1].span = Some((9e3, 2e4));
        panel.curves[0].points[2].span = Some((9e4, 2e5));
        let svg = svg_of(&[panel.clone(), panel]).expect("drawn");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
        for said in ["bvh", "kdtree", "N log N", "triangles"] {
            assert_eq!(svg.matches(&format!("\n{said}\n")).count(), 2, "{said}");
        }
        // Points have an outline, keys have none.
        assert_eq!(svg.matches("<circle").count() - empty.matches("<circle").count(), 2 * (2 * 6 + 2));
        let png = png_of(&svg).expect("drawn");
        let picture = image::load_from_memory(&png).expect("a picture").into_rgb8();
        assert_eq!(picture.dimensions(), (4 * SIZE.0, 2 * SIZE.1));
        let dark = |y: u32| (0..picture.width()).filter(|x| picture.get_pixel(*x, y).0.iter().all(|c| *c < 96)).count();
        assert!((0..80).any(|y| dark(y) > 20), "the title is written");
    }

    #[test]
    fn even_axes_have_a_place_for_zero_and_text_stays_text() {
        let curve = Curve { name: "a < b & \"c\"".to_owned(), ..Curve::of("x", [(0.0, 0.0), (0.5, -2.0), (1.0, 3.0)]) };
        let axes = ["place", "SAH cost"];
        let panel =
            Panel { title: "<node>".to_owned(), axes, curves: vec![curve], guide: None, labelled: false, scale: Scale::Even };
        let svg = svg_of(&[panel]).expect("drawn");
        assert!(usvg::Tree::from_str(&svg, &usvg::Options::default()).is_ok(), "well formed");
        assert!(!svg.contains("<node>") && svg.matches("<circle").count() >= 3);
    }

    #[test]
    fn a_band_reaches_to_zero_and_below_on_even_axes() {
        let drawn = |scale, span| {
            let mut curve = Curve::of("bvh", [(1.0, 1.0), (2.0, 2.0), (3.0, 3.0)]);
            curve.points.iter_mut().for_each(|dot| dot.span = Some(span));
            let axes = ["place", "SAH cost"];
            let panel = Panel { title: "node".to_owned(), axes, curves: vec![curve], guide: None, labelled: false, scale };
            svg_of(&[panel]).expect("drawn").lines().find(|line| line.contains("<polygon")).map(str::to_owned)
        };
        let corners = |line: Option<String>| line.map_or(0, |line| line.matches(',').count());
        assert!(corners(drawn(Scale::Even, (0.0, 4.0))) > corners(drawn(Scale::Log, (0.0, 4.0))));
        assert_eq!(corners(drawn(Scale::Even, (-1.0, 0.0))), corners(drawn(Scale::Even, (1.0, 4.0))));
    }

    #[test]
    fn numbers_along_an_even_axis_are_told_apart() {
        let labels = |axis: Range<f64>| -> Vec<String> {
            let label = even(axis.clone());
            RangedCoordf64::from(axis).key_points(LABELS).iter().map(label).collect()
        };
        for (from, to) in [(0.0, 1.0), (-0.5, 0.5), (0.0, 4e-4), (0.2001, 0.2006), (-3e-9, 2e-9), (0.0, 4e6), (990.0, 1010.0)] {
            let all = labels(from..to);
            assert!(all.len() > 2 && all.windows(2).all(|w| w[0] != w[1]), "{all:?}");
        }
        assert_eq!(labels(0.0..1.0)[..3], ["0", "0.1", "0.2"]);
        assert_eq!(labels(0.0..4e-4)[1..3], ["0.00005", "0.00010"]);
        assert_eq!(even(-1.0..1.0)(&1e-17), "0");
        assert_eq!(even(0.0..1e7)(&2e6), "2 M");
    }
}
