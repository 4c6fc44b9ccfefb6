//! From sums of samples to bytes: exposure is one, colours are gamma-encoded, amounts go through a
//! range and a colour map.

use super::colormap::viridis;
use super::{Film, Mode};

/// The amounts that the ends of the colour map stand for.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct Range {
    /// At the dark end.
    pub min: f32,
    /// At the bright end.
    pub max: f32,
}

/// How to develop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// What the film holds.
    pub mode: Mode,
    /// For amounts.
    pub range: Range,
    /// Behind what is hit: gamma-encoded red, green and blue; `None` leaves it transparent, and
    /// colours are multiplied by their opacity.
    pub background: Option<[f32; 3]>,
}

/// A range that suits the film: 0 to the amount that one pixel in two hundred exceeds; for depths,
/// from the nearest to the farthest.
pub fn auto_range(film: &Film, mode: Mode) -> Range {
    let mut amounts: Vec<f32> = film.means().filter(|m| m[3] > 0.0).map(|m| m[0] / m[3]).collect();
    if amounts.is_empty() {
        return Range { min: 0.0, max: 1.0 };
    }
    amounts.sort_unstable_by(f32::total_cmp);
    let last = amounts.len() - 1;
    match mode {
        Mode::Depth => Range { min: amounts[0], max: amounts[last].max(amounts[0].next_up()) },
        _ => Range { min: 0.0, max: amounts[last - last / 200].max(1.0).ceil() },
    }
}

impl Development {
    /// Four bytes a pixel (red, green, blue, opacity), row 0 at the top.
    pub fn develop(&self, film: &Film) -> Vec<u8> {
        film.means().flat_map(|mean| self.pixel(mean)).collect()
    }

    fn pixel(&self, [r, g, b, coverage]: [f32; 4]) -> [u8; 4] {
        let color = if coverage <= 0.0 {
            [0.0; 3]
        } else if self.mode.is_scalar() {
            self.amount(r / coverage)
        } else {
            [r, g, b].map(|x| encode(x / coverage))
        };
        let (behind, opacity) = self.background.map_or(([0.0; 3], coverage), |behind| (behind, 1.0));
        let over = |k: usize| byte(color[k] * coverage + behind[k] * (1.0 - coverage));
        [over(0), over(1), over(2), byte(opacity)]
    }

    fn amount(&self, amount: f32) -> [f32; 3] {
        let t = (amount - self.range.min) / (self.range.max - self.range.min);
        if self.mode == Mode::Depth { [1.0 - 0.85 * t.clamp(0.0, 1.0); 3] } else { viridis(t) }
    }
}

/// Linear light to sRGB.
fn encode(x: f32) -> f32 {
    let x = x.clamp(0.0, 1.0);
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
fn byte(x: f32) -> u8 {
    (x * 255.0 + 0.5) as u8
}
