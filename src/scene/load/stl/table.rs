//! Which corner is the first at its position: a table that all threads fill at once, without locks.
//!
//! Open addressing with linear probing (Knuth, "The Art of Computer Programming" 3, 1973, section 6.4).
//! A slot is taken by the first who comes, and stays with that position; what changes is only which of
//! the corners there it names, and in the end that is the least: the same whoever came first.

use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

use crate::geometry::num;
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

impl Table {
    /// Bytes of a table with so many slots.
    pub const fn bytes(slots: usize) -> u64 {
        slots as u64 * 8
    }

    /// `slots` is below 2^32.
    pub fn new(slots: usize) -> Self {
        Self(zeros_in_large_pages(slots))
    }

    /// Finds or takes the slot for a corner at `key`; `key_of` tells that of the other corners. Also whether it
    /// was taken. `None` if there is no slot near where it should be.
    #[inline(always)]
    pub fn insert(&self, corner: u32, key: Key, key_of: impl Fn(u32) -> Key) -> Option<(u32, bool)> {
        let (mut at, tag) = place(key, self.0.len());
        let mine = u64::from(!corner) << 32 | u64::from(tag);
        for _ in 0..MOST_PROBES {
            let slot = self.0.get(at)?;
            let mut seen = slot.load(Relaxed);
            if seen == 0 {
                match slot.compare_exchange(0, mine, Relaxed, Relaxed) {
                    Ok(_) => return Some((num::index(at), true)),
                    Err(other) => seen = other,
                }
            }
            if low(seen) == tag && key_of(corner_in(seen)) == key {
                if seen < mine {
                    slot.fetch_max(mine, Relaxed);
                }
                return Some((num::index(at), false));
            }
            at = if at + 1 == self.0.len() { 0 } else { at + 1 };
        }
        None
    }

    /// The first corner at the position of a slot.
    #[inline(always)]
    pub fn first(&self, slot: u32) -> u32 {
        corner_in(self.0[slot as usize].load(Relaxed))
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
