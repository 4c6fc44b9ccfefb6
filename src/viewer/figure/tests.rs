use super::drawing::Lines;
use super::*;
use crate::geometry::{Aabb, Axis, HalfSpace, Side, Space};
use crate::lab::plot::png_of;
use crate::render::Range;
use crate::render::colormap::viridis;
use crate::scene::{Camera, Projection};
use crate::viewer::gpu::BoxInstance;
use crate::viewer::panes::Arrange;
use glam::Vec3;

/// A view along -z of a box in the middle, its right half behind a surface that is near.
fn drawing() -> Drawing {
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
    Drawing {
        picture: Arc::new(picture),
        overlay: Some(Arc::new(overlay)),
        marks: Vec::new(),
        view: View::new(&camera, &space, 2.0),
        space,
        size,
        begin: 0.0,
        hidden_lines: true,
    }
}

/// Pictures as a figure.
fn figure(drawings: Vec<Option<Drawing>>, layout: Layout) -> Figure {
    let (names, captions, legends) = (Vec::new(), Vec::new(), Vec::new());
    Figure { drawings, layout, view: [40, 20], names, captions, legends, caption: "a <b> & c".to_owned() }
}

fn text_of(figure: &Figure) -> String {
    String::from_utf8(figure.svg(&Cancel::new()).expect("made")).expect("text")
}

/// A figure of one picture.
fn text(drawing: Drawing) -> String {
    text_of(&figure(vec![Some(drawing)], Layout::Alone))
}

#[test]
fn what_is_behind_a_surface_is_dashed_and_can_be_left_out() {
    let svg = text(drawing());
    assert!(svg.contains("a &lt;b&gt; &amp; c") && svg.contains("data:image/png;base64,"));
    assert_eq!((svg.matches("stroke-dasharray").count(), svg.matches("stroke=\"#090807\"").count()), (1, 2));
    assert!(!svg.contains("NaN") && resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).is_ok());
    assert!(!text(Drawing { hidden_lines: false, ..drawing() }).contains("stroke-dasharray"));
    let stopped = Cancel::new();
    stopped.cancel();
    assert!(figure(vec![Some(drawing())], Layout::Alone).svg(&stopped).is_err());
}

#[test]
fn a_flat_box_has_four_edges_and_a_box_has_twelve() {
    let drawing = drawing();
    let lines = |size: Vec3| {
        let mut lines = Lines::default();
        // Left of the middle, where nothing is in front.
        let cell = Aabb { min: Vec3::new(-0.3, -0.1, 0.0), max: Vec3::new(-0.3, -0.1, 0.0) + size };
        drawing.edges(&BoxInstance::new(&cell, [0; 4]), &mut lines);
        lines.visible.matches('M').count()
    };
    assert_eq!((lines(Vec3::splat(0.1)), lines(Vec3::new(0.1, 0.1, 0.0)), lines(Vec3::X * 0.1)), (12, 4, 1));
}

#[test]
fn pictures_keep_their_colours_where_they_are_half_clear() {
    let mut drawing = drawing();
    let picture = Arc::get_mut(&mut drawing.picture).expect("ours alone");
    picture.rgba[..8].copy_from_slice(&[64, 32, 0, 128, 10, 20, 30, 255]);
    let read = image::load_from_memory(&png(picture).expect("made")).expect("a picture").into_rgba8();
    assert_eq!((read.get_pixel(0, 0).0, read.get_pixel(1, 0).0), ([127, 63, 0, 128], [10, 20, 30, 255]));
    assert_eq!(read.dimensions(), (40, 20));
}

