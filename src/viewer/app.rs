//! The window: one frame after another. [`eframe::App::logic`] takes in what has finished and carries
//! out what was asked for; [`eframe::App::ui`] draws the panels, which only read and ask.

use std::sync::Arc;
use std::time::Duration;

use eframe::egui::{self, CentralPanel, Context, Frame, LayerId, Margin, Panel, Rect, RichText, ScrollArea, Ui, ViewportCommand};

use super::animation::Animation;
use super::command::Command;
use super::dialogs::{FileDialog, SystemDialog};
use super::gpu;
use super::graphics::Graphics;
use super::options::ViewerOptions;
use super::pace::Pace;
use super::panels::{self, Commands};
use super::screenshot::Screenshot;
use super::settings::{Settings, ThemeChoice, Workspace};
use super::state::State;
use super::tessellation::Tessellation;
use super::theme::{self, Palette};
use super::tour;
use super::workers::Shared;
use crate::sys::thread_time;
use crate::task::{Budget, Pool};

/// Where settings are kept in eframe's storage.
const SETTINGS: &str = "settings";
/// The layout of a window that the command line drives.
const SCRIPTED: u64 = u64::MAX;

/// The program's window.
pub struct App {
    state: State,
    commands: Commands,
    screenshot: Option<Screenshot>,
    animation: Option<Animation>,
    pace: Pace,
    /// How long this thread has worked for the present frame, besides having it drawn.
    own_work: Duration,
    /// What it takes to draw that in triangles, where the command line drives and is told of it.
    tessellation: Option<Tessellation>,
    /// Where the panels were last drawn, and in which layer, in the order of the keys.
    panels: Vec<(LayerId, Rect)>,
    /// Grows when the layout is reset: panels forget their sizes with their names.
    layout: u64,
}

impl App {
    /// Opens the window with what was asked for on the command line.
    ///
    /// # Errors
    /// If the system grants no thread.
    pub fn new(cc: &eframe::CreationContext<'_>, options: ViewerOptions) -> std::io::Result<Self> {
        Self::with_dialog(cc, options, Box::new(SystemDialog))
    }

    /// The same with another way to ask for files.
    ///
    /// # Errors
    /// If the system grants no thread.
    pub fn with_dialog(
        cc: &eframe::CreationContext<'_>,
        options: ViewerOptions,
        dialog: Box<dyn FileDialog>,
    ) -> std::io::Result<Self> {
        theme::apply(&cc.egui_ctx);
        // The enlargement is a setting of ours, under the same keys.
        cc.egui_ctx.options_mut(|o| o.zoom_with_keyboard = false);
        if let Some(render_state) = &cc.wgpu_render_state {
            gpu::install(render_state);
        }
        let stored: Option<Settings> = cc.storage.and_then(|s| eframe::get_value(s, SETTINGS));
        let mut settings = if options.is_scripted() { Settings::default() } else { stored.unwrap_or_default() };
        options.apply(&mut settings);
        let tour = options.tour.or_else(|| is_first_start(cc, &options, &settings).then_some(0));
        settings.panes.mend();

        let ctx = cc.egui_ctx.clone();
        let budget = options.memory_mib.or(settings.memory_mib).map_or_else(Budget::half_of_machine, Budget::of_mib);
        let shared = Shared::new(Pool::new("work", options.threads), budget, Arc::new(move || ctx.request_repaint()));
        let mut state = State::new(settings, shared, dialog, Graphics::of(cc.wgpu_render_state.as_ref()))?;
        state.first_camera = options.camera;
        state.first_section = options.section;
        state.unfolded = options.unfold;
        state.tradeoffs.plot = options.errors.unwrap_or_default();
        state.carry_out(Command::Open(options.model.clone().unwrap_or_else(|| tour::LECTURE.to_owned())));
        if let Some(rays) = options.rays.clone() {
            state.await_rays(rays);
        }
        if tour.is_some() {
            state.carry_out(Command::Tour(tour));
        }
        let screenshot = options.screenshot.clone().map(|path| Screenshot::new(path, &options));
        let layout = if options.is_scripted() { SCRIPTED } else { 0 };
        let animation = options.animate.clone().map(Animation::new);
        let tessellation = options.is_scripted().then(|| Tessellation::watch(&cc.egui_ctx));
        let app = Self {
            state,
            commands: Vec::new(),
            screenshot,
            animation,
            pace: Pace::default(),
            own_work: Duration::ZERO,
            tessellation,
            panels: Vec::new(),
            layout,
        };
        app.follow_settings(&cc.egui_ctx);
        Ok(app)
    }

