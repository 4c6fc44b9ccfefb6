//! Dividing a node by any plane across an axis: what each side would hold and cost; and the planes that simpler rules than
//! the surface area heuristic would have chosen.

use crate::accel::stats::SahWeights;
use crate::geometry::{Aabb, Axis};
use crate::task::{Cancel, Cancelled};

/// One side of a division.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Side {
    /// References.
    pub references: usize,
    /// The area of what bounds them: their own box in a hierarchy, the part of the cell where cells divide space.
    pub area: f64,
}

/// A division, and what it costs a line through the node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Division {
    /// The axis that the plane crosses, and where: from 0 to 1 along the node.
    pub plane: (Axis, f64),
    /// Towards smaller values.
    pub left: Side,
    /// Towards larger ones.
    pub right: Side,
    /// `C_trav + C_isect (A_l n_l + A_r n_r) / A`, less what is forgiven for empty space.
    pub cost: f64,
}

/// Another way to divide the node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Alternative {
    /// What it is called.
    pub name: &'static str,
    /// How it chooses, in a sentence.
    pub help: &'static str,
    /// What it comes to; nothing where it can't divide the node.
    pub division: Option<Division>,
}

/// Boxes in a node, sorted along one axis, so that any plane is weighed at once.
#[derive(Clone, Debug, PartialEq)]
pub struct Sorted {
    axis: Axis,
    node: Aabb,
    weights: SahWeights,
    /// What is forgiven of the cost where one side is empty: a share of it.
    bonus: f64,
    kind: Kind,
}

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    /// By centres: of a hierarchy.
    Centres {
        centres: Vec<f32>,
        /// The areas of what bounds the first so many, and all but those.
        left: Vec<f32>,
        right: Vec<f32>,
    },
    /// By faces: where cells divide space.
    Faces {
        starts: Vec<f32>,
        ends: Vec<f32>,
        /// Those that start where they end.
        flats: Vec<f32>,
    },
}

impl Sorted {
    /// Of a hierarchy: a box belongs to the side that its centre is on.
    pub fn by_centres(node: Aabb, boxes: &[Aabb], axis: Axis, weights: SahWeights) -> Self {
        let k = axis.index();
        let mut order: Vec<&Aabb> = boxes.iter().collect();
        order.sort_unstable_by(|a, b| a.centre_twice()[k].total_cmp(&b.centre_twice()[k]));
        let areas = |boxes: &mut dyn Iterator<Item = &&Aabb>| {
            let mut side = Aabb::EMPTY;
            let add = |b: &&Aabb| {
                side = side.union(**b);
                side.area() as f32
            };
            std::iter::once(0.0).chain(boxes.map(add)).collect::<Vec<f32>>()
        };
        let left = areas(&mut order.iter());
        let mut right = areas(&mut order.iter().rev());
        right.reverse();
        let centres = order.iter().map(|b| b.centre()[k]).collect();
        Self { axis, node, weights, bonus: 0.0, kind: Kind::Centres { centres, left, right } }
    }

    /// Where cells divide space: a box belongs to every side that it reaches into.
    pub fn by_faces(node: Aabb, boxes: &[Aabb], axis: Axis, (weights, bonus): (SahWeights, f64)) -> Self {
        let k = axis.index();
        let sorted = |mut ends: Vec<f32>| {
            ends.sort_unstable_by(f32::total_cmp);
            ends
        };
        let (starts, ends) = (boxes.iter().map(|b| b.min[k]), boxes.iter().map(|b| b.max[k]));
        let flats = boxes.iter().filter(|b| b.min[k] == b.max[k]).map(|b| b.min[k]);
        let kind = Kind::Faces { starts: sorted(starts.collect()), ends: sorted(ends.collect()), flats: sorted(flats.collect()) };
        Self { axis, node, weights, bonus, kind }
    }

    /// Where a position lies in the node, from 0 to 1.
    pub fn place(&self, x: f32) -> f64 {
        let k = self.axis.index();
        let (min, size) = (f64::from(self.node.min[k]), f64::from(self.node.size()[k]));
        if size > 0.0 { (f64::from(x) - min) / size } else { 0.0 }
    }

    /// The other way round.
    pub fn position(&self, place: f64) -> f32 {
        let k = self.axis.index();
        (f64::from(self.node.min[k]) + place * f64::from(self.node.size()[k])) as f32
    }

    /// The division by a plane at a place from 0 to 1.
    pub fn at(&self, place: f64) -> Division {
        self.at_position(self.position(place), place)
    }

