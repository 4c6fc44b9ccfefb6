//! Rays in NumPy files, written and read; what is in them is told apart by [`crate::lab::ray_file::npy`].

use std::io::{self, Write};
use std::path::Path;

use npyz::WriterBuilder;

use super::failure::Failure;
use crate::geometry::Ray;
use crate::lab::ray_file::{RayFileError, npy, read};
use crate::task::{Budget, Cancel, Charge};

/// Numbers in a row.
const COLUMNS: usize = 8;

/// Writes rays as float32.
pub fn write_rays(rays: &[Ray], out: &mut impl Write) -> io::Result<()> {
    let shape = [rays.len() as u64, COLUMNS as u64];
    let mut writer = npyz::WriteOptions::<f32>::new().default_dtype().shape(&shape).writer(out).begin_nd()?;
    for ray in rays {
        writer.extend(bytemuck::cast::<Ray, [f32; COLUMNS]>(*ray))?;
    }
    writer.finish()
}

/// Reads rays from a file of float32 or float64, of either byte and row order. The charge is held as
/// long as the rays are.
pub fn read_rays(path: &Path, budget: &Budget, cancel: &Cancel) -> Result<(Vec<Ray>, Charge), Failure> {
    let failed = |error: RayFileError| -> Failure {
        match error {
            RayFileError::Cancelled(cancelled) => cancelled.into(),
            RayFileError::Memory(over) => over.into(),
            RayFileError::Wrong(why) => Failure::of_input(path, why),
        }
    };
    let (bytes, memory) = read(path, budget, cancel).map_err(failed)?;
    Ok((npy::parse(&bytes, usize::MAX, cancel).map_err(failed)?, memory))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn rays_come_back_as_they_were_written() {
        let ray = |i: u8| Ray { tmax: f32::INFINITY, tmin: 0.5, ..Ray::new(Vec3::splat(f32::from(i)), Vec3::new(1.0, 2.0, 3.0)) };
        let rays: Vec<Ray> = (0..5).map(ray).collect();
        let mut bytes = Vec::new();
        write_rays(&rays, &mut bytes).expect("written");
        assert_eq!(npy::parse(&bytes, usize::MAX, &Cancel::new()), Ok(rays));
    }
}
