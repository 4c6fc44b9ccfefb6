//! Plots as SVG and PNG: curves and points over logarithmic or even axes, bars side by side, and how amounts are spread; one
//! panel beside the other.

mod axis;
mod bars;
mod colors;
mod columns;
mod curves;

use plotters::coord::Shift;
use plotters::prelude::*;
use resvg::tiny_skia::{Pixmap, Transform};
use resvg::usvg;

pub use axis::Scale;
pub use bars::{Bar, Bars};
pub use columns::Columns;

/// A plot of one kind.
#[derive(Clone, Debug)]
pub enum Drawing {
    /// Curves and points, panel beside panel.
    Curves(Vec<Panel>),
    /// Bars, panel beside panel.
    Bars(Vec<Bars>),
    /// How amounts are spread.
    Columns(Columns),
}

impl Drawing {
    /// The plot, on white.
    ///
    /// # Errors
    /// What the drawing says; there is none that an ordinary plot gives.
    pub fn svg(&self) -> Result<String, Failed> {
        match self {
            Self::Curves(panels) => svg_of(panels),
            Self::Bars(panels) => side_by_side(panels, bars::draw),
            Self::Columns(columns) => side_by_side(std::slice::from_ref(columns), columns::draw),
        }
    }
}

/// One pair of axes.
#[derive(Clone, Debug, Default)]
pub struct Panel {
    /// What it shows.
    pub title: String,
    /// What is along the axes, with units.
    pub axes: [&'static str; 2],
    /// What is drawn.
    pub curves: Vec<Curve>,
    /// A curve to compare with: its name and a function that is moved through the least point of all.
    pub guide: Option<Guide>,
    /// The name of the line on which both coordinates are equal; both axes then have the range of all figures.
    pub equal: Option<&'static str>,
    /// What marks stand for, listed where there are any.
    pub keys: Vec<(Mark, &'static str)>,
    /// Whether curves are named at their first point, instead of in a list.
    pub labelled: bool,
    /// How axes are divided.
    pub scales: [Scale; 2],
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
    /// What its points are drawn as, if they are.
    pub mark: Option<Mark>,
    /// From left to right.
    pub points: Vec<Dot>,
}

/// What a point is drawn as.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// Round.
    Circle,
    /// On a side.
    Square,
    /// On a corner.
    Diamond,
    /// Its tip up.
    Triangle,
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
        Self { id: id.to_owned(), name: id.to_owned(), dash: 0, mark: Some(Mark::Circle), points }
    }
}

/// Pixels of a panel.
const SIZE: (u32, u32) = (640, 480);
const TEXT: i32 = 15;

/// Why there is no plot.
pub type Failed = DrawingAreaErrorKind<std::io::Error>;

/// The panels side by side, on white.
///
/// # Errors
/// What the drawing says; there is none that an ordinary plot gives.
pub fn svg_of(panels: &[Panel]) -> Result<String, Failed> {
    side_by_side(panels, curves::draw)
}

