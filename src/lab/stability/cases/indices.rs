//! Lists that grow longer than what numbers their entries.

use super::{Case, Trial, shapes};
use crate::scene::builtin::Random;

const fn limit(id: &'static str, make: fn(&mut Random, usize) -> Trial) -> Case {
    Case {
        id,
        what: "A ball of 360 triangles, where no list may have more entries than that many, as if indices had hardly any bits.",
        bites: "Indices that overflow point to other triangles: nothing is refused and much is wrong.",
        remedy: "Compare each length with what its index holds before the list is made, and refuse.",
        make,
    }
}

pub const FEW: Case = limit("indices-300", |random, rays| make(random, rays, 300));
pub const SOME: Case = limit("indices-1000", |random, rays| make(random, rays, 1000));
pub const MANY: Case = limit("indices-3000", |random, rays| make(random, rays, 3000));

fn make(random: &mut Random, rays: usize, indices: usize) -> Trial {
    let triangles = shapes::ball(10);
    Trial { rays: shapes::aimed(random, &triangles, 3.0, rays), triangles, closed: true, indices: Some(indices) }
}
