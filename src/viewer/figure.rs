//! The view as a figure: traced pictures, as they stand in the window, with boxes, planes, other forms and rays over them as lines,
//! what their colours stand for, and captions that say what they show.

mod clip;
mod drawing;
mod place;
#[cfg(test)]
mod tests;
mod words;

use std::fmt::Write;
use std::sync::Arc;

use super::compared::{self, Shown};
use super::format;
use super::gpu::{Overlay, View};
use super::legends::{self, Heat};
use super::panes::LETTERS;
use super::rays_over;
use super::state::State;
use super::theme::{self, LineStyle};
use crate::accel::cell;
use crate::render::{self, Picture};
use crate::task::Cancel;
use drawing::Drawing;
use place::{Layout, Place};
use words::{about, escaped, wrapped};

/// What is drawn.
pub struct Figure {
    /// A first; nothing where there is no picture yet.
    drawings: Vec<Option<Drawing>>,
    layout: Layout,
    /// Columns and rows of a view.
    view: [u32; 2],
    /// What is written on strips.
    names: Vec<String>,
    /// What is written beneath each of compared pictures.
    captions: Vec<String>,
    /// What colours stand for.
    legends: Vec<Heat>,
    /// What is written beneath all.
    caption: String,
}

/// The distance of lines beneath a picture.
const SMALL_LINE: f32 = 4.0 * theme::GRID;
/// The same of the caption.
const LINE: f32 = 5.0 * theme::GRID;
/// What a caption takes besides.
const MARGIN: f32 = 2.0 * theme::GRID;

impl Figure {
    /// What is on the screen; `None` while there is no picture.
    pub fn of(state: &State) -> Option<Self> {
        state.model.as_ref()?;
        state.on_screen()?;
        let shown = compared::shown(state);
        let drawings = shown.iter().enumerate().map(|(which, shown)| drawing(state, which, shown)).collect();
        let panes = &state.settings.panes;
        let view = state.size_px.map(|side| side.max(1));
        let alone = Self {
            drawings,
            layout: Layout::Alone,
            view,
            names: Vec::new(),
            captions: Vec::new(),
            legends: legends::heat(state).into_iter().collect(),
            caption: caption(state),
        };
        if !state.is_comparing() {
            return Some(alone);
        }
        let structures = compared::names(state);
        let captions = shown.iter().enumerate().map(|(which, shown)| {
            let facts = compared::facts(state, which, &structures);
            format!("{}: {}. {facts}", LETTERS[which], what(which, shown))
        });
        Some(Self {
            layout: Layout::of(panes.arrange, panes.places()),
            captions: captions.collect(),
            names: structures.iter().zip(LETTERS).map(|(name, letter)| format!("{letter}: {name}")).collect(),
            legends: compared::heats(state).into_iter().map(|(_, heat)| heat).collect(),
            ..alone
        })
    }

    /// As SVG.
    ///
    /// # Errors
    /// In words; there is none that ordinary pictures give, but that it was stopped.
    pub fn svg(&self, cancel: &Cancel) -> Result<Vec<u8>, String> {
        let view = self.view.map(|side| side as f32);
        let beneath = self.beneath();
        let places = self.layout.places(view, beneath);
        let [across, pictures] = self.layout.size(view, beneath);
        let width = across.max(words::page_of(&self.legends));
        let lines = wrapped(&self.caption, width - 2.0 * theme::GUTTER, theme::BODY);
        let legends = words::legends_height(&self.legends, width);
        let height = pictures + legends + MARGIN + LINE * lines.len() as f32;
        let mut out = format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" viewBox=\"0 0 {width} {height}\">\n\
             <title>{}</title>\n<rect width=\"{width}\" height=\"{height}\" fill=\"white\"/>\n",
            escaped(&self.caption)
        );
        for (which, place) in places.iter().enumerate() {
            self.part(which, place, &mut out, cancel)?;
        }
        if matches!(self.layout, Layout::Strips(_)) {
            places.iter().skip(1).for_each(|place| divider(place.columns[0], view[1], &mut out));
        }
        words::legends(&mut out, &self.legends, width, pictures);
        for (i, text) in lines.iter().enumerate() {
            let base = pictures + legends + MARGIN + LINE * (i as f32 + 0.5);
            words::line(&mut out, [theme::GUTTER, base], theme::BODY, text);
        }
        out.push_str("</svg>\n");
        Ok(out.into_bytes())
    }

    /// The height of what is written beneath each picture.
    fn beneath(&self) -> f32 {
        let view = self.view.map(|side| side as f32);
        let places = self.layout.places(view, 0.0);
        let most = places.iter().enumerate().map(|(which, place)| self.lines_of(which, place).len()).max().unwrap_or(0);
        if most == 0 { 0.0 } else { MARGIN + SMALL_LINE * most as f32 }
    }

    /// What is written beneath a picture.
    fn lines_of(&self, which: usize, place: &Place) -> Vec<String> {
        let text = self.captions.get(which).map_or("", String::as_str);
        wrapped(text, place.text[1] - 2.0 * theme::GRID, theme::CAPTION)
    }

    /// A picture in its place, and nothing beyond it.
    fn part(&self, which: usize, place: &Place, out: &mut String, cancel: &Cancel) -> Result<(), String> {
        let height = self.view[1] as f32;
        let ([x, y], [from, to]) = (place.at, place.columns);
        // A strip without a picture shows the first, as in the window.
        let instead = self.drawings.first().filter(|_| matches!(self.layout, Layout::Strips(_)));
        let drawing = self.drawings.get(which).and_then(Option::as_ref).or_else(|| instead.and_then(Option::as_ref));
        if let Some(drawing) = drawing.filter(|_| to > from) {
            let (left, width) = (x + from, to - from);
            // What is drawn beyond the sides of an inner picture is cut off.
            let _ = writeln!(
                out,
                "<svg x=\"{left}\" y=\"{y}\" width=\"{width}\" height=\"{height}\" viewBox=\"{from} 0 {width} {height}\">"
            );
            drawing.write(out, cancel)?;
            if let Some(name) = self.names.get(which).filter(|_| matches!(self.layout, Layout::Strips(_))) {
                plate(from + theme::GUTTER, name, out);
            }
            out.push_str("</svg>\n");
        }
        for (i, text) in self.lines_of(which, place).iter().enumerate() {
            let base = y + height + SMALL_LINE * (i + 1) as f32;
            words::line(out, [place.text[0] + theme::GRID, base], theme::CAPTION, text);
        }
        Ok(())
    }
}

