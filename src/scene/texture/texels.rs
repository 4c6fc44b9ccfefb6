//! A decoded image, and what its value is at a point.

use std::sync::LazyLock;

use glam::Vec2;

use super::sampler::{Filter, Sampler};
use crate::geometry::num;
use crate::scene::load::linear_from_srgb;

/// A decoded image. It holds only the channels that materials read.
#[derive(Clone, PartialEq)]
pub struct Texture {
    pub(super) width: usize,
    pub(super) height: usize,
    pub(super) layout: Layout,
    /// Rows from the top, texels from the left, colours as stored (sRGB).
    pub(super) texels: Vec<u8>,
    /// Whether every texel of [`Layout::Value`] is 255.
    pub(super) full: bool,
}

/// A channel of an image that a single value is read from: opacity, say, or roughness.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Red, as stored.
    Red,
    /// Green, as stored.
    Green,
    /// Blue, as stored.
    Blue,
    /// The alpha channel; 1 where the image has none.
    Alpha,
    /// Brightness, of the colours as stored.
    Luminance,
    /// The alpha channel where it says anything, that is, where it is not 1 everywhere, and
    /// brightness where it does not: masks are stored as either.
    Mask,
}

/// The channels of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Layout {
    /// The one value that materials read, of this channel.
    Value(Channel),
    Grey,
    GreyAlpha,
    Rgb,
    Rgba,
}

/// Linear light by stored value.
static LINEAR: LazyLock<[f32; 256]> = LazyLock::new(|| {
    let mut table = [0.0; 256];
    for (stored, linear) in (0u8..=255).zip(&mut table) {
        [*linear, ..] = linear_from_srgb([f32::from(stored) / 255.0; 3]);
    }
    table
});

impl Texture {
    /// Its width and height in texels.
    pub fn size(&self) -> (usize, usize) {
        (self.width, self.height)
    }

    /// What is stored, row by row.
    pub(crate) fn texels(&self) -> &[u8] {
        &self.texels
    }

    /// Bytes of its texels.
    pub fn bytes(&self) -> u64 {
        self.texels.len() as u64
    }

    /// The linear colour at `uv`, and opacity where the texture holds it, or else 1. Filtering is
    /// of linear values and of alpha on its own, as on graphics cards.
    pub fn color(&self, uv: Vec2, sampler: &Sampler) -> [f32; 4] {
        let linear = &*LINEAR;
        self.filtered(uv, sampler, |texel| self.layout.color(texel, linear))
    }

    /// Opacity at `uv`, of the alpha channel. The same bits on every machine.
    pub fn alpha(&self, uv: Vec2, sampler: &Sampler) -> f32 {
        self.value(uv, sampler, Channel::Alpha)
    }

    /// Red, green and blue at `uv`, 0 to 1 as stored: what is no colour has no curve. The same bits on every machine.
    pub fn stored(&self, uv: Vec2, sampler: &Sampler) -> [f32; 3] {
        self.filtered(uv, sampler, |texel| self.layout.rgb(texel).map(|stored| f32::from(stored) / 255.0))
    }

    /// The mean linear colour of all texels.
    pub fn mean_color(&self) -> [f32; 3] {
        // Counted first: the same few colours come again and again.
        let mut counts = [[0u64; 256]; 3];
        for texel in self.texels.chunks_exact(self.layout.channels()) {
            for (counts, stored) in counts.iter_mut().zip(self.layout.rgb(texel)) {
                counts[usize::from(stored)] += 1;
            }
        }
        let mean = |counts: [u64; 256]| {
            let sum: f64 = counts.iter().zip(&*LINEAR).map(|(n, linear)| *n as f64 * f64::from(*linear)).sum();
            num::narrow(sum / counts.iter().sum::<u64>().max(1) as f64)
        };
        counts.map(mean)
    }

    /// The value of one channel at `uv`, 0 to 1 as stored. The same bits on every machine.
    pub fn value(&self, uv: Vec2, sampler: &Sampler, channel: Channel) -> f32 {
        let [value] = self.filtered(uv, sampler, |texel| [self.layout.value(texel, channel)]);
        value
    }

