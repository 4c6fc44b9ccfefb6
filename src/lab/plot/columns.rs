//! How amounts are spread: a column for each bin, in the colours of a heat map, with the ends of the colours.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{LABELS, even, short};
use super::{Area, Failed, TEXT, plain};
use crate::lab::format;

/// Amounts in bins.
#[derive(Clone, Debug)]
pub struct Columns {
    /// What it shows.
    pub title: String,
    /// What is along the axes, with units. Heights are square roots, so that few are seen beside many.
    pub axes: [String; 2],
    /// Of a bin; the first one begins at nothing.
    pub width: f64,
    /// How many there are in each.
    pub counts: Vec<u32>,
    /// What the dark and the bright end of the colours stand for.
    pub ends: [f64; 2],
    /// Colours from the dark end, 0, to the bright one, 1.
    pub colors: fn(f32) -> [f32; 3],
}

/// Parts of the strip of colours.
const STEPS: u32 = 48;
/// The strip's lower and upper edge, as parts of the height over the columns.
const STRIP: [f64; 2] = [1.06, 1.1];
/// The height, where the highest column has 1.
const HEIGHT: f64 = 1.25;

impl Columns {
    /// The colour of an amount; of what is beyond the ends, that of the end.
    fn color(&self, amount: f64) -> RGBColor {
        let [dark, bright] = self.ends;
        let t = if bright > dark { ((amount - dark) / (bright - dark)).clamp(0.0, 1.0) } else { 0.5 };
        let [r, g, b] = (self.colors)(t as f32).map(|c| (c * 255.0).round() as u8);
        RGBColor(r, g, b)
    }
}

/// Draws it.
pub(super) fn draw(area: &Area<'_>, of: &Columns) -> Result<(), Failed> {
    let text = ("sans-serif", TEXT);
    let most = f64::from(of.counts.iter().copied().max().unwrap_or(0).max(1)).sqrt();
    let end = (of.width * of.counts.len() as f64).max(of.ends[1]);
    let axis = 0.0..if end > 0.0 && end.is_finite() { end } else { 1.0 };
    let mut builder = ChartBuilder::on(area);
    builder.caption(&of.title, ("sans-serif", TEXT + 3)).margin(12).x_label_area_size(44).y_label_area_size(72);
    let mut chart = builder.build_cartesian_2d(axis.clone(), 0.0..HEIGHT * most)?;
    let (amounts, heights) = (even(axis), |root: &f64| short(&(root * root).round()));
    let mesh = &mut chart.configure_mesh();
    mesh.x_labels(LABELS).y_labels(LABELS).x_label_formatter(&amounts).y_label_formatter(&heights);
    mesh.x_desc(&of.axes[0]).y_desc(&of.axes[1]).label_style(text).axis_desc_style(text);
    mesh.light_line_style(BLACK.mix(0.04)).bold_line_style(BLACK.mix(0.12)).draw()?;
    let column = |(i, count): (usize, &u32)| {
        let (from, to) = (of.width * i as f64, of.width * (i + 1) as f64);
        // A bin of counts holds the least of them.
        Rectangle::new([(from, 0.0), (to, f64::from(*count).sqrt())], of.color(from).filled())
    };
    chart.draw_series(of.counts.iter().enumerate().filter(|(_, count)| **count > 0).map(column))?;
    let [dark, bright] = of.ends;
    let step = |i: u32| {
        let at = |i: u32| dark + (bright - dark) * f64::from(i) / f64::from(STEPS);
        let [low, high] = STRIP.map(|part| part * most);
        Rectangle::new([(at(i), low), (at(i + 1), high)], of.color(0.5 * (at(i) + at(i + 1))).filled())
    };
    chart.draw_series((0..STEPS).map(step))?;
    let line = |x: f64| PathElement::new([(x, 0.0), (x, STRIP[1] * most)], BLACK.mix(0.5));
    chart.draw_series([dark, bright].into_iter().map(line))?;
    let said = |(x, name, up): (f64, &str, i32)| {
        let side = if 2.0 * x > end { HPos::Right } else { HPos::Left };
        let style = TextStyle::from(("sans-serif", TEXT - 3)).pos(Pos::new(side, VPos::Bottom));
        let text = plain(&format!("{name} {}", format::number(x)));
        EmptyElement::at((x, STRIP[1] * most)) + Text::new(text, (0, -4 - up), style)
    };
    // One over the other, since they may be near to each other.
    let ends = [(dark, "dark", TEXT), (bright, "bright", 0)];
    chart.draw_series(ends.into_iter().map(said))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Drawing;
    use super::*;
    use crate::render::colormap::viridis;

    #[test]
    fn every_bin_that_holds_something_is_a_column_and_the_ends_are_told() {
        let columns = |counts: Vec<u32>, ends| {
            let axes = ["nodes a ray".to_owned(), "pixels".to_owned()];
            let columns = Columns { title: "Teapot".to_owned(), axes, width: 2.0, counts, ends, colors: viridis };
            Drawing::Columns(columns).svg().expect("drawn")
        };
        let rects = |svg: &str| svg.matches("<rect").count();
        let svg = columns(vec![900, 0, 100, 1], [0.0, 5.0]);
        assert_eq!(rects(&svg), rects(&columns(Vec::new(), [0.0, 5.0])) + 3);
        for said in ["dark 0", "bright 5.00", "nodes a ray", "pixels", "Teapot"] {
            assert!(svg.contains(&format!("\n{said}\n")), "{said}: {svg}");
        }
        // Heights are square roots.
        let heights: Vec<f64> = svg
            .lines()
            .filter(|line| line.starts_with("<rect"))
            .filter_map(|line| line.split(" height=\"").nth(1)?.split('"').next()?.parse().ok())
            .collect();
        let tall = heights[1];
        assert!((tall / heights[2] - 3.0).abs() < 0.2 && (tall / heights[3] - 30.0).abs() < 6.0, "{heights:?}");
        // A range of no width, or nothing at all, is drawn as well.
        assert!(!columns(vec![3], [1.0, 1.0]).contains("NaN") && !columns(vec![0], [0.0, 0.0]).contains("NaN"));
    }
}
