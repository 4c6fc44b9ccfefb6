//! What was found of rays, of a node's volumes and of the model, as it is saved.

use crate::lab::findings::Findings;
use crate::lab::{Field, Fitting, MeshCheck, ModelCheck, Sheet};

/// Why rays are slow: sentences, what each mesh and material costs, and the loosest triangles.
pub fn causes(found: &Findings) -> Sheet {
    let mut sheet = Sheet::new(&[
        "kind",
        "what",
        "ns/ray",
        "work (share)",
        "tests (share)",
        "triangles (share)",
        "hits of its tests (share)",
        "misfit",
        "tests",
        "hits",
    ]);
    let none = || Field::Missing;
    for finding in &found.list {
        let (what, ns, share) = (finding.text.clone().into(), finding.ns.into(), finding.share.into());
        sheet.row(["finding".into(), what, ns, share, none(), none(), none(), none(), none(), none()]);
    }
    for (kind, parts) in [("mesh", &found.meshes), ("material", &found.materials)] {
        for part in parts {
            let [tests, triangles, hits] = [part.tests, part.triangles, part.hits].map(Field::from);
            let name = part.name.clone().into();
            sheet.row([kind.into(), name, none(), none(), tests, triangles, hits, none(), none(), none()]);
        }
    }
    for loose in &found.loosest {
        let (name, misfit) = (loose.name.clone().into(), loose.misfit.into());
        let [tests, hits] = [loose.tests, loose.hits].map(Field::from);
        sheet.row(["triangle".into(), name, none(), none(), none(), none(), none(), misfit, tests, hits]);
    }
    sheet
}

/// Bounding volumes around a node.
pub fn volumes(fitting: &Fitting) -> Sheet {
    let mut sheet = Sheet::new(&[
        "volume",
        "area (scaled)",
        "area (of the hull's)",
        "rays let in",
        "in vain",
        "in vain (share)",
        "test (ns)",
        "spread (ns)",
        "triangles",
        "triangles taken",
        "rays followed",
        "note",
    ]);
    let hull = fitting.rows.iter().find(|row| row.id == "hull").map(|row| row.area).filter(|area| *area > 0.0);
    for row in &fitting.rows {
        sheet.row([
            row.id.into(),
            row.area.into(),
            hull.map(|hull| row.area / hull).into(),
            (row.met as u64).into(),
            (row.in_vain as u64).into(),
            row.false_positives().into(),
            row.test_ns.into(),
            row.spread_ns.into(),
            (fitting.triangles as u64).into(),
            (fitting.taken as u64).into(),
            (fitting.followed as u64).into(),
            row.loose.then_some("fewer faces than its name says").into(),
        ]);
    }
    sheet
}

/// The check of a model: its triangles, what is worth saying of them, and structures beside exact arithmetic.
pub fn check(check: &ModelCheck) -> Sheet {
    let mut sheet = Sheet::new(&["of", "triangle test", "figure", "value", "remedy"]);
    for (figure, value) in figures(&check.mesh) {
        sheet.row(["mesh".into(), Field::Missing, figure.into(), value, Field::Missing]);
    }
    for sliver in &check.mesh.worst {
        let name = format!("aspect of triangle {} of instance {}", sliver.primitive, sliver.instance);
        sheet.row(["mesh".into(), Field::Missing, name.into(), sliver.aspect.into(), Field::Missing]);
    }
    for finding in check.mesh.findings() {
        let kind = if finding.grave { "warning" } else { "note" };
        sheet.row(["mesh".into(), Field::Missing, kind.into(), finding.what.into(), finding.remedy.into()]);
    }
    for row in &check.structures {
        for (figure, n) in [("rays", row.rays), ("wrong", row.wrong), ("rounded", row.rounded)] {
            sheet.row([row.id.clone().into(), row.test.id().into(), figure.into(), (n as u64).into(), Field::Missing]);
        }
    }
    sheet
}

fn figures(mesh: &MeshCheck) -> [(&'static str, Field); 12] {
    [
        ("surface", mesh.surface().into()),
        ("triangles", mesh.triangles.into()),
        ("slivers", mesh.slivers.into()),
        ("worst aspect", mesh.worst_aspect.into()),
        ("no area", mesh.degenerate.into()),
        ("not finite", mesh.non_finite.into()),
        ("copies", mesh.duplicates.into()),
        ("edges", mesh.edges.into()),
        ("open edges", mesh.boundary_edges.into()),
        ("branching edges", mesh.non_manifold_edges.into()),
        ("extent ratio", mesh.extent_ratio.into()),
        ("distance ratio", mesh.distance_ratio.into()),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::cell::Form;
    use crate::geometry::Aabb;
    use crate::lab::FitRow;
    use crate::lab::findings::{Cause, Finding, LooseTriangle, PartCost};

    fn lines(sheet: &Sheet) -> Vec<String> {
        assert!(sheet.rows.iter().all(|row| row.len() == sheet.columns.len()));
        sheet.csv().lines().skip(1).map(str::to_owned).collect()
    }

    #[test]
    fn findings_stand_with_what_parts_cost_and_loose_triangles() {
        let part = |name: &str| PartCost { name: name.to_owned(), triangles: f64::NAN, tests: 0.5, hits: 0.25 };
        let finding = Finding { cause: Cause::Overlap, text: "Boxes, they overlap.".to_owned(), ns: 12.5, share: 0.5, row: None };
        let loose = LooseTriangle { name: "7 of leaf".to_owned(), misfit: f64::INFINITY, tests: 9, hits: 0, row: None };
        let found = Findings {
            list: vec![finding],
            meshes: vec![part("hull")],
            materials: vec![part("glass")],
            loosest: vec![loose],
            ..Findings::default()
        };
        let expected = [
            "finding,\"Boxes, they overlap.\",12.5,0.5,,,,,,",
            "mesh,hull,,,0.5,,0.25,,,",
            "material,glass,,,0.5,,0.25,,,",
            "triangle,7 of leaf,,,,,,,9,0",
        ];
        assert_eq!(lines(&causes(&found)), expected);
    }

    #[test]
    fn volumes_are_told_beside_the_hull() {
        let row = |id: &'static str, area: f64, met: usize| FitRow {
            id,
            area,
            met,
            in_vain: met / 2,
            test_ns: 3.0,
            spread_ns: 0.5,
            loose: id == "kdop26",
            form: Form::Box(Aabb::EMPTY),
        };
        let mut fitting =
            Fitting { rows: vec![row("kdop26", 3.0, 8), row("hull", 2.0, 0)], triangles: 90, taken: 80, rays: 70, followed: 60 };
        let expected = ["kdop26,3,1.5,8,4,0.5,3,0.5,90,80,60,fewer faces than its name says", "hull,2,1,0,0,,3,0.5,90,80,60,"];
        assert_eq!(lines(&volumes(&fitting)), expected);
        fitting.rows.pop();
        assert!(lines(&volumes(&fitting))[0].starts_with("kdop26,3,,8,"), "no hull");
    }
}
