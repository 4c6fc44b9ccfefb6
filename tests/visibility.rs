//! Triangles of cells that are isolated or hidden: the picture is that of a scene without the others.

mod common;

use std::collections::HashSet;
use std::ops::ControlFlow;
use std::sync::Arc;

use boxwood::accel::cell::{Cell, CellKind, Descend, walk, walk_below};
use boxwood::accel::visibility::{Change, Visibility, VisibilityError, Written};
use boxwood::accel::{self, Accel, Filter, Hit, registry};
use boxwood::geometry::tri::TestKind;
use boxwood::render::{Film, Job, Mode, Until, render};
use boxwood::scene::{Camera, Geometry, Instance, LoadCx, Scene};
use boxwood::task::{Budget, Cancel, Pool, Progress};
use common::{ball, build, geometry_of, scene_of, soup};
use glam::{Affine3A, Quat, Vec3};

type Triangles = HashSet<(u32, u32)>;

const SIZE: [u32; 2] = [60, 40];

fn built(geometry: &Arc<Geometry>, id: &str) -> Arc<dyn Accel> {
    Arc::from(build(registry::find(id).expect("registered"), geometry, TestKind::Watertight))
}

fn job(scene: &Arc<Scene>, accel: Arc<dyn Accel>, mode: Mode) -> Job {
    let camera = Camera::framing(accel.geometry().world_bounds(), Vec3::new(1.0, 0.7, 2.0), Vec3::Y, 1.5);
    Job::new(Arc::clone(scene), accel, camera, mode, Arc::default())
}

fn film(job: &Job) -> Film {
    let (pool, until) = (Pool::new("test", 2), Until::samples(1));
    render(job, (SIZE[0], SIZE[1]), &until, &pool, &Cancel::new(), &Progress::new()).expect("not cancelled").film
}

fn change(before: Option<&Visibility>, accel: &dyn Accel, cell: &Cell, change: Change) -> Arc<Visibility> {
    Arc::new(Visibility::change(before, accel, (cell, change), &Budget::unlimited(), &Cancel::new()).expect("some triangles"))
}

/// The triangles that a cell and those below it hold.
fn held(accel: &dyn Accel, cell: &Cell) -> Triangles {
    let mut all = Triangles::new();
    walk_below(accel, *cell, &mut |cell| {
        if cell.is_leaf() {
            let place = accel.level(cell.id.instance).and_then(|level| level.instance);
            accel.prims(cell, &mut |prim| {
                all.insert(place.map_or_else(|| accel.geometry().locate(prim), |instance| (instance, prim)));
            });
        }
        ControlFlow::Continue(Descend::Yes)
    });
    all
}

/// Some cells that hold triangles, but not all of them.
fn cells(accel: &dyn Accel, most: usize) -> Vec<Cell> {
    let (mut cells, all) = (Vec::new(), held(accel, &accel.root()).len());
    walk(accel, &mut |cell| {
        let count = held(accel, cell).len();
        if count > 0 && count < all && cell.kind != CellKind::Void {
            cells.push(*cell);
        }
        if cells.len() < most { ControlFlow::Continue(Descend::Yes) } else { ControlFlow::Break(()) }
    });
    cells
}

struct Among<'a>(&'a Triangles);

impl Filter for Among<'_> {
    fn accepts(&self, hit: &Hit) -> bool {
        self.0.contains(&(hit.instance, hit.primitive))
    }
}

