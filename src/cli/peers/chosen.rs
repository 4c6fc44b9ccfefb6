//! Who takes part: structures of ours, each with its settings, and peers.

use std::str::FromStr;

use crate::accel::params::{Kind, ParamValues};
use crate::accel::registry::{self, Entry, Family};
use crate::cli::args::Size;
use crate::cli::context::Context;
use crate::cli::failure::Failure;
use crate::cli::structures::{BuildArgs, One, Setting};
use crate::geometry::num::floor_index;
use crate::geometry::tri::TestKind;
use crate::lab::RayKind;
use crate::lab::peers::{Ours, Recipe, Recipes, peers};

/// A structure with settings of its own: `bvh:builder=sweep`.
#[derive(Clone, Debug)]
pub struct Spec {
    name: String,
    entry: &'static Entry,
    settings: Vec<Setting>,
}

impl FromStr for Spec {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let mut parts = s.split(':').map(str::trim);
        let One(entry) = parts.next().unwrap_or_default().parse()?;
        let settings = parts.map(str::parse).collect::<Result<_, _>>()?;
        Ok(Self { name: s.to_owned(), entry, settings })
    }
}

/// Bounding volume hierarchies of boxes, which are what the peers are.
fn usual() -> Vec<Spec> {
    let mut specs = Vec::new();
    for entry in registry::ALL.iter().filter(|entry| entry.family == Family::Bvh && entry.id != "volumes") {
        match entry.params.iter().find(|param| param.id == "layout").map(|param| param.kind) {
            Some(Kind::Choice { options }) => {
                let layout = |option: &&str| format!("{}:layout={option}", entry.id).parse();
                specs.extend(options.iter().filter_map(|option| layout(option).ok()));
            }
            _ => specs.push(Spec { name: entry.id.to_owned(), entry, settings: Vec::new() }),
        }
    }
    specs
}

/// Our structures: their names and parameters.
pub fn specs(asked: &[Spec], set: &[Setting]) -> Result<Vec<(String, &'static Entry, ParamValues)>, Failure> {
    let specs = if asked.is_empty() { usual() } else { asked.to_vec() };
    let entries: Vec<&'static Entry> = specs.iter().map(|spec| spec.entry).collect();
    let common = BuildArgs { test: TestKind::Watertight, set: set.to_vec() }.params(&entries)?;
    let own = |(spec, mut params): (Spec, ParamValues)| {
        spec.settings.iter().try_for_each(|setting| setting.apply(spec.entry, &mut params))?;
        Ok((spec.name, spec.entry, params))
    };
    specs.into_iter().zip(common).map(own).collect()
}

/// Those with each triangle test.
pub fn ours(specs: &[(String, &'static Entry, ParamValues)], tests: &[TestKind], cx: &Context) -> Recipes {
    let recipe = |(id, entry, params): &(String, &'static Entry, ParamValues), test| {
        let (id, params, budget, cancel) = (id.clone(), params.clone(), cx.budget.clone(), cx.cancel.clone());
        Box::new(Ours { id, entry, params, test, budget, cancel }) as Box<dyn Recipe>
    };
    specs.iter().flat_map(|spec| tests.iter().map(move |test| recipe(spec, *test))).collect()
}

/// Which of the peers.
#[derive(Clone, Debug)]
pub enum Peers {
    /// All that are here.
    All,
    /// Those whose ids begin so.
    Some(Vec<String>),
}

impl FromStr for Peers {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        Ok(match s {
            "all" => Self::All,
            "none" => Self::Some(Vec::new()),
            ids => Self::Some(ids.split(',').map(|id| id.trim().to_owned()).collect()),
        })
    }
}

impl Peers {
    /// The chosen ones, and a word on each that is not here.
    pub fn chosen(&self) -> Result<(Recipes, Vec<String>), Failure> {
        let (mut recipes, mut missing) = match self {
            Self::Some(ids) if ids.is_empty() => (Recipes::new(), Vec::new()),
            _ => peers(),
        };
        if let Self::Some(ids) = self {
            let known: Vec<String> = recipes.iter().map(|recipe| recipe.label().id).collect();
            let there = |id: &&String| known.iter().chain(&missing).any(|known| known.starts_with(id.as_str()));
            if let Some(id) = ids.iter().find(|id| !there(id)) {
                return Err(Failure::Input(format!("there is no peer '{id}' here; there are {}", known.join(", "))));
            }
            let chosen = |name: &str| ids.iter().any(|id| name.starts_with(id.as_str()));
            recipes.retain(|recipe| chosen(&recipe.label().id));
            missing.retain(|why| chosen(why));
        }
        Ok((recipes, missing))
    }
}

/// A kind of rays, or about how many of each.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Asked {
    /// A kind.
    Kind(RayKind),
    /// A square picture.
    Square(Size),
}

impl FromStr for Asked {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let Ok(rays) = s.parse::<u32>() else { return s.parse().map(Self::Kind) };
        let side = floor_index(f64::from(rays).sqrt().round(), usize::MAX).max(1);
        Ok(Self::Square(format!("{side}x{side}").parse()?))
    }
}

impl Asked {
    pub fn kind(self) -> Option<RayKind> {
        if let Self::Kind(kind) = self { Some(kind) } else { None }
    }

    pub fn size(self) -> Option<Size> {
        if let Self::Square(size) = self { Some(size) } else { None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structures_carry_settings_of_their_own() {
        let spec = |s: &str| s.parse::<Spec>().expect(s);
        let chosen = specs(&[spec("bvh:builder=sweep"), spec("bvh")], &["c_trav=2".parse().expect("a setting")]).expect("good");
        let found: Vec<_> = chosen.iter().map(|(name, _, p)| (name.as_str(), p.choice("builder"), p.float("c_trav"))).collect();
        let default = chosen[1].1.defaults().choice("builder");
        assert_eq!(found, [("bvh:builder=sweep", "sweep", 2.0), ("bvh", default, 2.0)]);
        assert!("oak".parse::<Spec>().is_err() && "bvh:builder".parse::<Spec>().is_err());
        assert!(specs(&[spec("bvh:builder=oak")], &[]).is_err() && specs(&[spec("bvh:leaves=3")], &[]).is_err());
    }

    #[test]
    fn hierarchies_of_boxes_take_part_unless_told_otherwise() {
        let names: Vec<String> = specs(&[], &[]).expect("good").into_iter().map(|(name, ..)| name).collect();
        assert!(names.iter().any(|name| name == "bvh") && !names.iter().any(|name| name == "volumes"), "{names:?}");
    }

    #[test]
    fn a_number_of_rays_is_a_square_picture() {
        let square = |side| Ok(Asked::Square(Size { width: side, height: side }));
        assert_eq!(["4096".parse(), "0".parse(), "1000".parse()], [square(64), square(1), square(32)]);
        assert_eq!("shuffled".parse(), Ok(Asked::Kind(RayKind::Shuffled)));
        assert!("4294967295".parse::<Asked>().is_err() && "some".parse::<Asked>().is_err());
    }
}
