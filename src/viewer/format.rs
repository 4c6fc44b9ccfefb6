//! How numbers are written: as in every table and report.

pub use crate::lab::format::*;

#[cfg(test)]
mod tests {
    #[test]
    fn every_sign_is_in_the_bundled_font() {
        use eframe::egui::{Context, FontId};
        let ctx = Context::default();
        ctx.run_ui(Default::default(), |_| {}).drop_without_applying_deltas();
        let font = FontId::proportional(crate::viewer::theme::BODY);
        assert!(ctx.fonts_mut(|fonts| fonts.has_glyphs(&font, "0123456789.-e–±µ%x\u{2009}")));
    }
}