    /// Whether its colours are there, and not the values of one channel alone.
    pub fn has_colors(&self) -> bool {
        !matches!(self.layout, Layout::Value(_))
    }

    /// Whether values of a channel can be read, and it does not hold those of another alone.
    pub fn has(&self, channel: Channel) -> bool {
        match self.layout {
            Layout::Value(only) => only == channel,
            _ => true,
        }
    }

    /// Whether a channel is known to be 1 everywhere.
    pub fn is_one(&self, channel: Channel) -> bool {
        match self.layout {
            Layout::Value(_) => self.full,
            // A channel of nothing but ones is not kept.
            Layout::Grey | Layout::Rgb => channel == Channel::Alpha,
            Layout::GreyAlpha | Layout::Rgba => false,
        }
    }

    fn filtered<const N: usize>(&self, uv: Vec2, sampler: &Sampler, value: impl Fn(&[u8]) -> [f32; N]) -> [f32; N] {
        let Sampler { wrap_u, wrap_v, filter } = *sampler;
        let texel = |x: usize, y: usize| {
            let n = self.layout.channels();
            value(&self.texels[(y * self.width + x) * n..][..n])
        };
        if filter == Filter::Nearest {
            return texel(wrap_u.texel(uv.x, self.width), wrap_v.texel(uv.y, self.height));
        }
        let (x, y) = (wrap_u.between(uv.x, self.width), wrap_v.between(uv.y, self.height));
        let row = |y: usize| mix(texel(x.first, y), texel(x.second, y), x.weight);
        mix(row(y.first), row(y.second), y.weight)
    }
}

/// Exact where both are the same.
#[inline]
fn mix<const N: usize>(a: [f32; N], b: [f32; N], t: f32) -> [f32; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

impl Layout {
    #[inline]
    pub fn channels(self) -> usize {
        match self {
            Self::Value(_) | Self::Grey => 1,
            Self::GreyAlpha => 2,
            Self::Rgb => 3,
            Self::Rgba => 4,
        }
    }

    #[inline]
    fn color(self, texel: &[u8], linear: &[f32; 256]) -> [f32; 4] {
        let [r, g, b] = self.rgb(texel).map(|stored| linear[usize::from(stored)]);
        [r, g, b, self.value(texel, Channel::Alpha)]
    }

    #[inline]
    fn value(self, texel: &[u8], channel: Channel) -> f32 {
        let (sum, of) = self.weighed(texel, channel);
        sum as f32 / of as f32
    }

    /// A channel of a texel as a fraction.
    #[inline]
    pub fn weighed(self, texel: &[u8], channel: Channel) -> (u16, u16) {
        let [r, g, b] = self.rgb(texel).map(u16::from);
        let alpha = self.alpha(texel).map(u16::from);
        match channel {
            _ if matches!(self, Self::Value(_)) => (r, 255),
            Channel::Red => (r, 255),
            Channel::Green => (g, 255),
            Channel::Blue => (b, 255),
            Channel::Alpha => (alpha.unwrap_or(255), 255),
            Channel::Mask if alpha.is_some() => (alpha.unwrap_or(255), 255),
            // The weights of ITU-R BT.709 in 256ths: white is exactly 1.
            Channel::Luminance | Channel::Mask => (54 * r + 183 * g + 19 * b, 256 * 255),
        }
    }

    #[inline]
    fn rgb(self, texel: &[u8]) -> [u8; 3] {
        match (self, texel) {
            (Self::Rgb | Self::Rgba, [r, g, b, ..]) => [*r, *g, *b],
            _ => [texel[0]; 3],
        }
    }

    #[inline]
    pub fn alpha(self, texel: &[u8]) -> Option<u8> {
        match self {
            Self::GreyAlpha | Self::Rgba => texel.last().copied(),
            _ => None,
        }
    }
}

impl std::fmt::Debug for Texture {
    /// Without its texels.
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { width, height, layout, .. } = self;
        write!(f, "Texture({width} x {height} {layout:?})")
    }
}
