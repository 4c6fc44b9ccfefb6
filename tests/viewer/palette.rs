//! The palette of commands, and the page of keys.

use boxwood::viewer::actions;
use boxwood::viewer::settings::{ThemeChoice, Workspace};
use eframe::egui::{Event, Key, Modifiers, Role};

use crate::window::Window;

fn type_in(w: &mut Window, text: &str) {
    w.key(Modifiers::COMMAND, Key::P);
    assert!(w.state().palette);
    w.step();
    w.harness.event(Event::Text(text.to_owned()));
    w.step();
}

#[test]
fn a_few_letters_do_anything() {
    let mut w = Window::lecture();
    type_in(&mut w, "kd");
    w.key(Modifiers::NONE, Key::Enter);
    w.until("the k-d tree", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "kdtree"));
    w.settle();
    assert!(!w.state().palette);
    // The second of what fits, by keys; and by a click.
    type_in(&mut w, "look:");
    w.key(Modifiers::NONE, Key::ArrowDown);
    w.key(Modifiers::NONE, Key::Enter);
    w.step();
    assert_eq!(w.state().settings.theme, ThemeChoice::Light, "the shortest name first, which is the dark one");
    type_in(&mut w, "check works");
    w.key(Modifiers::NONE, Key::Enter);
    w.step();
    assert_eq!((w.state().settings.workspace, w.state().palette), (Workspace::Check, false));
    type_in(&mut w, "terms");
    w.button("Terms, with formulas and sources");
    w.step();
    assert_eq!((w.state().terms, w.state().palette), (true, false));
    w.key(Modifiers::NONE, Key::Escape);
    type_in(&mut w, "zzz");
    assert!(w.says("Nothing that can be done now has these letters."));
    // Nothing behind it hears what is typed, also after an Enter that did nothing.
    let boxes = w.state().settings.overlay.boxes;
    w.key(Modifiers::NONE, Key::Enter);
    w.key(Modifiers::NONE, Key::B);
    assert_eq!((w.state().palette, w.state().settings.overlay.boxes), (true, boxes));
    w.key(Modifiers::NONE, Key::Escape);
    w.step();
    assert!(!w.state().palette);
}

#[test]
fn every_key_does_one_thing_and_every_name_is_one() {
    let w = Window::lecture();
    let all = actions::all(w.state());
    let (mut names, mut keys) = (Vec::new(), Vec::new());
    for action in &all {
        assert!(!names.contains(&action.name), "{} is there twice", action.name);
        names.push(action.name.clone());
        for key in &action.keys {
            assert!(!keys.contains(key), "{key:?} does two things");
            keys.push(*key);
        }
    }
    assert!(all.len() > 80 && keys.len() > 20, "{} actions, {} keys", all.len(), keys.len());
}

/// Commands that no entry of the palette sends, and why.
const BY_HAND_ALONE: [(&str, &str); 8] = [
    ("Params", "a value of a parameter, which is typed"),
    ("Camera", "a view, which is turned to by hand or keys"),
    ("Pick", "a place in the picture"),
    ("WalkToRow", "an arrow key in the tree"),
    ("OpenRow", "a row of the tree"),
    ("RayText", "a ray, which is typed"),
    ("OpenCase", "a cell of the matrix"),
    ("Predict", "sent by the panel that shows predictions"),
];

#[test]
fn the_palette_has_every_command() {
    let source = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("src/viewer");
    let read = |path: &std::path::Path| std::fs::read_to_string(path).expect("readable");
    let files = std::fs::read_dir(source.join("actions")).expect("a folder");
    let actions: String = files.map(|file| read(&file.expect("a file").path())).collect();
    let commands = read(&source.join("command.rs"));
    let variants = commands.split_once("pub enum Command {").expect("the list").1;
    let name_of = |line: &str| {
        let line = line.strip_prefix("    ").filter(|line| line.starts_with(char::is_uppercase))?;
        line.split(|c: char| !c.is_alphanumeric()).next().map(str::to_owned)
    };
    let names: Vec<String> = variants.lines().filter_map(name_of).collect();
    assert!(names.len() > 100, "{names:?}");
    let sends = |name: &str| {
        let sent = format!("Command::{name}");
        actions.match_indices(&sent).any(|(at, _)| !actions[at + sent.len()..].starts_with(char::is_alphanumeric))
    };
    for name in &names {
        let by_hand = BY_HAND_ALONE.iter().any(|(known, _)| known == name);
        assert!(sends(name) != by_hand, "{name}: in the palette or in the list of those that are not, and in one alone");
    }
    assert!(BY_HAND_ALONE.iter().all(|(known, _)| names.iter().any(|name| name == known)));
}

#[test]
fn only_what_does_something_is_offered() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    let offers = |w: &Window, name: &str| {
        let all = actions::all(w.state());
        all.iter().find(|action| action.name == name).is_some_and(|action| action.possible)
    };
    // A hierarchy of boxes has neither planes nor empty cells, a k-d tree has both, a grid no leaves to choose.
    let three = ["Leaves only, or a depth", "Split planes on or off", "Empty cells on or off"];
    assert_eq!(three.map(|name| offers(&w, name)), [true, false, false]);
    w.button("k-d tree");
    w.settle();
    assert_eq!(three.map(|name| offers(&w, name)), [true, true, true]);
    w.button("Grid");
    w.settle();
    assert_eq!(three.map(|name| offers(&w, name)), [false, false, true]);
    assert!(offers(&w, "Slice: the next layer") && !offers(&w, "A level deeper"));
    for name in ["Follow the dearest ray of the file", "Next step", "Stop building", "Unfold the panel at the right"] {
        assert!(!offers(&w, name), "{name}");
    }
    // Siblings are gone around by a key.
    w.button("BVH");
    w.settle();
    w.key(Modifiers::NONE, Key::F2);
    w.until("the tree", |s| s.tree.outline.is_some());
    assert!(!offers(&w, "Select the next sibling"));
    w.button("Deepest leaf");
    w.settle();
    let first = w.state().tree.selected;
    w.key(Modifiers::NONE, Key::N);
    w.settle();
    assert!(w.state().tree.selected.is_some() && w.state().tree.selected != first);
    w.key(Modifiers::NONE, Key::N);
    w.settle();
    assert_eq!(w.state().tree.selected, first, "a binary tree has two");
}

#[test]
fn keys_turn_boxes_on_and_go_deeper() {
    let mut w = Window::lecture();
    let overlay = |w: &Window| w.state().settings.overlay;
    let before = overlay(&w);
    w.key(Modifiers::NONE, Key::B);
    assert_ne!(overlay(&w).boxes, before.boxes);
    w.key(Modifiers::NONE, Key::OpenBracket);
    assert_eq!(overlay(&w).depth, before.depth - 1);
    w.key(Modifiers::NONE, Key::CloseBracket);
    assert_eq!(overlay(&w).depth, before.depth);
    w.key(Modifiers::NONE, Key::F2);
    assert_eq!(w.state().settings.workspace, Workspace::Structure);
    w.key(Modifiers::NONE, Key::Questionmark);
    assert!(w.says("A level deeper") && w.has(Role::Window, "Keys and mouse"));
}