/// Where a panel is drawn.
type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Panels of one kind side by side.
fn side_by_side<T>(panels: &[T], draw: impl Fn(&Area<'_>, &T) -> Result<(), Failed>) -> Result<String, Failed> {
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

/// Text as files have it: a typeface may lack thin spaces.
fn plain(text: &str) -> String {
    text.replace('\u{2009}', " ")
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_curve_is_drawn_and_named() {
        let curve = |id: &str, power: f64| Curve::of(id, [1e3, 1e4, 1e5].map(|n: f64| (n, 1e-6 * n.powf(power))));
        let guide: (_, fn(f64) -> f64) = ("N log N", |n| n * n.ln());
        let mut panel = Panel { title: "Builds".to_owned(), axes: ["triangles", "s"], guide: Some(guide), ..Panel::default() };
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
        let panel = Panel { title: "<node>".to_owned(), axes, curves: vec![curve], scales: [Scale::Even; 2], ..Panel::default() };
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
            let (title, scales) = ("node".to_owned(), [scale; 2]);
            let panel = Panel { title, axes, curves: vec![curve], scales, ..Panel::default() };
            svg_of(&[panel]).expect("drawn").lines().find(|line| line.contains("<polygon")).map(str::to_owned)
        };
        let corners = |line: Option<String>| line.map_or(0, |line| line.matches(',').count());
        assert!(corners(drawn(Scale::Even, (0.0, 4.0))) > corners(drawn(Scale::Log, (0.0, 4.0))));
        assert_eq!(corners(drawn(Scale::Even, (-1.0, 0.0))), corners(drawn(Scale::Even, (1.0, 4.0))));
    }

    /// The numbers of an attribute of every element of a kind.
    fn attribute(svg: &str, element: &str, name: &str) -> Vec<String> {
        let (begins, name) = (format!("<{element} "), format!(" {name}=\""));
        let of = svg.lines().filter(|line| line.starts_with(&begins)).filter_map(|line| {
            let value = &line[line.find(&name)? + name.len()..];
            value.split('"').next().map(str::to_owned)
        });
        of.collect()
    }

    #[test]
    fn the_line_of_equals_goes_through_equal_figures_and_every_mark_is_drawn() {
        let marks = [Mark::Circle, Mark::Square, Mark::Diamond, Mark::Triangle];
        let keys: Vec<(Mark, &str)> = marks.into_iter().zip(["a round", "a square", "a diamond", "a triangle"]).collect();
        let mut panel = Panel { equal: Some("x = y"), keys, labelled: true, ..Panel::default() };
        panel.curves = vec![Curve::of("bvh", [(10.0, 10.0), (1000.0, 1000.0)]), Curve::of("grid", [(20.0, 5000.0)])];
        let svg = svg_of(&[panel.clone()]).expect("drawn");
        let line: Vec<f64> = attribute(&svg, "polyline", "points")
            .iter()
            .map(|points| points.split([' ', ',']).filter_map(|n| n.parse().ok()).collect::<Vec<f64>>())
            .find(|line| line.len() == 4 && line[0] != line[2] && line[1] != line[3])
            .expect("the only line that is neither level nor upright");
        let number = |name: &str| -> Vec<f64> { attribute(&svg, "circle", name).iter().filter_map(|n| n.parse().ok()).collect() };
        let at: Vec<(f64, f64)> = number("cx").into_iter().zip(number("cy")).collect();
        let off = |(x, y): &(f64, f64)| (line[1] + (line[3] - line[1]) * (x - line[0]) / (line[2] - line[0]) - y).abs();
        // Two circles each for two points that are equal, two for one that is not, and one of the list.
        assert_eq!((at.len(), at.iter().filter(|at| off(at) <= 1.5).count()), (7, 4), "{at:?} {line:?}");
        for said in ["x = y", "bvh", "grid", "a round", "a square", "a diamond", "a triangle"] {
            assert_eq!(svg.matches(&format!("\n{said}\n")).count(), 1, "{said}");
        }
        for (mark, more) in marks.into_iter().zip([0, 3, 3, 3]) {
            panel.curves.iter_mut().for_each(|curve| curve.mark = Some(mark));
            let svg = svg_of(&[panel.clone()]).expect("drawn");
            // The list has one of each of the three that have corners.
            assert_eq!(svg.matches("<polygon").count(), 3 + more, "{mark:?}");
        }
        panel.curves.iter_mut().for_each(|curve| curve.mark = None);
        assert_eq!(svg_of(&[panel]).expect("drawn").matches("<circle").count(), 1, "a line alone");
    }

    #[test]
    fn an_axis_may_be_even_beside_a_logarithmic_one() {
        let curve = Curve::of("bvh", [(0.0, 100.0), (1.0, 10.0), (2.0, 0.0)]);
        let drawn = |scales| {
            let panel = Panel { curves: vec![curve.clone()], scales, labelled: true, ..Panel::default() };
            svg_of(&[panel]).expect("drawn").matches("<circle").count() / 2
        };
        assert_eq!(drawn([Scale::Even, Scale::Log]), 2, "nothing has no logarithm");
        assert_eq!(drawn([Scale::Log, Scale::Even]), 2);
        assert_eq!((drawn([Scale::Even; 2]), drawn([Scale::Log; 2])), (3, 1));
    }
}
