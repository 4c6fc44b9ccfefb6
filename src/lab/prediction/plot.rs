//! Predicted against measured as it is saved: a mark for each structure and kind of ray.

use super::{AXES, EQUAL, KINDS, points};
use crate::lab::plot::{Curve, Mark, Panel};
use crate::lab::rays::RayKind;
use crate::lab::tradeoffs::TradeoffRow;

/// What points of a kind of ray are drawn as.
pub const fn mark(kind: RayKind) -> Mark {
    match kind {
        RayKind::Primary => Mark::Square,
        RayKind::Shadow => Mark::Diamond,
        RayKind::Diffuse => Mark::Triangle,
        RayKind::Lines | RayKind::Shuffled => Mark::Circle,
    }
}

/// The plot. Each structure is named once, at its first mark.
pub fn panel(rows: &[TradeoffRow], title: String) -> Panel {
    let mut curves: Vec<Curve> = Vec::new();
    let mut named = None;
    for point in points(rows) {
        let name = if named == Some(&point.row.name) { String::new() } else { point.row.name.clone() };
        named = Some(&point.row.name);
        let at = [(point.predicted, point.measured)];
        curves.push(Curve { name, mark: Some(mark(point.kind)), ..Curve::of(&point.row.structure, at) });
    }
    let keys = KINDS.map(|kind| (mark(kind), kind.id())).into();
    Panel { title, axes: AXES, curves, equal: Some(EQUAL), keys, labelled: true, ..Panel::default() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::plot::svg_of;

    #[test]
    fn there_is_a_mark_for_each_figure_at_its_place() {
        let row = |name: &str, structure: &str, predicted: f64| TradeoffRow {
            name: name.to_owned(),
            structure: structure.to_owned(),
            predicted_ns: Some(predicted),
            ns: KINDS.into_iter().zip([100.0, 80.0, 60.0, 120.0]).collect(),
            ..TradeoffRow::default()
        };
        let rows = [row("bvh", "bvh", 110.0), row("bvh <ploc>", "bvh", 90.0), row("brute", "brute", 90_000.0)];
        let panel = panel(&rows, "Teapot".to_owned());
        assert_eq!(panel.curves.len(), 3 * KINDS.len(), "none is hidden");
        assert_eq!(panel.curves.iter().filter(|curve| !curve.name.is_empty()).count(), 3);
        let at: Vec<(f64, f64)> = panel.curves.iter().flat_map(|curve| curve.points.iter().map(|dot| dot.at)).collect();
        assert_eq!(at[..4], [(110.0, 100.0), (110.0, 80.0), (110.0, 60.0), (110.0, 120.0)]);
        let svg = svg_of(&[panel]).expect("drawn");
        // Two circles each for three structures, one of the list; of squares, diamonds and triangles one each, and the list.
        assert_eq!((svg.matches("<circle").count(), svg.matches("<polygon").count()), (3 * 2 + 1, 3 * 3 + 3));
        for said in ["bvh", "bvh &lt;ploc&gt;", "brute", "lines", "primary", "shadow", "diffuse", EQUAL, AXES[0], AXES[1]] {
            assert_eq!(svg.matches(&format!("\n{said}\n")).count(), 1, "{said}");
        }
    }
}
