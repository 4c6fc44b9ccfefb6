//! The Structure workspace: the tree of cells, and how the selected one is divided.

use boxwood::accel::outline::Rank;
use boxwood::geometry::Axis;
use boxwood::viewer::settings::{BoxColor, Workspace};
use eframe::egui::{Key, Modifiers, PointerButton, Role, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

/// A window in the Structure workspace; that took one click.
fn open(model: &str) -> Window {
    open_as_tall_as(model, 800.0)
}

fn open_as_tall_as(model: &str, height: f32) -> Window {
    let mut setup = Setup { size: vec2(1280.0, height), ..Setup::default() };
    setup.options.model = Some(model.to_owned());
    let mut w = Window::new(setup).settled();
    w.button("Structure workspace");
    assert_eq!(w.state().settings.workspace, Workspace::Structure);
    w.until("the cells are listed", |s| s.tree.outline.is_some());
    w.settle();
    w
}

fn selected(w: &Window) -> u32 {
    let tree = &w.state().tree;
    let (at, outline) = (tree.selected.expect("selected"), tree.outline.as_ref().expect("listed"));
    let cell = *w.state().picked.as_ref().and_then(|picked| picked.selected()).expect("its cell");
    assert_eq!(outline.row(at).id, cell.id);
    at
}

#[test]
fn the_deepest_leaf_and_the_dearest_cell_are_two_clicks_away() {
    let mut w = open("builtin:teapot?triangles=1000");
    for rank in Rank::ALL {
        w.button(rank.name());
        w.settle();
        let (outline, at) = (w.state().tree.outline.clone().expect("listed"), selected(&w));
        assert_eq!(outline.greatest(rank), Some(at), "{rank:?}");
        assert!(w.state().tree.folding.height_of(at).is_some(), "its row is open");
        let name = format!("{} {}", if outline.row(at).is_leaf() { "leaf" } else { "node" }, outline.row(at).id.node);
        assert!(w.says(&name), "{name} is in sight");
    }
    w.button("Close all");
    let tree = &w.state().tree;
    let outline = tree.outline.clone().expect("listed");
    assert_eq!(tree.folding.visible() as usize, 1 + outline.children(0).count());
    w.button("Open all");
    assert_eq!(w.state().tree.folding.visible(), outline.len());
    // Its box is drawn over the picture, whatever is chosen.
    assert!(w.state().overlay.as_ref().is_some_and(|overlay| overlay.selected.is_some()));
}

#[test]
fn a_click_in_the_picture_selects_the_leaf_in_the_tree() {
    let mut w = open("builtin:teapot?triangles=1000");
    let at = w.viewport().center();
    w.press_in_one_frame(at);
    w.until("a leaf", |s| s.picked.is_some());
    w.settle();
    let row = selected(&w);
    assert!(w.state().tree.outline.as_ref().expect("listed").row(row).is_leaf());
    // Another structure has another tree, in which nothing is selected.
    w.button("k-d tree");
    w.until("its cells", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "kdtree") && s.tree.outline.is_some());
    w.settle();
    assert_eq!(w.state().tree.selected, None);
    assert!(w.says("Nothing is selected. Click the picture, or a row of the tree."));
}

#[test]
fn keys_walk_the_tree() {
    let mut w = open("builtin:lecture");
    let node = |w: &Window, at: u32| {
        let row = w.state().tree.outline.as_ref().expect("listed").row(at);
        format!("{} {}, depth {}", if row.is_leaf() { "leaf" } else { "node" }, row.id.node, row.depth)
    };
    let name = node(&w, 0);
    w.harness.get_by(|n| n.role() == Role::TreeItem && n.label().is_some_and(|l| l.starts_with(&name))).click();
    w.settle();
    assert_eq!(selected(&w), 0);
    let mut press = |key, expected: u32| {
        w.key(Modifiers::NONE, key);
        w.settle();
        assert_eq!(selected(&w), expected, "{key:?}");
    };
    press(Key::ArrowRight, 1);
    press(Key::ArrowRight, 1); // it opens
    press(Key::ArrowRight, 2);
    press(Key::ArrowLeft, 1); // what is closed goes to its parent
    press(Key::ArrowLeft, 1); // it closes
    press(Key::ArrowLeft, 0);
    press(Key::ArrowDown, 1);
    press(Key::ArrowUp, 0);
    let last = w.state().tree.outline.as_ref().expect("listed").children(0).last().expect("two");
    w.key(Modifiers::NONE, Key::End);
    w.settle();
    assert_eq!(selected(&w), last);
    for (button, expected) in [("Sibling", 1), ("Child", 2), ("Parent", 1), ("Parent", 0)] {
        w.button(button);
        w.settle();
        assert_eq!(selected(&w), expected, "{button}");
    }
    // A selection is taken back like any other choice.
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!(selected(&w), 1);
}

