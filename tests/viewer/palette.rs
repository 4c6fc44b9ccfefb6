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
