//! What a traversal costs for being one that can be watched, when nobody does: instructions of `brute` beside those of the
//! same loop written out by hand, counted by `callgrind` (Debian: `valgrind`). `cargo bench --bench off`
//!
//! Both are run for a few passes and for more, so that what comes before and after the passes is not counted.

mod common;

use std::hint::black_box;
use std::process::Command;
use std::sync::Arc;

use boxwood::accel::{BuildCx, Hit, Mode, registry};
use boxwood::geometry::Ray;
use boxwood::geometry::tri::{Block, Eight, TestKind, TriTest, Watertight, corners};
use boxwood::scene::{self, Geometry, LoadCx};
use boxwood::simd::{LANES, Portable};
use boxwood::task::Cancel;
use common::rays;

const MODEL: &str = "builtin:soup?triangles=5000";
const PASSES: [usize; 2] = [2, 12];
const WAYS: [&str; 2] = ["probe", "hand"];

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let args: Vec<String> = std::env::args().collect();
    if let [_, way, passes] = &args[..]
        && let Ok(passes) = passes.parse()
    {
        return pass(way, passes);
    }
    // Cargo asks every benchmark whether it still runs.
    if args.iter().any(|arg| arg == "--test") {
        return WAYS.iter().try_for_each(|way| pass(way, 1));
    }
    let mut each = [0.0; 2];
    for (way, each) in WAYS.iter().zip(&mut each) {
        let [few, many] = PASSES.map(|passes| instructions(way, passes));
        *each = (many? - few?) / (PASSES[1] - PASSES[0]) as f64;
        println!("{way:>6}: {each:.0} instructions a pass");
    }
    println!(" ratio: {:.4}", each[0] / each[1]);
    Ok(())
}

/// Instructions of this program for so many passes.
fn instructions(way: &str, passes: usize) -> Result<f64, Box<dyn std::error::Error>> {
    let mut valgrind = Command::new("valgrind");
    valgrind.args(["--tool=callgrind", "--callgrind-out-file=/dev/null"]).arg(std::env::current_exe()?);
    let ran = valgrind.arg(way).arg(passes.to_string()).output().map_err(|why| format!("valgrind can't be run: {why}"))?;
    let text = String::from_utf8_lossy(&ran.stderr);
    let count = text.lines().find_map(|line| line.split_once("Collected : ")).and_then(|(_, n)| n.trim().parse().ok());
    count.ok_or_else(|| format!("valgrind counted nothing:\n{text}").into())
}

/// Traces the rays so many times in one way.
fn pass(way: &str, passes: usize) -> Result<(), Box<dyn std::error::Error>> {
    let cx = LoadCx::unattended();
    let geometry = Arc::new(Geometry::new(&scene::open(MODEL, &cx)?, &cx)?);
    let rays = rays(&geometry);
    let triangles: Vec<_> = (0..geometry.live_count()).map(|i| geometry.corners(geometry.live(i))).collect();
    let blocks: Vec<Block> = triangles.chunks(LANES).map(|eight| Block::new(eight.iter().copied())).collect();
    let brute = registry::find("brute").ok_or("there is no brute force")?;
    let brute = brute.build(&geometry, TestKind::Watertight, &brute.defaults(), &BuildCx::unattended(1))?;
    let (mut probe, mut hand) = (vec![None; rays.len()], vec![None; rays.len()]);
    // Once each in either way, so that both find the same and the one counted is the only difference.
    brute.trace_like_for_like(&rays, Mode::Closest, &mut probe, &Cancel::new())?;
    by_hand(&geometry, &blocks, &rays, &mut hand);
    assert_eq!(probe, hand, "both find the same");
    for _ in 0..passes {
        match way {
            "probe" => brute.trace_like_for_like(black_box(&rays), Mode::Closest, &mut probe, &Cancel::new()).map(|_| ())?,
            _ => by_hand(&geometry, &blocks, black_box(&rays), &mut hand),
        }
    }
    Ok(())
}

/// The loop of `brute` written out: no probe, no query, no tie to ask about in a soup.
fn by_hand(geometry: &Geometry, blocks: &[Block], rays: &[Ray], hits: &mut [Option<Hit>]) {
    for (ray, hit) in rays.iter().zip(hits) {
        let entered = geometry.space().enter(ray);
        let test = Watertight::prepare(&entered.ray, geometry.bounds());
        let mut best = None;
        let mut end = entered.ray.tmax;
        for (b, block) in blocks.iter().enumerate() {
            let mut left = test.may_meet(Portable, &corners(Portable, block, test.axes()));
            while left != 0 {
                let lane = left.trailing_zeros() as usize;
                left &= left - 1;
                if b * LANES + lane < geometry.live_count()
                    && let Some(found) = test.hit(&block.triangle(lane), entered.ray.tmin, end)
                {
                    end = found.t;
                    best = Some((found, geometry.live(b * LANES + lane)));
                }
            }
        }
        *hit = best.map(|(found, prim)| {
            let (instance, primitive) = geometry.locate(prim);
            Hit { t: entered.back.world_t(found.t), u: found.u, v: found.v, instance, primitive }
        });
    }
}
