//! Light that is followed from the eye: at each surface a light is asked and a direction drawn, and what both find is weighed
//! by how densely each would have found it (Kajiya 1986; Veach 1997, section 9.2).

use glam::{Vec2, Vec3};

use super::bsdf::Bsdf;
use super::sources::Sources;
use crate::accel::{self, Hit};
use crate::geometry::Ray;
use crate::geometry::num::UNIT_ROUNDOFF;
use crate::render::Job;
use crate::render::sampler::Sampler;
use crate::render::shade::shading_normal;
use crate::render::spawn::Point;
use crate::scene::{Material, coverage};
use crate::task::{Cancel, Cancelled};

/// Surfaces that a path meets at most.
const LONGEST: u32 = 12;
/// Surfaces before a path may end by chance.
const CERTAIN: u32 = 3;
/// The sampler's first dimension; those before are the pixel's, and of other uses.
const FIRST: u32 = 8;
/// Dimensions that each surface takes.
const EACH: u32 = 4;

/// A path on its way.
#[derive(Clone, Copy)]
struct Path {
    /// Which of the camera's rays it began with.
    of: usize,
    /// What of the light that it meets goes on to the eye.
    share: Vec3,
    /// How densely its last direction was drawn, over solid angle; infinite for the eye's.
    density: f32,
}

/// Light from a source, if nothing is in between.
struct Asked {
    of: usize,
    light: Vec3,
}

/// The weight of one of two ways to find the same light (the power heuristic, Veach 1997, equation 9.13).
fn weight(own: f32, other: f32) -> f32 {
    if own.is_infinite() {
        return 1.0;
    }
    let ratio = other / own;
    1.0 / (1.0 + ratio * ratio)
}

/// Axes around a normal: the first two, of any direction about it.
fn axes(normal: Vec3) -> [Vec3; 3] {
    let (x, y) = normal.any_orthonormal_pair();
    [x, y, normal]
}

fn to_local([x, y, z]: &[Vec3; 3], v: Vec3) -> Vec3 {
    Vec3::new(v.dot(*x), v.dot(*y), v.dot(*z))
}

fn to_world([x, y, z]: &[Vec3; 3], v: Vec3) -> Vec3 {
    *x * v.x + *y * v.y + *z * v.z
}

impl Job {
    /// Follows light back along rays, and adds what reaches the eye to their samples. Returns how many rays that took.
    pub(in crate::render) fn follow(
        &self,
        sources: &Sources,
        mut rays: Vec<Ray>,
        first_hits: Vec<Option<Hit>>,
        sampler: impl Fn(usize) -> Sampler,
        samples: &mut [[f32; 4]],
        cancel: &Cancel,
    ) -> Result<u64, Cancelled> {
        let mut paths: Vec<Path> = (0..rays.len()).map(|of| Path { of, share: Vec3::ONE, density: f32::INFINITY }).collect();
        let (mut hits, mut traced) = (first_hits, 0);
        for surface in 0..LONGEST {
            let (mut asked, mut questions) = (Vec::new(), Vec::new());
            let (mut next_paths, mut next_rays) = (Vec::new(), Vec::new());
            for ((path, ray), hit) in paths.iter().zip(&rays).zip(&hits) {
                let Some(hit) = hit else {
                    // Behind the scene a picture is clear.
                    if let Some(sky) = sources.above().filter(|_| surface > 0) {
                        add(&mut samples[path.of], path.share * sky.radiance(ray.dir.normalize_or_zero(), self.scene.up));
                    }
                    continue;
                };
                let at = Surface::of(self, ray, hit);
                if at.emission.max_element() > 0.0 {
                    let found = sources.density(at.emission) * at.per_solid_angle;
                    add(&mut samples[path.of], path.share * at.emission * weight(path.density, found));
                } else if surface == 0 {
                    add(&mut samples[path.of], Vec3::ZERO);
                }
                let (sampler, dimension) = (sampler(path.of), FIRST + surface * EACH);
                if let Some((light, question)) = at.ask(self, sources, sampler.pair(dimension), sampler.pair(dimension + 1)) {
                    asked.push(Asked { of: path.of, light: path.share * light });
                    questions.push(question);
                }
                let chances = sampler.pair(dimension + 2);
                if let Some((share, density, ray)) = at.go_on(self, chances.x, sampler.pair(dimension + 3)) {
                    let share = path.share * share;
                    let stays = if surface < CERTAIN { 1.0 } else { share.max_element().min(0.95) };
                    if chances.y < stays {
                        next_paths.push(Path { of: path.of, share: share / stays, density });
                        next_rays.push(ray);
                    }
                }
            }
            let mut blocked = vec![None; questions.len()];
            self.trace(&questions, accel::Mode::Any, &mut blocked, cancel)?;
            for (asked, _) in asked.iter().zip(&blocked).filter(|(_, blocked)| blocked.is_none()) {
                add(&mut samples[asked.of], asked.light);
            }
            traced += (questions.len() + next_rays.len()) as u64;
            if next_rays.is_empty() {
                break;
            }
            (paths, rays) = (next_paths, next_rays);
            hits = vec![None; rays.len()];
            self.trace(&rays, accel::Mode::Closest, &mut hits, cancel)?;
        }
        Ok(traced)
    }
}

