//! How fast model files are read, beside reading their bytes into memory and nothing else, and for OBJ beside `tobj`:
//! `cargo bench --bench load [-- TRIANGLES...]`, one and ten million unless told otherwise. Rounds are interleaved; medians
//! are printed. Files are written to a temporary folder and are in the system's cache when they are timed.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use boxwood::lab::statistics::{half_iqr, median};
use boxwood::scene::{self, LoadCx, Mesh};

const ROUNDS: usize = 7;

/// Writes a mesh in some format.
type Writer = fn(&Mesh, &mut dyn Write) -> io::Result<()>;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|arg| arg.parse().ok()).collect();
    let sizes = if sizes.is_empty() { vec![1_000_000, 10_000_000] } else { sizes };
    // Cargo asks every benchmark whether it still runs.
    if std::env::args().any(|arg| arg == "--test") {
        return Ok(());
    }
    println!(
        "{:>10} {:>4} {:>7} {:>18} {:>18} {:>10} {:>18} {:>9}",
        "triangles", "", "MB", "read s", "load s", "load/read", "tobj s", "tobj/load"
    );
    for triangles in sizes {
        let cx = LoadCx::unattended();
        let scene = scene::open(&format!("builtin:terrain?triangles={triangles}"), &cx)?;
        let mesh = &scene.meshes[0];
        let folder = tempfile::tempdir()?;
        let writers: [(&str, Writer); 4] = [("ply", ply), ("glb", glb), ("stl", stl), ("obj", obj)];
        for (format, write) in writers {
            let path = folder.path().join(format!("terrain.{format}"));
            let mut file = BufWriter::new(File::create(&path)?);
            write(mesh, &mut file)?;
            file.flush()?;
            row(&path, format, mesh.triangles.len())?;
            fs::remove_file(&path)?;
        }
    }
    Ok(())
}

fn timed<T>(secs: &mut Vec<f64>, work: impl FnOnce() -> T) -> T {
    let start = Instant::now();
    let done = work();
    secs.push(start.elapsed().as_secs_f64());
    done
}

fn row(path: &PathBuf, format: &str, triangles: usize) -> Result<(), Box<dyn std::error::Error>> {
    let name = path.to_str().ok_or("a path that is no text")?;
    let cx = LoadCx::unattended();
    let (mut read, mut load, mut peer) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let bytes = timed(&mut read, || fs::read(path))?;
        drop(bytes);
        let scene = timed(&mut load, || scene::open(name, &cx))?;
        assert_eq!(scene.triangle_count(), triangles as u64);
        if format == "obj" {
            let triangles = timed(&mut peer, || plain_tobj(path))?;
            assert_eq!(triangles, scene.triangle_count());
        }
    }
    let told = |secs: &[f64]| if secs.is_empty() { "-".into() } else { format!("{:.3} ±{:.3}", median(secs), half_iqr(secs)) };
    let megabytes = fs::metadata(path)?.len() as f64 / 1e6;
    let over = median(&load) / median(&read);
    let faster = if peer.is_empty() { "-".into() } else { format!("{:.2}", median(&peer) / median(&load)) };
    println!(
        "{triangles:>10} {format:>4} {megabytes:>7.0} {:>18} {:>18} {over:>10.2} {:>18} {faster:>9}",
        told(&read),
        told(&load),
        told(&peer)
    );
    Ok(())
}

fn plain_tobj(path: &Path) -> Result<u64, tobj::LoadError> {
    let (models, _) = tobj::load_obj(path, &tobj::GPU_LOAD_OPTIONS)?;
    Ok(models.iter().map(|model| model.mesh.indices.len() as u64 / 3).sum())
}

fn floats(out: &mut dyn Write, of: &[f32]) -> io::Result<()> {
    of.iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))
}

fn ply(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    write!(out, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len())?;
    write!(out, "property float x\nproperty float y\nproperty float z\nelement face {}\n", mesh.triangles.len())?;
    write!(out, "property list uchar int vertex_indices\nend_header\n")?;
    mesh.positions.iter().try_for_each(|p| floats(out, &p.to_array()))?;
    mesh.triangles.iter().try_for_each(|triangle| {
        out.write_all(&[3])?;
        triangle.iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))
    })
}

fn glb(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    let (points, corners) = (mesh.positions.len(), mesh.triangles.len() * 3);
    let bytes = points * 12 + corners * 4;
    let least = mesh.positions.iter().fold(mesh.positions[0], |a, b| a.min(*b)).to_array();
    let most = mesh.positions.iter().fold(mesh.positions[0], |a, b| a.max(*b)).to_array();
    let mut json = serde_json::json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "buffers": [{"byteLength": bytes}],
        "bufferViews": [{"buffer": 0, "byteLength": points * 12}, {"buffer": 0, "byteOffset": points * 12, "byteLength": corners * 4}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": points, "type": "VEC3", "min": least, "max": most},
            {"bufferView": 1, "componentType": 5125, "count": corners, "type": "SCALAR"},
        ],
    })
    .to_string();
    while !json.len().is_multiple_of(4) {
        json.push(' ');
    }
    let size = |n: usize| u32::try_from(n).map(u32::to_le_bytes).map_err(io::Error::other);
    out.write_all(b"glTF\x02\0\0\0")?;
    out.write_all(&size(12 + 8 + json.len() + 8 + bytes)?)?;
    out.write_all(&size(json.len())?)?;
    out.write_all(b"JSON")?;
    out.write_all(json.as_bytes())?;
    out.write_all(&size(bytes)?)?;
    out.write_all(b"BIN\0")?;
    mesh.positions.iter().try_for_each(|p| floats(out, &p.to_array()))?;
    mesh.triangles.iter().flatten().try_for_each(|i| out.write_all(&i.to_le_bytes()))
}

fn stl(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    out.write_all(&[0; 80])?;
    out.write_all(&u32::try_from(mesh.triangles.len()).map_err(io::Error::other)?.to_le_bytes())?;
    mesh.triangles.iter().try_for_each(|triangle| {
        floats(out, &[0.0; 3])?;
        triangle.iter().try_for_each(|i| floats(out, &mesh.positions[*i as usize].to_array()))?;
        out.write_all(&[0; 2])
    })
}

fn obj(mesh: &Mesh, out: &mut dyn Write) -> io::Result<()> {
    mesh.positions.iter().try_for_each(|p| writeln!(out, "v {} {} {}", p.x, p.y, p.z))?;
    mesh.triangles.iter().try_for_each(|[a, b, c]| writeln!(out, "f {} {} {}", a + 1, b + 1, c + 1))
}
