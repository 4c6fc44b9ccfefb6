//! One triangle on the screen: which samples it covers, and how deep it lies there.
//!
//! Three edge functions, linear on the screen, decide (Pineda 1988). They are taken from homogeneous
//! coordinates (Olano and Greer 1997), which hold for corners behind the eye as well: the cross
//! product of two corners is the plane through the eye and the edge between them, and a ray runs on
//! one side of it or the other. So nothing needs to be clipped at the eye, and there is no near plane
//! for a triangle to be cut off at.
//!
//! ```text
//!         c          inside: e_ab, e_bc and e_ca have the sign of det(a, b, c). All have the other
//!        / \         where the line of the ray meets the triangle behind the eye.
//!       / + \
//!      a-----b
//! ```
//!
//! Neighbours take the same two products for their shared edge, with opposite signs, to the bit: no
//! sample between them is lost, and one that lies on the edge belongs to just one of them.

use std::ops::Range;

use super::view::View;
use crate::geometry::num::floor_index;
use glam::{DVec2, DVec3, Vec3};

/// A triangle that is seen from this angle (its sine) or less is edge on: the eye is in its plane,
/// up to rounding, and it covers nothing.
const EDGE_ON: f64 = 1e-14;

/// Corners no farther before the eye (in a scene of extent 1) may be anywhere on the screen.
const AT_EYE: f64 = 1e-9;

/// A triangle that may cover samples.
#[derive(Clone, Debug)]
pub struct Triangle {
    edges: [Edge; 3],
    /// t is the one over the other, both linear in (x, y, 1).
    t: [DVec3; 2],
    /// The rows that may hold samples of it.
    pub rows: Range<usize>,
    columns: Range<usize>,
    /// It reaches behind the eye: what a rasteriser with a near plane would have to clip.
    pub crosses_eye: bool,
}

/// An edge function: `of · (x, y, 1)`, positive inside.
#[derive(Clone, Copy, Debug)]
struct Edge {
    of: DVec3,
    /// -1 over the slope in x.
    inverse: f64,
    /// Samples on the edge are the triangle's.
    owner: bool,
}

impl Triangle {
    /// Sets up a triangle of the scaled space; `None` for one that can cover no sample: it lies
    /// behind the eye, off the screen or between samples, or is seen edge on.
    pub fn new(view: &View, corners: &[Vec3; 3]) -> Option<Self> {
        let places = corners.map(|p| view.place(p));
        let [a, b, c] = places.map(|p| view.homogeneous(p));
        if off_screen(&[a, b, c]) || places.iter().all(|p| p.z < 0.0) {
            return None;
        }
        let [rows, columns] = if a.z > AT_EYE && b.z > AT_EYE && c.z > AT_EYE {
            bounds(view, &[a, b, c])
        } else {
            [0..view.rows.len(), 0..view.columns.len()]
        };
        if rows.is_empty() || columns.is_empty() {
            return None;
        }
        let normal = (places[1] - places[0]).cross(places[2] - places[0]);
        let (det, most) = if view.parallel {
            (normal.z, normal.length_squared())
        } else {
            (normal.dot(places[0]), normal.length_squared() * places[0].length_squared())
        };
        let has_area = det * det > EDGE_ON * EDGE_ON * most; // what is not a number has none
        if !has_area {
            return None;
        }
        let side = det.signum();
        let edges = [b.cross(c), c.cross(a), a.cross(b)].map(|e| Edge::new(e * side));
        let crosses_eye = places.iter().any(|p| p.z < 0.0);
        Some(Self { edges, t: depth(view, normal, places[0], det), rows, columns, crosses_eye })
    }

    /// The columns whose samples the triangle covers in a row: all of them, and no others.
    #[inline]
    pub fn span(&self, view: &View, row: usize) -> Range<usize> {
        let mut span = self.columns.clone();
        for edge in &self.edges {
            edge.narrow(view, view.rows[row], &mut span);
            if span.is_empty() {
                break;
            }
        }
        span
    }

    /// t of the samples at `xs` of a row: that of the primary rays through them.
    #[inline]
    pub fn depths(&self, y: f64, xs: &[f64]) -> impl Iterator<Item = f64> {
        let [over, under] = self.t;
        let (c, d) = (over.y * y + over.z, under.y * y + under.z);
        xs.iter().map(move |x| (over.x * x + c) / (under.x * x + d))
    }
}

/// Where a primary ray meets the plane through `at`: with normal n, in perspective n·at / n·(x, y, 1);
/// in a parallel view, whose rays start at (x, y, 0), (n·at - n_x x - n_y y) / n_z.
fn depth(view: &View, normal: DVec3, at: DVec3, det: f64) -> [DVec3; 2] {
    if view.parallel { [DVec3::new(-normal.x, -normal.y, normal.dot(at)) / det, DVec3::Z] } else { [DVec3::Z, normal / det] }
}

/// Whether all corners lie beyond one side of the screen; holds for any w.
fn off_screen(corners: &[DVec3; 3]) -> bool {
    let all = |beyond: fn(&DVec3) -> bool| corners.iter().all(beyond);
    all(|p| p.z <= 0.0) || all(|p| p.x > p.z) || all(|p| -p.x > p.z) || all(|p| p.y > p.z) || all(|p| -p.y > p.z)
}

/// The rows and columns whose samples may be covered, of corners before the eye.
fn bounds(view: &View, corners: &[DVec3; 3]) -> [Range<usize>; 2] {
    let at = corners.map(|p| DVec2::new(view.column(p.x / p.z), view.row(p.y / p.z)));
    let (min, max) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
    let range = |min: f64, max: f64, n: usize| {
        // Samples are placed in 32 bits. With it the first may be the one after the whole part.
        let slack = 0.01 + 1e-6 * n as f64;
        floor_index(min - slack + 1.0, n)..floor_index(max + slack + 1.0, n)
    };
    [range(min.y, max.y, view.rows.len()), range(min.x, max.x, view.columns.len())]
}

impl Edge {
    fn new(of: DVec3) -> Self {
        // Of two triangles on both sides of an edge one has the opposite function, so that just one
        // of them owns it: the "top-left rule" in other words.
        let owner = of.x > 0.0 || (of.x == 0.0 && (of.y > 0.0 || (of.y == 0.0 && of.z > 0.0)));
        Self { of, inverse: -1.0 / of.x, owner }
    }

    /// Narrows a span of columns to those inside. The crossing is guessed, and then settled by the
    /// function itself: it is monotone in x, rounding included, and antisymmetric between neighbours.
    #[inline]
    fn narrow(&self, view: &View, y: f64, span: &mut Range<usize>) {
        let rest = self.of.y * y + self.of.z;
        let inside = |column: usize| {
            let e = self.of.x * view.columns[column] + rest;
            e > 0.0 || (e == 0.0 && self.owner)
        };
        let crossing = floor_index(view.column(rest * self.inverse) + 1.0, span.end).clamp(span.start, span.end);
        let mut at = crossing;
        if self.of.x > 0.0 {
            while at > span.start && inside(at - 1) {
                at -= 1;
            }
            while at < span.end && !inside(at) {
                at += 1;
            }
            span.start = at;
        } else if self.of.x < 0.0 {
            while at < span.end && inside(at) {
                at += 1;
            }
            while at > span.start && !inside(at - 1) {
                at -= 1;
            }
            span.end = at;
        } else if !(rest > 0.0 || (rest == 0.0 && self.owner)) {
            span.end = span.start;
        }
    }
}
