//! Many rays on one core, taking turns: while one waits for memory the others go on.
//!
//! Each step ends with a prefetch of what the ray needs next, and then it is the next ray's turn. So
//! the latency of a node in far memory is shared by all rays on their way, and the processor always
//! has several that do not depend on each other.

use std::cell::RefCell;

use super::leaf::Pack;
use super::ray::{Open, Walk};
use super::tree::Tree;
use crate::accel::probe::Off;
use crate::accel::{Hit, Query, Traced};
use crate::geometry::Ray;
use crate::geometry::space::Entered;
use crate::geometry::tri::TriTest;
use crate::simd::{Kernel, Simd};
use crate::task::{Cancel, Cancelled};

/// Rays on their way at a time.
pub const TURNS: usize = 16;
/// Rays that are begun between two looks at the cancel flag.
const RAYS_PER_CHECK: usize = 256;

/// World rays to be traced.
pub struct Batch<'a, T, B, Q> {
    pub tree: &'a Tree<T, B>,
    pub rays: &'a [Ray],
    pub query: &'a Q,
    pub hits: &'a mut [Option<Hit>],
    pub cancel: &'a Cancel,
    /// Of so many rays at a time, at most [`TURNS`].
    pub open: &'a mut [Open],
}

/// A ray on its way, and where its hit goes.
struct Turn<'a, T> {
    walk: Walk<'a, T>,
    entered: Entered,
    at: usize,
    on_its_way: bool,
}

thread_local! {
    /// What rays have met and not visited yet, kept from batch to batch.
    static OPEN: RefCell<Vec<Open>> = const { RefCell::new(Vec::new()) };
}

/// Lends `n` of them.
#[inline(always)]
pub fn with_open<R>(n: usize, work: impl FnOnce(&mut [Open]) -> R) -> R {
    OPEN.with(|kept| {
        // Taken while they are lent: a query may trace rays of its own.
        let mut open = kept.take();
        if open.len() < n {
            open.resize(n, Open::new());
        }
        let result = work(&mut open[..n]);
        kept.replace(open);
        result
    })
}

impl<T: TriTest, B: Pack, Q: Query> Kernel for Batch<'_, T, B, Q> {
    type Out = Result<Traced, Cancelled>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Self::Out {
        let Self { tree, rays, query, hits, cancel, open } = self;
        let mut rest = Rest { tree, rays, hits, cancel, next: 0, traced: Traced::default() };
        let mut turns: Vec<Turn<'_, T>> = Vec::with_capacity(open.len());
        let mut active = 0;
        for open in open {
            let mut turn = Turn { walk: Walk::idle(&tree.geometry, open), entered: Entered::NOWHERE, at: 0, on_its_way: false };
            turn.on_its_way = rest.begin(&mut turn)?;
            active += usize::from(turn.on_its_way);
            turns.push(turn);
        }
        while active > 0 {
            for turn in &mut turns {
                if turn.walk.step::<S, B, Q, Off>(s, &tree.units, query, &mut Off) {
                    tree.prefetch(s, turn.walk.next());
                } else if turn.on_its_way {
                    rest.end(turn);
                    turn.on_its_way = rest.begin(turn)?;
                    active -= usize::from(!turn.on_its_way);
                }
            }
        }
        Ok(rest.traced)
    }
}

/// Rays that are not begun yet.
struct Rest<'a, T, B> {
    tree: &'a Tree<T, B>,
    rays: &'a [Ray],
    hits: &'a mut [Option<Hit>],
    cancel: &'a Cancel,
    next: usize,
    traced: Traced,
}

impl<T: TriTest, B: Pack> Rest<'_, T, B> {
    /// Begins with the next ray that may hit anything; false if there is none.
    #[inline(always)]
    fn begin(&mut self, turn: &mut Turn<'_, T>) -> Result<bool, Cancelled> {
        while let Some(ray) = self.rays.get(self.next) {
            let at = self.next;
            self.next += 1;
            if at.is_multiple_of(RAYS_PER_CHECK) {
                self.cancel.check()?;
            }
            if ray.is_valid() {
                let entered = self.tree.geometry.space().enter(ray);
                if entered.ray.tmin <= entered.ray.tmax {
                    turn.walk.begin(&entered.ray, &self.tree.geometry, self.tree.root);
                    turn.entered = entered;
                    turn.at = at;
                    return Ok(true);
                }
            } else {
                self.traced.invalid += 1;
            }
            self.hits[at] = None;
        }
        Ok(false)
    }

    #[inline(always)]
    fn end(&mut self, turn: &Turn<'_, T>) {
        self.hits[turn.at] = turn.walk.found().map(|hit| {
            let (instance, primitive) = self.tree.geometry.locate(hit.prim);
            Hit { t: turn.entered.world_t(hit.t), u: hit.u, v: hit.v, instance, primitive }
        });
    }
}
