//! Every model of a folder beside the package, where there is one: it loads with the right number
//! of triangles, or is refused for the right reason, and other readers find the same triangles.

mod common;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use boxwood::scene::{Geometry, LoadCx, Projection, Scene, open};
use glam::Vec3;

/// Where the list counts something else than triangles.
const COUNTED_OTHERWISE: &[(&str, u64)] = &[
    ("trimesh/cube_blender_uv.ply", 12), // the list counts its six quads
    ("trimesh/multi.ply", 2),            // one quad
    ("trimesh/plane.ply", 2),            // one quad
];

/// Refused, and what the reason says.
const REFUSED: &[(&str, &str)] = &[
    ("meshopt-no-fallback/meshopt-no-fallback.gltf", "meshopt_compression, which Boxwood can't read. Re-export without meshopt"),
    ("gkjohnson/lamborghini/scene.glb", "it needs EXT_meshopt_compression"),
    ("test/in/BoxMeshopt.glb", "it needs EXT_meshopt_compression"),
    ("test/in/BoxMeshopt.gltf", "it needs EXT_meshopt_compression"),
    (
        "test/in/BoxDraco.gltf",
        "mesh 0 (Mesh) primitive 0 needs KHR_draco_mesh_compression, which Boxwood can't read. Re-export without Draco.",
    ),
    ("test/in/DracoSparseMesh.gltf", "mesh 0 needs KHR_draco_mesh_compression"),
    ("test/in/DenseSphere.glb", "mesh 0 needs KHR_draco_mesh_compression"),
    ("BoundsChecking/integer-out-of-bounds.gltf", "floating point `1e+300`"),
    ("BoundsChecking/invalid-buffer-index.gltf", "Primitives without positions"),
    ("BoundsChecking/invalid-buffer-view-index.gltf", "Primitives without positions"),
    ("BoundsChecking/invalid-primitive-indices.gltf", "Primitives without positions"),
    ("tinyobjloader/invalid-relative-texture-index.obj", "line 2: there is no vertex 1"),
    ("tinyobjloader/invalid-relative-vertex-index.obj", "line 1: there is no vertex -4"),
    ("tinyobjloader/issue-140-zero-face-idx.obj", "line 16: there is no vertex 0"),
    (".off", "the format 'off' is not known"),
];

/// Where the other reader is not to be followed.
const READ_OTHERWISE: &[&str] = &[
    "tinyobjloader/cube-vertex-w-component.obj", // it divides by a weight that is for curves
    "trimesh/multibody.stl",                     // it stops after the first solid
    "trimesh/two_objects_mixed_case_names.stl",  // it stops after the first solid
];

struct Model {
    path: String,
    triangles: Option<u64>,
}

/// The models that the list in `folder` names; `None` if there is no such list.
fn listed(folder: &Path) -> Option<Vec<Model>> {
    let list = std::fs::read_to_string(folder.join("MANIFEST.tsv")).ok()?;
    let rows = list.lines().map(|line| line.split('\t').collect::<Vec<_>>()).filter(|row| row.get(1) == Some(&"model"));
    let model = |row: Vec<&str>| {
        let path = row[0].to_owned();
        let otherwise = COUNTED_OTHERWISE.iter().find(|(p, _)| *p == path).map(|(_, n)| *n);
        // "… 3542 triangles instanced" where nodes place meshes more than once.
        let instanced = row.last().and_then(|why| why.strip_suffix(" triangles instanced")?.rsplit(' ').next()?.parse().ok());
        Model { path, triangles: otherwise.or(instanced).or_else(|| row[3].parse().ok()) }
    };
    Some(rows.map(model).collect())
}

/// The corners of every triangle as bits, so that NaN is equal to itself.
type Soup = Vec<[[u32; 3]; 3]>;

fn soup(scene: &Scene) -> Soup {
    let meshes = scene.meshes.iter();
    meshes.flat_map(|m| m.triangles.iter().map(|t| t.map(|i| m.positions[i as usize].to_array().map(f32::to_bits)))).collect()
}

/// What another reader makes of the file; `None` if it cannot read it, or there is none.
fn read_by_another(path: &Path) -> Option<Soup> {
    let bits = |p: &[f32]| [p[0], p[1], p[2]].map(f32::to_bits);
    match path.extension()?.to_str()?.to_lowercase().as_str() {
        "obj" => {
            let (models, _) = tobj::load_obj(path, &tobj::GPU_LOAD_OPTIONS).ok()?;
            let corner = |m: &tobj::Mesh, i: u32| bits(&m.positions[3 * i as usize..]);
            let of =
                |m: &tobj::Mesh| m.indices.chunks_exact(3).map(|t| [t[0], t[1], t[2]].map(|i| corner(m, i))).collect::<Vec<_>>();
            Some(models.iter().flat_map(|model| of(&model.mesh)).collect())
        }
        "stl" => {
            let mesh = stl_io::read_stl(&mut std::fs::File::open(path).ok()?).ok()?;
            Some(mesh.faces.iter().map(|t| t.vertices.map(|i| bits(&mesh.vertices[i].0))).collect())
        }
        "ply" => ply(path),
        _ => None,
    }
}