#[test]
fn what_is_walked_over_is_one_step_to_take_back() {
    let mut w = open("builtin:teapot?triangles=1000");
    w.button(Rank::Depth.name());
    w.settle();
    let before = selected(&w);
    w.harness.get_by_role_and_label(Role::Tree, "Cells").focus();
    w.step();
    for _ in 0..4 {
        w.key(Modifiers::NONE, Key::ArrowUp);
        w.settle();
    }
    assert_ne!(selected(&w), before);
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!(selected(&w), before);
    w.key(Modifiers::COMMAND.plus(Modifiers::SHIFT), Key::Z);
    w.settle();
    assert_ne!(selected(&w), before);
}

#[test]
fn a_plane_is_tried_by_hand_by_keys_and_by_rule() {
    // As tall as what is said of a node: scrolling is another thing.
    let mut w = open_as_tall_as("builtin:lecture", 1200.0);
    w.button(Rank::Overlap.name());
    w.settle();
    w.button("Parent");
    w.settle();
    let plot = w.harness.get_by_role_and_label(Role::Image, "SAH cost over candidate planes").rect();
    let tried = |w: &Window| w.state().tree.tried.expect("a plane");
    w.drag(
        plot.left_center() + vec2(0.25 * plot.width(), 0.0),
        vec2(0.25 * plot.width(), 0.0),
        PointerButton::Primary,
        Modifiers::NONE,
    );
    let (axis, middle) = tried(&w);
    assert!((middle - 0.5).abs() < 0.05, "{middle}");
    assert!(w.state().overlay.as_ref().is_some_and(|overlay| overlay.tried.is_some()), "drawn over the view");
    w.key(Modifiers::NONE, Key::ArrowRight);
    assert!(tried(&w).1 > middle && tried(&w).0 == axis);
    w.key(Modifiers::NONE, Key::ArrowDown);
    assert_eq!(tried(&w).0, Axis::ALL[(axis.index() + 1) % 3]);
    // What a rule would have chosen is tried by a click, and costs what the table says.
    w.button("Spatial middle");
    w.settle();
    let curves = w.state().curves.clone().and_then(|curves| curves.1).expect("worked out");
    let rule =
        curves.others.iter().find(|other| other.name == "Spatial middle").and_then(|other| other.division).expect("divides");
    assert_eq!(tried(&w), rule.plane);
    assert_eq!(curves.at(rule.plane.0, rule.plane.1).cost, rule.cost);
    let exact = curves.others[0].division.expect("divides");
    assert!(curves.chosen.is_none_or(|chosen| chosen.cost + 1e-6 >= exact.cost.min(curves.leaf)) && rule.cost >= exact.cost);
    w.button("×");
    assert!(w.state().tree.tried.is_none() && w.state().overlay.as_ref().is_some_and(|overlay| overlay.tried.is_none()));
}

#[test]
fn the_outcome_can_be_hidden_until_asked() {
    let mut w = open("builtin:lecture");
    w.button(Rank::Overlap.name());
    w.settle();
    assert!(w.says("Chosen") && w.has(Role::Button, "Exact sweep"));
    w.click(Role::CheckBox, "Hide the outcome");
    w.step();
    assert!(!w.says("Chosen") && !w.has(Role::Button, "Exact sweep"));
    w.button("Reveal");
    w.step();
    assert!(w.says("Chosen"));
    // Of another cell it is hidden again.
    w.button("Child");
    w.settle();
    assert!(!w.says("Chosen") && w.has(Role::Button, "Reveal"));
}

