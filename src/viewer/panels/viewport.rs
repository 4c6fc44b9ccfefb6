//! The 3D view: the picture with boxes over it, and the hands.

use std::sync::Arc;

use eframe::egui::{self, Key, PointerButton, Pos2, Rect, Response, Role, Sense, Ui, UiBuilder, WidgetInfo};
use glam::Vec2;

use super::split::{self, Place};
use super::{Commands, captions, marking, panes};
use crate::scene::Camera;
use crate::viewer::command::Command;
use crate::viewer::gpu::{self, Base, DrawList, Raster, View};
use crate::viewer::navigation;
use crate::viewer::panes::{Arrange, MOST};
use crate::viewer::rays_over;
use crate::viewer::settings::{Navigation, Workspace};
use crate::viewer::state::State;
use crate::viewer::theme::{self, Palette};

/// The names of the views among viewports, that of the shown structure first.
const PANES: [gpu::PaneId; MOST] = [0, 1, 2, 3];
/// What an arrow key turns, in points of dragging.
const KEY_STEP: f32 = 24.0;
/// What a key zooms, in points of the wheel.
const KEY_ZOOM: f32 = 60.0;

/// Draws the view, or compared views; returns the size in pixels that each of them has.
pub fn show(ui: &mut Ui, state: &State, commands: &mut Commands) -> [u32; 2] {
    let (rect, response) = ui.allocate_exact_size(ui.available_size(), Sense::click_and_drag());
    response.widget_info(|| WidgetInfo::labeled(Role::Canvas, true, "3D viewport"));
    // What changes with every picture is no part of the name, or a screen reader would begin anew.
    ui.ctx().accesskit_node_builder(response.id, |node| node.set_description(captions::describe(state)));
    if response.clicked() || response.drag_started() {
        response.request_focus();
    }
    let pixels_per_point = ui.ctx().pixels_per_point();
    let compared = Some(&state.settings.panes).filter(|_| state.is_comparing());
    let places = split::places(rect, compared, pixels_per_point);
    // All views are seen by one camera: what is under the pointer in one of them is so in each.
    let under = |at: Pos2| places.iter().find(|place| place.seen.contains(at)).map(|place| place.view);
    let view = places[0].view;
    let size_px = gpu::size_px(view, pixels_per_point);
    paint(ui, rect, &places, state, (size_px, pixels_per_point));
    if response.has_focus() {
        let stroke = egui::Stroke::new(1.0, Palette::in_ui(ui).accent_text);
        ui.painter().rect_stroke(rect, 0.0, stroke, egui::StrokeKind::Inside);
    }
    if compared.is_none() {
        captions::show(ui, view, response.hover_pos(), state);
    } else {
        let mut over = ui.new_child(UiBuilder::new().max_rect(view));
        over.shrink_clip_rect(view); // they belong to one of several views
        captions::show(&over, view, None, state);
        split::dividers(ui, &places, state, commands);
        let pointer = response.hover_pos().and_then(|at| under(at).map(|view| (view, in_picture(view, at))));
        panes::show(ui, &places, pointer, state, commands);
    }
    if matches!(state.settings.workspace, Workspace::View | Workspace::Ray) {
        marking::show(ui, view, &state.brute);
    }
    if state.brute.marking {
        marking::hands(ui, &response, view, size_px, commands);
    } else {
        marking::forget(ui, &response);
        if let Some(at) = response.interact_pointer_pos().filter(|_| response.clicked())
            && let Some(view) = under(at)
        {
            commands.push(clicked(at, view, state));
        }
    }
    let view = response.hover_pos().and_then(under).unwrap_or(view);
    if let Some(camera) = hands(ui, &response, view, state) {
        commands.push(Command::Camera(camera));
    }
    size_px
}

/// What a click asks for: what is there, or why it differs where that is marked.
fn clicked(at: Pos2, view: Rect, state: &State) -> Command {
    let marked = marking::near(at, view, &state.brute).filter(|_| state.can_compare_with_brute_force());
    marked.map_or(Command::Pick(in_picture(view, at)), Command::FollowUnlike)
}

fn paint(ui: &Ui, rect: Rect, places: &[Place], state: &State, (size_px, pixels_per_point): ([u32; 2], f32)) {
    let palette = Palette::in_ui(ui);
    ui.painter().rect_filled(rect, 0.0, palette.background);
    let Some(model) = &state.model else { return };
    // A picture and the boxes over it are of one view, also while the next picture is on its way.
    let camera = state.picture.as_ref().map_or(state.camera, |p| p.camera);
    let base = match state.on_screen() {
        Some(picture) => Base::Picture(Arc::clone(picture)),
        // The preview would show what is hidden.
        None if state.visible().is_some() => Base::Nothing,
        None => Base::Raster(Raster {
            mesh: Arc::clone(&model.raster),
            color: palette.preview.to_array(),
            max_triangles: state.preview_limit(),
        }),
    };
    let overlay = state.shown.as_ref().and(state.overlay.clone());
    let section = state.section().map(|section| section.scaled(model.geometry.space()));
    let view = View::new(&camera, model.geometry.space(), size_px[0] as f32 / size_px[1] as f32).within(section);
    // For an audience lines are twice as wide, and everything is enlarged already.
    let lines = if state.presenting { theme::PRESENTED_LINES / theme::PRESENTED } else { 1.0 };
    let list = DrawList {
        view,
        size_px,
        pixels_per_point: pixels_per_point * lines,
        background: palette.background.to_array(),
        base,
        overlay,
        begin: state.boxes_begin(),
        hidden_lines: state.settings.overlay.hidden_lines,
    };
    let Place { view: rect, .. } = places[0];
    // Strips that have no picture yet show the first.
    let seen = if state.settings.panes.arrange == Arrange::Divider { rect } else { places[0].seen };
    gpu::paint(&ui.painter_at(seen), rect, PANES[0], list.clone());
    if state.is_comparing() {
        others(ui, places, state, &list);
    } else if list.begin > 0.0 {
        let begin = rect.left() + list.begin * rect.width();
        ui.painter().vline(begin, rect.y_range(), egui::Stroke::new(1.0, palette.text));
    }
    let marks = rays_over::marks(state);
    rays_over::paint(&ui.painter_at(rect), rect, &marks, &view, model.geometry.space(), palette);
    let (there, all) = model.raster.progress();
    if state.picture.is_none() && there < all {
        ui.ctx().request_repaint();
    }
}

