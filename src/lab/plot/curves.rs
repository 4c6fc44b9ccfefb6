//! Curves and single points over a pair of axes.

use std::ops::Range;

use plotters::coord::Shift;
use plotters::coord::ranged1d::{Ranged, ValueFormatter};
use plotters::prelude::*;

use super::axis::LABELS;
use super::colors::colors_of;
use super::{Curve, Dot, Failed, Mark, Panel, Scale, TEXT};

/// What is drawn over, with axes of two kinds.
type Chart<'a, 'b, X, Y> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<X, Y>>;

/// Draws a panel.
pub(super) fn draw(area: &DrawingArea<SVGBackend<'_>, Shift>, panel: &Panel) -> Result<(), Failed> {
    let spans = panel.spans();
    let (xs, ys) = spans.clone();
    let mut builder = ChartBuilder::on(area);
    builder.caption(&panel.title, ("sans-serif", TEXT + 3)).margin(12).x_label_area_size(44).y_label_area_size(72);
    match panel.scales {
        [Scale::Log, Scale::Log] => fill(builder.build_cartesian_2d(xs.log_scale(), ys.log_scale())?, panel, spans),
        [Scale::Log, Scale::Even] => fill(builder.build_cartesian_2d(xs.log_scale(), ys)?, panel, spans),
        [Scale::Even, Scale::Log] => fill(builder.build_cartesian_2d(xs, ys.log_scale())?, panel, spans),
        [Scale::Even, Scale::Even] => fill(builder.build_cartesian_2d(xs, ys)?, panel, spans),
    }
}

impl Panel {
    /// Whether a point has a place.
    fn has(&self, dot: &Dot) -> bool {
        self.scales[0].fits(dot.at.0) && self.scales[1].fits(dot.at.1)
    }

    /// Where there are points.
    fn all(&self) -> impl Iterator<Item = (f64, f64)> + Clone {
        self.curves.iter().flat_map(|curve| &curve.points).filter(|dot| self.has(dot)).map(|dot| dot.at)
    }

    /// How far the axes reach: both as far as the other where what is along them is compared.
    fn spans(&self) -> (Range<f64>, Range<f64>) {
        let (xs, ys) = (self.all().map(|p| p.0), self.all().map(|p| p.1));
        if self.equal.is_some() {
            let both = self.scales[0].around(xs.chain(ys));
            return (both.clone(), both);
        }
        (self.scales[0].around(xs), self.scales[1].around(ys))
    }
}

impl Mark {
    /// Its corners around a place, in pixels; a circle has none.
    fn corners(self, (x, y): (i32, i32)) -> Option<Vec<(i32, i32)>> {
        let corners: &[(i32, i32)] = match self {
            Self::Circle => return None,
            Self::Square => &[(-4, -4), (4, -4), (4, 4), (-4, 4)],
            Self::Diamond => &[(0, -6), (6, 0), (0, 6), (-6, 0)],
            Self::Triangle => &[(0, -5), (5, 4), (-5, 4)],
        };
        Some(corners.iter().map(|(dx, dy)| (x + dx, y + dy)).collect())
    }
}

/// Draws what is over the axes.
fn fill<'a, 'b: 'a, X, Y>(mut chart: Chart<'a, 'b, X, Y>, panel: &Panel, spans: (Range<f64>, Range<f64>)) -> Result<(), Failed>
where
    X: Ranged<ValueType = f64> + ValueFormatter<f64>,
    Y: Ranged<ValueType = f64> + ValueFormatter<f64>,
{
    let [x, y] = panel.axes;
    let text = ("sans-serif", TEXT);
    let labels = [panel.scales[0].labels(&spans.0), panel.scales[1].labels(&spans.1)];
    let mesh = &mut chart.configure_mesh();
    mesh.x_labels(LABELS).y_labels(LABELS).x_label_formatter(&*labels[0]).y_label_formatter(&*labels[1]);
    mesh.x_desc(x).y_desc(y).label_style(text).axis_desc_style(text);
    mesh.light_line_style(BLACK.mix(0.04)).bold_line_style(BLACK.mix(0.12)).draw()?;
    guides(&mut chart, panel, &spans)?;
    let ids: Vec<&str> = panel.curves.iter().map(|curve| &curve.id[..]).collect();
    for (curve, color) in panel.curves.iter().zip(colors_of(&ids)) {
        draw_curve(&mut chart, panel, (curve, color), &spans.0)?;
    }
    keys(&mut chart, panel)?;
    if panel.labelled && panel.equal.is_none() && panel.keys.is_empty() {
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

/// What curves and points are compared with.
fn guides<'a, 'b: 'a, X, Y>(
    chart: &mut Chart<'a, 'b, X, Y>,
    panel: &Panel,
    (xs, ys): &(Range<f64>, Range<f64>),
) -> Result<(), Failed>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let style = BLACK.mix(0.5).stroke_width(1);
    let key = move |(x, y)| PathElement::new([(x, y), (x + 20, y)], style);
    let least = panel.all().min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    if let Some((least, (name, law))) = least.zip(panel.guide) {
        let steps = (0..=32).map(|i| least.0 * (xs.end / least.0).powf(f64::from(i) / 32.0));
        let line = steps.map(|x| (x, least.1 * law(x) / law(least.0))).filter(|p| ys.contains(&p.1));
        chart.draw_series(DashedLineSeries::new(line, 4, 4, style))?.label(name).legend(key);
    }
    if let Some(name) = panel.equal {
        let ends = [(xs.start, xs.start), (xs.end, xs.end)];
        chart.draw_series(LineSeries::new(ends, style))?.label(name).legend(key);
    }
    Ok(())
}

