//! What is taken away from the window: tables, plots, the figure, the picture and the report.

use std::fs;
use std::path::{Path, PathBuf};

use boxwood::accel::outline::Rank;
use boxwood::lab::Fairness;
use boxwood::render::Mode;
use boxwood::viewer::panes::Arrange;
use boxwood::viewer::timings::Column;
use boxwood::viewer::tradeoffs::Plot;
use boxwood::viewer::{actions, format};
use eframe::egui::{Key, Modifiers, Role, vec2};
use egui_kittest::kittest::Queryable;

use crate::window::{Setup, Window};

/// A window whose dialogs answer with this path.
fn window(answer: &Path) -> Window {
    let mut setup = Setup { size: vec2(1400.0, 900.0), answer: Some(answer.to_path_buf()), ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
    Window::new(setup).settled()
}

/// Whether something can be done now.
fn offers(w: &Window, name: &str) -> bool {
    let all = actions::all(w.state());
    let action = all.iter().find(|action| action.name == name);
    action.unwrap_or_else(|| panic!("there is no {name}")).possible
}

/// Waits until something was written, and where that is.
#[track_caller]
fn written(w: &mut Window, name: &str) -> PathBuf {
    w.until("a file", |s| s.exports.said.is_some());
    w.settle();
    assert_eq!(w.state().error, None);
    let said = w.state().exports.said.clone().expect("just written");
    let (what, path) = said.split_once(" written to ").expect("a sentence");
    assert_eq!(what, name);
    assert!(w.says(&said), "the bar at the bottom tells it");
    PathBuf::from(path)
}

#[test]
fn tables_are_saved_as_csv() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("rows"));
    w.button("Save timings");
    w.button("Table as CSV…");
    let path = written(&mut w, "Timings");
    assert_eq!(path, folder.path().join("rows.csv"), "with its ending");
    let text = fs::read_to_string(&path).expect("there");
    let lines: Vec<&str> = text.lines().collect();
    assert!(lines[0].starts_with("structure,terms,build (s),bytes,"), "{text}");
    assert_eq!(lines.len(), 1 + boxwood::accel::registry::ALL.len());
    assert!(lines.iter().any(|line| line.starts_with("bvh,,") && !line.starts_with("bvh,,,")), "built, not measured: {text}");
    // The dialog asked about another name: what is there stays.
    w.button("Save timings");
    w.button("Table as CSV…");
    w.until("a refusal", |s| s.error.is_some());
    assert!(w.state().error.as_ref().is_some_and(|why| why.contains("rows.csv") && why.contains("already")));
    assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 1, "no temporary file is left");
}

#[test]
fn what_holds_memory_is_saved_part_by_part() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("memory.csv"));
    w.button("Check workspace");
    w.settle();
    w.click(Role::DisclosureTriangle, "Memory");
    w.settle();
    w.button("Save memory");
    w.button("Table as CSV…");
    let text = fs::read_to_string(written(&mut w, "Memory")).expect("there");
    let bytes = w.state().shown.as_ref().and_then(|shown| shown.stats.as_ref()).map(|stats| stats.bytes()).expect("counted");
    let parts = text.lines().filter(|line| line.starts_with("bvh,test=watertight,"));
    let sum: u64 = parts.filter_map(|line| line.rsplit(',').next()?.parse::<u64>().ok()).sum();
    assert_eq!(sum, bytes, "{text}");
    assert!(text.contains("budget,,limit,") && text.contains("model,,triangles,"), "{text}");
}

#[test]
fn plots_are_saved_as_svg_and_png() {
    let folder = tempfile::tempdir().expect("a folder");
    for (item, ending, begins) in [("Plot as SVG…", "svg", &b"<svg"[..]), ("Plot as PNG…", "png", &b"\x89PNG"[..])] {
        let mut w = window(&folder.path().join(format!("leaves.{ending}")));
        w.button("Save statistics");
        w.button(item);
        let path = written(&mut w, "Statistics");
        assert!(fs::read(path).expect("there").starts_with(begins), "{ending}");
    }
}

