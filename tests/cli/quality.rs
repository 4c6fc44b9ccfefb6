//! Quality in `stats` and `compare`, and `scaling`: the schema, and that the figures make sense.

use crate::support::{Folder, good, json};
use serde_json::{Value, json};

fn float(value: &Value) -> f64 {
    value.as_f64().unwrap_or_else(|| panic!("no number: {value}"))
}

fn rows(report: &Value) -> &[Value] {
    report["structures"].as_array().expect("a list")
}

#[test]
fn stats_tells_the_quality_of_every_structure() {
    let args = ["stats", "builtin:soup?triangles=800", "--structure", "all", "--alpha", "0.25", "--json"];
    let report = json(&args);
    for row in rows(&report) {
        let (quality, id) = (&row["quality"], &row["id"]);
        for (expected, counted) in [("expected_nodes", "nodes"), ("expected_tests", "tests")] {
            let (expected, mean) = (float(&quality[expected]), float(&quality["lines"][counted]));
            let error = float(&quality["lines"][format!("{counted}_error")]);
            assert!(mean < expected * 1.05 + 6.0 * error, "{id}: {quality}");
            assert!(id != "bvh" || mean > expected * 0.95 - 6.0 * error, "{id}: {quality}");
        }
        let duplication = float(&quality["duplication"]);
        assert_eq!(duplication, float(&row["references"]) / 800.0, "{id}");
        if let Some(epo) = quality["epo"].as_object() {
            let blend = 0.75 * float(&row["sah"]) + 0.25 * float(&epo["value"]);
            assert!((float(&quality["blend"]) - blend).abs() < 1e-9 && epo["error"] == 0.0, "{id}: {quality}");
            assert_eq!(epo["of"], 800);
        } else {
            assert!(quality["epo_missing"].is_string(), "{id}: {quality}");
        }
        assert!(quality.get("overlap").is_some() && quality.get("empty_volume").is_some() && row.get("costs").is_some());
    }
    let of = |id: &str| rows(&report).iter().find(|row| row["id"] == id).expect("there")["quality"].clone();
    assert_eq!((float(&of("brute")["expected_tests"]), float(&of("brute")["overlap"])), (800.0, 0.0));
    assert!(float(&of("bvh")["epo"]["value"]) > 0.0 && float(&of("bvh")["overlap"]) > 0.0);
    assert_eq!((float(&of("kdtree")["epo"]["value"]), float(&of("grid")["overlap"])), (0.0, 0.0));
    assert!(float(&of("kdtree")["duplication"]) > 1.0 && float(&of("bvh")["duplication"]) == 1.0);
}

#[test]
fn a_sampled_overlap_has_an_error() {
    let stats = |more: &[&str]| {
        let args = ["stats", "builtin:soup?triangles=3000", "--structure", "bvh", "--json"];
        rows(&json(&[&args[..], more].concat()))[0]["quality"]["epo"].clone()
    };
    let (exact, sampled) = (stats(&[]), stats(&["--epo-sample", "500"]));
    assert_eq!((&exact["error"], &exact["sampled"]), (&json!(0.0), &json!(3000)));
    let off = (float(&sampled["value"]) - float(&exact["value"])).abs();
    assert!(float(&sampled["error"]) > 0.0 && off < 4.0 * float(&sampled["error"]), "{sampled} of {exact}");
}

#[test]
fn costs_are_fitted_and_expected_times_follow() {
    let args = ["stats", "builtin:teapot", "--structure", "bvh,kdtree", "--fit-costs", "--json"];
    for row in rows(&json(&args)) {
        let (costs, quality) = (&row["costs"], &row["quality"]);
        let of = |key: &str| float(&costs[key]);
        assert!(of("c_trav_ns") >= 0.0 && of("c_isect_ns") >= 0.0 && of("c0_ns") >= 0.0, "{costs}");
        assert!((0.0..=1.0).contains(&of("r_squared")) && of("blocks") > 100.0, "{costs}");
        let expected = of("c_trav_ns") * float(&quality["expected_nodes"]);
        let expected = expected + of("c_isect_ns") * float(&quality["expected_tests"]) + of("c0_ns");
        assert!((of("expected_ns") / expected - 1.0).abs() < 1e-9, "{costs}");
        assert!(costs["ratio"].is_null() || (of("ratio") * of("c_trav_ns") / of("c_isect_ns") - 1.0).abs() < 1e-9);
    }
}

#[test]
fn compare_shows_expected_beside_counted() {
    let args = ["compare", "builtin:cornell-box", "--structures", "bvh,grid", "--rays", "primary,lines", "--size", "64x64"];
    let quick = [&args[..], &["--secs", "0.02", "--quality", "--fit-costs"]].concat();
    let table = good(&quick);
    for word in ["lines rays", "expected", "LCV", "EPO", "C_trav ns", "R²", "blend 0.500", "SAH = sum over inner nodes"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    let report = json(&[&args[..], &["--secs", "0.02", "--json"]].concat());
    for row in rows(&report) {
        let lines = &row["rays"]["lines"];
        assert_eq!(lines["count"], 64 * 64);
        assert!(float(&lines["lcv"]) > 0.0 && float(&lines["leaves_per_ray"]) > 0.0, "{lines}");
        // To the closest hit a line does less than one that nothing cuts short.
        assert!(float(&lines["nodes_per_ray"]) < float(&row["quality"]["expected_nodes"]), "{row}");
        assert!(row["quality"]["epo"].is_null() && row["costs"].is_null(), "not asked for: {row}");
    }
}

#[test]
fn scaling_fits_exponents_over_made_sizes() {
    let args = ["scaling", "builtin:soup", "--structures", "brute,bvh", "--from", "100", "--to", "6400", "--steps", "4"];
    let quick = ["--size", "40x25", "--repeat", "3", "--secs", "0.02", "--cap", "2"];
    let outcome = json(&[&args[..], &quick, &["--json"]].concat());
    assert_eq!(outcome["triangles"], json!([100, 400, 1600, 6400]));
    for row in rows(&outcome) {
        let points = row["points"].as_array().expect("a list");
        assert_eq!(points.iter().map(|p| p["triangles"].clone()).collect::<Vec<_>>(), [100, 400, 1600, 6400]);
        for point in points {
            assert!(float(&point["ray_secs"]) > 0.0 && point["builds"].as_u64() >= Some(1), "{point}");
        }
        assert!(row["ray"]["error"].is_number() && row["build"]["value"].is_number(), "{row}");
    }
    // Brute force does 64 times as much, a tree does not: seen on however busy a machine.
    let exponent = |i: usize| float(&rows(&outcome)[i]["ray"]["value"]);
    assert!(exponent(0) > 0.5 && exponent(1) < exponent(0), "{outcome}");
}

#[test]
fn scaling_cuts_a_file_finer() {
    let folder = Folder::new();
    let model = folder.model();
    let args = ["scaling", &model, "--structures", "bvh", "--to", "900", "--rays", "primary", "--size", "16x16"];
    let table = good(&[&args[..], &["--secs", "0.01", "--repeat", "1"]].concat());
    // 14 in the file, 12 of them live; cut finer, so are those of no area that do not matter.
    for word in ["12, 48, 192, 768 triangles", "build exponent", "ns/ray", "bvh"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
}
