//! Many rays on one core at a time.
//!
//! Rays wait in lists by what they do next: enter a node, look at a block of triangles, settle what was
//! found there. Each list is worked off by a loop of its own, in which no branch depends on what a ray
//! meets: which list a ray joins next is arithmetic. So the processor overlaps the steps of many
//! rays, foresees every branch, and what a ray needs next, asked for when it joins its list, is there when
//! its turn comes.

use std::cell::Cell;
use std::thread::LocalKey;

use super::beam::Beam;
use super::child::Child;
use super::leaf::Pack;
use super::node::Node;
use super::open::Open;
use super::tree::Tree;
use super::way::{Rest, Way};
use crate::accel::probe::Off;
use crate::accel::{Hit, Query, Traced};
use crate::geometry::tri::{TriTest, splat_own};
use crate::geometry::{EightSlabs, Ray};
use crate::simd::{Kernel, Simd};
use crate::task::{Cancel, Cancelled};

/// Rays on their way at a time: what they need fits the first level of the cache together with what they
/// are about to visit.
const RAYS: usize = 32;
/// Beams on their way at a time.
const BEAMS: usize = 8;
/// Rounds between two looks at the cancel flag.
const ROUNDS_PER_CHECK: usize = 64;

/// World rays to be traced.
pub struct Batch<'a, T, B, Q> {
    pub tree: &'a Tree<T, B>,
    pub rays: &'a [Ray],
    pub query: &'a Q,
    pub hits: &'a mut [Option<Hit>],
    pub cancel: &'a Cancel,
    pub under_way: &'a mut UnderWay,
}

/// Rays and beams on their way.
pub struct UnderWay {
    ways: [Way; RAYS],
    beams: [Beam; BEAMS],
}

/// Kept by each thread from call to call.
type Kept<V> = LocalKey<Cell<Option<Box<V>>>>;

thread_local! {
    static UNDER_WAY: Cell<Option<Box<UnderWay>>> = const { Cell::new(None) };
    /// What a ray alone has met and not visited yet.
    static OPEN: Cell<Option<Box<Open>>> = const { Cell::new(None) };
}

/// Lends room for a batch.
pub fn with_under_way<R>(work: impl FnOnce(&mut UnderWay) -> R) -> R {
    lend(&UNDER_WAY, UnderWay::new, work)
}

/// Lends room for one ray.
#[inline(always)]
pub fn with_open<R>(work: impl FnOnce(&mut Open) -> R) -> R {
    lend(&OPEN, Open::new, work)
}

/// Taken while it is lent: a query may trace rays of its own.
#[inline(always)]
fn lend<V, R>(kept: &'static Kept<V>, new: fn() -> V, work: impl FnOnce(&mut V) -> R) -> R {
    let mut lent = kept.take().unwrap_or_else(|| boxed(new));
    let result = work(&mut lent);
    kept.set(Some(lent));
    result
}

/// Too large for the frame of whoever asks for it.
#[cold]
#[inline(never)]
fn boxed<V>(new: fn() -> V) -> Box<V> {
    Box::new(new())
}

impl UnderWay {
    /// Nobody.
    const fn new() -> Self {
        Self { ways: [const { Way::idle() }; RAYS], beams: [const { Beam::idle() }; BEAMS] }
    }
}

/// Rays, or beams, by what they do next, each with what it visits: the kinds of [`Child`], [`SETTLE`], and
/// [`FETCHED`].
struct Lists<const N: usize> {
    entries: [[(Child, u32); N]; LISTS],
    lens: [usize; LISTS],
}

/// A power of two, so that the number of a list is cut short by a mask.
const LISTS: usize = 8;
/// The list of rays that have found something.
const SETTLE: usize = 1;
/// The list of rays at a block whose points were asked for.
const FETCHED: usize = 4;

impl<const N: usize> Lists<N> {
    /// All are idle.
    fn new() -> Self {
        let idle = std::array::from_fn(|i| (Child::NONE, i as u32));
        let (mut entries, mut lens) = ([[(Child::NONE, 0); N]; LISTS], [0; LISTS]);
        (entries[Child::NOTHING], lens[Child::NOTHING]) = (idle, N);
        Self { entries, lens }
    }