    /// Whether the command line drives it.
    const fn is_scripted(&self) -> bool {
        self.screenshot.is_some() || self.animation.is_some()
    }

    /// What the window knows: for tests.
    pub fn state(&self) -> &State {
        &self.state
    }

    fn follow_settings(&self, ctx: &Context) {
        ctx.set_theme(match self.state.settings.theme {
            ThemeChoice::System => egui::ThemePreference::System,
            ThemeChoice::Light => egui::ThemePreference::Light,
            ThemeChoice::Dark => egui::ThemePreference::Dark,
        });
        let presented = if self.state.presenting { theme::PRESENTED } else { 1.0 };
        ctx.set_zoom_factor(self.state.settings.scale * presented);
    }

    fn carry_out(&mut self, ctx: &Context) {
        for command in std::mem::take(&mut self.commands) {
            match command {
                Command::Quit => ctx.send_viewport_cmd(ViewportCommand::Close),
                Command::FullScreen => {
                    let full = ctx.input(|i| i.viewport().fullscreen.unwrap_or(false));
                    ctx.send_viewport_cmd(ViewportCommand::Fullscreen(!full));
                }
                Command::NextPanel(forward) => panels::focus::go(ctx, &self.panels, forward),
                Command::ResetLayout => self.layout = self.layout.wrapping_add(1),
                command => self.state.carry_out(command),
            }
            self.follow_settings(ctx);
        }
    }

    /// Adds what this thread has worked since then, where the system tells it.
    fn has_worked(&mut self, since: Option<Duration>) {
        if let (Some(since), Some(now)) = (since, thread_time()) {
            self.own_work += now.saturating_sub(since);
        }
    }

    /// A file dropped anywhere on the window is opened.
    fn take_dropped(&mut self, ctx: &Context) {
        let dropped = ctx.input(|i| i.raw.dropped_files.first().map(|file| file.path().to_string_lossy().into_owned()));
        self.commands.extend(dropped.map(Command::Open));
    }

    fn panel(&self, name: &str) -> egui::Id {
        egui::Id::unique((name, self.layout))
    }