#[test]
fn isolated_triangles_are_a_scene_of_their_own() {
    for triangles in [ball(10), soup(200, 0.4, 9)] {
        let scene = Arc::new(scene_of(&triangles));
        let geometry = geometry_of(&scene);
        let brute = built(&geometry, "brute");
        for entry in registry::ALL {
            let accel = built(&geometry, entry.id);
            for cell in cells(accel.as_ref(), 5) {
                let seen = held(accel.as_ref(), &cell);
                let job = job(&scene, Arc::clone(&accel), Mode::Depth);
                let visible = change(None, accel.as_ref(), &cell, Change::Isolate);
                assert_eq!(visible.count() as usize, held(accel.as_ref(), &accel.root()).len() - seen.len());
                let isolated = film(&Job { visible: Some(Arc::clone(&visible)), ..job.clone() });
                // To the bit what brute force finds among those triangles.
                let rays = job.camera_rays(SIZE[0], SIZE[1], 0..SIZE[1], 0);
                let mut hits = vec![None; rays.len()];
                let among = Among(&seen);
                brute.trace_filtered(&rays, accel::Mode::Closest, &among, &mut hits, &Cancel::new()).expect("not cancelled");
                let scale = geometry.space().scale();
                let depth = |hit: &Option<Hit>| hit.map_or(f32::INFINITY, |hit| (f64::from(hit.t) * scale) as f32);
                let wrong = hits.iter().zip(isolated.depth().iter()).filter(|(hit, found)| depth(hit) != **found).count();
                assert!(wrong * 500 < rays.len(), "{}: {wrong} pixels", entry.id);
                // And what a scene without the others shows, but for rounding.
                let alone: Vec<[Vec3; 3]> = {
                    let mut numbers: Vec<u32> = seen.iter().map(|(_, primitive)| *primitive).collect();
                    numbers.sort_unstable();
                    numbers.into_iter().map(|i| triangles[i as usize]).collect()
                };
                let own_scene = Arc::new(scene_of(&alone));
                let own = geometry_of(&own_scene);
                let own_job = Job { camera: job.camera, ..self::job(&own_scene, built(&own, "bvh"), Mode::Depth) };
                let (own_film, own_scale) = (film(&own_job), own.space().scale());
                let world = |depth: f32, scale: f64| f64::from(depth) / scale;
                let near = |(a, b): (&f32, &f32)| {
                    let (a, b) = (world(*a, scale), world(*b, own_scale));
                    a == b || (a - b).abs() < 1e-4 * a.abs()
                };
                let same = isolated.depth().iter().zip(own_film.depth().iter()).filter(|pair| near(*pair)).count();
                assert!((rays.len() - same) * 200 < rays.len(), "{}: {same} of {} pixels", entry.id, rays.len());
            }
        }
    }
}

#[test]
fn what_is_isolated_and_what_is_hidden_are_the_whole() {
    let scene = Arc::new(scene_of(&ball(10)));
    let geometry = geometry_of(&scene);
    let accel = built(&geometry, "bvh");
    let job = job(&scene, Arc::clone(&accel), Mode::Depth);
    let whole = film(&job);
    for cell in cells(accel.as_ref(), 6) {
        let [isolated, hidden] = [Change::Isolate, Change::Hide].map(|which| {
            let visible = change(None, accel.as_ref(), &cell, which);
            film(&Job { visible: Some(visible), ..job.clone() }).depth().to_vec()
        });
        let both: Vec<f32> = isolated.iter().zip(&hidden).map(|(a, b)| a.min(*b)).collect();
        assert_eq!(both, whole.depth().to_vec());
    }
    // Hidden besides what is hidden already; isolated whatever is hidden.
    let cells = cells(accel.as_ref(), 6);
    let first = change(None, accel.as_ref(), &cells[2], Change::Hide);
    let second = change(Some(&first), accel.as_ref(), &cells[5], Change::Hide);
    let union: Triangles = held(accel.as_ref(), &cells[2]).union(&held(accel.as_ref(), &cells[5])).copied().collect();
    assert_eq!(second.count() as usize, union.len());
    assert!(second != first && first.is_of(&geometry) && !first.is_of(&geometry_of(&scene)));
    let isolated = change(Some(&second), accel.as_ref(), &cells[2], Change::Isolate);
    assert!(held(accel.as_ref(), &cells[2]).iter().all(|(instance, primitive)| isolated.sees(&geometry, *instance, *primitive)));
}

#[test]
fn hidden_triangles_are_hidden_in_every_structure_and_from_every_ray() {
    let scene = Arc::new(scene_of(&ball(10)));
    let geometry = geometry_of(&scene);
    let bvh = built(&geometry, "bvh");
    // Half of the ball, so that some of it is in view.
    let cell = cells(bvh.as_ref(), 1)[0];
    let visible = change(None, bvh.as_ref(), &cell, Change::Hide);
    for mode in [Mode::Shaded, Mode::Ao, Mode::Path] {
        let of = |id: &str| Job { visible: Some(Arc::clone(&visible)), ..job(&scene, built(&geometry, id), mode) };
        let expected = film(&of("brute"));
        assert!(expected != film(&Job { visible: None, ..of("brute") }));
        for id in ["bvh", "wide", "kdtree", "grid2", "octree", "bsp"] {
            assert!(film(&of(id)) == expected, "{id} in {mode:?}");
        }
    }
}

/// A mesh that stands in five places, and one that stands in one.
fn placed_scene() -> Scene {
    let [mesh, single] = [ball(8), soup(40, 0.4, 3)].map(|triangles| scene_of(&triangles).meshes.remove(0));
    let placed = |i: u8| {
        let at = Vec3::new(f32::from(i) * 2.5, f32::from(i % 2), 0.0);
        Instance { mesh: 0, world_from_object: Affine3A::from_rotation_translation(Quat::from_rotation_y(f32::from(i)), at) }
    };
    let instances = (0..5).map(placed).chain([Instance::identity(1)]).collect();
    Scene { meshes: vec![mesh, single], instances, up: Vec3::Y, ..Scene::default() }
}

