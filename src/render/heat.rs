//! Whose work a heat map shows: that of the camera's rays, or of rays that leave what they meet.

use super::sampler::Sampler;
use super::spawn::{BOUNCE, Point, light_beside};
use super::tile::Job;
use crate::accel::{self, Hit};
use crate::geometry::Ray;
use crate::task::{Cancel, Cancelled};

/// The rays whose work a heat map shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum HeatRays {
    /// The camera's.
    #[default]
    Primary,
    /// From each primary hit to a point light beside the camera.
    Shadow,
    /// From each primary hit in a random direction about the normal.
    Bounce,
}

impl HeatRays {
    /// All of them, in the order of menus.
    pub const ALL: [Self; 3] = [Self::Primary, Self::Shadow, Self::Bounce];

    /// The name used on the command line and in files.
    pub const fn id(self) -> &'static str {
        match self {
            Self::Primary => "primary",
            Self::Shadow => "shadow",
            Self::Bounce => "bounce",
        }
    }

    /// The name in menus, after that of the amount.
    pub const fn label(self) -> &'static str {
        match self {
            Self::Primary => "of camera rays",
            Self::Shadow => "of shadow rays",
            Self::Bounce => "of bounces",
        }
    }

    /// One of them, after an amount: `Nodes visited a ray`.
    pub const fn each(self) -> &'static str {
        match self {
            Self::Primary => "a ray",
            Self::Shadow => "a shadow ray",
            Self::Bounce => "a bounce",
        }
    }

    /// One sentence for the user.
    pub const fn help(self) -> &'static str {
        match self {
            Self::Primary => "The ray from the camera through each pixel, to the closest hit.",
            Self::Shadow => "The ray from what each pixel shows to a point light beside the camera: any hit will do.",
            Self::Bounce => "A ray from what each pixel shows in a random direction about the normal, to the closest hit.",
        }
    }

    /// What is asked of them.
    pub const fn mode(self) -> accel::Mode {
        match self {
            Self::Primary | Self::Bounce => accel::Mode::Closest,
            Self::Shadow => accel::Mode::Any,
        }
    }
}

impl std::str::FromStr for HeatRays {
    type Err = String;

    fn from_str(s: &str) -> Result<Self, String> {
        let known = Self::ALL.into_iter().find(|rays| rays.id() == s);
        known.ok_or_else(|| format!("there are no rays '{s}': use primary, shadow or bounce"))
    }
}

impl Job {
    /// The rays whose work is shown of some pixels (column and row) of a picture, of its first sample: fewer than pixels where
    /// camera rays meet nothing that others could leave.
    ///
    /// # Errors
    /// [`Cancelled`] if asked to stop.
    pub fn heat_rays_of(
        &self,
        pixels: impl Iterator<Item = (u32, u32)> + Clone,
        size: [u32; 2],
        cancel: &Cancel,
    ) -> Result<Vec<Ray>, Cancelled> {
        let rays = self.rays_of(pixels.clone(), size, 0);
        if self.heat_rays == HeatRays::Primary {
            return Ok(rays);
        }
        let mut hits = vec![None; rays.len()];
        self.accel.trace(&rays, accel::Mode::Closest, &mut hits, cancel)?;
        let met = rays.iter().zip(&hits).zip(pixels);
        let leave = |((ray, hit), (x, y)): ((&Ray, &Option<Hit>), (u32, u32))| {
            Some(self.leaving(ray, hit.as_ref()?, &self.sampling.of(x, y, 0)))
        };
        Ok(met.filter_map(leave).collect())
    }

    /// The ray that [`Self::heat_rays`] stands for, where a camera ray hit something.
    pub(super) fn leaving(&self, ray: &Ray, hit: &Hit, sampler: &Sampler) -> Ray {
        let geometry = self.accel.geometry();
        match self.heat_rays {
            HeatRays::Primary => *ray,
            HeatRays::Shadow => Point::of(geometry, ray, hit).segment_to(geometry, light_beside(&self.camera)),
            HeatRays::Bounce => Point::of(geometry, ray, hit).bounce(geometry, sampler.pair(BOUNCE)),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_read_back() {
        for rays in HeatRays::ALL {
            assert_eq!(rays.id().parse(), Ok(rays));
        }
        assert!("diffuse".parse::<HeatRays>().is_err_and(|why| why.contains("bounce")));
    }
}
