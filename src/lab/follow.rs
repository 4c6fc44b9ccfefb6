//! A ray followed step by step: every node that a structure enters or leaves out, and why, every triangle that it tests, where
//! along the ray that is, and what is known and still waits by then. All t are those of the world's ray.

use std::collections::{HashMap, HashSet};
use std::ops::ControlFlow;

use crate::accel::cell::{Cell, CellId, Descend, walk};
use crate::accel::probe::{Counts, Watched};
use crate::accel::{Accel, Hit, Mode, Prune, Step};
use crate::geometry::space::Back;
use crate::geometry::{Ray, Slabs};
use crate::task::{Cancel, Cancelled};

/// A ray, and what a structure did with it.
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    /// The ray.
    pub ray: Ray,
    /// What was asked.
    pub mode: Mode,
    /// What was done, in order.
    pub steps: Vec<FollowedStep>,
    /// More was done than is listed.
    pub more: bool,
    /// What was found.
    pub hit: Option<Hit>,
    /// How much was done in all.
    pub counts: Counts,
    /// The cells that steps speak of.
    pub cells: HashMap<CellId, Cell>,
}

/// A step, and where the ray is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FollowedStep {
    /// What is done.
    pub step: Step,
    /// On which level: see [`CellId`].
    pub instance: u32,
    /// Where the ray enters and leaves the cell, or the box around it; `None` where it misses it, and of triangles.
    pub interval: Option<[f32; 2]>,
    /// Where along the ray this is: where the cell begins or the triangle is met; of others what it was before.
    pub t: f32,
    /// The best hit so far; infinite if there is none.
    pub best: f32,
    /// Cells that wait: their parent was entered, and they come up later. Those that never do are not known of.
    pub waiting: u32,
}

impl FollowedStep {
    /// The cell that it speaks of.
    pub fn cell(&self) -> Option<CellId> {
        match self.step {
            Step::Entered(node) | Step::Pruned(node, _) => Some(CellId { instance: self.instance, node }),
            Step::Level(_) | Step::Tested(..) | Step::OutsideCell => None,
        }
    }
}

/// Steps that are listed of one ray.
const MOST: usize = 20_000;

/// Follows a world ray.
///
/// # Errors
/// [`Cancelled`], within 100 ms of the request.
pub fn follow(accel: &dyn Accel, ray: &Ray, mode: Mode, cancel: &Cancel) -> Result<Followed, Cancelled> {
    let (mut counts, mut heard, mut more) = (Counts::default(), Vec::new(), false);
    let mut listener = |step| if heard.len() < MOST { heard.push(step) } else { more = true };
    let mut watched = Watched { counts: &mut counts, listener: Some(&mut listener) };
    let hit = accel.trace_heard(ray, mode, &mut watched, cancel)?;
    let mut levels = Levels::new(accel, ray);
    let mut steps = Vec::with_capacity(heard.len());
    let (mut instance, mut t, mut best) = (0, ray.tmin, f32::INFINITY);
    for mut step in heard {
        match &mut step {
            Step::Level(level) => instance = *level,
            Step::Tested(_, Some(met)) => {
                *met = levels.world_t(instance, *met);
                t = *met;
                best = best.min(*met);
            }
            Step::Entered(_) | Step::Pruned(..) | Step::Tested(_, None) | Step::OutsideCell => {}
        }
        steps.push(FollowedStep { step, instance, interval: None, t, best, waiting: 0 });
    }
    let (cells, parents) = levels.cells(&steps, cancel)?;
    for step in &mut steps {
        let cell = step.cell().and_then(|id| cells.get(&id));
        step.interval = cell.and_then(|cell| levels.interval(cell));
    }
    place(&mut steps);
    count_waiting(&mut steps, &parents);
    Ok(Followed { ray: *ray, mode, steps, more, hit, counts, cells })
}

impl Followed {
    /// The last step before the first one beyond some t, of those that follow each other from the start.
    pub fn until(&self, t: f32) -> usize {
        self.steps.iter().skip(1).take_while(|step| step.t <= t).count()
    }

