//! Light that is followed from the eye: at each surface a light is asked and a direction drawn, and what both find is weighed
//! by how densely each would have found it (Kajiya 1986; Veach 1997, section 9.2).

use glam::{Vec2, Vec3};

use super::bsdf::{Bsdf, Seen};
use super::sources::Sources;
use crate::accel::{self, Hit};
use crate::geometry::Ray;
use crate::geometry::num::{UNIT_ROUNDOFF, narrow};
use crate::render::sampler::Sampler;
use crate::render::shade::{Facing, facing, normal_at};
use crate::render::spawn::Point;
use crate::render::work::{Watch, Work};
use crate::render::{Job, Transport};
use crate::scene::{Finish, Finished};
use crate::task::{Cancel, Cancelled};

/// The sampler's first set; the one before is the pixel's.
const FIRST: u32 = 1;
/// Sets that each surface takes: for asking a source, and for going on.
const EACH: u32 = 2;

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
    /// Follows light back along the camera's rays, and adds what reaches the eye to their samples.
    pub(in crate::render) fn follow(
        &self,
        sources: &Sources,
        (mut rays, mut hits): (Vec<Ray>, Vec<Option<Hit>>),
        sampler: impl Fn(usize) -> Sampler,
        samples: &mut [[f32; 4]],
        (work, watch): (&mut Work, &mut Watch),
        cancel: &Cancel,
    ) -> Result<(), Cancelled> {
        let Transport { surfaces, certain, clamp } = self.transport;
        let mut paths: Vec<Path> = (0..rays.len()).map(|of| Path { of, share: Vec3::ONE, density: f32::INFINITY }).collect();
        // Beyond the last surface nothing is asked, but what its direction finds belongs to it.
        for surface in 0..=surfaces {
            // Light that was asked for here came over this surface, light that is found here only over those before.
            let (clamp_asked, clamp_found) = (clamp.filter(|_| surface > 0), clamp.filter(|_| surface > 1));
            let (mut asked, mut questions) = (Vec::new(), Vec::new());
            let (mut next_paths, mut next_rays) = (Vec::new(), Vec::new());
            for ((path, ray), hit) in paths.iter().zip(&rays).zip(&hits) {
                let Some(hit) = hit else {
                    // Behind the scene a picture is clear.
                    if surface > 0 {
                        let (radiance, found) = sources.far(ray.dir.normalize_or_zero());
                        let light = path.share * radiance * weight(path.density, found);
                        add(&mut samples[path.of], limited(light, clamp_found, work));
                    }
                    continue;
                };
                let at = Surface::of(self, ray, hit);
                if at.emission.max_element() > 0.0 {
                    let found = sources.density(at.material) * at.per_solid_angle;
                    let light = path.share * at.emission * weight(path.density, found);
                    add(&mut samples[path.of], limited(light, clamp_found, work));
                } else if surface == 0 {
                    add(&mut samples[path.of], Vec3::ZERO);
                }
                if surface == surfaces {
                    continue;
                }
                let (sampler, set) = (sampler(path.of), FIRST + surface * EACH);
                let [which, x, y, chance] = sampler.four(set);
                if let Some((light, question)) = at.ask(self, sources, which, Vec2::new(x, y)) {
                    asked.push(Asked { of: path.of, light: path.share * light });
                    questions.push(question);
                }
                let [which, x, y, _] = sampler.four(set + 1);
                if let Some((share, density, ray)) = at.go_on(self, which, Vec2::new(x, y)) {
                    let share = path.share * share;
                    let stays = if surface < certain { 1.0 } else { share.max_element().min(0.95) };
                    if chance < stays {
                        next_paths.push(Path { of: path.of, share: share / stays, density });
                        next_rays.push(ray);
                    }
                }
            }
            work.rays += (questions.len() + next_rays.len()) as u64;
            watch.lap(&mut work.shading);
            let mut blocked = vec![None; questions.len()];
            self.trace(&questions, accel::Mode::Any, &mut blocked, cancel)?;
            watch.lap(&mut work.tracing);
            for (asked, _) in asked.iter().zip(&blocked).filter(|(_, blocked)| blocked.is_none()) {
                add(&mut samples[asked.of], limited(asked.light, clamp_asked, work));
            }
            if next_rays.is_empty() {
                break;
            }
            (paths, rays) = (next_paths, next_rays);
            hits = vec![None; rays.len()];
            watch.lap(&mut work.shading);
            self.trace(&rays, accel::Mode::Closest, &mut hits, cancel)?;
            watch.lap(&mut work.tracing);
        }
        Ok(())
    }
}

