//! Two triangles in every format, and the same so often that the file is large.

/// A name, the loader's id, and the bytes.
pub type File = (&'static str, &'static str, Vec<u8>);

const OBJ: &str = "# two\nmtllib none.mtl\no square\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 0 1 1 1\nvt 0 0\nvt 1 1\nvn 0 0 1\n\
                   g front\nusemtl red\ns 1\nf 1/1/1 2/2/1 3/1/1 -1/-1/-1\n";
const STL: &str = "solid two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 1e0 1.0 0\n  endloop\n endfacet\n \
                   facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 1 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid two\n";
const GLTF: &str = r#"{"asset":{"version":"2.0"},"scene":0,"scenes":[{"nodes":[0]}],"nodes":[{"children":[1],"translation":[1,0,0]},
{"mesh":0,"rotation":[0,0,1,0]}],"meshes":[{"name":"m","primitives":[{"attributes":{"POSITION":0,"COLOR_0":2},"indices":1,"mode":4,"material":0}]}],
"materials":[{"pbrMetallicRoughness":{"baseColorFactor":[1,0,0,1]}}],
"accessors":[{"bufferView":0,"componentType":5126,"count":4,"type":"VEC3","min":[0,0,0],"max":[1,1,0]},
{"bufferView":1,"componentType":5123,"count":6,"type":"SCALAR"},
{"componentType":5121,"normalized":true,"count":4,"type":"VEC4","sparse":{"count":1,"indices":{"bufferView":2,"componentType":5121},"values":{"bufferView":3}}}],
"bufferViews":[{"buffer":0,"byteLength":48},{"buffer":0,"byteOffset":48,"byteLength":12},{"buffer":0,"byteOffset":60,"byteLength":1},
{"buffer":0,"byteOffset":64,"byteLength":4}],"buffers":[{"byteLength":68URI}]}"#;

const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
const INDICES: [u16; 6] = [0, 1, 2, 0, 2, 3];

/// One of each kind.
pub fn models() -> Vec<File> {
    vec![
        ("obj", "obj", OBJ.into()),
        ("ascii stl", "stl", STL.into()),
        ("binary stl", "stl", binary_stl(1)),
        ("ascii ply", "ply", ascii_ply(1)),
        ("little-endian ply", "ply", binary_ply("little", 1)),
        ("big-endian ply", "ply", binary_ply("big", 1)),
        ("gltf", "gltf", embedded_gltf()),
        ("glb", "gltf", glb(&GLTF.replace("URI", ""), &gltf_bin())),
    ]
}

/// Large ones of about `size` bytes.
pub fn repeated(size: usize) -> impl Iterator<Item = File> {
    let builders: [fn(usize) -> File; 7] = [
        |size| ("obj", "obj", OBJ.repeat(size / OBJ.len()).into()),
        |size| ("ascii stl", "stl", STL.repeat(size / STL.len()).into()),
        |size| ("binary stl", "stl", binary_stl(size / 100)),
        |size| ("ascii ply", "ply", ascii_ply(size / 40)),
        |size| ("little-endian ply", "ply", binary_ply("little", size / 65)),
        |size| ("embedded gltf", "gltf", large_embedded_gltf(size)),
        |size| ("glb", "gltf", large_glb(size)),
    ];
    builders.into_iter().map(move |build| build(size))
}

fn binary_stl(squares: usize) -> Vec<u8> {
    let mut file = b"solid, says the header, but it is not".to_vec();
    file.resize(80, b' ');
    file.extend(u32::try_from(2 * squares).expect("few").to_le_bytes());
    for n in 0..squares {
        for triangle in INDICES.chunks(3) {
            file.extend([0; 12]);
            let corners = triangle.iter().map(|i| CORNERS[usize::from(*i)]);
            file.extend(corners.flat_map(|[x, y, _]| [x, y, f32::from_bits(0x3F00_0000 + n as u32)]).flat_map(f32::to_le_bytes));
            file.extend([0; 2]);
        }
    }
    file
}