/// Draws a curve, or its points alone.
fn draw_curve<'a, 'b: 'a, X, Y>(
    chart: &mut Chart<'a, 'b, X, Y>,
    panel: &Panel,
    (curve, color): (&Curve, RGBColor),
    xs: &Range<f64>,
) -> Result<(), Failed>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    let dots: Vec<Dot> = curve.points.iter().copied().filter(|dot| panel.has(dot)).collect();
    let ends = |end: fn((f64, f64)) -> f64| {
        dots.iter().filter_map(move |dot| {
            Some((dot.span.map(end).filter(|x| panel.scales[0].fits(*x))?.clamp(xs.start, xs.end), dot.at.1))
        })
    };
    let band: Vec<(f64, f64)> = ends(|span| span.0).chain(ends(|span| span.1).collect::<Vec<_>>().into_iter().rev()).collect();
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
        EmptyElement::at(at) + part(-10, -gap) + part(20 + gap, 30) + part(0, 20)
    };
    match (panel.labelled, curve.mark) {
        (true, _) => {}
        (false, None) => {
            series.label(&curve.name).legend(key);
        }
        (false, Some(_)) => {
            series.label(&curve.name).legend(move |at| key(at) + Circle::new((10, 0), 4, color.filled()));
        }
    }
    let inside = |dot: &Dot| if dot.hollow { WHITE.filled() } else { color.filled() };
    match curve.mark.map(|mark| mark.corners((0, 0))) {
        None => {}
        Some(None) => {
            let circle = |dot: &Dot| {
                EmptyElement::at(dot.at) + Circle::new((0, 0), 4, inside(dot)) + Circle::new((0, 0), 4, color.stroke_width(2))
            };
            chart.draw_series(dots.iter().map(circle))?;
        }
        Some(Some(corners)) => {
            let around: Vec<(i32, i32)> = corners.iter().chain(&corners[..1]).copied().collect();
            let shape = |dot: &Dot| {
                let edge = PathElement::new(around.clone(), color.stroke_width(2));
                EmptyElement::at(dot.at) + Polygon::new(corners.clone(), inside(dot)) + edge
            };
            chart.draw_series(dots.iter().map(shape))?;
        }
    }
    if let (true, Some(first)) = (panel.labelled && !curve.name.is_empty(), dots.first()) {
        let place = EmptyElement::at(first.at) + Text::new(curve.name.clone(), (7, -6), ("sans-serif", TEXT - 3));
        chart.draw_series(std::iter::once(place))?;
    }
    Ok(())
}

/// What marks stand for, in the list.
fn keys<'a, 'b: 'a, X, Y>(chart: &mut Chart<'a, 'b, X, Y>, panel: &Panel) -> Result<(), Failed>
where
    X: Ranged<ValueType = f64>,
    Y: Ranged<ValueType = f64>,
{
    for (mark, name) in &panel.keys {
        let nothing = LineSeries::new(Vec::<(f64, f64)>::new(), BLACK);
        let series = chart.draw_series(nothing)?.label(*name);
        match mark.corners((10, 0)) {
            None => series.legend(|at| EmptyElement::at(at) + Circle::new((10, 0), 4, BLACK.filled())),
            Some(corners) => series.legend(move |at| EmptyElement::at(at) + Polygon::new(corners.clone(), BLACK.filled())),
        };
    }
    Ok(())
}
