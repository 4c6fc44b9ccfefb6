//! Whether two structures agree on a ray.

use super::Found;
use crate::accel::Mode;

/// Two hits of different triangles are as good as one if their t differ by no more than this share: on
/// an edge that triangles share, or where two coincide, either may be told.
const NEAR: f32 = 1e-4;

/// Whether what was found is another hit than the one expected.
pub fn differs(expected: Found, found: Found, mode: Mode) -> bool {
    if expected.is_hit() != found.is_hit() {
        return true;
    }
    let closest = mode == Mode::Closest && expected.is_hit();
    let near = (expected.t - found.t).abs() <= NEAR * expected.t.abs().max(f32::EPSILON);
    closest && expected.prim != found.prim && !near
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn another_triangle_differs_unless_it_is_as_near() {
        let hit = |t, prim| Found { t, prim };
        let differ = |a, b| differs(a, b, Mode::Closest);
        assert!(!differ(hit(1.0, 3), hit(1.1, 3)), "a t of its own is no other hit");
        assert!(!differ(hit(1.0, 3), hit(1.000_05, 4)));
        assert!(differ(hit(1.0, 3), hit(1.01, 4)));
        assert!(differ(hit(1.0, 3), Found::MISS) && differ(Found::MISS, hit(1.0, 3)));
        assert!(!differ(Found::MISS, Found::MISS));
        assert!(!differs(Found::SOMETHING, hit(9.0, 7), Mode::Any) && differs(Found::MISS, Found::SOMETHING, Mode::Any));
    }
}
