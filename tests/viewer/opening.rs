//! The ways to open a model.

use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex};

use boxwood::viewer::dialogs::FileDialog;
use eframe::egui::{DroppedFile, Event, Key, Modifiers, Role};
use egui_kittest::kittest::Queryable;

use crate::files::{self, Files};
use crate::window::{Setup, Window};

fn triangles(window: &Window) -> usize {
    window.state().model.as_ref().map_or(0, |m| m.geometry.triangle_count())
}

#[test]
fn the_first_launch_shows_the_lecture() {
    let w = Window::lecture();
    let state = w.state();
    assert_eq!(state.model.as_ref().map(|m| m.scene.name.as_str()), Some("builtin:lecture"));
    assert_eq!((triangles(&w), w.shown()), (16, Some("bvh")));
    let picture = state.picture.as_ref().expect("a picture");
    assert_eq!([picture.width, picture.height], state.size_px);
    for said in ["builtin:lecture", "SAH cost", "Nodes", "Leaves", "Depth", "Leaf size", "Bytes"] {
        assert!(w.says(said), "{said}");
    }
    assert!(state.error.is_none());
}

#[test]
fn the_first_view_fills_the_viewport() {
    // The lecture is there before the window knows how large it is.
    let mut w = Window::new(Setup { slow_start: true, ..Setup::default() }).settled();
    let first = w.state().camera;
    w.key(Modifiers::NONE, Key::Home);
    w.settle();
    let height = |c: &boxwood::scene::Camera| c.half_size(1.0).y;
    let (first, framed) = (height(&first), height(&w.state().camera));
    assert!((first / framed - 1.0).abs() < 0.05, "at first {first}, framed {framed}");
}

#[test]
fn built_in_scenes_and_recent_files_open_from_the_menu() {
    let mut w = Window::lecture();
    w.button("File");
    w.button_that_contains("Built-in scenes");
    w.button("teapot");
    w.until("the teapot", |s| s.model.as_ref().is_some_and(|m| m.scene.name == "builtin:teapot"));
    w.settle();
    assert!(triangles(&w) > 1000 && w.says("builtin:teapot"));

    w.button("File");
    w.button_that_contains("Open recent");
    w.button("builtin:lecture");
    w.until("the lecture", |s| s.model.as_ref().is_some_and(|m| m.scene.name == "builtin:lecture"));
    assert_eq!(w.state().settings.recent[..2], ["builtin:lecture", "builtin:teapot"]);
}

#[test]
fn a_typed_path_opens() {
    let mut w = Window::lecture();
    // A button that has the focus must not keep the field from it.
    w.harness.get_by_role_and_label(Role::Button, "Grid").focus();
    w.step();
    w.key(Modifiers::COMMAND, Key::L);
    w.step();
    assert!(w.has(Role::Button, "Open model"));
    w.harness.event(Event::Text("builtin:menger?triangles=3000".into()));
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    w.until("the sponge", |s| s.model.as_ref().is_some_and(|m| m.scene.name.starts_with("builtin:menger")));
    w.settle();
    assert!(w.state().asking.is_none() && !w.has(Role::Button, "Open model"));

    w.key(Modifiers::COMMAND, Key::L);
    w.step();
    w.key(Modifiers::NONE, Key::Escape);
    w.step();
    assert!(w.state().asking.is_none(), "Esc closes the field");
}

#[test]
fn the_dialog_opens_what_it_answers() {
    let files = Files::new();
    let path = files.write("quad.ply", files::ply());
    let mut w = Window::new(Setup { answer: Some(path), ..Setup::default() }).settled();
    w.key(Modifiers::COMMAND, Key::O);
    w.until("the file", |s| s.model.as_ref().is_some_and(|m| m.geometry.triangle_count() == 2));
    w.settle();
    assert!(w.says("quad.ply"));
}

#[test]
fn a_dialog_that_is_closed_changes_nothing() {
    let mut w = Window::lecture();
    w.button("File");
    w.button_that_contains("Open…");
    w.harness.run_steps(4);
    assert!(w.state().loading.is_none() && w.state().error.is_none());
    assert_eq!(triangles(&w), 16);
}

/// A dialog before which somebody sits and thinks: each time it is opened, somebody to answer.
#[derive(Clone, Default)]
struct Thinking(Arc<Mutex<Vec<Sender<Option<PathBuf>>>>>);

impl FileDialog for Thinking {
    fn pick(&self, _: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        let (sender, receiver) = channel();
        self.0.lock().expect("nobody has failed").push(sender);
        receiver
    }

    fn save(&self, _: &str, wake: Arc<dyn Fn() + Send + Sync>) -> Receiver<Option<PathBuf>> {
        self.pick(wake)
    }
}

#[test]
fn there_is_one_dialog_at_a_time() {
    let files = Files::new();
    let path = files.write("quad.ply", files::ply());
    let thinking = Thinking::default();
    let opened = || thinking.0.lock().expect("nobody has failed").len();
    let dialog: Box<dyn FileDialog> = Box::new(thinking.clone());
    let mut w = Window::new(Setup { dialog: Some(dialog), ..Setup::default() }).settled();
    w.key(Modifiers::COMMAND, Key::O);
    w.key(Modifiers::COMMAND, Key::O);
    w.button("File");
    w.button_that_contains("Open…");
    assert_eq!(opened(), 1);
    thinking.0.lock().expect("nobody has failed")[0].send(None).expect("the window listens");
    w.step();
    w.key(Modifiers::COMMAND, Key::O);
    assert_eq!(opened(), 2, "the first was closed");
    // One that dies without an answer is closed, too.
    thinking.0.lock().expect("nobody has failed").clear();
    w.step();
    w.key(Modifiers::COMMAND, Key::O);
    assert_eq!(opened(), 1);
    thinking.0.lock().expect("nobody has failed")[0].send(Some(path)).expect("the window listens");
    w.until("the file", |s| s.model.as_ref().is_some_and(|m| m.geometry.triangle_count() == 2));
}

/// A file that was dropped.
#[derive(Debug)]
pub struct Dropped(pub PathBuf);

impl DroppedFile for Dropped {
    fn path(&self) -> &Path {
        &self.0
    }

    fn bytes(&self) -> Result<Vec<u8>, String> {
        std::fs::read(&self.0).map_err(|e| e.to_string())
    }
}

#[test]
fn a_dropped_file_opens_whatever_its_name() {
    let files = Files::new();
    let path = files.write("čajník 茶壺 ☕.obj", files::OBJ);
    let mut w = Window::new(Setup { foreign: true, ..Setup::default() }).settled();
    w.harness.input_mut().dropped_files.push(Arc::new(Dropped(path.clone())));
    w.until("the file", |s| s.model.as_ref().is_some_and(|m| m.geometry.triangle_count() == 3));
    assert_eq!(w.state().settings.recent[0], path.to_string_lossy());
}
