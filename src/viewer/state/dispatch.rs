//! What each command does: one line a command; what takes more is a method beside what it is about.

use std::time::Instant;

use super::State;
use crate::viewer::command::Command;
use crate::viewer::history::{Choices, Kind};
use crate::viewer::navigation;
use crate::viewer::pick::Picked;
use crate::viewer::settings::Workspace;

impl State {
    /// Does one thing that a panel asked for. Commands that concern the window itself are the app's.
    pub fn carry_out(&mut self, command: Command) {
        if let Some(kind) = Choices::changed_by(&command) {
            self.choices.leave(self.present_choices(), kind, Instant::now());
        }
        match command {
            Command::Open(model) => self.open(model),
            Command::OpenDialog => self.ask_for_file(),
            Command::AskForPath(open) => self.asking = open.then(String::new),
            Command::CancelLoad => self.stay(),
            Command::CancelBuild => self.cancel_build(),
            Command::CancelMeasure => self.measuring = None,
            Command::Fairness(fairness) => self.terms_of_timings.fairness = fairness,
            Command::SortTimings(column) => self.terms_of_timings.sort_by(column),
            Command::Structure(id) => {
                self.settings.structure = id.to_owned();
                self.choose();
            }
            Command::Params(values) => {
                let entry = self.settings.entry();
                self.settings.remember(entry, &values);
                self.choose();
            }
            Command::Test(test) => {
                self.settings.test = test;
                self.choose();
            }
            Command::Mode(mode) => self.show_mode(mode),
            Command::HeatRays(rays) => self.show_heat_of(rays),
            Command::ShowTiles(shown) => self.show_tiles(shown),
            Command::TimeTiles => self.time_tiles(),
            Command::CancelTiles => self.tiles.running = None,
            Command::HeatRange(range) => self.set_heat_range(range),
            Command::Overlay(overlay) => {
                let depths = (overlay.from_depth, overlay.depth);
                if depths != (self.settings.overlay.from_depth, self.settings.overlay.depth) {
                    self.chosen_depths = depths;
                }
                self.settings.overlay = overlay;
            }
            Command::Section(section) => self.cut(section),
            Command::Hide(change) => self.hide_triangles(change),
            Command::CancelHide => self.hide_no_more(),
            Command::ShowAll => self.show_all(),
            Command::Camera(camera) => self.look(camera, Kind::Hand),
            Command::CameraBack => self.camera = self.cameras.back(self.camera).unwrap_or(self.camera),
            Command::CameraForward => self.camera = self.cameras.forward(self.camera).unwrap_or(self.camera),
            // What is timed shall not be disturbed by a build.
            Command::Undo | Command::Redo | Command::Bookmark(_) if self.is_measuring() => {}
            Command::Undo => self.undo(),
            Command::Redo => self.redo(),
            Command::Pick(at) => self.pick(at),
            Command::SelectLevel(level) => {
                let picked = self.picked.clone().map(|p| Picked { level: level.min(p.path.len().saturating_sub(1)), ..p });
                self.select(picked);
            }
            Command::SelectRow(row) => self.select_row(row, false),
            Command::WalkToRow(row) => self.select_row(row, true),
            Command::OpenRow(row, open) => self.open_row(row, open),
            Command::OpenBelow(row) => self.open_below(row),
            Command::CloseTree => self.tree.close_all(),
            Command::TryPlane(plane) => self.try_plane(plane),
            Command::MakeFilm => self.make_film(),
            Command::CloseFilm => self.close_film(),
            Command::FilmTo(at) => self.filming.go(at),
            Command::PlayFilm(play) => self.filming.play(play, Instant::now()),
            Command::FilmSpeed(speed) => self.filming.set_speed(speed, Instant::now()),
            Command::FitVolumes => self.fit_volumes(),
            Command::CancelFitVolumes => self.fits.running = None,
            Command::DrawVolume(id) => self.draw_volume(id),
            Command::FindCauses => self.find_causes(),
            Command::CancelCauses => self.causes.running = None,
            Command::ShowCause(row) => self.show_cause(row),
            Command::RayKind(kind) => {
                self.rays.kind = kind;
                self.follow_again();
            }
            Command::RayText(text) => self.follow_text(&text),
            Command::OpenRays => self.ask_for_rays(),
            Command::FollowListed(row) => self.follow_listed(row),
            Command::CancelRays => self.cancel_rays(),
            Command::CloseRays => self.close_rays(),
            Command::CancelFollow => self.rays.following = None,
            Command::MarkRectangle(mark) => self.mark_rectangle(mark),
            Command::CheckByBrute(rect) => self.compare_with_brute_force(rect),
            Command::CancelBrute => self.brute.clear(),
            Command::FollowUnlike(number) => self.follow_unlike(number),
            Command::Beside(id, beside) => self.follow_beside(id, beside),
            Command::Step(column, step) => self.go_to_step(column, step),
            Command::Play(play) => self.play(play),
            Command::PlaySpeed(speed) => self.rays.speed = speed,
            Command::HideOutcome(hide) => (self.settings.hide_outcome, self.tree.revealed) = (hide, false),
            Command::Reveal => self.tree.revealed = true,
            Command::FrameSelected => self.frame_selected(),
            Command::FrameAll => self.frame_all(),
            Command::ToggleProjection => self.look(navigation::toggle_projection(&self.camera), Kind::Single),
            Command::MaxSamples(n) => self.settings.max_samples = n.max(1),
            Command::Measure => self.measure(),
            Command::Predict => self.predict(),
            Command::MeasureNeeds => self.measure_needs(),
            Command::CancelNeeds => self.needing = None,
            Command::Instances(instances) => self.reopen(instances),
            Command::Workspace(workspace) => {
                self.settings.workspace = workspace;
                (self.rays.playing, self.filming.playing) = (None, None);
                if workspace == Workspace::Ray && self.rays.columns.is_empty() && self.rays.following.is_none() {
                    self.follow_again();
                }
                self.light();
            }
            Command::RunLab => self.run_lab(),
            Command::CancelLab => self.checks.running = None,
            Command::OpenCase(cell) => self.open_case(cell),
            Command::CheckModel => self.check_model(),
            Command::CancelCheck => self.checks.checking = None,
            Command::MarkModel(which) => self.checks.mark_model(which),
            Command::Tone(tone) => self.settings.tone = tone,
            Command::Sampler(sampler) => self.settings.sampler = sampler,
            Command::MakeReference => self.make_reference(),
            Command::CancelReference => self.errors.making = None,
            Command::Shot(chosen, difference) => self.choose_shot(chosen, difference),
            Command::ErrorsAsTable(table) => self.errors.as_table = table,
            Command::ErrorPlot(plot) => self.tradeoffs.plot = plot,
            Command::Miss(miss) => self.tradeoffs.miss = miss,
            Command::Goodness(goodness) => self.tradeoffs.goodness = goodness,
            Command::MeasureTradeoffs => self.measure_tradeoffs(),
            Command::CancelTradeoffs => self.tradeoffs.running = None,
            Command::MeasureScaling => self.measure_scaling(),
            Command::CancelScaling => self.tradeoffs.growing = None,
            Command::Dismiss => self.error = None,
            Command::Memory(mib) => self.set_memory(mib),
            Command::Theme(theme) => self.settings.theme = theme,
            Command::Navigation(navigation) => self.settings.navigation = navigation,
            Command::Scale(scale) => self.settings.scale = scale,
            Command::Palette(open) => self.palette = open,
            Command::Help(open) => self.help = open,
            Command::Preferences(open) => self.preferences = open,
            Command::Terms(open) => self.terms = open,
            Command::Tour(step) => self.go_on_tour(step),
            Command::Present(present) => self.presenting = present,
            Command::Unfold(open) => self.unfolded = open,
            Command::PutBeside(id) => self.change_panes(|state| state.put_beside(id)),
            Command::PutPane(which, choice) => self.change_panes(|state| state.settings.panes.put(which, choice)),
            Command::ClosePane(which) => self.change_panes(|state| state.close_pane(which)),
            Command::TunePane(which) => self.panes.tuned = which,
            Command::Arrange(arrange) => self.change_panes(|state| state.settings.panes.arrange = arrange),
            Command::Divider(which, at) => self.settings.panes.move_divider(which, at),
            Command::FitRange => self.fit_anew(),
            Command::SaveWorkspace => self.ask_where_to_save(),
            Command::Export(export) => self.ask_where_to_export(export),
            Command::CancelReport => self.exports.report = None,
            Command::AddBookmark => self.add_bookmark(),
            Command::Bookmark(at) => self.go_to_bookmark(at),
            Command::DropBookmark(at) => {
                if at < self.bookmarks.len() {
                    self.bookmarks.remove(at);
                }
            }
            Command::ResetLayout | Command::NextPanel(_) | Command::FullScreen | Command::Quit => {}
        }
    }
}
