//! Which triangles a ray was tested against lately, so that one in several cells is not tested again.
//!
//! Mailboxes at the triangles (Amanatides and Woo 1987) are written by every ray, which threads
//! cannot share. The inverse mailbox (Shevtsov, Soupikov and Kapustin 2007, "Ray-Triangle
//! Intersection Algorithm for Modern CPU Architectures") is the ray's own: the last few triangles,
//! in a ring. It forgets, so some tests are repeated; none is left out.

use crate::scene::PrimRef;

/// How many triangles are remembered: one comparison of a vector of 256 bits.
const SIZE: usize = 8;

/// The last triangles of one ray.
#[derive(Clone, Copy, Debug)]
pub struct Mailbox {
    last: [PrimRef; SIZE],
    next: usize,
}

impl Mailbox {
    /// Nothing was tested yet.
    pub const fn new() -> Self {
        Self { last: [PrimRef::MAX; SIZE], next: 0 }
    }

    /// Whether the triangle was tested lately; if not, it counts as tested from now on.
    #[inline(always)]
    pub fn holds_or_takes(&mut self, prim: PrimRef) -> bool {
        // All are compared: no branch for each.
        let holds = self.last.iter().fold(false, |found, last| found | (*last == prim));
        if !holds {
            self.last[self.next] = prim;
            self.next = (self.next + 1) % SIZE;
        }
        holds
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_last_eight_are_remembered() {
        let mut mailbox = Mailbox::new();
        assert!((0..8).all(|prim| !mailbox.holds_or_takes(prim)));
        assert!((0..8).all(|prim| mailbox.holds_or_takes(prim)));
        assert!(!mailbox.holds_or_takes(8) && !mailbox.holds_or_takes(0) && mailbox.holds_or_takes(8));
    }
}
