//! Colours for amounts.

/// Viridis (Stéfan van der Walt and Nathaniel Smith for matplotlib, CC0) at `t` in 0 to 1, as
/// gamma-encoded red, green, blue. The polynomial is Matt Zucker's fit to its table (2019, CC0), off
/// by at most 5/255.
pub fn viridis(t: f32) -> [f32; 3] {
    const COEFFICIENTS: [[f32; 3]; 7] = [
        [0.277_727_33, 0.005_407_344_5, 0.334_099_8],
        [0.105_093_04, 1.404_613_5, 1.384_590_2],
        [-0.330_861_84, 0.214_847_56, 0.095_095_16],
        [-4.634_230_5, -5.799_101, -19.332_441],
        [6.228_27, 14.179_933, 56.690_55],
        [4.776_385, -13.745_145, -65.353_03],
        [-5.435_456, 4.645_852_6, 26.312_435],
    ];
    let t = if t.is_nan() { 0.0 } else { t.clamp(0.0, 1.0) };
    let channel = |k: usize| COEFFICIENTS.iter().rev().fold(0.0, |sum, c| sum * t + c[k]);
    [0, 1, 2].map(|k| channel(k).clamp(0.0, 1.0))
}

/// Signed amounts: blue at -1, white at 0, orange at 1, as gamma-encoded red, green, blue.
pub fn difference(t: f32) -> [f32; 3] {
    const BLUE: [f32; 3] = [0.13, 0.35, 0.67];
    const ORANGE: [f32; 3] = [0.87, 0.42, 0.05];
    const WHITE: [f32; 3] = [0.97, 0.97, 0.97];
    let t = if t.is_nan() { 0.0 } else { t.clamp(-1.0, 1.0) };
    let end = if t < 0.0 { BLUE } else { ORANGE };
    std::array::from_fn(|k| WHITE[k] + (end[k] - WHITE[k]) * t.abs())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn viridis_runs_from_violet_to_yellow_ever_brighter() {
        let near = |a: [f32; 3], b: [f32; 3]| (0..3).all(|k| (a[k] - b[k]).abs() < 0.02);
        assert!(near(viridis(0.0), [0.267, 0.005, 0.329]));
        assert!(near(viridis(0.5), [0.128, 0.567, 0.551]));
        assert!(near(viridis(1.0), [0.993, 0.906, 0.144]));
        let luma = |c: [f32; 3]| 0.3 * c[0] + 0.6 * c[1] + 0.1 * c[2];
        assert!((0..50u8).all(|i| luma(viridis(f32::from(i) / 50.0)) < luma(viridis(f32::from(i + 1) / 50.0))));
    }
}
