use super::replay::{Events, levels_above, listed, rounds};
use super::*;
use crate::accel::registry;
use crate::accel::stats::SahWeights;
use crate::geometry::tri::TestKind;
use crate::scene::{Geometry, LoadCx, open};
use crate::task::{Budget, Cancelled};

/// A film, and the SAH cost of the finished structure with the number of its leaves.
fn try_all(model: &str, id: &str, set: &[(&str, &str)], bytes: u64) -> Result<(Film, f64, usize), FilmError> {
    let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
    let geometry = Arc::new(Geometry::with_instances(&open(model, &load).expect("built in"), &load).expect("fits"));
    let entry = registry::find(id).expect("registered");
    let mut params = entry.defaults();
    set.iter().for_each(|(id, value)| params.set(id, value).expect("in range"));
    let accel = entry.build(&geometry, TestKind::Watertight, &params, &cx).expect("builds");
    let on = (&cx.budget, &cx.cancel, &cx.progress);
    let outline = Outline::of(accel.as_ref(), SahWeights::of(&params), on).expect("small");
    let leaves = (0..outline.len()).filter(|row| outline.below(*row).is_empty()).count();
    let (sah, cx) = (outline.sah(), BuildCx { budget: Budget::new(bytes), ..cx });
    let film = Film::of(&Subject { id, accel: accel.as_ref(), params: &params }, Arc::new(outline), &cx)?;
    Ok((film, sah, leaves))
}

fn try_film(model: &str, id: &str, set: &[(&str, &str)], bytes: u64) -> Result<Film, FilmError> {
    try_all(model, id, set, bytes).map(|(film, ..)| film)
}

fn film(model: &str, id: &str, set: &[(&str, &str)]) -> Film {
    try_film(model, id, set, 1 << 30).expect("made")
}

const SMALL: &str = "builtin:soup?triangles=200";
const KINDS: [(&str, &[(&str, &str)]); 7] = [
    ("bvh", &[]),
    ("bvh", &[("builder", "ploc")]),
    ("wide", &[]),
    ("wide", &[("builder", "ploc")]),
    ("kdtree", &[]),
    ("octree", &[]),
    ("grid2", &[]),
];

/// The whole cells that are in no other, and how many rows without others below are in them.
fn seen(film: &Film, at: u32) -> (Vec<u32>, u32) {
    let outline = film.replay.outline();
    let (mut whole, mut open, mut leaves) = (Vec::new(), vec![0], 0);
    while let Some(row) = open.pop() {
        if film.replay.is_whole(row, at) {
            whole.push(row);
            leaves += (row..outline.behind(row)).filter(|row| outline.below(*row).is_empty()).count() as u32;
        } else {
            open.extend(outline.children(row));
        }
    }
    (whole, leaves)
}

#[test]
fn cells_are_divided_after_those_around_them_and_merged_before() {
    for (id, set) in KINDS {
        let film = film(SMALL, id, set);
        let Events::Rows(rows) = &film.replay.events else { panic!("{id}: few") };
        let inner = (0..film.replay.outline().len()).filter(|row| !film.replay.outline().below(*row).is_empty());
        assert_eq!(rows.len(), inner.count(), "{id}: each once");
        for (i, (row, _)) in rows.iter().enumerate() {
            let parent = film.replay.outline().parent(*row).map(|parent| rows.iter().position(|other| other.0 == parent));
            let before = parent.flatten().is_none_or(|parent| parent < i);
            let first = i == if film.order() == Order::Splits { 0 } else { rows.len() - 1 };
            assert_eq!(parent.is_none(), first, "{id}: {i}");
            assert!(parent.is_none() || before == (film.order() == Order::Splits), "{id}: {i}");
        }
        let levels: Vec<u32> = rows.iter().map(|row| film.replay.level(row.0)).collect();
        assert!(levels.is_sorted(), "{id}: by level or round");
    }
}

