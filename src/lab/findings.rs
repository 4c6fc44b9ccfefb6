//! Why rays are slow in a structure: what a sample of the view's rays does in it, cell by cell and triangle by triangle, and the
//! few sentences that come of it, ranked by the nanoseconds of a ray that they account for.

use std::collections::HashMap;
use std::sync::Arc;

use super::costs::{Costs, FitOptions, fit_costs};
use super::format::{capital, count, number, percent};
use super::measure::Contestant;
use super::rays::{RayKind, RaySet};
use super::tally::{Prim, Tally, Tested, shrunk};
use crate::accel::outline::Outline;
use crate::accel::params::{ParamValues, Value};
use crate::accel::registry::{Entry, Family};
use crate::accel::{Accel, CellId};
use crate::geometry::Aabb;
use crate::render::Job;
use crate::scene::Scene;
use crate::task::{Cancel, Cancelled, Pool, Progress};

/// What makes rays slow.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Cause {
    /// Triangles whose boxes are far larger than they are.
    LooseBoxes,
    /// Boxes of siblings that overlap.
    Overlap,
    /// Leaves of many triangles.
    FullLeaves,
    /// Cells without triangles.
    EmptyCells,
    /// A mesh that takes far more than its part.
    OneMesh,
}

/// A sentence, with its evidence and what shows it.
#[derive(Clone, Debug, PartialEq)]
pub struct Finding {
    /// What it is about.
    pub cause: Cause,
    /// The sentence, and what to try.
    pub text: String,
    /// Nanoseconds of a ray that it accounts for, as fitted costs have it; no number where they are not known.
    pub ns: f64,
    /// The same as a part of what steps and tests take in all.
    pub share: f64,
    /// The row of the outline where it is seen best.
    pub row: Option<u32>,
}

/// What the triangles of a mesh, or of a material, take.
#[derive(Clone, Debug, PartialEq)]
pub struct PartCost {
    /// Its name, or its number.
    pub name: String,
    /// Its part of the scene's triangles; no number where meshes are placed as instances.
    pub triangles: f64,
    /// Its part of the triangle tests.
    pub tests: f64,
    /// The part of its tests that are hits.
    pub hits: f64,
}

/// A triangle whose box is far larger than it is.
#[derive(Clone, Debug, PartialEq)]
pub struct LooseTriangle {
    /// Its number within its level, and the mesh that it is of.
    pub name: String,
    /// The area of its box over what it is for one of its area across two axes; infinite for a triangle without area.
    pub misfit: f64,
    /// How often it was tested.
    pub tests: u64,
    /// How often it was hit.
    pub hits: u64,
    /// The row of a leaf that it was tested in.
    pub row: Option<u32>,
}

/// Everything that was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// At most five, the dearest first.
    pub list: Vec<Finding>,
    /// Each mesh that is tested, the dearest first.
    pub meshes: Vec<PartCost>,
    /// The same of materials.
    pub materials: Vec<PartCost>,
    /// The tested triangles whose boxes fit worst, the loosest first.
    pub loosest: Vec<LooseTriangle>,
    /// Rays that were followed.
    pub rays: usize,
    /// Nodes that a ray enters, on average.
    pub nodes: f64,
    /// Triangles that it is tested against.
    pub tests: f64,
    /// What a step and a test take, if that could be told.
    pub costs: Option<Costs>,
}

/// About so many pixels have their rays followed.
const PIXELS: f64 = 8000.0;
/// At most so many sentences.
const MOST: usize = 5;
/// At most so many triangles whose boxes fit badly.
const LOOSEST: usize = 8;
/// A box of more than so many times the area that a triangle across two axes has is loose.
const LOOSE: f64 = 4.0;
/// Leaves of more triangles are full.
const FULL: u32 = 8;
/// Rows between two looks at whether to stop.
const PER_CHECK: u32 = 1 << 12;
/// What takes less than this part is not worth a sentence.
const LEAST: f64 = 0.1;

