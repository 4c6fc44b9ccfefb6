//! `scenes`, `stats` and `compare`: the schema, and tables for people.

use crate::support::{Folder, bad, good, json};
use boxwood::accel::registry;
use boxwood::scene::builtin;
use serde_json::{Value, json};

fn assert_keys(value: &Value, keys: &[&str]) {
    for key in keys {
        assert!(value.get(key).is_some(), "no '{key}' in {value}");
    }
}

fn ids(report: &Value) -> Vec<&str> {
    report["structures"].as_array().expect("a list").iter().map(|row| row["id"].as_str().expect("text")).collect()
}

#[test]
fn scenes_lists_every_built_in_scene() {
    let listed = json(&["scenes", "--json"]);
    let models: Vec<&str> = listed["scenes"].as_array().expect("a list").iter().filter_map(|s| s["model"].as_str()).collect();
    let expected: Vec<String> = builtin::all().iter().map(|scene| format!("builtin:{}", scene.id)).collect();
    assert_eq!(models, expected);
    let text = good(&["scenes"]);
    assert!(builtin::all().iter().all(|scene| text.contains(scene.id) && text.contains(scene.about)));
}

#[test]
fn stats_follows_the_schema() {
    let folder = Folder::new();
    let model = folder.model();
    let report = json(&["stats", &model, "--structure", "all", "--set", "max_leaf=2", "--threads", "1", "--json"]);
    assert_eq!(
        report["scene"],
        json!({"path": model, "triangles": 14, "dropped": 1, "degenerate": 1, "extent": [1.0, 1.0, 1.0]})
    );
    assert_keys(&report["machine"], &["cpu", "cores"]);
    assert_eq!(report["machine"]["threads"], 1);
    assert_eq!(ids(&report), registry::ALL.iter().map(|entry| entry.id).collect::<Vec<_>>());
    for (row, entry) in report["structures"].as_array().expect("a list").iter().zip(registry::ALL) {
        assert_keys(row, &["params", "build_secs", "bytes", "nodes", "leaves", "max_depth", "references", "sah", "rays", "test"]);
        assert!(row.get("error").is_none() && row["references"].as_u64() >= Some(12), "{row}");
        assert_keys(&row["params"], &entry.params.iter().map(|param| param.id).collect::<Vec<_>>());
    }
    let bvh = &report["structures"][2];
    assert_eq!((&bvh["params"]["max_leaf"], &bvh["references"]), (&json!(2), &json!(12)));
    for (id, choice) in [("bvh", "auto took sweep"), ("kdtree", "builder sah")] {
        let index = registry::ALL.iter().position(|entry| entry.id == id).expect("registered");
        let remark = report["structures"][index]["remarks"][0].as_str().expect("what auto chose");
        assert!(remark.contains(choice), "{remark}");
    }
    assert_eq!(folder.names(), ["Würfel.ply"]);
}