    /// The farthest that any step up to one has come.
    pub fn reached(&self, at: usize) -> f32 {
        self.steps.iter().take(at + 1).map(|step| step.t).fold(f32::NEG_INFINITY, f32::max)
    }

    /// The next step after one that enters a leaf, or the one before it.
    pub fn leaf(&self, at: usize, forward: bool) -> Option<usize> {
        let enters = |step: &FollowedStep| {
            matches!(step.step, Step::Entered(_)) && step.cell().and_then(|id| self.cells.get(&id)).is_some_and(Cell::is_leaf)
        };
        if forward {
            (at + 1..self.steps.len()).find(|i| enters(&self.steps[*i]))
        } else {
            (0..at.min(self.steps.len())).rev().find(|i| enters(&self.steps[*i]))
        }
    }

    /// The cell that is entered at a step, or was last.
    pub fn cell_at(&self, at: usize) -> Option<&Cell> {
        self.steps[..self.steps.len().min(at + 1)].iter().rev().find_map(|step| self.cells.get(&step.cell()?))
    }
}

/// Puts the steps that enter or leave out a cell where it begins, and others where the one before them is.
fn place(steps: &mut [FollowedStep]) {
    let mut now = steps.first().map_or(0.0, |step| step.t);
    for step in steps {
        now = match step.step {
            Step::Tested(_, Some(_)) => step.t,
            _ => step.interval.map_or(now, |interval| interval[0]),
        };
        step.t = now;
    }
}

/// Counts, at each step, the cells whose parent was entered and that come up only later.
fn count_waiting(steps: &mut [FollowedStep], parents: &HashMap<CellId, CellId>) {
    let mut entered = HashMap::new();
    let mut change = vec![0i64; steps.len() + 1];
    let mut seen = HashSet::new();
    for (i, step) in steps.iter().enumerate() {
        let Some(id) = step.cell() else { continue };
        let waits = matches!(step.step, Step::Entered(_) | Step::Pruned(_, Prune::BehindHit));
        if let Some(since) = parents.get(&id).and_then(|parent| entered.get(parent)).filter(|_| waits && seen.insert(id)) {
            change[*since] += 1;
            change[i] -= 1;
        }
        if matches!(step.step, Step::Entered(_)) {
            entered.entry(id).or_insert(i);
        }
    }
    let mut waiting = 0;
    for (step, change) in steps.iter_mut().zip(change) {
        waiting += change;
        step.waiting = u32::try_from(waiting).unwrap_or(0);
    }
}

/// The ray as each level sees it.
struct Levels<'a> {
    accel: &'a dyn Accel,
    world: Ray,
    known: HashMap<u32, Local>,
}

/// A ray in the space of a level, and the ways back: into the scene's scaled space, and into the world.
#[derive(Clone, Copy)]
struct Local {
    ray: Ray,
    slabs: Slabs,
    back: Option<Back>,
    world: Back,
}

/// What cells belong to.
type Cells = (HashMap<CellId, Cell>, HashMap<CellId, CellId>);

impl<'a> Levels<'a> {
    fn new(accel: &'a dyn Accel, ray: &Ray) -> Self {
        Self { accel, world: *ray, known: HashMap::new() }
    }

    fn local(&mut self, instance: u32) -> Local {
        if let Some(known) = self.known.get(&instance) {
            return *known;
        }
        let scene = self.accel.geometry().space();
        let entered = scene.enter(&self.world);
        let local = match self.accel.level(instance).filter(|level| level.instance.is_some()) {
            Some(level) => {
                let geometry = self.accel.geometry_of(instance);
                let mapped = geometry.space().enter_mapped(&entered.ray, &level.scene_from_level.inverse());
                let slabs = Slabs::new(&mapped.ray, geometry.bounds());
                Local { ray: mapped.ray, slabs, back: Some(mapped.back), world: entered.back }
            }
            None => Local { ray: entered.ray, slabs: Slabs::new(&entered.ray, scene.bounds()), back: None, world: entered.back },
        };
        self.known.insert(instance, local);
        local
    }

