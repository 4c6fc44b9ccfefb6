//! Rough mirrors: the facets of Trowbridge and Reitz (1975), seen from one side (Smith 1967; Walter et al. 2007; Heitz 2014).
//! Directions are of unit length and point away from the surface, whose normal is z.

use std::f32::consts::{PI, TAU};

use glam::{Vec2, Vec3};

/// How rough a surface is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Roughness(f32);

/// Smoother than this is as good as a mirror; 32 bits hold no smaller facets' square.
const SMOOTHEST: f32 = 1e-3;

impl Roughness {
    /// From a material's roughness, 0 to 1, which is the square root of the facets' (Burley 2012).
    pub fn new(perceived: f32) -> Self {
        Self((perceived * perceived).clamp(SMOOTHEST, 1.0))
    }

    /// How many facets face a direction.
    pub fn facets(self, half: Vec3) -> f32 {
        let a = self.0 * self.0;
        let d = half.z * half.z * (a - 1.0) + 1.0;
        a / (PI * d * d)
    }

    fn hidden(self, to: Vec3) -> f32 {
        let cosine = to.z * to.z;
        let tangent = (1.0 - cosine).max(0.0) / cosine.max(1e-12);
        0.5 * ((1.0 + self.0 * self.0 * tangent).sqrt() - 1.0)
    }

    /// The share of facets that are seen from a direction.
    pub fn masking(self, to: Vec3) -> f32 {
        1.0 / (1.0 + self.hidden(to))
    }

    /// That of those that are seen from both.
    pub fn masking_of_both(self, to: Vec3, from: Vec3) -> f32 {
        1.0 / (1.0 + self.hidden(to) + self.hidden(from))
    }

    /// What facets do between two directions.
    pub fn between(self, to: Vec3, from: Vec3) -> Between {
        let half = (to + from).normalize_or_zero();
        let (facets, hidden) = (self.facets(half), self.hidden(to));
        let masking_of_both = 1.0 / (1.0 + hidden + self.hidden(from));
        Between {
            reflected: facets * masking_of_both / (4.0 * to.z * from.z).max(1e-12),
            density: facets / ((1.0 + hidden) * (4.0 * to.z).max(1e-12)),
            cosine: to.dot(half),
        }
    }

    /// The normal of a facet, drawn from those that are seen from `to` (Dupuy and Benyoub 2023).
    pub fn sample(self, to: Vec3, u: Vec2) -> Vec3 {
        let stretched = Vec3::new(self.0 * to.x, self.0 * to.y, to.z).normalize_or(Vec3::Z);
        let z = (1.0 - u.y) * (1.0 + stretched.z) - stretched.z;
        let (sine, angle) = ((1.0 - z * z).max(0.0).sqrt(), TAU * u.x);
        let facet = Vec3::new(sine * angle.cos(), sine * angle.sin(), z) + stretched;
        Vec3::new(self.0 * facet.x, self.0 * facet.y, facet.z.max(0.0)).normalize_or(Vec3::Z)
    }
}

/// What the facets of a mirror do with light that comes from one direction and goes to another.
#[derive(Clone, Copy, Debug)]
pub struct Between {
    /// What they reflect, without Fresnel's share.
    pub reflected: f32,
    /// How densely [`mirrored`] directions of facets that are drawn are, over solid angle.
    pub density: f32,
    /// The cosine between either direction and the facets that mirror one to the other.
    pub cosine: f32,
}

/// The direction that a facet mirrors another to.
pub fn mirrored(to: Vec3, half: Vec3) -> Vec3 {
    2.0 * to.dot(half) * half - to
}