/// Looks for what makes the rays of a view of that shape slow in the structure of a job, which was built with such parameters and
/// whose cells the outline lists; primary rays, and as many that leave what they meet.
///
/// # Errors
/// [`Cancelled`] within 100 ms of the request.
pub fn find(
    job: &Job,
    size: [u32; 2],
    (entry, params, outline): (&Entry, &ParamValues, &Outline),
    pool: &Pool,
    cancel: &Cancel,
    progress: &Progress,
) -> Result<Findings, Cancelled> {
    let [width, height] = shrunk(size, PIXELS);
    let of = |kind| RaySet::generate(kind, job, width, height, pool, cancel);
    let sets = [of(RayKind::Primary)?, of(RayKind::Diffuse)?];
    let accel = job.accel.as_ref();
    let tally = Tally::of(accel, &sets, pool, cancel, progress)?;
    progress.start("costs", 0);
    let contestant = [Contestant { id: String::new(), accel: Arc::clone(&job.accel) }];
    let options = FitOptions { rounds: 3, cap_secs: 1.0 };
    let both: Vec<&RaySet> = sets.iter().collect();
    let costs = fit_costs(&contestant, &both, &options, pool, cancel, progress)?.into_iter().next().flatten();
    let cut = params.get("builder") == Some(Value::Choice("sbvh"));
    Ok(Finder::new(accel, &job.scene, (entry, cut, outline), &tally, costs, cancel)?.findings())
}

/// What the tally comes to.
struct Finder<'a> {
    accel: &'a dyn Accel,
    scene: &'a Scene,
    entry: &'a Entry,
    /// The builder cuts triangles.
    cut: bool,
    outline: &'a Outline,
    tally: &'a Tally,
    costs: Option<Costs>,
    /// Visits of rows, those that were visited.
    rows: Vec<(u32, u64)>,
    visits: f64,
    tests: f64,
}

impl<'a> Finder<'a> {
    fn new(
        accel: &'a dyn Accel,
        scene: &'a Scene,
        (entry, cut, outline): (&'a Entry, bool, &'a Outline),
        tally: &'a Tally,
        costs: Option<Costs>,
        cancel: &Cancel,
    ) -> Result<Self, Cancelled> {
        let mut rows = Vec::with_capacity(tally.visits.len());
        for row in 0..outline.len() {
            if row.is_multiple_of(PER_CHECK) {
                cancel.check()?;
            }
            rows.extend(tally.visits.get(&outline.id(row)).map(|visits| (row, *visits)));
        }
        let (visits, tests) = (tally.counts.nodes as f64, tally.counts.prims as f64);
        Ok(Self { accel, scene, entry, cut, outline, tally, costs, rows, visits, tests })
    }

    fn findings(self) -> Findings {
        let meshes = self.parts(|prim| self.mesh(prim), |mesh| self.name(mesh));
        let materials = self.parts(|prim| self.material(prim), |material| self.material_name(material));
        let found = [self.loose_boxes(), self.overlap(), self.full_leaves(), self.empty_cells(), self.one_mesh(&meshes)];
        let mut list: Vec<Finding> = found.into_iter().flatten().filter(|finding| finding.share >= LEAST).collect();
        list.sort_by(|a, b| b.share.total_cmp(&a.share));
        list.truncate(MOST);
        let over = |n: f64| n / self.tally.rays.max(1) as f64;
        let (rays, nodes, tests) = (self.tally.rays, over(self.visits), over(self.tests));
        Findings { list, meshes, materials, loosest: self.loosest(), rays, nodes, tests, costs: self.costs }
    }

    /// What so many steps and tests of all rays take of one ray, and as a part of all; without costs a step is a test.
    fn weigh(&self, steps: f64, tests: f64) -> (f64, f64) {
        let (step, test) = self.costs.as_ref().map_or((1.0, 1.0), |costs| (costs.c_trav_ns, costs.c_isect_ns));
        let all = step * self.visits + test * self.tests;
        let these = step * steps + test * tests;
        let ns = if self.costs.is_some() { these / self.tally.rays.max(1) as f64 } else { f64::NAN };
        (ns, if all > 0.0 { these / all } else { 0.0 })
    }

    fn finding(&self, cause: Cause, text: String, (ns, share): (f64, f64), row: Option<u32>) -> Finding {
        Finding { cause, text, ns, share, row }
    }

    /// The row of the leaf in which triangles of a kind are tested most.
    fn row_with(&self, tested: impl Iterator<Item = Tested>) -> Option<u32> {
        let mut by_leaf: HashMap<CellId, u64> = HashMap::new();
        for tested in tested {
            if let Some(leaf) = tested.leaf {
                *by_leaf.entry(leaf).or_default() += tested.tests;
            }
        }
        let most = by_leaf.into_iter().max_by_key(|(leaf, tests)| (*tests, *leaf))?.0;
        self.rows.iter().map(|(row, _)| *row).find(|row| self.outline.id(*row) == most)
    }

