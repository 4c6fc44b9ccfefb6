//! How much of everything goes into a report.

use crate::accel::params::ParamValues;
use crate::accel::registry::{self, Entry};
use crate::lab::{Enough, MeasureOptions};

/// How much of everything.
#[derive(Clone, Debug)]
pub struct Amount {
    /// Whether it is little.
    pub quick: bool,
    /// The structures, unless others are asked for.
    pub structures: &'static [&'static str],
    /// Columns and rows of the pictures.
    pub picture: [u32; 2],
    /// Samples a pixel of the path traced one.
    pub spp: u32,
    /// The picture whose rays are timed.
    pub rays: [u32; 2],
    /// How long they are timed.
    pub times: MeasureOptions,
    /// How many random lines are counted.
    pub lines: Enough,
    /// Triangles looked at for end-point overlap, at most.
    pub epo: usize,
    /// The picture whose error is measured.
    pub converge: [u32; 2],
    /// Its samples a pixel, at most.
    pub converge_spp: u32,
    /// How often it is timed.
    pub runs: u32,
    /// The picture whose rays quality is measured on.
    pub tradeoffs: [u32; 2],
    /// Whether the BVH is built by every builder for that.
    pub builders: bool,
    /// The picture whose rays are checked.
    pub check: [u32; 2],
    /// Seconds for that, of each structure.
    pub check_secs: f64,
}

impl Amount {
    /// Little, or enough for figures to rely on.
    pub fn of(quick: bool) -> Self {
        let times = MeasureOptions::default();
        if quick {
            Self {
                quick,
                structures: &["wide", "bvh", "kdtree", "grid2"],
                picture: [480, 300],
                spp: 16,
                rays: [240, 150],
                times: MeasureOptions { min_rounds: 3, min_secs: 0.15, cap_secs: 1.0, ..times },
                lines: Enough { three_sigma: 0.05, secs: 0.2, lines: 1 << 15 },
                epo: 5_000,
                converge: [80, 50],
                converge_spp: 16,
                runs: 1,
                tradeoffs: [120, 75],
                builders: false,
                check: [80, 50],
                check_secs: 0.5,
            }
        } else {
            Self {
                quick,
                structures: &["wide", "bvh", "kdtree", "grid2", "octree", "bsp"],
                picture: [640, 400],
                spp: 64,
                rays: [480, 300],
                times,
                lines: Enough::default(),
                epo: crate::accel::epo::MOST,
                converge: [160, 100],
                converge_spp: 64,
                runs: 3,
                tradeoffs: [240, 150],
                builders: true,
                check: [320, 200],
                check_secs: 10.0,
            }
        }
    }

    /// The structures, unless others are asked for.
    pub fn entries(&self) -> Vec<&'static Entry> {
        self.structures.iter().filter_map(|id| registry::find(id)).collect()
    }

    /// What repeats a report of a model on the command line: `view` and `light` are arguments of view and light, each after a
    /// blank. A model whose instances are kept has no report there.
    pub fn commands(&self, model: &str, ids: &str, [view, light]: [&str; 2], flat: bool) -> Vec<String> {
        let model = if model.contains(' ') { format!("\"{model}\"") } else { model.to_owned() };
        let size = |[width, height]: [u32; 2]| format!("{width}x{height}");
        let (rays, converge, check) = (size(self.rays), size(self.converge), size(self.check));
        let (quick, flatten) = (if self.quick { " --quick" } else { "" }, if flat { " --flatten" } else { "" });
        let (spp, runs) = (self.converge_spp, self.runs);
        let report = format!("boxwood report {model} -o DIR{quick} --structures {ids}{view}{light}");
        let others = [
            format!("boxwood compare {model} --structures {ids} --size {rays}{flatten} --quality --fit-costs{view}"),
            format!(
                "boxwood converge {model} -o DIR --structures {ids} --size {converge} --spp {spp} --runs {runs}{flatten}{view}{light}"
            ),
            format!("boxwood check {model} --structures {ids} --size {check}{view}"),
        ];
        flat.then_some(report).into_iter().chain(others).collect()
    }
}

/// The arguments of the command line that set what structures are built with otherwise than usual, each after a blank.
pub fn settings(structures: &[(&'static Entry, ParamValues)]) -> String {
    let of = |(entry, params): &(&'static Entry, ParamValues)| -> String {
        let changed = params.changed();
        changed.map(|(param, value)| format!(" --set {}.{}={value}", entry.id, param.id)).collect()
    };
    structures.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_usual_structures_are_registered_and_commands_name_all_that_they_need() {
        for quick in [true, false] {
            let amount = Amount::of(quick);
            assert_eq!(amount.entries().len(), amount.structures.len());
            let lines = amount.commands("a b.ply", "bvh", [" --test fast", " --sun 40,10"], true);
            assert!(lines.iter().all(|line| line.contains("\"a b.ply\"") && line.contains("--test fast")), "{lines:?}");
            assert_eq!((lines.len(), lines[0].contains("--quick")), (4, quick));
            assert_eq!(amount.commands("m", "bvh", ["", ""], false).len(), 3);
        }
    }
}