fn ply_header(format: &str, squares: usize) -> Vec<u8> {
    format!(
        "ply\nformat {format} 1.0\ncomment two\nelement vertex {}\nproperty float x\nproperty float y\nproperty float z\n\
         property uchar red\nelement face {squares}\nproperty list uchar int vertex_indices\nend_header\n",
        4 * squares
    )
    .into_bytes()
}

fn ascii_ply(squares: usize) -> Vec<u8> {
    let mut file = ply_header("ascii", squares);
    (0..squares).for_each(|_| file.extend(b"0 0 0 9\n1 0 0 9\n1 1 0 9\n0 1 nan 9\n"));
    (0..squares).for_each(|_| file.extend(b"4 0 1 2 3\n"));
    file
}

fn binary_ply(order: &str, squares: usize) -> Vec<u8> {
    let mut file = ply_header(&format!("binary_{order}_endian"), squares);
    let put =
        |file: &mut Vec<u8>, bytes: [u8; 4]| if order == "big" { file.extend(bytes.iter().rev()) } else { file.extend(bytes) };
    for _ in 0..squares {
        for corner in CORNERS {
            corner.iter().for_each(|x| put(&mut file, x.to_le_bytes()));
            file.push(9);
        }
    }
    let mut face = vec![4];
    (0..4i32).for_each(|i| put(&mut face, i.to_le_bytes()));
    file.extend(face.repeat(squares));
    file
}

fn gltf_bin() -> Vec<u8> {
    let mut bin: Vec<u8> = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend(INDICES.iter().flat_map(|i| i.to_le_bytes()));
    bin.extend([2, 0, 0, 0, 255, 0, 0, 255]);
    bin
}

fn embedded_gltf() -> Vec<u8> {
    let uri = format!(r#","uri":"data:application/octet-stream;base64,{}""#, base64(&gltf_bin()));
    GLTF.replace("URI", &uri).into_bytes()
}

fn glb(json: &str, bin: &[u8]) -> Vec<u8> {
    let mut json = json.as_bytes().to_vec();
    json.resize(json.len().next_multiple_of(4), b' ');
    let word = |n: usize| u32::try_from(n).expect("short").to_le_bytes();
    let length = 28 + json.len() + bin.len();
    [b"glTF", &word(2)[..], &word(length), &word(json.len()), b"JSON", &json, &word(bin.len()), b"BIN\0", bin].concat()
}

/// Triangles without indices.
fn large_json(bytes: usize, uri: &str) -> String {
    let (vertices, length) = (bytes / 12, bytes / 12 * 12);
    format!(
        r#"{{"asset":{{"version":"2.0"}},"nodes":[{{"mesh":0}}],"meshes":[{{"primitives":[{{"attributes":{{"POSITION":0}}}}]}}],
        "accessors":[{{"bufferView":0,"componentType":5126,"count":{vertices},"type":"VEC3"}}],
        "bufferViews":[{{"buffer":0,"byteLength":{length}}}],"buffers":[{{"byteLength":{length}{uri}}}]}}"#
    )
}

fn large_glb(size: usize) -> Vec<u8> {
    glb(&large_json(size, ""), &vec![0; size.next_multiple_of(4)])
}

fn large_embedded_gltf(size: usize) -> Vec<u8> {
    let data = "A".repeat(size / 4 * 4);
    large_json(size / 4 * 3, &format!(r#","uri":"data:;base64,{data}""#)).into_bytes()
}

fn base64(bytes: &[u8]) -> String {
    const DIGITS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let digits = |chunk: &[u8]| {
        let bits = chunk.iter().chain([&0; 2]).take(3).fold(0u32, |bits, b| bits << 8 | u32::from(*b));
        (0..4)
            .map(|i| if i <= chunk.len() { char::from(DIGITS[(bits >> (18 - 6 * i)) as usize & 63]) } else { '=' })
            .collect::<String>()
    };
    bytes.chunks(3).map(digits).collect()
}
