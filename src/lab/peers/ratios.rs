//! How many times as fast as the best of the others.

use serde::Serialize;
use std::collections::BTreeMap;

use super::{Call, PeerRow};
use crate::lab::RayKind;

/// Our best over the best peer's, of rows of one run with one number of threads. `None` (`null` in JSON)
/// where either has no such row.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Ratios {
    /// Rays a second, however they are handed over.
    pub primary: Option<f64>,
    /// Rays a second, both one ray at a time.
    pub primary_single: Option<f64>,
    /// As `primary`.
    pub diffuse: Option<f64>,
    /// As `primary`.
    pub shuffled: Option<f64>,
    /// As `primary`.
    pub shadow: Option<f64>,
    /// The least of [`Self::build_against`].
    pub build: Option<f64>,
    /// For each peer: the seconds of its build over those of the quickest of ours that traces no fewer
    /// diffuse rays a second; `None` where none of ours does.
    pub build_against: BTreeMap<String, Option<f64>>,
}

impl Ratios {
    /// Of all rows; with `watertight` of those alone on both sides.
    pub fn of(rows: &[PeerRow], watertight: bool) -> Self {
        let rows: Vec<&PeerRow> = rows.iter().filter(|row| row.watertight || !watertight).collect();
        let (peers, ours): (Vec<&PeerRow>, Vec<&PeerRow>) = rows.into_iter().partition(|row| row.peer);
        let ratio = |kind, single| Some(best(&ours, kind, single)? / best(&peers, kind, single)?);
        let mut build_against: BTreeMap<String, Option<f64>> = BTreeMap::new();
        for peer in &peers {
            let same: Vec<&PeerRow> = peers.iter().copied().filter(|row| row.id == peer.id).collect();
            let Some((rate, build)) = best(&same, RayKind::Diffuse, false).zip(peer.build) else { continue };
            let enough = |row: &&&PeerRow| best(&[**row], RayKind::Diffuse, false).is_some_and(|ours| ours >= rate);
            let secs = ours.iter().filter(enough).filter_map(|row| Some(row.build?.median)).min_by(f64::total_cmp);
            build_against.insert(peer.id.clone(), secs.map(|secs| build.median / secs));
        }
        Self {
            primary: ratio(RayKind::Primary, false),
            primary_single: ratio(RayKind::Primary, true),
            diffuse: ratio(RayKind::Diffuse, false),
            shuffled: ratio(RayKind::Shuffled, false),
            shadow: ratio(RayKind::Shadow, false),
            build: build_against.values().flatten().copied().min_by(f64::total_cmp),
            build_against,
        }
    }

    /// The figures by the names of their keys.
    pub fn named(&self) -> [(&'static str, Option<f64>); 6] {
        [
            ("primary", self.primary),
            ("primary_single", self.primary_single),
            ("diffuse", self.diffuse),
            ("shuffled", self.shuffled),
            ("shadow", self.shadow),
            ("build", self.build),
        ]
    }
}

/// The most rays a second of a kind; with `single` where they are handed over one at a time.
fn best(rows: &[&PeerRow], kind: RayKind, single: bool) -> Option<f64> {
    let rows = rows.iter().filter(|row| row.call == Call::Single || !single);
    rows.filter_map(|row| Some(row.rays.get(&kind)?.mrays_per_sec)).filter(|rate| rate.is_finite()).max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::peers::{BuildSecs, RayRow};

    fn row(id: &str, peer: bool, watertight: bool, call: Call, (rate, build): (f64, f64)) -> PeerRow {
        let timed = RayRow {
            count: 1,
            of: 1,
            hits: 1,
            rounds: 5,
            secs: 1.0,
            secs_spread: 0.0,
            secs_min: 1.0,
            secs_max: 1.0,
            mrays_per_sec: rate,
            differing_rays: 0,
        };
        PeerRow {
            id: id.to_owned(),
            library: String::new(),
            peer,
            watertight,
            test: "",
            call,
            threads: 1,
            params: BTreeMap::new(),
            build: Some(BuildSecs { median: build, half_iqr: 0.0, builds: 3 }),
            bytes: None,
            differing_rays: 0,
            rays: [(RayKind::Primary, timed), (RayKind::Diffuse, timed)].into(),
            error: None,
        }
    }

    #[test]
    fn the_best_of_each_side_are_compared_and_builds_only_where_rays_are_no_slower() {
        let rows = [
            row("bvh", false, true, Call::Single, (3.0, 0.5)),
            row("bvh", false, false, Call::Batch, (6.0, 0.4)),
            row("a", true, false, Call::Single, (4.0, 0.2)),
            row("a", true, false, Call::Packet8, (5.0, 0.2)),
            row("b", true, true, Call::Single, (2.0, 1.0)),
            row("c", true, false, Call::Single, (7.0, 0.1)),
        ];
        let all = Ratios::of(&rows[..5], false);
        assert_eq!((all.primary, all.primary_single), (Some(6.0 / 5.0), Some(3.0 / 4.0)));
        assert_eq!((all.build, all.shadow), (Some(0.5), None));
        assert_eq!(all.build_against["b"], Some(1.0 / 0.4));
        let slower = Ratios::of(&rows, false);
        assert_eq!((slower.build_against["c"], slower.build), (None, Some(0.5)), "ours is slower on its rays");
        let watertight = Ratios::of(&rows, true);
        assert_eq!((watertight.primary, watertight.build), (Some(1.5), Some(2.0)));
        assert_eq!(Ratios::of(&[], false), Ratios::default());
    }
}