/// Light of which no colour is more than that; what is taken away is counted.
fn limited(light: Vec3, most: Option<f32>, work: &mut Work) -> Vec3 {
    match most {
        Some(most) if light.max_element() > most => {
            let less = light * (most / light.max_element());
            work.clamped += 1;
            work.lost += f64::from((light - less).element_sum());
            less
        }
        _ => light,
    }
}

/// Adds light to a sample, which something is seen in.
fn add(sample: &mut [f32; 4], light: Vec3) {
    (0..3).for_each(|k| sample[k] += light[k]);
    sample[3] = 1.0;
}

/// A normal that an image bends: it says where the surface faces in terms of how the image lies on it.
fn bent(facing: Facing, bend: Vec3, [a, b, c]: &[Vec3; 3], [ua, ub, uc]: &[Vec2; 3]) -> Vec3 {
    let (e1, e2, d1, d2) = (*b - *a, *c - *a, *ub - *ua, *uc - *ua);
    let turn = d1.perp_dot(d2);
    let front = if facing.turned { -facing.normal } else { facing.normal };
    // Along u; the image's rows go down, what is up in it is against v.
    let (right, up) = ((e1 * d2.y - e2 * d1.y) * turn.signum(), (e1 * d2.x - e2 * d1.x) * turn.signum());
    let Some(right) = (right - front * front.dot(right)).try_normalize().filter(|_| turn != 0.0) else { return facing.normal };
    let across = front.cross(right);
    let across = if across.dot(up) < 0.0 { -across } else { across };
    let normal = (right * bend.x + across * bend.y + front * bend.z).normalize_or(front);
    if facing.turned { -normal } else { normal }
}

/// A point that a path meets.
struct Surface {
    point: Point,
    axes: [Vec3; 3],
    /// What is seen of it from where the path came.
    seen: Option<Seen>,
    material: Option<usize>,
    emission: Vec3,
    /// What a density over area is to be multiplied by to be one over solid angle, from where the path came.
    per_solid_angle: f32,
}

impl Surface {
    fn of(job: &Job, ray: &Ray, hit: &Hit) -> Self {
        let geometry = job.accel.geometry();
        let point = Point::of(geometry, ray, hit);
        let mesh = job.scene.instances[hit.instance as usize].mesh;
        let finish = Finish::new(&job.scene, mesh, job.looks.textures());
        let Finished { base, metallic, roughness, transmission, ior, emission, bend } = finish.at(hit.primitive, hit.u, hit.v);
        let normal = normal_at(job, ray, hit, &point);
        let normal = match bend.zip(finish.uvs(hit.primitive)) {
            Some((bend, uvs)) => bent(facing(job, hit, normal), bend, &geometry.corners_of(hit.instance, hit.primitive), &uvs),
            None => normal,
        };
        let (axes, dir) = (axes(normal), ray.dir.normalize_or_zero());
        let to = to_local(&axes, -dir);
        // Between the facets and the triangle a direction may lie: then it only grazes.
        let to = Vec3::new(to.x, to.y, to.z.max(1e-4)).normalize_or(Vec3::Z);
        let distance = narrow(f64::from(hit.t) * ray.dir.as_dvec3().length() * geometry.space().scale());
        let cosine = point.normal.dot(-dir).abs().max(UNIT_ROUNDOFF);
        let f0 = ((ior - 1.0) / (ior + 1.0)).powi(2);
        let bsdf = Bsdf { base: base.into(), metallic, roughness, transmission, f0 };
        let (material, per_solid_angle) = (job.scene.meshes[mesh].material, distance * distance / cosine);
        Self { point, axes, seen: bsdf.seen(to), material, emission: emission.into(), per_solid_angle }
    }