    fn at_position(&self, pos: f32, place: f64) -> Division {
        let (left, right) = match &self.kind {
            Kind::Centres { centres, .. } => self.first(centres.partition_point(|c| *c < pos)),
            Kind::Faces { starts, ends, flats } => {
                // One that lies in the plane counts below.
                let inside = flats.partition_point(|f| *f <= pos) - flats.partition_point(|f| *f < pos);
                let below = starts.partition_point(|s| *s < pos) + inside;
                let above = ends.len() - ends.partition_point(|e| *e <= pos);
                let (low, high) = self.node.split(self.axis, pos);
                (Side { references: below, area: low.area() }, Side { references: above, area: high.area() })
            }
        };
        self.division(place, left, right)
    }

    /// The sides when so many are on the left; of faces there is no such order.
    fn first(&self, n: usize) -> (Side, Side) {
        let Kind::Centres { centres, left, right } = &self.kind else { return (Side::default(), Side::default()) };
        let side = |references, areas: &[f32]| Side { references, area: f64::from(areas[n]) };
        (side(n, left), side(centres.len() - n, right))
    }

    fn division(&self, place: f64, left: Side, right: Side) -> Division {
        let children = left.area * left.references as f64 + right.area * right.references as f64;
        let empty = left.references == 0 || right.references == 0;
        let cost = cost_of(self.weights, children / self.node.area(), if empty { self.bonus } else { 0.0 });
        Division { plane: (self.axis, place), left, right, cost }
    }

    /// Every candidate: between every two neighbouring centres, or at every face inside the cell.
    pub fn candidates(&self) -> impl Iterator<Item = Division> + '_ {
        let mut planes = Vec::new();
        let mut between = 0..0;
        match &self.kind {
            Kind::Centres { centres, .. } => between = 1..centres.len().max(1),
            Kind::Faces { starts, ends, .. } => {
                planes.extend(starts.iter().chain(ends));
                planes.sort_unstable_by(f32::total_cmp);
                planes.dedup();
                let k = self.axis.index();
                planes.retain(|x| self.node.min[k] < *x && *x < self.node.max[k]);
            }
        }
        let at_face = |pos| self.at_position(pos, self.place(pos));
        between.filter_map(|n| self.between(n)).chain(planes.into_iter().map(at_face))
    }

    /// Between two neighbouring centres, so many being on the left.
    fn between(&self, n: usize) -> Option<Division> {
        let Kind::Centres { centres, .. } = &self.kind else { return None };
        let pos = centres.get(n.checked_sub(1)?)?.midpoint(*centres.get(n)?);
        let (left, right) = self.first(n);
        Some(self.division(self.place(pos), left, right))
    }

    /// The planes between so many slices of equal width of what the candidates span.
    pub fn buckets(&self, bins: u32) -> Vec<Division> {
        let (first, last) = match &self.kind {
            Kind::Centres { centres, .. } => (centres.first().copied(), centres.last().copied()),
            Kind::Faces { .. } => (Some(self.node.min[self.axis.index()]), Some(self.node.max[self.axis.index()])),
        };
        let (Some(first), Some(last)) = (first, last) else { return Vec::new() };
        if first >= last {
            return Vec::new();
        }
        let (first, last) = (self.place(first), self.place(last));
        (1..bins).map(|i| self.at(first + (last - first) * f64::from(i) / f64::from(bins))).collect()
    }

    /// What spans the centres, or the cell.
    fn extent(&self) -> f32 {
        match &self.kind {
            Kind::Centres { centres, .. } => centres.last().copied().unwrap_or(0.0) - centres.first().copied().unwrap_or(0.0),
            Kind::Faces { .. } => self.node.size()[self.axis.index()],
        }
    }

    /// As many on either side, as far as that goes.
    fn halves(&self) -> Option<Division> {
        match &self.kind {
            Kind::Centres { centres, .. } => self.between(centres.len() / 2),
            Kind::Faces { starts, .. } => {
                let pos = *starts.get(starts.len() / 2)?;
                let inside = (f64::EPSILON..1.0).contains(&self.place(pos));
                inside.then(|| self.at_position(pos, self.place(pos)))
            }
        }
    }
}

/// What a line through a node takes that tests so many triangles of its children, a share of the tests being forgiven.
pub fn cost_of(weights: SahWeights, tests: f64, forgiven: f64) -> f64 {
    weights.c_trav + weights.c_isect * tests * (1.0 - forgiven)
}

/// The cheapest of several that leave nothing of the node undivided.
fn cheapest(divisions: impl Iterator<Item = Division>) -> Option<Division> {
    divisions.filter(|d| d.left.references > 0 && d.right.references > 0).min_by(|a, b| a.cost.total_cmp(&b.cost))
}