/// A picture with what `put` puts into an overlay.
fn of(put: impl FnOnce(&mut Overlay)) -> Drawing {
    let mut overlay = Overlay::default();
    put(&mut overlay);
    Drawing { overlay: Some(Arc::new(overlay)), ..drawing() }
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
    let drawn = |put: &dyn Fn(&mut Overlay)| {
        let svg = text(of(put));
        // A halo and a line for what is seen.
        let [own, selected] = [LineStyle::BOX, LineStyle::SELECTED]
            .map(|style| svg.matches(&format!("stroke=\"#123456\" stroke-width=\"{}\"", style.width)).count());
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
    let triangle = text(of(|o| o.fills = vec![BoxInstance::triangle([a, b, c], color)]));
    let points = triangle.split("points=\"").nth(1).and_then(|rest| rest.split('"').next()).expect("a polygon");
    assert_eq!(points.split(' ').count(), 3, "{points}");
}

#[test]
fn what_the_section_cuts_away_is_not_drawn() {
    let line = BoxInstance::line(Vec3::new(-0.4, 0.1, 0.0), Vec3::new(-0.2, 0.1, 0.0), [1, 2, 3, 255]);
    let plane = BoxInstance::new(&Aabb { min: Vec3::new(-0.4, -0.1, 0.0), max: Vec3::new(-0.2, 0.1, 0.0) }, [1, 2, 3, 255]);
    let lines = |at: f32, instance: &BoxInstance| {
        let mut drawing = drawing();
        drawing.view = drawing.view.within(Some(HalfSpace { axis: Axis::X, at, side: Side::Below }));
        let (mut lines, mut fill) = (Lines::default(), String::new());
        drawing.edges(instance, &mut lines);
        drawing.fill_plane(instance, &mut fill);
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

/// A picture without surfaces with a line of a colour across it and beyond both sides.
fn crossed(color: [u8; 3]) -> Option<Drawing> {
    let [r, g, b] = color;
    let line = BoxInstance::line(Vec3::NEG_X * 5.0, Vec3::X * 5.0, [r, g, b, 255]);
    let mut drawing = of(|o| o.lines = vec![line]);
    Arc::get_mut(&mut drawing.picture).expect("ours alone").depth = Arc::new(vec![f32::INFINITY; 800]);
    Some(drawing)
}

/// Where there is red, green and blue along a row of a figure, in pixels of views.
fn colours_along(figure: &Figure, y: u32) -> [Vec<u32>; 3] {
    let png = png_of(&text_of(figure)).expect("drawn");
    let image = image::load_from_memory(&png).expect("a picture").into_rgb8();
    let scale = image.width() / figure.layout.size(figure.view.map(|side| side as f32), 0.0)[0] as u32;
    let strong = |x: u32, k: usize| {
        let pixel = image.get_pixel(x * scale, y * scale).0;
        (0..3).all(|other| other == k || pixel[k] > pixel[other].saturating_add(60))
    };
    [0, 1, 2].map(|k| (0..image.width() / scale).filter(|x| strong(*x, k)).collect())
}

#[test]
fn what_lies_over_each_compared_picture_stays_in_its_place() {
    const COLORS: [[u8; 3]; 3] = [[255, 0, 0], [0, 255, 0], [0, 0, 255]];
    let strips = figure(COLORS.map(crossed).into(), Layout::of(Arrange::Divider, vec![0.25, 0.5]));
    // Beside the dividers, which are lines themselves.
    let inner = |columns: &[u32]| -> [u32; 2] { [columns[0], columns[columns.len() - 1]] };
    let [red, green, blue] = colours_along(&strips, 10);
    assert!(inner(&red)[0] == 0 && inner(&red)[1] < 10, "{red:?}");
    assert!(inner(&green)[0] >= 10 && inner(&green)[1] < 20 && green.len() >= 6, "{green:?}");
    assert!(inner(&blue)[0] >= 20 && inner(&blue)[1] == 39 && blue.len() >= 16, "{blue:?}");
    // One that is not there yet is the first, in strips; in panes its place is empty.
    let missing = |layout| figure(vec![crossed(COLORS[0]), None, crossed(COLORS[2])], layout);
    let [red, green, blue] = colours_along(&missing(Layout::of(Arrange::Divider, vec![0.25, 0.5])), 10);
    assert!(inner(&red)[1] < 20 && red.len() >= 16 && green.is_empty() && inner(&blue)[0] >= 20, "{red:?} {blue:?}");
    let panes = missing(Layout::of(Arrange::Four, Vec::new()));
    let [red, green, blue] = colours_along(&panes, 10);
    assert!(red == (0..40).collect::<Vec<u32>>() && green.is_empty() && blue.is_empty(), "{red:?}");
    let [red, _, blue] = colours_along(&panes, 20 + place::GAP as u32 + 10);
    assert!(red.is_empty() && blue == (0..40).collect::<Vec<u32>>(), "the third, in the second row: {blue:?}");
    let two = figure(vec![crossed(COLORS[0]), crossed(COLORS[1])], Layout::of(Arrange::Two, Vec::new()));
    let [red, green, _] = colours_along(&two, 10);
    assert_eq!((inner(&red), inner(&green)), ([0, 39], [48, 87]), "and none in the gap");
}

#[test]
fn boxes_begin_where_they_do_in_the_window() {
    let half = Drawing { begin: 0.5, ..crossed([255, 0, 0]).expect("one") };
    let [red, ..] = colours_along(&figure(vec![Some(half)], Layout::Alone), 10);
    assert_eq!(red, (20..40).collect::<Vec<u32>>());
}

#[test]
fn compared_pictures_have_their_captions_and_legends_beneath() {
    let range = Range { min: 0.0, max: 12.0 };
    let plain = figure(vec![Some(drawing()), Some(drawing())], Layout::of(Arrange::Two, Vec::new()));
    let written = Figure {
        captions: ["A: nodes visited. BVH", "B: nodes visited. k-d tree"].map(str::to_owned).into(),
        legends: vec![Heat::new("Nodes visited a ray".to_owned(), range, viridis)],
        ..plain
    };
    let svg = text_of(&written);
    assert!(!svg.contains("NaN") && resvg::usvg::Tree::from_str(&svg, &resvg::usvg::Options::default()).is_ok());
    assert_eq!(svg.matches("<linearGradient ").count(), 1);
    let page = words::page_of(&written.legends);
    assert!(page > 88.0 && svg.contains(&format!(" viewBox=\"0 0 {page} ")), "the page is as wide as the legend: {page}");
    for part in [">Nodes visited a ray</text>", ">12.0</text>", ">a &lt;b&gt; &amp; c</text>"] {
        assert!(svg.contains(part), "{part}: {svg}");
    }
    // The views are narrow: lines are broken, each beneath its own picture.
    let base = |words: &str| {
        let line =
            svg.lines().find(|line| line.contains(&format!(">{words}</text>"))).unwrap_or_else(|| panic!("{words}: {svg}"));
        let of = |name: &str| line.split(&format!("{name}=\"")).nth(1).and_then(|rest| rest.split('"').next());
        [of(" x"), of(" y")].map(|number| number.and_then(|number| number.parse::<f32>().ok()).expect("a number"))
    };
    let ([ax, ay], [bx, by]) = (base("BVH"), base("k-d"));
    assert!(ax < 40.0 && bx > 48.0 && ay > 20.0 && by > 20.0, "{ax} {ay} {bx} {by}");
}
