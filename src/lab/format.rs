//! How numbers are written: three significant digits, thin spaces between thousands, a decimal
//! point, and `–` for what is not there (never 0; the reason is the caller's to give).

/// What stands for a value that is missing.
pub const MISSING: &str = "–";

/// Separates thousands, and a value from its magnitude.
const THIN: char = '\u{2009}';

/// Three significant digits: `31.2`, `0.00412`, `12 600`, `1.23e-7`.
pub fn number(x: f64) -> String {
    if !x.is_finite() {
        return MISSING.to_owned();
    }
    let x = round_to_three(x);
    let magnitude = x.abs();
    if magnitude != 0.0 && !(1e-3..1e9).contains(&magnitude) {
        return scientific(x, 2);
    }
    let text = format!("{x:.*}", decimals(magnitude));
    if magnitude >= 1000.0 { group(&text) } else { text }
}

/// A count, exact below a million: `12 639`, then `10.7 M` and `2.10 G`.
pub fn count(n: u64) -> String {
    if n < 1_000_000 {
        return group(&n.to_string());
    }
    with_unit(n as f64, &[(1e6, "M"), (1e9, "G"), (1e12, "T")])
}

/// Bytes: `512 B`, `9.41 MiB`.
pub fn bytes(n: u64) -> String {
    if n < 1 << 10 {
        return format!("{n}{THIN}B");
    }
    with_unit(n as f64, &[(KIB, "KiB"), (KIB * KIB, "MiB"), (KIB * KIB * KIB, "GiB")])
}

const KIB: f64 = 1024.0;

/// A difference of bytes: `9.41 MiB`, `-528 B`; nothing is missing.
pub fn signed_bytes(n: i64) -> String {
    match n {
        0 => MISSING.to_owned(),
        n if n < 0 => format!("-{}", bytes(n.unsigned_abs())),
        n => bytes(n.unsigned_abs()),
    }
}

/// A duration: `4.12 ms`.
pub fn duration(secs: f64) -> String {
    with_unit(secs, TIME)
}

const TIME: &[(f64, &str)] = &[(1e-6, "µs"), (1e-3, "ms"), (1.0, "s")];

/// A measured duration: the median, half the interquartile range in the same unit and to the same
/// digit, and how many times it was measured: `4.12 ms ±0.08 (n = 9)`.
pub fn spread(median_secs: f64, half_iqr_secs: f64, n: usize) -> String {
    let Some((unit, name)) = unit_of(median_secs, TIME) else { return MISSING.to_owned() };
    let median = number(median_secs / unit);
    let digits = median.split_once('.').map_or(0, |(_, after)| after.len());
    let half = if half_iqr_secs.is_finite() { format!(" ±{:.digits$}", half_iqr_secs / unit) } else { String::new() };
    format!("{median}{THIN}{name}{half} (n = {n})")
}

/// Rays per second, in millions: `5.31 Mrays/s`.
pub fn rate(rays_per_sec: f64) -> String {
    if rays_per_sec.is_finite() { format!("{}{THIN}Mrays/s", number(rays_per_sec * 1e-6)) } else { MISSING.to_owned() }
}

/// How many times as much: `1.84x`.
pub fn ratio(x: f64) -> String {
    if x.is_finite() { format!("{}x", number(x)) } else { MISSING.to_owned() }
}

/// A share of the whole: `62 %`; what is not quite all or nothing does not read 100 or 0.
pub fn percent(share: f64) -> String {
    if !share.is_finite() {
        return MISSING.to_owned();
    }
    let whole = (share * 100.0).round();
    let shown = match share {
        s if s > 0.0 && whole == 0.0 => "<1".to_owned(),
        s if s < 1.0 && whole == 100.0 => ">99".to_owned(),
        _ => format!("{whole}"),
    };
    format!("{shown}{THIN}%")
}

/// By which share something is more or less: `+12 %`, `-3 %`.
pub fn signed_percent(share: f64) -> String {
    match share {
        s if !s.is_finite() => MISSING.to_owned(),
        s if s < 0.0 => format!("-{}", percent(-s)),
        s => format!("+{}", percent(s)),
    }
}

/// A share of the whole to three digits: `12.3 %`.
pub fn share(share: f64) -> String {
    if share.is_finite() { format!("{}{THIN}%", number(share * 100.0)) } else { MISSING.to_owned() }
}

/// A sentence from its first letter on: `Mesh 3 …`.
pub fn capital(text: &str) -> String {
    let mut letters = text.chars();
    letters.next().map(|first| first.to_uppercase().chain(letters).collect()).unwrap_or_default()
}

/// An error: `3.2e-4`.
pub fn error(x: f64) -> String {
    if !x.is_finite() {
        MISSING.to_owned()
    } else if x == 0.0 {
        "0".to_owned()
    } else {
        scientific(x, 1)
    }
}

