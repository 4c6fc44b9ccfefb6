//! Every road against the plain one, operation by operation.

use super::*;

/// All operations of a road on some numbers, as bits.
struct Everything([Lanes; 2]);

impl Kernel for Everything {
    type Out = Vec<u32>;

    #[inline(always)]
    fn run<S: Simd>(self, s: S) -> Vec<u32> {
        let [a, b] = self.0.map(|x| s.load(&x));
        let mut out = Vec::new();
        let bytes = self.0[0].map(|x| x.to_bits() as u8);
        let i = s.indices(&bytes);
        // Numbers that 32 bits do not hold.
        let x = s.mul_double(s.widen(a), s.splat_double(1.0 / 3.0));
        let y = s.add_double(s.widen(b), s.splat_double(f64::EPSILON));
        let columns = s.transpose([a, b, a, a, b, b, a, b]);
        let results = [
            s.add(a, b),
            s.sub(a, b),
            s.mul(a, b),
            s.div(a, b),
            s.min(a, b),
            s.max(a, b),
            s.splat(self.0[0][3]),
            s.permute(a, i),
            s.permute(b, s.flip(i, 5)),
            s.load_bits(&self.0[1].map(f32::to_bits)),
            s.splat_bits(bytes[0].into()),
            s.add_bits(a, b),
            s.sub_bits(a, b),
            s.and_bits(a, b),
            s.abs(a),
            s.select(s.lt(a, b), a, b),
            s.load_shorts(&self.0[0].map(|x| x.to_bits() as u16)),
            s.narrow(s.add_double(x, y)),
            s.narrow(s.sub_double(x, y)),
            s.narrow(s.mul_double(x, y)),
            s.narrow(s.div_double(x, y)),
            s.narrow(s.min_double(x, y)),
            s.narrow(s.max_double(x, y)),
            s.narrow(s.abs_double(x)),
            s.narrow(s.splat_double(self.0[0][3].into())),
        ];
        // All but the last, and all: the last of a list may be fetched in another way.
        let points: Vec<Vec3> = self.0[0].iter().zip(self.0[1]).map(|(a, b)| Vec3::new(*a, b, a + b)).collect();
        let (first, all) = (bytes.map(|i| u32::from(i % 7)), bytes.map(|i| u32::from(i % 8)));
        let gathered = [s.gather(&points, &first), s.gather(&points, &all), s.gather(&points[..1], &[0; LANES])];
        for result in results.into_iter().chain(columns).chain(gathered.into_iter().flatten()) {
            let (mut floats, mut bits) = ([0.0; LANES], [0; LANES]);
            s.store(result, &mut floats);
            s.store_bits(result, &mut bits);
            // Which of two NaNs a sum carries on is left open.
            out.extend(floats.map(|x| if x.is_nan() { 1 } else { x.to_bits() }));
            out.extend(bits.map(|x| if f32::from_bits(x).is_nan() { 1 } else { x }));
        }
        out.push(s.bits(s.lt_double(x, y)));
        let (le, lt, eq) = (s.le(a, b), s.lt(a, b), s.eq(a, b));
        out.extend([s.bits(le), s.bits(lt), s.bits(eq), s.bits(s.and(le, lt)), s.bits(s.or(lt, eq))]);
        out
    }
}

#[test]
fn every_road_computes_the_same() {
    let some = [0.0, -0.0, 1.0, -1.5, f32::INFINITY, f32::NEG_INFINITY, f32::NAN, 1e-45, f32::MAX, 0.1, 3.0, f32::MIN_POSITIVE];
    for shift in 0..some.len() {
        for step in 1..some.len() {
            let a = std::array::from_fn(|i| some[(i + shift) % some.len()]);
            let b = std::array::from_fn(|i| some[(i * step + 3) % some.len()]);
            let plain = Portable.run(Everything([a, b]));
            for road in Road::all() {
                assert_eq!(road.run(Everything([a, b])), plain, "{} of {a:?} and {b:?}", road.id());
            }
        }
    }
}

#[test]
fn the_tables_say_what_they_claim() {
    for mask in 0..256usize {
        let set: Vec<u8> = (0..8).filter(|bit| mask >> bit & 1 == 1).collect();
        assert_eq!(LEFT[mask][..set.len()], set[..]);
        for x in 0..8 {
            let flipped = set.iter().fold(0u8, |m, bit| m | 1 << (bit ^ x));
            assert_eq!(UNDER_XOR[usize::from(x)][mask], flipped);
        }
    }
}