#[test]
fn boxes_are_of_the_selected_cell_alone_and_coloured_by_what_they_cost() {
    let mut w = open("builtin:teapot?triangles=1000");
    w.button(Rank::Overlap.name());
    w.settle();
    w.button("Child");
    w.settle();
    w.click(Role::CheckBox, "Leaves only");
    w.settle();
    let all = w.state().collected.total;
    w.click(Role::CheckBox, "Selected cell only");
    w.settle();
    let (outline, at) = (w.state().tree.outline.clone().expect("listed"), selected(&w));
    let leaves = outline.below(at).filter(|row| outline.row(*row).is_leaf()).count();
    assert_eq!(w.state().collected.total, leaves);
    assert!(leaves < all && w.state().collected.range.is_none());
    w.choose(BoxColor::Depth.label(), BoxColor::Cost.label());
    w.settle();
    let [low, high] = w.state().collected.range.expect("a range");
    let shares = outline.below(at).map(|row| outline.row(row)).filter(|row| row.is_leaf()).map(|row| row.share as f32);
    let most = shares.fold(0.0, f32::max);
    assert!(low < high && high <= most * 1.000_1, "{low} {high} {most}");
    assert!(w.says("SAH share: "));
    // Taken back, step by step.
    w.key(Modifiers::COMMAND, Key::Z);
    w.settle();
    assert_eq!(w.state().settings.overlay.color, BoxColor::Depth);
}

#[test]
fn boxes_are_coloured_by_the_visits_of_the_present_view() {
    let mut w = open("builtin:teapot?triangles=1000");
    w.choose(BoxColor::Depth.label(), BoxColor::Visits.label());
    w.settle();
    let range = |w: &Window| w.state().collected.range.expect("counted");
    let [low, high] = range(&w);
    assert!(low >= 0.0 && low < high && high <= 1.0, "a ray enters a node once: {low} {high}");
    assert!(w.says("Visits a ray: "));
    w.button(Rank::Cost.name());
    w.settle();
    let cell = w.state().picked.as_ref().and_then(|picked| picked.selected()).expect("selected").id;
    assert!(w.state().visits().is_some_and(|visits| visits.a_ray(cell) > 0.0) && w.says("Visits a ray"));
    // From elsewhere they are others.
    w.drag(w.viewport().center(), vec2(160.0, 90.0), PointerButton::Primary, Modifiers::NONE);
    w.settle();
    assert_ne!(range(&w), [low, high]);
    // The list of cells is not needed for it, nor a tree.
    w.button("View workspace");
    w.button("Grid");
    w.settle();
    let [low, high] = range(&w);
    assert!(low < high && high <= 1.0, "{low} {high}");
}

#[test]
fn a_grid_of_many_cells_is_one_list() {
    let mut w = open("builtin:soup?triangles=20000");
    w.button("Grid");
    w.until("its cells", |s| s.shown.as_ref().is_some_and(|b| b.key.entry.id == "grid") && s.tree.outline.is_some());
    w.settle();
    let cells = w.state().tree.outline.as_ref().expect("listed").len();
    assert!(cells > 10_000 && w.state().tree.folding.visible() == cells);
    w.button(Rank::References.name());
    w.settle();
    let at = selected(&w);
    let row = w.state().tree.outline.as_ref().expect("listed").row(at);
    assert!(w.says(&format!("leaf {}", row.id.node)), "its row is in sight");
}

#[test]
fn causes_are_found_and_shown_by_one_click() {
    let mut setup = Setup { size: vec2(1280.0, 800.0), ..Setup::default() };
    setup.options.model = Some("builtin:teapot-in-stadium?triangles=500".to_owned());
    setup.options.structure = Some("grid".to_owned());
    let mut w = Window::new(setup).settled();
    w.button("Look for causes");
    w.until("sentences", |s| s.causes.found.is_some());
    w.settle();
    let found = w.state().causes.found.clone().expect("found");
    let row = found.list.first().and_then(|finding| finding.row).expect("a cell");
    assert!(w.says(&found.list[0].text) && found.rays > 0);
    w.button("Show finding 1");
    w.settle();
    assert_eq!((w.state().settings.workspace, selected(&w)), (Workspace::Structure, row));
    // Another view is another matter.
    w.button("View workspace");
    assert!(!w.has(Role::Button, "Look for causes"));
    w.drag(w.viewport().center(), vec2(80.0, 0.0), PointerButton::Primary, Modifiers::NONE);
    w.step();
    assert!(w.says("Of an earlier view.") && w.has(Role::Button, "Look for causes"));
    w.button("k-d tree");
    w.settle();
    assert!(w.state().causes.found.is_none());
}
