//! Spheres: the smallest one around some points, and whether a line meets one.

use super::Line;
use super::num::round_up;
use glam::{DVec3, Vec3};

/// A closed ball, its centre relative to the centre of the scene.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct Sphere {
    /// The centre.
    pub centre: Vec3,
    /// The radius, rounded up.
    pub radius: f32,
}

impl Sphere {
    /// About `centre`, rounded to 32 bits, and as large as `reach` asks for: the greatest distance
    /// of a point from the rounded centre.
    pub fn new(centre: Vec3, reach: f64) -> Self {
        // 64 bits err by a few 1e-16 of the coordinates that distances are taken between.
        let slack = 1e-14 * (reach + f64::from(centre.abs().element_sum()));
        Self { centre, radius: round_up(reach + slack) }
    }

    /// Where the line may hit what lies in the sphere; `None` if it misses.
    ///
    /// The distance of the centre from the line is taken from the vector of it (Haines and others
    /// 2019, "Precision Improvements for Ray/Sphere Intersection"): the difference of squares of the
    /// school formula would lose half the digits. In 32 bits that vector errs by 28uD (11 from its
    /// components, each with five roundings of up to 2.7D; 17 along the line, from the foot of the
    /// perpendicular), the squares by 7uD; what is looked for may be off by the root of 3 times
    /// E = 24uD + 4u|o| (see [`Line`]). Twice the line's pad, 96uD + 16u|o|, covers the sum.
    #[inline(always)]
    pub fn interval(&self, line: &Line) -> Option<(f32, f32)> {
        let to_centre = self.centre - line.origin;
        let foot = to_centre.dot(line.dir) * line.inv_length_squared;
        let radius = self.radius + 2.0 * line.pad;
        if (to_centre - foot * line.dir).length_squared() > radius * radius {
            return None;
        }
        let (entry, exit) = line.in_box(self.centre - self.radius, self.centre + self.radius);
        (entry <= exit).then_some((entry, exit))
    }

    /// The area of its surface.
    pub fn area(&self) -> f64 {
        4.0 * std::f64::consts::PI * f64::from(self.radius) * f64::from(self.radius)
    }
}

/// Rounds of [`smallest_ball`]: each takes in a point that was outside. A dozen is usual.
const ROUNDS: usize = 64;

/// Centre and radius of the smallest ball around some points, within a relative 1e-9 where the
/// rounds suffice; a little too small where they do not, so a caller takes the radius from the
/// points. `None` for no points.
///
/// The ball is determined by at most four of the points (Welzl 1991). Here the point farthest
/// outside joins them, and of all balls through some of these five the smallest that holds them all
/// is next (Gärtner 1999, "Fast and Robust Smallest Enclosing Balls", pivoting).
pub fn smallest_ball(points: &[DVec3]) -> Option<(DVec3, f64)> {
    let mut support = vec![*points.first()?];
    let (mut centre, mut radius) = (support[0], 0.0);
    for _ in 0..ROUNDS {
        let (far, distance) = farthest(points, centre)?;
        if distance <= radius * (1.0 + 1e-9) {
            break;
        }
        support.push(far);
        let Some((ball, of)) = ball_of_few(&support) else { break };
        if ball.1 <= radius {
            break;
        }
        (centre, radius) = ball;
        support = of;
    }
    Some((centre, radius))
}

/// The point farthest from `centre`, and how far.
pub fn farthest(points: &[DVec3], centre: DVec3) -> Option<(DVec3, f64)> {
    let squared = |p: &DVec3| p.distance_squared(centre);
    let far = points.iter().max_by(|a, b| squared(a).total_cmp(&squared(b)))?;
    Some((*far, far.distance(centre)))
}

type Ball = (DVec3, f64);

/// The smallest ball around at most five points, the last of which lies on it, and which of them
/// determine it.
fn ball_of_few(points: &[DVec3]) -> Option<(Ball, Vec<DVec3>)> {
    let last = points.len().checked_sub(1)?;
    let mut best: Option<(Ball, Vec<DVec3>)> = None;
    for chosen in 0..1u32 << last {
        let others = (0..last).filter(|i| chosen >> i & 1 == 1).map(|i| points[i]);
        let on: Vec<DVec3> = others.chain([points[last]]).collect();
        let Some(ball) = ball_through(&on) else { continue };
        let room = ball.1 * (1.0 + 1e-10);
        let holds_all = points.iter().all(|p| p.distance(ball.0) <= room);
        if holds_all && best.as_ref().is_none_or(|(b, _)| ball.1 < b.1) {
            best = Some((ball, on));
        }
    }
    best
}