#[test]
fn stats_prints_a_table() {
    let table = good(&["stats", "builtin:cornell-box", "--structure", "bvh", "--test", "fast"]);
    for word in ["build ms", "SAH cost", "bvh", "fast", "references", "depth", "cores"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    let table = good(&["stats", "builtin:cornell-box", "--structure", "kdtree"]);
    assert!(table.contains("chosen  builder sah"), "{table}");
}

#[test]
fn compare_follows_the_schema() {
    let args = ["compare", "builtin:cornell-box", "--structures", "brute,bvh,grid", "--size", "48x32", "--repeat", "2"];
    let report = json(&[&args[..], &["--secs", "0.02", "--threads", "2", "--json"]].concat());
    assert_keys(&report, &["scene", "machine", "structures", "fairness", "raster"]);
    assert!(report["raster"].is_null(), "not asked for");
    assert_eq!((ids(&report), &report["fairness"]), (vec!["brute", "bvh", "grid"], &json!("like-for-like")));
    for row in report["structures"].as_array().expect("a list") {
        for kind in ["primary", "shadow", "diffuse"] {
            let rays = &row["rays"][kind];
            assert_keys(rays, &["count", "hits", "secs", "mrays_per_sec", "nodes_per_ray", "prims_per_ray", "rounds"]);
            assert!(rays["rounds"].as_u64() >= Some(2) && rays["secs"].as_f64() > Some(0.0));
            assert_eq!(rays["hits"], report["structures"][0]["rays"][kind]["hits"], "all hit the same");
        }
        assert_eq!(row["rays"]["primary"]["count"], 48 * 32);
    }
}

#[test]
fn compare_prints_one_table_for_each_kind_and_names_its_terms() {
    let args = ["compare", "builtin:cornell-box", "--structures", "bvh,kdtree", "--rays", "shadow,primary", "--size", "32x32"];
    let table = good(&[&args[..], &["--secs", "0.02", "--best"]].concat());
    for word in ["each at its best", "primary rays", "shadow rays", "Mrays/s", "nodes/ray", "fastest", "kdtree", "threads"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    assert!(!table.contains("diffuse rays"));
}

#[test]
fn the_rasteriser_stands_beside_the_structures() {
    let args = ["compare", "builtin:cornell-box", "--size", "48x32", "--repeat", "2", "--secs", "0.01", "--structures"];
    let report = json(&[&args[..], &["raster,bvh", "--rays", "primary,shadow", "--json"]].concat());
    assert_eq!(ids(&report), ["bvh"]);
    let (raster, traced) = (&report["raster"], &report["structures"][0]["rays"]["primary"]);
    assert_keys(raster, &["secs", "secs_spread", "mrays_per_sec", "covered", "overdraw", "set_up", "culled", "crossing"]);
    assert!(raster["rounds"].as_u64() >= Some(2) && raster["secs"].as_f64() > Some(0.0));
    let number = |value: &Value| value.as_u64().expect("a number");
    assert_eq!((number(&raster["count"]), number(&raster["differing"]["other"])), (48 * 32, 0));
    assert!(number(&raster["hits"]).abs_diff(number(&traced["hits"])) <= number(&raster["differing"]["edge"]));
    assert!(number(&raster["covered"]) >= number(&raster["hits"]) && number(&raster["set_up"]) > 0);

    let table = good(&[&args[..], &["bvh,raster", "--rays", "primary,shadow"]].concat());
    for word in ["\nraster  ", "pixels covered by", "overdraw", "edge pixels differ"] {
        assert_eq!(table.matches(word).count(), 1, "{word:?} in\n{table}");
    }
    let alone = good(&[&args[..], &["raster", "--rays", "primary"]].concat());
    assert!(alone.contains("\nraster  ") && !alone.contains("SAH"), "{alone}");
    for (structures, rays) in [("bvh", "primary"), ("raster,bvh", "shadow")] {
        let table = good(&[&args[..], &[structures, "--rays", rays]].concat());
        assert!(!table.contains("raster"), "{table}");
    }
    let wrong = bad(&[&args[..], &["raster", "--rays", "diffuse"]].concat(), 2);
    assert!(wrong.contains("--rays primary"), "{wrong}");
}

#[test]
fn volumes_follows_the_schema() {
    let args = ["volumes", "builtin:cornell-box", "--rays", "diffuse", "--size", "48x32", "--repeat", "2", "--secs", "0.01"];
    let report = json(&[&args[..], &["--threads", "2", "--json"]].concat());
    assert_keys(&report, &["scene", "machine", "size", "kind", "nodes", "volumes"]);
    let rows = report["volumes"].as_array().expect("a list");
    let ids: Vec<&str> = rows.iter().filter_map(|row| row["id"].as_str()).collect();
    assert_eq!(ids, ["aabb", "sphere", "obb", "kdop6", "kdop8", "kdop14", "kdop18", "kdop26", "hull"]);
    let of = |id: &str, key: &str| rows[ids.iter().position(|i| *i == id).expect("a row")][key].as_f64().expect("a number");
    for row in rows {
        assert_keys(row, &["build_secs", "area_nodes", "simplified", "failed", "rays_counted", "tests_per_ray", "nodes_per_ray"]);
        assert_eq!(row["rays"]["hits"], rows[0]["rays"]["hits"], "all hit the same");
        assert_eq!(row["area_nodes"], report["nodes"], "every hull of this scene is known");
        assert!(row["area_ratio"].as_f64() > Some(0.999) && row["test_ns"]["median"].as_f64() > Some(0.0), "{row}");
        assert!(row["false_positives"].as_f64().is_some_and(|share| (0.0..1.0).contains(&share)), "{row}");
    }
    assert_eq!(of("aabb", "area_ratio"), of("kdop6", "area_ratio"));
    assert_eq!((of("sphere", "bytes_per_node"), of("aabb", "bytes_per_node")), (24.0, 32.0));
    assert!(of("hull", "area_ratio") <= of("kdop26", "area_ratio") && of("kdop26", "area_ratio") <= of("aabb", "area_ratio"));
    assert!(of("hull", "nodes_per_ray") <= of("aabb", "nodes_per_ray"));
}

#[test]
fn volumes_prints_a_table() {
    let table =
        good(&["volumes", "builtin:cornell-box", "--size", "16x16", "--repeat", "1", "--secs", "0.01", "--set", "max_leaf=2"]);
    for word in ["bytes/node", "ns/test", "in vain", "primary rays", "kdop14", "hull", "convex hulls", "watertight test"] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
}

#[test]
fn a_structure_that_does_not_fit_is_a_row_with_the_reason() {
    let args = ["compare", "builtin:soup?triangles=20000", "--memory", "3", "--rays", "primary", "--size", "16x16"];
    let report = json(&[&args[..], &["--secs", "0.01", "--repeat", "1", "--json"]].concat());
    let rows = report["structures"].as_array().expect("a list");
    let kdtree = rows.iter().find(|row| row["id"] == "kdtree").expect("a row");
    let brute = &rows[0];
    assert_eq!((&brute["id"], &kdtree["id"]), (&json!("brute"), &json!("kdtree")));
    assert!(brute.get("error").is_none() && brute["rays"]["primary"]["count"].as_u64() > Some(0));
    assert!(kdtree["error"].as_str().expect("a reason").contains("memory budget"));
    assert!(kdtree["rays"].as_object().expect("an object").is_empty() && kdtree.get("nodes").is_none());
}