    /// The row of those visited that something is greatest of.
    fn row_of(&self, of: impl Fn(u32, u64) -> f64) -> Option<u32> {
        let best = self.rows.iter().map(|(row, visits)| (*row, of(*row, *visits))).filter(|best| best.1 > 0.0);
        best.max_by(|a, b| a.1.total_cmp(&b.1)).map(|best| best.0)
    }

    fn loose_boxes(&self) -> Option<Finding> {
        let loose: Vec<(Prim, Tested)> =
            self.tally.tests.iter().filter(|(prim, _)| self.looseness(**prim) > LOOSE).map(|(p, t)| (*p, *t)).collect();
        let sum = |of: fn(&Tested) -> u64| loose.iter().map(|(_, tested)| of(tested)).sum::<u64>() as f64;
        let (tests, hits) = (sum(|tested| tested.tests), sum(|tested| tested.hits));
        let triangles = loose.len() as f64 / self.tally.tests.len().max(1) as f64;
        let part = tests / self.heard();
        if part < LEAST || part < 1.5 * triangles {
            return None;
        }
        let mut by_mesh: HashMap<usize, u64> = HashMap::new();
        loose.iter().for_each(|(prim, tests)| *by_mesh.entry(self.mesh(*prim)).or_default() += tests.tests);
        let mesh = by_mesh.into_iter().max_by_key(|(_, tests)| *tests).map(|(mesh, _)| self.name(mesh)).unwrap_or_default();
        let remedy = if self.would_cut() { " Try the builder sbvh, which cuts them." } else { "" };
        let text = format!(
            "{} of the triangles that are tested take {} of the tests, and {} of those are hits: their boxes are loose, as those of long ones across the axes are. Most are in {mesh}.{remedy}",
            percent(triangles),
            percent(part),
            percent(hits / tests.max(1.0)),
        );
        // A leaf is entered for a few triangles.
        let steps = (tests - hits) / self.mean_leaf();
        let row = self.row_with(loose.iter().map(|(_, tested)| *tested));
        Some(self.finding(Cause::LooseBoxes, text, self.weigh(steps, tests - hits), row))
    }

    /// The triangles whose boxes fit worst, of those that are loose.
    fn loosest(&self) -> Vec<LooseTriangle> {
        let with_misfit = |(prim, tested): (&Prim, &Tested)| (self.looseness(*prim), *prim, *tested);
        let mut loose: Vec<(f64, Prim, Tested)> =
            self.tally.tests.iter().map(with_misfit).filter(|(misfit, ..)| *misfit > LOOSE).collect();
        loose.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
        loose.truncate(LOOSEST);
        let one = |(misfit, prim, tested): (f64, Prim, Tested)| LooseTriangle {
            name: format!("{} of {}", prim.1, self.name(self.mesh(prim))),
            misfit,
            tests: tested.tests,
            hits: tested.hits,
            row: self.row_with(std::iter::once(tested)),
        };
        loose.into_iter().map(one).collect()
    }

    /// Tests that were heard of: where triangles are looked at several at a time those that are left in doubt.
    fn heard(&self) -> f64 {
        self.tally.tests.values().map(|tested| tested.tests).sum::<u64>().max(1) as f64
    }

    /// Whether a builder that cuts triangles would do so where this one does not.
    fn would_cut(&self) -> bool {
        self.entry.family == Family::Bvh && !self.cut && self.entry.id != "volumes"
    }

    /// Triangles in a leaf that is entered, on average.
    fn mean_leaf(&self) -> f64 {
        let leaves = self.rows.iter().filter(|(row, _)| self.outline.row(*row).is_leaf()).map(|(_, visits)| *visits);
        (self.tests / leaves.sum::<u64>().max(1) as f64).max(1.0)
    }

    /// The area of a triangle's box over what it is for one of its area across two axes.
    fn looseness(&self, (level, prim): Prim) -> f64 {
        let corners = self.accel.geometry_of(level).corners(prim);
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let area = 0.5 * (b - a).cross(c - a).length();
        if area > 0.0 { Aabb::of_triangle(&corners).area() / (4.0 * area) } else { f64::INFINITY }
    }