/// Slices of equal width that are looked at for triangles to cut (Stich, Friedrich and Dietrich 2009, "Spatial Splits in
/// Bounding Volume Hierarchies").
const SLICES: u32 = 32;
/// Boxes between two looks at whether to stop.
const PER_CHECK: usize = 1 << 12;

/// The other ways to divide a node, of whose boxes these are the sorted ones, beside the cheapest candidate.
///
/// # Errors
/// [`Cancelled`] if asked to stop.
pub fn alternatives(
    sorted: &[Sorted; 3],
    boxes: &[Aabb],
    (exact, bins): (Option<Division>, u32),
    cancel: &Cancel,
) -> Result<Vec<Alternative>, Cancelled> {
    let longest = |of: &dyn Fn(&Sorted) -> f32| sorted.iter().reduce(|a, b| if of(b) > of(a) { b } else { a });
    let by_centres = longest(&Sorted::extent);
    let by_box = longest(&|s| s.node.size()[s.axis.index()]);
    let mut all = vec![
        Alternative { name: "Exact sweep", help: "The cheapest of all candidates on the three axes.", division: exact },
        Alternative {
            name: "Buckets",
            help: "The cheapest of the planes between slices of equal width (Wald 2007), as many as the builder has bins.",
            division: match sorted {
                [Sorted { kind: Kind::Centres { .. }, .. }, ..] => cheapest(sorted.iter().flat_map(|s| s.buckets(bins))),
                // Where space is divided, a plane may cut off emptiness.
                _ => sorted.iter().flat_map(|s| s.buckets(bins)).min_by(|a, b| a.cost.total_cmp(&b.cost)),
            },
        },
        Alternative {
            name: "Object median",
            help: "As many triangles on either side, across the axis along which their centres spread most; where space is divided, the middle of where they start along the longest side.",
            division: by_centres.and_then(Sorted::halves),
        },
        Alternative { name: "Spatial middle", help: "The middle of the longest side.", division: by_box.map(|s| s.at(0.5)) },
    ];
    if let [Sorted { kind: Kind::Centres { .. }, node, weights, .. }, ..] = sorted {
        let mut best = None;
        for axis in Axis::ALL {
            best = cheapest(best.into_iter().chain(spatial(*node, boxes, axis, *weights, cancel)?));
        }
        all.push(Alternative {
            name: "Spatial split",
            help: "The cheapest of 31 planes on each axis that cut triangles in two, whose boxes are cut with them: more references, less overlap (Stich et al. 2009).",
            division: best,
        });
    }
    Ok(all)
}

