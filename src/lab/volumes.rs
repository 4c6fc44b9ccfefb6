//! Bounding volumes, tightness against cost: the same tree with each kind of volume around its
//! nodes. How much larger the volumes are than the convex hulls, what one test of them takes, how
//! often they let a ray in for nothing, and what a ray takes in the end.

use std::ops::Range;
use std::sync::Arc;
use std::time::Instant;

use rayon::prelude::*;
use serde::Serialize;

use super::rays::RaySet;
use super::sample::pick;
use super::statistics::{half_iqr, median};
use super::timing::Timing;
use super::{Contestant, MeasureOptions, measure};
use crate::accel::Accel;
use crate::accel::volumes::{Loose, Seen, Volumes};
use crate::geometry::Ray;
use crate::geometry::num::index;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// A tree with one kind of volume.
#[derive(Clone)]
pub struct VolumeTree {
    /// The kind.
    pub id: &'static str,
    /// The tree; all trees compared must have the same nodes.
    pub tree: Arc<dyn Volumes>,
    /// Wall-clock seconds of the build.
    pub build_secs: f64,
}

/// One kind of volume in figures. Field names are the schema of `boxwood volumes --json`.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct VolumeRow {
    /// The kind.
    pub id: &'static str,
    /// Wall-clock seconds of the build.
    pub build_secs: f64,
    /// Bytes of nodes, and the faces that hulls share, for each node.
    pub bytes_per_node: f64,
    /// The sum of the volumes' areas over the sum of the hulls', over all nodes whose hull is known.
    pub area_ratio: f64,
    /// The mean over the same nodes of the volume's area over the hull's.
    pub area_ratio_mean: f64,
    /// Nodes whose hull is known.
    pub area_nodes: usize,
    /// Volumes looser than their name says.
    #[serde(flatten)]
    pub loose: Loose,
    /// What was seen of a ray's traversal.
    #[serde(flatten)]
    pub traversal: Traversal,
    /// Nanoseconds of one test of a volume.
    pub test_ns: TestTime,
    /// How long rays took, and what was counted of them.
    pub rays: Timing,
}

/// What traversals do, counted over a part of the rays, spread evenly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Traversal {
    /// Rays that were counted.
    pub rays_counted: usize,
    /// Volumes tested by a ray.
    pub tests_per_ray: f64,
    /// Nodes entered by a ray.
    pub nodes_per_ray: f64,
    /// The share of entered nodes in which no triangle is hit by the ray, nowhere in its interval.
    pub false_positives: f64,
}

/// A tight loop over the volumes that real rays tested, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct TestTime {
    /// The median over rounds.
    pub median: f64,
    /// Half the interquartile range.
    pub spread: f64,
    /// Tests in a round.
    pub tests: usize,
    /// The share of them that met the volume.
    pub met: f64,
}

/// Rays whose traversal is looked into.
const WATCHED: usize = 4000;

/// Tests in a round of the tight loop, at most: some milliseconds.
const MOST_TESTS: usize = 300_000;

/// Measures all trees with one set of rays; the rows are in the trees' order. The true hulls' areas
/// come from whichever tree knows them, the one of hulls; without it the ratios are NaN.
///
/// The caller sees to it that nothing else keeps the processors busy.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn measure_volumes(
    trees: &[VolumeTree],
    set: &RaySet,
    options: &MeasureOptions,
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Vec<VolumeRow>, Cancelled> {
    progress.start("look", trees.len() as u64 * 2);
    let rays: Vec<Ray> = pick(&set.rays, WATCHED).into_iter().filter(Ray::is_valid).collect();
    let hit = triangles_hit(trees, &rays, pool, cancel)?;
    let mut looked = Vec::new();
    for tree in trees {
        let areas = Areas::of(tree, trees, pool, cancel)?;
        progress.advance(1);
        looked.push((areas, Looked::at(tree, set, &rays, &hit, pool, cancel)?));
        progress.advance(1);
    }
    let test_ns = time_tests(trees, &looked.iter().map(|(_, l)| &l.pairs[..]).collect::<Vec<_>>(), &rays, options, cancel)?;
    let contestant = |tree: &VolumeTree| Contestant { id: tree.id.to_owned(), accel: Arc::clone(&tree.tree) as Arc<dyn Accel> };
    let contestants: Vec<Contestant> = trees.iter().map(contestant).collect();
    let timings = measure(&contestants, set, options, pool, cancel, progress)?;

    let parts = trees.iter().zip(looked).zip(test_ns).zip(timings);
    Ok(parts
        .map(|(((tree, (areas, looked)), test_ns), rays)| VolumeRow {
            id: tree.id,
            build_secs: tree.build_secs,
            bytes_per_node: tree.tree.node_bytes() as f64 / tree.tree.node_count().max(1) as f64,
            area_ratio: areas.volumes / areas.hulls,
            area_ratio_mean: areas.ratios / areas.nodes as f64,
            area_nodes: areas.nodes,
            loose: tree.tree.loose(),
            traversal: looked.traversal,
            test_ns,
            rays,
        })
        .collect())
}

/// Sums over the nodes whose hull is known.
#[derive(Clone, Copy, Default)]
struct Areas {
    volumes: f64,
    hulls: f64,
    ratios: f64,
    nodes: usize,
}

