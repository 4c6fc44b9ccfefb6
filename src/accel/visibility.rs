//! Which triangles of a scene are seen: all but those that cells were asked to hide.
//!
//! What was flattened has a bit for each triangle. A mesh that stands in several places has none as long as each place is
//! seen, or hidden, as a whole: bits for every triangle of every place would be as large as the flattened scene. Only a place
//! of which a part is hidden has bits of its own.

mod written;

pub use written::Written;

use std::collections::HashMap;
use std::ops::ControlFlow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Weak};

use super::cell::{Cell, Descend, walk_below};
use super::{Accel, Filter, Hit};
use crate::scene::{Geometry, Placed};
use crate::task::{Budget, Cancel, Cancelled, Charge, OverBudget};

/// Tells sets apart.
static NUMBER: AtomicU64 = AtomicU64::new(1);
/// Cells, or triangles, looked at between two looks at the cancel flag.
const PER_CHECK: usize = 1 << 14;
/// About what a place takes in the table of places.
const PLACE_BYTES: u64 = 64;

/// Which triangles of a scene are hidden. Two are equal if they are the same one.
pub struct Visibility {
    number: u64,
    geometry: Weak<Geometry>,
    hidden: Triangles,
    count: u64,
    _charge: Charge,
}

/// What becomes of the triangles of a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// They alone are seen.
    Isolate,
    /// They are hidden, besides what is hidden already.
    Hide,
}

/// Why triangles can't be hidden.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum VisibilityError {
    /// The cell is empty.
    #[error("the cell holds no triangles")]
    Empty,
    /// The set does not fit.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// It was stopped.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
    /// They were written down of another scene.
    #[error("they were hidden in a model of {of} triangles, and this one has {has}")]
    OfAnother {
        /// Triangles of that scene.
        of: u64,
        /// Triangles of this one.
        has: u64,
    },
    /// What was written down is not whole.
    #[error("the list of them is damaged")]
    Damaged,
}

/// Numbers, a bit for each.
#[derive(Clone, Debug, Default)]
struct Bits(Vec<u64>);

impl Bits {
    fn of(count: usize) -> Self {
        Self(vec![0; count.div_ceil(64)])
    }

    #[inline]
    fn has(&self, i: u32) -> bool {
        self.0.get(i as usize / 64).is_some_and(|word| word >> (i % 64) & 1 == 1)
    }

    fn set(&mut self, i: u32) {
        if let Some(word) = self.0.get_mut(i as usize / 64) {
            *word |= 1 << (i % 64);
        }
    }

    fn add(&mut self, other: &Self, cancel: &Cancel) -> Result<(), Cancelled> {
        for (words, more) in self.0.chunks_mut(PER_CHECK).zip(other.0.chunks(PER_CHECK)) {
            cancel.check()?;
            words.iter_mut().zip(more).for_each(|(word, more)| *word |= more);
        }
        Ok(())
    }

    fn count(&self, cancel: &Cancel) -> Result<u64, Cancelled> {
        let count = |words: &[u64]| {
            let set = words.iter().map(|word| u64::from(word.count_ones())).sum::<u64>();
            cancel.check().map(|()| set)
        };
        self.0.chunks(PER_CHECK).map(count).sum()
    }
}

/// Triangles of a place.
#[derive(Clone, Debug)]
enum OfPlace {
    All,
    Some(Bits),
}

/// Triangles of a scene.
#[derive(Clone, Debug, Default)]
struct Triangles {
    flat: Bits,
    /// By instance, of meshes that stand in several places.
    places: HashMap<u32, OfPlace>,
}