    fn overlap(&self) -> Option<Finding> {
        // A sum over pairs of children: no line enters more of them than there are.
        let most = |row: u32| self.outline.children(row).take(8).count().saturating_sub(1) as f64;
        let overlap = |row: u32| Some(self.outline.row(row).overlap?.min(most(row)));
        let extra = |row: u32, visits: u64| overlap(row).unwrap_or(0.0) * visits as f64;
        let steps: f64 = self.rows.iter().map(|(row, visits)| extra(*row, *visits)).sum();
        let steps = steps.min(self.visits);
        let row = self.row_of(extra)?;
        let worst = self.outline.row(row);
        let text = format!(
            "Boxes of siblings overlap, so that a ray enters {} nodes more, and what is below them: most at node {} at depth {}, whose children share {} of it.{}",
            number(steps / self.tally.rays.max(1) as f64),
            worst.id.node,
            worst.depth,
            percent(overlap(row).unwrap_or(0.0).min(1.0)),
            if self.would_cut() { " Try the builder sbvh, or reinsertion." } else { "" },
        );
        Some(self.finding(Cause::Overlap, text, self.weigh(steps, 0.0), Some(row)))
    }

    fn full_leaves(&self) -> Option<Finding> {
        let full = |row: u32| Some(self.outline.row(row)).filter(|row| row.is_leaf() && row.references > FULL);
        let rows: Vec<(u32, u64, u32)> = self.rows.iter().filter_map(|(at, n)| Some((*at, *n, full(*at)?.references))).collect();
        let tests: f64 = rows.iter().map(|(_, visits, references)| (*visits * u64::from(*references)) as f64).sum();
        let tests = tests.min(self.tests);
        let (row, _, most) = *rows.iter().max_by_key(|(_, visits, references)| *visits * u64::from(*references))?;
        let text = format!(
            "{} leaves of more than {FULL} triangles take {} of the tests; the one that takes most holds {}.{}",
            count(rows.len() as u64),
            percent(tests / self.tests.max(1.0)),
            count(most.into()),
            match self.entry.family {
                Family::Grid if self.entry.id == "grid" =>
                    " Small things stand in a large room: try a structure that adapts, such as grid2 or a BVH.",
                Family::Brute => " Nothing is left out: try any structure.",
                _ => " Smaller leaves would help, if these triangles can be told apart.",
            },
        );
        Some(self.finding(Cause::FullLeaves, text, self.weigh(0.0, tests), Some(row)))
    }

    fn empty_cells(&self) -> Option<Finding> {
        let empty = |row: u32| Some(self.outline.row(row)).filter(|row| row.is_leaf() && row.references == 0).is_some();
        let steps: u64 = self.rows.iter().filter(|(row, _)| empty(*row)).map(|(_, visits)| *visits).sum();
        let row = self.row_of(|row, visits| if empty(row) { visits as f64 } else { 0.0 })?;
        let text = format!(
            "{} of the steps are into cells without a triangle: {} a ray.{}",
            percent(steps as f64 / self.visits.max(1.0)),
            number(steps as f64 / self.tally.rays.max(1) as f64),
            if self.entry.id == "grid" { " Try grid2, whose cells are as small only where there is something." } else { "" },
        );
        Some(self.finding(Cause::EmptyCells, text, self.weigh(steps as f64, 0.0), Some(row)))
    }

    fn one_mesh(&self, meshes: &[PartCost]) -> Option<Finding> {
        let mesh = meshes.first().filter(|_| meshes.len() > 1)?;
        // Of instances it is not known.
        let stands_out = mesh.tests >= 2.0 * mesh.triangles && mesh.tests >= LEAST;
        if !stands_out {
            return None;
        }
        let text = format!(
            "{} takes {} of the tests with {} of the triangles.",
            capital(&mesh.name),
            percent(mesh.tests),
            percent(mesh.triangles)
        );
        let its = self.tally.tests.iter().filter(|(prim, _)| self.name(self.mesh(**prim)) == mesh.name);
        let row = self.row_with(its.map(|(_, tested)| *tested));
        Some(self.finding(Cause::OneMesh, text, self.weigh(0.0, mesh.tests * self.tests), row))
    }

    /// Which mesh a triangle belongs to.
    fn mesh(&self, (level, prim): Prim) -> usize {
        let instance = match self.accel.level(level).and_then(|level| level.instance) {
            Some(instance) => instance,
            None => self.accel.geometry_of(level).locate(prim).0,
        };
        self.scene.instances.get(instance as usize).map_or(0, |instance| instance.mesh)
    }

    fn name(&self, mesh: usize) -> String {
        let name = self.scene.meshes.get(mesh).map_or("", |mesh| &mesh.name[..]);
        if name.is_empty() { format!("mesh {mesh}") } else { format!("mesh '{name}'") }
    }

