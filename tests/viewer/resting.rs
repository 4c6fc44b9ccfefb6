//! A window with nothing to do rests, and one that is resized is never blank.

use std::time::Duration;

use boxwood::viewer::settings::Workspace;
use eframe::egui::{Event, ViewportId, pos2, vec2};
use image::RgbaImage;

use crate::common;
use crate::window::{Setup, Window};

/// Frames after which all that moves by itself has come to rest: sections that open, cards that appear.
const STILL: usize = 60;
/// A window that asks for no frame for so long asks for none.
const LONG: Duration = Duration::from_secs(60);

/// How soon the last frame asks for the next one.
fn next_frame(w: &Window) -> Duration {
    w.harness.output().viewport_output.get(&ViewportId::ROOT).expect("the window").repaint_delay
}

#[track_caller]
fn rests(w: &mut Window, when: &str) {
    w.settle();
    w.harness.event(Event::PointerGone);
    w.harness.run_steps(STILL);
    // What is over may still be said, such as what a switch of structures changed.
    w.until("nothing is said any more", |s| s.change.as_ref().is_none_or(|(_, until)| *until < std::time::Instant::now()));
    for _ in 0..3 {
        w.step();
        let causes = w.harness.ctx.repaint_causes();
        assert!(next_frame(w) > LONG, "{when}: the next frame in {:?}: {causes:?}", next_frame(w));
    }
}

#[test]
fn with_nothing_to_do_no_frame_is_asked_for() {
    let mut w = Window::with_model("builtin:teapot?triangles=1000");
    for workspace in Workspace::ALL {
        w.button(&format!("{} workspace", workspace.name()));
        rests(&mut w, workspace.name());
        if workspace == Workspace::Ray {
            let at = w.viewport().center();
            w.press_in_one_frame(at);
            w.until("its steps", |s| !s.rays.columns.is_empty());
            rests(&mut w, "a ray that is followed");
        }
    }
}

#[test]
fn a_hidden_window_rests_before_its_picture_is_done() {
    let mut setup = Setup::default();
    setup.options.model = Some("builtin:teapot?triangles=20000".to_owned());
    // So many samples that it would trace for long.
    setup.options.samples = Some(1 << 20);
    let mut w = Window::new(setup);
    w.ready();
    w.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default().minimized = Some(true);
    w.harness.run_steps(STILL);
    // What was on its way comes to an end.
    std::thread::sleep(Duration::from_millis(300));
    w.harness.run_steps(3);
    let samples = |w: &Window| w.state().picture.as_ref().map(|picture| picture.progress.samples);
    let before = samples(&w);
    std::thread::sleep(Duration::from_millis(300));
    w.harness.run_steps(3);
    assert_eq!(samples(&w), before);
    assert!(next_frame(&w) > LONG, "{:?}: {:?}", next_frame(&w), w.harness.ctx.repaint_causes());
    // It goes on where it is seen again.
    w.harness.input_mut().viewports.entry(ViewportId::ROOT).or_default().minimized = Some(false);
    w.until("more samples", |s| s.picture.as_ref().map(|picture| picture.progress.samples) > before);
}

/// Whether the middle of the view holds nothing but what is in its corner.
fn is_blank(image: &RgbaImage, w: &Window) -> bool {
    let view = w.viewport();
    let at = |x: f32, y: f32| {
        let p = pos2(view.left() + x * view.width(), view.top() + y * view.height());
        image.get_pixel((p.x as u32).min(image.width() - 1), (p.y as u32).min(image.height() - 1)).0
    };
    let corner = at(0.01, 0.01);
    let middle = (0u8..32).flat_map(|i| (0u8..32).map(move |k| [i, k].map(|n| 0.25 + 0.5 * f32::from(n) / 32.0)));
    middle.filter(|[x, y]| at(*x, *y) != corner).count() < 32
}

#[test]
fn no_frame_of_sixty_resizes_is_blank() {
    if !common::has_gpu("a view that is never blank") {
        return;
    }
    let mut setup = Setup { gpu: true, size: vec2(800.0, 600.0), ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=500".to_owned());
    setup.options.no_overlay = true;
    let mut w = Window::new(setup).settled();
    for i in 0u8..60 {
        // Wider and narrower, higher and lower, at different paces.
        let (x, y) = (f32::from(i % 12) / 11.0, f32::from(i % 7) / 6.0);
        w.harness.set_size(vec2(700.0 + 300.0 * x, 520.0 + 160.0 * y));
        w.step();
        let image = w.harness.render().expect("drawn");
        assert!(!is_blank(&image, &w), "resize {i}: the view {} is blank", w.viewport());
    }
}