/// Adds light to a sample, which something is seen in.
fn add(sample: &mut [f32; 4], light: Vec3) {
    (0..3).for_each(|k| sample[k] += light[k]);
    sample[3] = 1.0;
}

/// A point that a path meets.
struct Surface {
    point: Point,
    axes: [Vec3; 3],
    /// To where the path came from.
    to: Vec3,
    bsdf: Bsdf,
    emission: Vec3,
    /// What a density over area is to be multiplied by to be one over solid angle, from where the path came.
    per_solid_angle: f32,
}

impl Surface {
    fn of(job: &Job, ray: &Ray, hit: &Hit) -> Self {
        static PLAIN: Material = Material::PLAIN;
        let geometry = job.accel.geometry();
        let point = Point::of(geometry, ray, hit);
        let instance = &job.scene.instances[hit.instance as usize];
        let material = job.scene.meshes[instance.mesh].material.and_then(|m| job.scene.materials.get(m)).unwrap_or(&PLAIN);
        let surface = coverage::Surface::new(&job.scene, instance.mesh, job.looks.textures());
        let base = Vec3::from_array(surface.color::<true, true>(hit.primitive, hit.u, hit.v)).clamp(Vec3::ZERO, Vec3::ONE);
        let axes = axes(shading_normal(job, ray, hit));
        let dir = ray.dir.normalize_or_zero();
        let to = to_local(&axes, -dir);
        // Between the facets and the triangle a direction may lie: then it only grazes.
        let to = Vec3::new(to.x, to.y, to.z.max(1e-4)).normalize_or(Vec3::Z);
        let distance = crate::geometry::num::narrow(f64::from(hit.t) * ray.dir.as_dvec3().length() * geometry.space().scale());
        let cosine = point.normal.dot(-dir).abs().max(UNIT_ROUNDOFF);
        let Material { metallic, roughness, transmission, ior, emission, .. } = *material;
        let f0 = ((ior - 1.0) / (ior + 1.0)).powi(2);
        let bsdf = Bsdf { base, metallic, roughness, transmission, f0 };
        Self { point, axes, to, bsdf, emission: emission.into(), per_solid_angle: distance * distance / cosine }
    }

    /// Light that comes here from a source, and the ray that asks whether it does.
    fn ask(&self, job: &Job, sources: &Sources, which: Vec2, u: Vec2) -> Option<(Vec3, Ray)> {
        let geometry = job.accel.geometry();
        let chosen = sources.choose(geometry, which.x, u)?;
        let away = chosen.at - self.point.at;
        let distance = away.length();
        let dir = away / distance;
        let cosine = chosen.normal.dot(dir).abs();
        // Light that the triangle itself is turned away from does not pass through it.
        if !dir.is_finite() || cosine < UNIT_ROUNDOFF || self.point.normal.dot(dir) <= 0.0 {
            return None;
        }
        let (response, drawn) = self.bsdf.evaluate(self.to, to_local(&self.axes, dir));
        let density = chosen.density * distance * distance / cosine;
        let light = response * chosen.radiance * (weight(density, drawn) / density);
        if light.max_element() <= 0.0 || !light.is_finite() {
            return None;
        }
        Some((light, self.point.segment_to(geometry, geometry.space().world_point(chosen.at))))
    }

    /// Where light may come from otherwise: what of it goes on, how densely that is drawn, and the ray there.
    fn go_on(&self, job: &Job, which: f32, u: Vec2) -> Option<(Vec3, f32, Ray)> {
        let drawn = self.bsdf.draw(self.to, which, u)?;
        let dir = to_world(&self.axes, drawn.from).try_normalize()?;
        let side = self.point.normal.dot(dir);
        if (drawn.from.z > 0.0) != (side > 0.0) || side == 0.0 {
            return None;
        }
        let point = if side > 0.0 { self.point } else { self.point.other_side() };
        (drawn.weight.max_element() > 0.0).then(|| (drawn.weight, drawn.density, point.ray(job.accel.geometry(), dir)))
    }
}
