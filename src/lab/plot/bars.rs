//! Bars from nothing to what was measured, one beneath the other, with their spread.

use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

use super::axis::{LABELS, even};
use super::colors::colors_of;
use super::{Area, Failed, TEXT, plain};
use crate::geometry::num;
use crate::lab::format;

/// One thing, of several.
#[derive(Clone, Debug)]
pub struct Bars {
    /// What it shows.
    pub title: String,
    /// What is along the axis, with its unit.
    pub axis: &'static str,
    /// From above.
    pub bars: Vec<Bar>,
}

/// A bar.
#[derive(Clone, Debug)]
pub struct Bar {
    /// The id of the structure whose colour it has.
    pub id: String,
    /// What it is called.
    pub name: String,
    /// How long it is; not a number where that is not known: then there is none.
    pub length: f64,
    /// How far that may be off, to either side; nothing where it cannot be.
    pub spread: f64,
    /// What is said beside it: why there is none, if so.
    pub note: String,
}

/// What stands to the left of the bars, in pixels.
const NAMES: i32 = 120;
/// The part of its row that a bar leaves free above and below itself.
const GAP: f64 = 0.2;
/// Half of the height of the ends of a spread, in pixels.
const END: i32 = 5;
/// What is left free around a panel, in pixels.
const MARGIN: i32 = 12;
/// What is left free between a bar and its figure, in pixels.
const BESIDE: i32 = 8;
/// The height of figures and names.
const SMALL: i32 = TEXT - 2;
/// About what a character of them takes, in pixels: rather more than less.
const CHARACTER: f64 = 0.5 * SMALL as f64;
/// The part of the axis that a figure may take, so that bars stay to be seen; a longer one is cut.
const SAID: f64 = 0.6;

impl Bar {
    fn is_known(&self) -> bool {
        self.length.is_finite()
    }

    /// Where its figure begins on the axis.
    fn end(&self) -> f64 {
        if self.is_known() { self.length.max(0.0) + self.spread.max(0.0) } else { 0.0 }
    }

    /// The figure that stands at its end, where the axis has so many pixels.
    fn said(&self, pixels: f64) -> String {
        let note = if self.note.is_empty() { String::new() } else { format!(" {}", self.note) };
        let spread =
            if self.spread > 0.0 && self.is_known() { format!(" ±{}", format::number(self.spread)) } else { String::new() };
        let said = plain(&format!("{}{spread}{note}", format::number(self.length)));
        let most = num::floor_index(SAID * pixels / CHARACTER, usize::MAX);
        if said.chars().count() <= most {
            return said;
        }
        said.chars().take(most.saturating_sub(1)).chain(std::iter::once('…')).collect()
    }
}

/// How far an axis of so many pixels goes: every figure has room beside its bar.
fn end_of_axis(bars: &[Bar], pixels: f64) -> f64 {
    let needs = |bar: &Bar| {
        let free = pixels - f64::from(BESIDE) - CHARACTER * bar.said(pixels).chars().count() as f64;
        bar.end() * pixels / free.max(1.0)
    };
    let end = bars.iter().map(needs).fold(0.0, f64::max);
    if end > 0.0 { end } else { 1.0 }
}

