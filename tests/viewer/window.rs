//! A window under test, and the hands that work it.

use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, RwLock, RwLockReadGuard, RwLockWriteGuard};
use std::time::{Duration, Instant};

use boxwood::viewer::dialogs::FileDialog;
use boxwood::viewer::state::State;
use boxwood::viewer::{App, ViewerOptions};
use eframe::egui::{
    self, Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, Rect, Role, Shape, TouchPhase, Vec2, vec2,
};
use egui_kittest::Harness;
use egui_kittest::kittest::Queryable;

/// The size of most windows here: just wide enough for all panels.
pub const SIZE: Vec2 = egui::vec2(1120.0, 720.0);
/// After this long, what has not happened will not.
pub const PATIENCE: Duration = Duration::from_secs(40);

/// Tests run side by side, but for those that look at the clock: they wait for the others to end.
static QUIET: RwLock<()> = RwLock::new(());

/// Some drivers wait for ever where several threads of a program make devices at the same time.
static DEVICES: Mutex<()> = Mutex::new(());

enum Turn {
    Shared(#[expect(dead_code, reason = "held, not read")] RwLockReadGuard<'static, ()>),
    Alone(#[expect(dead_code, reason = "held, not read")] RwLockWriteGuard<'static, ()>),
}

/// A dialog that is answered at once.
struct Answer(Option<PathBuf>);

impl FileDialog for Answer {
    fn pick(&self, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        let (sender, receiver) = channel();
        sender.send(self.0.clone()).expect("the receiver is here");
        wake();
        receiver
    }

    fn save(&self, _: &str, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        self.pick(wake)
    }
}

/// How a window is opened.
pub struct Setup {
    pub size: Vec2,
    pub pixels_per_point: f32,
    pub options: ViewerOptions,
    /// What the file dialog answers.
    pub answer: Option<PathBuf>,
    /// Asks in its place.
    pub dialog: Option<Box<dyn FileDialog>>,
    /// No other test runs meanwhile.
    pub alone: bool,
    /// Draws pixels: there must be an adapter.
    pub gpu: bool,
    /// The system takes its time between starting the program and showing its window.
    pub slow_start: bool,
    /// Some text has letters that the fonts lack; otherwise that is a failure.
    pub foreign: bool,
}

impl Default for Setup {
    fn default() -> Self {
        // Pictures that are soon done leave the processors to the tests.
        let options = ViewerOptions { samples: Some(1), ..ViewerOptions::default() };
        Self {
            size: SIZE,
            pixels_per_point: 1.0,
            options,
            answer: None,
            dialog: None,
            alone: false,
            gpu: false,
            slow_start: false,
            foreign: false,
        }
    }
}

/// A piece of text as it was drawn.
#[derive(Clone, Debug)]
pub struct Painted {
    pub text: String,
    /// Where its letters are.
    pub rect: Rect,
    /// Outside of this it is cut off.
    pub clip: Rect,
    /// An ellipsis stands for a part of it.
    pub elided: bool,
}

/// The window.
pub struct Window {
    pub harness: Harness<'static, App>,
    _turn: Turn,
    _device: Option<MutexGuard<'static, ()>>,
}

impl Window {
    /// Opens a window.
    pub fn new(setup: Setup) -> Self {
        Self::with_storage_if(setup, None)
    }

    /// Opens a window that finds what another one has saved.
    pub fn with_storage(setup: Setup, storage: impl eframe::Storage + 'static) -> Self {
        // The harness wants it to outlive all.
        Self::with_storage_if(setup, Some(Box::leak(Box::new(storage))))
    }

    fn with_storage_if(setup: Setup, storage: Option<&'static dyn eframe::Storage>) -> Self {
        let turn = if setup.alone {
            Turn::Alone(QUIET.write().unwrap_or_else(PoisonError::into_inner))
        } else {
            Turn::Shared(QUIET.read().unwrap_or_else(PoisonError::into_inner))
        };
        let mut builder = Harness::builder().with_size(setup.size).with_pixels_per_point(setup.pixels_per_point);
        // Real frames are short; with long ones two clicks are never close enough to be a double click.
        builder = builder.with_step_dt(1.0 / 60.0);
        let device = setup.gpu.then(|| DEVICES.lock().unwrap_or_else(PoisonError::into_inner));
        if setup.gpu {
            builder = builder.wgpu();
        }
        if setup.foreign {
            builder = builder.allow_missing_glyphs();
        }
        let (options, dialog) = (setup.options, setup.dialog.unwrap_or_else(|| Box::new(Answer(setup.answer))));
        let harness = builder.build_eframe(move |cc| {
            cc.storage = storage;
            let app = App::with_dialog(cc, options, dialog).expect("threads");
            if setup.slow_start {
                std::thread::sleep(Duration::from_millis(300));
            }
            app
        });
        Self { harness, _turn: turn, _device: device }
    }

    /// A window with a model, settled.
    pub fn with_model(model: &str) -> Self {
        let mut setup = Setup::default();
        setup.options.model = Some(model.to_owned());
        Self::new(setup).settled()
    }

    /// What opens at the first launch, settled.
    pub fn lecture() -> Self {
        Self::new(Setup::default()).settled()
    }

    pub fn state(&self) -> &State {
        self.harness.state().state()
    }

    /// The id of the structure on the screen.
    pub fn shown(&self) -> Option<&'static str> {
        self.state().shown.as_ref().map(|b| b.key.entry.id)
    }

    /// One frame, or as many as there are events.
    pub fn step(&mut self) {
        self.harness.step();
    }

    /// Frames until something holds.
    #[track_caller]
    pub fn until(&mut self, what: &str, holds: impl Fn(&State) -> bool) {
        let start = Instant::now();
        while !holds(self.state()) {
            assert!(start.elapsed() < PATIENCE, "waited in vain: {what}; error: {:?}", self.state().error);
            let frame = Instant::now();
            self.step();
            // Half of the time is for those who do the work.
            std::thread::sleep(frame.elapsed().max(Duration::from_millis(4)));
        }
    }

    /// Frames until a structure is shown with its figures and some picture: enough to look at the
    /// window, though not at the picture.
    #[track_caller]
    pub fn ready(&mut self) {
        self.step();
        self.until("figures and a picture", |s| {
            let counted = s.shown.as_ref().is_some_and(|b| b.stats.is_some());
            s.loading.is_none() && s.building.is_none() && counted && s.picture.is_some()
        });
        self.harness.run_steps(2);
    }

    /// Frames until nothing is going on and everything is on the screen.
    #[track_caller]
    pub fn settle(&mut self) {
        // Twice, since what was clicked in one frame is carried out in the next.
        for _ in 0..2 {
            self.harness.run_steps(2);
            self.until("nothing going on", |s| {
                !s.is_busy() && s.shown.as_ref().is_none_or(|b| b.stats.is_some()) && (s.model.is_none() || s.shown.is_some())
            });
        }
        self.harness.run_steps(2);
    }

    pub fn settled(mut self) -> Self {
        self.settle();
        self
    }

    /// Clicks what has this role and name.
    #[track_caller]
    pub fn click(&mut self, role: Role, name: &str) {
        self.harness.get_by_role_and_label(role, name).click();
        self.carried_out();
    }

    /// The events that are on their way, and the frame that follows: what was asked for in one frame
    /// is done before the next is drawn.
    fn carried_out(&mut self) {
        self.step();
        self.step();
    }

    #[track_caller]
    pub fn button(&mut self, name: &str) {
        self.click(Role::Button, name);
    }

    /// Clicks the one button whose name contains this: menus add an arrow or a key to theirs.
    #[track_caller]
    pub fn button_that_contains(&mut self, part: &str) {
        let buttons = self.harness.get_by(|n| n.role() == Role::Button && n.label().is_some_and(|l| l.contains(part)));
        buttons.click();
        self.carried_out();
    }

    /// Takes `option` in the list that shows `now`.
    #[track_caller]
    pub fn choose(&mut self, now: &str, option: &str) {
        self.harness.get_by(|n| n.role() == Role::ComboBox && n.value().as_deref() == Some(now)).click();
        self.carried_out();
        self.button(option);
    }

    /// Types a number into a parameter.
    #[track_caller]
    pub fn set_parameter(&mut self, name: &str, value: &str) {
        if self.harness.query_by_role_and_label(Role::SpinButton, name).is_none() {
            self.click(Role::DisclosureTriangle, "Parameters");
            self.step();
        }
        self.set_number(name, value);
    }

    /// Types a number into the field of this name.
    #[track_caller]
    pub fn set_number(&mut self, name: &str, value: &str) {
        self.click(Role::SpinButton, name);
        self.step();
        self.key(Modifiers::COMMAND, Key::A);
        self.harness.event(Event::Text(value.to_owned()));
        self.step();
        self.key(Modifiers::NONE, Key::Enter);
        self.step();
    }

    /// Opens a model by the field for a path.
    pub fn open_path(&mut self, path: &str) {
        self.key(Modifiers::COMMAND, Key::L);
        self.step();
        self.key(Modifiers::COMMAND, Key::A);
        self.harness.event(Event::Text(path.to_owned()));
        self.step();
        self.button("Open model");
        self.step();
    }

    /// Presses and releases the button in one frame, as a machine that is late does.
    pub fn press_in_one_frame(&mut self, pos: Pos2) {
        self.harness.hover_at(pos);
        self.step();
        let press = |pressed| Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE };
        self.harness.input_mut().events.extend([press(true), press(false)]);
        self.step();
    }

