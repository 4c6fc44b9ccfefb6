//! The facets of a binary file, whose equal corners are welded by all threads, with the same result as by
//! one: a vertex for each position, in the order of the first corner there.
//!
//! ```text
//! corners    a b c   b d c   c d e        the file
//! equals     0 1 2   1 4 2   2 4 8        a table finds an equal corner, in the end the first
//! first      * * *   . * .   . . *        which a mark is put at
//! vertices   0 1 2   1 3 2   2 3 4        the number of marks before it
//! ```

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use glam::Vec3;

use super::marks::Marks;
use super::table::{Key, Place, Table};
use super::{FACET, key};
use crate::geometry::num;
use crate::scene::load::fill::{self, Stop};
use crate::scene::{LoadCx, Mesh, Reason};

/// Whole facets.
#[derive(Clone, Copy)]
pub(super) struct Facets<'a>(pub &'a [u8]);

/// Corners that are looked for at once: those of sixteen facets.
const AHEAD: usize = 48;

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
        let Some(mut triangles) = Stop::or_slow_road(self.equals(&table, slots / 4 * 3, cx))? else { return Ok(None) };
        let marks = Marks::of(&mut table, corners, cx)?;
        memory.grow(marks.count() as u64 * 12)?;
        let positions = marks.positions(cx, |corner| self.position(corner))?;
        fill::each_piece(&mut triangles, cx, |_, piece: &mut [[u32; 3]]| {
            piece.as_flattened_mut().iter_mut().for_each(|equal| *equal = self.vertex(*equal, &marks, &table));
            cx.progress.advance((piece.len() * (FACET - FINDING)) as u64);
            Ok::<_, Reason>(())
        })?;
        Ok(Some(Mesh { positions, triangles, ..Mesh::default() }))
    }

    /// For each corner of each facet one at the same position: the first, or one that was entered before it. No
    /// more than about `most` positions.
    fn equals(self, table: &Table, most: usize, cx: &LoadCx) -> Result<Vec<[u32; 3]>, Stop> {
        let all_taken = AtomicUsize::new(0);
        fill::try_list(self.count(), FINDING as u64, cx, |start, piece: &mut [[u32; 3]]| {
            if all_taken.load(Relaxed) > most {
                return Err(Stop::Unusual);
            }
            let mut taken = 0;
            for (i, group) in piece.as_flattened_mut().chunks_mut(AHEAD).enumerate() {
                let first = num::index(3 * start + i * AHEAD);
                let mut ahead = [(Key::default(), Place::default()); AHEAD];
                for (corner, (key, place)) in (first..).zip(&mut ahead[..group.len()]) {
                    *key = self.key(corner);
                    *place = table.place(*key);
                }
                table.look(ahead[..group.len()].iter_mut().map(|(_, place)| place));
                for ((corner, equal), (key, place)) in (first..).zip(group).zip(&ahead) {
                    *equal = table.enter(corner, *key, *place, |other| self.key(other)).ok_or(Stop::Unusual)?;
                    taken += usize::from(*equal == corner);
                }
            }
            all_taken.fetch_add(taken, Relaxed);
            Ok(())
        })
    }

    /// The vertex of a corner that is equal to this one. It nearly always is the first, which is near in the
    /// file and so in the marks, while a look at the table would take long.
    #[inline(always)]
    fn vertex(self, equal: u32, marks: &Marks, table: &Table) -> u32 {
        let first = if marks.has(equal) { equal } else { table.first(self.key(equal), |other| self.key(other)) };
        marks.rank(first)
    }
}
