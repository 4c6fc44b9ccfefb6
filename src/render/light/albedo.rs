//! The share of light that a rough mirror gives back, over all directions: tabulated once, by integration.

use std::sync::LazyLock;

use glam::{Vec2, Vec3};

use super::microfacet::{self, Roughness};

/// Nodes of the table along the cosine and along the roughness.
const NODES: usize = 32;
/// Directions on either axis that a node is integrated over.
const STEPS: usize = 48;
/// The least cosine: at 0 there is no light to share.
const LEAST: f32 = 1e-3;

/// With Schlick's Fresnel term the albedo is `f0 a + b`: both are looked up (Karis 2013).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Split {
    a: f32,
    b: f32,
}

/// What of light from one direction a rough mirror gives back, once and with what bounces between its facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    split: Split,
}

struct Table {
    /// By roughness, there by cosine.
    nodes: Vec<Split>,
    /// By roughness, the means over all directions, weighed by the cosine.
    means: Vec<Split>,
}

static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

impl Table {
    fn new() -> Self {
        let at = |k: usize| k as f32 / (NODES - 1) as f32;
        let node = |k: usize| integrate(at(k % NODES).max(LEAST), Roughness::new(at(k / NODES)));
        // By the thread that asks first: one of a pool that waited for others here could be given work that asks again,
        // and would wait for itself.
        let nodes: Vec<Split> = (0..NODES * NODES).map(node).collect();
        let mean = |row: &[Split]| {
            let weight = |k: usize| if k == 0 || k == NODES - 1 { 0.5 } else { 1.0 };
            let sum = |of: fn(&Split) -> f32| {
                row.iter().enumerate().map(|(k, split)| weight(k) * at(k) * of(split)).sum::<f32>() * 2.0 / (NODES - 1) as f32
            };
            Split { a: sum(|s| s.a), b: sum(|s| s.b) }
        };
        let means = nodes.chunks(NODES).map(mean).collect();
        Self { nodes, means }
    }
}

/// Both parts for light from a direction.
fn integrate(cosine: f32, roughness: Roughness) -> Split {
    let to = Vec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine);
    let mut split = Split::default();
    for i in 0..STEPS * STEPS {
        let u = (Vec2::new((i % STEPS) as f32, (i / STEPS) as f32) + 0.5) / STEPS as f32;
        let half = roughness.sample(to, u);
        let from = microfacet::mirrored(to, half);
        if from.z > 0.0 {
            let weight = roughness.masking_of_both(to, from) / roughness.masking(to);
            let grazing = (1.0 - to.dot(half)).clamp(0.0, 1.0).powi(5);
            split.a += weight * (1.0 - grazing);
            split.b += weight * grazing;
        }
    }
    let n = (STEPS * STEPS) as f32;
    Split { a: split.a / n, b: split.b / n }
}

/// Between two nodes: which, and how far.
fn between(x: f32) -> (usize, usize, f32) {
    let at = x.clamp(0.0, 1.0) * (NODES - 1) as f32;
    let low = crate::geometry::num::floor_index(at.into(), NODES - 2);
    (low, low + 1, at - low as f32)
}

fn mix(a: Split, b: Split, t: f32) -> Split {
    Split { a: a.a + (b.a - a.a) * t, b: a.b + (b.b - a.b) * t }
}

impl Albedo {
    /// For light from or to a direction with this cosine.
    pub fn of(cosine: f32, roughness: f32) -> Self {
        let ((x, x1, s), (y, y1, t)) = (between(cosine), between(roughness));
        let row = |y: usize| mix(TABLE.nodes[y * NODES + x], TABLE.nodes[y * NODES + x1], s);
        Self { split: mix(row(y), row(y1), t) }
    }

    /// The mean over all directions.
    pub fn mean(roughness: f32) -> Self {
        let (y, y1, t) = between(roughness);
        Self { split: mix(TABLE.means[y], TABLE.means[y1], t) }
    }

    /// How many times what bounces once comes back altogether, of a mirror that reflects `f0` head on: so that a perfect
    /// one gives all light back (Turquin 2019, equation 16).
    pub fn gain(self, f0: f32) -> f32 {
        let once = self.split.a + self.split.b;
        1.0 + f0 * (1.0 - once) / once.max(1e-4)
    }

    /// The share that comes back.
    pub fn share(self, f0: f32) -> f32 {
        (f0 * self.split.a + self.split.b) * self.gain(f0)
    }

    /// The share that a perfect mirror gives back at the first bounce.
    pub fn once(self) -> f32 {
        self.split.a + self.split.b
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smooth_mirrors_give_back_what_fresnel_says_and_rough_ones_lose_some() {
        for cosine in [0.2, 0.5, 0.9, 1.0f32] {
            let smooth = Albedo::of(cosine, 0.0);
            let fresnel = 0.04 + 0.96 * (1.0 - cosine).powi(5);
            assert!((smooth.share(0.04) - fresnel).abs() < 0.01, "{cosine}: {} beside {fresnel}", smooth.share(0.04));
            assert!((smooth.once() - 1.0).abs() < 1e-3);
            assert!(Albedo::of(cosine, 1.0).once() < 0.95);
        }
        for roughness in [0.0, 0.3, 0.7, 1.0] {
            for cosine in [0.01, 0.3, 1.0] {
                assert!((Albedo::of(cosine, roughness).share(1.0) - 1.0).abs() < 1e-5, "a perfect mirror loses nothing");
            }
        }
        let means = [0.0, 0.3, 0.7, 1.0].map(|roughness| Albedo::mean(roughness).once());
        assert!((means[0] - 1.0).abs() < 0.01 && means.is_sorted_by(|a, b| a > b), "{means:?}");
    }
}