    /// One joins a list. There are never more of them than there is room for.
    #[inline(always)]
    const fn add(&mut self, list: usize, next: Child, who: usize) {
        let list = list % LISTS;
        let len = self.lens[list];
        self.entries[list][len % N] = (next, who as u32);
        self.lens[list] = len + 1;
    }

    #[inline(always)]
    const fn get(&self, list: usize, i: usize) -> (Child, usize) {
        let (child, who) = self.entries[list % LISTS][i % N];
        (child, who as usize % N)
    }

    /// Empties a list that is read from now on, one entry after another, before new ones reach it: how
    /// many there are.
    #[inline(always)]
    const fn take(&mut self, list: usize) -> usize {
        std::mem::replace(&mut self.lens[list], 0)
    }

    /// The last of those that are idle.
    #[inline(always)]
    const fn idle(&self) -> Option<usize> {
        match self.lens[Child::NOTHING] {
            0 => None,
            n => Some(self.get(Child::NOTHING, n - 1).1),
        }
    }

    /// The last of those that are idle begins.
    #[inline(always)]
    const fn begin(&mut self, root: Child, who: usize) {
        self.lens[Child::NOTHING] -= 1;
        self.add(root.kind(), root, who);
    }
}

impl<T: TriTest, B: Pack, Q: Query> Kernel for Batch<'_, T, B, Q> {
    type Out = Result<Traced, Cancelled>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Out {
        let Self { tree, rays, query, hits, cancel, under_way: UnderWay { ways, beams } } = self;
        let whose = tree.geometry.whose();
        let (mut lists, mut beam_lists) = (Lists::<RAYS>::new(), Lists::<BEAMS>::new());
        let mut rest = Rest::new(&tree.geometry, rays);
        let mut rounds = 0usize;
        loop {
            if rounds.is_multiple_of(ROUNDS_PER_CHECK) {
                cancel.check()?;
            }
            rounds += 1;
            // Others begin; no more than that between two looks at the flag.
            for _ in 0..RAYS {
                while let Some(idle) = lists.idle()
                    && let Some(ready) = rest.take()
                {
                    ways[idle].begin(ready, tree.root);
                    lists.begin(tree.root, idle);
                }
                if let Some(idle) = beam_lists.idle()
                    && rest.can_prepare()
                {
                    if rest.prepare::<T, S>(s, hits, &mut beams[idle], tree.root) {
                        beam_lists.begin(tree.root, idle);
                    }
                } else {
                    break;
                }
            }
            let (idle, idle_beams) = (lists.lens[Child::NOTHING], beam_lists.lens[Child::NOTHING]);
            if idle == RAYS && idle_beams == BEAMS && rest.is_done() {
                return Ok(rest.traced);
            }
            enter_nodes(s, tree, ways, &mut lists);
            look_at_blocks(s, tree, ways, &mut lists);
            settle(s, tree, query, ways, &mut lists);
            for i in idle..lists.lens[Child::NOTHING] {
                let (_, ray) = lists.get(Child::NOTHING, i);
                ways[ray].end(&whose, hits);
            }
            step_beams(s, tree, query, beams, &mut beam_lists);
            for i in idle_beams..beam_lists.lens[Child::NOTHING] {
                let (_, who) = beam_lists.get(Child::NOTHING, i);
                beams[who].end(s, &whose, hits);
            }
        }
    }
}

/// Rays that enter a node.
#[inline(always)]
fn enter_nodes<S: Simd, T: TriTest, B: Pack>(s: S, tree: &Tree<T, B>, ways: &mut [Way; RAYS], lists: &mut Lists<RAYS>) {
    let nodes = lists.take(Child::NODE);
    for i in 0..nodes {
        let (child, ray) = lists.get(Child::NODE, i);
        let (way, node) = (&mut ways[ray], B::Node::at(&tree.units, child.place()));
        let met = node.meet(s, &way.slabs(), way.best.tmin(), way.best.t());
        way.last = way.open.replace(s, way.last, node.children(), &met, way.order());
    }
    // What comes next is looked up in a loop of its own: by then it is known for all of them.
    for i in 0..nodes {
        let (_, ray) = lists.get(Child::NODE, i);
        let next = ways[ray].open.next(ways[ray].last);
        tree.prefetch(s, next);
        lists.add(next.kind(), next, ray);
    }
}

