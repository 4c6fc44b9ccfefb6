//! The facets of a binary file, whose equal corners are welded by all threads, with the same result as by
//! one: a vertex for each position, in the order of the first corner there.
//!
//! ```text
//! corners    a b c   b d c   c d e        the file
//! slots      5 2 7   2 4 7   7 4 1        a table finds one slot for equal corners, and the first corner there
//! first      * * *   . * .   . . *        which a mark is put at; the vertex is the number of marks before it
//! vertices   0 1 2   1 3 2   2 3 4
//! ```

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use glam::Vec3;

use super::marks::Marks;
use super::table::{Key, Table};
use super::{FACET, key};
use crate::geometry::num;
use crate::scene::load::fill::{self, Stop};
use crate::scene::{LoadCx, Mesh, Reason};

/// Whole facets.
#[derive(Clone, Copy)]
pub(super) struct Facets<'a>(pub &'a [u8]);

/// Of a facet's bytes, what finding slots counts as; numbering is the rest.
const FINDING: usize = FACET * 3 / 5;

impl Facets<'_> {
    fn count(self) -> usize {
        self.0.len() / FACET
    }

    #[inline(always)]
    fn position(self, corner: u32) -> Vec3 {
        let (facet, corner) = (corner as usize / 3, corner as usize % 3);
        let (floats, _) = self.0[facet * FACET + (corner + 1) * 12..].as_chunks();
        let floats = floats.first_chunk::<3>().map(|floats| floats.map(f32::from_le_bytes));
        Vec3::from_array(floats.unwrap_or([f32::NAN; 3]))
    }

    #[inline(always)]
    fn key(self, corner: u32) -> Key {
        key(self.position(corner))
    }

    /// `None` if there are too many for this, or a table is filled badly.
    pub fn weld(self, cx: &LoadCx) -> Result<Option<Mesh>, Reason> {
        let corners = self.count().saturating_mul(3);
        // A surface has about one vertex for six corners, triangles without connection as many as corners.
        for slots in [corners / 3, corners.saturating_mul(3) / 2] {
            let slots = slots.saturating_add(1024);
            if slots > num::MAX_INDEX {
                break;
            }
            let mesh = self.weld_with(slots, cx)?;
            if mesh.is_some() {
                return Ok(mesh);
            }
        }
        Ok(None)
    }

    /// With a table of so many slots; `None` if they are too few.
    fn weld_with(self, slots: usize, cx: &LoadCx) -> Result<Option<Mesh>, Reason> {
        let corners = self.count() * 3;
        let mut memory = cx.budget.charge(Table::bytes(slots) + Marks::bytes(corners) + self.count() as u64 * 12)?;
        let mut table = Table::new(slots);
        let Some(mut triangles) = Stop::or_slow_road(self.slots(&table, slots / 4 * 3, cx))? else { return Ok(None) };
        let marks = Marks::of(&mut table, corners, cx)?;
        memory.grow(marks.count() as u64 * 12)?;
        let positions = marks.positions(cx, |corner| self.position(corner))?;
        fill::each_piece(&mut triangles, cx, |_, piece: &mut [[u32; 3]]| {
            piece.as_flattened_mut().iter_mut().for_each(|slot| *slot = marks.rank(table.first(*slot)));
            cx.progress.advance((piece.len() * (FACET - FINDING)) as u64);
            Ok::<_, Reason>(())
        })?;
        Ok(Some(Mesh { positions, triangles, ..Mesh::default() }))
    }

    /// The slots of the three corners of each facet, of which no more than about `most` are taken.
    fn slots(self, table: &Table, most: usize, cx: &LoadCx) -> Result<Vec<[u32; 3]>, Stop> {
        let all_taken = AtomicUsize::new(0);
        fill::try_list(self.count(), FINDING as u64, cx, |start, piece: &mut [[u32; 3]]| {
            if all_taken.load(Relaxed) > most {
                return Err(Stop::Unusual);
            }
            let mut taken = 0;
            for (corner, to) in (num::index(3 * start)..).zip(piece.as_flattened_mut()) {
                let found = table.insert(corner, self.key(corner), |other| self.key(other));
                let (slot, new) = found.ok_or(Stop::Unusual)?;
                *to = slot;
                taken += usize::from(new);
            }
            all_taken.fetch_add(taken, Relaxed);
            Ok(())
        })
    }
}