impl Areas {
    fn of(tree: &VolumeTree, trees: &[VolumeTree], pool: &Pool, cancel: &Cancel) -> Result<Self, Cancelled> {
        let hull = |node: u32| trees.iter().find_map(|other| other.tree.hull_area(node)).filter(|area| *area > 0.0);
        let of_node = |node: u32| {
            cancel.check()?;
            let Some(hull) = hull(node) else { return Ok(Self::default()) };
            let volume = tree.tree.area(node);
            Ok(Self { volumes: volume, hulls: hull, ratios: volume / hull, nodes: 1 })
        };
        // Added up in order, so that the sum does not depend on the threads.
        let parts: Result<Vec<Self>, Cancelled> =
            pool.run(|| (0..index(tree.tree.node_count())).into_par_iter().map(of_node).collect());
        Ok(parts?.into_iter().fold(Self::default(), |a, b| Self {
            volumes: a.volumes + b.volumes,
            hulls: a.hulls + b.hulls,
            ratios: a.ratios + b.ratios,
            nodes: a.nodes + b.nodes,
        }))
    }
}

/// For each ray the places of the triangles it hits, ascending. The same for all trees.
fn triangles_hit(trees: &[VolumeTree], rays: &[Ray], pool: &Pool, cancel: &Cancel) -> Result<Vec<Vec<u32>>, Cancelled> {
    let Some(first) = trees.first() else { return Ok(Vec::new()) };
    let packed = first.tree.packed();
    let mut place = vec![0; first.tree.geometry().triangle_count()];
    packed.iter().enumerate().for_each(|(i, prim)| place[*prim as usize] = index(i));
    let of_ray = |ray: &Ray| {
        cancel.check()?;
        let mut places: Vec<u32> = first.tree.all_hits(ray).into_iter().map(|prim| place[prim as usize]).collect();
        places.sort_unstable();
        Ok(places)
    };
    pool.run(|| rays.par_iter().map(of_ray).collect())
}

/// The traversals of some rays through one tree.
struct Looked {
    traversal: Traversal,
    /// Node and ray of every test, up to the most that are timed.
    pairs: Vec<(u32, u32)>,
}

impl Looked {
    fn at(
        tree: &VolumeTree,
        set: &RaySet,
        rays: &[Ray],
        hit: &[Vec<u32>],
        pool: &Pool,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        let watch = |ray: &Ray| {
            cancel.check()?;
            let mut seen = Seen::default();
            tree.tree.watch(ray, set.mode, &mut seen);
            Ok(seen)
        };
        let seen: Result<Vec<Seen>, Cancelled> = pool.run(|| rays.par_iter().map(watch).collect());
        let seen = seen?;
        let ranges = tree.tree.ranges();
        let in_vain =
            |(seen, hit): (&Seen, &Vec<u32>)| seen.entered.iter().filter(|n| !any_in(hit, &ranges[**n as usize])).count();
        let (tests, nodes) = seen.iter().fold((0, 0), |(t, n), s| (t + s.tested.len(), n + s.entered.len()));
        let vain: usize = seen.iter().zip(hit).map(in_vain).sum();
        let each = rays.len() as f64;
        let traversal = Traversal {
            rays_counted: rays.len(),
            tests_per_ray: tests as f64 / each,
            nodes_per_ray: nodes as f64 / each,
            false_positives: vain as f64 / nodes as f64,
        };
        let of_ray = |(ray, seen): (usize, &Seen)| seen.tested.iter().map(|node| (*node, index(ray))).collect::<Vec<_>>();
        let pairs = seen.iter().enumerate().flat_map(of_ray).take(MOST_TESTS).collect();
        Ok(Self { traversal, pairs })
    }
}

/// Whether an ascending list has a member in a range.
fn any_in(ascending: &[u32], range: &Range<u32>) -> bool {
    let from = ascending.partition_point(|place| *place < range.start);
    ascending.get(from).is_some_and(|place| *place < range.end)
}

/// Times the tests of all trees in turns, by one thread.
fn time_tests(
    trees: &[VolumeTree],
    pairs: &[&[(u32, u32)]],
    rays: &[Ray],
    options: &MeasureOptions,
    cancel: &Cancel,
) -> Result<Vec<TestTime>, Cancelled> {
    let runs: Vec<_> = trees.iter().zip(pairs).map(|(tree, pairs)| tree.tree.tests(rays, pairs)).collect();
    // The first round warms up and is not counted.
    let met: Vec<usize> = runs.iter().map(|run| run()).collect();
    let mut ns: Vec<Vec<f64>> = vec![Vec::new(); runs.len()];
    for round in 0..options.min_rounds.max(1) {
        for i in 0..runs.len() {
            cancel.check()?;
            let k = (round + i) % runs.len();
            let start = Instant::now();
            std::hint::black_box(runs[k]());
            ns[k].push(start.elapsed().as_secs_f64() * 1e9 / pairs[k].len() as f64);
        }
    }
    let row = |k: usize| {
        let tests = pairs[k].len();
        // Of no samples neither is a number.
        let samples = if tests == 0 { &[] } else { &ns[k][..] };
        TestTime { median: median(samples), spread: half_iqr(samples), tests, met: met[k] as f64 / tests as f64 }
    };
    Ok((0..runs.len()).map(row).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_range_is_looked_up_in_an_ascending_list() {
        let hit = [3, 7, 7, 20];
        for (range, expected) in
            [(0..3, false), (0..4, true), (4..7, false), (7..8, true), (8..20, false), (20..21, true), (21..99, false)]
        {
            assert_eq!(any_in(&hit, &range), expected, "{range:?}");
        }
        assert!(!any_in(&[], &(0..9)));
    }
}
