//! Primary rays of a built-in scene through every registered structure, on one thread.

use std::hint::black_box;
use std::sync::Arc;

use boxwood::accel::{Accel, BuildCx, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::lab::{RayKind, RaySet};
use boxwood::render::{Job, Mode};
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::task::{Cancel, Pool};
use criterion::{Criterion, Throughput, criterion_group, criterion_main};

/// Small enough that brute force ends.
const MODEL: &str = "builtin:soup?triangles=5000";

fn primary_rays(criterion: &mut Criterion) {
    let cx = LoadCx::unattended();
    let scene = Arc::new(scene::open(MODEL, &cx).expect("a built-in scene"));
    let geometry = Arc::new(Geometry::new(&scene, &cx).expect("small"));
    let camera = scene.first_camera(geometry.world_bounds(), 1.5);
    let mut group = criterion.benchmark_group("primary");
    group.sample_size(20);
    for entry in registry::ALL {
        let built = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(0)).expect("fits");
        let accel: Arc<dyn Accel> = Arc::from(built);
        let job = Job::new(Arc::clone(&scene), Arc::clone(&accel), camera, Mode::Shaded, Arc::default());
        let set =
            RaySet::generate(RayKind::Primary, &job, 96, 64, &Pool::new("bench", 1), &Cancel::new()).expect("not cancelled");
        let mut hits = vec![None; set.rays.len()];
        group.throughput(Throughput::Elements(set.rays.len() as u64));
        group.bench_function(entry.id, |bench| {
            bench.iter(|| accel.trace(black_box(&set.rays), set.mode, &mut hits, &Cancel::new()).expect("not cancelled"));
        });
    }
    group.finish();
}

criterion_group!(benches, primary_rays);
criterion_main!(benches);
