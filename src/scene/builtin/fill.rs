//! Making long lists: asked of the budget first, in parallel, with a look at the cancel flag every
//! few milliseconds. An element depends on its index alone, so the threads leave no trace in it.

use crate::scene::{Instance, LoadCx, Reason};
use crate::task::{Cancelled, Charge};
use glam::{Vec3, Vec4};
use rayon::prelude::*;

/// How much a scene will hold.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Sizes {
    pub vertices: usize,
    pub triangles: usize,
    /// Vertices with a normal.
    pub normals: usize,
    /// Vertices with a colour.
    pub colors: usize,
    pub instances: usize,
}

impl Sizes {
    /// Charges the memory of the lists and starts to report how many bytes of them are made. The
    /// charge is for the time of making; who then keeps the scene charges for it.
    pub fn begin(self, cx: &LoadCx) -> Result<Charge, Reason> {
        let sizes: [(usize, usize); 4] = [
            (self.vertices + self.normals, size_of::<Vec3>()),
            (self.triangles, size_of::<[u32; 3]>()),
            (self.colors, size_of::<Vec4>()),
            (self.instances, size_of::<Instance>()),
        ];
        let bytes = sizes.iter().map(|(n, each)| (n * each) as u64).sum();
        let charge = cx.budget.charge(bytes)?;
        cx.progress.start("generate", bytes);
        Ok(charge)
    }
}

/// Elements between two looks at the cancel flag: the slowest take a quarter of a microsecond.
const BLOCK: usize = 1 << 16;

/// The list of `make(0)`, `make(1)` to `make(n - 1)`.
pub(super) fn fill<T: Send>(n: usize, cx: &LoadCx, make: impl Fn(usize) -> T + Sync) -> Result<Vec<T>, Cancelled> {
    let mut list = Vec::with_capacity(n);
    extend(&mut list, n, cx, make)?;
    Ok(list)
}

/// Appends `make(0)`, `make(1)` to `make(n - 1)`.
pub(super) fn extend<T: Send>(
    list: &mut Vec<T>,
    n: usize,
    cx: &LoadCx,
    make: impl Fn(usize) -> T + Sync,
) -> Result<(), Cancelled> {
    for start in (0..n).step_by(BLOCK) {
        cx.cancel.check()?;
        let block = start..n.min(start + BLOCK);
        let bytes = block.len() * size_of::<T>();
        cx.pool.run(|| list.par_extend(block.into_par_iter().with_min_len(256).map(&make)));
        cx.progress.advance(bytes as u64);
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::atomic::{AtomicUsize, Ordering};

    #[test]
    fn every_element_is_made_in_its_place() {
        let n = 2 * BLOCK + 17;
        let list = fill(n, &LoadCx::unattended(), |i| i).expect("nobody cancels");
        assert!(list.len() == n && list.iter().enumerate().all(|(i, x)| i == *x));
    }

    #[test]
    fn it_stops_at_the_end_of_a_block() {
        let cx = LoadCx::unattended();
        let made = AtomicUsize::new(0);
        let stopped = fill(10 * BLOCK, &cx, |i| {
            made.fetch_add(1, Ordering::Relaxed);
            if i == BLOCK + 5 {
                cx.cancel.cancel();
            }
        });
        assert!(stopped.is_err());
        assert_eq!(made.into_inner(), 2 * BLOCK);
    }
}