    /// Which material a triangle has; the first number behind those of the scene stands for none.
    fn material(&self, prim: Prim) -> usize {
        let none = self.scene.materials.len();
        self.scene.meshes.get(self.mesh(prim)).and_then(|mesh| mesh.material).unwrap_or(none)
    }

    fn material_name(&self, material: usize) -> String {
        match self.scene.materials.get(material).map(|material| &material.name[..]) {
            None => "no material".to_owned(),
            Some("") => format!("material {material}"),
            Some(name) => format!("material '{name}'"),
        }
    }

    /// What the triangles take, by the part of the scene that they belong to.
    fn parts(&self, part_of: impl Fn(Prim) -> usize, name: impl Fn(usize) -> String) -> Vec<PartCost> {
        let mut by_part: HashMap<usize, [u64; 2]> = HashMap::new();
        for (prim, tests) in &self.tally.tests {
            let part = by_part.entry(part_of(*prim)).or_default();
            (part[0], part[1]) = (part[0] + tests.tests, part[1] + tests.hits);
        }
        let heard: u64 = by_part.values().map(|tests| tests[0]).sum();
        let triangles = self.triangles(&part_of);
        let cost = |(part, [tests, hits]): (usize, [u64; 2])| PartCost {
            name: name(part),
            triangles: triangles.as_ref().map_or(f64::NAN, |parts| parts.get(&part).copied().unwrap_or(0.0)),
            tests: tests as f64 / heard.max(1) as f64,
            hits: hits as f64 / tests.max(1) as f64,
        };
        let mut parts: Vec<PartCost> = by_part.into_iter().map(cost).collect();
        parts.sort_by(|a, b| b.tests.total_cmp(&a.tests).then_with(|| a.name.cmp(&b.name)));
        parts
    }
}

