//! What compared pictures show: any kind beside any other, what each amounts to, and the colours of boxes over them.

use std::sync::Arc;

use boxwood::accel::Accel;
use boxwood::render::sampler::Sampling;
use boxwood::render::{self, Mode, Until};
use boxwood::task::{Cancel, Pool, Progress};
use boxwood::viewer::compared::spread;
use boxwood::viewer::panes::{Arrange, Shows};
use boxwood::viewer::settings::BoxColor;
use boxwood::viewer::state::State;
use boxwood::viewer::{format, theme};
use eframe::egui::{Event, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};
use glam::Vec2;

use crate::panes::{by_name, compare, pictures, place, setup};
use crate::window::Window;

/// Chooses what is shown of a pane's hits.
fn show_of(w: &mut Window, letter: &str, shows: &str) {
    w.harness.get_by_role_and_label(Role::ComboBox, &format!("Picture of {letter}")).click();
    w.step();
    w.step();
    w.button(shows);
    w.settle();
}

/// The bytes of the present view through a structure, rendered alone.
fn alone(s: &State, accel: &Arc<dyn Accel>, mode: Mode) -> Vec<u8> {
    let (model, samples) = (s.model.as_ref().expect("open"), s.settings.max_samples);
    let (scene, looks) = (Arc::clone(&model.scene), Arc::clone(&model.looks));
    let whole = render::Job::new(scene, Arc::clone(accel), s.camera, mode, looks);
    let job = render::Job { sampling: Sampling { kind: s.settings.sampler, seed: 0 }, ..whole };
    let until = Until { adaptive: true, ..Until::samples(samples) };
    let (pool, [width, height]) = (Pool::new("alone", 2), s.size_px);
    let still = render::render(&job, (width, height), &until, &pool, &Cancel::new(), &Progress::new()).expect("not cancelled");
    still.develop(&job, None, s.settings.tone, None, &pool)
}

#[test]
fn a_path_traced_picture_stands_beside_any_other() {
    let mut setup = setup(&["bvh", "kdtree"], Arrange::Divider, Mode::Shaded);
    setup.options.model = Some("builtin:cornell-box".to_owned());
    setup.options.samples = Some(4);
    let mut w = Window::new(setup).settled();
    let exposed = |w: &Window| w.has(Role::ComboBox, "Tone") && w.has(Role::ComboBox, "Sampler");
    assert!(!exposed(&w));
    show_of(&mut w, "B", Mode::Path.label());
    assert!(w.state().settings.panes.others[0].shows == Shows::Mode(Mode::Path) && exposed(&w));
    let as_alone = |w: &Window, modes: [Mode; 2]| {
        let s = w.state();
        let structures = [s.shown.as_ref(), s.panes.all[0].built.as_ref()].map(|built| &built.expect("built").accel);
        for ((picture, accel), mode) in pictures(s).iter().zip(structures).zip(modes) {
            assert!(picture.progress.done && picture.progress.samples == 4 && [picture.width, picture.height] == s.size_px);
            assert!(picture.rgba == alone(s, accel, mode), "{} of {modes:?}", mode.id());
            assert_eq!(picture.progress.exposure.is_some(), mode == Mode::Path);
        }
    };
    as_alone(&w, [Mode::Shaded, Mode::Path]);
    assert!(w.state().fitting_exposure().is_some());
    // The first one, too, and other amounts beside it.
    w.choose(Mode::Shaded.label(), Mode::Path.label());
    w.settle();
    assert!(w.state().is_split() && exposed(&w));
    as_alone(&w, [Mode::Path, Mode::Path]);
    show_of(&mut w, "B", Mode::Shaded.label());
    as_alone(&w, [Mode::Path, Mode::Shaded]);
    // Seconds of a picture that shares its threads are no curve.
    let curves = |w: &Window| w.state().errors.curves.len();
    assert!(curves(&w) == 0 && w.says("Errors are those of one picture, which has all threads to itself."));
    w.button("One picture again");
    w.settle();
    assert!(w.state().panes.all.is_empty() && curves(&w) == 1);
}

