use super::*;

/// What the standard library makes of each word, and ours.
fn same(word: &str) {
    let ours = float(word.as_bytes(), 0).map(|(x, end)| (x.to_bits(), end));
    let theirs = word.parse::<f32>().ok().map(|x| (x.to_bits(), word.len()));
    assert_eq!(ours, theirs, "{word}");
}

#[test]
fn floats_are_those_of_the_standard_library() {
    let words = "0 -0 +0. .5 -.5e1 1. 1e5 1E-5 1e+5 00012 123456789 0.1 16777217 16777219 3.4028235e38 3.4028236e38 1e39 1e99 \
        1e-38 1.1754944e-38 1e-45 7e-46 9.99999999999999999999 0.000000000000000000001 1e9999999999999999999999 0e9999 0e99999999999 \
        18446744073709551615 9223372036854775808 0.1234567890123456789 inf -nan infinity 1.0e0 1.00000005960464477539 \
        1.000000059604644775390625 1.00000005960464477539062499999 8.5070595e37 5e-324 00000000000000000000000001 1.17549435e-38";
    words.split_whitespace().for_each(same);
    for word in [
        "", "-", "+", ".", "-.", "e5", "1e", "1e+", "1e+-5", "1e-+5", "--1", "+-1", "1x", "1,5", "1.2.3", "0x1", "1_0", "1\\",
        "٣",
    ] {
        assert!(word.parse::<f32>().is_err() && float(word.as_bytes(), 0).is_none(), "{word}");
    }
}

#[test]
fn floats_near_midpoints_are_rounded_once() {
    let mut bits = 0x1357_9BDF_u32;
    for _ in 0..20_000 {
        bits = bits.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        let x = f32::from_bits(bits >> 1);
        if !x.is_finite() {
            continue;
        }
        let middle = (f64::from(x) + f64::from(x.next_up())) / 2.0;
        for y in [middle, middle.next_up(), middle.next_down(), f64::from(x)] {
            same(&format!("{y:e}"));
            same(&format!("{y:.17e}"));
            same(&format!("{y:.8e}"));
            if (1e-6..1e9).contains(&y) {
                same(&format!("-{y}"));
                same(&format!("{y:.6}"));
            }
        }
    }
}

#[test]
fn whole_numbers_of_any_length_end_where_their_digits_do() {
    for n in [0, 7, 12, 123, 1234, 12_345, 123_456, 1_234_567, 12_345_678, 123_456_789, 1 << 40, i64::MAX, -1, -99_999_999] {
        for after in ["", "/", " 1", "//12345678", "\n", ":", "\u{80}"] {
            let text = format!("{n}{after}");
            assert_eq!(integer(text.as_bytes(), 0), Some((n, text.len() - after.len())), "{text}");
        }
    }
    for text in ["", "x", "+1", "--1", "9223372036854775808", "99999999999999999999"] {
        assert_eq!(integer(text.as_bytes(), 0), None, "{text}");
    }
}