/// Draws the pictures of other structures, each with its own boxes.
fn others(ui: &Ui, places: &[Place], state: &State, first: &DrawList) {
    let Some(model) = &state.model else { return };
    let aspect = first.size_px[0] as f32 / first.size_px[1] as f32;
    let panes = state.panes.all.iter().zip(state.settings.panes.on_screen());
    for (((pane, choice), place), id) in panes.zip(&places[1..]).zip(&PANES[1..]) {
        let Some(picture) = pane.on_screen(choice.differs(state.settings.mode)) else { continue };
        let list = DrawList {
            view: View::new(&picture.camera, model.geometry.space(), aspect).within(first.view.section),
            base: Base::Picture(Arc::clone(picture)),
            overlay: pane.overlay.clone(),
            ..first.clone()
        };
        gpu::paint(&ui.painter_at(place.seen), place.view, *id, list);
    }
}

/// Where the hands take the camera, if they do.
fn hands(ui: &Ui, response: &Response, rect: Rect, state: &State) -> Option<Camera> {
    state.model.as_ref()?;
    let height = rect.height();
    // While a rectangle is marked drags are not the camera's.
    let orbited = if state.brute.marking { None } else { dragged(ui, response, state, height) };
    orbited.or_else(|| wheel(ui, response, rect, state)).or_else(|| typed(ui, response, state, rect))
}

/// A drag is worked out from where it began, so that a slow frame loses none of it.
fn dragged(ui: &Ui, response: &Response, state: &State, height: f32) -> Option<Camera> {
    let id = response.id.with("camera at start of drag");
    let total = response.total_drag_delta()?;
    let start: Camera = ui.data_mut(|d| {
        if response.drag_started() {
            d.insert_temp(id, state.camera);
        }
        d.get_temp(id).unwrap_or(state.camera)
    });
    if total.length() < theme::CLICK_SLACK {
        return None;
    }
    let shift = ui.input(|i| i.modifiers.shift);
    let by = |button| response.dragged_by(button);
    let delta = Vec2::new(total.x, total.y);
    let orbit = |go: bool| go.then(|| navigation::orbit(&start, delta, height));
    let pan = |go: bool| go.then(|| navigation::pan(&start, delta, height));
    match state.settings.navigation {
        Navigation::Standard => {
            pan(by(PointerButton::Middle) || (by(PointerButton::Primary) && shift)).or_else(|| orbit(by(PointerButton::Primary)))
        }
        Navigation::Blender => pan(by(PointerButton::Middle) && shift).or_else(|| orbit(by(PointerButton::Middle))),
    }
}

fn wheel(ui: &Ui, response: &Response, rect: Rect, state: &State) -> Option<Camera> {
    let pointer = response.hover_pos()?;
    let (scroll, pinch) = ui.input(|i| (i.smooth_scroll_delta().y, i.zoom_delta()));
    let at = in_picture(rect, pointer);
    let aspect = rect.width() / rect.height();
    if pinch != 1.0 {
        return Some(navigation::zoom_by(1.0 / pinch, &state.camera, at, aspect));
    }
    (scroll != 0.0).then(|| navigation::zoom(&state.camera, scroll, at, aspect))
}

/// A point of the window in the picture: (-1, -1) lower left, (1, 1) upper right.
fn in_picture(rect: Rect, at: Pos2) -> Vec2 {
    Vec2::new((at.x - rect.center().x) / rect.width(), (rect.center().y - at.y) / rect.height()) * 2.0
}

/// Arrows and plus and minus, while the viewport has the focus.
fn typed(ui: &Ui, response: &Response, state: &State, rect: Rect) -> Option<Camera> {
    if !response.has_focus() {
        return None;
    }
    let lock = egui::EventFilter { horizontal_arrows: true, vertical_arrows: true, ..Default::default() };
    ui.memory_mut(|m| m.set_focus_lock_filter(response.id, lock));
    let pressed = |key| ui.input(|i| i.key_pressed(key));
    let turns = [
        (Key::ArrowLeft, Vec2::new(KEY_STEP, 0.0)),
        (Key::ArrowRight, Vec2::new(-KEY_STEP, 0.0)),
        (Key::ArrowUp, Vec2::new(0.0, KEY_STEP)),
        (Key::ArrowDown, Vec2::new(0.0, -KEY_STEP)),
    ];
    if let Some((_, delta)) = turns.into_iter().find(|(key, _)| pressed(*key)) {
        return Some(navigation::orbit(&state.camera, delta, rect.height()));
    }
    let aspect = rect.width() / rect.height();
    let zoom = |scroll| navigation::zoom(&state.camera, scroll, Vec2::ZERO, aspect);
    let plain = ui.input(|i| i.modifiers.is_none() || i.modifiers.shift_only());
    let closer = pressed(Key::Plus) || pressed(Key::Equals);
    (plain && closer).then(|| zoom(KEY_ZOOM)).or_else(|| (plain && pressed(Key::Minus)).then(|| zoom(-KEY_ZOOM)))
}