#[test]
fn what_is_seen_holds_every_leaf_once_at_every_position() {
    for (id, set) in KINDS {
        let film = film(SMALL, id, set);
        let (outline, merges) = (film.replay.outline(), film.order() == Order::Merges);
        let all = seen(&film, 0).1;
        let mut expected = if merges { all } else { 1 };
        for at in 0..=film.last() {
            if let Some(row) = film.replay.just(at) {
                let more = outline.children(row).count() as u32 - 1;
                expected = if merges { expected - more } else { expected + more };
            }
            let (whole, leaves) = seen(&film, at);
            assert_eq!((whole.len() as u32, leaves), (expected, all), "{id}: {at} of {}", film.last());
        }
        assert_eq!(expected, if merges { 1 } else { all }, "{id}");
    }
}

#[test]
fn the_cost_ends_at_that_of_the_finished_structure() {
    for entry in registry::ALL {
        let film = film(SMALL, entry.id, &[]);
        let (end, sah) = (film.cost(film.last()), film.replay.outline().sah());
        assert!((end / sah - 1.0).abs() < 1e-5, "{}: {end} and {sah}", entry.id);
        assert_eq!(film.cost(u32::MAX), end);
    }
    for film in [film(SMALL, "bvh", &[("builder", "ploc")]), film("builtin:sphere-flake", "bvh", &[])] {
        assert!((film.cost(film.last()) / film.replay.outline().sah() - 1.0).abs() < 1e-5);
    }
    let film = film(SMALL, "bvh", &[("c_isect", "2")]);
    let one_leaf = 2.0 * f64::from(film.replay.outline().row(0).references);
    assert!((film.cost(0) / one_leaf - 1.0).abs() < 1e-6, "{}", film.cost(0));
    // However often the cells of a partition hold a triangle.
    let film = self::film(SMALL, "kdtree", &[("c_isect", "2")]);
    assert!((film.cost(0) / (2.0 * film.replay.triangles as f64) - 1.0).abs() < 1e-6, "{}", film.cost(0));
}

#[test]
fn of_too_many_cells_each_level_is_an_event() {
    for (set, order) in [(&[][..], Order::Splits), (&[("builder", "ploc")], Order::Merges)] {
        let film = film("builtin:soup?triangles=20000", "bvh", set);
        let Events::Levels(levels) = &film.replay.events else { panic!("many") };
        let inner = (0..film.replay.outline().len()).filter(|row| !film.replay.outline().below(*row).is_empty()).count();
        assert_eq!((film.order(), levels.iter().map(|level| level.1 as usize).sum::<usize>()), (order, inner));
        assert!(inner > MOST && film.last() < 100 && film.replay.just(3).is_none());
        assert!((film.cost(film.last()) / film.replay.outline().sah() - 1.0).abs() < 1e-5);
        let all = seen(&film, 0).1;
        assert!((0..=film.last()).all(|at| seen(&film, at).1 == all));
        let at_last = seen(&film, film.last()).0.len() as u32;
        assert_eq!(at_last, if order == Order::Splits { all } else { 1 });
    }
}

#[test]
fn the_upper_level_is_divided_first() {
    let film = film("builtin:sphere-flake?triangles=100000", "bvh", &[]);
    let level = |row: u32| (film.replay.outline().id(row).instance > 0, film.replay.level(row));
    let inner = (0..film.replay.outline().len()).filter(|row| !film.replay.outline().below(*row).is_empty());
    let mut levels: Vec<(bool, u32)> = inner.map(level).collect();
    levels.sort_unstable();
    assert!(levels.iter().any(|level| level.0) && levels.is_sorted_by_key(|level| level.1));
    let refused = try_film("builtin:sphere-flake?triangles=100000", "bvh", &[("builder", "ploc")], 1 << 30);
    assert!(matches!(refused, Err(FilmError::TwoOrders)));
}

