//! The window answers while the machine works.

use std::time::{Duration, Instant};

use crate::window::{PATIENCE, Setup, Window};

#[test]
fn frames_stay_short_while_a_large_build_runs() {
    let mut setup = Setup { alone: true, ..Setup::default() };
    setup.options.model = Some("builtin:terrain?triangles=300000".into());
    let mut w = Window::new(setup).settled();
    w.button("k-d tree");
    let (start, mut frames) = (Instant::now(), Vec::new());
    while w.state().building.is_some() {
        assert!(start.elapsed() < PATIENCE, "the build never ends");
        let frame = Instant::now();
        w.step();
        frames.push(frame.elapsed());
        std::thread::sleep(Duration::from_millis(8));
    }
    assert_eq!(w.shown(), Some("kdtree"));
    frames.sort();
    let (longest, count) = (frames[frames.len() - 1], frames.len());
    // On a machine that others use too, single frames wait for a core.
    let usual = frames[count * 95 / 100];
    println!("{count} frames in {:?} of building, 95 in 100 under {usual:?}, the longest {longest:?}", start.elapsed());
    assert!(usual < Duration::from_millis(100), "{usual:?}");
    assert!(longest < Duration::from_millis(500), "{longest:?}");
}