    /// Draws the panels at the left and at the right; returns where they are, and in which layer.
    fn sides(&mut self, ui: &mut Ui) -> [(LayerId, Rect); 2] {
        self.state.folds = ui.available_width() < theme::FOLD_BELOW;
        let (state, commands) = (&self.state, &mut self.commands);
        let workspace = state.settings.workspace;
        let beside = move |ui: &mut Ui, commands: &mut Commands| {
            panels::heat::show(ui, state, commands);
            match workspace {
                Workspace::View => {
                    panels::statistics::show(ui, state, commands);
                    panels::selection::show(ui, state, commands);
                    panels::brute::show(ui, state, commands);
                }
                Workspace::Structure => panels::node::show(ui, state, commands),
                Workspace::Ray => {
                    panels::ray::show(ui, state, commands);
                    panels::brute::show(ui, state, commands);
                }
                Workspace::Compare => panels::error_side::show(ui, state, commands),
                Workspace::Check => panels::check::show(ui, state, commands),
            }
        };
        let id = |name: &str| egui::Id::unique((name, self.layout));
        let left = if workspace == Workspace::Structure {
            let tree = Panel::left(id("tree")).default_size(theme::TREE_PANEL).resizable(true);
            tree.show(ui, |ui| {
                // The tree takes what the settings below it leave.
                panels::lower::show(ui, id("below the tree"), |ui| {
                    panels::overlay::show(ui, state, commands);
                    panels::section::show(ui, state, commands);
                });
                CentralPanel::no_frame().show(ui, |ui| panels::tree::show(ui, state, commands));
            })
        } else {
            Panel::left(id("left")).default_size(theme::LEFT_PANEL).resizable(true).show(ui, |ui| {
                ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                    panels::scene::show(ui, state, commands);
                    ui.separator();
                    panels::structure::show(ui, state, commands);
                    ui.separator();
                    panels::overlay::show(ui, state, commands);
                    panels::section::show(ui, state, commands);
                    panels::focus::keep_in_sight(ui);
                });
            })
        };
        let left = (ui.layer_id(), left.response.rect);
        if state.folds {
            return [left, panels::drawer::show(ui, Panel::right(id("strip")), state, commands, beside)];
        }
        let right = Panel::right(id("right")).default_size(theme::RIGHT_PANEL).resizable(true).show(ui, |ui| {
            ScrollArea::vertical().auto_shrink(false).show(ui, |ui| {
                beside(ui, commands);
                panels::focus::keep_in_sight(ui);
            });
        });
        [left, (ui.layer_id(), right.response.rect)]
    }

    /// Draws the view, and what stands below it; returns where they are.
    fn centre(&mut self, ui: &mut Ui) -> Vec<Rect> {
        let below: Option<(&str, f32, Below)> = match self.state.settings.workspace {
            Workspace::View => Some(("timings", theme::BOTTOM_PANEL, panels::timings::show)),
            Workspace::Structure if self.state.filming.film.is_some() => Some(("film", theme::FILM_PANEL, panels::film::show)),
            Workspace::Structure => self.state.has_film().then_some(("film offer", theme::FILM_OFFER, panels::film::show)),
            Workspace::Ray => Some(("steps", theme::STEPS_PANEL, panels::steps::show)),
            // Compared pictures get the room that curves of one would take.
            Workspace::Compare if self.state.is_comparing() => Some(("beside", theme::LOW_PANEL, panels::errors::show)),
            Workspace::Compare => Some(("errors", theme::ERROR_PANEL, panels::errors::show)),
            Workspace::Check => Some(("matrix", theme::MATRIX_PANEL, panels::stability::show)),
        };
        let below = below.filter(|_| !self.state.presenting).map(|(name, height, show)| (self.panel(name), height, show));
        let (state, commands) = (&self.state, &mut self.commands);
        let mut size_px = state.size_px;
        let below = below.map(|(id, height, show)| {
            Panel::bottom(id).default_size(height).resizable(true).show(ui, |ui| show(ui, state, commands)).response.rect
        });
        let view = CentralPanel::no_frame().show(ui, |ui| {
            ui.spacing_mut().item_spacing.y = 0.0;
            let bar =
                Frame::NONE.fill(ui.visuals().panel_fill).inner_margin(Margin::symmetric(theme::GUTTER as i8, theme::GRID as i8));
            bar.show(ui, |ui| {
                ui.set_width(ui.available_width());
                ScrollArea::horizontal().show(ui, |ui| {
                    panels::toolbar::show(ui, state, commands);
                    panels::focus::keep_in_sight(ui);
                });
            });
            error(ui, state, commands);
            let view = ui.available_rect_before_wrap();
            size_px = panels::viewport::show(ui, state, commands);
            panels::tour::show(ui, view, state, commands);
        });
        self.state.size_px = size_px;
        std::iter::once(view.response.rect).chain(below).collect()
    }
}

/// Whether nobody has used the program yet, as far as it remembers: a window that remembers nothing shows no tour, nor one
/// that was asked for a model.
fn is_first_start(cc: &eframe::CreationContext<'_>, options: &ViewerOptions, settings: &Settings) -> bool {
    let used = settings.toured || !settings.recent.is_empty();
    cc.storage.is_some() && !used && options.model.is_none() && !options.is_scripted()
}

/// Draws a panel below the view.
type Below = fn(&mut Ui, &State, &mut Commands);

/// Whether this is the second pass over a frame, with the same input: what the hands did to the camera
/// in the first is to be seen in this frame, not in the next.
fn is_repeated(ctx: &Context) -> bool {
    ctx.current_pass_index() > 0
}

