//! Hits in NumPy files: an .npz of `t`, `u`, `v` (float32) and `primitive` (uint32; uint64 for a scene of more triangles than
//! 32 bits number), one a ray.

use std::io::{self, Seek, Write};

use npyz::WriterBuilder;
use zip::write::SimpleFileOptions;

use crate::accel::{Hit, Mode};
use crate::scene::{Instance, Scene};

/// Writes hits. For [`Mode::Closest`]: t is infinite for a miss, and the primitive is the index in
/// the flattened scene, whether it was flattened or not. For [`Mode::Any`]: t is 0 where there is a hit and infinite
/// where there is none; which hit it was is chance, so nothing is said of it.
pub fn write(hits: &[Option<Hit>], mode: Mode, scene: &Scene, out: impl Write + Seek) -> io::Result<()> {
    let closest = |hit: &Option<Hit>| hit.filter(|_| mode == Mode::Closest);
    let t = |hit: &Option<Hit>| match (hit, mode) {
        (Some(hit), Mode::Closest) => hit.t,
        (Some(_), Mode::Any) => 0.0,
        (None, _) => f32::INFINITY,
    };
    let mut zip = zip::ZipWriter::new(out);
    array(&mut zip, "t", hits, t)?;
    array(&mut zip, "u", hits, |hit| closest(hit).map_or(0.0, |hit| hit.u))?;
    array(&mut zip, "v", hits, |hit| closest(hit).map_or(0.0, |hit| hit.v))?;
    let first = first_triangles(scene);
    let flat = |hit: &Option<Hit>| closest(hit).map(|hit| first[hit.instance as usize] + u64::from(hit.primitive));
    if scene.triangle_count() < u64::from(u32::MAX) {
        array(&mut zip, "primitive", hits, |hit| flat(hit).and_then(|i| u32::try_from(i).ok()).unwrap_or(u32::MAX))?;
    } else {
        array(&mut zip, "primitive", hits, |hit| flat(hit).unwrap_or(u64::MAX))?;
    }
    zip.finish()?.flush()
}

/// The number that each instance's first triangle has where all are counted in order.
fn first_triangles(scene: &Scene) -> Vec<u64> {
    let mut next = 0;
    let first = |i: &Instance| {
        let first = next;
        next += scene.meshes[i.mesh].triangles.len() as u64;
        first
    };
    scene.instances.iter().map(first).collect()
}

/// Adds an array, uncompressed, as `numpy.savez` does.
fn array<T, W>(zip: &mut zip::ZipWriter<W>, name: &str, hits: &[Option<Hit>], value: impl Fn(&Option<Hit>) -> T) -> io::Result<()>
where
    T: npyz::AutoSerialize,
    W: Write + Seek,
{
    let stored = SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored).large_file(true);
    zip.start_file(format!("{name}.npy"), stored)?;
    let shape = [hits.len() as u64];
    let mut writer = npyz::WriteOptions::<T>::new().default_dtype().shape(&shape).writer(io::BufWriter::new(zip)).begin_nd()?;
    writer.extend(hits.iter().map(value))?;
    writer.finish()
}