    fn world_t(&mut self, instance: u32, t: f32) -> f32 {
        let local = self.local(instance);
        local.world.world_t(local.back.map_or(t, |back| back.world_t(t)))
    }

    /// Where the ray is in a cell's box; `None` where it misses it.
    fn interval(&mut self, cell: &Cell) -> Option<[f32; 2]> {
        let local = self.local(cell.id.instance);
        let (entry, exit) = local.slabs.interval(cell.shape.bounds());
        let (entry, exit) = (entry.max(local.ray.tmin), exit.min(local.ray.tmax));
        (entry <= exit).then(|| [entry, exit].map(|t| self.world_t(cell.id.instance, t)))
    }

    /// The cells that steps speak of, and the ones around them.
    fn cells(&mut self, steps: &[FollowedStep], cancel: &Cancel) -> Result<Cells, Cancelled> {
        let wanted: HashSet<CellId> = steps.iter().filter_map(FollowedStep::cell).collect();
        let (mut cells, mut parents) = (HashMap::new(), HashMap::new());
        let mut open: Vec<(u32, CellId)> = Vec::new();
        let accel = self.accel;
        let mut stopped = Ok(());
        let mut looked = 0u32;
        walk(accel, &mut |cell| {
            looked += 1;
            if looked.is_multiple_of(1 << 12) {
                stopped = cancel.check();
            }
            if stopped.is_err() {
                return ControlFlow::Break(());
            }
            if wanted.contains(&cell.id) {
                while open.last().is_some_and(|above| above.0 >= cell.depth) {
                    open.pop();
                }
                parents.extend(open.last().map(|above| (cell.id, above.1)));
                cells.insert(cell.id, *cell);
                open.push((cell.depth, cell.id));
            }
            let met = cell.depth == 0 || self.interval(cell).is_some();
            ControlFlow::Continue(if met { Descend::Yes } else { Descend::No })
        });
        stopped?;
        Ok((cells, parents))
    }
}

/// A ray as a line of text: origin, direction, and the interval of t, as in a file of rays.
pub fn to_text(ray: &Ray) -> String {
    let [o, d] = [ray.origin, ray.dir].map(|v| v.to_array().map(|x| x.to_string()).join(" "));
    format!("{o}  {d}  {} {}", ray.tmin, ray.tmax)
}

