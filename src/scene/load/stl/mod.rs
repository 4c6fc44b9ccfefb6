//! STL, as text and binary: triangles without connections, whose equal corners are welded here.
//!
//! Both are read by hand and not with `stl_io`: that one takes every file that begins with
//! "solid " for text, which many binary files do, stops after the first of several solids, and
//! refuses coordinates that are not finite, which Boxwood keeps and counts. The tests use it to
//! check this reader.

mod facets;
mod marks;
mod table;

use std::collections::HashMap;

use glam::Vec3;

use facets::Facets;

use super::pace::Pace;
use super::text::{Line, Lines, float, lossy, shown};
use super::{Loader, Siblings, mesh_bytes};
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Mesh, Reason, Scene};
use crate::task::Charge;

/// The reader of `.stl` files.
pub(super) struct Stl;

/// A binary file: 80 bytes of anything, the number of facets, then 50 bytes each (a normal, three
/// corners, two bytes that mean nothing).
const HEADER: usize = 84;
const FACET: usize = 50;

impl Loader for Stl {
    fn id(&self) -> &'static str {
        "stl"
    }

    fn extensions(&self) -> &'static [&'static str] {
        &["stl"]
    }

    fn load(&self, bytes: &[u8], _: &dyn Siblings, cx: &LoadCx) -> Result<Scene, Reason> {
        cx.progress.start("parse", bytes.len() as u64);
        let mut weld = Weld::new(cx)?;
        match kind(bytes) {
            Kind::Text => read_text(bytes, &mut weld, cx)?,
            Kind::Binary => read_binary(bytes, &mut weld, cx)?,
        }
        weld.finish()
    }
}

enum Kind {
    Text,
    Binary,
}

/// A length that fits the count of facets means binary, whatever the first bytes are: "solid" is
/// a popular way to begin the 80 free ones. Text has no zero byte, and the count nearly always has.
fn kind(bytes: &[u8]) -> Kind {
    let fits = facets(bytes).is_some_and(|n| n.checked_mul(FACET).and_then(|n| n.checked_add(HEADER)) == Some(bytes.len()));
    let solid = bytes.trim_ascii_start().get(..5).is_some_and(|word| word.eq_ignore_ascii_case(b"solid"));
    if solid && !fits && !bytes.iter().take(4 * HEADER).any(|b| *b == 0) { Kind::Text } else { Kind::Binary }
}

fn facets(bytes: &[u8]) -> Option<usize> {
    let count = bytes.get(80..)?.first_chunk::<4>()?;
    usize::try_from(u32::from_le_bytes(*count)).ok()
}

fn read_binary(bytes: &[u8], weld: &mut Weld, cx: &LoadCx) -> Result<(), Reason> {
    let Some(count) = facets(bytes) else {
        let what = format!("the file ends after {} bytes, before the {HEADER} of a binary STL header", bytes.len());
        return Err(Reason::malformed("header", what));
    };
    let body = &bytes[HEADER..];
    if body.len() / FACET < count {
        let what = format!("the header says {count} triangles, but the file ends after {}: it was cut short", body.len() / FACET);
        return Err(Reason::malformed("header", what));
    }
    if body.len() / FACET > count {
        weld.warnings.push(format!("{} bytes after the last triangle were left out.", body.len() - count * FACET));
    }
    let facets = &body[..count * FACET];
    match Facets(facets).weld(cx)? {
        Some(mesh) => weld.mesh = mesh,
        None => weld_in_turn(facets, weld, cx)?,
    }
    Ok(())
}

/// One facet after the other: the slow road.
fn weld_in_turn(facets: &[u8], weld: &mut Weld, cx: &LoadCx) -> Result<(), Reason> {
    let mut pace = Pace::new(cx);
    for facet in facets.chunks_exact(FACET) {
        pace.step(FACET)?;
        let float = |i: usize| facet[i * 4..].first_chunk().map_or(f32::NAN, |b| f32::from_le_bytes(*b));
        weld.add([3, 6, 9].map(|i| Vec3::new(float(i), float(i + 1), float(i + 2))))?;
    }
    Ok(())
}

/// Reads `solid NAME … endsolid` any number of times. Only the lines that carry something are
/// looked at: `vertex` adds a corner, `endloop` or `endfacet` closes the triangle.
fn read_text(bytes: &[u8], weld: &mut Weld, cx: &LoadCx) -> Result<(), Reason> {
    let mut lines = Lines::new(bytes, 1, cx);
    let mut corners = Vec::with_capacity(3);
    let mut open = None;
    while let Some(line) = lines.next()? {
        match line.words().next().map(<[u8]>::to_ascii_lowercase).as_deref() {
            Some(b"solid") => {
                weld.begin(lossy(line.tail()))?;
                open = Some(line.number);
            }
            Some(b"endsolid") => open = None,
            Some(b"facet") if !corners.is_empty() => return Err(line.error("the facet before this one has no end")),
            Some(b"vertex") => corners.push(corner(&line)?),
            Some(b"endloop") => {
                let count = corners.len();
                let triangle = corners.drain(..).as_slice().try_into();
                weld.add(triangle.map_err(|_| line.error(format_args!("a facet has three corners, this one {count}")))?)?;
            }
            Some(b"facet" | b"outer" | b"endfacet") | None => {}
            Some(_) if open.is_none() => {} // between solids anything may stand
            Some(word) => return Err(line.error(format_args!("{} is no word of an STL file", shown(word)))),
        }
    }
    match open {
        Some(number) if !corners.is_empty() => {
            Err(Reason::malformed(format_args!("line {number}"), "this solid ends within a facet: the file was cut short"))
        }
        Some(_) => {
            weld.warnings.push("The last solid has no end: the file may have been cut short.".to_owned());
            Ok(())
        }
        None => Ok(()),
    }
}