/// Cells of both levels: the first of the upper, some roots below it, and what is below those.
fn cells_of_both(accel: &dyn Accel) -> Vec<Cell> {
    let mut some: Vec<Cell> = cells(accel, 4);
    walk(accel, &mut |cell| {
        let below = cell.id.instance > 0 && cell.is_leaf() && !held(accel, cell).is_empty();
        if below && some.len() < 12 {
            some.push(*cell);
        }
        ControlFlow::Continue(Descend::Yes)
    });
    assert!(some.iter().any(|cell| cell.id.instance > 0));
    some
}

#[test]
fn places_of_a_mesh_are_hidden_one_by_one() {
    let scene = placed_scene();
    let geometry = Arc::new(Geometry::with_instances(&scene, &LoadCx::unattended()).expect("small"));
    assert!(geometry.placed().is_some());
    for id in ["bvh", "kdtree", "brute"] {
        let accel = built(&geometry, id);
        let all = held(accel.as_ref(), &accel.root());
        for cell in cells_of_both(accel.as_ref()) {
            let of_cell = held(accel.as_ref(), &cell);
            let sees = |visible: &Visibility| -> Triangles {
                all.iter().copied().filter(|(instance, primitive)| visible.sees(&geometry, *instance, *primitive)).collect()
            };
            let isolated = change(None, accel.as_ref(), &cell, Change::Isolate);
            assert!(sees(&isolated) == of_cell, "{id}, {:?}", cell.id);
            assert_eq!(isolated.count() as usize, all.len() - of_cell.len());
            let hidden = change(None, accel.as_ref(), &cell, Change::Hide);
            assert!(sees(&hidden) == all.difference(&of_cell).copied().collect(), "{id}, {:?}", cell.id);
            // Hidden again it is as it was.
            let twice = change(Some(&hidden), accel.as_ref(), &cell, Change::Hide);
            assert!(sees(&twice) == sees(&hidden) && twice.count() == hidden.count());
        }
    }
}

#[test]
fn it_says_why_nothing_can_be_hidden() {
    let scene = Arc::new(scene_of(&soup(200, 0.3, 5)));
    let geometry = geometry_of(&scene);
    let accel = built(&geometry, "bvh");
    let root = accel.root();
    let (none, stopped) = (Budget::new(0), Cancel::new());
    stopped.cancel();
    let hide = |budget: &Budget, cancel: &Cancel| {
        Visibility::change(None, accel.as_ref(), (&root, Change::Isolate), budget, cancel).map(|visible| visible.count())
    };
    assert!(matches!(hide(&none, &Cancel::new()), Err(VisibilityError::Memory(_))));
    assert!(matches!(hide(&Budget::unlimited(), &stopped), Err(VisibilityError::Cancelled(_))));
    assert_eq!(hide(&Budget::unlimited(), &Cancel::new()), Ok(0));
    // Isolating takes a second set for a while.
    let whole = Budget::of_mib(1);
    let hidden = Visibility::change(None, accel.as_ref(), (&root, Change::Hide), &whole, &Cancel::new()).expect("fits");
    let one = Budget::new(whole.used());
    assert!(matches!(hide(&one, &Cancel::new()), Err(VisibilityError::Memory(_))));
    assert_eq!((hide(&Budget::new(2 * whole.used()), &Cancel::new()), one.used()), (Ok(0), 0));
    assert_eq!(hidden.count(), geometry.live_count() as u64);
    // What is charged is given back with the set.
    let budget = Budget::of_mib(1);
    drop(Visibility::change(None, accel.as_ref(), (&root, Change::Hide), &budget, &Cancel::new()).expect("fits"));
    assert_eq!(budget.used(), 0);
    // An empty cell of a grid.
    let grid = built(&geometry, "grid");
    let mut empty = None;
    walk(grid.as_ref(), &mut |cell| {
        let is_empty = matches!(cell.kind, CellKind::Void | CellKind::Leaf { prims: 0 });
        empty = empty.or_else(|| is_empty.then_some(*cell));
        ControlFlow::Continue(Descend::Yes)
    });
    if let Some(cell) = empty {
        let nothing = Visibility::change(None, grid.as_ref(), (&cell, Change::Hide), &Budget::unlimited(), &Cancel::new());
        assert_eq!(nothing.err(), Some(VisibilityError::Empty));
    }
}

/// The triangles that are seen, of all.
fn seen(visible: &Visibility, geometry: &Geometry) -> Triangles {
    let all = (0..geometry.instance_end()).flat_map(|i| (0..geometry.count_of(i) as u32).map(move |p| (i, p)));
    all.filter(|(instance, primitive)| visible.sees(geometry, *instance, *primitive)).collect()
}