#[test]
fn the_cost_along_a_film_is_saved_event_by_event() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("film"));
    w.button("Structure workspace");
    w.until("the cells are listed", |s| s.tree.outline.is_some());
    w.settle();
    assert!(!offers(&w, "Save plot as SVG: film…"));
    w.button("Make the film");
    w.until("the film", |s| s.filming.film.is_some());
    w.settle();
    w.button("Forward");
    w.settle();
    let film = w.state().filming.film.clone().expect("made");
    w.button("Save film");
    w.button("Table as CSV…");
    let csv = fs::read_to_string(written(&mut w, "Film")).expect("there");
    let lines: Vec<&str> = csv.lines().collect();
    assert_eq!((lines[0], lines.len()), ("event,SAH cost,what happened", 2 + film.last() as usize));
    for event in [0, 1, film.last()] {
        assert!(lines[1 + event as usize].starts_with(&format!("{event},{},", film.cost(event))), "{csv}");
    }
    w.button("Save film");
    w.button("Plot as SVG…");
    w.until("a plot", |s| s.exports.said.as_ref().is_some_and(|said| said.ends_with(".svg")));
    let svg = fs::read_to_string(folder.path().join("film.svg")).expect("there");
    for said in ["SAH cost so far", "event 1", "events so far", "SAH cost"] {
        assert!(svg.contains(&format!("\n{said}\n")), "{said}");
    }
    // The line has a corner for each position; the only point is where the film stands, in the plot and in the list.
    let longest = svg.lines().filter(|line| line.starts_with("<polyline")).map(|line| line.matches(',').count()).max();
    assert_eq!(longest, Some(1 + film.last() as usize));
    assert_eq!(svg.matches("<circle").count(), 3);
}

#[test]
fn the_histogram_of_a_heat_map_is_saved_with_its_ends() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("heat"));
    assert!(!offers(&w, "Save plot as SVG: heat…"));
    w.choose("Shaded", Mode::Nodes.label());
    w.settle();
    let picture = w.state().picture.clone().expect("traced");
    let histogram = picture.amounts.as_ref().expect("a heat map").histogram.clone();
    w.button("Save heat");
    w.button("Table as CSV…");
    let csv = fs::read_to_string(written(&mut w, "Heat")).expect("there");
    assert!(csv.contains(&format!("bvh,Nodes visited a ray,bright end,{},,", f64::from(picture.range.max))), "{csv}");
    let bins: Vec<u32> = csv.lines().filter(|line| line.contains(",bin,")).filter_map(last_count).collect();
    assert_eq!(bins, histogram.counts);
    w.button("Save heat");
    w.button("Plot as SVG…");
    w.until("a plot", |s| s.exports.said.as_ref().is_some_and(|said| said.ends_with(".svg")));
    let svg = fs::read_to_string(folder.path().join("heat.svg")).expect("there");
    let [dark, bright] = [picture.range.min, picture.range.max].map(|end| format::number(end.into()));
    for said in ["Nodes visited a ray", &format!("dark {dark}"), &format!("bright {bright}")] {
        assert!(svg.contains(&format!("\n{said}\n")), "{said}");
    }
    let filled = histogram.counts.iter().filter(|pixels| **pixels > 0).count();
    assert!(svg.matches("<rect").count() > filled, "a column for each bin that holds something");
}

/// The count that ends a line.
fn last_count(line: &str) -> Option<u32> {
    line.rsplit(',').next()?.parse().ok()
}

#[test]
fn volumes_around_a_node_are_saved_as_bars() {
    let folder = tempfile::tempdir().expect("a folder");
    let answer = Some(folder.path().join("volumes.svg"));
    let mut setup = Setup { size: vec2(1280.0, 1700.0), answer, ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
    let mut w = Window::new(setup).settled();
    w.button("Structure workspace");
    w.until("the cells are listed", |s| s.tree.outline.is_some());
    w.settle();
    w.button(Rank::Overlap.name());
    w.settle();
    w.button("Compare bounding volumes");
    w.until("rows", |s| s.fitting().is_some());
    w.settle();
    w.button("Save volumes");
    w.button("Plot as SVG…");
    let svg = fs::read_to_string(written(&mut w, "Volumes")).expect("there");
    let rows = w.state().fitting().expect("made").0.rows.clone();
    let hull = rows.iter().find(|row| row.id == "hull").expect("the tightest").area;
    for row in &rows {
        let figure = format::number(row.area / hull);
        assert!(svg.contains(&format!("\n{figure}\n")), "{}: {figure}", row.id);
    }
    for name in ["Convex hull", "Sphere", "26-DOP"] {
        assert_eq!(svg.matches(&format!("\n{name}\n")).count(), 3, "in each of three plots: {name}");
    }
}

#[test]
fn the_figure_has_the_picture_and_its_boxes() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("view.svg"));
    w.button("File");
    w.button("Save figure…");
    let svg = fs::read_to_string(written(&mut w, "Figure")).expect("there");
    assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
    assert!(svg.contains("data:image/png;base64,") && svg.contains("<path d=\"M") && svg.contains("stroke-dasharray"));
    assert!(svg.contains("<title>BVH, boxes at depth ") && svg.contains("SAH cost ") && svg.contains("builtin:teapot"));
}

