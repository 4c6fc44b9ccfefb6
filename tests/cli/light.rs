//! `converge`, and what of `render` is about light: what they print and leave, and when they stop.

use std::fs;
use std::io::Cursor;

use boxwood::render::LinearPicture;
use serde_json::Value;

use crate::support::{Folder, bad, good, json};

const SMALL: [&str; 8] = ["--size", "16x16", "--spp", "8", "--runs", "1", "--structures", "bvh,kdtree"];

fn converge(folder: &Folder, more: &[&str]) -> Value {
    let out = folder.at("out");
    json(&[&["converge", "builtin:cornell-box", "-o", &out, "--json"], &SMALL[..], more].concat())
}

#[test]
fn converge_leaves_plots_and_data_and_uses_its_reference_again() {
    let folder = Folder::new();
    let outcome = converge(&folder, &[]);
    let names = ["convergence.csv", "convergence.json", "error-samples.png", "error-samples.svg", "error-seconds.png"];
    for name in names.into_iter().chain(["error-seconds.svg", "reference.exr"]) {
        assert!(fs::metadata(folder.at(&format!("out/{name}"))).is_ok_and(|file| file.len() > 100), "{name}");
    }
    let written: Value = serde_json::from_slice(&fs::read(folder.at("out/convergence.json")).expect("there")).expect("JSON");
    assert_eq!(written, outcome);
    assert_eq!((&outcome["version"], &outcome["coincide"]), (&1.into(), &true.into()));
    assert_eq!(outcome["reference"]["spp"], 128);
    let curves = outcome["curves"].as_array().expect("a list");
    assert_eq!(curves.len(), 4, "two structures, two samplers");
    for curve in curves {
        let spp: Vec<u64> = curve["points"].as_array().expect("a list").iter().filter_map(|p| p["spp"].as_u64()).collect();
        assert_eq!(spp, [1, 2, 4, 8]);
        assert!(curve["points"].as_array().expect("a list").iter().all(|p| p["rmse"].as_f64().is_some_and(|e| e > 0.0)));
    }
    let rows = fs::read_to_string(folder.at("out/convergence.csv")).expect("there");
    assert_eq!(rows.lines().count(), 1 + 4 * 4);

    let reference = || fs::read(folder.at("out/reference.exr")).expect("there");
    let (before, picture) = (reference(), LinearPicture::read(Cursor::new(reference())).expect("an EXR"));
    assert_eq!((picture.note("spp"), picture.width), (Some("128"), 16));
    let noise = |outcome: &Value| outcome["reference"]["noise"].as_f64().expect("a number");
    // One that was changed says so if it is read and not made anew.
    let said = |name: &str| picture.notes.iter().filter(|(key, _)| key != name).cloned().collect::<Vec<_>>();
    let marked = LinearPicture { notes: [said("noise"), vec![("noise".into(), "0.5".into())]].concat(), ..picture.clone() };
    let mut bytes = Cursor::new(Vec::new());
    marked.write(&mut bytes).expect("written");
    fs::write(folder.at("out/reference.exr"), bytes.into_inner()).expect("written");
    assert_eq!(noise(&converge(&folder, &[])), 0.5);
    // Of another view, or of too few samples, it is of no use.
    let other = converge(&folder, &["--camera", "eye 0,1,3 target 0,1,0"]);
    assert!(noise(&other) < 0.5 && reference() != before);
}

#[test]
fn rendering_stops_at_an_error_or_a_time_and_says_both() {
    let folder = Folder::new();
    let (png, exr) = (folder.at("x.png"), folder.at("x.exr"));
    let common = ["render", "builtin:cornell-box", "--mode", "path", "--structure", "wide", "--size", "16x16"];
    let line = |text: &str, name: &str| {
        let line = text.lines().find(|line| line.starts_with(name)).unwrap_or_else(|| panic!("no {name} in {text}"));
        line[name.len()..].trim().to_owned()
    };
    let samples = |text: &str| -> u32 {
        let picture = line(text, "picture");
        let part = picture.split(", ").find_map(|part| part.strip_suffix(" spp")).expect("samples");
        part.parse().expect("a number")
    };
    let noise = |text: &str| -> f64 { line(text, "noise").split(' ').next().expect("a number").parse().expect("a number") };
    let rough = good(&[&common[..], &["-o", &png, "--until-error", "0.2"]].concat());
    let fine = good(&[&common[..], &["-o", &exr, "--until-error", "0.1", "--sampler", "sobol", "--seed", "3"]].concat());
    assert!(noise(&rough) <= 0.2 && noise(&fine) <= 0.1, "{rough}{fine}");
    assert!((2..2000).contains(&samples(&rough)) && samples(&fine) > 2 * samples(&rough), "{rough}{fine}");
    assert!(line(&fine, "time").contains("tracing") && line(&fine, "noise").contains("estimated after"));
    let picture = LinearPicture::read(Cursor::new(fs::read(&exr).expect("there"))).expect("an EXR");
    assert_eq!((picture.note("spp"), picture.note("seed")), (Some(samples(&fine).to_string().as_str()), Some("3")));
    // Before the second pass there is time for one alone.
    let hasty = good(&[&common[..], &["-o", &png, "--seconds", "1e-9"]].concat());
    assert_eq!(samples(&hasty), 1);
    let clamped = good(&[&common[..], &["-o", &png, "--spp", "4", "--clamp", "0.1"]].concat());
    assert!(line(&clamped, "clamped").contains("of the light is missing"));
}