/// What is read of a set that was written to a file.
fn read(written: &Written, geometry: &Arc<Geometry>) -> Result<Visibility, VisibilityError> {
    let text = serde_json::to_string(written).expect("plain data");
    let written = serde_json::from_str(&text).expect("just written");
    Visibility::read(&written, geometry, &Budget::unlimited(), &Cancel::new())
}

fn written(visible: &Visibility, geometry: &Geometry) -> Written {
    visible.written(geometry, &Cancel::new()).expect("not cancelled")
}

#[test]
fn what_is_hidden_is_written_down_and_read_again() {
    let flat = geometry_of(&scene_of(&soup(200, 0.4, 9)));
    let ball = geometry_of(&scene_of(&ball(10)));
    let placed = Arc::new(Geometry::with_instances(&placed_scene(), &LoadCx::unattended()).expect("small"));
    let flattened = geometry_of(&placed_scene());
    for (geometry, other) in [(&flat, None), (&ball, None), (&placed, Some(&flattened)), (&flattened, Some(&placed))] {
        for id in ["bvh", "kdtree", "grid"] {
            let accel = built(geometry, id);
            let two_levels = geometry.placed().is_some();
            let some = if two_levels { cells_of_both(accel.as_ref()) } else { cells(accel.as_ref(), 8) };
            let mut before: Option<Arc<Visibility>> = None;
            for (i, cell) in some.iter().enumerate() {
                // What is hidden grows, and begins anew with every third cell.
                let which = if i % 3 == 0 { Change::Isolate } else { Change::Hide };
                let visible = change(before.as_deref(), accel.as_ref(), cell, which);
                let file = written(&visible, geometry);
                let again = read(&file, geometry).expect("of this scene");
                assert!(again != *visible && again.is_of(geometry), "a set of its own");
                assert_eq!(again.count(), visible.count());
                assert!(seen(&again, geometry) == seen(&visible, geometry), "{id}, {:?}", cell.id);
                assert_eq!(written(&again, geometry), file);
                // Instances that are flattened, or no longer, hold the same triangles.
                if let Some(other) = other {
                    let there = read(&file, other).expect("as many triangles");
                    assert!(seen(&there, other) == seen(&visible, geometry), "{id}, {:?}", cell.id);
                }
                before = Some(visible);
            }
        }
    }
}

#[test]
fn what_is_written_of_hidden_triangles_is_short_and_checked() {
    let geometry = geometry_of(&scene_of(&soup(200, 0.4, 9)));
    let accel = built(&geometry, "bvh");
    let text = |which| {
        let visible = change(None, accel.as_ref(), &accel.root(), which);
        serde_json::to_string(&written(&visible, &geometry)).expect("plain data")
    };
    assert_eq!(text(Change::Hide), r#"{"of":200,"runs":"0 200"}"#);
    assert_eq!(text(Change::Isolate), r#"{"of":200,"runs":"200"}"#);
    let of = |text: &str| serde_json::from_str::<Written>(text).expect("as it is written");
    let (budget, cancel) = (Budget::of_mib(1), Cancel::new());
    let read = |runs: &str| {
        let file = of(&format!(r#"{{"of":200,"runs":"{runs}"}}"#));
        Visibility::read(&file, &geometry, &budget, &cancel).map(|visible| visible.count())
    };
    assert_eq!(read("10 20 0 30 140"), Ok(50));
    assert_eq!(read(" 150  50 "), Ok(50));
    for runs in ["", "199", "201", "10 20", "200 1", "200 0", "10 x 190", "-10 210", "1.5 198.5", "99999999999999999999", "0 0 0"]
    {
        assert_eq!(read(runs), Err(VisibilityError::Damaged), "{runs}");
    }
    assert_eq!(budget.used(), 0, "what was not read takes nothing");
    let other = Visibility::read(&of(r#"{"of":199,"runs":"0 199"}"#), &geometry, &budget, &cancel);
    assert_eq!(other.err(), Some(VisibilityError::OfAnother { of: 199, has: 200 }));
    let whole = of(r#"{"of":200,"runs":"0 200"}"#);
    let none = Visibility::read(&whole, &geometry, &Budget::new(0), &cancel);
    assert!(matches!(none, Err(VisibilityError::Memory(_))));
    let visible = Visibility::read(&whole, &geometry, &budget, &cancel).expect("fits");
    assert!(budget.used() > 0);
    cancel.cancel();
    assert!(visible.written(&geometry, &cancel).is_err());
    assert!(matches!(Visibility::read(&whole, &geometry, &budget, &cancel), Err(VisibilityError::Cancelled(_))));
}
