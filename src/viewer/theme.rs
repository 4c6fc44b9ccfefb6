//! Every colour, size and gap of the window. Nothing else in `viewer` holds such a literal, so that
//! the whole look can be read, and changed, here.

mod lines;
mod marker;
mod palette;
mod ramp;

pub use lines::{DASH_PT, LineStyle, PLANE_FILL, PLANE_FILL_HIDDEN};
pub use marker::Marker;
pub use palette::{Mark, Palette};
pub use ramp::{amount_color, depth_color, heat_color};

use egui::{Color32, CornerRadius, FontFamily, FontId, Margin, Stroke, Style, TextStyle, Theme, Vec2, Visuals, style};

use eframe::egui;

/// The width of a curve in a plot.
pub const CURVE: f32 = 1.5;
/// The step that every gap is a multiple of, in points.
pub const GRID: f32 = 4.0;
/// The gap between things that belong to different groups, and around a panel's content.
pub const GUTTER: f32 = 8.0;
/// The height of a row, and the least size of anything that can be clicked.
pub const ROW: f32 = 24.0;
/// The size of most text.
pub const BODY: f32 = 13.0;
/// The size of captions and secondary lines.
pub const CAPTION: f32 = 11.0;
/// The size of headings.
pub const HEADING: f32 = 15.0;
/// The size of the few numbers that are meant to be read across a room.
pub const NUMERAL: f32 = 20.0;
/// The width of the panel at the left.
pub const LEFT_PANEL: f32 = 232.0;
/// The width of the panel at the right.
pub const RIGHT_PANEL: f32 = 280.0;
/// The height of the timings below the viewport.
pub const BOTTOM_PANEL: f32 = 184.0;
/// The width of a bar that says how far a job is, with its button beside it.
pub const RUNNING: f32 = 30.0 * GRID;
/// The height of the plots of errors below the viewport.
pub const ERROR_PANEL: f32 = 280.0;
/// The same while pictures are compared, at first.
pub const LOW_PANEL: f32 = 110.0;
/// The height of the stability lab's matrix there.
pub const MATRIX_PANEL: f32 = 320.0;
/// The width of the names of cases beside the matrix.
pub const CASE_NAME: f32 = 28.0 * GRID;
/// The width of the dark edge around rays that are drawn over the view.
pub const RAY_HALO: f32 = 3.0;
/// How much of its colour is left of what stands behind something.
pub const FAINT: f32 = 0.3;
/// A plane that somebody tries.
pub const TRIED: Color32 = Color32::from_rgb(255, 255, 255);
/// The parent that a moved node had, in the film of a build.
pub const MOVED_FROM: Color32 = Color32::from_rgb(255, 140, 105);
/// The parent that it has since.
pub const MOVED_TO: Color32 = Color32::from_rgb(120, 190, 255);
/// The plane of a section.
pub const SECTION: Color32 = Color32::from_rgb(242, 177, 52);
/// A bounding volume that somebody compares with others.
pub const COMPARED: Color32 = Color32::from_rgb(255, 140, 105);
/// A box of which an amount is not known.
pub const UNKNOWN: Color32 = Color32::from_rgb(128, 128, 128);
/// The width and height of a page of text.
pub const PAGE: f32 = 480.0;
/// The width of the card of the tour.
pub const TOUR_CARD: f32 = 80.0 * GRID;
/// What everything is enlarged by for an audience, and lines besides.
pub const PRESENTED: f32 = 1.5;
/// The width of lines for an audience.
pub const PRESENTED_LINES: f32 = 2.0;
/// The width of the list of rays beside their steps.
pub const RAY_LIST: f32 = 64.0 * GRID;
/// The height of menus that show all of their entries.
pub const LONG_MENU: f32 = 14.0 * ROW;
/// The height of the steps of a ray.
pub const STEPS_PANEL: f32 = 280.0;
/// The height of the film of a build.
pub const FILM_PANEL: f32 = 160.0;
/// The height of the row that offers one.
pub const FILM_OFFER: f32 = ROW + GUTTER;
/// The width of the tree of cells.
pub const TREE_PANEL: f32 = 336.0;
/// The height of the bar at the top.
pub const TOP_BAR: f32 = 32.0;
/// From this width on the structures and what is shown of them stand in one row above the view.
pub const ONE_ROW: f32 = 840.0;
/// Below this window width the right panel folds to a strip.
pub const FOLD_BELOW: f32 = 1100.0;
/// The size of the window at first.
pub const WINDOW: Vec2 = Vec2::new(1280.0, 800.0);
/// The least size of the window.
pub const LEAST_WINDOW: Vec2 = Vec2::new(960.0, 600.0);
/// A press that moves less than this is a click, in points.
pub const CLICK_SLACK: f32 = 4.0;
/// The width of the strip that the right panel folds to.
pub const STRIP: f32 = 40.0;
/// The width of a slider where many things stand in a row.
pub const SHORT_SLIDER: f32 = 12.0 * GRID;
/// The height of the histogram of a heat map.
pub const HISTOGRAM: f32 = 4.0 * ROW;
/// Half the width of what the ends of its colours are dragged by, and its height over the bars.
pub const HANDLE: f32 = 6.0;
/// The size of a structure's mark.
pub const MARK: f32 = 9.0;
/// The width of the line around what has the focus.
const FOCUS_RING: f32 = 2.0;
/// How often progress bars move.
pub const PROGRESS_INTERVAL: std::time::Duration = std::time::Duration::from_millis(50);
/// The height of bars in tables.
pub const BAR: f32 = 3.0;
/// How far round corners are rounded.
const CORNER: u8 = 4;