fn ply(path: &Path) -> Option<Soup> {
    use ply_rs_bw::{parser::Parser, ply::DefaultElement};
    let ply = Parser::<DefaultElement>::new().read_ply(&mut std::fs::File::open(path).ok()?).ok()?;
    let axis = |v: &DefaultElement, name: &str| v.get(name)?.to_f32_lossy();
    let vertex = |v| Some([axis(v, "x")?, axis(v, "y")?, axis(v, "z")?].map(f32::to_bits));
    let vertices = ply.payload.get("vertex")?.iter().map(vertex).collect::<Option<Vec<_>>>()?;
    let list = |face: &DefaultElement| face.get("vertex_indices").or(face.get("vertex_index"))?.to_u32_list();
    let faces = ply.payload.get("face")?.iter().map(list).collect::<Option<Vec<_>>>()?;
    let fan = |f: Vec<u32>| (2..f.len()).map(|i| [f[0], f[i - 1], f[i]].map(|v| vertices[v as usize])).collect::<Vec<_>>();
    Some(faces.into_iter().flat_map(fan).collect())
}

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/models")
}

/// Loads one model; returns what to count it as, or what is wrong.
fn attempt(model: &Model, cx: &LoadCx) -> Result<String, String> {
    let path = folder().join(&model.path);
    let format = path.extension().unwrap_or_default().to_string_lossy().to_lowercase();
    let refusal = REFUSED.iter().find(|(end, _)| model.path.ends_with(end)).map(|(_, says)| *says);
    match (open(path.to_str().ok_or("not Unicode")?, cx), refusal) {
        (Ok(_), Some(says)) => Err(format!("loaded, but should say: {says}")),
        (Ok(scene), None) if Some(scene.triangle_count()) != model.triangles => {
            Err(format!("{} triangles, not {:?}", scene.triangle_count(), model.triangles))
        }
        (Ok(scene), None) => match read_by_another(&path) {
            Some(other) if other == soup(&scene) => Ok(format!("{format:4}  loaded, as another reader does")),
            Some(_) if READ_OTHERWISE.contains(&model.path.as_str()) => {
                Ok(format!("{format:4}  loaded, for good reason not as another reader does"))
            }
            Some(_) => Err("another reader finds other triangles".to_owned()),
            None => Ok(format!("{format:4}  loaded")),
        },
        (Err(error), Some(says)) if error.to_string().contains(says) => Ok(format!("{format:4}  refused: {says}")),
        (Err(error), None) if model.triangles == Some(0) && error.to_string().contains("it holds no triangles") => {
            Ok(format!("{format:4}  refused: it holds no triangles"))
        }
        (Err(error), _) => Err(error.to_string()),
    }
}

#[test]
fn real_models() {
    let Some(models) = listed(&folder()) else {
        let remedy = format!("Put some into {} with a list of them, MANIFEST.tsv, to run it.", folder().display());
        common::left_out("model files", "loading real models", &remedy);
        return;
    };
    let cx = LoadCx::unattended();
    let mut table = BTreeMap::<String, usize>::new();
    let mut wrong = Vec::new();
    for model in &models {
        match attempt(model, &cx) {
            Ok(kind) => *table.entry(kind).or_default() += 1,
            Err(what) => wrong.push(format!("{}: {what}", model.path)),
        }
    }
    table.iter().for_each(|(kind, n)| println!("{n:4}  {kind}"));
    assert!(wrong.is_empty(), "{} of {} models:\n{}", wrong.len(), models.len(), wrong.join("\n"));
}

/// The file says twice where its camera is: in glTF, and in an extension as eye and point of interest.
#[test]
fn the_camera_of_a_real_file_looks_where_its_author_did() {
    let path = folder().join("tinygltf/Extensions-overwrite-issue261/issue-261.gltf");
    let (true, Some(path)) = (path.exists(), path.to_str()) else {
        let remedy = format!("Put tinygltf's issue-261.gltf at {} to run it.", path.display());
        return common::left_out("model files", "the camera of a real file", &remedy);
    };
    let cx = LoadCx::unattended();
    let scene = open(path, &cx).expect("a model");
    let geometry = Geometry::new(&scene, &cx).expect("a model");
    let camera = scene.first_camera(geometry.world_bounds(), 4.0 / 3.0);
    assert!(camera.eye.distance(Vec3::new(0.972_907_4, 1.259_243_8, 2.419_918_8)) < 1e-5, "{camera:?}");
    let towards = (Vec3::new(0.134_265_48, -0.143_561_38, 0.037_264_325) - camera.eye).normalize_or_zero();
    assert!(camera.frame().forward.dot(towards) > 0.9999, "{camera:?}");
    assert!(camera.frame().up.dot(Vec3::Y) > 0.8 && camera.target.length() < 0.3, "{camera:?}");
    assert_eq!(camera.projection, Projection::Perspective { fov_y: 0.927_295_2 });
}
