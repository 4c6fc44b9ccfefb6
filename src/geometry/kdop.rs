//! Discrete oriented polytopes (Kay and Kajiya 1986, "Ray Tracing Complex Scenes", §3; Klosowski
//! and others 1998 for the sets of directions): slabs of fixed directions, so that all that depends
//! on ray and direction is worked out once a ray.
//!
//! The directions besides the axes are the four diagonals of a cube and the six of its faces. They
//! are not of unit length: with components 0, 1 and -1, products and bounds are sums.

use super::line::{Through, common};
use super::num::{round_down, round_up};
use super::polytope::Plane;
use super::{Aabb, Line};
use glam::{DVec3, Vec3};

const fn d(x: f32, y: f32, z: f32) -> Vec3 {
    Vec3::new(x, y, z)
}

/// The diagonals of the cube, then those of its faces.
const DIAGONALS: [Vec3; 10] = [
    d(1.0, 1.0, 1.0),
    d(1.0, 1.0, -1.0),
    d(1.0, -1.0, 1.0),
    d(-1.0, 1.0, 1.0),
    d(1.0, 1.0, 0.0),
    d(1.0, -1.0, 0.0),
    d(1.0, 0.0, 1.0),
    d(1.0, 0.0, -1.0),
    d(0.0, 1.0, 1.0),
    d(0.0, 1.0, -1.0),
];

/// The first `N` diagonals from `FIRST` on, and how far points reach along them, relative to the
/// centre of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Diagonals<const FIRST: usize, const N: usize> {
    lo: [f32; N],
    hi: [f32; N],
}

/// What [`Diagonals`] need of a line.
#[derive(Clone, Copy, Debug)]
pub struct DiagonalLine<const N: usize>([Through; N]);

impl<const FIRST: usize, const N: usize> Diagonals<FIRST, N> {
    /// Holds nothing.
    pub const EMPTY: Self = Self { lo: [f32::INFINITY; N], hi: [f32::NEG_INFINITY; N] };

    /// The directions.
    pub const DIRECTIONS: [Vec3; N] = {
        let mut some = [Vec3::ZERO; N];
        let mut i = 0;
        while i < N {
            some[i] = DIAGONALS[FIRST + i];
            i += 1;
        }
        some
    };

    /// The same grown to hold a point. Sums of 64-bit coordinates err by less than 4e-16 of their
    /// magnitudes, which the step to the next 32-bit float covers unless they cancel; then the
    /// slack does.
    #[inline]
    pub fn with(mut self, point: DVec3) -> Self {
        let slack = 1e-15 * (point.x.abs() + point.y.abs() + point.z.abs());
        for (i, direction) in Self::DIRECTIONS.iter().enumerate() {
            let at = direction.as_dvec3().dot(point);
            self.lo[i] = self.lo[i].min(round_down(at - slack));
            self.hi[i] = self.hi[i].max(round_up(at + slack));
        }
        self
    }

    /// What holds both.
    pub fn union(mut self, other: &Self) -> Self {
        for i in 0..N {
            self.lo[i] = self.lo[i].min(other.lo[i]);
            self.hi[i] = self.hi[i].max(other.hi[i]);
        }
        self
    }

    /// What depends on the line only.
    pub fn line(line: &Line) -> DiagonalLine<N> {
        DiagonalLine(Self::DIRECTIONS.map(|n| line.through(n, n.abs().element_sum())))
    }

    /// Cuts an interval of t by all slabs; empty when the first exceeds the second.
    #[inline(always)]
    pub fn cut(&self, line: &DiagonalLine<N>, interval: (f32, f32)) -> (f32, f32) {
        let mut left = interval;
        for i in 0..N {
            left = common(left, line.0[i].interval(self.lo[i], self.hi[i]));
        }
        left
    }

    /// Its faces, relative to the centre of the scene.
    pub fn planes(&self) -> Vec<Plane> {
        let faces = |i: usize| {
            let normal = Self::DIRECTIONS[i].as_dvec3();
            [Plane::new(normal, f64::from(self.hi[i])), Plane::new(-normal, -f64::from(self.lo[i]))]
        };
        (0..N).flat_map(faces).collect()
    }
}

