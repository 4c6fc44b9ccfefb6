//! Large pages for large lists: with small ones a processor spends as long finding out where a node is
//! as fetching it.
#![expect(unsafe_code)]

use bytemuck::Zeroable;

/// The least size of a list for which it is worth asking.
const WORTH_BYTES: usize = 4 << 20;

/// An empty list with room for `capacity` items, in large pages where the system grants them. It is to be
/// filled after that: what was written already stays where it is.
pub fn list_in_large_pages<T>(capacity: usize) -> Vec<T> {
    let list = Vec::<T>::with_capacity(capacity);
    let bytes = list.capacity() * size_of::<T>();
    if bytes >= WORTH_BYTES {
        advise(list.as_ptr().cast(), bytes);
    }
    list
}

/// A list of `n` zeros, in large pages where the system grants them. Fresh memory is cleared when it is first
/// written to, so several threads that fill it share that work.
pub fn zeros_in_large_pages<T: Zeroable>(n: usize) -> Vec<T> {
    let list = bytemuck::zeroed_vec::<T>(n);
    if size_of_val(&list[..]) >= WORTH_BYTES {
        advise(list.as_ptr().cast(), size_of_val(&list[..]));
    }
    list
}

/// Asks for large pages inside a stretch of memory; that may be in vain, and it is no error if so.
#[cfg(target_os = "linux")]
fn advise(start: *const u8, bytes: usize) {
    const PAGE: usize = 4096;
    let first = start.addr().next_multiple_of(PAGE);
    let end = (start.addr() + bytes) & !(PAGE - 1);
    if first < end {
        // SAFETY: the pages are inside an allocation of ours, and the advice changes nothing that is in them.
        unsafe {
            libc::madvise(start.with_addr(first).cast_mut().cast(), end - first, libc::MADV_HUGEPAGE);
        }
    }
}

#[cfg(not(target_os = "linux"))]
fn advise(_: *const u8, _: usize) {}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zeros_are_zeros() {
        for n in [0, 3, 3 << 20] {
            let list = zeros_in_large_pages::<u64>(n);
            assert!(list.len() == n && list.iter().all(|x| *x == 0));
        }
    }

    #[test]
    fn lists_hold_what_they_are_filled_with() {
        for n in [0, 3, 3 << 20] {
            let mut list = list_in_large_pages(n);
            list.extend(0..n as u64);
            assert!(list.capacity() >= n);
            assert!(list.iter().enumerate().all(|(i, x)| i as u64 == *x) && list.len() == n);
        }
    }
}
