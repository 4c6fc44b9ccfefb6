//! What lies between the texels of an image, and beyond its edges.

use crate::geometry::num;

/// How an image is looked up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Sampler {
    /// Beyond the left and the right edge.
    pub wrap_u: Wrap,
    /// Beyond the upper and the lower edge.
    pub wrap_v: Wrap,
    /// Between texels.
    pub filter: Filter,
}

/// What an image is beyond its edges.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Wrap {
    /// The same again.
    #[default]
    Repeat,
    /// The same again, every other time mirrored.
    Mirror,
    /// Its outermost texels go on for ever.
    Clamp,
}

/// What an image is between the centres of its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Filter {
    /// The four texels around, by their distance.
    #[default]
    Linear,
    /// The texel that the point is in.
    Nearest,
}

/// Two neighbouring texels of a row or a column, and the weight of the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Between {
    pub first: usize,
    pub second: usize,
    pub weight: f32,
}

impl Wrap {
    /// The texel of `n` that the coordinate `x` is in.
    #[inline]
    pub(super) fn texel(self, x: f32, n: usize) -> usize {
        num::floor_index(f64::from(self.fold(x) * n as f32), n - 1)
    }

    /// The texels of `n` whose centres `x` is between.
    ///
    /// ```text
    ///  0         1/n        2/n    x
    ///  |    0    |     1    |     2 ...
    ///       '----------'              the centres of 0 and 1, half a texel in
    /// ```
    #[inline]
    pub(super) fn between(self, x: f32, n: usize) -> Between {
        // Half a texel on, so that the second one's number is never below zero.
        let at = self.fold(x) * n as f32 + 0.5;
        let second = num::floor_index(f64::from(at), n);
        let weight = at - second as f32;
        let (before_first, after_last) = if self == Self::Repeat { (n - 1, 0) } else { (0, n - 1) };
        let first = if second == 0 { before_first } else { second - 1 };
        Between { first, second: if second == n { after_last } else { second }, weight }
    }

    /// The coordinate within 0 to 1 that stands for `x`. What is no number, or nowhere, is at 0.
    #[inline]
    fn fold(self, x: f32) -> f32 {
        let folded = match self {
            Self::Repeat => x - x.floor(),
            Self::Mirror => {
                let in_two = x - 2.0 * (0.5 * x).floor();
                if in_two > 1.0 { 2.0 - in_two } else { in_two }
            }
            Self::Clamp => x.clamp(0.0, 1.0),
        };
        if folded.is_nan() { 0.0 } else { folded }
    }
}