#[test]
fn events_are_told_in_sentences() {
    let split = film(SMALL, "bvh", &[]);
    let all = split.replay.outline().row(0).references;
    assert!(split.tell(0).starts_with(&format!("Before the first split: {all} triangles in one cell, SAH cost of the tree ")));
    let parts: Vec<u32> = split.replay.outline().children(0).map(|part| split.replay.outline().row(part).references).collect();
    let (last, cost) = (split.last(), format::number(split.cost(1)));
    let told = format!("Split 1 of {last}: {all} triangles into {} and {}, SAH cost of the tree {cost}.", parts[0], parts[1]);
    assert_eq!(split.tell(1), told);
    let kd = film(SMALL, "kdtree", &[]);
    let parts: Vec<u32> = kd.replay.outline().children(0).map(|part| kd.replay.outline().row(part).references).collect();
    assert!(kd.replay.outline().row(0).references > all, "some triangles are in several leaves");
    assert!(kd.tell(0).starts_with(&format!("Before the first split: {all} triangles in one cell, ")), "{}", kd.tell(0));
    let told = format!(": {all} triangles into {} and {} references, SAH cost of the tree ", parts[0], parts[1]);
    assert!(kd.tell(1).contains(&told), "{}", kd.tell(1));
    let second = counted(kd.replay.outline().row(kd.replay.just(2).expect("a cell")).references.into(), "reference");
    assert!(kd.tell(2).contains(&format!(": {second} into ")), "{}", kd.tell(2));
    let merge = film(SMALL, "bvh", &[("builder", "ploc")]);
    assert!(
        merge.tell(1).contains(", in round 1: ")
            && merge.tell(u32::MAX).contains(&format!(" into {all} triangles, SAH cost so far "))
    );
    assert_eq!(listed(&["1".to_owned(), "2".to_owned(), "3".to_owned()]), "1, 2 and 3");
    assert_eq!((counted(1, "cell"), counted(2, "merge")), ("1 cell".to_owned(), "2 merges".to_owned()));
}

#[test]
fn it_stops_when_asked() {
    let (film, cx) = (film(SMALL, "bvh", &[]), BuildCx::unattended(1));
    cx.cancel.cancel();
    assert_eq!(levels_above(film.replay.outline(), &cx.cancel), Err(FilmError::Cancelled(Cancelled)));
    let mut charge = cx.budget.charge(0).expect("nothing");
    assert_eq!(rounds(film.replay.outline(), &mut charge, &cx.cancel), Err(FilmError::Cancelled(Cancelled)));
}

#[test]
fn there_is_none_of_a_list_that_ends_at_the_instances() {
    let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
    let scene = open("builtin:sphere-flake?triangles=100000", &load).expect("built in");
    let geometry = Arc::new(Geometry::with_instances(&scene, &load).expect("fits"));
    let entry = registry::find("bvh").expect("registered");
    let params = entry.defaults();
    let accel = entry.build(&geometry, TestKind::Watertight, &params, &cx).expect("builds");
    // The first rows are charged less than that, and those after them more.
    let budget = Budget::new(1 << 20);
    let outline = Outline::of(accel.as_ref(), SahWeights::of(&params), (&budget, &cx.cancel, &cx.progress));
    let cut = outline.expect("the upper level fits");
    assert!(cut.is_cut());
    let made = Film::of(&Subject { id: "bvh", accel: accel.as_ref(), params: &params }, Arc::new(cut), &cx);
    assert!(matches!(made, Err(FilmError::Cut)));
}

#[test]
fn what_does_not_fit_is_refused_and_grids_have_none() {
    assert!(matches!(try_film(SMALL, "bvh", &[], 100), Err(FilmError::Memory(_))));
    assert!(matches!(try_film(SMALL, "bvh", &[("builder", "ploc")], 100), Err(FilmError::Memory(_))));
    let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
    let geometry = Arc::new(Geometry::new(&open(SMALL, &load).expect("built in"), &load).expect("fits"));
    for entry in registry::ALL {
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds");
        assert_eq!(is_possible(accel.as_ref()), !["brute", "bound", "grid"].contains(&entry.id), "{}", entry.id);
    }
}

const MOVED: &[(&str, &str)] = &[("reinsertion", "on"), ("reinsertion_gain", "0")];

