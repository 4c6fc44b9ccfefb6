//! Eight rays, and eight points, side by side: one vector for each component.

use super::Ray;
use crate::simd::{LANES, Lanes, Simd};
use glam::Vec3;

/// Eight points.
#[derive(Clone, Copy, Debug)]
pub struct Points<F> {
    /// One of each.
    pub x: F,
    /// One of each.
    pub y: F,
    /// One of each.
    pub z: F,
}

// No closures: what is inlined into a road must say so, and closures cannot.
impl<F: Copy> Points<F> {
    /// The same point eight times.
    #[inline(always)]
    pub fn splat<S: Simd<F = F>>(s: S, p: Vec3) -> Self {
        Self { x: s.splat(p.x), y: s.splat(p.y), z: s.splat(p.z) }
    }

    /// The same number in every component.
    #[inline(always)]
    pub const fn all(x: F) -> Self {
        Self { x, y: x, z: x }
    }

    /// By axis, in memory.
    #[inline(always)]
    pub fn store<S: Simd<F = F>>(self, s: S, to: &mut [Lanes; 3]) {
        s.store(self.x, &mut to[0]);
        s.store(self.y, &mut to[1]);
        s.store(self.z, &mut to[2]);
    }

    /// Point `i[k]` in lane `k`.
    #[inline(always)]
    pub fn permute<S: Simd<F = F>>(self, s: S, i: S::I) -> Self {
        Self { x: s.permute(self.x, i), y: s.permute(self.y, i), z: s.permute(self.z, i) }
    }

    /// The sums.
    #[inline(always)]
    pub fn plus<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self { x: s.add(self.x, other.x), y: s.add(self.y, other.y), z: s.add(self.z, other.z) }
    }

    /// From other points to these.
    #[inline(always)]
    pub fn minus<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self { x: s.sub(self.x, other.x), y: s.sub(self.y, other.y), z: s.sub(self.z, other.z) }
    }

    /// Each times a number of its own.
    #[inline(always)]
    pub fn times<S: Simd<F = F>>(self, s: S, by: F) -> Self {
        Self { x: s.mul(self.x, by), y: s.mul(self.y, by), z: s.mul(self.z, by) }
    }

    /// Component by component.
    #[inline(always)]
    pub fn scaled<S: Simd<F = F>>(self, s: S, by: Self) -> Self {
        Self { x: s.mul(self.x, by.x), y: s.mul(self.y, by.y), z: s.mul(self.z, by.z) }
    }

    /// Without signs.
    #[inline(always)]
    pub fn abs<S: Simd<F = F>>(self, s: S) -> Self {
        Self { x: s.abs(self.x), y: s.abs(self.y), z: s.abs(self.z) }
    }

    /// The lesser of each component.
    #[inline(always)]
    pub fn min<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self { x: s.min(self.x, other.x), y: s.min(self.y, other.y), z: s.min(self.z, other.z) }
    }

    /// The greater of each component.
    #[inline(always)]
    pub fn max<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self { x: s.max(self.x, other.x), y: s.max(self.y, other.y), z: s.max(self.z, other.z) }
    }

    /// Component by component these where another is negative, and else those.
    #[inline(always)]
    pub fn where_negative<S: Simd<F = F>>(self, s: S, sign: Self, or: Self) -> Self {
        let zero = s.splat(0.0);
        Self {
            x: s.select(s.lt(sign.x, zero), self.x, or.x),
            y: s.select(s.lt(sign.y, zero), self.y, or.y),
            z: s.select(s.lt(sign.z, zero), self.z, or.z),
        }
    }

    /// Where no component is greater.
    #[inline(always)]
    pub fn at_most<S: Simd<F = F>>(self, s: S, other: Self) -> S::M {
        s.and(s.and(s.le(self.x, other.x), s.le(self.y, other.y)), s.le(self.z, other.z))
    }

    /// The least of the three components.
    #[inline(always)]
    pub fn least<S: Simd<F = F>>(self, s: S) -> F {
        s.min(s.min(self.x, self.y), self.z)
    }

    /// The greatest of the three components.
    #[inline(always)]
    pub fn greatest<S: Simd<F = F>>(self, s: S) -> F {
        s.max(s.max(self.x, self.y), self.z)
    }

    /// In the order of [`Vec3::cross`].
    #[inline(always)]
    pub fn cross<S: Simd<F = F>>(self, s: S, other: Self) -> Self {
        Self {
            x: s.sub(s.mul(self.y, other.z), s.mul(other.y, self.z)),
            y: s.sub(s.mul(self.z, other.x), s.mul(other.z, self.x)),
            z: s.sub(s.mul(self.x, other.y), s.mul(other.x, self.y)),
        }
    }

    /// In the order of [`Vec3::dot`].
    #[inline(always)]
    pub fn dot<S: Simd<F = F>>(self, s: S, other: Self) -> F {
        s.add(s.add(s.mul(self.x, other.x), s.mul(self.y, other.y)), s.mul(self.z, other.z))
    }
}

/// Eight rays: see [`Ray`].
#[derive(Clone, Copy, Debug)]
pub struct Rays<F> {
    /// Where each starts.
    pub origin: Points<F>,
    /// Where each goes.
    pub dir: Points<F>,
    /// The least t that counts.
    pub tmin: F,
    /// The greatest.
    pub tmax: F,
}

impl<F: Copy> Rays<F> {
    /// Eight in a row.
    #[inline(always)]
    pub fn load<S: Simd<F = F>>(s: S, rays: &[Ray; LANES]) -> Self {
        let [a, b, c, d, e, f, g, h]: &[Lanes; LANES] = bytemuck::cast_ref(rays);
        let rows = [s.load(a), s.load(b), s.load(c), s.load(d), s.load(e), s.load(f), s.load(g), s.load(h)];
        let [ox, oy, oz, dx, dy, dz, tmin, tmax] = s.transpose(rows);
        Self { origin: Points { x: ox, y: oy, z: oz }, dir: Points { x: dx, y: dy, z: dz }, tmin, tmax }
    }

