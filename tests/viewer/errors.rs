//! Files that cannot be opened.

use std::path::Path;

use crate::files::{self, Files};
use crate::window::Window;

/// Opens what cannot be opened; returns what the window says.
#[track_caller]
fn refused(w: &mut Window, path: &Path) -> String {
    let kept = w.state().model.as_ref().expect("open").scene.name.clone();
    w.open_path(&path.to_string_lossy());
    w.until("an error", |s| s.error.is_some());
    w.settle();
    let state = w.state();
    assert!(state.loading.is_none());
    assert_eq!(state.model.as_ref().expect("still open").scene.name, kept);
    assert!(state.shown.is_some() && state.picture.is_some());
    let error = state.error.clone().expect("just seen");
    assert!(w.says(&error), "the window says: {error}");
    assert!(error.starts_with("Can't open ") && error.ends_with(" Your scene is unchanged."), "{error}");
    let name = path.file_name().expect("a file").to_string_lossy();
    assert!(error.contains(&*name), "{error}");
    error
}

#[test]
fn what_cannot_be_opened_says_why_and_the_scene_stays() {
    let files = Files::new();
    let whole = files::ply();
    let mut w = Window::lecture();
    let cut = files.write("cut short.ply", &whole[..whole.len() - 12]);
    let error = refused(&mut w, &cut);
    assert!(error.len() > "Can't open . Your scene is unchanged.".len() + cut.to_string_lossy().len() + 10, "{error}");

    w.button("Dismiss");
    w.step();
    assert!(w.state().error.is_none() && !w.says("Your scene is unchanged."));

    let error = refused(&mut w, &files.missing("nowhere.obj"));
    assert!(error.to_lowercase().contains("no such file") || error.contains("cannot find"), "{error}");
    let error = refused(&mut w, &files.write("empty.ply", files::ply_without_faces()));
    assert!(error.contains("it holds no triangles"), "{error}");
    let error = refused(&mut w, &files.write("notes.txt", "hello"));
    assert!(error.contains("txt"), "{error}");

    // The next file that opens puts the message away.
    w.open_path(&files.write("whole.ply", whole).to_string_lossy());
    w.until("the file", |s| s.model.as_ref().is_some_and(|m| m.geometry.triangle_count() == 2));
    assert!(w.state().error.is_none());
}
