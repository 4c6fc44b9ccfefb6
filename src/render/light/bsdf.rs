//! What a surface does with light: a metal, or a rough dielectric coat over a matt or a thin clear body (glTF 2.0, appendix B;
//! KHR_materials_transmission). The body gets what the coat does not give back, in both directions, so that no light is gained
//! and a white body loses none (Kelemen and Szirmay-Kalos 2001; Kulla and Conty 2017).

use std::f32::consts::PI;

use glam::{Vec2, Vec3};

use super::albedo::Albedo;
use super::microfacet::{Roughness, mirrored};
use crate::render::sampler::cosine_direction;

/// The material at a point. Directions are of unit length and point away from it; the normal is z.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bsdf {
    /// Linear, 0 to 1.
    pub base: Vec3,
    /// 0 to 1.
    pub metallic: f32,
    /// As perceived, 0 to 1.
    pub roughness: f32,
    /// The share of the body that is clear, 0 to 1.
    pub transmission: f32,
    /// What the coat reflects head on.
    pub f0: f32,
}

/// A direction that light was followed to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drawn {
    /// Where it came from.
    pub from: Vec3,
    /// What of it goes on: the response times the cosine, over how densely directions are drawn.
    pub weight: Vec3,
    /// That, over solid angle.
    pub density: f32,
}

/// What depends on the direction that light goes to alone.
#[derive(Clone, Copy, Debug)]
struct Shares {
    facets: Roughness,
    albedo: Albedo,
    coat: f32,
    /// How likely coat and metal, matt body and clear body are drawn.
    chances: [f32; 3],
}

