//! From sums of samples to bytes: light is exposed and goes through a curve, colours are gamma-encoded, amounts go through
//! a range and a colour map.

use std::sync::LazyLock;

use rayon::prelude::*;

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

/// How light becomes colour.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(default)]
pub struct Tone {
    /// In stops: each doubles the light.
    pub exposure: f32,
    /// What becomes of light that is brighter than a picture can show.
    pub curve: Curve,
}

/// From light to what a screen shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Curve {
    /// As it is; what is too bright is white.
    #[default]
    Plain,
    /// Bent at both ends as film does (Narkowicz 2016, a fit of the curve of the Academy Color Encoding System).
    Filmic,
}

impl Curve {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Plain, Self::Filmic];

    /// The name on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Plain => "plain",
            Self::Filmic => "filmic",
        }
    }

    /// The name in the window.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Plain => "Plain",
            Self::Filmic => "Filmic",
        }
    }

    fn of(self, x: f32) -> f32 {
        match self {
            Self::Plain => x,
            Self::Filmic if x.is_finite() => {
                let x = x.clamp(0.0, 1e6);
                x * (2.51 * x + 0.03) / (x * (2.43 * x + 0.59) + 0.14)
            }
            Self::Filmic => 1.0,
        }
    }
}

impl std::str::FromStr for Curve {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|curve| curve.id() == s);
        known.ok_or_else(|| format!("there is no curve '{s}': use plain or filmic"))
    }
}

impl Tone {
    /// Linear light in a pixel's range of 0 to 1, not yet encoded.
    pub fn of(self, light: [f32; 3]) -> [f32; 3] {
        let factor = self.exposure.exp2();
        light.map(|x| self.curve.of(x * factor))
    }
}

/// How to develop.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Development {
    /// What the film holds.
    pub mode: Mode,
    /// For amounts.
    pub range: Range,
    /// For light: in [`Mode::Path`].
    pub tone: Tone,
    /// Behind what is hit: gamma-encoded red, green and blue; `None` leaves it transparent, and
    /// colours are multiplied by their opacity.
    pub background: Option<[f32; 3]>,
}

/// A range that suits the film: 0 to the amount that one pixel in two hundred exceeds; for depths,
/// from the nearest to the farthest.
pub fn auto_range(film: &Film, mode: Mode) -> Range {
    let amounts: Vec<f32> = film.means().filter(|m| m[3] > 0.0).map(|m| m[0] / m[3]).collect();
    fitting(amounts, mode == Mode::Depth)
}

/// The same of amounts, which may be depths.
pub(super) fn fitting(mut amounts: Vec<f32>, depths: bool) -> Range {
    if amounts.is_empty() {
        return Range { min: 0.0, max: 1.0 };
    }
    amounts.sort_unstable_by(f32::total_cmp);
    let last = amounts.len() - 1;
    match depths {
        true => Range { min: amounts[0], max: amounts[last].max(amounts[0].next_up()) },
        false => Range { min: 0.0, max: amounts[last - last / 200].max(1.0).ceil() },
    }
}

/// Pixels developed at a time.
pub(super) const CHUNK: usize = 4096;

impl Development {
    /// Four bytes a pixel (red, green, blue, opacity), row 0 at the top. Runs on the threads of the
    /// pool that it is called in.
    pub fn develop(&self, film: &Film) -> Vec<u8> {
        let mut rgba = vec![0; film.pixels() * 4];
        rgba.par_chunks_mut(4 * CHUNK).enumerate().for_each(|(chunk, rgba)| {
            for (pixel, rgba) in (chunk * CHUNK..).zip(rgba.as_chunks_mut().0) {
                *rgba = self.pixel(film.mean(pixel));
            }
        });
        rgba
    }

    fn pixel(&self, [r, g, b, coverage]: [f32; 4]) -> [u8; 4] {
        let color = if coverage <= 0.0 {
            [0.0; 3]
        } else if self.mode.is_scalar() {
            self.amount(r / coverage)
        } else {
            let color = [r, g, b].map(|x| x / coverage);
            (if self.mode == Mode::Path { self.tone.of(color) } else { color }).map(encode)
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

/// Steps of the table of [`encode`].
const STEPS: usize = 4096;

/// Linear light to sRGB by a table, linear in between: a twentieth of a byte's step off at most, and
/// far faster than a power for each channel of each pixel.
pub fn encode(x: f32) -> f32 {
    static TABLE: LazyLock<Vec<f32>> = LazyLock::new(|| (0..=STEPS).map(|i| srgb(i as f32 / STEPS as f32)).collect());
    let at = x.clamp(0.0, 1.0) * STEPS as f32;
    #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "between 0 and STEPS")]
    let i = (at as usize).min(STEPS - 1);
    TABLE[i] + (TABLE[i + 1] - TABLE[i]) * (at - i as f32)
}

/// Linear light to sRGB (IEC 61966-2-1).
fn srgb(x: f32) -> f32 {
    if x <= 0.003_130_8 { 12.92 * x } else { 1.055 * x.powf(1.0 / 2.4) - 0.055 }
}

#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "`as` saturates")]
pub(super) fn byte(x: f32) -> u8 {
    (x * 255.0 + 0.5) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_rise_and_exposure_doubles() {
        for curve in Curve::ALL {
            assert_eq!(curve.id().parse(), Ok(curve));
            let at: Vec<f32> = (0..400u16).map(|i| curve.of(f32::from(i) * 0.05)).collect();
            assert!(at[0].abs() < 1e-6 && at.is_sorted(), "{curve:?}");
        }
        let tone = Tone { exposure: 1.0, curve: Curve::Plain };
        assert_eq!(tone.of([0.25, 0.5, 0.0]), [0.5, 1.0, 0.0]);
        assert!(Curve::Filmic.of(100.0) <= 1.05 && Curve::Filmic.of(f32::INFINITY) == 1.0);
    }

    #[test]
    fn the_table_is_as_good_as_the_formula() {
        let worst = (0..=1_000_000u32).map(|i| i as f32 * 1e-6).map(|x| (encode(x) - srgb(x)).abs() * 255.0);
        assert!(worst.fold(0.0, f32::max) < 0.05);
        assert_eq!((byte(encode(-1.0)), byte(encode(7.0)), byte(encode(f32::NAN))), (0, 255, 0));
    }
}
