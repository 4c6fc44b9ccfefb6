//! What a triangle test costs by itself: one triangle after another, in plain code, whatever it stores of each made ready.

use std::hint::black_box;
use std::time::Instant;

use serde::Serialize;

use super::cases::shapes;
use crate::geometry::tri::{BaldwinWeber, Double, Exact, Fast, TestKind, Transformation, TriTest, Watertight};
use crate::geometry::{Aabb, Ray};
use crate::lab::statistics::median;
use crate::scene::builtin::Random;
use crate::task::{Cancel, Cancelled};
use glam::Vec3;

/// The price of a test.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct TestPrice {
    /// Which test.
    pub id: TestKind,
    /// Of one triangle, which most rays miss.
    pub ns_per_test: f64,
    /// What is read of a triangle: its corners, or what is stored in their place.
    pub bytes: usize,
}

/// Rounds that are timed.
const ROUNDS: usize = 9;
const RAYS: usize = 256;

/// Times all tests in turns, on the rays around a ball.
///
/// # Errors
/// Cancelled.
pub fn prices(cancel: &Cancel) -> Result<Vec<TestPrice>, Cancelled> {
    let triangles = shapes::ball(14);
    let rays = shapes::aimed(&mut Random::new(1, 0), &triangles, 3.0, RAYS);
    let transformations: Vec<Transformation<f32>> = triangles.iter().map(Transformation::new).collect();
    let (corners, stored) = (size_of::<[Vec3; 3]>(), size_of::<Transformation<f32>>());
    let bare = [
        (Fast::KIND, corners, of::<Fast> as Round),
        (BaldwinWeber::KIND, stored, of_stored),
        (Watertight::KIND, corners, of::<Watertight>),
        (Double::KIND, corners, of::<Double>),
        (Exact::KIND, corners, of::<Exact>),
    ];
    let things = Things { triangles, transformations, rays };
    let tests = (things.triangles.len() * things.rays.len()) as f64;
    let mut secs = bare.map(|_| Vec::with_capacity(ROUNDS));
    for _ in 0..ROUNDS {
        for ((_, _, round), secs) in bare.iter().zip(&mut secs) {
            cancel.check()?;
            let start = Instant::now();
            black_box(round(black_box(&things)));
            secs.push(start.elapsed().as_secs_f64());
        }
    }
    let price = |((id, bytes, _), secs): ((TestKind, usize, Round), Vec<f64>)| TestPrice {
        id,
        ns_per_test: median(&secs) * 1e9 / tests,
        bytes,
    };
    Ok(bare.into_iter().zip(secs).map(price).collect())
}

struct Things {
    triangles: Vec<[Vec3; 3]>,
    transformations: Vec<Transformation<f32>>,
    rays: Vec<Ray>,
}

type Round = fn(&Things) -> usize;

fn of<T: TriTest>(things: &Things) -> usize {
    let bounds = Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE };
    let met = |ray: &Ray| {
        let test = T::prepare(ray, &bounds);
        things.triangles.iter().filter(|tri| test.meet(tri).is_some()).count()
    };
    things.rays.iter().map(met).sum()
}

fn of_stored(things: &Things) -> usize {
    let met = |ray: &Ray| things.transformations.iter().filter(|tri| tri.hit(ray.origin, ray.dir).is_some()).count();
    things.rays.iter().map(met).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_test_has_a_price() {
        let prices = prices(&Cancel::new()).expect("not cancelled");
        let all = TestKind::ALL.into_iter().chain(TestKind::OTHERS);
        assert!(all.into_iter().all(|test| prices.iter().any(|p| p.id == test && p.ns_per_test > 0.0)));
    }
}
