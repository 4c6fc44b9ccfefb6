//! A subtree built by one thread, depth first, without taking memory for every cell: references and
//! events lie on stacks, the ones of the child below a plane on top of those of the child above it.
//!
//! ```text
//!   ... │ the cell's │ above │ below │        each of the four stacks (references, events of x, y, z)
//! ```

use std::ops::Range;

use super::builder::{Builder, List, Work, too_large};
use super::costs::Plane;
use super::deal::{Dealer, Dealt, HIGH, KdRef, LOW, keep, merge};
use super::events::{self, Event, Lists};
use super::tree::KdNode;
use crate::accel::BuildError;
use crate::geometry::num;
use crate::task::Charge;

/// The stacks, and room to deal in.
pub struct Bench {
    refs: Vec<KdRef>,
    /// Never shortened: what lies beyond the top cell's events is old.
    lists: Lists,
    dealt: Dealt,
    charge: Charge,
}

/// A cell on the stacks.
struct OnStack {
    work: Work,
    refs: Range<usize>,
    /// `None` where planes are chosen by bins.
    lists: Option<[Range<usize>; 3]>,
}

impl Bench {
    /// For a cell with these references and events.
    pub fn new(refs: Vec<KdRef>, lists: Lists, charge: Charge) -> Self {
        Self { refs, lists, dealt: Dealt::default(), charge }
    }

    fn bytes(&self) -> u64 {
        let events: usize = self.lists.iter().map(Vec::capacity).sum();
        (self.refs.capacity() * size_of::<KdRef>() + events * size_of::<Event>()) as u64
    }

    /// Charges for what the stacks have grown to.
    fn settle(&mut self) -> Result<(), BuildError> {
        let more = self.bytes().saturating_sub(self.charge.bytes());
        if more > 0 { self.charge.grow(more).map_err(too_large) } else { Ok(()) }
    }

    fn events(&self, lists: &[Range<usize>; 3]) -> [&[Event]; 3] {
        [0, 1, 2].map(|k| &self.lists[k][lists[k].clone()])
    }

    /// Sorts the events of a cell that had none; they go to the bottom of the stacks.
    fn make_events(&mut self, refs: &Range<usize>) -> [Range<usize>; 3] {
        self.lists.iter_mut().for_each(Vec::clear);
        self.refs[refs.clone()].iter().enumerate().for_each(|(i, r)| events::append(&mut self.lists, &r.bounds, num::index(i)));
        self.lists.iter_mut().for_each(|list| list.sort_unstable());
        [0, 1, 2].map(|k| 0..self.lists[k].len())
    }
}

impl Builder<'_> {
    /// Builds what is below a cell that has the whole bench.
    pub fn fill(&self, list: &mut List, bench: &mut Bench, work: Work, events: bool) -> Result<(), BuildError> {
        let lists = events.then(|| [0, 1, 2].map(|k| 0..bench.lists[k].len()));
        let refs = 0..bench.refs.len();
        self.fill_on(list, bench, OnStack { work, refs, lists })
    }

    fn fill_on(&self, list: &mut List, bench: &mut Bench, mut cell: OnStack) -> Result<(), BuildError> {
        if cell.lists.is_none() && self.is_exact(cell.refs.len()) {
            cell.lists = Some(bench.make_events(&cell.refs));
        }
        let found = {
            let lists = cell.lists.as_ref().map(|lists| bench.events(lists));
            self.divide(&cell.work, &bench.refs[cell.refs.clone()], lists)?
        };
        let Some((plane, bad)) = found else { return self.leaf(list, &cell.work, &bench.refs[cell.refs]) };
        let at = list.nodes.len();
        list.nodes.push(KdNode::leaf(0, 0));
        let (low, high) = self.deal_on(bench, &cell, &plane, bad);
        bench.settle()?;
        let top = high.refs.end;
        self.fill_on(list, bench, low)?;
        bench.refs.truncate(top);
        list.nodes[at] = KdNode::inner(plane.axis, plane.pos, num::index(list.nodes.len()));
        self.fill_on(list, bench, high)
    }

    /// Puts the children's references and events on the stacks.
    fn deal_on(&self, bench: &mut Bench, cell: &OnStack, plane: &Plane, bad: u32) -> (OnStack, OnStack) {
        let dealer = Dealer { geometry: self.geometry, cell: cell.work.cell, plane: *plane, events: cell.lists.is_some() };
        let Bench { refs, lists, dealt, .. } = bench;
        dealt.deal(&refs[cell.refs.clone()], &dealer);
        let start = refs.len();
        refs.extend_from_slice(&dealt.high.refs);
        let middle = refs.len();
        refs.extend_from_slice(&dealt.low.refs);
        let (low, high) = self.sides(&cell.work, plane, bad);
        let mut low = OnStack { work: low, refs: middle..refs.len(), lists: None };
        let mut high = OnStack { work: high, refs: start..middle, lists: None };
        if let Some(own) = &cell.lists {
            let mut ranges = [0, 1, 2].map(|k| split_on(&mut lists[k], &own[k], dealt, k));
            low.lists = Some(ranges.each_mut().map(|(low, _)| std::mem::take(low)));
            high.lists = Some(ranges.map(|(_, high)| high));
        }
        (low, high)
    }
}

/// Puts the children's events of one axis on its stack, above those of the cell.
fn split_on(stack: &mut Vec<Event>, own: &Range<usize>, dealt: &mut Dealt, k: usize) -> (Range<usize>, Range<usize>) {
    let (fresh_low, fresh_high) = (&mut dealt.low.fresh[k], &mut dealt.high.fresh[k]);
    let room = 2 * own.len() + fresh_low.len() + fresh_high.len();
    if stack.len() < own.end + room {
        stack.resize(own.end + room, Event::default());
    }
    let (below, free) = stack.split_at_mut(own.end);
    let own_events = &below[own.clone()];
    let n = keep(own_events, &dealt.moved, HIGH, free);
    let n = merge(free, n, fresh_high);
    let free = &mut free[n..];
    let m = keep(own_events, &dealt.moved, LOW, free);
    let m = merge(free, m, fresh_low);
    (own.end + n..own.end + n + m, own.end..own.end + n)
}
