//! Nodes that reinsertion moved, round by round, in each round by gain. A finished tree does not say what was moved: it is built
//! once more, and looked at while that happens.

use std::sync::Arc;

use super::{FilmError, MOST, Seen, Subject, counted};
use crate::accel::outline::Outline;
use crate::accel::stats::SahWeights;
use crate::accel::{Accel, BuildCx, Recorded, Round, record_reinsertion};
use crate::geometry::num;
use crate::lab::format;
use crate::task::Charge;

/// Of the whole film, moves that are told one by one are at most this share, so that splits can be, too.
const SHARE: usize = 2;
/// The most moves of a round that are shown, where a round is one event.
const SHOWN: usize = 32;

/// Costs of one tree, summed up in two ways, differ by no larger share.
const SAME: f64 = 1e-5;

/// One event.
struct Event {
    /// The round it is in, or which it is.
    round: u32,
    /// The first of the round's moves that it shows, and how many.
    first: usize,
    shown: usize,
}

/// The moves, and at last the choice of leaves.
pub struct Moves {
    before: Box<dyn Accel>,
    finished: Arc<Outline>,
    rounds: Vec<Round>,
    events: Vec<Event>,
    /// Whether an event is a move, and not a round.
    one_by_one: bool,
    /// What nodes hold, called one: references where a triangle may be in several.
    held: &'static str,
    /// Leaves of the finished structure.
    leaves: u64,
    /// The SAH cost after each event, that of the finished structure last.
    costs: Vec<f64>,
    _charge: Charge,
}

impl Moves {
    /// Watches the tree being built, and lists the cells that it has before; nothing if nothing was moved.
    pub fn of(subject: &Subject<'_>, finished: Arc<Outline>, cx: &BuildCx) -> Result<Option<(Self, Arc<Outline>)>, FilmError> {
        let recorded = record_reinsertion(subject.accel.geometry(), subject.params, MOST / SHARE, cx)?;
        let Some(Recorded { before, mut rounds, sah }) = recorded else { return Ok(None) };
        if (sah - finished.sah()).abs() > SAME * sah {
            return Err(FilmError::Another);
        }
        if rounds.is_empty() {
            return Ok(None);
        }
        let weights = SahWeights::of(subject.params);
        let outline = Outline::of(before.as_ref(), weights, (&cx.budget, &cx.cancel, &cx.progress))?;
        let one_by_one = rounds.iter().map(|round| round.made as usize).sum::<usize>() <= MOST / SHARE;
        if !one_by_one {
            rounds.iter_mut().for_each(|round| round.moves = round.moves[..round.moves.len().min(SHOWN)].to_vec());
        }
        let events: Vec<Event> = rounds.iter().zip(0..).flat_map(|(round, i)| events(round, i, one_by_one)).collect();
        let once = u64::from(outline.row(0).references) == subject.accel.geometry().counts().live;
        let held = if once { "triangle" } else { "reference" };
        let leaves = (0..finished.len()).filter(|row| finished.below(*row).is_empty()).count() as u64;
        let kept: usize = rounds.iter().map(|round| size_of_val(&round.moves[..])).sum();
        let charge = cx.budget.charge((kept + events.len() * (size_of::<Event>() + size_of::<f64>())) as u64)?;
        let costs = Vec::new();
        let mut moves = Self { before, finished, rounds, events, one_by_one, held, leaves, costs, _charge: charge };
        moves.fill_costs(outline.sah(), weights.c_trav);
        Ok(Some((moves, Arc::new(outline))))
    }

    /// An area that is saved is a node that is entered less often; leaves stay as they are until they are chosen.
    fn fill_costs(&mut self, mut cost: f64, c_trav: f64) {
        let whole = self.before.root().shape.bounds().area();
        let per_area = if whole > 0.0 { c_trav / whole } else { 0.0 };
        for event in &self.events {
            let round = &self.rounds[event.round as usize];
            cost -= per_area * if self.one_by_one { round.moves[event.first].gain } else { round.gain };
            self.costs.push(cost);
        }
        self.costs.push(self.finished.sah());
    }

    /// The tree before any of them, with one triangle in a leaf.
    pub fn before(&self) -> &dyn Accel {
        self.before.as_ref()
    }

    /// The last of their positions, from 1.
    pub fn last(&self) -> u32 {
        num::index(self.costs.len())
    }

    /// The SAH cost after each event.
    pub fn costs(&self) -> &[f64] {
        &self.costs
    }

    /// What is to be seen after an event, from 0.
    pub fn seen(&self, event: u32) -> Seen<'_> {
        match self.events.get(event as usize) {
            Some(Event { round, first, shown }) => {
                let moves = &self.rounds[*round as usize].moves;
                Seen::Moves(&moves[*first..first + shown], &self.finished)
            }
            None => Seen::Finished(&self.finished),
        }
    }

    /// What an event was, without an end.
    pub fn tell(&self, event: u32) -> String {
        let Some(Event { round, first, .. }) = self.events.get(event as usize) else {
            let (n, leaves) = (format::count(self.leaves), if self.leaves == 1 { "leaf" } else { "leaves" });
            return format!("{n} {leaves} chosen by their cost: the finished structure");
        };
        let [number, last] = [event as usize + 1, self.events.len()].map(|n| format::count(n as u64));
        let (in_round, round) = (round + 1, &self.rounds[*round as usize]);
        if self.one_by_one {
            let held = counted(round.moves[*first].references.into(), self.held);
            format!("Reinsertion {number} of {last}, in round {in_round}: {held} moved to where they cost less")
        } else {
            format!("Round {number} of {last} of reinsertion: {}", counted(round.made.into(), "move"))
        }
    }
}

/// The events of a round.
fn events(round: &Round, number: u32, one_by_one: bool) -> Vec<Event> {
    if one_by_one {
        return (0..round.moves.len()).map(|first| Event { round: number, first, shown: 1 }).collect();
    }
    vec![Event { round: number, first: 0, shown: round.moves.len().min(SHOWN) }]
}