/// The smallest ball with all of one to four points on it: its centre is in the span of them.
/// `None` if they are not independent.
fn ball_through(points: &[DVec3]) -> Option<Ball> {
    let from = *points.first()?;
    let q: Vec<DVec3> = points[1..].iter().map(|p| *p - from).collect();
    let n = q.len();
    if n > 3 {
        return None;
    }
    // centre = from + sum of l_j q_j with 2 q_i . q_j l_j = q_i . q_i
    let mut rows = [[0.0; 4]; 3];
    for i in 0..n {
        for j in 0..n {
            rows[i][j] = 2.0 * q[i].dot(q[j]);
        }
        rows[i][3] = q[i].length_squared();
    }
    let weights = solve(&mut rows, n)?;
    let offset: DVec3 = q.iter().zip(weights).map(|(q, l)| *q * l).sum();
    Some((from + offset, offset.length()))
}

/// Solves `n` of at most three equations by elimination with pivots; the last column is the right side.
fn solve(rows: &mut [[f64; 4]; 3], n: usize) -> Option<[f64; 3]> {
    let scale = (0..n).map(|i| rows[i][i]).fold(0.0, f64::max);
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| rows[*a][k].abs().total_cmp(&rows[*b][k].abs()))?;
        rows.swap(k, pivot);
        if rows[k][k].abs() <= 1e-13 * scale {
            return None;
        }
        for i in k + 1..n {
            let by = rows[i][k] / rows[k][k];
            let above = rows[k];
            rows[i].iter_mut().zip(above).skip(k).for_each(|(x, a)| *x -= by * a);
        }
    }
    let mut solution = [0.0; 3];
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| rows[k][j] * solution[j]).sum();
        solution[k] = (rows[k][3] - known) / rows[k][k];
    }
    Some(solution)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_smallest_ball_is_known_for_simple_sets() {
        let at = DVec3::new(0.3, -0.2, 0.1);
        let ball = |points: &[DVec3]| {
            let moved: Vec<DVec3> = points.iter().map(|p| *p + at).collect();
            let (centre, radius) = smallest_ball(&moved).expect("points");
            (centre - at, radius)
        };
        let near = |a: (DVec3, f64), b: (DVec3, f64)| a.0.distance(b.0) < 1e-7 && (a.1 - b.1).abs() < 1e-7;
        assert!(near(ball(&[DVec3::ZERO, DVec3::X]), (DVec3::X * 0.5, 0.5)));
        assert!(near(ball(&[DVec3::ZERO, DVec3::X, DVec3::X * 0.3, DVec3::X]), (DVec3::X * 0.5, 0.5)));
        let obtuse = [DVec3::ZERO, DVec3::X, DVec3::new(0.5, 0.1, 0.0)];
        assert!(near(ball(&obtuse), (DVec3::X * 0.5, 0.5)), "the obtuse corner does not count");
        let cube: Vec<DVec3> = (0..8).map(|i| DVec3::new(f64::from(i & 1), f64::from(i >> 1 & 1), f64::from(i >> 2))).collect();
        assert!(near(ball(&cube), (DVec3::splat(0.5), 0.75f64.sqrt())));
        assert!(smallest_ball(&[]).is_none());
    }

    #[test]
    fn no_ball_about_another_centre_is_smaller() {
        let points: Vec<DVec3> = (0..200)
            .map(f64::from)
            .map(|i| DVec3::new((i * 1.7).sin(), (i * 2.3).cos() * 0.5, (i * 0.9).sin() * i / 300.0))
            .collect();
        let (centre, radius) = smallest_ball(&points).expect("points");
        let reach = |c: DVec3| farthest(&points, c).expect("points").1;
        assert!((reach(centre) - radius).abs() <= 1e-8 * radius);
        for step in [DVec3::X, DVec3::Y, DVec3::Z].into_iter().flat_map(|d| [d * 1e-3, d * -1e-3]) {
            assert!(reach(centre + step) > radius);
        }
    }
}