fn corner(line: &Line) -> Result<Vec3, Reason> {
    let mut words = line.words().skip(1);
    let mut next = || {
        let word = words.next().ok_or_else(|| line.error("a vertex has three coordinates"))?;
        float(word).ok_or_else(|| line.error(format_args!("{} is no number", shown(word))))
    };
    Ok(Vec3::new(next()?, next()?, next()?))
}

/// What makes two corners one: the bits of their position. -0 + 0 is 0.
#[inline(always)]
fn key(p: Vec3) -> [u32; 3] {
    p.to_array().map(|x| (x + 0.0).to_bits())
}

/// Vertices by the bits of their position, so that a NaN is equal to itself. Many tables and not
/// one, because one of millions takes longer to grow than the cancel flag may wait.
struct Known([HashMap<[u32; 3], u32>; 64]);

impl Default for Known {
    fn default() -> Self {
        Self(std::array::from_fn(|_| HashMap::new()))
    }
}

impl Known {
    fn table(&mut self, key: [u32; 3]) -> &mut HashMap<[u32; 3], u32> {
        let [x, y, z] = key;
        let mixed = (x ^ y.rotate_left(11) ^ z.rotate_left(22)).wrapping_mul(0x9E37_79B9);
        &mut self.0[(mixed >> 26) as usize]
    }
}

/// Gathers triangles into meshes and gives equal corners one index.
struct Weld {
    scene: Scene,
    warnings: Vec<String>,
    mesh: Mesh,
    known: Known,
    added: usize,
    memory: Charge,
}

impl Weld {
    /// Triangles between two charges to the budget.
    const BATCH: usize = 1 << 14;
    /// What a triangle takes at most, with its share of the table.
    const BYTES: u64 = 12 + 3 * (12 + 32);

    fn new(cx: &LoadCx) -> Result<Self, Reason> {
        let scene = Scene { up: Vec3::Z, ..Scene::default() };
        let (warnings, mesh, known) = Default::default();
        Ok(Self { scene, warnings, mesh, known, added: 0, memory: cx.budget.charge(0)? })
    }

    fn add(&mut self, corners: [Vec3; 3]) -> Result<(), Reason> {
        if self.added.is_multiple_of(Self::BATCH) {
            self.memory.grow(Self::BATCH as u64 * Self::BYTES)?;
            if self.mesh.positions.len() > num::MAX_INDEX - 3 * Self::BATCH {
                return Err(Reason::TooLarge(self.mesh.positions.len() as u64, "vertices"));
            }
        }
        self.added += 1;
        let triangle = corners.map(|p| self.index(p));
        self.mesh.triangles.push(triangle);
        Ok(())
    }

    fn index(&mut self, p: Vec3) -> u32 {
        let key = key(p);
        let positions = &mut self.mesh.positions;
        *self.known.table(key).entry(key).or_insert_with(|| {
            positions.push(p);
            num::index(positions.len() - 1)
        })
    }

    /// Starts the next solid.
    fn begin(&mut self, name: String) -> Result<(), Reason> {
        self.end()?;
        self.mesh.name = name;
        Ok(())
    }

    fn end(&mut self) -> Result<(), Reason> {
        let mesh = std::mem::take(&mut self.mesh);
        self.known = Known::default(); // clearing large tables for each of many small solids takes long
        if !mesh.triangles.is_empty() {
            self.memory.grow(mesh_bytes(&mesh))?;
            self.scene.instances.push(Instance::identity(self.scene.meshes.len()));
            self.scene.meshes.push(mesh);
        }
        Ok(())
    }

    fn finish(mut self) -> Result<Scene, Reason> {
        self.end()?;
        self.scene.warnings = self.warnings;
        Ok(self.scene)
    }
}

#[cfg(test)]
mod tests {
    use super::super::tests::load;
    use super::*;

    fn binary(header: &[u8], count: u32, facets: &[[f32; 9]]) -> Vec<u8> {
        let mut file = header.to_vec();
        file.resize(80, b' ');
        file.extend(count.to_le_bytes());
        for facet in facets {
            file.extend([0; 12]);
            facet.iter().for_each(|x| file.extend(x.to_le_bytes()));
            file.extend([0; 2]);
        }
        file
    }