/// Rays that look at a block of triangles.
#[inline(always)]
fn look_at_blocks<S: Simd, T: TriTest, B: Pack>(s: S, tree: &Tree<T, B>, ways: &mut [Way; RAYS], lists: &mut Lists<RAYS>) {
    let looked_at = if B::REFERS { FETCHED } else { Child::BLOCKS };
    for i in 0..lists.take(looked_at) {
        let (child, ray) = lists.get(looked_at, i);
        let way = &mut ways[ray];
        let block = B::at(&tree.units, child.place());
        let axes = way.test::<T>().axes();
        let slabs = EightSlabs::splat(s, &way.slabs_in_order(axes));
        let interval = [s.splat(way.best.tmin()), s.splat(way.best.t())];
        let hits = T::hit_eight(s, &splat_own(s, &way.own()), &slabs, interval, &block.corners(s, tree.points(), axes));
        way.found.keep(s, &hits, block.lanes());
        way.block = child.place();
        way.last = way.open.shorten(way.last, child, B::UNITS);
        let next = way.open.next(way.last);
        tree.prefetch(s, next);
        let list = if way.found.any() { SETTLE } else { next.kind() };
        lists.add(list, next, ray);
    }
    if B::REFERS {
        // Their points are there when their turn comes.
        for i in 0..lists.take(Child::BLOCKS) {
            let (child, ray) = lists.get(Child::BLOCKS, i);
            B::at(&tree.units, child.place()).prefetch(s, tree.points());
            lists.add(FETCHED, child, ray);
        }
    }
}

/// Rays that have found something.
#[inline(always)]
fn settle<S: Simd, T: TriTest, B: Pack, Q: Query>(
    s: S,
    tree: &Tree<T, B>,
    query: &Q,
    ways: &mut [Way; RAYS],
    lists: &mut Lists<RAYS>,
) {
    for i in 0..lists.take(SETTLE) {
        let (_, ray) = lists.get(SETTLE, i);
        let way = &mut ways[ray];
        let (test, before) = (way.test::<T>(), way.best.t());
        if way.found.settle(&test, (B::at(&tree.units, way.block), tree.points()), query, &mut way.best, &mut Off::plain()) {
            lists.add(Child::NOTHING, Child::NONE, ray);
            continue;
        }
        if way.best.t() < before {
            way.last = way.open.forget_behind(s, way.last, way.best.t(), &mut Off::plain());
        }
        let next = way.open.next(way.last);
        tree.prefetch(s, next);
        lists.add(next.kind(), next, ray);
    }
}

/// All beams: first those that enter a node, then those that test a block.
#[inline(always)]
fn step_beams<S: Simd, T: TriTest, B: Pack, Q: Query>(
    s: S,
    tree: &Tree<T, B>,
    query: &Q,
    beams: &mut [Beam; BEAMS],
    lists: &mut Lists<BEAMS>,
) {
    for i in 0..lists.take(Child::NODE) {
        let (child, who) = lists.get(Child::NODE, i);
        let beam = &mut beams[who];
        beam.enter(s, B::Node::at(&tree.units, child.place()));
        let next = beam.open.next(beam.last);
        tree.prefetch(s, next);
        lists.add(next.kind(), next, who);
    }
    for i in 0..lists.take(Child::BLOCKS) {
        let (child, who) = lists.get(Child::BLOCKS, i);
        let beam = &mut beams[who];
        beam.last = beam.open.shorten(beam.last, child, B::UNITS);
        let more = beam.test::<S, T, B, Q>(s, (B::at(&tree.units, child.place()), tree.points()), query);
        let next = if more { beam.open.next(beam.last) } else { Child::NONE };
        tree.prefetch(s, next);
        lists.add(next.kind(), next, who);
    }
}