impl Finder<'_> {
    /// The share of the triangles that each part has, from a sample of them.
    fn triangles(&self, part_of: impl Fn(Prim) -> usize) -> Option<HashMap<usize, f64>> {
        const SAMPLE: usize = 1 << 16;
        if self.accel.levels().is_some() {
            return None;
        }
        let geometry = self.accel.geometry();
        let step = geometry.live_count().div_ceil(SAMPLE).max(1);
        let mut parts: HashMap<usize, f64> = HashMap::new();
        let sample: Vec<u32> = (0..geometry.live_count()).step_by(step).map(|i| geometry.live(i)).collect();
        let each = 1.0 / sample.len().max(1) as f64;
        sample.into_iter().for_each(|prim| *parts.entry(part_of((0, prim))).or_default() += each);
        Some(parts)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::stats::SahWeights;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::render::Mode as Picture;
    use crate::scene::{Camera, Geometry, Instance, LoadCx, Mesh, open};
    use glam::Vec3;

    fn findings(scene: Scene, id: &str, camera: Option<Camera>) -> (Findings, Outline) {
        let (cx, load) = (BuildCx::unattended(2), LoadCx::unattended());
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let entry = registry::find(id).expect("registered");
        let accel: Arc<dyn Accel> =
            Arc::from(entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds"));
        let outline = Outline::of(accel.as_ref(), SahWeights::of(&entry.defaults()), (&cx.budget, &cx.cancel, &cx.progress));
        let outline = outline.expect("small");
        let camera = camera.unwrap_or_else(|| scene.first_camera(geometry.world_bounds(), 1.6));
        let job = Job::new(Arc::new(scene), accel, camera, Picture::Shaded, Arc::default());
        let found = find(&job, [160, 100], (entry, &entry.defaults(), &outline), &cx.pool, &cx.cancel, &cx.progress)
            .expect("not cancelled");
        (found, outline)
    }

    fn of(found: &Findings, cause: Cause) -> Option<&Finding> {
        found.list.iter().find(|finding| finding.cause == cause)
    }

    /// A crowd of small triangles on a wall, and before it long ones across all axes.
    fn cables() -> Scene {
        let tri = |mesh: &mut Mesh, corners: [Vec3; 3]| {
            let first = u32::try_from(mesh.positions.len()).expect("few");
            mesh.positions.extend(corners);
            mesh.triangles.push([first, first + 1, first + 2]);
        };
        let (mut wall, mut cables) =
            (Mesh { name: "wall".into(), ..Mesh::default() }, Mesh { name: "cables".into(), ..Mesh::default() });
        for i in 0..1600u16 {
            let (x, y) = (f32::from(i % 40) * 0.025, f32::from(i / 40) * 0.025);
            let at = Vec3::new(x, y, 0.0);
            tri(&mut wall, [at, at + Vec3::X * 0.025, at + Vec3::Y * 0.025]);
            tri(&mut wall, [at + Vec3::new(0.025, 0.025, 0.0), at + Vec3::X * 0.025, at + Vec3::Y * 0.025]);
        }
        for i in 0..40u8 {
            let at = Vec3::new(f32::from(i) * 0.02, 0.0, 0.1);
            tri(&mut cables, [at, at + Vec3::new(0.3, 1.0, 0.8), at + Vec3::new(0.304, 1.0, 0.8)]);
        }
        Scene { meshes: vec![wall, cables], instances: vec![Instance::identity(0), Instance::identity(1)], ..Scene::default() }
    }

    #[test]
    fn long_triangles_across_the_axes_are_found_with_their_mesh() {
        let (found, outline) = findings(cables(), "bvh", None);
        let loose = of(&found, Cause::LooseBoxes).unwrap_or_else(|| panic!("{found:#?}"));
        assert!(loose.text.contains("mesh 'cables'") && loose.text.contains("sbvh"), "{}", loose.text);
        assert!(loose.row.is_some_and(|row| outline.row(row).is_leaf()));
        assert!(found.list.iter().all(|finding| finding.share >= LEAST && finding.share <= 1.0));
        assert!(found.list.windows(2).all(|pair| pair[0].share >= pair[1].share) && found.list.len() <= MOST);
        let (tests, triangles): (f64, f64) = found.meshes.iter().fold((0.0, 0.0), |a, m| (a.0 + m.tests, a.1 + m.triangles));
        assert!((tests - 1.0).abs() < 1e-9 && (triangles - 1.0).abs() < 1e-6, "{:?}", found.meshes);
        assert!(found.loosest.windows(2).all(|pair| pair[0].misfit >= pair[1].misfit) && found.loosest.len() == LOOSEST);
        assert!(found.loosest.iter().all(|t| t.name.contains("'cables'") && t.misfit > LOOSE && t.tests >= t.hits));
        assert!(found.loosest.iter().all(|t| t.row.is_some_and(|row| outline.row(row).is_leaf())));
        // Neither mesh has a material.
        assert!(found.materials.len() == 1 && found.materials[0].name == "no material");
        assert!((found.materials[0].tests - 1.0).abs() < 1e-9 && (found.materials[0].triangles - 1.0).abs() < 1e-6);
        let cables = of(&found, Cause::OneMesh).map(|finding| finding.text.clone());
        assert!(found.meshes[0].name == "mesh 'cables'" || cables.is_none());
    }

    #[test]
    fn a_small_thing_in_a_large_room_fills_one_cell_of_a_grid() {
        let scene = open("builtin:teapot-in-stadium", &LoadCx::unattended()).expect("built in");
        let (found, outline) = findings(scene, "grid", None);
        let full = of(&found, Cause::FullLeaves).unwrap_or_else(|| panic!("{found:#?}"));
        assert!(full.text.contains("grid2"), "{}", full.text);
        assert!(full.row.is_some_and(|row| outline.row(row).references > 100));
    }

    #[test]
    fn a_well_behaved_scene_has_no_loose_boxes_and_stopping_stops() {
        let scene = || open("builtin:teapot?triangles=5000", &LoadCx::unattended()).expect("built in");
        let (found, _) = findings(scene(), "bvh", None);
        assert!(of(&found, Cause::EmptyCells).is_none() && of(&found, Cause::FullLeaves).is_none(), "{:?}", found.list);
        assert!(found.rays > 5000 && found.nodes > 1.0 && found.tests > 0.1, "{found:?}");
        let cancel = Cancel::new();
        cancel.cancel();
        let (cx, load) = (BuildCx::unattended(1), LoadCx::unattended());
        let scene = scene();
        let geometry = Arc::new(Geometry::new(&scene, &load).expect("fits"));
        let entry = registry::find("bvh").expect("registered");
        let accel: Arc<dyn Accel> =
            Arc::from(entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &cx).expect("builds"));
        let outline = Outline::of(accel.as_ref(), SahWeights::default(), (&cx.budget, &cx.cancel, &cx.progress)).expect("small");
        let camera = scene.first_camera(geometry.world_bounds(), 1.6);
        let job = Job::new(Arc::new(scene), accel, camera, Picture::Shaded, Arc::default());
        assert!(find(&job, [160, 100], (entry, &entry.defaults(), &outline), &cx.pool, &cancel, &cx.progress).is_err());
    }
}