/// Draws a panel.
pub(super) fn draw(area: &Area<'_>, panel: &Bars) -> Result<(), Failed> {
    let (rows, text) = (panel.bars.len().max(1) as f64, ("sans-serif", TEXT));
    let pixels = f64::from(area.dim_in_pixel().0) - f64::from(2 * MARGIN + NAMES);
    let axis = 0.0..end_of_axis(&panel.bars, pixels);
    let mut builder = ChartBuilder::on(area);
    builder.caption(&panel.title, ("sans-serif", TEXT + 3)).margin(MARGIN).x_label_area_size(44).y_label_area_size(NAMES);
    let mut chart = builder.build_cartesian_2d(axis.clone(), 0.0..rows)?;
    let labels = even(axis);
    let mesh = &mut chart.configure_mesh();
    mesh.disable_y_mesh().x_labels(LABELS).y_labels(0).x_label_formatter(&labels);
    mesh.x_desc(panel.axis).label_style(text).axis_desc_style(text);
    mesh.light_line_style(BLACK.mix(0.04)).bold_line_style(BLACK.mix(0.12)).draw()?;
    let ids: Vec<&str> = panel.bars.iter().map(|bar| &bar.id[..]).collect();
    let beside = |side| TextStyle::from(("sans-serif", SMALL)).pos(Pos::new(side, VPos::Center));
    for ((i, bar), color) in panel.bars.iter().enumerate().zip(colors_of(&ids)) {
        let (low, middle) = (rows - 1.0 - i as f64, rows - 0.5 - i as f64);
        let name = EmptyElement::at((0.0, middle)) + Text::new(bar.name.clone(), (-BESIDE, 0), beside(HPos::Right));
        chart.draw_series(std::iter::once(name))?;
        let length = if bar.is_known() { bar.length.max(0.0) } else { 0.0 };
        if bar.is_known() {
            let corners = [(0.0, low + GAP), (length, low + 1.0 - GAP)];
            chart.draw_series(std::iter::once(Rectangle::new(corners, color.filled())))?;
        }
        let spread = if bar.is_known() { bar.spread.max(0.0) } else { 0.0 };
        if spread > 0.0 {
            let (from, to) = ((length - spread).max(0.0), length + spread);
            chart.draw_series(LineSeries::new([(from, middle), (to, middle)], BLACK))?;
            let end = |x| EmptyElement::at((x, middle)) + PathElement::new([(0, -END), (0, END)], BLACK);
            chart.draw_series([from, to].into_iter().map(end))?;
        }
        let said = EmptyElement::at((bar.end(), middle)) + Text::new(bar.said(pixels), (BESIDE, 0), beside(HPos::Left));
        chart.draw_series(std::iter::once(said))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::super::Drawing;
    use super::*;

    fn bar(id: &str, length: f64, spread: f64, note: &str) -> Bar {
        Bar { id: id.to_owned(), name: format!("<{id}>"), length, spread, note: note.to_owned() }
    }

    #[test]
    fn bars_are_as_long_as_their_figures_which_stand_beside_them() {
        let bars = vec![bar("bvh", 4.0, 0.0, ""), bar("grid", 2.0, 0.5, "of a part"), bar("bsp", f64::NAN, 0.5, "too large")];
        let empty = Bars { title: "Rays & time".to_owned(), axis: "1e6 rays a second", bars: Vec::new() };
        let panel = Bars { bars, ..empty.clone() };
        let drawn = |panel: Bars| Drawing::Bars(vec![panel]).svg().expect("drawn");
        let mut exact = panel.clone();
        exact.bars.iter_mut().for_each(|bar| bar.spread = 0.0);
        let (without, svg) = (drawn(empty), drawn(panel));
        let widths = |svg: &str| -> Vec<f64> {
            let rects = svg.lines().filter(|line| line.starts_with("<rect"));
            let width = |line: &str| line.split(" width=\"").nth(1)?.split('"').next()?.parse().ok();
            rects.filter_map(width).collect()
        };
        let wide = widths(&svg);
        let [.., long, short] = wide[..] else { panic!("{wide:?}") };
        assert_eq!(wide.len(), widths(&without).len() + 2, "what is not known has none");
        assert!((long / short - 2.0).abs() < 0.05, "{long} {short}");
        for said in ["4.00", "2.00 ±0.500 of a part", "– too large", "1e6 rays a second", "&lt;bvh&gt;", "&lt;bsp&gt;"] {
            assert!(svg.contains(&format!("\n{said}\n")), "{said}: {svg}");
        }
        assert!(svg.contains("Rays &amp; time") && !svg.contains("NaN"));
        let lines = |svg: &str| svg.matches("<polyline").count();
        assert_eq!(lines(&svg), lines(&drawn(exact)) + 3, "a spread is a line with two ends");
    }

    #[test]
    fn no_figure_runs_out_of_the_picture_however_long_its_note_is() {
        let sentence = "the structure would take 12 GiB, which is more than there is, so leave something out or raise the limit";
        let notes = ["", "a part of the rays", sentence];
        let bars = notes.map(|note| bar("bvh", 1234.0, 56.7, note)).into_iter().chain([bar("bsp", f64::NAN, 0.0, sentence)]);
        let panel = Bars { title: "Rays".to_owned(), axis: "rays", bars: bars.collect() };
        let svg = Drawing::Bars(vec![panel]).svg().expect("drawn");
        let number = |text: &str, name: &str| -> Option<f64> {
            text.split(&format!(" {name}=\"")).nth(1)?.split('"').next()?.parse().ok()
        };
        let mut figures = 0;
        for text in svg.split("<text").skip(1).filter(|text| text.contains("text-anchor=\"start\"")) {
            let (x, height) = number(text, "x").zip(number(text, "font-size")).expect("said");
            let said = text.split('>').nth(1).and_then(|said| said.split('<').next()).expect("text").trim();
            let end = x + 0.6 * height * said.chars().count() as f64;
            assert!(end < f64::from(super::super::SIZE.0), "{said} ends at {end}");
            figures += 1;
        }
        assert_eq!((figures, svg.matches('…').count()), (4, 2), "{svg}");
        assert!(svg.contains("a part of the rays\n"), "a short one is whole");
    }
}
