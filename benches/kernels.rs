//! What rays spend their time in, by itself: eight boxes, eight triangles, one triangle and eight rays, each on
//! every road.

mod common;

use std::hint::black_box;
use std::sync::Arc;

use boxwood::geometry::eight::Rays;
use boxwood::geometry::slabs::Boxes;
use boxwood::geometry::tri::{Block, Fast, TriTest, Watertight, corners, splat_own};
use boxwood::geometry::{EightSlabs, Ray};
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::simd::{Kernel, LANES, Road, Simd};
use common::rays;
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

const MODEL: &str = "builtin:soup?triangles=5000";

fn geometry() -> Arc<Geometry> {
    let cx = LoadCx::unattended();
    let scene = scene::open(MODEL, &cx).expect("made in code");
    Arc::new(Geometry::new(&scene, &cx).expect("small"))
}

fn blocks(geometry: &Geometry) -> Vec<Block> {
    let triangles: Vec<_> = (0..geometry.live_count()).map(|i| geometry.corners(geometry.live(i))).collect();
    triangles.chunks(LANES).map(|eight| Block::new(eight.iter().copied())).collect()
}

/// How many of the boxes of all triangles each ray meets.
struct MeetBoxes<'a>(&'a [Fast], &'a [Block]);

impl Kernel for MeetBoxes<'_> {
    type Out = u32;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u32 {
        let mut met = 0;
        for test in self.0 {
            let slabs = EightSlabs::splat(s, test.slabs());
            for block in self.1 {
                // Boxes as nodes have them: loaded, not worked out.
                let of = corners(s, block, [0, 1, 2]);
                let (entry, exit) = slabs.intervals(s, &Boxes { min: of[0], max: of[1] });
                met += s.bits(s.le(entry, exit)).count_ones();
            }
        }
        met
    }
}

/// How many triangles each ray hits, eight triangles at a time.
struct HitBlocks<'a, T>(&'a [T], &'a [Block]);

impl<T: TriTest> Kernel for HitBlocks<'_, T> {
    type Out = u32;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u32 {
        let mut hits = 0;
        let interval = [s.splat(0.0), s.splat(f32::INFINITY)];
        for test in self.0 {
            let axes = test.axes();
            let (own, slabs) = (splat_own(s, &test.own()), EightSlabs::splat(s, &test.slabs().in_order(axes)));
            for block in self.1 {
                let found = T::hit_eight(s, &own, &slabs, interval, &corners(s, block, axes));
                hits += s.bits(found.hit).count_ones();
            }
        }
        hits
    }
}

/// How many rays hit each triangle, eight rays at a time; all in the world's scale.
struct HitByEight<'a>(&'a [Ray], &'a Geometry);

impl Kernel for HitByEight<'_> {
    type Out = u32;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> u32 {
        let mut hits = 0;
        for eight in self.0.chunks_exact(LANES) {
            let Some(eight) = eight.first_chunk() else { continue };
            let rays = Rays::load(s, eight);
            let (own, slabs) = (Fast::own_of_eight(s, &rays), EightSlabs::new(s, &rays, self.1.bounds()));
            for i in 0..self.1.live_count() {
                let block = Block::new([self.1.corners(self.1.live(i)); LANES]);
                let of = corners(s, &block, [0, 1, 2]);
                let found = Fast::hit_eight(s, &own, &slabs, [rays.tmin, rays.tmax], &of);
                hits += s.bits(found.hit).count_ones();
            }
        }
        hits
    }
}

fn kernels(criterion: &mut Criterion) {
    let geometry = geometry();
    let (rays, blocks) = (rays(&geometry), blocks(&geometry));
    let local: Vec<Ray> = rays.iter().map(|ray| geometry.space().enter(ray).ray).collect();
    let fast: Vec<Fast> = local.iter().map(|ray| Fast::prepare(ray, geometry.bounds())).collect();
    let watertight: Vec<Watertight> = local.iter().map(|ray| Watertight::prepare(ray, geometry.bounds())).collect();
    let mut group = criterion.benchmark_group("kernels");
    group.sample_size(10).throughput(Throughput::Elements((rays.len() * blocks.len() * LANES) as u64));
    for road in Road::all() {
        let id = road.id();
        group.bench_function(format!("boxes/{id}"), |b| b.iter(|| road.run(MeetBoxes(black_box(&fast), &blocks))));
        group.bench_function(format!("fast/{id}"), |b| b.iter(|| road.run(HitBlocks(black_box(&fast), &blocks))));
        let all = HitBlocks::<Watertight>;
        group.bench_function(format!("watertight/{id}"), |b| b.iter(|| road.run(all(black_box(&watertight), &blocks))));
        group.bench_function(format!("eight rays/{id}"), |b| b.iter(|| road.run(HitByEight(black_box(&local), &geometry))));
    }
    group.finish();
}

criterion_group!(benches, kernels);
criterion_main!(benches);