    /// Which are valid, by the rule of [`Ray::is_valid`], a bit for each.
    #[inline(always)]
    pub fn valid<S: Simd<F = F>>(&self, s: S) -> u32 {
        let zero = s.splat(0.0);
        let zeros = self.origin.times(s, zero).plus(s, self.dir.times(s, zero));
        let finite = s.eq(s.add(s.add(zeros.x, zeros.y), zeros.z), zero);
        let somewhere = s.lt(zero, self.dir.abs(s).greatest(s));
        let interval = s.and(s.le(zero, self.tmin), s.le(self.tmin, self.tmax));
        s.bits(s.and(s.and(finite, somewhere), interval))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::space::Back;
    use crate::geometry::tri::{Fast, Own, TriTest, Watertight};
    use crate::geometry::{Aabb, EightSlabs, Space};
    use crate::simd::{Kernel, Road};
    use proptest::prelude::*;

    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![Just(0.0), Just(-0.0), Just(f32::NAN), Just(f32::INFINITY), -1.0f32..1.0, (-4i8..=4).prop_map(f32::from)]
    }

    fn point(of: impl Strategy<Value = f32> + Clone) -> impl Strategy<Value = Vec3> {
        (of.clone(), of.clone(), of).prop_map(|(x, y, z)| Vec3::new(x, y, z))
    }

    fn any_ray() -> impl Strategy<Value = Ray> {
        (point(number().boxed()), point(number().boxed()), -0.1f32..1.0, number()).prop_map(|(origin, dir, tmin, tmax)| Ray {
            origin,
            dir,
            tmin,
            tmax,
        })
    }

    /// Made ready all at once, as numbers.
    struct AtOnce<'a, T>(&'a [Ray; LANES], &'a Space, std::marker::PhantomData<T>);

    /// `o_lo`, `o_hi` and one over the direction, whether it runs forward, what the test needs, the interval, the
    /// way back.
    type Numbers = ([[f32; 3]; 3], u32, Own<f32>, [f32; 2], Back);

    impl<T: TriTest> Kernel for AtOnce<'_, T> {
        type Out = (u32, Option<Vec<Numbers>>);

        #[inline(always)]
        fn run<S: Simd>(self, s: S) -> Self::Out {
            let rays = Rays::load(s, self.0);
            let valid = rays.valid(s);
            let Some((rays, scales)) = self.1.enter_eight(s, &rays, valid) else { return (valid, None) };
            let slabs = EightSlabs::new(s, &rays, self.1.bounds());
            let lanes = |x: S::F| {
                let mut lanes = [0.0; LANES];
                s.store(x, &mut lanes);
                lanes
            };
            let points = |p: Points<S::F>| [lanes(p.x), lanes(p.y), lanes(p.z)];
            let parts = [points(slabs.o_lo), points(slabs.o_hi), points(slabs.inv)];
            let (forward, own) = (lanes(slabs.forward(s)), T::own_of_eight(s, &rays).map(lanes));
            let (tmin, tmax, scales) = (lanes(rays.tmin), lanes(rays.tmax), lanes(scales));
            let numbers = |i: usize| {
                let parts = parts.map(|part| part.map(|axis| axis[i]));
                let back = Back::scaled(scales[i]);
                (parts, forward[i].to_bits(), own.map(|number| number[i]), [tmin[i], tmax[i]], back)
            };
            (valid, Some((0..LANES).map(numbers).collect()))
        }
    }

    fn one_by_one<T: TriTest>(ray: &Ray, space: &Space) -> Numbers {
        let entered = space.enter(ray);
        let test = T::prepare(&entered.ray, space.bounds());
        let interval = [entered.ray.tmin, entered.ray.tmax];
        (test.slabs().parts(), test.slabs().forward(), test.own(), interval, entered.back)
    }

    fn are_the_same<T: TriTest>(rays: &[Ray; LANES], space: &Space) -> Result<usize, TestCaseError> {
        let mut at_once = 0;
        for road in Road::all() {
            let (valid, numbers) = road.run(AtOnce::<T>(rays, space, std::marker::PhantomData));
            for (i, ray) in rays.iter().enumerate() {
                prop_assert_eq!(valid >> i & 1 == 1, ray.is_valid(), "{:?} on {}", ray, road.id());
                if let Some(numbers) = numbers.as_ref().filter(|_| ray.is_valid()) {
                    prop_assert_eq!(format!("{:?}", numbers[i]), format!("{:?}", one_by_one::<T>(ray, space)), "{:?}", ray);
                    at_once += 1;
                }
            }
        }
        Ok(at_once)
    }

    proptest! {
        #[test]
        fn eight_rays_are_made_ready_as_one(rays in proptest::array::uniform8(any_ray()), size in -60i32..60) {
            let size = 2.0f32.powi(size);
            let space = Space::new(&Aabb { min: Vec3::splat(-3.0 * size), max: Vec3::splat(size) });
            are_the_same::<Watertight>(&rays, &space)?;
            are_the_same::<Fast>(&rays, &space)?;
        }
    }

    #[test]
    fn ordinary_rays_go_the_short_way() {
        let space = Space::new(&Aabb { min: Vec3::ZERO, max: Vec3::ONE });
        let rays = std::array::from_fn(|i| Ray::new(Vec3::splat(-2.0), Vec3::new(1.0, 0.1 * i as f32, -0.5)));
        let at_once = are_the_same::<Watertight>(&rays, &space).expect("the same");
        assert_eq!(at_once, LANES * Road::all().len());
    }
}
