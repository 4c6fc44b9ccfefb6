//! What the window's thread works to turn a frame's shapes into triangles. eframe does it after the program's own work, where
//! nobody can look, so for windows that the command line drives, which report their pace, it is done once more.

use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use eframe::egui::{Context, FullOutput, Plugin};

use crate::sys::thread_time;

/// What was worked since it was last asked.
#[derive(Clone, Default)]
pub struct Tessellation(Arc<Mutex<Duration>>);

impl Tessellation {
    /// Watches the frames of a window from now on.
    pub fn watch(ctx: &Context) -> Self {
        let taken = Self::default();
        ctx.add_plugin(Again(taken.clone()));
        taken
    }

    /// The time since the last call.
    pub fn take(&self) -> Duration {
        std::mem::take(&mut *self.0.lock().unwrap_or_else(PoisonError::into_inner))
    }
}

/// Tessellates every frame once more.
struct Again(Tessellation);

impl Plugin for Again {
    fn debug_name(&self) -> &'static str {
        "tessellation"
    }

    fn output_hook(&mut self, ctx: &Context, output: &mut FullOutput) {
        let shapes = output.shapes.clone();
        let start = thread_time();
        drop(ctx.tessellate(shapes, output.pixels_per_point));
        if let (Some(start), Some(end)) = (start, thread_time()) {
            *self.0.0.lock().unwrap_or_else(PoisonError::into_inner) += end.saturating_sub(start);
        }
    }
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use crate::viewer::theme;
    use eframe::egui::{Pos2, RawInput, Shape, Stroke, Ui};

    #[test]
    fn what_is_drawn_is_tessellated_and_told_once() {
        let ctx = Context::default();
        let taken = Tessellation::watch(&ctx);
        let curve: Vec<Pos2> = (0..10_000).map(|i| Pos2::new(i as f32, (i % 100) as f32)).collect();
        let mut output = ctx.run_ui(RawInput::default(), |ui: &mut Ui| {
            ui.painter().add(Shape::line(curve.clone(), Stroke::new(1.0, theme::TRIED)));
        });
        // Nobody is there to take the font.
        output.textures_delta.clear();
        assert!(taken.take() > Duration::ZERO);
        assert_eq!(taken.take(), Duration::ZERO);
    }
}