    /// Light that comes here from a source, and the ray that asks whether it does.
    fn ask(&self, job: &Job, sources: &Sources, which: f32, u: Vec2) -> Option<(Vec3, Ray)> {
        let geometry = job.accel.geometry();
        let seen = self.seen.as_ref()?;
        let incoming = sources.choose((&job.scene, geometry, job.looks.textures()), self.point.at, which, u)?;
        // What is hidden does not shine.
        if let (Some(visible), Some((instance, primitive))) = (&job.visible, incoming.triangle)
            && !visible.sees(geometry, instance, primitive)
        {
            return None;
        }
        // Light from behind is not asked for, also where the surface is clear: only its own directions find it.
        let from = to_local(&self.axes, incoming.dir);
        if self.point.normal.dot(incoming.dir) <= 0.0 || from.z <= 0.0 {
            return None;
        }
        let (response, drawn) = seen.evaluate(from);
        let alone = incoming.density.is_infinite();
        let light = response * incoming.light * if alone { 1.0 } else { weight(incoming.density, drawn) };
        if light.max_element() <= 0.0 || !light.is_finite() {
            return None;
        }
        let question = match incoming.from {
            Some(from) => self.point.segment_to(geometry, from),
            None => self.point.ray(geometry, incoming.dir),
        };
        Some((light, question))
    }

    /// Where light may come from otherwise: what of it goes on, how densely that is drawn, and the ray there.
    fn go_on(&self, job: &Job, which: f32, u: Vec2) -> Option<(Vec3, f32, Ray)> {
        let drawn = self.seen.as_ref()?.draw(which, u)?;
        let dir = to_world(&self.axes, drawn.from).try_normalize()?;
        let side = self.point.normal.dot(dir);
        if (drawn.from.z > 0.0) != (side > 0.0) || side == 0.0 {
            return None;
        }
        let point = if side > 0.0 { self.point } else { self.point.other_side() };
        // What is seen through it nobody asks for.
        let density = if side > 0.0 { drawn.density } else { f32::INFINITY };
        (drawn.weight.max_element() > 0.0).then(|| (drawn.weight, density, point.ray(job.accel.geometry(), dir)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn images_bend_normals_as_they_lie_on_the_surface() {
        // In the plane of x and y, seen from above; u to the right, and v down as rows of images go.
        let corners = [Vec3::ZERO, Vec3::X * 2.0, Vec3::Y * 3.0];
        let uvs = [Vec2::new(0.0, 1.0), Vec2::new(1.0, 1.0), Vec2::new(0.0, 0.0)];
        let front = Facing { normal: Vec3::Z, turned: false };
        let near = |a: Vec3, b: Vec3| assert!((a - b).length() < 1e-6, "{a} is not {b}");
        let (right, up) = (Vec3::new(0.6, 0.0, 0.8), Vec3::new(0.0, 0.6, 0.8));
        near(bent(front, Vec3::Z, &corners, &uvs), Vec3::Z);
        near(bent(front, right, &corners, &uvs), right);
        near(bent(front, up, &corners, &uvs), up);
        // A mirrored image leans the other way.
        let mirrored = uvs.map(|uv| Vec2::new(-uv.x, uv.y));
        near(bent(front, right, &corners, &mirrored), Vec3::new(-0.6, 0.0, 0.8));
        near(bent(front, up, &corners, &mirrored), up);
        // Seen from behind, the same surface is there: its normal turns, and where it leans stays in front.
        let back = Facing { normal: Vec3::NEG_Z, turned: true };
        near(bent(back, right, &corners, &uvs), -right);
        // Where the image has no extent there is nothing to lean along.
        near(bent(front, right, &corners, &[Vec2::ONE; 3]), Vec3::Z);
    }
}