/// Schlick's approximation (1994).
fn fresnel(f0: f32, cosine: f32) -> f32 {
    f0 + (1.0 - f0) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

impl Bsdf {
    fn shares(&self, to: Vec3) -> Shares {
        let albedo = Albedo::of(to.z, self.roughness);
        let coat = if self.f0 > 0.0 { albedo.share(self.f0) } else { 0.0 };
        let metal = self.base.to_array().map(|f0| albedo.share(f0));
        let body = (1.0 - self.metallic) * (1.0 - coat) * self.base.max_element();
        let mirror = (1.0 - self.metallic) * coat + self.metallic * metal.into_iter().fold(0.0, f32::max);
        let all = [mirror, body * (1.0 - self.transmission), body * self.transmission];
        let sum = all.iter().sum::<f32>();
        let chances = if sum > 0.0 { all.map(|x| x / sum) } else { [0.0; 3] };
        Shares { facets: Roughness::new(self.roughness), albedo, coat, chances }
    }

    /// The response to light that comes from one direction and goes to another, times the cosine of the first; and how
    /// densely [`Self::draw`] draws it.
    pub fn evaluate(&self, to: Vec3, from: Vec3) -> (Vec3, f32) {
        if to.z <= 0.0 { (Vec3::ZERO, 0.0) } else { self.respond(to, from, &self.shares(to)) }
    }

    fn respond(&self, to: Vec3, from: Vec3, shares: &Shares) -> (Vec3, f32) {
        let [mirror, matt, clear] = shares.chances;
        let body = (1.0 - self.metallic) * (1.0 - shares.coat);
        if from.z < 0.0 {
            // Straight through, as rough as the coat: its mirror image on the other side.
            let image = Vec3::new(from.x, from.y, -from.z);
            let lobe = shares.facets.reflected(to, image) / shares.albedo.once().max(1e-4) * image.z;
            return (self.base * (body * self.transmission * lobe), clear * shares.facets.density(to, image));
        }
        if from.z == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        let half = (to + from).normalize_or_zero();
        let (lobe, cosine) = (shares.facets.reflected(to, from), to.dot(half));
        let reflected = |f0: f32| if f0 > 0.0 { fresnel(f0, cosine) * shares.albedo.gain(f0) * lobe } else { 0.0 };
        let metal = Vec3::from_array(self.base.to_array().map(reflected));
        let mirrored = metal * self.metallic + Vec3::splat((1.0 - self.metallic) * reflected(self.f0));
        // What the coat leaves to the body from here, and lets out there, over the mean: one direction for the other.
        let into = 1.0 - if self.f0 > 0.0 { Albedo::of(from.z, self.roughness).share(self.f0) } else { 0.0 };
        let out = 1.0 - if self.f0 > 0.0 { Albedo::mean(self.roughness).share(self.f0) } else { 0.0 };
        let matt_body = self.base * (body * (1.0 - self.transmission) * into / (out.max(1e-4) * PI));
        let density = mirror * shares.facets.density(to, from) + matt * from.z / PI;
        ((mirrored + matt_body) * from.z, density)
    }

    /// Draws a direction that light may come from; `None` where none does.
    pub fn draw(&self, to: Vec3, which: f32, u: Vec2) -> Option<Drawn> {
        if to.z <= 0.0 {
            return None;
        }
        let shares = self.shares(to);
        let [mirror, matt, _] = shares.chances;
        let from = if which < mirror {
            mirrored(to, shares.facets.sample(to, u))
        } else if which < mirror + matt {
            cosine_direction(Vec3::Z, u)
        } else {
            let image = mirrored(to, shares.facets.sample(to, u));
            Vec3::new(image.x, image.y, -image.z)
        };
        // A facet may mirror light into the surface, or a clear body back out of it: that is lost.
        if (which < mirror + matt) != (from.z > 0.0) {
            return None;
        }
        let (response, density) = self.respond(to, from, &shares);
        (density > 0.0).then(|| Drawn { from, weight: response / density, density })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to below 1, the same everywhere.
    fn random(n: u32) -> impl Iterator<Item = [f32; 3]> {
        use crate::render::sampler::Sampler;
        (0..n).map(|i| {
            let (a, b) = (Sampler::new(i, 0, 0).pair(0), Sampler::new(i, 0, 0).pair(1));
            [a.x, a.y, b.x]
        })
    }

    fn to(cosine: f32) -> Vec3 {
        Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine)
    }

    /// The share of an evenly bright surrounding that comes back, and its standard error.
    fn furnace(bsdf: &Bsdf, to: Vec3) -> (f32, f32) {
        const N: u32 = 1 << 14;
        let (mut sum, mut squares) = (0.0f64, 0.0f64);
        for [a, b, c] in random(N) {
            let share = bsdf.draw(to, c, Vec2::new(a, b)).map_or(0.0, |drawn| f64::from(drawn.weight.max_element()));
            (sum, squares) = (sum + share, squares + share * share);
        }
        let (n, mean) = (f64::from(N), sum / f64::from(N));
        (mean as f32, ((squares / n - mean * mean).max(0.0) / n).sqrt() as f32)
    }

    #[test]
    fn in_a_white_furnace_nothing_white_is_seen_at_any_roughness() {
        for metallic in [0.0, 0.4, 1.0] {
            for transmission in [0.0, 0.5, 1.0] {
                for tenth in 0..=10u8 {
                    for cosine in [0.05, 0.3, 0.7, 1.0] {
                        let roughness = f32::from(tenth) * 0.1;
                        let bsdf = Bsdf { base: Vec3::ONE, metallic, roughness, transmission, f0: 0.04 };
                        let (share, error) = furnace(&bsdf, to(cosine));
                        assert!((share - 1.0).abs() < 0.01 + 4.0 * error, "{bsdf:?} at {cosine}: {share} ±{error}");
                    }
                }
            }
        }
    }

    #[test]
    fn no_light_is_gained() {
        for [a, b, c] in random(60) {
            let bsdf = Bsdf { base: Vec3::splat(a), metallic: b, roughness: c, transmission: (a + b) % 1.0, f0: 0.08 * c };
            for cosine in [0.02, 0.5, 1.0] {
                let (share, error) = furnace(&bsdf, to(cosine));
                assert!(share <= 1.01 + 4.0 * error, "{bsdf:?}: {share} ±{error}");
            }
        }
    }

    #[test]
    fn the_density_is_that_of_what_is_drawn() {
        // Over all directions it sums to the share of draws that come to something.
        for (metallic, roughness, transmission) in [(0.0, 0.5, 0.0), (1.0, 0.4, 0.0), (0.0, 0.8, 0.7), (0.3, 1.0, 0.2)] {
            let bsdf = Bsdf { base: Vec3::new(0.9, 0.5, 0.2), metallic, roughness, transmission, f0: 0.04 };
            let to = to(0.6);
            const N: u32 = 1 << 15;
            let drawn = random(N).filter(|[a, b, c]| bsdf.draw(to, *c, Vec2::new(*a, *b)).is_some()).count();
            let sum: f64 = random(N)
                .map(|[a, b, _]| {
                    let (z, angle) = (2.0 * a - 1.0, std::f32::consts::TAU * b);
                    let sine = (1.0 - z * z).max(0.0).sqrt();
                    f64::from(bsdf.evaluate(to, Vec3::new(sine * angle.cos(), sine * angle.sin(), z)).1)
                })
                .sum();
            let (share, sum) = (drawn as f64 / f64::from(N), sum / f64::from(N) * 4.0 * std::f64::consts::PI);
            assert!((share - sum).abs() < 0.03, "{bsdf:?}: {share} are drawn, {sum} said");
        }
    }

    #[test]
    fn a_matt_body_answers_alike_both_ways() {
        let bsdf = Bsdf { base: Vec3::splat(0.5), metallic: 0.0, roughness: 1.0, transmission: 0.0, f0: 0.0 };
        let (a, b) = (to(0.3), Vec3::new(-0.6, 0.0, 0.8));
        let (there, back) = (bsdf.evaluate(a, b).0 / b.z, bsdf.evaluate(b, a).0 / a.z);
        assert!((there - back).abs().max_element() < 1e-6 && (there.x - 0.5 / PI).abs() < 1e-6);
    }
}