impl Visibility {
    /// Hides the triangles of a cell and of those below it, or all others: every triangle that one of them holds, also where
    /// another cell holds it, too. `before` is hidden already.
    ///
    /// # Errors
    /// The cell is empty, the budget has no room, or it was asked to stop: within 100 ms of the request.
    pub fn change(
        before: Option<&Self>,
        accel: &dyn Accel,
        (cell, change): (&Cell, Change),
        budget: &Budget,
        cancel: &Cancel,
    ) -> Result<Self, VisibilityError> {
        let geometry = accel.geometry();
        let before = before.filter(|before| before.is_of(geometry));
        let mut charge = budget.charge(bytes(geometry))?;
        let held = Triangles::below(accel, cell, cancel)?;
        if held.count(geometry, cancel)? == 0 {
            return Err(VisibilityError::Empty);
        }
        let hidden = match change {
            Change::Isolate => {
                // Those of the cell are there until all others are found.
                let _meanwhile = budget.charge(bytes(geometry))?;
                held.others(geometry, cancel)?
            }
            Change::Hide => {
                charge.grow(before.map_or(0, |before| before.hidden.bytes()))?;
                held.with(before.map(|before| &before.hidden), cancel)?
            }
        };
        Ok(Self {
            number: NUMBER.fetch_add(1, Ordering::Relaxed),
            geometry: Arc::downgrade(geometry),
            count: hidden.count(geometry, cancel)?,
            hidden,
            _charge: charge,
        })
    }

    /// Tells it from every other.
    pub const fn number(&self) -> u64 {
        self.number
    }

    /// How many triangles are hidden, each counted as often as it stands somewhere.
    pub const fn count(&self) -> u64 {
        self.count
    }

    /// Whether it is of that geometry: of another one it would say nothing.
    pub fn is_of(&self, geometry: &Arc<Geometry>) -> bool {
        std::ptr::eq(self.geometry.as_ptr(), Arc::as_ptr(geometry))
    }

    /// Whether a triangle of an instance is seen.
    #[inline]
    pub fn sees(&self, geometry: &Geometry, instance: u32, primitive: u32) -> bool {
        let hidden = match geometry.flat(instance, primitive) {
            Some(prim) => self.hidden.flat.has(prim),
            None => match self.hidden.places.get(&instance) {
                None => false,
                Some(OfPlace::All) => true,
                Some(OfPlace::Some(bits)) => bits.has(primitive),
            },
        };
        !hidden
    }

    /// Counts hits only on what is seen.
    pub const fn filter<'a>(&'a self, geometry: &'a Geometry) -> Seen<'a> {
        Seen { visibility: self, geometry }
    }
}

impl PartialEq for Visibility {
    fn eq(&self, other: &Self) -> bool {
        self.number == other.number
    }
}

impl std::fmt::Debug for Visibility {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Visibility").field("number", &self.number).field("count", &self.count).finish_non_exhaustive()
    }
}

/// Counts hits only on what is seen.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    visibility: &'a Visibility,
    geometry: &'a Geometry,
}

impl Filter for Seen<'_> {
    #[inline]
    fn accepts(&self, hit: &Hit) -> bool {
        self.visibility.sees(self.geometry, hit.instance, hit.primitive)
    }
}

/// The most that a set takes in which one place has bits of its own.
fn bytes(geometry: &Geometry) -> u64 {
    let (parts, places) = geometry.placed().map_or((&[][..], &[][..]), |placed| (placed.parts(), placed.places()));
    let largest = parts.iter().map(|part| part.triangle_count()).max().unwrap_or(0);
    (geometry.triangle_count() / 8 + largest / 8 + 16) as u64 + places.len() as u64 * PLACE_BYTES
}

/// How many triangles structures hold of what stands in a place.
fn live_in(placed: Option<&Placed>, instance: u32) -> Option<&Arc<Geometry>> {
    let placed = placed?;
    placed.parts().get(placed.of_instance(instance)?.part as usize)
}

impl Triangles {
    /// Those of a cell and of all below it.
    fn below(accel: &dyn Accel, top: &Cell, cancel: &Cancel) -> Result<Self, Cancelled> {
        let geometry = accel.geometry();
        let mut held = Self { flat: Bits::of(geometry.triangle_count()), places: HashMap::new() };
        let (mut looked, mut stopped) = (0usize, Ok(()));
        walk_below(accel, *top, &mut |cell| {
            looked += 1;
            if looked.is_multiple_of(PER_CHECK) {
                stopped = cancel.check();
            }
            if stopped.is_err() {
                return ControlFlow::Break(());
            }
            let level = accel.level(cell.id.instance).map(|level| level.instance);
            // What is met below a cell of the upper level is held as a whole.
            if let (Some(instance), 0) = (level, top.id.instance) {
                held.add_all(geometry, instance);
                return ControlFlow::Continue(Descend::No);
            }
            if cell.is_leaf() {
                let bits = held.bits(geometry, level.flatten());
                accel.prims(cell, &mut |prim| bits.set(prim));
            }
            ControlFlow::Continue(Descend::Yes)
        });
        stopped.map(|()| held)
    }

