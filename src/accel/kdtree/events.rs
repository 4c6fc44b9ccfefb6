//! Where the boxes of triangles begin and end along an axis, in order: what the exact search for a
//! plane sweeps over (Wald and Havran 2006, §4.2).
//!
//! An event is one 64-bit number, so that comparing two is one comparison:
//!
//! ```text
//!   63 … 32: position, its bits made to sort as it does   31, 30: kind   29 … 0: the reference
//! ```

use crate::geometry::Aabb;

/// The most references a cell may have.
pub const MAX_REFS: usize = 1 << 30;

const INDEX: u64 = (1 << 30) - 1;
const KIND: u32 = 30;

/// What happens at an event. At one position what ends comes before what begins.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// A box ends.
    End = 0,
    /// A box lies in the plane: it begins and ends.
    Planar = 1,
    /// A box begins.
    Start = 2,
}

/// A place where a triangle's box begins or ends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Event(u64);

/// The events of a cell along each axis, sorted.
pub type Lists = [Vec<Event>; 3];

impl Event {
    /// An event of the cell's reference of that index, which is below [`MAX_REFS`].
    #[inline(always)]
    pub fn new(pos: f32, kind: Kind, index: u32) -> Self {
        // Adding zero makes both zeros the same place.
        Self(u64::from(sortable((pos + 0.0).to_bits())) << 32 | u64::from(kind as u8) << KIND | u64::from(index))
    }

    /// Where it is.
    #[inline(always)]
    pub fn pos(self) -> f32 {
        f32::from_bits(unsortable(high(self.0)))
    }

    /// Whether a box begins here, or lies here.
    #[inline(always)]
    pub const fn begins(self) -> bool {
        self.0 >> KIND & 3 != Kind::End as u64
    }

    /// Whether a box ends here, or lies here.
    #[inline(always)]
    pub const fn ends(self) -> bool {
        self.0 >> KIND & 3 != Kind::Start as u64
    }

    /// Which reference's.
    #[inline(always)]
    pub const fn index(self) -> usize {
        (self.0 & INDEX) as usize
    }

    /// The same event of a reference that got another index.
    #[inline(always)]
    pub const fn renamed(self, index: u32) -> Self {
        Self(self.0 & !INDEX | index as u64 & INDEX)
    }
}

/// Appends the events of a box.
#[inline(always)]
pub fn append(lists: &mut Lists, bounds: &Aabb, index: u32) {
    for (k, list) in lists.iter_mut().enumerate() {
        let (min, max) = (bounds.min[k], bounds.max[k]);
        if min == max {
            list.push(Event::new(min, Kind::Planar, index));
        } else {
            list.push(Event::new(min, Kind::Start, index));
            list.push(Event::new(max, Kind::End, index));
        }
    }
}

/// Bits of a float as an integer of the same order: negative ones turned around, below the others.
#[inline(always)]
const fn sortable(bits: u32) -> u32 {
    bits ^ (((bits >> 31).wrapping_neg()) | 1 << 31)
}

#[inline(always)]
const fn unsortable(bits: u32) -> u32 {
    bits ^ (((bits >> 31).wrapping_sub(1)) | 1 << 31)
}

#[inline(always)]
const fn high(bits: u64) -> u32 {
    let [.., a, b, c, d] = bits.to_le_bytes();
    u32::from_le_bytes([a, b, c, d])
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn events_sort_by_place_then_kind_and_give_back_what_they_hold() {
        let places = [f32::MIN, -1.5, -1e-40, 0.0, 1e-40, 0.25, 0.25f32.next_up(), 7e30];
        let kinds = [Kind::End, Kind::Planar, Kind::Start];
        let events: Vec<Event> =
            places.iter().flat_map(|p| kinds.iter().map(|k| Event::new(*p, *k, 5)).collect::<Vec<_>>()).collect();
        assert!(events.is_sorted_by(|a, b| a < b));
        for (i, event) in events.iter().enumerate() {
            assert_eq!((event.pos(), event.index(), event.renamed(9).index()), (places[i / 3], 5, 9));
            assert_eq!((event.ends(), event.begins()), (i % 3 < 2, i % 3 > 0));
        }
        assert_eq!(Event::new(-0.0, Kind::End, 1), Event::new(0.0, Kind::End, 1));
    }

    #[test]
    fn a_flat_box_has_one_event_on_its_axis() {
        let mut lists = Lists::default();
        append(&mut lists, &Aabb { min: Vec3::new(0.0, 0.5, 0.0), max: Vec3::new(1.0, 0.5, 1.0) }, 3);
        assert_eq!(lists.map(|list| list.len()), [2, 1, 2]);
    }
}
