//! Bytes in use at a time, counted by the allocator. Alone in its target: other tests would be counted, too.

use std::sync::Arc;

use boxwood::accel::{BuildCx, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::scene::{self, Geometry, LoadCx};
use peak_alloc::PeakAlloc;

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The most that building may take beyond the geometry.
const BYTES_PER_TRIANGLE: usize = 160;

#[test]
fn the_wide_bvh_is_built_in_160_bytes_a_triangle() {
    let geometry = {
        let cx = LoadCx::unattended();
        let scene = scene::open("builtin:terrain?triangles=400000", &cx).expect("made in code");
        Arc::new(Geometry::new(&scene, &cx).expect("fits"))
    };
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
