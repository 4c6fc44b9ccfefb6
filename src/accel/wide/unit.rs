//! Where nodes and blocks lie: one list in units of 32 bytes, a leaf's blocks next to the node that refers
//! to them, so that an address is an offset and neighbours share pages.

use bytemuck::Pod;

/// 32 bytes.
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
#[repr(C, align(32))]
pub struct Unit([u32; 8]);

/// Bytes of a unit.
pub const BYTES: usize = size_of::<Unit>();

/// The `N` units at a place as a value of that size.
#[inline(always)]
pub fn at<V: Pod, const N: usize>(units: &[Unit], place: usize) -> &V {
    let Some(units) = units[place..].first_chunk::<N>() else { outside() };
    bytemuck::from_bytes(bytemuck::cast_slice(units))
}

/// The same, to be changed.
pub fn at_mut<V: Pod, const N: usize>(units: &mut [Unit], place: usize) -> &mut V {
    let Some(units) = units[place..].first_chunk_mut::<N>() else { outside() };
    bytemuck::from_bytes_mut(bytemuck::cast_slice_mut(units))
}

/// Appends a value; where it lies.
pub fn push<V: Pod>(units: &mut Vec<Unit>, value: &V) -> usize {
    let place = units.len();
    units.extend_from_slice(bytemuck::cast_slice(std::slice::from_ref(value)));
    place
}

#[cold]
fn outside() -> ! {
    panic!("a child lies outside of its tree")
}