#[test]
fn the_figure_of_a_film_says_where_it_stands() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("film.svg"));
    w.button("Structure workspace");
    w.until("the cells are listed", |s| s.tree.outline.is_some());
    w.settle();
    w.button("Make the film");
    w.until("the film", |s| s.filming.film.is_some());
    w.settle();
    w.button("Forward");
    w.settle();
    w.button("File");
    w.button("Save figure…");
    let svg = fs::read_to_string(written(&mut w, "Figure")).expect("there");
    let last = w.state().filming.last();
    assert!(svg.contains(&format!("<title>BVH, reconstructed order, event 1 of {last}, SAH cost ")), "{last}");
    assert!(!svg.contains("at depth"));
}

#[test]
fn the_picture_is_as_large_as_the_view() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut w = window(&folder.path().join("view.png"));
    w.button("File");
    w.button("Save picture…");
    let picture = fs::read(written(&mut w, "Picture")).expect("there");
    assert!(picture.starts_with(b"\x89PNG"));
    let [width, height] = w.state().size_px.map(u32::to_be_bytes);
    assert_eq!((&picture[16..20], &picture[20..24]), (&width[..], &height[..]));
}

#[test]
fn compared_pictures_are_saved_as_they_stand() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arrange, [across, down]) in [(Arrange::Divider, [1, 1]), (Arrange::Two, [2, 1]), (Arrange::Four, [2, 2])] {
        let answer = folder.path().join(format!("{arrange:?}.png"));
        let mut setup = Setup { size: vec2(1400.0, 900.0), answer: Some(answer), ..Setup::default() };
        setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
        setup.options.samples = Some(1);
        setup.options.panes = ["bvh", "kdtree"].map(str::to_owned).to_vec();
        setup.options.arrange = Some(arrange);
        let mut w = Window::new(setup).settled();
        w.button("File");
        w.button("Save picture…");
        let picture = fs::read(written(&mut w, "Picture")).expect("there");
        let [width, height] = w.state().size_px;
        let [width, height] = [width * across, height * down].map(u32::to_be_bytes);
        assert_eq!((&picture[16..20], &picture[20..24]), (&width[..], &height[..]), "{arrange:?}");
    }
}

#[test]
fn the_figure_of_compared_pictures_has_all_of_them() {
    let folder = tempfile::tempdir().expect("a folder");
    for (arrange, [across, down]) in [(Arrange::Divider, [1, 1]), (Arrange::Two, [2, 1]), (Arrange::Four, [2, 2])] {
        let answer = folder.path().join(format!("{arrange:?}.svg"));
        let mut setup = Setup { size: vec2(1400.0, 900.0), answer: Some(answer), ..Setup::default() };
        setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
        setup.options.mode = Some(Mode::Nodes);
        setup.options.panes = ["bvh", "kdtree"].map(str::to_owned).to_vec();
        setup.options.arrange = Some(arrange);
        let mut w = Window::new(setup).settled();
        w.button("File");
        w.button("Save figure…");
        let svg = fs::read_to_string(written(&mut w, "Figure")).expect("there");
        assert!(svg.starts_with("<svg") && svg.trim_end().ends_with("</svg>") && !svg.contains("NaN"));
        assert!(svg.contains("<title>A: BVH; B: k-d tree, boxes at depth ") && svg.contains("builtin:teapot"), "{arrange:?}");
        // Each with what lies over it.
        let over: Vec<&str> = svg.split("<g fill=\"none\"").skip(1).filter_map(|part| part.split("</g>").next()).collect();
        assert!(svg.matches("<image ").count() == 2 && over.len() == 2, "{arrange:?}");
        assert!(over.iter().all(|lines| lines.contains("<path d=\"M")) && over[0] != over[1], "{arrange:?}");
        assert_eq!((svg.matches("<linearGradient ").count(), svg.matches(">Nodes visited a ray</text>").count()), (1, 1));
        assert!(svg.contains(">A: nodes visited. BVH: ") && svg.contains(">B: nodes visited. k-d tree: "), "{arrange:?}");
        let [width, height] = w.state().size_px;
        let least = [width * across, height * down];
        let of =
            |name: &str| svg.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next()?.parse::<f32>().ok());
        let size = ["width", "height"].map(|name| of(name).expect("a number") as u32);
        assert!(size[0] >= least[0] && size[1] > least[1], "{arrange:?}: {size:?} of {least:?}");
    }
}