/// What a picture shows, without its structure.
fn what(which: usize, shown: &Shown<'_>) -> String {
    let label = shown.mode.label().to_lowercase();
    if shown.differs { format!("{label}, {} less {}", LETTERS[0], LETTERS[which]) } else { label }
}

/// A picture with what lies over it.
fn drawing(state: &State, which: usize, shown: &Shown<'_>) -> Option<Drawing> {
    let (model, picture) = (state.model.as_ref()?, shown.picture?);
    let size = state.size_px.map(|side| side.max(1));
    let space = *model.geometry.space();
    let section = state.section().map(|section| section.scaled(&space));
    let (overlay, marks): (Option<Arc<Overlay>>, _) = match which.checked_sub(1) {
        None => (state.shown.as_ref().and(state.overlay.clone()), rays_over::marks(state).into_owned()),
        Some(other) => (state.panes.all.get(other).and_then(|pane| pane.overlay.clone()), Vec::new()),
    };
    Some(Drawing {
        picture: Arc::clone(picture),
        overlay,
        marks,
        view: View::new(&picture.camera, &space, size[0] as f32 / size[1] as f32).within(section),
        space,
        size,
        begin: state.boxes_begin(),
        hidden_lines: state.settings.overlay.hidden_lines,
    })
}

/// The line between two strips.
fn divider(x: f32, height: f32, out: &mut String) {
    let [r, g, b] = LineStyle::BOX.halo;
    for (width, color) in [(theme::RAY_HALO, format!("#{r:02x}{g:02x}{b:02x}")), (1.0, "white".to_owned())] {
        let _ = writeln!(out, "<path d=\"M{x} 0V{height}\" stroke=\"{color}\" stroke-width=\"{width}\"/>");
    }
}

/// A name over a picture.
fn plate(x: f32, name: &str, out: &mut String) {
    let width = about(name.chars().count(), theme::BODY) + theme::GUTTER;
    let (top, height) = (theme::GUTTER, LINE);
    let _ =
        writeln!(out, "<rect x=\"{x}\" y=\"{top}\" width=\"{width}\" height=\"{height}\" fill=\"white\" fill-opacity=\"0.8\"/>");
    words::line(out, [x + theme::GRID, top + 0.7 * height], theme::BODY, name);
}

/// `BVH, boxes at depth 3, SAH cost 31.2. builtin:teapot, 1 000 triangles.`; while a film of the build is shown, where that stands
/// and the cost there.
fn caption(state: &State) -> String {
    let overlay = &state.settings.overlay;
    let mut text = match &state.shown {
        Some(_) if state.is_comparing() => {
            let names = compared::names(state).into_iter().zip(LETTERS).map(|(name, letter)| format!("{letter}: {name}"));
            names.collect::<Vec<_>>().join("; ")
        }
        Some(shown) => shown.key.entry.name.to_owned(),
        None => String::new(),
    };
    let is_tree = !matches!(state.layout(), Some(cell::Layout::Flat { .. } | cell::Layout::Nested { .. }));
    let film = state.film_on_screen();
    if let Some((film, at)) = film {
        let order = film.order_at(at).to_lowercase();
        let [at, last] = [at, film.last()].map(|event| format::count(event.into()));
        text += &format!(", {order}, event {at} of {last}");
    } else if overlay.boxes && overlay.leaves_only {
        text += ", boxes of leaves";
    } else if overlay.boxes && is_tree {
        let to = overlay.depth;
        text += &match overlay.from_depth {
            from if from < to => format!(", boxes at depths {from} to {to}"),
            _ => format!(", boxes at depth {to}"),
        };
    } else if overlay.boxes {
        text += ", cells";
    }
    // Of compared ones each has its own.
    let finished = state.shown.as_ref().and_then(|shown| shown.stats.as_ref()).map(|stats| stats.sah);
    let finished = finished.filter(|_| !state.is_comparing());
    if let Some(cost) = film.map(|(film, at)| film.cost(at)).or(finished) {
        text += &format!(", SAH cost {}", format::number(cost));
    }
    if let Some(model) = &state.model {
        text += &format!(". {}, {} triangles.", model.scene.name, format::count(model.geometry.counts().live));
    }
    text
}

/// The bytes of a picture as a PNG file.
///
/// # Errors
/// In words; there is none that an ordinary picture gives.
pub fn png(picture: &Picture) -> Result<Vec<u8>, String> {
    encoded(&picture.rgba, [picture.width, picture.height])
}

/// The same of four bytes a pixel, as [`render::png`] takes them.
///
/// # Errors
/// In words, if there are not as many bytes.
pub fn encoded(rgba: &[u8], size: [u32; 2]) -> Result<Vec<u8>, String> {
    render::png(rgba, size).map_err(|why| format!("Can't make the picture: {why}."))
}
