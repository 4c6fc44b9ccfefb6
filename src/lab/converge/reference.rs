//! The picture that others are measured against, and how sure it is.

use std::hash::{DefaultHasher, Hash, Hasher};

use serde::Serialize;

use crate::geometry::HalfSpace;
use crate::lab::rms_difference;
use crate::render::light::Surroundings;
use crate::render::sampler::{SamplerKind, Sampling};
use crate::render::{Film, Job, LinearPicture};
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// A reference: the mean of two pictures of different seeds.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// Linear red, green and blue, row by row.
    pub pixels: Vec<[f32; 3]>,
    /// What is said of it.
    pub facts: ReferenceFacts,
}

/// What a reference is of.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct ReferenceFacts {
    /// Columns and rows.
    pub size: [u32; 2],
    /// Samples in each pixel, of both halves together.
    pub spp: u32,
    /// The seed of its first half; the second has the next.
    pub seed: u32,
    /// Of what is rendered: the scene, its lights, the camera, how far light is followed.
    pub scene_hash: u64,
    /// Its own error, estimated: the root mean squared difference of its halves, divided by 2.
    pub noise: f64,
}

/// RMSE has to be so many times the reference's noise.
const SURE: f64 = 4.0;

/// Numbers that no measured picture is made of: the reference has to be independent of them.
pub const SEED: u32 = 0x0BEE_F000;

impl Reference {
    /// Renders one of at least so many samples, half of them with each seed.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn render(
        job: &Job,
        [width, height]: [u32; 2],
        spp: u32,
        (pool, cancel, progress): (&Pool, &Cancel, &Progress),
    ) -> Result<Self, Cancelled> {
        let each = spp.div_ceil(2).max(1);
        progress.start("reference", u64::from(each) * 2);
        let half = |seed: u32| {
            let job = Job { sampling: Sampling { kind: SamplerKind::Sobol, seed }, ..job.clone() };
            let mut film = Film::new(width, height);
            for _ in 0..each {
                job.pass(&mut film, pool, cancel)?;
                progress.advance(1);
            }
            Ok(film.linear())
        };
        let (a, b) = (half(SEED)?, half(SEED + 1)?);
        let noise = rms_difference(&a, &b) * 0.5;
        let mean = |(a, b): (&[f32; 3], &[f32; 3])| std::array::from_fn(|k| 0.5 * (a[k] + b[k]));
        let facts =
            ReferenceFacts { size: [width, height], spp: each * 2, seed: SEED, scene_hash: hash_of(job, [width, height]), noise };
        Ok(Self { pixels: a.iter().zip(&b).map(mean).collect(), facts })
    }

    /// Whether it is too noisy itself to measure an error like that.
    pub fn is_hollow(&self, rmse: f64) -> bool {
        rmse < SURE * self.facts.noise
    }

    /// For a file.
    pub fn to_picture(&self) -> LinearPicture {
        let ReferenceFacts { size: [width, height], spp, seed, scene_hash, noise } = self.facts;
        let notes = [
            ("spp", spp.to_string()),
            ("seed", seed.to_string()),
            ("scene-hash", format!("{scene_hash:016x}")),
            ("noise", format!("{noise:e}")),
        ];
        let notes = notes.map(|(name, value)| (name.to_owned(), value)).into();
        LinearPicture { width, height, pixels: self.pixels.clone(), notes }
    }

    /// From a file that [`Self::to_picture`] went into; `None` if it says not what it is of.
    pub fn from_picture(picture: LinearPicture) -> Option<Self> {
        let facts = ReferenceFacts {
            size: [picture.width, picture.height],
            spp: picture.note("spp")?.parse().ok()?,
            seed: picture.note("seed")?.parse().ok()?,
            scene_hash: u64::from_str_radix(picture.note("scene-hash")?, 16).ok()?,
            noise: picture.note("noise")?.parse().ok()?,
        };
        Some(Self { pixels: picture.pixels, facts })
    }

    /// Whether pictures of that seed would be made of the same samples as references are.
    pub const fn has_samples_of(seed: u32) -> bool {
        seed == SEED || seed == SEED + 1
    }

    /// Whether it will do for pictures of that job and size and at most so many samples. None does where triangles are hidden:
    /// which they are is not hashed.
    pub fn suits(&self, job: &Job, size: [u32; 2], spp: u32) -> bool {
        let enough = self.facts.size == size && self.facts.spp >= spp && self.facts.seed == SEED;
        enough && job.visible.is_none() && self.facts.scene_hash == hash_of(job, size)
    }
}

/// Grows whenever light is followed otherwise, or more is hashed, so that references of before are made anew.
const VERSION: u32 = 2;

/// A number for everything that a path traced picture depends on but its samples; of hidden triangles, that there are some.
pub fn hash_of(job: &Job, size: [u32; 2]) -> u64 {
    let mut hasher = DefaultHasher::new();
    // Samples, and what other modes show, are no part of it.
    let Job { scene, accel, camera, mode: _, looks, sampling: _, transport, section, heat_rays: _, visible } = job;
    let geometry = accel.geometry();
    let floats = |hasher: &mut DefaultHasher, floats: &[f32]| floats.iter().for_each(|x| x.to_bits().hash(hasher));
    let mut known = vec![false; scene.meshes.len()];
    for (number, instance) in (0u32..).zip(&scene.instances) {
        instance.mesh.hash(&mut hasher);
        floats(&mut hasher, &instance.world_from_object.to_cols_array());
        if std::mem::replace(&mut known[instance.mesh], true) {
            continue;
        }
        let mesh = &scene.meshes[instance.mesh];
        for primitive in 0..geometry.count_of(number) {
            let corners = geometry.corners_of(number, crate::geometry::num::index(primitive));
            corners.iter().for_each(|corner| floats(&mut hasher, &corner.to_array()));
        }
        mesh.triangles.hash(&mut hasher);
        mesh.normals.iter().for_each(|normal| floats(&mut hasher, &normal.to_array()));
        mesh.uvs.iter().for_each(|uv| floats(&mut hasher, &uv.to_array()));
        mesh.colors.iter().for_each(|color| floats(&mut hasher, color));
        mesh.material.hash(&mut hasher);
    }
    for texture in (0..scene.images.len()).filter_map(|image| looks.textures().get(image)) {
        (texture.size(), texture.texels()).hash(&mut hasher);
    }
    let surroundings = looks.surroundings();
    if let Surroundings::Image { image, .. } = surroundings {
        image.texels().iter().for_each(|texel| floats(&mut hasher, texel));
    }
    section.map(|HalfSpace { axis, at, side }| (axis, at.to_bits(), side)).hash(&mut hasher);
    visible.is_some().hash(&mut hasher);
    // What has no bits of its own is told as text.
    let (materials, lights, around) = (&scene.materials, &scene.lights, surroundings.describe());
    format!("{VERSION} {materials:?} {lights:?} {:?} {camera:?} {transport:?} {size:?} {around}", scene.up).hash(&mut hasher);
    hasher.finish()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reference_says_what_it_is_of_in_its_file() {
        let facts = ReferenceFacts { size: [2, 1], spp: 4096, seed: SEED, scene_hash: 0xFEED_0000_0000_0001, noise: 1.25e-4 };
        let reference = Reference { pixels: vec![[1.0, 2.0, 3.0], [0.0; 3]], facts };
        let mut picture = reference.to_picture();
        assert_eq!(Reference::from_picture(picture.clone()), Some(reference));
        picture.notes.retain(|(name, _)| name != "spp");
        assert_eq!(Reference::from_picture(picture), None);
    }
}
