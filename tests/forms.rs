//! What cells look like, of every structure: within their boxes, closed, as large as they say.

use std::ops::ControlFlow;
use std::sync::Arc;

use boxwood::accel::cell::{Descend, walk};
use boxwood::accel::volumes::KINDS;
use boxwood::accel::{Accel, BuildCx, Cell, Form, Shape, registry};
use boxwood::geometry::polytope::polygon_area;
use boxwood::geometry::tri::TestKind;
use boxwood::scene::{Geometry, LoadCx, open};
use glam::DVec3;

fn geometry(model: &str) -> Arc<Geometry> {
    let cx = LoadCx::unattended();
    Arc::new(Geometry::new(&open(model, &cx).expect("built in"), &cx).expect("fits"))
}

fn built(geometry: &Arc<Geometry>, id: &str, volume: Option<&str>) -> Box<dyn Accel> {
    let entry = registry::find(id).expect("registered");
    let mut params = entry.defaults();
    if let Some(volume) = volume {
        params.set("volume", volume).expect("a kind");
    }
    entry.build(geometry, TestKind::Watertight, &params, &BuildCx::unattended(1)).expect("builds")
}

/// The first so many cells of a walk.
fn cells(accel: &dyn Accel, most: usize) -> Vec<Cell> {
    let mut cells = Vec::new();
    walk(accel, &mut |cell| {
        cells.push(*cell);
        if cells.len() < most { ControlFlow::Continue(Descend::Yes) } else { ControlFlow::Break(()) }
    });
    cells
}

/// Whether a form is in its cell's box, as large as the shape says, and closed.
#[track_caller]
fn check(name: &str, accel: &dyn Accel, cell: &Cell) {
    let (form, bounds) = (accel.form(cell), cell.shape.bounds());
    let size = f64::from(bounds.size().max_element());
    let (min, max) = (bounds.min.as_dvec3() - 1e-5 * size, bounds.max.as_dvec3() + 1e-5 * size);
    let inside = |p: &DVec3| p.cmpge(min).all() && p.cmple(max).all();
    let area = cell.shape.area();
    assert!((form.area() - area).abs() <= 1e-4 * size * size, "{name} {:?}: {} is not {area}", cell.id, form.area());
    match &form {
        Form::Box(own) => assert_eq!(own, bounds),
        Form::Sphere { centre, radius } => assert!(inside(&(*centre - *radius)) && inside(&(*centre + *radius))),
        Form::Polyhedron(p) => {
            let (corners, edges) = (p.corners().len(), p.edges().count());
            assert_eq!(corners + p.face_count() - edges, 2, "{name} {:?}: {corners} corners, {edges} edges", cell.id);
            assert!(p.corners().iter().all(inside), "{name} {:?}", cell.id);
        }
    }
}

#[test]
fn forms_are_closed_and_as_large_as_their_shapes() {
    let geometry = geometry("builtin:teapot?triangles=500");
    for entry in registry::ALL {
        let accel = built(&geometry, entry.id, None);
        for cell in cells(accel.as_ref(), 300) {
            check(entry.id, accel.as_ref(), &cell);
            assert!(!matches!(cell.shape, Shape::Box(_)) || matches!(accel.form(&cell), Form::Box(_)), "{}", entry.id);
        }
    }
    for kind in KINDS {
        let accel = built(&geometry, "volumes", Some(kind.id));
        for cell in cells(accel.as_ref(), 300) {
            check(kind.id, accel.as_ref(), &cell);
        }
    }
}

#[test]
fn the_plane_of_a_bsp_node_parts_its_cell_into_its_children() {
    let geometry = geometry("builtin:teapot?triangles=500");
    let accel = built(&geometry, "bsp", None);
    let mut general = 0;
    for cell in cells(accel.as_ref(), 400) {
        let Some(split) = cell.split else { continue };
        let (form, mut parts) = (accel.form(&cell), Vec::new());
        accel.children(&cell, &mut |child| {
            parts.push(accel.form(&child).area());
            ControlFlow::Continue(())
        });
        let polygon = form.section(&split);
        let whole = form.area() + 2.0 * polygon_area(&polygon);
        assert!((parts.iter().sum::<f64>() - whole).abs() < 1e-6, "{:?}: {parts:?} of {whole}", cell.id);
        general += usize::from(!polygon.is_empty() && polygon.len() != 4);
    }
    assert!(general > 5, "planes that are no rectangles: {general}");
}
