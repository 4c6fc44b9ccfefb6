//! The statements of an MTL file that name an image: options, then the name of a file, which may
//! have blanks in it (Wavefront, "Advanced Visualizer", appendix "MTL material format", 1995, the
//! section on texture map statements).

use crate::scene::load::text::{float, lossy};
use crate::scene::texture::{Channel, Sampler, UvTransform, Wrap};

/// A `map_Kd` statement, or another that names an image.
#[derive(Debug, PartialEq)]
pub(super) struct Map {
    /// The file as it is written.
    pub file: String,
    pub sampler: Sampler,
    pub transform: UvTransform,
    /// `-imfchan`: which channel a single value is read from.
    pub channel: Option<Channel>,
}

/// What follows an option: one word, or up to so many numbers.
#[derive(Clone, Copy)]
enum Takes {
    Word,
    Numbers(usize),
}

/// Every option there is, since one that is not known would begin the name. Turbulence, the blending
/// of texels, gain (`-mm`), sharpening and kinds of projection are read past.
const OPTIONS: &[(&[u8], Takes)] = &[
    (b"-o", Takes::Numbers(3)),
    (b"-s", Takes::Numbers(3)),
    (b"-t", Takes::Numbers(3)),
    (b"-mm", Takes::Numbers(2)),
    (b"-bm", Takes::Numbers(1)),
    (b"-boost", Takes::Numbers(1)),
    (b"-texres", Takes::Numbers(1)),
    (b"-blendu", Takes::Word),
    (b"-blendv", Takes::Word),
    (b"-cc", Takes::Word),
    (b"-clamp", Takes::Word),
    (b"-colorspace", Takes::Word), // of tinyobjloader
    (b"-imfchan", Takes::Word),
    (b"-type", Takes::Word),
];

/// Reads what follows the first word of the statement; `None` if it names no file.
pub(super) fn parse(tail: &[u8]) -> Option<Map> {
    let mut options = Options { offset: [0.0; 2], scale: [1.0; 2], clamp: false, channel: None };
    let rest = options.read(tail.trim_ascii(), true);
    let (file, rest) = rest.split_at(name_length(rest));
    // Some programs write them behind the name.
    options.read(rest.trim_ascii(), false);
    let Options { offset, scale, clamp, channel } = options;
    // Beyond the image the surface should have no texture at all, which nobody does.
    let wrap = if clamp { Wrap::Clamp } else { Wrap::Repeat };
    let sampler = Sampler { wrap_u: wrap, wrap_v: wrap, ..Sampler::default() };
    let file = lossy(file.trim_ascii());
    (!file.is_empty()).then(|| Map { file, sampler, transform: UvTransform::mtl(offset, scale), channel })
}

/// Where the name ends that `text` begins with: at its end, or at an option or a comment.
fn name_length(text: &[u8]) -> usize {
    let mut at = 0;
    while let Some((word, after)) = first_word(&text[at..]) {
        if word == b"#" || takes(word).is_some() {
            return at;
        }
        at = text.len() - after.len();
    }
    text.len()
}

struct Options {
    offset: [f32; 2],
    scale: [f32; 2],
    clamp: bool,
    channel: Option<Channel>,
}

impl Options {
    /// Reads the options that `text` begins with, and returns what follows them. Where a name has
    /// to follow, the last word is not taken for a number: a file may be called `512`.
    fn read<'a>(&mut self, mut text: &'a [u8], name_follows: bool) -> &'a [u8] {
        while let Some((option, rest)) = first_word(text)
            && let Some(takes) = takes(option)
        {
            text = match takes {
                Takes::Word => {
                    let (word, after) = first_word(rest).unwrap_or_default();
                    self.word(option, word);
                    after
                }
                Takes::Numbers(most) => {
                    let (numbers, after) = numbers(rest, most, name_follows);
                    self.numbers(option, &numbers);
                    after
                }
            };
        }
        text
    }

    fn word(&mut self, option: &[u8], word: &[u8]) {
        match option {
            b"-clamp" => self.clamp = word.eq_ignore_ascii_case(b"on"),
            b"-imfchan" => {
                self.channel = match word {
                    b"r" => Some(Channel::Red),
                    b"g" => Some(Channel::Green),
                    b"b" => Some(Channel::Blue),
                    b"m" => Some(Channel::Alpha),
                    b"l" => Some(Channel::Luminance),
                    _ => None,
                }
            }
            _ => {}
        }
    }

    /// Numbers that are left out stay as they are.
    fn numbers(&mut self, option: &[u8], numbers: &[f32]) {
        let into = match option {
            b"-o" => &mut self.offset,
            b"-s" => &mut self.scale,
            _ => return,
        };
        for (to, from) in into.iter_mut().zip(numbers) {
            *to = *from;
        }
    }
}

