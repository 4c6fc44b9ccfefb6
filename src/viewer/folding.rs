//! Which rows of a tree are open, so that the row at any height is found at once: of ten million rows those that are hidden
//! lie in few stretches, one for each closed node.

use crate::accel::outline::Outline;

/// Rows that are hidden below closed nodes.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folding {
    /// Stretches of hidden rows, the first and how many, in order.
    hidden: Vec<(u32, u32)>,
    /// How many are hidden in all stretches before each, and in all.
    before: Vec<u32>,
    rows: u32,
}

impl Folding {
    /// Everything below the root is hidden.
    pub fn closed(outline: &Outline) -> Self {
        let mut folding = Self { rows: outline.len(), ..Self::default() };
        folding.hidden.extend(Some((1, outline.len().saturating_sub(1))).filter(|(_, n)| *n > 0));
        folding.count();
        folding
    }

    /// Rows that are to be seen.
    pub fn visible(&self) -> u32 {
        self.rows - self.before.last().copied().unwrap_or(0)
    }

    /// The row at a height, from 0.
    pub fn row_at(&self, height: u32) -> u32 {
        // The height of what follows a stretch never falls from one to the next.
        let (mut low, mut high) = (0, self.hidden.len());
        while low < high {
            let middle = low.midpoint(high);
            if self.hidden[middle].0 - self.before[middle] <= height { low = middle + 1 } else { high = middle }
        }
        height + self.before[low]
    }

    /// The height of a row, if it is to be seen.
    pub fn height_of(&self, row: u32) -> Option<u32> {
        let after = self.hidden.partition_point(|(first, _)| *first <= row);
        let inside = after.checked_sub(1).map(|i| self.hidden[i]).is_some_and(|(first, n)| row - first < n);
        (!inside).then(|| row - self.before[after])
    }

    /// Whether a row that is to be seen shows what is below it.
    pub fn is_open(&self, row: u32) -> bool {
        self.hidden.binary_search_by_key(&(row + 1), |(first, _)| *first).is_err()
    }

    /// Shows the children of a row.
    pub fn open(&mut self, row: u32, outline: &Outline) {
        let Ok(at) = self.hidden.binary_search_by_key(&(row + 1), |(first, _)| *first) else { return };
        let below = outline.children(row).map(|child| (child + 1, outline.behind(child) - child - 1)).filter(|(_, n)| *n > 0);
        self.hidden.splice(at..=at, below);
        self.count();
    }

    /// Shows everything below a row.
    pub fn open_all(&mut self, row: u32, outline: &Outline) {
        self.drop_inside(row, outline);
        self.count();
    }

    /// Hides everything below a row.
    pub fn close(&mut self, row: u32, outline: &Outline) {
        let below = outline.behind(row) - row - 1;
        if below == 0 {
            return;
        }
        let at = self.drop_inside(row, outline);
        self.hidden.insert(at, (row + 1, below));
        self.count();
    }

    /// Opens what is above a row, so that it is to be seen.
    pub fn reveal(&mut self, row: u32, outline: &Outline) {
        for above in outline.path(row) {
            if above != row {
                self.open(above, outline);
            }
        }
    }

    /// Takes out the stretches below a row, and says where they were.
    fn drop_inside(&mut self, row: u32, outline: &Outline) -> usize {
        let range = outline.below(row);
        let from = self.hidden.partition_point(|(first, _)| *first < range.start);
        let to = self.hidden.partition_point(|(first, _)| *first < range.end);
        self.hidden.drain(from..to);
        from
    }

    fn count(&mut self) {
        self.before.clear();
        let mut sum = 0;
        for (_, n) in &self.hidden {
            self.before.push(sum);
            sum += n;
        }
        self.before.push(sum);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::stats::SahWeights;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::scene::{Geometry, LoadCx, open};
    use std::collections::BTreeSet;
    use std::sync::Arc;

    fn outline() -> Outline {
        let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
        let scene = open("builtin:soup?triangles=500", &load).expect("built in");
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let entry = registry::find("bvh").expect("registered");
        let accel = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds");
        Outline::of(accel.as_ref(), SahWeights::default(), (&cx.budget, &cx.cancel, &cx.progress)).expect("small")
    }

    /// The same by a set of open rows, looked through from the root.
    fn seen(outline: &Outline, open: &BTreeSet<u32>) -> Vec<u32> {
        (0..outline.len()).filter(|row| outline.path(*row).iter().all(|above| above == row || open.contains(above))).collect()
    }

    #[test]
    fn rows_are_where_a_walk_through_what_is_open_finds_them() {
        let outline = outline();
        let mut folding = Folding::closed(&outline);
        let mut open = BTreeSet::new();
        let mut x = 1u32;
        for step in 0..400 {
            x = x.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let rows = seen(&outline, &open);
            let row = rows[(x >> 8) as usize % rows.len()];
            let below = outline.below(row);
            match step % 8 {
                7 => {
                    folding.close(row, &outline);
                    open.retain(|o| *o != row && !below.contains(o));
                }
                6 if step % 5 == 0 => {
                    folding.open_all(row, &outline);
                    open.insert(row);
                    open.extend(below);
                }
                5 => {
                    let hidden = (x >> 4) % outline.len();
                    folding.reveal(hidden, &outline);
                    let path = outline.path(hidden);
                    open.extend(&path[..path.len() - 1]);
                }
                _ => {
                    folding.open(row, &outline);
                    open.insert(row);
                }
            }
            let rows = seen(&outline, &open);
            assert_eq!(folding.visible() as usize, rows.len(), "step {step}");
            for (height, row) in (0u32..).zip(&rows) {
                assert_eq!((folding.row_at(height), folding.height_of(*row)), (*row, Some(height)), "step {step}");
                assert_eq!(folding.is_open(*row), open.contains(row) || outline.row(*row).is_leaf(), "step {step}");
            }
            let hidden = (0..outline.len()).filter(|row| folding.height_of(*row).is_none()).count();
            assert_eq!(hidden, outline.len() as usize - rows.len());
        }
    }
}
