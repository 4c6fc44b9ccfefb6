//! Heat maps: whose work they show, the range of their colours, what a pixel stands for, and the times of tiles.

use boxwood::lab::tile_times::TILE;
use boxwood::render::{HeatRays, Mode};
use boxwood::viewer::format;
use boxwood::viewer::settings::Workspace;
use eframe::egui::{Event, Key, Modifiers, PointerButton, Pos2, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec2;

use crate::window::{Setup, Window};

const TEAPOT: &str = "builtin:teapot?triangles=1000";
const TILES: &str = "Nanoseconds by tile";

fn open(structure: &str, mode: Mode, alone: bool) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 800.0), alone, ..Setup::default() };
    setup.options.model = Some(TEAPOT.to_owned());
    setup.options.structure = Some(structure.to_owned());
    setup.options.mode = Some(mode);
    Window::new(setup).settled()
}

#[test]
fn a_heat_map_is_of_the_rays_that_are_chosen() {
    let mut w = open("bvh", Mode::Shaded, false);
    let name = "Rays of the heat map";
    assert!(!w.has(Role::ComboBox, name), "other pictures have no such choice");
    w.choose("Shaded", Mode::Nodes.label());
    w.settle();
    assert!(w.has(Role::ComboBox, name));
    let mut pictures = vec![w.state().picture.clone().expect("traced").rgba.clone()];
    for [before, rays] in [[HeatRays::Primary, HeatRays::Shadow], [HeatRays::Shadow, HeatRays::Bounce]] {
        w.choose(before.label(), rays.label());
        w.settle();
        assert_eq!(w.state().settings.heat_rays, rays);
        assert!(w.says(&format!("{} {}", Mode::Nodes.label(), rays.each())));
        pictures.push(w.state().picture.clone().expect("traced").rgba.clone());
    }
    assert!(pictures[0] != pictures[1] && pictures[1] != pictures[2]);
    w.choose(Mode::Nodes.label(), "Shaded");
    w.settle();
    assert!(!w.has(Role::ComboBox, name));
}