    /// Enlarges everything, as the Window menu does; the window itself stays as large as it is.
    pub fn scale(&mut self, scale: f32) {
        let size = self.harness.ctx.content_rect().size();
        while self.state().settings.scale != scale {
            let key = if self.state().settings.scale < scale { Key::Plus } else { Key::Minus };
            self.key(Modifiers::COMMAND, key);
        }
        self.harness.set_size(size / scale);
        self.step();
    }

    pub fn has(&self, role: Role, name: &str) -> bool {
        self.harness.query_all_by_role_and_label(role, name).next().is_some()
    }

    pub fn key(&mut self, modifiers: Modifiers, key: Key) {
        self.harness.key_press_modifiers(modifiers, key);
        self.carried_out();
    }

    /// Where the 3D view is.
    pub fn viewport(&self) -> Rect {
        self.harness.get_by_role(Role::Canvas).rect()
    }

    /// A drag, in several moves as a hand makes them.
    pub fn drag(&mut self, from: Pos2, by: Vec2, button: PointerButton, modifiers: Modifiers) {
        let press = |pressed, pos| Event::PointerButton { pos, button, pressed, modifiers };
        self.harness.event(Event::ModifiersChanged(modifiers));
        self.harness.event(Event::PointerMoved(from));
        self.harness.event(press(true, from));
        (1u8..=8).for_each(|i| self.harness.event(Event::PointerMoved(from + by * (f32::from(i) / 8.0))));
        self.harness.event(press(false, from + by));
        self.harness.event(Event::ModifiersChanged(Modifiers::NONE));
        self.harness.event(Event::PointerGone);
        self.step();
        self.step();
    }