/// Planes that cut boxes in two: what reaches over one is on both sides, each part with its own box.
fn spatial(node: Aabb, boxes: &[Aabb], axis: Axis, weights: SahWeights, cancel: &Cancel) -> Result<Vec<Division>, Cancelled> {
    let none =
        Sorted { axis, node, weights, bonus: 0.0, kind: Kind::Faces { starts: Vec::new(), ends: Vec::new(), flats: Vec::new() } };
    let k = axis.index();
    if node.size()[k] <= 0.0 {
        return Ok(Vec::new());
    }
    let plane = |i: u32| none.position(f64::from(i) / f64::from(SLICES));
    let slice_of = |x: f32| (none.place(x) * f64::from(SLICES)).clamp(0.0, f64::from(SLICES - 1)) as u32;
    let mut parts = [Aabb::EMPTY; SLICES as usize];
    let (mut entries, mut exits) = ([0usize; SLICES as usize], [0usize; SLICES as usize]);
    for (i, b) in boxes.iter().enumerate() {
        if i.is_multiple_of(PER_CHECK) {
            cancel.check()?;
        }
        let (first, last) = (slice_of(b.min[k]), slice_of(b.max[k]));
        entries[first as usize] += 1;
        exits[last as usize] += 1;
        for slice in first..=last {
            let mut part = *b;
            part.min[k] = part.min[k].max(plane(slice));
            part.max[k] = part.max[k].min(plane(slice + 1));
            parts[slice as usize] = parts[slice as usize].union(if part.min[k] <= part.max[k] { part } else { *b });
        }
    }
    let sum = |n: &[usize]| n.iter().sum::<usize>();
    let around = |parts: &[Aabb]| parts.iter().fold(Aabb::EMPTY, |a, b| a.union(*b)).area();
    let divide = |i: u32| {
        let at = i as usize;
        let left = Side { references: sum(&entries[..at]), area: around(&parts[..at]) };
        let right = Side { references: sum(&exits[at..]), area: around(&parts[at..]) };
        none.division(f64::from(i) / f64::from(SLICES), left, right)
    };
    Ok((1..SLICES).map(divide).collect())
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    /// Unit cubes from these places on, along x, in the box around them all.
    fn cubes(starts: &[f32]) -> (Aabb, Vec<Aabb>) {
        let cube = |x: &f32| Aabb { min: Vec3::new(*x, 0.0, 0.0), max: Vec3::new(x + 1.0, 1.0, 1.0) };
        let boxes: Vec<Aabb> = starts.iter().map(cube).collect();
        (boxes.iter().fold(Aabb::EMPTY, |a, b| a.union(*b)), boxes)
    }

    fn sorted(node: Aabb, boxes: &[Aabb]) -> [Sorted; 3] {
        Axis::ALL.map(|axis| Sorted::by_centres(node, boxes, axis, SahWeights::default()))
    }

    #[test]
    fn a_plane_costs_what_the_formula_says() {
        // Three cubes at 0 and one at 9: the box is 10 long, with an area of 2 + 4 * 10 = 42.
        let (node, boxes) = cubes(&[0.0, 0.0, 0.0, 9.0]);
        let [x, y, _] = &sorted(node, &boxes);
        let middle = x.at(0.5);
        assert_eq!((middle.left, middle.right), (Side { references: 3, area: 6.0 }, Side { references: 1, area: 6.0 }));
        assert!((middle.cost - (1.0 + 4.0 * 6.0 / 42.0)).abs() < 1e-6);
        // All on one side: nothing is gained.
        assert!((x.at(0.0).cost - 5.0).abs() < 1e-6 && x.at(0.0).left.references == 0);
        assert_eq!((y.at(0.2).left.references, y.at(0.8).left.references), (0, 4));
        assert_eq!(x.candidates().count(), 3);
        assert!((x.position(x.place(2.5)) - 2.5).abs() < 1e-6);
    }

    #[test]
    fn where_space_is_divided_a_box_may_be_on_both_sides_and_emptiness_is_forgiven() {
        let (node, boxes) = cubes(&[0.0, 4.0, 9.0]);
        let x = Sorted::by_faces(node, &boxes, Axis::X, (SahWeights::default(), 0.25));
        let through = x.at(0.45);
        assert_eq!((through.left.references, through.right.references), (2, 2));
        // Areas of parts of the cell, 4.5 and 5.5 long.
        assert!((through.cost - (1.0 + (20.0 * 2.0 + 24.0 * 2.0) / 42.0)).abs() < 1e-5, "{through:?}");
        let wider = Aabb { max: node.max + Vec3::X * 10.0, ..node };
        let empty = Sorted::by_faces(wider, &boxes, Axis::X, (SahWeights::default(), 0.25)).at(0.75);
        assert_eq!(empty.right.references, 0);
        assert!((empty.cost - (1.0 + 0.75 * 3.0 * 62.0 / 82.0)).abs() < 1e-5, "{empty:?}");
        // Those that end in the plane are below it, those that begin there above, and flat ones in it below.
        let (node, mut boxes) = cubes(&[0.0, 1.0]);
        boxes.push(Aabb { min: Vec3::X, max: Vec3::ONE });
        let touching = Sorted::by_faces(node, &boxes, Axis::X, (SahWeights::default(), 0.0)).at(0.5);
        assert_eq!((touching.left.references, touching.right.references), (2, 1));
        assert_eq!(x.candidates().count(), 4, "the faces but those of the cell");
    }

    #[test]
    fn other_rules_divide_otherwise() {
        // A long one over all, and a crowd at either end.
        let (node, mut boxes) = cubes(&[0.0, 0.2, 0.4, 20.0, 20.2, 20.4, 20.6]);
        boxes.push(node);
        let sorted = sorted(node, &boxes);
        let exact = cheapest(sorted.iter().flat_map(Sorted::candidates));
        let all = alternatives(&sorted, &boxes, (exact, 16), &Cancel::new()).expect("not cancelled");
        let of = |name: &str| all.iter().find(|a| a.name == name).and_then(|a| a.division).expect(name);
        assert_eq!(of("Object median").left.references, 4);
        assert_eq!(of("Spatial middle").plane, (Axis::X, 0.5));
        let (best, cut) = (of("Exact sweep"), of("Spatial split"));
        assert!(all.iter().flat_map(|a| a.division).all(|d| d.cost >= best.cost.min(cut.cost)));
        assert_eq!(cut.left.references + cut.right.references, boxes.len() + 1, "the long one is cut");
        assert!(cut.cost < best.cost);
        let stopped = Cancel::new();
        stopped.cancel();
        assert!(alternatives(&sorted, &boxes, (exact, 16), &stopped).is_err());
    }
}