#[test]
fn the_ends_of_the_colours_are_dragged_moved_by_keys_typed_and_fitted() {
    let mut w = open("bvh", Mode::Nodes, false);
    assert!(w.has(Role::Image, "Histogram of the heat map"));
    assert!(w.harness.unnamed_widgets().is_empty());
    let fitted = w.state().picture.as_ref().expect("traced").range;
    assert!(w.state().range.is_none());
    let camera = w.state().camera;
    let handle = |w: &Window, name: &str| -> Pos2 { w.harness.get_by_role_and_label(Role::Slider, name).rect().center() };
    let (dark, bright) = ("Dark end of the colours", "Bright end of the colours");
    w.drag(handle(&w, bright), vec2(-60.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    let range = w.state().range.expect("set by hand");
    assert!(range.max < fitted.max && range.min == fitted.min, "{range:?} of {fitted:?}");
    w.settle();
    assert_eq!(w.state().picture.as_ref().expect("traced").range, range);
    // The end that was dragged has the focus.
    w.key(Modifiers::NONE, Key::ArrowRight);
    let moved = w.state().range.expect("set by keys");
    assert!(moved.max > range.max && moved.min == range.min);
    w.drag(handle(&w, dark), vec2(400.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    let shut = w.state().range.expect("set by hand");
    assert!(shut.min < shut.max && shut.max <= moved.max + 1.0, "an end stops at the other: {shut:?}");
    w.click(Role::SpinButton, "Least amount");
    w.key(Modifiers::COMMAND, Key::A);
    w.harness.event(Event::Text("2".to_owned()));
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.state().range.map(|range| range.min), Some(2.0));
    w.settle();
    assert_eq!(w.state().picture.as_ref().map(|picture| picture.range), w.state().range);
    w.button("Auto-fit");
    w.settle();
    assert!(w.state().range.is_none());
    assert_eq!(w.state().picture.as_ref().expect("traced").range, fitted);
    assert_eq!(w.state().camera, camera, "nothing of this turns the view");
    // It is there in the Ray workspace too.
    w.button("Ray workspace");
    w.settle();
    assert!(w.state().settings.workspace == Workspace::Ray && w.has(Role::Slider, dark));
}

#[test]
fn the_amount_of_a_pixel_is_told_under_the_pointer_and_once_it_is_clicked() {
    let mut w = open("bvh", Mode::Prims, false);
    let view = w.viewport();
    let at = view.center() + vec2(10.3, 7.7);
    let amount = |w: &Window| {
        let within = (at - view.min) / view.size();
        let picture = w.state().picture.clone().expect("traced");
        picture.amount_at(Vec2::new(within.x * 2.0 - 1.0, 1.0 - within.y * 2.0)).expect("on the teapot")
    };
    w.harness.hover_at(at);
    w.step();
    w.step();
    let told = format::number(amount(&w).into());
    assert!(w.says(&format!("here: {told}")), "{told}");
    w.press_in_one_frame(at);
    w.until("a selection", |s| s.picked.is_some());
    w.settle();
    w.harness.remove_cursor();
    w.step();
    w.step();
    assert_eq!(w.state().clicked_amount(), Some(amount(&w)));
    assert!(w.says(&format!("clicked: {told}")));
    let said = w.harness.get_by_role(Role::Canvas).accesskit_node().description().unwrap_or_default();
    assert!(said.contains(&format!("{told} at the clicked pixel")), "{said}");
    // From elsewhere it is another pixel's.
    w.key(Modifiers::NONE, Key::P);
    w.settle();
    assert_eq!(w.state().clicked_amount(), None);
    assert!(!w.says("clicked: "));
}

#[test]
fn tiles_are_timed_and_shown_as_long_as_the_view_stays() {
    let mut w = open("bvh", Mode::Shaded, true);
    w.choose("Shaded", TILES);
    assert!(w.state().tiles.shown && w.says("Not timed.") && !w.state().shows_tiles());
    w.button("Time the tiles");
    assert!(w.state().is_measuring());
    w.until("times", |s| s.tiles.found.is_some());
    w.settle();
    let state = w.state();
    let (_, times) = state.tiles.found.clone().expect("timed");
    let [width, height] = state.size_px;
    assert_eq!(times.ns.len(), (width.div_ceil(TILE) * height.div_ceil(TILE)) as usize);
    assert_eq!(times.rays, u64::from(width) * u64::from(height));
    assert!(state.shows_tiles() && w.says("Nanoseconds a ray, by tile") && !w.says("Not timed."));
    let picture = state.on_screen().cloned().expect("drawn");
    let (first, second) = ((picture.width, picture.height), state.picture.as_ref().expect("traced"));
    assert_eq!((first, picture.camera, picture.depth.len()), ((width, height), second.camera, second.depth.len()));
    let pixel = |x: u32, y: u32| picture.rgba[4 * (y * width + x) as usize..][..4].to_vec();
    assert_eq!(pixel(0, 0), pixel(TILE - 1, TILE - 1));
    assert_eq!(pixel(2 * TILE, TILE), pixel(3 * TILE - 1, TILE));
    // Its range is changed like any other.
    w.click(Role::SpinButton, "Greatest amount");
    w.key(Modifiers::COMMAND, Key::A);
    w.harness.event(Event::Text("5000".to_owned()));
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    assert_eq!(w.state().on_screen().map(|picture| picture.range.max), Some(5000.0));
    // Another view is not what was timed.
    w.key(Modifiers::NONE, Key::P);
    w.settle();
    assert!(!w.state().shows_tiles() && w.says("Timed of an earlier view.") && w.has(Role::Button, "Time the tiles"));
    w.choose(TILES, "Shaded");
    w.settle();
    assert!(!w.state().tiles.shown && !w.says("Timed of an earlier view."));
}

#[test]
fn timing_tiles_can_be_cancelled() {
    let mut w = open("brute", Mode::Nodes, true);
    w.choose(Mode::Nodes.label(), TILES);
    w.button("Time the tiles");
    w.until("progress", |s| {
        s.tiles.running.as_ref().is_some_and(|(_, job)| job.progress.snapshot().fraction.is_some_and(|share| share > 0.0))
    });
    w.button("Cancel timing the tiles");
    assert!(w.state().tiles.running.is_none() && w.state().tiles.found.is_none());
    w.settle();
    assert!(w.says("Not timed.") && w.has(Role::Button, "Time the tiles"));
}

#[test]
fn a_structure_without_a_stack_says_so() {
    let mut w = open("bvh", Mode::Stack, false);
    assert!(w.state().picture.as_ref().is_some_and(|picture| picture.range.max > 1.0));
    w.button("Grid");
    w.settle();
    assert!(w.says("No stack depth: a grid keeps no stack, the ray goes from cell to cell."));
    w.choose(Mode::Stack.label(), "Shaded");
    w.settle();
    w.harness.get_by(|n| n.role() == Role::ComboBox && n.value().as_deref() == Some("Shaded")).click();
    w.step();
    w.step();
    assert!(!w.has(Role::Button, Mode::Stack.label()) && w.says("No stack depth: a grid keeps no stack"));
}
