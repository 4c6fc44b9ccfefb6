//! Viewports in a window of egui.

use std::sync::Arc;

use eframe::egui::{self, Rect, pos2, vec2};

use super::device::Headless;
use super::{list, picture};
use crate::viewer::gpu::{Base, install, paint, size_px};

/// Two viewports side by side, each in a colour of its own.
struct TwoPanes;

impl eframe::App for TwoPanes {
    fn ui(&mut self, ui: &mut egui::Ui, _frame: &mut eframe::Frame) {
        for (pane, rgb) in [(1, [200, 30, 30]), (2, [30, 30, 200])] {
            let rect = Rect::from_min_size(pos2(10.0 + 60.0 * (pane - 1) as f32, 10.0), vec2(50.0, 80.0));
            let rgba = [rgb[0], rgb[1], rgb[2], 255].to_vec();
            let picture = picture(pane, 1, 1, rgba, vec![1.0]);
            let mut list = list(0, Base::Picture(Arc::new(picture)));
            list.size_px = size_px(rect, ui.ctx().pixels_per_point());
            paint(ui.painter(), rect, pane, list);
        }
    }
}

#[test]
fn each_viewport_is_where_it_belongs() {
    // Kept, so that no other test makes a device meanwhile.
    let Some(_headless) = Headless::new("viewports in a window") else { return };
    for scale in [1.0, 1.5] {
        let harness = egui_kittest::Harness::builder().with_size(vec2(130.0, 100.0)).with_pixels_per_point(scale).wgpu();
        let mut harness = harness.build_eframe(|cc| {
            install(cc.wgpu_render_state.as_ref().expect("there is an adapter"));
            TwoPanes
        });
        harness.step();
        let image = harness.render().expect("drawn");
        let at = |x: f32, y: f32| image.get_pixel((x * scale) as u32, (y * scale) as u32).0;
        for (x, y) in [(11.0, 11.0), (35.0, 50.0), (59.0, 89.0)] {
            assert_eq!(at(x, y), [200, 30, 30, 255], "at scale {scale}");
            assert_eq!(at(x + 60.0, y), [30, 30, 200, 255], "at scale {scale}");
        }
        assert_ne!(at(65.0, 50.0), at(35.0, 50.0), "nothing between them");
        assert_ne!(at(65.0, 50.0), at(95.0, 50.0));
    }
}

#[test]
fn a_window_without_a_gpu_just_shows_nothing() {
    let mut harness = egui_kittest::Harness::builder().with_size(vec2(130.0, 100.0)).build_eframe(|cc| {
        assert!(cc.wgpu_render_state.is_none());
        TwoPanes
    });
    harness.step();
}