#[test]
fn amounts_are_told_of_each_picture_and_those_of_one_range_counted_together() {
    let mut w = compare(&["bvh", "kdtree", "grid"], Arrange::Divider, Mode::Nodes);
    let counted = |w: &Window, which: &[usize]| {
        let all = pictures(w.state());
        let values = which.iter().flat_map(|i| all[*i].amounts.as_ref().expect("a heat map").values.clone());
        let pixels = values.filter(|amount| amount.is_finite()).count();
        let spread = spread(w.state()).expect("heat maps");
        assert_eq!(spread.histogram.counts.iter().map(|pixels| *pixels as usize).sum::<usize>(), pixels);
        assert!(pixels > 1000 && spread.histogram.end() > spread.range.max, "{pixels}");
        spread.of
    };
    assert_eq!(counted(&w, &[0, 1, 2]), ["A", "B", "C"]);
    assert!(w.says("Pixels of A, B and C together: they share the range."));
    // A difference has amounts of its own, which have signs; C's are of another kind.
    show_of(&mut w, "B", "A less B");
    assert_eq!(counted(&w, &[0, 2]), ["A", "C"]);
    show_of(&mut w, "C", Mode::Prims.label());
    assert_eq!(counted(&w, &[0]), ["A"]);
    assert!(!w.says("they share the range"));
    let view = place(&w, 0).view;
    let at = view.center() + vec2(10.3, 7.7);
    let within = (at - view.min) / view.size();
    let amounts: Vec<f32> = pictures(w.state())
        .iter()
        .map(|picture| picture.amount_at(Vec2::new(within.x * 2.0 - 1.0, 1.0 - within.y * 2.0)).expect("on the teapot"))
        .collect();
    let less = f64::from(amounts[0] - amounts[1]);
    let sign = if less > 0.0 { "+" } else { "" };
    let told = [
        format!("A, BVH: {}", format::number(amounts[0].into())),
        format!("A less B: {sign}{}", format::number(less)),
        format!("C, Grid, primitives tested: {}", format::number(amounts[2].into())),
    ];
    w.harness.hover_at(at);
    w.step();
    w.step();
    assert!(w.says(&format!("Here\n{}", told.join("\n"))), "{told:?}");
    w.press_in_one_frame(at);
    w.until("a selection", |s| s.picked.is_some());
    w.settle();
    w.harness.remove_cursor();
    w.step();
    w.step();
    assert!(w.says(&format!("Clicked\n{}", told.join("\n"))), "{told:?}");
    let said = w.harness.get_by_role(Role::Canvas).accesskit_node().description().unwrap_or_default();
    assert!(told.iter().all(|told| said.contains(&format!("{told} at the clicked pixel"))), "{said}");
}

#[test]
fn a_heat_map_beside_a_shaded_picture_has_a_histogram_and_a_range() {
    let mut w = compare(&["bvh", "kdtree"], Arrange::Two, Mode::Shaded);
    assert!(spread(w.state()).is_none() && !w.has(Role::Image, "Histogram of the heat map"));
    show_of(&mut w, "B", Mode::Nodes.label());
    assert_eq!(spread(w.state()).map(|spread| spread.of), Some(vec!["B"]));
    assert!(w.has(Role::Image, "Histogram of the heat map") && !w.has(Role::ComboBox, "Rays of the heat map"));
    w.click(Role::SpinButton, "Least amount");
    w.key(Modifiers::COMMAND, Key::A);
    w.harness.event(Event::Text("2".to_owned()));
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    w.settle();
    assert_eq!(pictures(w.state())[1].range.min, 2.0);
    // Of other amounts it is another range.
    show_of(&mut w, "B", Mode::Prims.label());
    let all = pictures(w.state());
    assert!(w.state().range.is_none() && all[1].range == all[1].suits);
}

#[test]
fn boxes_over_all_pictures_have_the_chosen_colours_over_one_range() {
    let mut w = compare(&["bvh", "bvh", "kdtree"], Arrange::Four, Mode::Shaded);
    let boxes = |w: &Window, which: usize| {
        let overlays = std::iter::once(&w.state().overlay).chain(w.state().panes.all.iter().map(|pane| &pane.overlay));
        overlays.map(|overlay| overlay.as_ref().expect("collected").boxes.clone()).nth(which).expect("one each")
    };
    let by_depth = boxes(&w, 2);
    for color in [BoxColor::Triangles, BoxColor::Cost, BoxColor::Overlap, BoxColor::Visits] {
        by_name(&mut w, &format!("Colour boxes by {}", color.name()));
        w.settle();
        assert_eq!(w.state().settings.overlay.color, color);
        assert!(!boxes(&w, 0).is_empty() && boxes(&w, 0) == boxes(&w, 1), "one structure: {color:?}");
        let known = boxes(&w, 2).iter().filter(|b| b.color != theme::UNKNOWN.to_array()).count();
        // Cells that divide space do not overlap.
        assert_eq!(known, if color == BoxColor::Overlap { 0 } else { boxes(&w, 2).len() }, "{color:?}");
        assert!(boxes(&w, 2) != by_depth && !by_depth.is_empty(), "{color:?}");
        let (range, own) = (w.state().collected.range.expect("amounts"), w.state().collected.amounts.expect("amounts"));
        assert!(range[0] <= own[0] && own[1] <= range[1], "{color:?}: {range:?} holds {own:?}");
    }
    by_name(&mut w, "Colour boxes by Depth");
    w.settle();
    assert_eq!(boxes(&w, 2), by_depth);
}
