//! A parallel sort that stops when it is cancelled: pieces are sorted one by one, then merged two by
//! two.

use rayon::prelude::*;

use super::{Cancel, Cancelled};

/// Values sorted, or merged by one thread, between two looks at the cancel flag.
const PIECE: usize = 1 << 16;

/// Sorts a list by value, on the threads of the pool that it is called in. Equal values cannot be
/// told apart, so the result does not depend on the number of threads.
///
/// # Errors
/// [`Cancelled`]; the list is then in no order, and may not hold the same values.
pub fn by_value<T: Copy + Ord + Send + Sync>(list: &mut Vec<T>, cancel: &Cancel) -> Result<(), Cancelled> {
    list.par_chunks_mut(PIECE).try_for_each(|piece| {
        piece.sort_unstable();
        cancel.check()
    })?;
    if list.len() <= PIECE {
        return Ok(());
    }
    let mut other = list.clone();
    let mut width = PIECE;
    while width < list.len() {
        list.par_chunks(2 * width).zip(other.par_chunks_mut(2 * width)).try_for_each(|(pair, into)| {
            let (a, b) = pair.split_at(width.min(pair.len()));
            merge(a, b, into, cancel)
        })?;
        std::mem::swap(list, &mut other);
        width *= 2;
    }
    Ok(())
}

/// Merges two sorted lists; long ones in two halves, side by side.
fn merge<T: Copy + Ord + Send + Sync>(a: &[T], b: &[T], into: &mut [T], cancel: &Cancel) -> Result<(), Cancelled> {
    cancel.check()?;
    if into.len() <= PIECE {
        merge_here(a, b, into);
        return Ok(());
    }
    let (a, b) = if a.len() < b.len() { (b, a) } else { (a, b) };
    let (a_low, a_high) = a.split_at(a.len() / 2);
    let (b_low, b_high) = b.split_at(b.partition_point(|x| *x < a_high[0]));
    let (low, high) = into.split_at_mut(a_low.len() + b_low.len());
    let (low, high) = rayon::join(|| merge(a_low, b_low, low, cancel), || merge(a_high, b_high, high, cancel));
    low.and(high)
}

fn merge_here<'a, T: Copy + Ord>(mut a: &'a [T], mut b: &'a [T], into: &mut [T]) {
    for to in into {
        let from_a = match (a.first(), b.first()) {
            (Some(x), Some(y)) => x <= y,
            (first, _) => first.is_some(),
        };
        let from = if from_a { &mut a } else { &mut b };
        let Some((first, rest)) = from.split_first() else { return };
        (*to, *from) = (*first, rest);
    }
}

/// A key for a float that is not NaN: ordered as the floats are.
#[inline(always)]
pub const fn ascending(x: f32) -> u32 {
    let bits = x.to_bits();
    if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_come_out_sorted() {
        let mut x = 1u64;
        let mut next = || {
            x = x.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            x >> 40
        };
        for n in [0, 1, 2, PIECE, PIECE + 1, 5 * PIECE + 77] {
            let list: Vec<u64> = (0..n).map(|_| next()).collect();
            let (mut sorted, mut expected) = (list.clone(), list);
            by_value(&mut sorted, &Cancel::new()).expect("not cancelled");
            expected.sort_unstable();
            assert!(sorted == expected, "{n} values");
        }
    }

    #[test]
    fn it_stops_when_cancelled() {
        let cancel = Cancel::new();
        cancel.cancel();
        assert!(by_value(&mut vec![3, 1, 2], &cancel).is_err());
    }

    #[test]
    fn keys_are_ordered_as_floats_are() {
        let floats = [f32::NEG_INFINITY, -2.0, -1e-40, -0.0, 0.0, 1e-40, 1.0, f32::INFINITY];
        assert!(floats.windows(2).all(|w| ascending(w[0]) < ascending(w[1])));
    }
}
