//! Lists that all threads of the pool fill, each a piece at a time. Their pages are large and given when
//! first written to: at these sizes the system takes longer to clear pages than we to fill them.

use bytemuck::Zeroable;
use rayon::prelude::*;

use super::LoadCx;
use crate::sys::zeros_in_large_pages;
use crate::task::Cancelled;

/// Items between two looks at the cancel flag: a few milliseconds, where an item takes 500 ns.
const PIECE: usize = 1 << 13;

/// Waking the pool takes longer than to fill fewer, and models of many small meshes are common.
const FEW: usize = 1 << 14;

/// Why a list is not to be had by a quick road.
pub(super) enum Stop {
    Cancelled(Cancelled),
    /// Something is unusual, or wrong: the slow road is to look at it.
    Unusual,
}

impl From<Cancelled> for Stop {
    fn from(cancelled: Cancelled) -> Self {
        Self::Cancelled(cancelled)
    }
}

impl Stop {
    /// What was made, or `None` where the slow road is to be taken.
    pub fn or_slow_road<T>(made: Result<T, Self>) -> Result<Option<T>, Cancelled> {
        match made {
            Ok(made) => Ok(Some(made)),
            Err(Self::Unusual) => Ok(None),
            Err(Self::Cancelled(cancelled)) => Err(cancelled),
        }
    }
}

/// A list of `n` items. `fill` gets a piece of it, and where in the list that begins. Each item counts as
/// `units` of progress. The caller has charged the budget for the list, and made sure that the file backs
/// its length.
pub(super) fn list<T: Zeroable + Send>(
    n: usize,
    units: u64,
    cx: &LoadCx,
    fill: impl Fn(usize, &mut [T]) + Sync,
) -> Result<Vec<T>, Cancelled> {
    try_list(n, units, cx, |start, piece| {
        fill(start, piece);
        Ok(())
    })
}

/// The same where `fill` can give up. Which error is told if several pieces fail depends on the threads.
pub(super) fn try_list<T: Zeroable + Send, E: From<Cancelled> + Send>(
    n: usize,
    units: u64,
    cx: &LoadCx,
    fill: impl Fn(usize, &mut [T]) -> Result<(), E> + Sync,
) -> Result<Vec<T>, E> {
    let mut list = zeros_in_large_pages(n);
    each_piece(&mut list, cx, |start, piece| {
        cx.progress.advance(piece.len() as u64 * units);
        fill(start, piece)
    })?;
    Ok(list)
}

/// Gives the pieces of a list to all threads, with where each begins.
pub(super) fn each_piece<T: Send, E: From<Cancelled> + Send>(
    list: &mut [T],
    cx: &LoadCx,
    work: impl Fn(usize, &mut [T]) -> Result<(), E> + Sync,
) -> Result<(), E> {
    if list.len() <= FEW {
        cx.cancel.check()?;
        return work(0, list);
    }
    let pieces = list.par_chunks_mut(PIECE).enumerate();
    cx.pool.run(|| {
        pieces.try_for_each(|(i, piece)| {
            cx.cancel.check()?;
            work(i * PIECE, piece)
        })
    })
}

/// Where in a list the first is that is `wanted`.
pub(super) fn position<T: Sync>(list: &[T], cx: &LoadCx, wanted: impl Fn(&T) -> bool + Sync) -> Option<usize> {
    if list.len() <= FEW {
        return list.iter().position(wanted);
    }
    // Without a way out a piece is looked through several at a time.
    let any = |piece: &[T]| piece.iter().fold(false, |found, x| found | wanted(x));
    let piece = cx.pool.run(|| list.par_chunks(PIECE).position_first(any))?;
    list[piece * PIECE..].iter().position(wanted).map(|i| piece * PIECE + i)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_is_found() {
        let (cx, list) = (LoadCx::unattended(), Vec::from_iter(0..3 * PIECE));
        for first in [0, 1, PIECE - 1, PIECE, 3 * PIECE - 1] {
            assert_eq!(position(&list, &cx, |x| *x >= first), Some(first));
            assert_eq!(position(&list[..first], &cx, |x| *x >= first), None);
        }
    }

    #[test]
    fn every_item_is_filled_once() {
        let cx = LoadCx::unattended();
        for n in [0, 1, FEW, FEW + 1, 5 * PIECE + 7] {
            cx.progress.start("fill", 2 * n as u64);
            let fill = |start: usize, piece: &mut [u64]| (start as u64..).zip(piece).for_each(|(i, x)| *x += i + 1);
            let list = list(n, 2, &cx, fill).expect("nobody cancels");
            assert!(list.len() == n && (1..).zip(&list).all(|(i, x)| i == *x));
            assert!(cx.progress.snapshot().fraction.is_none_or(|done| done >= 1.0));
        }
        cx.cancel.cancel();
        assert!([1, 3 * PIECE].iter().all(|n| list::<u8>(*n, 1, &cx, |_, _| ()).is_err()));
    }
}
