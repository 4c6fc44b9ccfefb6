use super::*;
use crate::geometry::{Aabb, Axis, HalfSpace, Side};
use crate::render::Range;
use crate::scene::{Camera, Projection};

/// A view along -z of a box in the middle, its right half behind a surface that is near.
fn figure() -> Figure {
    let space = Space::new(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
    let camera =
        Camera { eye: Vec3::Z * 4.0, target: Vec3::ZERO, up: Vec3::Y, projection: Projection::Perspective { fov_y: 1.0 } };
    let size = [40u32, 20];
    let depth = (0..800).map(|i| if i % 40 >= 20 { 0.1 } else { f32::INFINITY }).collect();
    let picture = Picture {
        generation: 1,
        request: 1,
        camera,
        width: size[0],
        height: size[1],
        rgba: vec![0; 3200],
        depth: Arc::new(depth),
        range: Range { min: 0.0, max: 1.0 },
        progress: crate::render::Progress::default(),
        amounts: None,
        suits: Range { min: 0.0, max: 1.0 },
        shots: Vec::new(),
    };
    let cell = Aabb { min: Vec3::splat(-0.2), max: Vec3::splat(0.2) };
    let overlay = Overlay { boxes: vec![BoxInstance::new(&cell, [9, 8, 7, 255])], ..Overlay::default() };
    Figure {
        picture: Arc::new(picture),
        overlay: Some(Arc::new(overlay)),
        marks: Vec::new(),
        view: View::new(&camera, &space, 2.0),
        space,
        size,
        hidden_lines: true,
        caption: "a <b> & c".to_owned(),
    }
}

fn text(figure: &Figure) -> String {
    String::from_utf8(figure.svg(&Cancel::new()).expect("made")).expect("text")
}

#[test]
fn what_is_behind_a_surface_is_dashed_and_can_be_left_out() {
    let mut figure = figure();
    let svg = text(&figure);
    assert!(svg.contains("a &lt;b&gt; &amp; c") && svg.contains("data:image/png;base64,"));
    assert_eq!((svg.matches("stroke-dasharray").count(), svg.matches("stroke=\"#090807\"").count()), (1, 2));
    assert!(!svg.contains("NaN") && resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).is_ok());
    figure.hidden_lines = false;
    assert!(!text(&figure).contains("stroke-dasharray"));
    let stopped = Cancel::new();
    stopped.cancel();
    assert!(figure.svg(&stopped).is_err());
}

#[test]
fn a_flat_box_has_four_edges_and_a_box_has_twelve() {
    let figure = figure();
    let lines = |size: Vec3| {
        let mut lines = Lines::default();
        // Left of the middle, where nothing is in front.
        let cell = Aabb { min: Vec3::new(-0.3, -0.1, 0.0), max: Vec3::new(-0.3, -0.1, 0.0) + size };
        figure.edges(&BoxInstance::new(&cell, [0; 4]), &mut lines);
        lines.visible.matches('M').count()
    };
    assert_eq!((lines(Vec3::splat(0.1)), lines(Vec3::new(0.1, 0.1, 0.0)), lines(Vec3::X * 0.1)), (12, 4, 1));
}

#[test]
fn pictures_keep_their_colours_where_they_are_half_clear() {
    let mut figure = figure();
    let picture = Arc::get_mut(&mut figure.picture).expect("ours alone");
    picture.rgba[..8].copy_from_slice(&[64, 32, 0, 128, 10, 20, 30, 255]);
    let read = image::load_from_memory(&png(picture).expect("made")).expect("a picture").into_rgba8();
    assert_eq!((read.get_pixel(0, 0).0, read.get_pixel(1, 0).0), ([127, 63, 0, 128], [10, 20, 30, 255]));
    assert_eq!(read.dimensions(), (40, 20));
}

/// A figure of what `put` puts into an overlay.
fn of(put: impl FnOnce(&mut Overlay)) -> Figure {
    let mut overlay = Overlay::default();
    put(&mut overlay);
    Figure { overlay: Some(Arc::new(overlay)), ..figure() }
}