/// The same back: six numbers or eight, between spaces or commas.
///
/// # Errors
/// What is wrong with the text, in words for the user.
pub fn from_text(text: &str) -> Result<Ray, String> {
    let words = text.split([' ', ',', ';', '\t', '\n', '\r', '(', ')', '[', ']']).filter(|word| !word.is_empty());
    let number = |word: &str| word.parse::<f32>().map_err(|_| format!("'{word}' is no number"));
    let numbers = words.map(number).collect::<Result<Vec<f32>, _>>()?;
    let (at, interval) = match numbers[..] {
        [_, _, _, _, _, _] => (&numbers[..], [0.0, f32::INFINITY]),
        [_, _, _, _, _, _, tmin, tmax] => (&numbers[..6], [tmin, tmax]),
        _ => return Err(format!("a ray is six or eight numbers (origin, direction, tmin, tmax), not {}", numbers.len())),
    };
    let ray = Ray::new(glam::Vec3::from_slice(at), glam::Vec3::from_slice(&at[3..]));
    let ray = Ray { tmin: interval[0], tmax: interval[1], ..ray };
    if ray.is_valid() {
        Ok(ray)
    } else {
        Err("that is no ray: it needs a direction, and an interval that is none the wrong way round".to_owned())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{BuildCx, registry};
    use crate::geometry::tri::TestKind;
    use crate::scene::{Geometry, LoadCx, open};
    use glam::Vec3;
    use std::sync::Arc;

    fn built(model: &str, id: &str) -> Box<dyn Accel> {
        let load = LoadCx::unattended();
        let geometry = Arc::new(Geometry::with_instances(&open(model, &load).expect("built in"), &load).expect("fits"));
        let entry = registry::find(id).expect("registered");
        entry.build(&geometry, TestKind::Watertight, &entry.defaults(), &BuildCx::unattended(1)).expect("builds")
    }

    /// From outside through the middle of the scene.
    fn through(accel: &dyn Accel, from: Vec3) -> Ray {
        let bounds = accel.geometry().world_bounds();
        let size = bounds.size().max_element();
        Ray::new(bounds.centre() + from * size, -from)
    }

    #[test]
    fn every_structure_tells_where_it_is_and_ends_at_the_hit() {
        for entry in registry::ALL {
            for model in ["builtin:soup?triangles=2000", "builtin:sphere-flake?triangles=5000"] {
                let accel = built(model, entry.id);
                let ray = through(accel.as_ref(), Vec3::new(0.9, 0.4, 0.3));
                let followed = follow(accel.as_ref(), &ray, Mode::Closest, &Cancel::new()).expect("not cancelled");
                let hit = followed.hit.expect("the scene is met");
                let last = followed.steps.last().expect("steps");
                // Below an instance t comes back by another road: the same but for rounding.
                assert!((last.best / hit.t - 1.0).abs() < 1e-5, "{} {model}: {} and {}", entry.id, last.best, hit.t);
                let is_entered = |s: &FollowedStep| matches!(s.step, Step::Entered(_));
                let entered = followed.steps.iter().filter(|s| is_entered(s)).count();
                assert!(entered as u64 <= followed.counts.nodes, "{}", entry.id);
                // The root below an instance is entered without a look at its box.
                let below = |i: usize| i > 0 && matches!(followed.steps[i - 1].step, Step::Level(_));
                for (_, step) in followed.steps.iter().enumerate().filter(|(i, s)| is_entered(s) && !below(*i)) {
                    let [a, b] = step.interval.unwrap_or_else(|| panic!("{} {model}: {step:?}", entry.id));
                    assert!(a <= b && step.t == a, "{}: {step:?}", entry.id);
                }
                let missed = followed.steps.iter().filter(|s| matches!(s.step, Step::Pruned(_, Prune::Missed)));
                let boxes = !matches!(entry.id, "kdtree" | "bsp" | "volumes");
                missed.for_each(|step| assert!(!boxes || step.interval.is_none(), "{} {model}: {step:?}", entry.id));
            }
        }
    }

    #[test]
    fn columns_go_on_until_their_next_step_is_beyond() {
        let (bvh, kd) = (built("builtin:soup?triangles=2000", "bvh"), built("builtin:soup?triangles=2000", "kdtree"));
        let ray = through(bvh.as_ref(), Vec3::new(0.9, 0.4, 0.3));
        let [a, b] = [bvh, kd].map(|accel| follow(accel.as_ref(), &ray, Mode::Closest, &Cancel::new()).expect("not cancelled"));
        assert!(a.steps.iter().any(|step| step.waiting > 1), "something waits on the way");
        for at in 0..a.steps.len() {
            let t = a.reached(at);
            let other = b.until(t);
            assert!(b.steps[1..=other].iter().all(|step| step.t <= t));
            assert!(b.steps.get(other + 1).is_none_or(|step| step.t > t));
        }
        let first = a.leaf(0, true).expect("a leaf is entered");
        assert!(a.cell_at(first).is_some_and(Cell::is_leaf));
        assert_eq!(a.leaf(first + 1, false), Some(first));
        assert_eq!(a.leaf(first, false), None);
    }

    #[test]
    fn a_ray_is_written_and_read() {
        let ray = Ray { tmin: 0.25, ..Ray::new(Vec3::new(1.5, -2.0, 1e-9), Vec3::new(0.1, 0.0, -1.0)) };
        assert_eq!(from_text(&to_text(&ray)), Ok(ray));
        assert_eq!(from_text("0,0,1, 0 0 -1").map(|ray| (ray.dir.z, ray.tmax)), Ok((-1.0, f32::INFINITY)));
        for (text, part) in [("1 2 3", "six or eight"), ("1 2 x 0 0 1", "'x'"), ("0 0 0 0 0 0", "direction")] {
            assert!(from_text(text).is_err_and(|why| why.contains(part)), "{text}");
        }
    }
}
