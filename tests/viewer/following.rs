//! The Ray workspace: one ray, step by step, in several structures.

use std::time::Duration;

use boxwood::accel::Step;
use boxwood::lab::RayKind;
use boxwood::lab::follow::to_text;
use boxwood::viewer::format;
use boxwood::viewer::settings::Workspace;
use eframe::egui::{Event, Key, Modifiers, Role, vec2};
use egui_kittest::kittest::{NodeT, Queryable};

use crate::window::{Setup, Window};

/// A window in the Ray workspace, where the middle of the picture was clicked: two clicks.
fn follow(model: &str) -> Window {
    let mut setup = Setup { size: vec2(1280.0, 800.0), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    let mut w = Window::new(setup).settled();
    w.button("Ray workspace");
    assert_eq!(w.state().settings.workspace, Workspace::Ray);
    assert!(w.says("No ray yet. Click a pixel."));
    let at = w.viewport().center();
    w.press_in_one_frame(at);
    w.until("the steps", |s| !s.rays.columns.is_empty());
    w.settle();
    w
}

#[test]
fn why_a_pixel_is_slow_is_told_step_by_step() {
    let mut w = follow("builtin:teapot?triangles=1000");
    let rays = &w.state().rays;
    let followed = rays.columns[0].followed.clone();
    assert!(followed.hit.is_some() && followed.steps.len() > 3 && rays.at == 0);
    // What the click says of the ray is what its steps come to.
    let (nodes, tests) = (format::count(followed.counts.nodes), format::count(followed.counts.prims));
    assert!(w.state().picked.as_ref().is_some_and(|p| p.text.ends_with(&format!("this ray took {nodes} nodes, {tests} tests"))));
    w.button("Next");
    assert_eq!(w.state().rays.at, 1);
    w.button("Next leaf");
    let at = w.state().rays.at;
    assert_eq!(followed.leaf(1, true), Some(at));
    let cell = *followed.cell_at(at).expect("a leaf");
    assert!(cell.is_leaf() && w.says(&format!("enters {}", cell.id.node)));
    // The cell is lit in the view.
    let lit = w.state().overlay.as_ref().and_then(|overlay| overlay.selected).expect("lit");
    assert!((lit.at(glam::Vec3::ZERO) - cell.shape.bounds().min).length() < 1e-6);
    w.button("Back");
    assert_eq!(w.state().rays.at, at - 1);
    w.button("End");
    let best = followed.steps.last().expect("steps").best;
    assert_eq!((w.state().rays.at, Some(best)), (followed.steps.len() - 1, followed.hit.map(|hit| hit.t)));
    w.button("Start");
    assert_eq!(w.state().rays.at, 0);
}

#[test]
fn keys_and_clicks_go_to_steps() {
    let mut w = follow("builtin:teapot?triangles=1000");
    let name =
        w.harness.get_all_by_role(Role::ListItem).nth(2).and_then(|row| row.accesskit_node().label()).expect("a third step");
    w.click(Role::ListItem, &name);
    assert_eq!(w.state().rays.at, 2);
    w.key(Modifiers::NONE, Key::ArrowDown);
    assert_eq!(w.state().rays.at, 3);
    w.key(Modifiers::NONE, Key::ArrowUp);
    assert_eq!(w.state().rays.at, 2);
    w.key(Modifiers::NONE, Key::ArrowRight);
    let followed = &w.state().rays.columns[0].followed;
    assert_eq!(followed.leaf(2, true), Some(w.state().rays.at));
}

#[test]
fn other_structures_trace_the_same_ray_beside_it() {
    let mut w = follow("builtin:teapot?triangles=1000");
    for name in ["k-d tree beside", "Grid beside", "Octree beside"] {
        w.button(name);
        w.settle();
    }
    let rays = &w.state().rays;
    let ids: Vec<&str> = rays.columns.iter().map(|column| column.built.key.entry.id).collect();
    assert_eq!(ids, ["bvh", "kdtree", "grid", "octree"]);
    let hits: Vec<_> = rays.columns.iter().map(|column| column.followed.hit.map(|hit| hit.primitive)).collect();
    assert!(hits.iter().all(|hit| *hit == hits[0]), "{hits:?}");
    // No more than four.
    assert!(w.harness.get_by_role_and_label(Role::Button, "BSP beside").accesskit_node().is_disabled());
    w.button("Next leaf");
    let rays = &w.state().rays;
    let t = rays.columns[0].followed.reached(rays.at);
    for i in 1..4 {
        let (steps, at) = (&rays.columns[i].followed.steps, rays.position(i));
        assert!(steps[..=at].iter().skip(1).all(|step| step.t <= t) && steps.get(at + 1).is_none_or(|step| step.t > t));
    }
    // Whose step is chosen leads.
    let grid = w.harness.get_by_role_and_label(Role::List, "Steps of Grid").rect();
    let row =
        w.harness.get_all_by_role(Role::ListItem).filter(|row| grid.contains(row.rect().center())).nth(1).expect("a row").rect();
    w.press_in_one_frame(row.center());
    w.step();
    assert_eq!(w.state().rays.lead, 2);
    // At its end all are at theirs.
    w.button("End");
    let rays = &w.state().rays;
    assert!((0..4).all(|i| rays.position(i) + 1 == rays.columns[i].followed.steps.len()));
}

#[test]
fn shadow_rays_and_bounces_leave_what_the_pixel_meets() {
    let mut w = follow("builtin:teapot?triangles=1000");
    let pixel = w.state().rays.ray.expect("followed");
    let hit = w.state().rays.columns[0].followed.hit.expect("met");
    let there = pixel.at(hit.t);
    w.choose("The pixel's ray", "Shadow ray from there");
    w.settle();
    let rays = &w.state().rays;
    let shadow = rays.ray.expect("followed");
    assert_eq!((rays.kind, rays.columns[0].followed.mode), (RayKind::Shadow, RayKind::Shadow.mode()));
    assert!(shadow.origin.distance(there) < 1e-3 * there.distance(pixel.origin) && shadow.dir != pixel.dir);
    w.choose("Shadow ray from there", "Bounce from there");
    w.settle();
    assert_eq!(w.state().rays.kind, RayKind::Diffuse);
    // Another structure traces the same.
    let bounce = w.state().rays.ray;
    w.button("k-d tree");
    w.until("its steps", |s| s.rays.columns.first().is_some_and(|column| column.built.key.entry.id == "kdtree"));
    w.settle();
    let after = w.state().rays.ray.expect("followed");
    assert!(bounce.is_some_and(|before| before.dir.distance(after.dir) < 1e-3));
}

#[test]
fn a_ray_is_played_and_can_be_paused() {
    let mut w = follow("builtin:teapot?triangles=1000");
    let last = w.state().rays.last();
    w.button("Play");
    w.until("two steps", |s| s.rays.at >= 2);
    w.button("Pause");
    let at = w.state().rays.at;
    assert!(w.state().rays.playing.is_none());
    std::thread::sleep(Duration::from_millis(400));
    w.step();
    assert_eq!(w.state().rays.at, at);
    // From the end it begins anew, and at the end it rests.
    w.button("End");
    w.button("Play");
    assert!(w.state().rays.playing.is_some() && w.state().rays.at < last);
}

#[test]
fn a_ray_is_pasted_as_text() {
    let mut w = follow("builtin:teapot?triangles=1000");
    let ray = w.state().rays.ray.expect("followed");
    assert!(w.says(&to_text(&ray)[..8]));
    let mut paste = |text: &str| {
        let field = w.harness.get_by(|n| n.role() == Role::TextInput);
        field.click();
        w.step();
        w.harness.event(Event::Text(text.to_owned()));
        w.step();
        w.key(Modifiers::NONE, Key::Enter);
        w.settle();
        w.state().rays.ray
    };
    assert_eq!(paste("1 2 3"), Some(ray), "the last one stays");
    let other = paste("0 0 50  0 0 -1").expect("followed");
    assert_eq!((other.origin.z, other.dir.z), (50.0, -1.0));
    assert!(!w.state().rays.columns[0].followed.steps.is_empty());
    assert!(w.state().rays.columns[0].followed.steps.iter().any(|step| matches!(step.step, Step::Entered(_))));
}
