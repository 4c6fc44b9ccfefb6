//! Which structures, built how.

use std::str::FromStr;

use super::failure::Failure;
use crate::accel::params::ParamValues;
use crate::accel::registry::{self, Entry};
use crate::geometry::tri::TestKind;
use crate::lab::RasterRow;

/// How structures are built.
#[derive(Debug, clap::Args)]
pub struct BuildArgs {
    /// The triangle test: watertight, fast (rays through shared edges may slip through), exact, or with brute double or
    /// baldwin-weber.
    #[arg(long, value_name = "TEST", default_value = "watertight")]
    pub test: TestKind,
    /// Sets a parameter, as in --set bins=16. May be given many times.
    #[arg(long, value_name = "K=V")]
    pub set: Vec<Setting>,
}

/// One structure, by its id.
#[derive(Clone, Copy, Debug)]
pub struct One(pub &'static Entry);

impl FromStr for One {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = || registry::ALL.iter().map(|entry| entry.id).collect::<Vec<_>>().join(", ");
        registry::find(s).map(Self).ok_or_else(|| format!("there is no structure '{s}'; there are {}", known()))
    }
}

/// The same without repetitions.
pub fn each_once<T: PartialEq + Copy>(all: Vec<T>) -> Vec<T> {
    let mut once: Vec<T> = Vec::with_capacity(all.len());
    for one in all {
        if !once.contains(&one) {
            once.push(one);
        }
    }
    once
}

/// `all`, or ids between commas.
#[derive(Clone, Debug)]
pub struct Many(pub Vec<&'static Entry>);

impl FromStr for Many {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        if s == "all" {
            return Ok(Self(registry::ALL.iter().collect()));
        }
        let mut chosen: Vec<&'static Entry> = Vec::new();
        for id in s.split(',') {
            let One(entry) = id.trim().parse()?;
            if chosen.iter().all(|other| other.id != entry.id) {
                chosen.push(entry);
            }
        }
        Ok(Self(chosen))
    }
}

/// What takes part in a comparison: structures, and the rasteriser.
#[derive(Clone, Debug)]
pub struct Racers {
    pub entries: Vec<&'static Entry>,
    pub raster: bool,
}

impl FromStr for Racers {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let (raster, ids): (Vec<&str>, Vec<&str>) = s.split(',').map(str::trim).partition(|id| *id == RasterRow::ID);
        let raster = !raster.is_empty() || s == "all";
        if ids.is_empty() {
            return Ok(Self { entries: Vec::new(), raster });
        }
        let Many(entries) = ids.join(",").parse().map_err(|why| format!("{why}, and {}", RasterRow::ID))?;
        Ok(Self { entries, raster })
    }
}

/// `k=v`.
#[derive(Clone, Debug)]
pub struct Setting {
    id: String,
    value: String,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let (id, value) = s.split_once('=').ok_or("a setting is K=V")?;
        Ok(Self { id: id.trim().to_owned(), value: value.trim().to_owned() })
    }
}

impl Setting {
    /// Sets the parameter of a structure.
    #[cfg(feature = "peers")]
    pub fn apply(&self, entry: &Entry, params: &mut ParamValues) -> Result<(), Failure> {
        params.set(&self.id, &self.value).map_err(|error| Failure::Input(format!("{}: {error}", entry.id)))
    }
}

impl BuildArgs {
    /// The parameters of each structure. A setting goes to every structure that has the parameter;
    /// one that fits none is an error.
    pub fn params(&self, entries: &[&'static Entry]) -> Result<Vec<ParamValues>, Failure> {
        let mut all: Vec<ParamValues> = entries.iter().map(|entry| entry.defaults()).collect();
        for Setting { id, value } in &self.set {
            let has = |entry: &Entry| entry.params.iter().any(|param| param.id == id);
            let takers = entries.iter().zip(&mut all).filter(|(entry, _)| has(entry) || entries.len() == 1);
            let mut taken = false;
            for (entry, params) in takers {
                params.set(id, value).map_err(|error| Failure::Input(format!("{}: {error}", entry.id)))?;
                taken = true;
            }
            if !taken {
                return Err(Failure::Input(format!("none of these structures has a parameter '{id}'")));
            }
        }
        Ok(all)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn args(set: &[&str]) -> BuildArgs {
        BuildArgs { test: TestKind::Watertight, set: set.iter().map(|s| s.parse().expect("k=v")).collect() }
    }

    #[test]
    fn structures_are_named_once_each() {
        let ids = |s: &str| s.parse::<Many>().map(|Many(all)| all.iter().map(|e| e.id).collect::<Vec<_>>());
        assert_eq!(ids("bvh, grid,bvh"), Ok(vec!["bvh", "grid"]));
        assert_eq!(ids("all").map(|all| all.len()), Ok(registry::ALL.len()));
        assert!(ids("bvh,oak").expect_err("unknown").contains("brute, bound, bvh"));
    }

    #[test]
    fn the_rasteriser_is_named_among_structures() {
        let racers = |s: &str| s.parse::<Racers>().map(|r| (r.entries.iter().map(|e| e.id).collect::<Vec<_>>(), r.raster));
        assert_eq!(racers("raster, bvh"), Ok((vec!["bvh"], true)));
        assert_eq!(racers("bvh"), Ok((vec!["bvh"], false)));
        assert_eq!(racers("raster"), Ok((vec![], true)));
        assert_eq!(racers("all").map(|(ids, raster)| (ids.len(), raster)), Ok((registry::ALL.len(), true)));
        assert!(racers("raster,oak").expect_err("unknown").ends_with("and raster"));
    }

    #[test]
    fn settings_reach_every_structure_that_has_them() {
        let Many(all) = "brute,bvh,kdtree".parse().expect("known");
        let params = args(&["c_trav=2.5"]).params(&all).expect("some have it");
        assert_eq!((params[1].float("c_trav"), params[2].float("c_trav")), (2.5, 2.5));
        assert!(args(&["leaves=3"]).params(&all).is_err());
        assert!(args(&["bins=zero"]).params(&all).is_err());
        assert!(matches!(args(&["bins=8"]).params(&all[..1]), Err(Failure::Input(why)) if why.contains("there is none")));
    }
}