#[test]
fn a_dialog_that_is_closed_saves_nothing() {
    let mut setup = Setup::default();
    setup.options.model = Some("builtin:lecture".to_owned());
    let mut w = Window::new(setup).settled();
    w.button("File");
    w.button("Save picture…");
    w.settle();
    assert!(w.state().exports.said.is_none() && w.state().error.is_none());
}

#[test]
fn a_report_that_is_stopped_leaves_nothing() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut setup =
        Setup { size: vec2(1400.0, 900.0), answer: Some(folder.path().to_path_buf()), alone: true, ..Setup::default() };
    setup.options.model = Some("builtin:teapot?triangles=1000".to_owned());
    let mut w = Window::new(setup).settled();
    w.button("File");
    w.button("Export report…");
    w.until("its start", |s| s.exports.report.is_some());
    w.step();
    assert!(w.state().is_measuring() && w.says("Making the report"));
    w.button("Cancel the report");
    w.settle();
    assert!(w.state().exports.report.is_none() && w.state().exports.said.is_none() && w.state().error.is_none());
    assert_eq!(fs::read_dir(folder.path()).expect("there").count(), 0);
}

#[test]
fn timings_are_sorted_by_a_click_or_a_key() {
    let folder = tempfile::tempdir().expect("a folder");
    let answer = Some(folder.path().join("timings.svg"));
    let mut setup = Setup { size: vec2(1400.0, 900.0), alone: true, answer, ..Setup::default() };
    setup.options.model = Some("builtin:lecture".to_owned());
    let mut w = Window::new(setup).settled();
    let plot = "Save plot as SVG: timings…";
    assert!(offers(&w, "Save table: timings…") && !offers(&w, plot), "builds are known, nothing to draw as bars is");
    w.choose("Like for like", "Each at its best");
    w.button("Measure");
    w.until("timings", |s| s.measuring.is_none() && s.timings.view.is_some());
    w.settle();
    assert_eq!(w.state().timings.fairness, Fairness::Best);
    w.button("Sort by Mrays/s");
    w.step();
    assert!(w.has(Role::Button, "Sort by Mrays/s, descending"));
    let rates = |w: &Window| -> Vec<f64> {
        let rows = w.state().timings.sorted(&w.state().terms_of_timings);
        rows.iter().filter_map(|(_, row)| row.timing.as_ref()).map(|t| t.mrays_per_sec).collect()
    };
    assert!(rates(&w).is_sorted_by(|a, b| a >= b), "{:?}", rates(&w));
    w.button("Sort by Mrays/s, descending");
    assert!(rates(&w).is_sorted_by(|a, b| a <= b), "the other way round: {:?}", rates(&w));
    w.harness.get_by_role_and_label(Role::Button, "Sort by Build").focus();
    w.step();
    w.key(Modifiers::NONE, Key::Enter);
    assert_eq!(w.state().terms_of_timings.column, Column::Build);
    // Other terms from now on: the table says of which it is.
    w.choose("Each at its best", "Like for like");
    w.step();
    assert!(w.says("measured: each at its best"));
    // Saved as bars, each with its figure and its spread.
    assert!(offers(&w, plot));
    w.button("Save timings");
    w.button("Plot as SVG…");
    let svg = fs::read_to_string(written(&mut w, "Timings")).expect("there");
    assert!(svg.contains("timings, each at its best"), "{svg}");
    let rows = w.state().timings.sorted(&w.state().terms_of_timings);
    for (entry, timing) in rows.iter().filter_map(|(entry, row)| Some((entry, row.timing.as_ref()?))) {
        let figure = format::number(timing.mrays_per_sec);
        let begins = [format!("\n{figure} ±"), format!("\n{figure}\n"), format!("\n{figure} (")];
        assert!(begins.iter().any(|figure| svg.contains(figure)), "{}: {figure}", entry.id);
        assert!(svg.contains(&format!("\n{}\n", entry.short)), "{}", entry.short);
    }
    assert!(svg.contains("\nRaster\n"));
}

#[test]
fn time_against_triangles_is_measured_in_the_background_and_can_be_stopped() {
    let mut setup = Setup { size: vec2(1400.0, 900.0), alone: true, ..Setup::default() };
    setup.options.model = Some("builtin:soup?triangles=1000".to_owned());
    setup.options.errors = Some(Plot::Scaling);
    let mut w = Window::new(setup).settled();
    assert!(w.says("Not measured. Press Measure."));
    w.button("Measure");
    w.until("its start", |s| s.tradeoffs.growing.is_some());
    w.step();
    w.button("Cancel");
    w.settle();
    assert!(w.state().tradeoffs.growing.is_none() && w.state().tradeoffs.scaling.is_empty() && w.state().error.is_none());
}
