//! The rays of a file with what each does, as they are saved: too many to be made while the window waits.

use std::sync::Arc;

use crate::accel::stats::SahWeights;
use crate::geometry::Ray;
use crate::lab::ray_file::RayWork;
use crate::lab::{Field, Sheet};
use crate::task::{Budget, Cancel};
use crate::viewer::ray_list::Traced;
use crate::viewer::state::State;

/// All rays of the list, and what they do in one structure.
pub struct ListedRays {
    rays: Arc<Vec<Ray>>,
    traced: Arc<Traced>,
}

/// Rays between two looks at whether to stop.
const ROWS: usize = 1 << 12;
/// Bytes of a line, about.
const LINE: usize = 160;

impl ListedRays {
    /// Those of the open file, once they are traced.
    pub fn of(state: &State) -> Option<Self> {
        let (file, traced) = (state.ray_list.file.as_ref()?, state.ray_list.traced.as_ref()?);
        Some(Self { rays: Arc::clone(&file.rays), traced: Arc::clone(traced) })
    }

    /// As comma-separated values, the dearest ray first.
    ///
    /// # Errors
    /// In words: it does not fit, or it was stopped.
    pub fn csv(&self, budget: &Budget, cancel: &Cancel) -> Result<Vec<u8>, String> {
        let bytes = self.traced.order.len().saturating_mul(LINE);
        let _while_made = budget.charge(bytes as u64).map_err(|why| format!("Can't save the rays: {why}"))?;
        let mut sheet = Sheet::new(&[
            "ray",
            "structure",
            "nodes",
            "tests",
            "cost",
            "t",
            "origin x",
            "origin y",
            "origin z",
            "direction x",
            "direction y",
            "direction z",
            "tmin",
            "tmax",
        ]);
        let mut out = sheet.csv_head();
        out.reserve(bytes);
        for numbers in self.traced.order.chunks(ROWS) {
            cancel.check().map_err(|_| "Stopped.".to_owned())?;
            sheet.rows = numbers.iter().filter_map(|number| self.row(*number)).collect();
            sheet.csv_rows(&mut out);
        }
        Ok(out.into_bytes())
    }

    fn row(&self, number: u32) -> Option<Vec<Field>> {
        let at = number as usize;
        Some(row(self.traced.of.entry.id, number, self.rays.get(at)?, self.traced.work.get(at)?, self.weights()))
    }

    fn weights(&self) -> SahWeights {
        SahWeights::of(&self.traced.of.params)
    }
}

fn row(structure: &str, number: u32, ray: &Ray, work: &RayWork, weights: SahWeights) -> Vec<Field> {
    let mut fields: Vec<Field> = vec![
        (u64::from(number) + 1).into(),
        structure.into(),
        u64::from(work.nodes).into(),
        u64::from(work.tests).into(),
        work.cost(weights).into(),
        single(work.t),
    ];
    fields.extend(ray.origin.to_array().into_iter().chain(ray.dir.to_array()).chain([ray.tmin, ray.tmax]).map(single));
    fields
}

/// A number of 32 bits in the fewest digits that give it back; nothing if it is not finite.
fn single(x: f32) -> Field {
    if x.is_finite() { x.to_string().into() } else { Field::Missing }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::registry;
    use crate::geometry::tri::TestKind;
    use crate::viewer::kept::Key;
    use glam::Vec3;

    #[test]
    fn rays_are_written_the_dearest_first_and_as_exactly_as_they_are_known() {
        let entry = &registry::ALL[0];
        let rays = vec![Ray::new(Vec3::new(0.1, 0.0, -2.5), Vec3::X), Ray { tmax: 3.0, ..Ray::new(Vec3::ONE, Vec3::NEG_Z) }];
        let work = vec![RayWork { nodes: 1, tests: 0, t: f32::INFINITY }, RayWork { nodes: 7, tests: 4, t: 0.3 }];
        let of = Key { entry, params: entry.defaults(), test: TestKind::default() };
        let listed = ListedRays { rays: Arc::new(rays), traced: Arc::new(Traced { of, work, order: vec![1, 0] }) };
        let csv = listed.csv(&Budget::new(1 << 20), &Cancel::new()).expect("made");
        let text = String::from_utf8(csv).expect("text");
        let lines: Vec<&str> = text.lines().collect();
        assert_eq!(lines.len(), 3);
        assert!(lines[1].starts_with(&format!("2,{},7,4,", entry.id)) && lines[1].ends_with(",0.3,1,1,1,0,0,-1,0,3"), "{text}");
        assert!(lines[2].starts_with("1,") && lines[2].ends_with(",,0.1,0,-2.5,1,0,0,0,"), "{text}");
        assert!(listed.csv(&Budget::new(10), &Cancel::new()).is_err_and(|why| why.starts_with("Can't save the rays: ")));
        let stopped = Cancel::new();
        stopped.cancel();
        assert!(listed.csv(&Budget::new(1 << 20), &stopped).is_err());
    }
}
