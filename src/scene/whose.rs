//! Which instance a flattened triangle belongs to.

use super::PrimRef;
use crate::geometry::num;

/// The instances that were flattened, in ascending order, and where their triangles begin.
#[derive(Debug)]
pub(super) struct Owners {
    /// The last one begins behind the last triangle.
    starts: Vec<Start>,
    /// For each run of `2^shift` triangles the owner of the first: where to begin to search.
    runs: Vec<u32>,
    shift: u32,
}

#[derive(Clone, Copy, Debug)]
struct Start {
    first: PrimRef,
    instance: u32,
}

impl Owners {
    /// Of instances and how many triangles each has: together no more than 32 bits can index.
    pub fn new(instances: impl Iterator<Item = (u32, usize)>) -> Self {
        let mut starts = Vec::with_capacity(instances.size_hint().0 + 1);
        let mut next = 0;
        for (instance, triangles) in instances {
            starts.push(Start { first: next, instance });
            next += num::index(triangles);
        }
        let count = num::index(starts.len());
        starts.push(Start { first: next, instance: u32::MAX });
        // About as many runs as instances.
        let shift = (next / (count + 1)).max(1).ilog2();
        let owner = |run: u32| starts.partition_point(|start| start.first <= run << shift) - 1;
        let runs = if count == 0 { Vec::new() } else { (0..=next >> shift).map(|run| num::index(owner(run))).collect() };
        Self { starts, runs, shift }
    }

    /// For the look-up of many.
    #[inline(always)]
    pub fn whose(&self) -> Whose<'_> {
        Whose { starts: &self.starts, shift: self.shift, runs: &self.runs }
    }

    /// The flattened index of a triangle of an instance; `None` if that was not flattened.
    #[inline]
    pub fn flat(&self, instance: u32, primitive: u32) -> Option<PrimRef> {
        Some(self.starts[self.at(instance)?].first + primitive)
    }

    /// How many triangles an instance has; `None` if it was not flattened.
    pub fn count(&self, instance: u32) -> Option<usize> {
        let at = self.at(instance)?;
        Some((self.starts[at + 1].first - self.starts[at].first) as usize)
    }

    /// One more than the last instance that was flattened; 0 if none was.
    pub fn end(&self) -> u32 {
        // The last entry is nobody's.
        self.starts.iter().nth_back(1).map_or(0, |start| start.instance + 1)
    }

    #[inline]
    fn at(&self, instance: u32) -> Option<usize> {
        // Where all were flattened it stands at its own number. The last entry is nobody's.
        let starts = &self.starts[..self.starts.len() - 1];
        match starts.get(instance as usize) {
            Some(start) if start.instance == instance => Some(instance as usize),
            _ => starts.binary_search_by_key(&instance, |start| start.instance).ok(),
        }
    }

    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.starts[..]) + size_of_val(&self.runs[..])) as u64
    }
}

/// Tells the instance of many triangles.
#[derive(Clone, Copy, Debug)]
pub struct Whose<'a> {
    starts: &'a [Start],
    shift: u32,
    runs: &'a [u32],
}

impl Whose<'_> {
    /// The instance that a triangle belongs to, and its index within the instance's mesh.
    #[inline(always)]
    pub fn locate(&self, prim: PrimRef) -> (u32, u32) {
        let mut at = self.runs[(prim >> (self.shift & 31)) as usize];
        while self.starts[at as usize + 1].first <= prim {
            at += 1;
        }
        let start = self.starts[at as usize];
        (start.instance, prim - start.first)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_triangle_finds_its_instance_and_back() {
        let counts = [(0, 3), (2, 0), (3, 1), (7, 40), (8, 0), (9, 2)];
        let owners = Owners::new(counts.into_iter());
        let expected: Vec<_> = counts.iter().flat_map(|&(i, n)| (0..num::index(n)).map(move |p| (i, p))).collect();
        for (prim, (instance, primitive)) in (0..).zip(expected) {
            assert_eq!(owners.whose().locate(prim), (instance, primitive));
            assert_eq!(owners.flat(instance, primitive), Some(prim));
        }
        assert!(counts.iter().all(|(i, n)| owners.count(*i) == Some(*n)) && owners.count(1).is_none());
        assert_eq!((owners.flat(1, 0), owners.flat(10, 0), owners.end()), (None, None, 10));
        let none = Owners::new(std::iter::empty());
        assert_eq!((none.flat(0, 0), none.end()), (None, 0));
    }
}
