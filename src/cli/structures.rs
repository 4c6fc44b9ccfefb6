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
    /// Sets a parameter, as in --set bins=16, of every structure that has it; of one alone as in --set bvh.bins=16. May be
    /// given many times.
    #[arg(long, value_name = "[ID.]K=V")]
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

/// `k=v`, or `structure.k=v`.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The structure that it is for; every one that has the parameter if there is none.
    of: Option<&'static Entry>,
    id: String,
    value: String,
}

impl FromStr for Setting {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let (key, value) = s.split_once('=').ok_or("a setting is K=V, or ID.K=V for one structure")?;
        let (of, id) = match key.split_once('.') {
            Some((of, id)) => (Some(of.trim().parse::<One>()?.0), id),
            None => (None, key),
        };
        Ok(Self { of, id: id.trim().to_owned(), value: value.trim().to_owned() })
    }
}

impl Setting {
    /// Whether it is for a structure, one of so many.
    fn is_for(&self, entry: &Entry, all: usize) -> bool {
        let has = || all == 1 || entry.params.iter().any(|param| param.id == self.id);
        self.of.map_or_else(has, |of| of.id == entry.id)
    }

    /// Sets the parameter of a structure.
    #[cfg(feature = "peers")]
    pub fn apply(&self, entry: &Entry, params: &mut ParamValues) -> Result<(), Failure> {
        if let Some(of) = self.of.filter(|of| of.id != entry.id) {
            return Err(Failure::Input(format!("{}: a setting for {}", entry.id, of.id)));
        }
        params.set(&self.id, &self.value).map_err(|error| Failure::Input(format!("{}: {error}", entry.id)))
    }
}

impl BuildArgs {
    /// The parameters of each structure. A setting goes to the structure that it names, or to every one that has the
    /// parameter; one that fits none is an error.
    pub fn params(&self, entries: &[&'static Entry]) -> Result<Vec<ParamValues>, Failure> {
        let mut all: Vec<ParamValues> = entries.iter().map(|entry| entry.defaults()).collect();
        for setting in &self.set {
            let Setting { of, id, value } = setting;
            let takers = entries.iter().zip(&mut all).filter(|(entry, _)| setting.is_for(entry, entries.len()));
            let mut taken = false;
            for (entry, params) in takers {
                params.set(id, value).map_err(|error| Failure::Input(format!("{}: {error}", entry.id)))?;
                taken = true;
            }
            match of {
                _ if taken => {}
                Some(of) => return Err(Failure::Input(format!("{} is none of these structures, but has a setting", of.id))),
                None => return Err(Failure::Input(format!("none of these structures has a parameter '{id}'"))),
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
    fn what_a_report_says_of_settings_is_read_back() {
        let Many(all) = "wide,bvh,kdtree,grid2".parse().expect("known");
        let params = args(&["bvh.c_trav=2.5", "kdtree.c_trav=3", "bvh.builder=ploc"]).params(&all).expect("known");
        let structures: Vec<_> = all.iter().copied().zip(params.clone()).collect();
        let said = crate::lab::everything::settings(&structures);
        let set: Vec<&str> = said.split(" --set ").skip(1).collect();
        assert_eq!(set.len(), 3, "{said}");
        assert_eq!(args(&set).params(&all).expect("as said"), params);
        assert_eq!(crate::lab::everything::settings(&[]), "");
    }

    #[test]
    fn settings_reach_every_structure_that_has_them() {
        let Many(all) = "brute,bvh,kdtree".parse().expect("known");
        let params = args(&["c_trav=2.5"]).params(&all).expect("some have it");
        assert_eq!((params[1].float("c_trav"), params[2].float("c_trav")), (2.5, 2.5));
        assert!(args(&["leaves=3"]).params(&all).is_err());
        assert!(args(&["bins=zero"]).params(&all).is_err());
        let params = args(&["c_trav=2.5", "kdtree.c_trav=3"]).params(&all).expect("both have it");
        assert_eq!((params[1].float("c_trav"), params[2].float("c_trav")), (2.5, 3.0));
        assert!(args(&["bvh.leaves=3"]).params(&all).is_err(), "it has none of that name");
        assert!(matches!(args(&["grid.c_trav=3"]).params(&all), Err(Failure::Input(why)) if why.contains("grid is none of")));
        assert!("oak.bins=8".parse::<Setting>().is_err_and(|why| why.contains("no structure 'oak'")));
        assert!(matches!(args(&["bins=8"]).params(&all[..1]), Err(Failure::Input(why)) if why.contains("there is none")));
    }
}
