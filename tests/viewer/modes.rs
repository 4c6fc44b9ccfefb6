//! What the picture shows.

use std::collections::HashSet;

use boxwood::render::Mode;
use eframe::egui::Role;
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::Window;

#[test]
fn every_mode_gives_its_picture() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    let mut pictures = HashSet::new();
    let picture = |w: &Window| w.state().picture.clone().expect("a picture");
    pictures.insert(picture(&w).rgba.clone());
    for mode in Mode::ALL.into_iter().filter(|m| *m != Mode::Shaded) {
        let (request, now) = (picture(&w).request, w.state().settings.mode.label());
        w.choose(now, mode.label());
        assert_eq!(w.state().settings.mode, mode);
        w.until(mode.id(), |s| s.picture.as_ref().is_some_and(|p| p.request > request && p.progress.done));
        w.step();
        assert!(pictures.insert(picture(&w).rgba.clone()), "{} looks like another", mode.id());
        assert_eq!(w.says(&format!("{} a ray", mode.label())), mode.is_heat(), "legend of {}", mode.id());
    }
    assert!(w.harness.get_by_role(Role::Canvas).accesskit_node().description().is_some_and(|d| d.contains("teapot")));
}