/// What `write` makes of a value that may be missing.
pub fn or_missing<T>(value: Option<T>, write: impl FnOnce(T) -> String) -> String {
    value.map_or_else(|| MISSING.to_owned(), write)
}

/// Rounded to three significant digits.
fn round_to_three(x: f64) -> f64 {
    format!("{x:.2e}").parse().unwrap_or(x)
}

/// How many decimals show three significant digits of an already rounded magnitude.
fn decimals(magnitude: f64) -> usize {
    match magnitude {
        0.0 => 0,
        m if m >= 100.0 => 0,
        m if m >= 10.0 => 1,
        m if m >= 1.0 => 2,
        m if m >= 0.1 => 3,
        m if m >= 0.01 => 4,
        _ => 5,
    }
}

fn scientific(x: f64, decimals: usize) -> String {
    format!("{x:.decimals$e}")
}

/// The largest unit that is not larger than the value, rounding first: 999.9 µs is `1.00 ms`.
fn unit_of(x: f64, units: &[(f64, &'static str)]) -> Option<(f64, &'static str)> {
    if !x.is_finite() {
        return None;
    }
    let reaches = |(unit, _): &&(f64, &str)| round_to_three(x.abs() / unit) >= 1.0;
    units.iter().rev().find(reaches).or(units.first()).copied()
}

fn with_unit(x: f64, units: &[(f64, &'static str)]) -> String {
    unit_of(x, units).map_or_else(|| MISSING.to_owned(), |(unit, name)| format!("{}{THIN}{name}", number(x / unit)))
}

/// Thin spaces between thousands of a number without decimals.
fn group(digits: &str) -> String {
    let (sign, digits) = digits.strip_prefix('-').map_or(("", digits), |rest| ("-", rest));
    let mut out = String::from(sign);
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(THIN);
        }
        out.push(digit);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    /// With ordinary spaces, which can be seen here.
    fn plain(text: String) -> String {
        text.replace(THIN, " ")
    }

    #[test]
    fn three_significant_digits() {
        let table = [
            (0.0, "0"),
            (31.24, "31.2"),
            (4.1249, "4.12"),
            (-4.1249, "-4.12"),
            (0.004_12, "0.00412"),
            (0.999_9, "1.00"),
            (99.96, "100"),
            (12_639.0, "12 600"),
            (1.234e-7, "1.23e-7"),
            (2.5e11, "2.50e11"),
        ];
        for (x, expected) in table {
            assert_eq!(plain(number(x)), expected);
        }
    }

    #[test]
    fn counts_and_bytes() {
        for (n, expected) in [(0, "0"), (999, "999"), (12_639, "12 639"), (999_999, "999 999"), (10_700_123, "10.7 M")] {
            assert_eq!(plain(count(n)), expected);
        }
        for (n, expected) in
            [(0, "0 B"), (1023, "1023 B"), (1536, "1.50 KiB"), ((1 << 20) - 1, "1.00 MiB"), (3 << 30, "3.00 GiB")]
        {
            assert_eq!(plain(bytes(n)), expected);
        }
    }

    #[test]
    fn durations_pick_the_unit_after_rounding() {
        for (secs, expected) in
            [(4.12e-3, "4.12 ms"), (999.9e-6, "1.00 ms"), (3.2e-7, "0.320 µs"), (1.0, "1.00 s"), (0.0, "0 µs")]
        {
            assert_eq!(plain(duration(secs)), expected);
        }
        assert_eq!(plain(spread(4.12e-3, 0.08e-3, 9)), "4.12 ms ±0.08 (n = 9)");
        assert_eq!(plain(spread(41.2e-3, 0.08e-3, 9)), "41.2 ms ±0.1 (n = 9)");
        assert_eq!(plain(rate(5.314e6)), "5.31 Mrays/s");
    }

    #[test]
    fn shares_ratios_and_errors() {
        assert_eq!(ratio(1.8391), "1.84x");
        assert_eq!(error(3.2e-4), "3.2e-4");
        for (share, expected) in [(0.62, "62 %"), (0.001, "<1 %"), (0.9999, ">99 %"), (1.0, "100 %"), (0.0, "0 %")] {
            assert_eq!(plain(percent(share)), expected);
        }
        for (share, expected) in [(0.12, "+12 %"), (-0.034, "-3 %"), (2.5, "+250 %"), (0.0, "+0 %"), (f64::NAN, MISSING)] {
            assert_eq!(plain(signed_percent(share)), expected);
        }
    }

    #[test]
    fn what_is_missing_never_reads_zero() {
        for text in
            [number(f64::NAN), duration(f64::INFINITY), rate(f64::NAN), ratio(f64::NAN), error(f64::NAN), percent(f64::NAN)]
        {
            assert_eq!(text, MISSING);
        }
        assert_eq!(spread(f64::NAN, 0.0, 3), MISSING);
        assert_eq!(or_missing(None, count), MISSING);
    }
}
