//! The tour: at the first start alone, each step shown by doing it, the window in use meanwhile.

use boxwood::render::Mode;
use boxwood::viewer::settings::Workspace;
use boxwood::viewer::tour::{LECTURE, STADIUM, STEPS};
use eframe::egui::{Key, Modifiers, Rect, Role, Vec2, vec2};
use egui_kittest::kittest::Queryable;

use crate::settings::Drawer;
use crate::window::{Setup, Window};

fn on_tour(size: Vec2, alone: bool) -> Window {
    let mut setup = Setup { size, alone, ..Setup::default() };
    setup.options.tour = Some(0);
    Window::new(setup).settled()
}

fn card(w: &Window) -> Rect {
    w.harness.get_by_role_and_label(Role::Window, "Tour").rect()
}

/// Goes on to the next step and waits for what it shows.
fn next(w: &mut Window) {
    w.button("Next in the tour");
    w.settle();
}

fn model(w: &Window) -> String {
    w.state().model.as_ref().expect("open").scene.name.clone()
}

#[test]
fn each_step_shows_what_it_says() {
    // One of them measures.
    let mut w = on_tour(vec2(1280.0, 800.0), true);
    assert!(w.says("Step 1 of 6") && w.says(STEPS[0].title));
    let overlay = w.state().settings.overlay;
    assert_eq!((model(&w).as_str(), overlay.boxes, overlay.from_depth, overlay.depth), (LECTURE, true, 1, 1));
    next(&mut w);
    assert_eq!((w.state().settings.workspace, w.state().tree.selected), (Workspace::Structure, Some(0)));
    next(&mut w);
    assert!(w.says("Step 3 of 6") && w.state().tree.tried.is_some());
    next(&mut w);
    let rays = &w.state().rays;
    assert_eq!(w.state().settings.workspace, Workspace::Ray);
    assert!(rays.at > 0 && rays.columns[0].followed.hit.is_some());
    // The one before, and on again.
    w.button("Back in the tour");
    w.settle();
    assert_eq!(w.state().settings.workspace, Workspace::Structure);
    next(&mut w);
    next(&mut w);
    assert!(w.state().timings.view.is_some());
    // Its whole picture takes thousands of tests a ray, which is what it shows.
    w.button("Next in the tour");
    w.until("the stadium", |s| {
        let there = s.model.as_ref().is_some_and(|model| model.scene.name == STADIUM) && s.settings.mode == Mode::Prims;
        there && s.shown.as_ref().is_some_and(|shown| shown.key.entry.id == "grid") && s.picture.is_some()
    });
    w.button("Done with the tour");
    assert!(w.state().tour.is_none() && !w.has(Role::Window, "Tour"));
}

#[test]
fn the_window_is_used_meanwhile_and_esc_leaves() {
    let mut w = on_tour(vec2(1280.0, 800.0), false);
    w.button("k-d tree");
    w.settle();
    assert_eq!(w.shown(), Some("kdtree"));
    assert!(w.state().tour.is_some());
    w.key(Modifiers::NONE, Key::Escape);
    assert!(w.state().tour.is_none());
    w.button("Help");
    w.button("Tour");
    w.settle();
    assert_eq!((w.state().tour.map(|tour| tour.at), w.shown()), (Some(0), Some("bvh")));
}

#[test]
fn the_card_stands_in_the_view_of_small_windows() {
    let mut w = on_tour(vec2(960.0, 600.0), false);
    for (i, step) in STEPS.iter().take(4).enumerate() {
        w.step();
        let (card, view) = (card(&w), w.viewport());
        assert!(view.expand(1.0).contains_rect(card), "{}: {card} in {view}", step.title);
        if i < 3 {
            next(&mut w);
        }
    }
}

#[test]
fn it_begins_at_the_first_start_alone() {
    let mut w = Window::with_storage(Setup::default(), Drawer::default()).settled();
    assert_eq!(w.state().tour.map(|tour| tour.at), Some(0));
    w.button("Skip the tour");
    let mut drawer = Drawer::default();
    eframe::App::save(w.harness.state_mut(), &mut drawer);
    drop(w);
    let w = Window::with_storage(Setup::default(), drawer).settled();
    assert!(w.state().tour.is_none());
    drop(w);
    // Nor where a model was asked for.
    let mut setup = Setup::default();
    setup.options.model = Some(LECTURE.to_owned());
    let w = Window::with_storage(setup, Drawer::default()).settled();
    assert!(w.state().tour.is_none());
}