/// The four slabs of the cube's diagonals alone: an octahedron cut to size.
pub type Octahedron = Diagonals<0, 4>;

impl Octahedron {
    /// The box around it, rounded. Twice a coordinate is the sum of two diagonals, and the
    /// difference of the other two: whichever is tighter.
    #[inline(always)]
    pub fn rounded_box(&self) -> (Vec3, Vec3) {
        let ([a, b, c, d], [e, f, g, h]) = (self.lo, self.hi);
        // x = (d1 + d2) / 2 = (d0 - d3) / 2, y = (d1 + d3) / 2 = (d0 - d2) / 2, z likewise.
        let min = Vec3::new(b + c, b + d, c + d).max(Vec3::new(a - h, a - g, a - f));
        let max = Vec3::new(f + g, f + h, g + h).min(Vec3::new(e - d, e - c, e - b));
        (0.5 * min, 0.5 * max)
    }
}

/// The faces of a box, relative to `centre`.
pub fn box_planes(bounds: &Aabb, centre: DVec3) -> [Plane; 6] {
    let (min, max) = (bounds.min.as_dvec3() - centre, bounds.max.as_dvec3() - centre);
    let face = |k: usize| {
        let normal = DVec3::AXES[k];
        [Plane::new(normal, max[k]), Plane::new(-normal, -min[k])]
    };
    let [[a, b], [c, d], [e, f]] = [0, 1, 2].map(face);
    [a, b, c, d, e, f]
}

/// The points that reach farthest along the axes and all diagonals, either way: at most 26, each once.
pub fn extremes(points: &[DVec3]) -> Vec<DVec3> {
    let directions = DVec3::AXES.into_iter().chain(DIAGONALS.iter().map(|n| n.as_dvec3()));
    let mut chosen = Vec::new();
    for n in directions.flat_map(|n| [n, -n]) {
        let Some(far) = points.iter().max_by(|a, b| n.dot(**a).total_cmp(&n.dot(**b))) else { break };
        if !chosen.contains(far) {
            chosen.push(*far);
        }
    }
    chosen
}

/// All 26 directions of the largest of these polytopes, of unit length.
pub fn directions() -> impl Iterator<Item = DVec3> {
    let some = DVec3::AXES.into_iter().chain(DIAGONALS.iter().map(|n| n.as_dvec3()));
    some.flat_map(|n| [n, -n]).map(|n| n / n.length())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_octahedron_knows_its_box() {
        let points = [DVec3::new(0.1, 0.2, 0.3), DVec3::new(-0.4, 0.1, 0.0), DVec3::new(0.2, -0.3, 0.5)];
        let volume = points.into_iter().fold(Octahedron::EMPTY, Octahedron::with);
        for k in 0..3 {
            let (min, max) = volume.rounded_box();
            assert!(points.iter().all(|p| f64::from(min[k]) <= p[k] + 1e-7 && p[k] <= f64::from(max[k]) + 1e-7));
        }
        let tip = Octahedron::EMPTY.with(DVec3::X).with(-DVec3::X).with(DVec3::Y).with(-DVec3::Y).with(DVec3::Z).with(-DVec3::Z);
        assert!((tip.rounded_box().1.y - 1.0).abs() < 1e-6, "a true octahedron reaches to its corners");
    }

    #[test]
    fn extremes_are_few_and_outermost() {
        let points: Vec<DVec3> =
            (0..1000).map(f64::from).map(|i| DVec3::new(i.sin(), (i * 1.3).sin(), (i * 1.7).sin())).collect();
        let few = extremes(&points);
        let reach = |list: &[DVec3], n: DVec3| list.iter().map(|p| p.dot(n)).fold(f64::MIN, f64::max);
        assert!(few.len() <= 26 && directions().count() == 26);
        assert!(directions().all(|n| reach(&few, n) == reach(&points, n)));
        assert!(extremes(&[]).is_empty());
    }
}
