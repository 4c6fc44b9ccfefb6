//! Bytes in use at a time, counted by the allocator. Alone in its target: other tests would be counted, too.

use std::sync::Arc;

use boxwood::accel::stats::{SahWeights, Stats};
use boxwood::accel::{BuildCx, registry, would_fit};
use boxwood::geometry::tri::TestKind;
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::task::Cancel;
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The most that building may take beyond the geometry.
const BYTES_PER_TRIANGLE: usize = 160;

fn terrain(triangles: usize) -> Arc<Geometry> {
    let cx = LoadCx::unattended();
    let scene = scene::open(&format!("builtin:terrain?triangles={triangles}"), &cx).expect("made in code");
    Arc::new(Geometry::new(&scene, &cx).expect("fits"))
}

/// One test, so that no other is counted: [`PeakAlloc`] counts the whole process.
#[test]
fn building_takes_no_more_than_it_says() {
    the_wide_bvh_is_built_in_160_bytes_a_triangle();
    what_is_said_to_fit_fits();
    a_walk_takes_no_memory();
}

/// A grid's root has a child for each cell.
fn a_walk_takes_no_memory() {
    let grid = registry::find("grid").expect("registered");
    let grid = grid.build(&terrain(400_000), TestKind::Watertight, &grid.defaults(), &BuildCx::unattended(2)).expect("fits");
    MEMORY.reset_peak_usage();
    let before = MEMORY.current_usage();
    let stats = Stats::of(grid.as_ref(), SahWeights::default(), &Cancel::new()).expect("not cancelled");
    let peak = MEMORY.peak_usage() - before;
    assert!(stats.leaves > 500_000 && peak < 1 << 20, "{peak} bytes for {} cells", stats.leaves);
}

fn what_is_said_to_fit_fits() {
    let cx = BuildCx::unattended(2);
    for geometry in [terrain(20_000), terrain(400_000)] {
        for (id, each) in would_fit::KNOWN {
            let entry = registry::find(id).expect("registered");
            MEMORY.reset_peak_usage();
            let before = MEMORY.current_usage();
            let built = entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("fits");
            let peak = (MEMORY.peak_usage() - before) as u64;
            drop(built);
            let (said, triangles) = (each * geometry.live_count() as u64, geometry.live_count());
            println!("{id}: {} bytes a triangle of {triangles}", peak / triangles as u64);
            // Threads and tables take a little, however few the triangles.
            assert!(peak <= said + (1 << 20), "{id}: {peak} bytes for {triangles} triangles, {said} said");
        }
    }
}

fn the_wide_bvh_is_built_in_160_bytes_a_triangle() {
    let geometry = terrain(400_000);
    let wide = registry::find("wide").expect("registered");
    let cx = BuildCx::unattended(2);
    for builder in ["binned", "ploc", "lbvh"] {
        let mut params = wide.defaults();
        params.set("builder", builder).expect("a builder");
        MEMORY.reset_peak_usage();
        let before = MEMORY.current_usage();
        let built = wide.build(&geometry, TestKind::Watertight, &params, &cx).expect("fits");
        let peak = (MEMORY.peak_usage() - before) / geometry.live_count();
        let kept = built.memory().iter().map(|part| part.bytes as usize).sum::<usize>() / geometry.live_count();
        println!("{builder}: {peak} bytes a triangle at most, {kept} kept");
        assert!(kept <= peak, "{builder}: {kept} bytes kept, {peak} counted");
        assert!(peak <= BYTES_PER_TRIANGLE, "{builder}: {peak} bytes a triangle");
    }
}
