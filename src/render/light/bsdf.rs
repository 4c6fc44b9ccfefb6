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

/// The material seen from one direction: what depends on that alone is worked out once.
#[derive(Clone, Copy, Debug)]
pub struct Seen {
    of: Bsdf,
    to: Vec3,
    facets: Roughness,
    albedo: Albedo,
    /// How many times what metal and coat mirror once they mirror altogether.
    gains: [f32; 4],
    /// What of the body is seen through the coat.
    body: f32,
    /// What the coat leaves of light from everywhere, times pi.
    out: f32,
    /// How likely coat and metal, matt body and clear body are drawn.
    chances: [f32; 3],
}

/// Schlick's approximation (1994).
fn fresnel(f0: f32, cosine: f32) -> f32 {
    f0 + (1.0 - f0) * (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

impl Bsdf {
    /// As it is seen from a direction; nothing is seen from behind.
    pub fn seen(&self, to: Vec3) -> Option<Seen> {
        if to.z <= 0.0 {
            return None;
        }
        let Self { base, metallic, roughness, transmission, f0 } = *self;
        let albedo = Albedo::of(to.z, roughness);
        let coat = if f0 > 0.0 { albedo.share(f0) } else { 0.0 };
        let metal = if metallic > 0.0 { base.to_array().map(|f0| albedo.share(f0)) } else { [0.0; 3] };
        let body = (1.0 - metallic) * (1.0 - coat);
        let seen = body * base.max_element();
        let mirror = (1.0 - metallic) * coat + metallic * metal.into_iter().fold(0.0, f32::max);
        let all = [mirror, seen * (1.0 - transmission), seen * transmission];
        let sum = all.iter().sum::<f32>();
        let chances = if sum > 0.0 { all.map(|x| x / sum) } else { [0.0; 3] };
        let out = 1.0 - if f0 > 0.0 { Albedo::mean(roughness).share(f0) } else { 0.0 };
        let metals = if metallic > 0.0 { base.to_array().map(|f0| albedo.gain(f0)) } else { [1.0; 3] };
        let gains = [metals[0], metals[1], metals[2], albedo.gain(f0)];
        let facets = Roughness::new(roughness);
        Some(Seen { of: *self, to, facets, albedo, gains, body, out: out.max(1e-4) * PI, chances })
    }
}

impl Seen {
    /// The response to light that comes from a direction, times its cosine; and how densely [`Self::draw`] draws it.
    pub fn evaluate(&self, from: Vec3) -> (Vec3, f32) {
        let Bsdf { base, metallic, roughness, transmission, f0 } = self.of;
        let [mirror, matt, clear] = self.chances;
        if from.z == 0.0 {
            return (Vec3::ZERO, 0.0);
        }
        if from.z < 0.0 {
            if clear <= 0.0 {
                return (Vec3::ZERO, 0.0);
            }
            // Straight through, as rough as the coat: its mirror image on the other side.
            let image = Vec3::new(from.x, from.y, -from.z);
            let facets = self.facets.between(self.to, image);
            let lobe = facets.reflected / self.albedo.once().max(1e-4) * image.z;
            return (base * (self.body * transmission * lobe), clear * facets.density);
        }
        let facets = self.facets.between(self.to, from);
        let reflected = |f0: f32, gain: f32| if f0 > 0.0 { fresnel(f0, facets.cosine) * gain * facets.reflected } else { 0.0 };
        let mut response = Vec3::splat((1.0 - metallic) * reflected(f0, self.gains[3]));
        if metallic > 0.0 {
            let metal = Vec3::from_array([0, 1, 2].map(|k| reflected(base[k], self.gains[k])));
            response += metal * metallic;
        }
        if matt > 0.0 {
            // What the coat leaves to the body from here, and lets out there, over the mean: one direction for the other.
            let into = 1.0 - if f0 > 0.0 { Albedo::of(from.z, roughness).share(f0) } else { 0.0 };
            response += base * (self.body * (1.0 - transmission) * into / self.out);
        }
        (response * from.z, mirror * facets.density + matt * from.z / PI)
    }

    /// Draws a direction that light may come from; `None` where none does.
    pub fn draw(&self, which: f32, u: Vec2) -> Option<Drawn> {
        let [mirror, matt, _] = self.chances;
        let from = if which < mirror {
            mirrored(self.to, self.facets.sample(self.to, u))
        } else if which < mirror + matt {
            cosine_direction(Vec3::Z, u)
        } else {
            let image = mirrored(self.to, self.facets.sample(self.to, u));
            Vec3::new(image.x, image.y, -image.z)
        };
        // A facet may mirror light into the surface, or a clear body back out of it: that is lost.
        if (which < mirror + matt) != (from.z > 0.0) {
            return None;
        }
        let (response, density) = self.evaluate(from);
        (density > 0.0).then(|| Drawn { from, weight: response / density, density })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Numbers from 0 to below 1, the same everywhere.
    fn random(n: u32) -> impl Iterator<Item = [f32; 3]> {
        use crate::render::sampler::Random;
        (0..n).map(|i| {
            let (a, b) = (Random::new(i, 0, 0).pair(0), Random::new(i, 0, 0).pair(1));
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
            let share = bsdf
                .seen(to)
                .and_then(|seen| seen.draw(c, Vec2::new(a, b)))
                .map_or(0.0, |drawn| f64::from(drawn.weight.max_element()));
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
            let seen = bsdf.seen(to(0.6)).expect("from the front");
            const N: u32 = 1 << 15;
            let drawn = random(N).filter(|[a, b, c]| seen.draw(*c, Vec2::new(*a, *b)).is_some()).count();
            let sum: f64 = random(N)
                .map(|[a, b, _]| {
                    let (z, angle) = (2.0 * a - 1.0, std::f32::consts::TAU * b);
                    let sine = (1.0 - z * z).max(0.0).sqrt();
                    f64::from(seen.evaluate(Vec3::new(sine * angle.cos(), sine * angle.sin(), z)).1)
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
        let response = |to: Vec3, from: Vec3| bsdf.seen(to).expect("from the front").evaluate(from).0 / from.z;
        let (there, back) = (response(a, b), response(b, a));
        assert!((there - back).abs().max_element() < 1e-6 && (there.x - 0.5 / PI).abs() < 1e-6);
    }
}