/// The message that something went wrong, until it is put away.
fn error(ui: &mut Ui, state: &State, commands: &mut Commands) {
    let Some(error) = &state.error else { return };
    let palette = Palette::in_ui(ui);
    Frame::NONE.fill(palette.stripe).inner_margin(Margin::same(theme::GUTTER as i8)).show(ui, |ui| {
        ui.horizontal(|ui| {
            ui.with_layout(egui::Layout::right_to_left(egui::Align::Center), |ui| {
                if ui.button("Dismiss").clicked() {
                    commands.push(Command::Dismiss);
                }
                ui.with_layout(egui::Layout::left_to_right(egui::Align::Center), |ui| {
                    let text = ui.add(egui::Label::new(RichText::new(format!("× {error}")).color(palette.fail)).wrap());
                    panels::announce::at_once(&text);
                });
            });
        });
    });
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &Context, _: &mut eframe::Frame) {
        let start = thread_time();
        if !is_repeated(ctx) {
            let tessellated = self.tessellation.as_ref().map_or(Duration::ZERO, Tessellation::take);
            self.pace.own_work(std::mem::take(&mut self.own_work) + tessellated);
            self.take_dropped(ctx);
            panels::menu::keys(ctx, &self.state, &mut self.commands);
            panels::focus::dividers(ctx);
        }
        if !self.is_scripted() {
            let hidden = |i: &egui::InputState| i.viewport().minimized == Some(true) || i.viewport().occluded == Some(true);
            self.state.hide(ctx.input(hidden));
        }
        self.carry_out(ctx);
        self.state.advance();
        if let Some(screenshot) = self.screenshot.as_mut().filter(|_| !is_repeated(ctx)) {
            screenshot.advance(ctx, &self.state, &mut self.pace, &mut self.commands);
        }
        if let Some(animation) = self.animation.as_mut().filter(|_| !is_repeated(ctx)) {
            animation.advance(ctx, &self.state, &mut self.commands);
        }
        if let Some(due) = self.state.play_on() {
            ctx.request_repaint_after(due);
        }
        if let Some(due) = self.state.play_film_on() {
            ctx.request_repaint_after(due);
        }
        // Progress bars move; everything else wakes the window itself.
        let state = &self.state;
        let measured = state.is_measuring() || state.is_checking() || state.brute.running.is_some();
        let made = state.pane_in_building().is_some() || state.ray_list.progress().is_some() || state.rays.following.is_some();
        if state.loading.is_some() || state.building.is_some() || measured || made {
            ctx.request_repaint_after(theme::PROGRESS_INTERVAL);
        }
        self.has_worked(start);
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        let start = thread_time();
        let ui_secs = frame.info().cpu_usage.map(f64::from);
        if !is_repeated(ui.ctx()) {
            self.pace.frame(ui_secs, &self.state);
        }
        let menu = Panel::top(self.panel("menu"))
            .exact_size(theme::TOP_BAR)
            .show(ui, |ui| panels::menu::show(ui, &self.state, &mut self.commands));
        let status = Panel::bottom(self.panel("status")).exact_size(theme::ROW).show(ui, |ui| {
            panels::status::show(ui, &self.state, ui_secs, &mut self.commands);
        });
        let sides = (!self.state.presenting).then(|| self.sides(ui));
        let (left, right) = (sides.map(|sides| sides[0]), sides.map(|sides| sides[1]));
        let centre = self.centre(ui);
        let here = |rect| (ui.layer_id(), rect);
        let inner = left.into_iter().chain(centre.into_iter().map(here)).chain(right);
        self.panels = std::iter::once(here(menu.response.rect)).chain(inner).chain([here(status.response.rect)]).collect();
        panels::terms::show(ui, &self.state, &mut self.commands);
        panels::help::show(ui, &self.state, &mut self.commands);
        panels::preferences::show(ui, &self.state, &mut self.commands);
        panels::path::show(ui, &self.state, &mut self.commands);
        panels::palette::show(ui, &self.state, &mut self.commands);
        panels::focus::show(ui);
        if is_repeated(ui.ctx()) {
            // The same hands were seen in the first pass.
            self.commands.clear();
        } else if self.commands.iter().any(|command| matches!(command, Command::Camera(_))) {
            ui.ctx().request_discard("the camera moved");
        }
        if !self.commands.is_empty() {
            ui.ctx().request_repaint();
        }
        self.has_worked(start);
    }

    /// A scripted window neither leaves its sizes to the next one nor, under names of its own, takes those of the last.
    fn persist_egui_memory(&self) -> bool {
        !self.is_scripted()
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        if !self.is_scripted() {
            eframe::set_value(storage, SETTINGS, &self.state.settings);
        }
    }
}