#[test]
fn an_image_of_the_surroundings_lights_the_scene() {
    let folder = Folder::new();
    // Two texels on an even sphere: white.
    let white = image::Rgb32FImage::from_pixel(4, 2, image::Rgb([2.0, 2.0, 2.0]));
    let sky = folder.at("sky.exr");
    image::DynamicImage::from(white).save(&sky).expect("written");
    let (model, out) = (folder.model(), folder.at("lit.exr"));
    let args = ["render", &model, "-o", &out, "--mode", "path", "--size", "24x24", "--spp", "64", "--structure", "bvh"];
    good(&[&args[..], &["--environment", &sky, "--environment-strength", "0.5"]].concat());
    let picture = LinearPicture::read(Cursor::new(fs::read(&out).expect("there"))).expect("an EXR");
    // A convex body in an even surrounding of 1 shows what it gives back: its grey, and what its coat mirrors.
    let middle = picture.pixels[12 * 24 + 12];
    assert!(middle.iter().all(|x| (0.6..0.85).contains(x)), "{middle:?}");
    let wrong = folder.file("sky.png", "no image");
    let said = bad(&[&args[..], &["--environment", &wrong]].concat(), 2);
    assert!(said.contains("sky.png") && said.contains(".hdr"), "{said}");
    assert!(bad(&[&args[..], &["--sun", "high"]].concat(), 2).contains("ELEVATION,AZIMUTH"));
}

#[test]
fn a_report_is_one_page_of_everything() {
    let folder = Folder::new();
    let (model, out) = (folder.model(), folder.at("report"));
    good(&["report", &model, "-o", &out, "--quick", "--structures", "bvh,kdtree"]);
    let page = fs::read_to_string(folder.at("report/index.html")).expect("there");
    for section in [
        "Pictures",
        "Used and left out",
        "Structures",
        "Timings",
        "Predicted and measured",
        "Image error",
        "Intersection error",
        "Model error",
        "Stability",
        "Machine, seeds, commands",
    ] {
        assert!(page.contains(&format!(">{section}</h2>")), "{section}");
    }
    // Nothing is fetched: the only address is the name of what SVG is.
    assert_eq!(page.matches("http").count(), page.matches("http://www.w3.org/2000/svg").count());
    assert!(page.contains("Würfel.ply") && !page.contains(">NaN"));
    let report: Value = serde_json::from_slice(&fs::read(folder.at("report/report.json")).expect("there")).expect("JSON");
    assert_eq!((&report["version"], &report["quick"]), (&1.into(), &true.into()));
    assert_eq!(report["structures"].as_array().map(Vec::len), Some(2));
    let tradeoffs = report["tradeoffs"].as_array().expect("a list");
    assert_eq!(tradeoffs.len(), 2, "no builders where it is to be quick");
    // Predicted against measured is there where costs could be fitted, which is told beside what is predicted.
    assert!(tradeoffs[0]["name"] == "bvh" && tradeoffs[0]["predicted_ns"].as_f64() > Some(0.0), "{}", tradeoffs[0]);
    assert_eq!((page.matches("<svg").count(), page.matches("data:image/png").count()), (8, 3));
    assert_eq!(page.matches("predicted = measured").count(), 1);
    for row in tradeoffs {
        let fitted = [&row["costs"]["c_trav_ns"], &row["prediction_secs"]].map(|figure| figure.is_number());
        assert_eq!(fitted, [row["predicted_ns"].is_number(); 2], "{row}");
    }
    let boxes = &report["tradeoffs"][0]["boxes"];
    assert_eq!((&boxes[3]["test"], &boxes[3]["wrong_per_million"]), (&"two-origins".into(), &0.0.into()));
    assert_eq!(report["check"]["structures"][0]["wrong"], 0);
    assert!(report["commands"][0].as_str().is_some_and(|line| line.contains("report") && line.contains("--quick")));
    assert_eq!(fs::read_to_string(folder.at("report/structures.csv")).expect("there").lines().count(), 3);
}