    /// Turns the wheel by so many notches over a place: up is positive.
    pub fn wheel(&mut self, at: Pos2, notches: i32) {
        let notch = Event::MouseWheel {
            unit: MouseWheelUnit::Line,
            delta: vec2(0.0, notches.signum() as f32),
            phase: TouchPhase::Move,
            source: MouseWheelSource::Unknown,
            modifiers: Modifiers::NONE,
        };
        self.harness.hover_at(at);
        (0..notches.abs()).for_each(|_| self.harness.event(notch.clone()));
        self.harness.run_steps(30);
    }

    /// The text of the last frame.
    pub fn texts(&self) -> Vec<Painted> {
        let mut texts = Vec::new();
        for clipped in &self.harness.output().shapes {
            gather(&clipped.shape, clipped.clip_rect, &mut texts);
        }
        texts
    }

    /// Whether some text of the last frame contains this.
    pub fn says(&self, part: &str) -> bool {
        self.texts().iter().any(|t| t.text.contains(part))
    }
}

fn gather(shape: &Shape, clip: Rect, texts: &mut Vec<Painted>) {
    match shape {
        Shape::Vec(shapes) => shapes.iter().for_each(|s| gather(s, clip, texts)),
        Shape::Text(t) if !t.galley.is_empty() => {
            let rect = t.galley.rect.translate(t.pos.to_vec2());
            texts.push(Painted { text: t.galley.text().to_owned(), rect, clip, elided: t.galley.elided });
        }
        _ => {}
    }
}