    /// The bits of a place, or of what was flattened.
    fn bits(&mut self, geometry: &Geometry, instance: Option<u32>) -> &mut Bits {
        let Some(instance) = instance else { return &mut self.flat };
        let count = live_in(geometry.placed(), instance).map_or(0, |part| part.triangle_count());
        let none = || OfPlace::Some(Bits::of(count));
        let of_place = self.places.entry(instance).or_insert_with(none);
        match of_place {
            OfPlace::Some(bits) => bits,
            // Nothing is added to all.
            OfPlace::All => &mut self.flat,
        }
    }

    /// Adds a place as a whole, or all that was flattened.
    fn add_all(&mut self, geometry: &Geometry, instance: Option<u32>) {
        match instance {
            Some(instance) => drop(self.places.insert(instance, OfPlace::All)),
            None => (0..geometry.live_count()).for_each(|i| self.flat.set(geometry.live(i))),
        }
    }

    /// Those of a scene that are not among these.
    fn others(&self, geometry: &Geometry, cancel: &Cancel) -> Result<Self, Cancelled> {
        let flat = not_in(&self.flat, geometry, cancel)?;
        let mut others = Self { flat, places: HashMap::new() };
        for (i, place) in geometry.placed().map_or(&[][..], Placed::places).iter().enumerate() {
            if i.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            let of_place = match (self.places.get(&place.instance), live_in(geometry.placed(), place.instance)) {
                (Some(OfPlace::All), _) => continue,
                (Some(OfPlace::Some(bits)), Some(part)) => OfPlace::Some(not_in(bits, part, cancel)?),
                _ => OfPlace::All,
            };
            others.places.insert(place.instance, of_place);
        }
        Ok(others)
    }

    /// These and others.
    fn with(mut self, others: Option<&Self>, cancel: &Cancel) -> Result<Self, Cancelled> {
        let Some(others) = others else { return Ok(self) };
        self.flat.add(&others.flat, cancel)?;
        for (i, (instance, more)) in others.places.iter().enumerate() {
            if i.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            match (self.places.get_mut(instance), more) {
                (Some(OfPlace::All), _) => {}
                (Some(OfPlace::Some(bits)), OfPlace::Some(more)) => bits.add(more, cancel)?,
                (Some(of_place), OfPlace::All) => *of_place = OfPlace::All,
                (None, more) => drop(self.places.insert(*instance, more.clone())),
            }
        }
        Ok(self)
    }

    fn count(&self, geometry: &Geometry, cancel: &Cancel) -> Result<u64, Cancelled> {
        let mut count = self.flat.count(cancel)?;
        for (i, (instance, of_place)) in self.places.iter().enumerate() {
            if i.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            count += match of_place {
                OfPlace::Some(bits) => bits.count(cancel)?,
                OfPlace::All => live_in(geometry.placed(), *instance).map_or(0, |part| part.live_count() as u64),
            };
        }
        Ok(count)
    }

    fn bytes(&self) -> u64 {
        let of_place = |of_place: &OfPlace| match of_place {
            OfPlace::Some(bits) => size_of_val(&bits.0[..]) as u64,
            OfPlace::All => 0,
        };
        self.places.values().map(of_place).sum()
    }
}

/// The triangles that structures hold of a geometry and that are not among some.
fn not_in(some: &Bits, geometry: &Geometry, cancel: &Cancel) -> Result<Bits, Cancelled> {
    let mut others = Bits::of(geometry.triangle_count());
    for i in 0..geometry.live_count() {
        if i.is_multiple_of(PER_CHECK) {
            cancel.check()?;
        }
        let prim = geometry.live(i);
        if !some.has(prim) {
            others.set(prim);
        }
    }
    Ok(others)
}
