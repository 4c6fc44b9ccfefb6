//! Which builder: what the parameters name, or what suits the number of triangles.

use crate::accel::params::ParamValues;

/// A way to build.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Builder {
    /// [`super::median::ObjectMedian`].
    Median,
    /// [`super::median::SpatialMiddle`].
    Midpoint,
    /// [`super::sweep`].
    Sweep,
    /// [`super::binned`].
    Binned,
    /// [`super::sbvh`].
    Sbvh,
    /// [`super::lbvh`].
    Lbvh,
    /// [`super::ploc`].
    Ploc,
}

/// The names, `auto` first.
pub const OPTIONS: &[&str] = &["auto", "binned", "sweep", "sbvh", "ploc", "lbvh", "midpoint", "median"];

/// Up to so many triangles `auto` sweeps: that takes no longer than a blink. Beyond it bins: on ten million triangles
/// in two thirds of the time that clustering takes, to a tree with a sixth fewer nodes a ray.
const SWEEP_UP_TO: usize = 50_000;

impl Builder {
    /// Whether it is left to the preset.
    pub fn is_auto(p: &ParamValues) -> bool {
        p.choice("builder") == OPTIONS[0]
    }

    /// What is asked for, and a remark if that was left to the preset.
    pub fn of(p: &ParamValues, triangles: usize) -> (Self, Option<String>) {
        let builder = match p.choice("builder") {
            "median" => Self::Median,
            "midpoint" => Self::Midpoint,
            "sweep" => Self::Sweep,
            "binned" => Self::Binned,
            "sbvh" => Self::Sbvh,
            "lbvh" => Self::Lbvh,
            "ploc" => Self::Ploc,
            _ => {
                let (builder, id) = Self::suiting(triangles);
                return (builder, Some(format!("Builder: auto took {id}, for {triangles} triangles.")));
            }
        };
        (builder, None)
    }

    const fn suiting(triangles: usize) -> (Self, &'static str) {
        if triangles <= SWEEP_UP_TO { (Self::Sweep, "sweep") } else { (Self::Binned, "binned") }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::bvh::PARAMS;

    #[test]
    fn every_name_is_a_builder_and_auto_says_what_it_took() {
        for name in &OPTIONS[1..] {
            let mut p = ParamValues::defaults(PARAMS);
            p.set("builder", name).expect("an option");
            let (builder, remark) = Builder::of(&p, 10);
            assert_eq!(format!("{builder:?}").to_lowercase(), *name);
            assert!(remark.is_none());
        }
        let of = |n| Builder::of(&ParamValues::defaults(PARAMS), n);
        assert_eq!((of(10).0, of(1_000_000).0, of(10_000_000).0), (Builder::Sweep, Builder::Binned, Builder::Binned));
        assert_eq!(of(12_345_678).1.as_deref(), Some("Builder: auto took binned, for 12345678 triangles."));
    }
}
