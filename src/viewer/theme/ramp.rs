//! Colours for numbers: viridis for heat and for depth, blue to white to orange for differences.

use std::ops::RangeInclusive;

use eframe::egui::Color32;

pub use crate::render::colormap::viridis;

/// Where a level lies on viridis: from the darkest that is used to 1 over the levels that are shown, one even step a level.
pub fn depth_position(level: u32, shown: &RangeInclusive<u32>) -> f32 {
    let (first, last) = (*shown.start(), *shown.end());
    let t = if last > first { level.clamp(first, last).abs_diff(first) as f32 / (last - first) as f32 } else { 0.5 };
    LEAST + (1.0 - LEAST) * t
}

/// The colour of a level of a tree when the levels `shown` are on the screen.
pub fn depth_color(level: u32, shown: &RangeInclusive<u32>) -> Color32 {
    opaque(viridis(depth_position(level, shown)))
}

/// The colour of an amount between two others: in even steps, or in even ratios where one is more than ten times the other.
/// It begins where lines can be told on the dark background.
pub fn amount_color(value: f32, [low, high]: [f32; 2]) -> Color32 {
    let even = |x: f32| if low > 0.0 && high > 10.0 * low { x.max(low).ln() } else { x };
    let (value, low, high) = (even(value), even(low), even(high));
    let t = if high > low { ((value - low) / (high - low)).clamp(0.0, 1.0) } else { 0.5 };
    opaque(viridis(LEAST + (1.0 - LEAST) * t))
}

/// The colour of a place on viridis, from 0 to 1; what is beyond has that of the end.
pub fn heat_color(t: f32) -> Color32 {
    opaque(viridis(t))
}

/// The darkest that lines can be told on the dark background.
const LEAST: f32 = 0.35;

fn opaque(rgb: [f32; 3]) -> Color32 {
    let [r, g, b] = rgb.map(|v| (v * 255.0).round() as u8);
    Color32::from_rgb(r, g, b)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viridis_meets_its_table() {
        let table =
            [(0.0, [68, 1, 84]), (0.25, [59, 82, 139]), (0.5, [33, 145, 140]), (0.75, [94, 201, 98]), (1.0, [253, 231, 37])];
        for (t, rgb) in table {
            for (k, expected) in rgb.into_iter().enumerate() {
                let got = viridis(t)[k] * 255.0;
                assert!((got - expected as f32).abs() <= 5.0, "{t}: {got} for {expected}");
            }
        }
        assert_eq!(viridis(f32::NAN), viridis(0.0));
        assert_eq!(viridis(7.0), viridis(1.0));
    }

    #[test]
    fn each_level_is_one_even_step() {
        let shown = 3..=7;
        assert_eq!(depth_position(3, &shown), 0.35);
        assert_eq!(depth_position(7, &shown), 1.0);
        let steps: Vec<f32> = (4..=7).map(|l| depth_position(l, &shown) - depth_position(l - 1, &shown)).collect();
        assert!(steps.iter().all(|s| (s - steps[0]).abs() < 1e-6));
        assert_eq!(depth_color(5, &(5..=5)), opaque(viridis(0.675)));
    }
}
