//! The axes of plots: how they are divided, how far they reach, and the numbers along them.

use std::ops::Range;

use plotters::coord::ranged1d::Ranged;
use plotters::coord::types::RangedCoordf64;

use crate::geometry::num::floor_index;

/// How an axis is divided.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scale {
    /// By powers of ten; what is not positive has no place.
    #[default]
    Log,
    /// Evenly.
    Even,
}

/// Numbers along an axis, at most.
pub(super) const LABELS: usize = 11;

impl Scale {
    /// Whether a coordinate has a place.
    pub(super) fn fits(self, x: f64) -> bool {
        x.is_finite() && (self == Self::Even || x > 0.0)
    }

    /// What is written along an axis.
    pub(super) fn labels(self, axis: &Range<f64>) -> Box<dyn Fn(&f64) -> String> {
        match self {
            Self::Log => Box::new(short),
            Self::Even => Box::new(even(axis.clone())),
        }
    }

    /// An axis that holds all of these, with some room.
    pub(super) fn around(self, values: impl Iterator<Item = f64>) -> Range<f64> {
        let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
        match self {
            Self::Log if low <= high => low * 0.7..high * 1.4,
            Self::Log => 0.1..10.0,
            Self::Even if low <= high => {
                let room = if high > low { (high - low) * 0.05 } else { low.abs().max(1.0) * 0.5 };
                low - room..high + room
            }
            Self::Even => 0.0..1.0,
        }
    }
}

/// Powers of ten as people write them.
pub(super) fn short(x: &f64) -> String {
    match *x {
        x if x >= 1e6 => format!("{} M", x / 1e6),
        x if x >= 1e3 => format!("{} k", x / 1e3),
        // Not to the last bit: 0.4, not 0.4000000000000001.
        x if x >= 1e-3 => format!("{}", (x * 1e6).round() / 1e6),
        0.0 => "0".to_owned(),
        x if x < 0.0 => format!("-{}", short(&-x)),
        x => format!("{x:.0e}"),
    }
}

/// Numbers along an even axis, with the decimals that tell neighbours apart.
pub(super) fn even(axis: Range<f64>) -> impl Fn(&f64) -> String {
    /// The most decimals that are written out.
    const MOST: f64 = 6.0;
    let span = axis.end - axis.start;
    let step = match RangedCoordf64::from(axis).key_points(LABELS)[..] {
        [a, b, ..] => b - a,
        _ => span,
    };
    // Steps are 1, 2 or 5 times a power of ten, but for rounding.
    let power = |x: f64| (x.log10() + 1e-6).floor();
    let digits = |n: f64| floor_index(n.max(0.0), 15);
    move |x| {
        let (unit, name) = match x.abs() {
            x if x < span * 1e-6 => return "0".to_owned(),
            x if x >= 1e6 => (1e6, " M"),
            x if x >= 1e3 => (1e3, " k"),
            _ => (1.0, ""),
        };
        let decimals = -power(step / unit);
        if decimals > MOST {
            let digits = digits(power(x.abs()) - power(step));
            return format!("{x:.digits$e}");
        }
        format!("{:.*}{name}", digits(decimals), x / unit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_along_an_even_axis_are_told_apart() {
        let labels = |axis: Range<f64>| -> Vec<String> {
            let label = even(axis.clone());
            RangedCoordf64::from(axis).key_points(LABELS).iter().map(label).collect()
        };
        for (from, to) in [(0.0, 1.0), (-0.5, 0.5), (0.0, 4e-4), (0.2001, 0.2006), (-3e-9, 2e-9), (0.0, 4e6), (990.0, 1010.0)] {
            let all = labels(from..to);
            assert!(all.len() > 2 && all.windows(2).all(|w| w[0] != w[1]), "{all:?}");
        }
        assert_eq!(labels(0.0..1.0)[..3], ["0", "0.1", "0.2"]);
        assert_eq!(labels(0.0..4e-4)[1..3], ["0.00005", "0.00010"]);
        assert_eq!(even(-1.0..1.0)(&1e-17), "0");
        assert_eq!(even(0.0..1e7)(&2e6), "2 M");
    }
}
