//! Which corner is the first at its position: a table that all threads fill at once, without locks.
//!
//! Open addressing with linear probing (Knuth, "The Art of Computer Programming" 3, 1973, section 6.4).
//! A slot is taken by the first who comes, and stays with that position; what changes is only which of
//! the corners there it names, and in the end that is the least: the same whoever came first.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::scene::LoadCx;
use crate::scene::load::fill;
use crate::sys::zeros_in_large_pages;
use crate::task::Cancelled;

/// The bits of a position, those of -0 as of 0.
pub(super) type Key = [u32; 3];

/// Slots that a search looks at; more means that the table is too full, or the file made to fill it badly.
const MOST_PROBES: usize = 1 << 9;

/// The corner in the high half, as what it lacks to `u32::MAX`, so that zero is free and the least corner is
/// the greatest number; in the low half some of the position's hash, so that others are passed over
/// without a look at the file.
pub(super) struct Table(Vec<AtomicU64>);

/// Where the search for a position begins, and what was there.
#[derive(Clone, Copy, Default)]
pub(super) struct Place {
    at: usize,
    tag: u32,
    seen: u64,
}

impl Table {
    /// Bytes of a table with so many slots.
    pub const fn bytes(slots: usize) -> u64 {
        slots as u64 * 8
    }

    /// `slots` is below 2^32.
    pub fn new(slots: usize) -> Self {
        Self(zeros_in_large_pages(slots))
    }

    /// Where to look for a position.
    #[inline(always)]
    pub fn place(&self, key: Key) -> Place {
        let (at, tag) = place(key, self.0.len());
        Place { at, tag, seen: 0 }
    }

    /// Looks at places. Where many are looked at with nothing in between, the memory answers all at once.
    #[inline(always)]
    pub fn look<'a>(&self, places: impl Iterator<Item = &'a mut Place>) {
        places.for_each(|place| place.seen = self.0[place.at].load(Relaxed));
    }

    /// Enters a corner. Returns a corner at its position, which the slot named a moment ago: itself if the slot
    /// was free. The place need not have been looked at. `None` if there is no slot near where it should be. `key_of` tells what others are at.
    #[inline(always)]
    pub fn enter(&self, corner: u32, key: Key, place: Place, key_of: impl Fn(u32) -> Key) -> Option<u32> {
        let Place { mut at, tag, mut seen } = place;
        let mine = u64::from(!corner) << 32 | u64::from(tag);
        for _ in 0..MOST_PROBES {
            if seen == 0 {
                match self.0[at].compare_exchange(0, mine, Relaxed, Relaxed) {
                    Ok(_) => return Some(corner),
                    Err(other) => seen = other,
                }
            }
            if low(seen) == tag && key_of(corner_in(seen)) == key {
                if seen < mine {
                    self.0[at].fetch_max(mine, Relaxed);
                }
                return Some(corner_in(seen));
            }
            at = self.after(at);
            seen = self.0[at].load(Relaxed);
        }
        None
    }

    /// The first corner at a position that was entered.
    pub fn first(&self, key: Key, key_of: impl Fn(u32) -> Key) -> u32 {
        let Place { mut at, tag, .. } = self.place(key);
        let mut seen = self.0[at].load(Relaxed);
        let mut probes = 0..MOST_PROBES;
        while probes.next().is_some() && !(low(seen) == tag && seen != 0 && key_of(corner_in(seen)) == key) {
            at = self.after(at);
            seen = self.0[at].load(Relaxed);
        }
        corner_in(seen)
    }

    #[inline(always)]
    fn after(&self, at: usize) -> usize {
        if at + 1 == self.0.len() { 0 } else { at + 1 }
    }

    /// Tells the first corner of every slot that is taken, in no order.
    pub fn each_first(&mut self, cx: &LoadCx, tell: impl Fn(u32) + Sync) -> Result<(), Cancelled> {
        fill::each_piece(&mut self.0, cx, |_, piece| {
            piece.iter_mut().map(|slot| *slot.get_mut()).filter(|seen| *seen != 0).for_each(|seen| tell(corner_in(seen)));
            Ok(())
        })
    }
}

#[inline(always)]
fn corner_in(seen: u64) -> u32 {
    !low(seen >> 32)
}

/// The low half.
#[inline(always)]
const fn low(x: u64) -> u32 {
    (x & 0xFFFF_FFFF) as u32
}

/// Where the search for a position begins, and bits to tell it from others: a multiplicative hash (Knuth,
/// as above), twice, because a grid's coordinates differ in few bits.
#[inline(always)]
fn place([x, y, z]: Key, slots: usize) -> (usize, u32) {
    let a = (u64::from(x) | u64::from(y) << 32).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    let b = (a ^ a >> 32 ^ u64::from(z)).wrapping_mul(0xD6E8_FEB8_6659_FD93);
    let at = (u64::from(low(b >> 32)) * slots as u64) >> 32;
    (usize::try_from(at).unwrap_or(0), low(b ^ b >> 29))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_least_corner_is_the_first_whoever_came_first() {
        let key_of = |corner: u32| [corner % 100, 1, 2];
        let mut table = Table::new(150);
        for corner in (0..1000).rev() {
            let key = key_of(corner);
            let equal = table.enter(corner, key, table.place(key), key_of).expect("there is room");
            assert!(equal % 100 == corner % 100 && (equal == corner) == (corner >= 900));
        }
        assert!((0..1000).all(|corner| table.first(key_of(corner), key_of) == corner % 100));
        let told = std::sync::Mutex::new(Vec::new());
        table.each_first(&LoadCx::unattended(), |corner| told.lock().expect("no panic").push(corner)).expect("nobody cancels");
        let mut told = told.into_inner().expect("no panic");
        told.sort_unstable();
        assert_eq!(told, Vec::from_iter(0..100));
    }

    #[test]
    fn a_full_table_says_so() {
        let table = Table::new(10);
        let enter = |corner: u32| table.enter(corner, [corner; 3], table.place([corner; 3]), |other| [other; 3]);
        assert!((0..10).all(|corner| enter(corner) == Some(corner)));
        assert_eq!((enter(10), enter(3)), (None, Some(3)));
    }
}
