//! Which vertices of a list a primitive needs.

use crate::geometry::num;
use crate::scene::Reason;
use crate::scene::load::pace::Pace;

/// Which of an accessor's elements are read.
pub(super) enum Picked {
    All(usize),
    /// These, ascending: many primitives may share one long list of vertices, of which each uses
    /// a few.
    Some(Vec<u32>),
}

impl Picked {
    /// What `triangles` use of `count` vertices, and the triangles with indices into that.
    pub fn of(mut triangles: Vec<[u32; 3]>, count: usize, pace: &mut Pace) -> Result<(Self, Vec<[u32; 3]>), Reason> {
        if triangles.len() >= count / 6 {
            return Ok((Self::All(count), triangles));
        }
        let mut used = Vec::new();
        if triangles.len() < Self::FEW {
            used.extend(triangles.iter().flatten());
            used.sort_unstable();
            used.dedup();
        } else {
            let mut is_used = vec![false; count];
            for corner in triangles.iter().flatten() {
                pace.step(1)?;
                is_used[*corner as usize] = true;
            }
            used.extend((0..).zip(is_used).filter(|(_, is_used)| *is_used).map(|(i, _)| i));
        }
        for corner in triangles.iter_mut().flatten() {
            pace.step(4)?;
            *corner = num::index(used.partition_point(|i| *i < *corner));
        }
        Ok((Self::Some(used), triangles))
    }

    /// Below this sorting what is used is quick, above it marking what is used is, which takes
    /// time by the length of the whole list.
    const FEW: usize = 1 << 14;

    /// How many are read.
    pub fn count(&self) -> usize {
        match self {
            Self::All(count) => *count,
            Self::Some(list) => list.len(),
        }
    }

    /// Where in the accessor the `i`-th of them is.
    pub fn source(&self, i: usize) -> usize {
        match self {
            Self::All(_) => i,
            Self::Some(list) => list[i] as usize,
        }
    }
}