/// The text style of the large numbers.
pub fn numeral() -> TextStyle {
    TextStyle::Name("numeral".into())
}

/// Behind text that stands on a picture.
pub const fn plate(palette: &Palette) -> Color32 {
    let [r, g, b, _] = palette.background.to_array();
    Color32::from_rgba_premultiplied(r / 8 * 7, g / 8 * 7, b / 8 * 7, 224)
}

/// The line around what has the focus.
pub const fn focus_ring(palette: &Palette) -> Stroke {
    Stroke { width: FOCUS_RING, color: palette.accent_text }
}

/// Gives egui both looks, and lets it follow the system's choice.
pub fn apply(ctx: &egui::Context) {
    for theme in [Theme::Dark, Theme::Light] {
        ctx.set_style_of(theme, style_of(theme));
    }
    ctx.set_theme(egui::ThemePreference::System);
}

/// The whole style of a theme.
fn style_of(theme: Theme) -> Style {
    let mut style = Style { visuals: visuals(theme), text_styles: text_styles(), ..theme.default_style() };
    let spacing = &mut style.spacing;
    spacing.item_spacing = Vec2::new(GUTTER, GRID);
    spacing.button_padding = Vec2::new(GUTTER, GRID);
    spacing.interact_size = Vec2::new(ROW + GUTTER, ROW);
    spacing.indent = 2.0 * GUTTER;
    spacing.window_margin = Margin::same(margin(GUTTER));
    spacing.menu_margin = Margin::same(margin(GRID));
    spacing.icon_width = 4.0 * GRID;
    spacing.icon_width_inner = 2.0 * GRID;
    spacing.icon_spacing = GRID;
    spacing.slider_width = 26.0 * GRID;
    spacing.combo_width = 26.0 * GRID;
    style.interaction.tooltip_delay = 0.4;
    style.url_in_tooltip = true;
    style
}

fn text_styles() -> std::collections::BTreeMap<TextStyle, FontId> {
    let text = |size| FontId::new(size, FontFamily::Proportional);
    [
        (TextStyle::Body, text(BODY)),
        (TextStyle::Button, text(BODY)),
        (TextStyle::Small, text(CAPTION)),
        (TextStyle::Heading, text(HEADING)),
        (numeral(), text(NUMERAL)),
        (TextStyle::Monospace, FontId::new(BODY, FontFamily::Monospace)),
    ]
    .into()
}

/// A gap as the whole points that egui's margins count in.
const fn margin(gap: f32) -> i8 {
    gap as i8
}

fn visuals(theme: Theme) -> Visuals {
    let p = Palette::of(theme);
    let mut v = theme.default_visuals();
    v.panel_fill = p.panel;
    v.window_fill = p.panel;
    v.extreme_bg_color = p.background;
    v.faint_bg_color = p.stripe;
    v.code_bg_color = p.stripe;
    v.weak_text_color = Some(p.dim);
    v.warn_fg_color = p.warn;
    v.error_fg_color = p.fail;
    v.hyperlink_color = p.accent_text;
    v.window_stroke = Stroke::new(1.0, p.line);
    v.window_corner_radius = CornerRadius::same(2 * CORNER);
    v.menu_corner_radius = CornerRadius::same(CORNER);
    v.selection = style::Selection { bg_fill: p.selection, stroke: Stroke::new(1.0, p.text) };
    v.text_cursor.stroke = Stroke::new(1.5, p.text);
    v.slider_trailing_fill = true;
    v.indent_has_left_vline = false;
    v.widgets = widgets(p);
    v
}

/// Flat controls: one step of grey for each state, an outline where the pointer or the focus is.
fn widgets(p: &Palette) -> style::Widgets {
    let look = |fill: Color32, outline: Color32, text: Color32| style::WidgetVisuals {
        bg_fill: fill,
        weak_bg_fill: fill,
        bg_stroke: Stroke::new(1.0, outline),
        corner_radius: CornerRadius::same(CORNER),
        fg_stroke: Stroke::new(1.0, text),
        expansion: 0.0,
    };
    style::Widgets {
        noninteractive: look(p.panel, p.line, p.text),
        inactive: look(p.control, p.control, p.text),
        hovered: look(p.control_hovered, p.dim, p.text),
        active: look(p.selection, p.text, p.text),
        open: look(p.control_hovered, p.line, p.text),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_looks_are_set_and_the_system_chooses() {
        let ctx = egui::Context::default();
        apply(&ctx);
        for theme in [Theme::Dark, Theme::Light] {
            let style = ctx.style_of(theme);
            assert_eq!(style.visuals.dark_mode, theme == Theme::Dark);
            assert_eq!(style.visuals.panel_fill, Palette::of(theme).panel);
            assert_eq!(style.text_styles[&TextStyle::Body].size, BODY);
            assert!(style.spacing.interact_size.y >= ROW && style.spacing.interact_size.x >= ROW);
        }
    }
}
