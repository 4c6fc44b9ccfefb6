//! The whole state of the window in a file.

use std::path::Path;

use boxwood::lab::RayKind;
use boxwood::viewer::settings::{BoxColor, Workspace};
use eframe::egui::{Key, Modifiers, PointerButton, Role, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

const TEAPOT: &str = "builtin:teapot?triangles=1000";

/// A window whose file dialogs answer with this path.
fn window(model: &str, answer: &Path) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 800.0), answer: Some(answer.to_path_buf()), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    Window::new(setup).settled()
}

#[test]
fn nothing_is_lost_between_saving_and_opening() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lesson.boxwood");
    let mut w = window(TEAPOT, &path);
    // Open, orbit, step a ray, try a division.
    w.drag(w.viewport().center(), vec2(60.0, 20.0), PointerButton::Primary, Modifiers::NONE);
    w.button("k-d tree");
    w.settle();
    w.key(Modifiers::NONE, Key::F3);
    w.press_in_one_frame(w.viewport().center());
    w.until("steps", |s| !s.rays.columns.is_empty());
    w.settle();
    w.button("BVH beside");
    w.settle();
    w.choose("The pixel's ray", "Bounce from there");
    w.settle();
    w.button("Next leaf");
    let step = w.state().rays.place().expect("a step");
    assert!(step.1 > 0);
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    w.settle();
    w.button("Deepest leaf");
    w.settle();
    w.button("Parent");
    w.settle();
    w.choose(BoxColor::Depth.label(), BoxColor::Cost.label());
    w.settle();
    let plot = w.harness.get_by_role_and_label(Role::Image, "SAH cost over candidate planes").rect();
    w.drag(plot.center(), vec2(20.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    // Compare, and back to the tree.
    w.key(Modifiers::NONE, Key::F4);
    w.choose("No second", "and Grid");
    w.until("two pictures", boxwood::viewer::state::State::is_split);
    w.key(Modifiers::NONE, Key::F2);
    w.settle();
    w.key(Modifiers::COMMAND, Key::D);
    w.key(Modifiers::COMMAND, Key::S);
    w.until("the file", |_| path.exists());
    w.settle();
    assert_eq!(w.state().error, None);
    let before = w.state();
    let (camera, settings, ids) = (before.camera, before.settings.clone(), before.picked.as_ref().expect("selected").ids());
    let (ray, bookmarks) = (before.rays.ray, before.bookmarks.len());
    let tried = before.tree.tried.expect("dragged");
    drop(w);
    // Another window, with other settings, opens it as the command line does.
    let mut w = window(&path.to_string_lossy(), &path);
    w.until("the selection", |s| s.picked.is_some());
    w.settle();
    let after = w.state();
    assert_eq!((after.camera, after.settings.structure.as_str()), (camera, "kdtree"));
    assert_eq!(after.picked.as_ref().map(|picked| picked.ids()), Some(ids));
    assert_eq!((after.settings.overlay, after.settings.workspace), (settings.overlay, Workspace::Structure));
    assert_eq!((after.rays.kind, after.rays.beside.as_slice()), (RayKind::Diffuse, &["bvh"][..]));
    assert_eq!(after.bookmarks.len(), bookmarks);
    assert!(after.settings.panes == settings.panes && after.settings.panes.others.len() == 1);
    assert!(after.tree.tried.is_some_and(|(axis, place)| axis == tried.0 && (place - tried.1).abs() < 1e-9));
    assert!(after.overlay.as_ref().is_some_and(|overlay| overlay.tried.is_some()));
    assert!(after.model.as_ref().is_some_and(|model| model.scene.name == TEAPOT));
    // The ray is followed again where it is looked at.
    w.key(Modifiers::NONE, Key::F3);
    w.until("its steps", |s| s.rays.columns.len() == 2);
    w.settle();
    assert_eq!((w.state().rays.ray, w.state().rays.place()), (ray, Some(step)));
    // The view that was kept is gone to.
    w.button("BVH");
    w.settle();
    w.button("View");
    w.button_that_contains("Bookmarks");
    w.button("view 1 (k-d tree)");
    w.settle();
    assert_eq!(w.shown(), Some("kdtree"));
    assert!(w.state().picked.is_some());
}

#[test]
fn a_file_that_is_none_leaves_everything_as_it_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("broken.boxwood");
    std::fs::write(&path, "{\"version\": 1}").expect("written");
    let mut w = window("builtin:lecture", &path);
    w.key(Modifiers::COMMAND, Key::O);
    w.until("a message", |s| s.error.is_some());
    assert!(
        w.state().error.as_ref().is_some_and(|error| error.contains("broken.boxwood") && error.contains("no workspace file"))
    );
    assert!(w.state().model.as_ref().is_some_and(|model| model.scene.name == "builtin:lecture"));
    // One whose model is gone says which.
    w.button("Dismiss");
    let gone = folder.path().join("gone.ply").to_string_lossy().into_owned();
    let mut file = boxwood::viewer::workspace_file::WorkspaceFile::new(
        &gone,
        &w.state().settings,
        w.state().camera,
        boxwood::viewer::model::Instances::default(),
    );
    file.selected = vec![(0, 3)];
    file.write(&path).expect("written");
    w.key(Modifiers::COMMAND, Key::O);
    w.until("a message", |s| s.error.is_some());
    assert!(w.state().error.as_ref().is_some_and(|error| error.contains("gone.ply")), "{:?}", w.state().error);
    w.settle();
    assert!(w.state().picked.is_none());
}

#[test]
fn a_file_that_is_overtaken_changes_nothing_of_what_overtook_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = folder.path().join("lesson.boxwood");
    let mut w = window("builtin:soup?triangles=300000", &path);
    w.key(Modifiers::COMMAND, Key::D);
    w.key(Modifiers::COMMAND, Key::S);
    w.until("the file", |_| path.exists());
    w.open_path("builtin:lecture");
    w.settle();
    let camera = w.state().camera;
    // Opened, and before its model is there another one.
    w.open_path(&path.to_string_lossy());
    w.open_path("builtin:lecture");
    w.settle();
    assert!(w.state().model.as_ref().is_some_and(|model| model.scene.name == "builtin:lecture"));
    assert_eq!((w.state().camera, w.state().bookmarks.len()), (camera, 0));
}
