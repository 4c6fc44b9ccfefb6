//! Whether a triangle has zero area, decided exactly.

use glam::Vec3;

/// True if the three corners lie on one line (or in one point), with no rounding: the corners are
/// on one line exactly if they are in all three coordinate projections, and the planar question
/// is answered by the adaptive predicate of Shewchuk (1997).
pub fn has_zero_area(tri: &[Vec3; 3]) -> bool {
    let collinear = |i: usize, j: usize| {
        let at = |v: Vec3| robust::Coord { x: f64::from(v[i]), y: f64::from(v[j]) };
        robust::orient2d(at(tri[0]), at(tri[1]), at(tri[2])) == 0.0
    };
    collinear(0, 1) && collinear(1, 2) && collinear(2, 0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slivers_are_told_from_lines() {
        let (a, b) = (Vec3::new(0.1, 0.2, 0.3), Vec3::new(1.7, -3.1, 9.4));
        assert!(has_zero_area(&[a, a, b]));
        assert!(has_zero_area(&[Vec3::ZERO, Vec3::splat(1e-30), Vec3::splat(2e-30)]));
        let next = f32::from_bits(1.0f32.to_bits() + 1);
        assert!(!has_zero_area(&[Vec3::ZERO, Vec3::ONE, Vec3::new(1.0, 1.0, next)]));
        assert!(!has_zero_area(&[Vec3::ZERO, Vec3::X * 1e-38, Vec3::Y * 1e-38]));
    }
}
