//! The Compare workspace as it is saved: errors of pictures and of tests, quality, predictions, and scaling.

use crate::lab::converge::Reference;
use crate::lab::prediction::KINDS;
use crate::lab::tradeoffs::TradeoffRow;
use crate::lab::{Fairness, Field, Sheet};
use crate::viewer::state::State;

/// The picture's error, a row a point.
pub fn errors(state: &State) -> Sheet {
    let mut sheet =
        Sheet::new(&["structure", "build (s)", "spp", "seconds", "estimated noise", "RMSE", "relMSE", "MAE", "SMAPE", "hollow"]);
    let hollow = |reference: &Reference, rmse| if reference.is_hollow(rmse) { "yes" } else { "no" };
    for live in &state.errors.curves {
        for (i, shot) in live.shots.iter().enumerate() {
            let known = live.errors.get(i).copied().flatten();
            sheet.row([
                live.key.entry.id.into(),
                live.build_secs.into(),
                u64::from(shot.samples).into(),
                shot.secs.into(),
                shot.noise.into(),
                known.map(|e| e.rmse).into(),
                known.map(|e| e.relmse).into(),
                known.map(|e| e.mae).into(),
                known.map(|e| e.smape).into(),
                state.errors.reference.as_deref().zip(known).map(|(reference, e)| hollow(reference, e.rmse)).into(),
            ]);
        }
    }
    sheet
}

/// Errors of tests of triangles and boxes.
pub fn tests(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&[
        "structure",
        "test of",
        "test",
        "rays",
        "ns/ray",
        "wrong (1e-6)",
        "rounded (1e-6)",
        "t, one in a thousand (ulps)",
    ]);
    for row in &state.tradeoffs.rows {
        let triangles = row.tests.iter().map(|test| ("triangles", test.test.id(), &test.erring));
        let boxes = row.boxes.iter().map(|test| ("boxes", test.test.id(), &test.erring));
        for (of, test, erring) in triangles.chain(boxes) {
            sheet.row([
                row.name.clone().into(),
                of.into(),
                test.into(),
                (erring.rays as u64).into(),
                erring.ns.into(),
                erring.wrong_per_million.into(),
                erring.rounded_per_million.into(),
                erring.p999_ulps.into(),
            ]);
        }
    }
    sheet
}

/// How good structures are.
pub fn quality(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&[
        "structure",
        "build (s)",
        "SAH cost",
        "EPO",
        "predicted (ns/line)",
        "lines (ns)",
        "lines off (share)",
        "primary (ns)",
        "primary off (share)",
        "shadow (ns)",
        "shadow off (share)",
        "diffuse (ns)",
        "diffuse off (share)",
        "note",
    ]);
    for row in &state.tradeoffs.rows {
        let mut fields: Vec<Field> =
            vec![row.name.clone().into(), row.build_secs.into(), row.sah.into(), row.epo.into(), row.predicted_ns.into()];
        for kind in KINDS {
            fields.push(row.ns.get(&kind).copied().into());
            fields.push(row.prediction_error(kind).into());
        }
        fields.push(row.error.clone().into());
        sheet.rows.push(fields);
    }
    sheet
}

/// Predicted against measured: a row for each structure and kind of ray, also where one of both is not known.
pub fn prediction(rows: &[TradeoffRow]) -> Sheet {
    let mut sheet = Sheet::new(&[
        "structure",
        "rays",
        "predicted (ns/ray)",
        "measured (ns/ray)",
        "off (share)",
        "C_trav (ns)",
        "C_isect (ns)",
        "C_0 (ns)",
        "fit (R²)",
        "blocks of rays",
        "rays a block",
        "prediction took (s)",
        "note",
    ]);
    for row in rows {
        let costs = row.costs.as_ref();
        for kind in KINDS {
            sheet.row([
                row.name.clone().into(),
                kind.id().into(),
                row.predicted_ns.into(),
                row.ns.get(&kind).copied().into(),
                row.prediction_error(kind).into(),
                costs.map(|costs| costs.c_trav_ns).into(),
                costs.map(|costs| costs.c_isect_ns).into(),
                costs.map(|costs| costs.c0_ns).into(),
                costs.map(|costs| costs.r_squared).into(),
                costs.map(|costs| costs.blocks as u64).into(),
                costs.map(|costs| costs.rays_per_block as u64).into(),
                row.prediction_secs.into(),
                row.error.clone().into(),
            ]);
        }
    }
    sheet
}

/// Time against the number of triangles.
pub fn scaling(state: &State) -> Sheet {
    let mut sheet = Sheet::new(&[
        "structure",
        "triangles",
        "build (s)",
        "spread (s)",
        "builds",
        "ns/ray",
        "spread (ns/ray)",
        "rounds",
        "terms",
    ]);
    for structure in &state.tradeoffs.scaling {
        for p in &structure.points {
            sheet.row([
                structure.id.clone().into(),
                p.triangles.into(),
                p.build_secs.into(),
                p.build_spread.into(),
                (p.builds as u64).into(),
                (p.ray_secs * 1e9).into(),
                (p.ray_spread * 1e9).into(),
                (p.rounds as u64).into(),
                Fairness::LikeForLike.name().into(),
            ]);
        }
    }
    sheet
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lab::Costs;

    #[test]
    fn predictions_stand_beside_what_was_measured_row_by_row() {
        let whole = TradeoffRow {
            name: "bvh, \"x\"".to_owned(),
            predicted_ns: Some(150.0),
            ns: KINDS.into_iter().zip([100.0, 120.0, 75.0, 300.0]).collect(),
            costs: Some(Costs { c_trav_ns: 2.0, c_isect_ns: 3.0, c0_ns: 5.0, r_squared: 0.5, blocks: 256, ..Costs::default() }),
            prediction_secs: Some(0.25),
            ..TradeoffRow::default()
        };
        let none = TradeoffRow { name: "grid".to_owned(), error: Some("It does not fit.".to_owned()), ..TradeoffRow::default() };
        let csv = prediction(&[whole, none]).csv();
        let lines: Vec<&str> = csv.lines().skip(1).collect();
        assert_eq!(lines.len(), 2 * KINDS.len(), "none is left out");
        assert_eq!(lines[0], "\"bvh, \"\"x\"\"\",lines,150,100,0.5,2,3,5,0.5,256,0,0.25,");
        assert_eq!(lines[3], "\"bvh, \"\"x\"\"\",diffuse,150,300,-0.5,2,3,5,0.5,256,0,0.25,");
        assert_eq!(lines[4], "grid,lines,,,,,,,,,,,It does not fit.");
    }
}