#[test]
fn nodes_are_moved_by_gain_and_bring_the_cost_to_that_of_the_finished_tree() {
    for builder in ["binned", "ploc", "sbvh", "median"] {
        // With one triangle in a leaf nothing is left to do once nodes are moved.
        let set = [MOVED, &[("builder", builder), ("max_leaf", "1")]].concat();
        let (film, sah, leaves) = try_all("builtin:soup?triangles=200", "bvh", &set, 1 << 30).expect("made");
        let (splits, last) = (film.replay.last(), film.last());
        let moves = film.moves.as_ref().expect("median and the like leave much to gain");
        assert_eq!(splits + moves.last(), last);
        let (before, after, end) = (film.cost(splits), film.cost(last - 1), film.cost(last));
        assert!(after < before && (after / end - 1.0).abs() < 1e-4, "{builder}: {before}, {after}, {end}");
        assert_eq!(end, sah);
        for at in splits + 1..last {
            let Seen::Moves([moved], _) = film.seen(at) else { panic!("{builder}: one move is one event") };
            assert!(moved.gain > 0.0 && film.cost(at) < film.cost(at - 1), "{builder}: {at}");
            assert!(moved.to.union(moved.node) == moved.to && moved.from.union(moved.node) == moved.from, "{builder}: {at}");
            assert!(moved.references >= 1 && film.tell(at).contains(", in round "), "{}", film.tell(at));
        }
        let Seen::Finished(outline) = film.seen(last) else { panic!("{builder}: the finished tree") };
        assert_eq!((0..outline.len()).filter(|row| film.seen(last).is_whole(*row)).count(), leaves);
        assert!(film.tell(last).starts_with(&format!("{} leaves chosen", format::count(leaves as u64))), "{}", film.tell(last));
    }
}

#[test]
fn of_too_many_moves_each_round_is_an_event() {
    let set = [MOVED, &[("builder", "median")]].concat();
    let film = film("builtin:soup?triangles=20000", "bvh", &set);
    let (splits, last) = (film.replay.last(), film.last());
    assert!(splits < 100 && (2..=33).contains(&(last - splits)), "{splits}, {last}");
    for at in splits + 1..last {
        let Seen::Moves(shown, _) = film.seen(at) else { panic!("a round") };
        assert!((1..=32).contains(&shown.len()) && film.tell(at).starts_with("Round "), "{}", film.tell(at));
        assert!(film.cost(at) < film.cost(at - 1));
    }
}

#[test]
fn what_does_not_move_its_own_cells_has_no_moves() {
    for (model, id) in [(SMALL, "wide"), ("builtin:sphere-flake?triangles=100000", "bvh")] {
        let film = film(model, id, &[("reinsertion", "on")]);
        assert!(!film.has_moves() && matches!(film.seen(film.last()), Seen::Cells(_, _, None)), "{id}");
    }
    // A single triangle more or less has nowhere to go.
    let film = film("builtin:soup?triangles=3", "bvh", &[MOVED, &[("max_leaf", "1")]].concat());
    assert!(!film.has_moves());
}

#[test]
fn a_tree_that_came_out_otherwise_is_refused() {
    let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
    let geometry = Arc::new(Geometry::new(&open(SMALL, &load).expect("built in"), &load).expect("fits"));
    let entry = registry::find("bvh").expect("registered");
    let mut params = entry.defaults();
    params.set("builder", "median").and_then(|()| params.set("max_leaf", "1")).expect("in range");
    let accel = entry.build(&geometry, TestKind::Watertight, &params, &cx).expect("builds");
    let on = (&cx.budget, &cx.cancel, &cx.progress);
    let outline = Outline::of(accel.as_ref(), SahWeights::of(&params), on).expect("small");
    // As if the time had run out at another round: as many nodes, in other places.
    params.set("reinsertion", "on").expect("in range");
    let made = Film::of(&Subject { id: "bvh", accel: accel.as_ref(), params: &params }, Arc::new(outline), &cx);
    assert!(matches!(made, Err(FilmError::Another)));
}