fn numbers(mut text: &[u8], most: usize, name_follows: bool) -> (Vec<f32>, &[u8]) {
    let mut numbers = Vec::new();
    while numbers.len() < most
        && let Some((word, after)) = first_word(text)
        && let Some(number) = float(word)
        && !(name_follows && after.is_empty())
    {
        numbers.push(number);
        text = after;
    }
    (numbers, text)
}

fn takes(word: &[u8]) -> Option<Takes> {
    OPTIONS.iter().find(|(name, _)| *name == word).map(|(_, takes)| *takes)
}

/// The first word of `text`, and what follows it.
fn first_word(text: &[u8]) -> Option<(&[u8], &[u8])> {
    let text = text.trim_ascii_start();
    let end = text.iter().position(u8::is_ascii_whitespace).unwrap_or(text.len());
    let (word, rest) = text.split_at(end);
    (!word.is_empty()).then(|| (word, rest.trim_ascii_start()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(text: &str) -> Map {
        parse(text.as_bytes()).expect("a map")
    }

    fn file(text: &str) -> String {
        map(text).file
    }

    fn at(text: &str, u: f32, v: f32) -> [f32; 2] {
        map(text).transform.apply(glam::Vec2::new(u, v)).to_array()
    }

    /// The statements of tinyobjloader's texture-options-issue-85, norm-texopt, issue-248 and
    /// colorspace-issue-184.
    #[test]
    fn every_option_is_read_past() {
        for options in [
            "-o 0.1",
            "-s 0.1 0.2",
            "-t 0.1 0.2 0.3",
            "-bm 3",
            "-blendu on",
            "-blendv off",
            "-mm 0.1 0.3",
            "-type sphere",
            "-type cube_top",
            "-texres 512",
            "-colorspace sRGB -o 0.1",
            "-clamp on",
            "-imfchan r",
            "-boost 2",
            "-cc off",
        ] {
            assert_eq!(file(&format!("{options} diffuse.jpg")), "diffuse.jpg", "{options}");
            assert_eq!(file(&format!("diffuse 1.jpg {options} ")), "diffuse 1.jpg", "{options}");
        }
        assert_eq!(map("-imfchan r bumpmap2.jpg -bm 1.5").channel, Some(Channel::Red));
    }

    #[test]
    fn names_may_have_blanks_and_be_numbers() {
        assert_eq!(file("texture 01.png"), "texture 01.png");
        assert_eq!(file("-bm 2  bump  01.png "), "bump  01.png");
        assert_eq!(file("-s 2 512"), "512");
        assert_eq!(file("-o 1 2 3 4"), "4");
        assert_eq!(file("-x.png"), "-x.png");
        assert_eq!(file("tile #1.png # not this"), "tile #1.png");
        for nothing in ["", "-clamp", "-clamp on", "-s", "# none"] {
            assert_eq!(parse(nothing.as_bytes()), None, "{nothing}");
        }
    }

    #[test]
    fn offsets_scale_and_v_points_down() {
        assert_eq!(at("x.png", 0.25, 0.25), [0.25, 0.75]);
        assert_eq!(at("-s 2 x.png", 0.25, 0.25), [0.5, 0.75]);
        assert_eq!(at("-o 0.5 0.25 0 -s 2 4 1 x.png", 0.25, 0.125), [1.0, 0.25]);
        let sampler = map("-clamp on x.png").sampler;
        assert_eq!((sampler.wrap_u, sampler.wrap_v), (Wrap::Clamp, Wrap::Clamp));
        assert_eq!(map("-clamp off x.png").sampler, Sampler::default());
    }
}
