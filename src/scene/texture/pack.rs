//! Leaves out of a decoded image what no material reads.

use super::texels::{Channel, Layout, Texture};

/// What the materials of a scene read of an image.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Wanted {
    pub color: bool,
    /// The channels that single values are read from, each once.
    pub channels: Vec<Channel>,
    /// Everything is kept, read or not.
    pub whole: bool,
}

impl Wanted {
    /// Whether anything is read from the alpha channel.
    fn alpha(&self) -> bool {
        self.channels.iter().any(|channel| matches!(channel, Channel::Alpha | Channel::Mask))
    }
}

/// Makes a texture of texels of any layout, in place.
pub(super) fn pack((width, height): (usize, usize), mut layout: Layout, mut texels: Vec<u8>, wanted: &Wanted) -> Texture {
    if wanted.whole {
        return Texture { width, height, layout, texels, full: false };
    }
    let without_alpha = match layout {
        Layout::GreyAlpha => Some(Layout::Grey),
        Layout::Rgba => Some(Layout::Rgb),
        _ => None,
    };
    let says_nothing = |texels: &[u8]| texels.chunks_exact(layout.channels()).all(|texel| layout.alpha(texel) == Some(255));
    if let Some(fewer) = without_alpha.filter(|_| !wanted.alpha() || says_nothing(&texels)) {
        shorten(&mut texels, layout.channels(), fewer.channels(), |texel, i| texel[i]);
        layout = fewer;
    }
    if let (false, [channel]) = (wanted.color, wanted.channels.as_slice()) {
        shorten(&mut texels, layout.channels(), 1, |texel, _| {
            let (sum, of) = layout.weighed(texel, *channel);
            rounded(sum, of)
        });
        layout = Layout::Value(*channel);
    }
    let full = matches!(layout, Layout::Value(_)) && texels.iter().all(|value| *value == 255);
    Texture { width, height, layout, texels, full }
}

/// Makes texels of `from` bytes ones of `to`, which is no more, of which byte `i` is
/// `byte(texel, i)`.
fn shorten(texels: &mut Vec<u8>, from: usize, to: usize, byte: impl Fn(&[u8], usize) -> u8) {
    let count = texels.len() / from;
    for t in 0..count {
        let mut texel = [0; 4];
        texel[..from].copy_from_slice(&texels[t * from..][..from]);
        for i in 0..to {
            texels[t * to + i] = byte(&texel[..from], i);
        }
    }
    texels.truncate(count * to);
    texels.shrink_to_fit();
}

/// A fraction in 255ths, to the nearest.
fn rounded(sum: u16, of: u16) -> u8 {
    let (sum, of) = (u32::from(sum), u32::from(of));
    u8::try_from((255 * sum + of / 2) / of).unwrap_or(255)
}