    const FACETS: [[f32; 9]; 2] = [[0., 0., 0., 1., 0., 0., 0., 1., 0.], [1., 0., 0., 0., 1., 0., 1., 1., f32::NAN]];

    #[test]
    fn binary_that_begins_with_solid_is_binary() {
        let scene = load(&Stl, &binary(b"solid by some CAD program", 2, &FACETS)).expect("a model");
        assert_eq!(scene.meshes[0].triangles, [[0, 1, 2], [1, 2, 3]]);
        assert!(scene.meshes[0].positions[3].z.is_nan());
        assert_eq!(scene.up, Vec3::Z);
        let longer = [binary(b"solid", 2, &FACETS), vec![0; 60]].concat();
        let scene = load(&Stl, &longer).expect("a model");
        assert_eq!((scene.triangle_count(), scene.warnings.len()), (2, 1));
    }

    #[test]
    fn a_claimed_count_is_not_believed() {
        let error = load(&Stl, &binary(b"", u32::MAX, &FACETS)).expect_err("cut short").to_string();
        assert_eq!(error, "header: the header says 4294967295 triangles, but the file ends after 2: it was cut short");
        assert!(load(&Stl, b"").is_err() && load(&Stl, b"sol").is_err());
    }

    #[test]
    fn text_of_several_solids_in_any_case() {
        let facet = "FACET NORMAL 0 0 1\n outer loop\n vertex 0 0 0\n vertex 1 0 -0\n VERTEX 0 1e0 inf\n endloop\nendfacet\n";
        let text = format!("solid\n{facet}{facet}endsolid\nby hand\nsolid Second One\n{facet}endsolid x\n");
        let scene = load(&Stl, text.as_bytes()).expect("a model");
        let seen: Vec<_> = scene.meshes.iter().map(|m| (m.name.as_str(), m.triangles.len(), m.positions.len())).collect();
        assert_eq!(seen, [("", 2, 3), ("Second One", 1, 3)]);
        assert_eq!(scene.meshes[1].positions[2], Vec3::new(0.0, 1.0, f32::INFINITY));
        assert!(scene.warnings.is_empty());
    }

    #[test]
    fn errors_name_the_line() {
        let error = |text: &str| load(&Stl, text.as_bytes()).expect_err("broken").to_string();
        assert_eq!(error("solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2\n"), "line 4: a vertex has three coordinates");
        assert_eq!(error("solid a\nvertex 1 2 x\n"), "line 2: 'x' is no number");
        assert_eq!(error("solid a\nvertex 1 2 3\nendloop\n"), "line 3: a facet has three corners, this one 1");
        assert_eq!(error("solid a\nvertex 1 2 3\n"), "line 1: this solid ends within a facet: the file was cut short");
        assert_eq!(error("solid a\nbanana\n"), "line 2: 'banana' is no word of an STL file");
    }

    /// Facets of grids of all sizes, with holes in them, of soups, and of one point.
    #[test]
    fn every_road_welds_the_same() {
        let grid = |i: u32, n: u32| [(i % n) as f32 * 0.5 - 0.0, (i / n) as f32, if i.is_multiple_of(7) { -0.0 } else { 0.0 }];
        let quads = |count: u32, n: u32| -> Vec<[f32; 9]> {
            let triangles = (0..count).flat_map(|i| [[i, i + 1, i + n], [i + n + 1, i + n, i + 1]]);
            triangles.map(|t| bytemuck::cast(t.map(|i| grid(i, n)))).collect()
        };
        let soup = |count: u32| -> Vec<[f32; 9]> {
            (0..count).map(|i| std::array::from_fn(|k| f32::from_bits((i * 9 + k as u32).wrapping_mul(0x9E37_79B9)))).collect()
        };
        let cases = [
            quads(0, 2),
            quads(1, 2),
            quads(100, 10),
            quads(50_000, 300),
            soup(1),
            soup(300),
            soup(60_000),
            vec![[1.5; 9]; 40_000],
        ];
        for facets in cases {
            let file = binary(b"", u32::try_from(facets.len()).expect("few"), &facets);
            let cx = LoadCx::unattended();
            let mut weld = Weld::new(&cx).expect("memory");
            weld_in_turn(&file[HEADER..], &mut weld, &cx).expect("facets");
            let mesh = Facets(&file[HEADER..]).weld(&cx).expect("facets").expect("a table that is not filled badly");
            assert!(mesh.triangles == weld.mesh.triangles, "{} facets", facets.len());
            let bits = |mesh: &Mesh| bytemuck::cast_slice::<_, u32>(&mesh.positions).to_vec();
            assert!(bits(&mesh) == bits(&weld.mesh));
        }
    }

    #[test]
    fn many_small_solids_are_no_burden() {
        let solid = "solid a\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendsolid\n";
        let scene = load(&Stl, solid.repeat(20_000).as_bytes()).expect("a model");
        assert_eq!(scene.meshes.len(), 20_000);
    }
}
