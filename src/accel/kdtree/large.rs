//! The work of large cells, in parallel portions: each is a fixed number of references or events, so
//! the result does not depend on the number of threads.

use rayon::prelude::*;

use super::builder::{Builder, FORK, Work, too_large};
use super::costs::Plane;
use super::deal::{Dealer, Dealt, HIGH, KdRef, LOW, Moved, Side, keep, merge};
use super::events::{self, Event, Lists};
use super::sort::{gather, sort};
use crate::accel::BuildError;
use crate::geometry::{Aabb, num};
use crate::task::Charge;

/// References, or events, in a portion.
const CHUNK: usize = 1 << 14;

/// The references of a cell, their events where they are kept, and the memory of both.
pub struct Part {
    /// Where the triangles are in the cell.
    pub refs: Vec<KdRef>,
    /// `None` where planes are chosen by bins.
    pub lists: Option<Lists>,
    /// Of both.
    pub charge: Charge,
}

impl Builder<'_> {
    /// All live triangles.
    pub fn everything(&self) -> Result<Part, BuildError> {
        let (n, cx) = (self.geometry.live_count(), self.cx);
        let mut charge = self.charge(0)?;
        charge.grow((2 * n * size_of::<KdRef>()) as u64).map_err(too_large)?;
        let reference = |i| {
            let prim = self.geometry.live(i);
            KdRef { bounds: Aabb::of_triangle(&self.geometry.corners(prim)), prim }
        };
        let chunk = |c: usize| cx.cancel.check().map(|()| (c * CHUNK..n.min((c + 1) * CHUNK)).map(reference).collect::<Vec<_>>());
        let chunks: Result<Vec<_>, _> = cx.pool.run(|| (0..n.div_ceil(CHUNK)).into_par_iter().map(chunk).collect());
        let refs = gather(chunks?, &cx.cancel)?;
        if n < FORK || !self.is_exact(n) {
            return Ok(Part { refs, lists: None, charge });
        }
        cx.progress.start("sort", 0);
        charge.grow((3 * 2 * 2 * n * size_of::<Event>()) as u64).map_err(too_large)?;
        let lists = cx.pool.run(|| self.sorted(&refs))?;
        Ok(Part { refs, lists: Some(lists), charge })
    }

    /// The events of all axes, in order.
    fn sorted(&self, refs: &[KdRef]) -> Result<Lists, BuildError> {
        let events = |(c, refs): (usize, &[KdRef])| {
            let mut lists = Lists::default();
            refs.iter().enumerate().for_each(|(i, r)| events::append(&mut lists, &r.bounds, num::index(c * CHUNK + i)));
            self.cx.cancel.check().map(|()| lists)
        };
        let chunks: Vec<Lists> = refs.par_chunks(CHUNK).enumerate().map(events).collect::<Result<_, _>>()?;
        let [mut of_x, mut of_y, mut of_z] = [const { Vec::new() }; 3];
        for [x, y, z] in chunks {
            of_x.push(x);
            of_y.push(y);
            of_z.push(z);
        }
        let axis = |chunks| sort(chunks, &self.cx.cancel);
        let (x, (y, z)) = rayon::join(|| axis(of_x), || rayon::join(|| axis(of_y), || axis(of_z)));
        Ok([x?, y?, z?])
    }

    /// What each side of a large cell gets, worked out in parallel portions.
    pub fn deal_large(&self, work: &Work, part: Part, plane: &Plane) -> Result<(Part, Part), BuildError> {
        let dealer = Dealer { geometry: self.geometry, cell: work.cell, plane: *plane, events: part.lists.is_some() };
        // Until both sides have their own.
        let _held = self.charge(size_of_val(&part.refs[..]))?;
        let chunk = |refs: &[KdRef]| {
            let mut dealt = Dealt::default();
            dealt.deal(refs, &dealer);
            self.cx.cancel.check().map(|()| dealt)
        };
        let chunks: Vec<Dealt> = part.refs.par_chunks(CHUNK).map(chunk).collect::<Result<_, _>>()?;
        let mut dealt = Dealt::default();
        for chunk in chunks {
            self.cx.cancel.check()?;
            dealt.append(chunk);
        }
        let (low, high) = (std::mem::take(&mut dealt.low), std::mem::take(&mut dealt.high));
        let lists = part.lists.as_ref();
        let side = |side: Side, bit| self.side(side, lists, &dealt.moved, bit);
        let (low, high) = rayon::join(|| side(low, LOW), || side(high, HIGH));
        Ok((low?, high?))
    }

    /// One side's part: its references, and of the cell's events those that it keeps.
    fn side(&self, side: Side, lists: Option<&Lists>, moved: &[Moved], bit: u32) -> Result<Part, BuildError> {
        let events = if lists.is_some() { 6 * side.refs.len() * size_of::<Event>() } else { 0 };
        let charge = self.charge(side.refs.len() * size_of::<KdRef>() + events)?;
        let Some([x, y, z]) = lists else { return Ok(Part { refs: side.refs, lists: None, charge }) };
        let [fresh_x, fresh_y, fresh_z] = side.fresh;
        let axis = |events, fresh| self.keep_sorted(events, fresh, moved, bit);
        let (x, (y, z)) = rayon::join(|| axis(x, fresh_x), || rayon::join(|| axis(y, fresh_y), || axis(z, fresh_z)));
        Ok(Part { refs: side.refs, lists: Some([x?, y?, z?]), charge })
    }

    /// Keeps and merges in chunks of the cell's events; the fresh ones go where they belong.
    fn keep_sorted(&self, events: &[Event], fresh: Vec<Event>, moved: &[Moved], bit: u32) -> Result<Vec<Event>, BuildError> {
        let fresh = sort(vec![fresh], &self.cx.cancel)?;
        let chunk = |(c, own): (usize, &[Event])| {
            // The kept events are renamed, so fresh ones are divided by place and kind alone.
            let place = |i: usize| events.get(i).map(|e| e.renamed(0));
            let from = if c == 0 { 0 } else { place(c * CHUNK).map_or(0, |at| fresh.partition_point(|e| *e < at)) };
            let to = place((c + 1) * CHUNK).map_or(fresh.len(), |at| fresh.partition_point(|e| *e < at));
            let mut mine = fresh[from..to].to_vec();
            let mut out = vec![Event::default(); own.len() + mine.len()];
            let kept = keep(own, moved, bit, &mut out);
            let n = merge(&mut out, kept, &mut mine);
            out.truncate(n);
            self.cx.cancel.check().map(|()| out)
        };
        let chunks: Vec<Vec<Event>> = events.par_chunks(CHUNK).enumerate().map(chunk).collect::<Result<_, _>>()?;
        Ok(gather(chunks, &self.cx.cancel)?)
    }
}