#[test]
fn all_of_an_overlay_is_drawn_each_in_its_style() {
    // Left of the middle, where nothing is in front.
    let at = Vec3::new(-0.4, 0.1, 0.0);
    let [a, b, c] = [at, at + Vec3::X * 0.1, at + Vec3::Y * 0.1];
    let color = [0x12, 0x34, 0x56, 255];
    let line = BoxInstance::line(a, b, color);
    let boxed = BoxInstance::new(&Aabb { min: a, max: a + Vec3::splat(0.1) }, color);
    let flat = BoxInstance::new(&Aabb { min: a, max: a + Vec3::new(0.1, 0.1, 0.0) }, color);
    let white = LineStyle::SELECTED.color.expect("its own").map(|c| format!("{c:02x}")).concat();
    let drawn = |put: &dyn Fn(&mut Overlay)| {
        let svg = text(&of(put));
        // A halo and a line for what is seen.
        let [own, selected] = [color[..3].iter().map(|c| format!("{c:02x}")).collect::<String>(), white.clone()]
            .map(|color| svg.matches(&format!("stroke=\"#{color}\"")).count());
        (svg.matches("<polygon").count(), own, selected)
    };
    assert_eq!(drawn(&|o| o.boxes = vec![boxed]), (0, 1, 0));
    assert_eq!(drawn(&|o| o.planes = vec![flat]), (1, 1, 0));
    assert_eq!(drawn(&|o| o.tried = Some(flat)), (1, 1, 0));
    assert_eq!(drawn(&|o| o.lines = vec![line]), (0, 1, 0));
    assert_eq!(drawn(&|o| o.fills = vec![BoxInstance::triangle([a, b, c], color)]), (1, 0, 0));
    assert_eq!(drawn(&|o| o.compared = vec![line]), (0, 1, 0));
    assert_eq!(drawn(&|o| o.selected = Some(boxed)), (0, 0, 1));
    assert_eq!(drawn(&|o| o.selected_lines = vec![line]), (0, 0, 1));
    assert_eq!(drawn(&|o| o.lit = vec![boxed]), (0, 0, 1));
    assert_eq!(drawn(&|o| o.lit_lines = vec![line]), (0, 0, 1));
    assert_eq!(drawn(&|_| {}), (0, 0, 0));
    let triangle = text(&of(|o| o.fills = vec![BoxInstance::triangle([a, b, c], color)]));
    let points = triangle.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a polygon");
    assert_eq!(points.split(' ').count(), 3, "{points}");
}

#[test]
fn what_the_section_cuts_away_is_not_drawn() {
    let line = BoxInstance::line(Vec3::new(-0.4, 0.1, 0.0), Vec3::new(-0.2, 0.1, 0.0), [1, 2, 3, 255]);
    let plane = BoxInstance::new(&Aabb { min: Vec3::new(-0.4, -0.1, 0.0), max: Vec3::new(-0.2, 0.1, 0.0) }, [1, 2, 3, 255]);
    let lines = |at: f32, instance: &BoxInstance| {
        let mut figure = figure();
        figure.view = figure.view.within(Some(HalfSpace { axis: Axis::X, at, side: Side::Below }));
        let (mut lines, mut fill) = (Lines::default(), String::new());
        figure.edges(instance, &mut lines);
        figure.fill_plane(instance, &mut fill);
        (lines.visible, fill)
    };
    let right_end = |at: f32| lines(at, &line).0.split('L').nth(1).map(|end| end.split(' ').next().unwrap_or("").to_owned());
    let cut: f32 = right_end(-0.3).and_then(|x| x.parse().ok()).expect("a half is left");
    let whole: f32 = right_end(0.0).and_then(|x| x.parse().ok()).expect("all is left");
    assert!(cut < whole - 0.5, "{cut} {whole}");
    assert_eq!(lines(-0.5, &line).0, "");
    assert_eq!(lines(0.0, &plane).0.matches('M').count(), 4);
    assert_eq!(lines(-0.3, &plane).0.matches('M').count(), 3, "the side beyond is gone");
    assert!(!lines(-0.3, &plane).1.is_empty() && lines(-0.5, &plane).1.is_empty());
}
