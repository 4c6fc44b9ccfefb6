//! Mountains: an even sheet of small triangles over a square, as grids like it, and with a long
//! horizon, as most of a real landscape's rays see it.

use super::fill::{Sizes, fill};
use super::noise::{fbm, ridges};
use super::view;
use crate::geometry::num;
use crate::scene::{Instance, LoadCx, Material, Mesh, Reason, Scene};
use glam::{Vec2, Vec3};

const SEED: u64 = 0x7465_7272;

/// The side of the square; the mountains are up to 2 high.
const SIDE: f32 = 10.0;

/// The cells of the sheet, each of two triangles.
#[derive(Clone, Copy)]
struct Grid {
    columns: usize,
    rows: usize,
}

/// About so many triangles: nearly as many rows as columns.
pub(super) fn generate(triangles: usize, cx: &LoadCx) -> Result<Scene, Reason> {
    let grid = Grid::of(triangles);
    let vertices = (grid.columns + 1) * (grid.rows + 1);
    let triangles = 2 * grid.columns * grid.rows;
    let _memory = Sizes { vertices, triangles, normals: vertices, colors: vertices, ..Sizes::default() }.begin(cx)?;
    let positions = fill(vertices, cx, |k| grid.point(k))?;
    let normals = fill(vertices, cx, |k| grid.normal(k, &positions))?;
    let colors = fill(vertices, cx, |k| color(positions[k], normals[k]))?;
    let triangles = fill(triangles, cx, |k| grid.triangle(k))?;
    Ok(Scene {
        meshes: vec![Mesh {
            name: "terrain".into(),
            positions,
            triangles,
            normals,
            colors,
            material: Some(0),
            ..Mesh::default()
        }],
        instances: vec![Instance::identity(0)],
        materials: vec![Material { name: "ground".into(), base_color: [1.0; 4], ..Material::PLAIN }],
        up: Vec3::Z,
        camera: Some(view(Vec3::new(-0.2, 0.2, 0.35), Vec3::new(2.2, -6.2, 2.9))),
        ..Scene::default()
    })
}

impl Grid {
    fn of(triangles: usize) -> Self {
        let cells = triangles as f64 / 2.0;
        let rows = num::floor_index(cells.sqrt() + 0.5, 1 << 14).max(1);
        let columns = num::floor_index(cells / rows as f64 + 0.5, 1 << 14).max(1);
        Self { columns, rows }
    }

    /// The column and the row of a vertex.
    fn place(&self, vertex: usize) -> (usize, usize) {
        (vertex % (self.columns + 1), vertex / (self.columns + 1))
    }

    fn point(&self, vertex: usize) -> Vec3 {
        let (column, row) = self.place(vertex);
        let across = |i: usize, n: usize| (i as f32 / n as f32 - 0.5) * SIDE;
        let p = Vec2::new(across(column, self.columns), across(row, self.rows));
        p.extend(height(p))
    }

    /// From the differences to the neighbours, one-sided on the borders.
    fn normal(&self, vertex: usize, positions: &[Vec3]) -> Vec3 {
        let (column, row) = self.place(vertex);
        let step = self.columns + 1;
        let difference = |i: usize, n: usize, step: usize| {
            let (before, after) = (if i > 0 { step } else { 0 }, if i < n { step } else { 0 });
            positions[vertex + after] - positions[vertex - before]
        };
        let (east, north) = (difference(column, self.columns, 1), difference(row, self.rows, step));
        east.cross(north).normalize_or(Vec3::Z)
    }

    /// Cells are cut along alternating diagonals, which favours no direction.
    fn triangle(&self, k: usize) -> [u32; 3] {
        let (column, row) = (k / 2 % self.columns, k / 2 / self.columns);
        let a = row * (self.columns + 1) + column;
        let (b, c, d) = (a + 1, a + self.columns + 1, a + self.columns + 2);
        let halves = if (column + row) % 2 == 0 { [[a, b, d], [a, d, c]] } else { [[a, b, c], [b, d, c]] };
        halves[k % 2].map(num::index)
    }
}

/// Chains of mountains where a coarse noise is high, hills elsewhere.
fn height(p: Vec2) -> f32 {
    let p = p * 0.28;
    let bent = p + 0.35 * Vec2::new(fbm(SEED + 100, p * 1.3, 3), fbm(SEED + 200, p * 1.3, 3));
    let chain = smooth(-0.35, 0.45, fbm(SEED + 300, p * 0.8, 2));
    let hills = 0.12 * (fbm(SEED + 400, bent * 2.0, 7) + 1.0);
    hills + 1.9 * chain * ridges(SEED, bent * 1.1, 11)
}

/// Grass below, snow above, rock where it is steep; linear colours.
fn color(at: Vec3, normal: Vec3) -> [f32; 4] {
    const MEADOW: Vec3 = Vec3::new(0.105, 0.170, 0.055);
    const HEATH: Vec3 = Vec3::new(0.200, 0.190, 0.085);
    const ROCK: Vec3 = Vec3::new(0.215, 0.190, 0.165);
    const SNOW: Vec3 = Vec3::new(0.800, 0.830, 0.870);
    let patchy = 0.15 * fbm(SEED + 500, at.truncate() * 3.0, 4);
    let level = at.z + patchy;
    let grass = MEADOW.lerp(HEATH, smooth(0.15, 0.75, level));
    let ground = grass.lerp(ROCK, smooth(0.28, 0.5, 1.0 - normal.z + 0.5 * patchy));
    let snow = smooth(0.85, 1.1, level) * smooth(0.45, 0.65, normal.z);
    ground.lerp(SNOW, snow).extend(1.0).to_array()
}

/// 0 up to `low`, 1 from `high` on, smooth between.
fn smooth(low: f32, high: f32, x: f32) -> f32 {
    let t = ((x - low) / (high - low)).clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}
