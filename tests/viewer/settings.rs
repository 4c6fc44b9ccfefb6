//! What is remembered from one day to the next.

use std::collections::HashMap;

use boxwood::render::Mode;
use boxwood::viewer::settings::{Navigation, ThemeChoice};
use eframe::egui::{Key, Modifiers, Role};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

/// What the disk is to the program.
#[derive(Clone, Default)]
pub struct Drawer(HashMap<String, String>);

impl eframe::Storage for Drawer {
    fn get_string(&self, key: &str) -> Option<String> {
        self.0.get(key).cloned()
    }

    fn set_string(&mut self, key: &str, value: String) {
        self.0.insert(key.to_owned(), value);
    }

    fn remove_string(&mut self, key: &str) {
        self.0.remove(key);
    }

    fn flush(&mut self) {}
}

#[test]
fn settings_come_back_the_next_day() {
    let mut w = Window::lecture();
    w.button("k-d tree");
    w.settle();
    w.harness.get_by_role_and_label(Role::Slider, "Depth").set_value_accesskit(1.0);
    w.choose("Shaded", Mode::Normals.label());
    w.button("View");
    w.button_that_contains("Mouse");
    w.click(Role::RadioButton, "Blender: middle orbits, Shift+middle pans");
    w.button("Window");
    w.click(Role::RadioButton, "Light");
    w.step();
    w.settle();

    let saved = w.state().settings.clone();
    assert_eq!((saved.theme, saved.navigation, saved.mode), (ThemeChoice::Light, Navigation::Blender, Mode::Normals));
    assert_eq!((saved.structure.as_str(), saved.overlay.depth), ("kdtree", 1));
    let mut drawer = Drawer::default();
    eframe::App::save(w.harness.state_mut(), &mut drawer);
    drop(w);

    let w = Window::with_storage(Setup::default(), drawer).settled();
    assert_eq!(w.state().settings, saved);
    assert_eq!(w.shown(), Some("kdtree"));
}

#[test]
fn the_page_of_settings_has_them_all() {
    let mut w = Window::lecture();
    w.key(Modifiers::COMMAND, Key::Comma);
    w.step();
    assert!(w.has(Role::Window, "Settings"));
    w.click(Role::RadioButton, "Dark");
    w.click(Role::RadioButton, "Blender: middle orbits, Shift+middle pans");
    w.click(Role::RadioButton, "1.00\u{2009}GiB");
    w.click(Role::RadioButton, "256");
    w.button("Larger");
    w.step();
    let s = &w.state().settings;
    assert_eq!((s.theme, s.navigation, s.memory_mib), (ThemeChoice::Dark, Navigation::Blender, Some(1 << 10)));
    assert!(s.max_samples == 256 && s.scale > 1.0);
    assert!(w.harness.unnamed_widgets().is_empty());
    w.key(Modifiers::NONE, Key::Escape);
    w.step();
    assert!(!w.has(Role::Window, "Settings"));
    w.button("Edit");
    w.button_that_contains("Settings…");
    w.step();
    assert!(w.has(Role::Window, "Settings"));
}

#[test]
fn settings_of_no_known_version_are_forgotten() {
    let mut drawer = Drawer::default();
    eframe::Storage::set_string(&mut drawer, "settings", "(structure: 7, what: [".into());
    let w = Window::with_storage(Setup::default(), drawer).settled();
    assert_eq!(w.shown(), Some("bvh"));
}
