//! Rays in NumPy files: an array (N, 8) of origin xyz, direction xyz, tmin, tmax.
//!
//! The header is read here rather than by a crate: the file may come from anywhere, and neither its claimed shape nor its
//! nesting may cost memory or stack.

use super::{PER_CHECK, RayFileError};
use crate::geometry::Ray;
use crate::geometry::num::narrow;
use crate::task::Cancel;

/// Numbers in a row.
const COLUMNS: usize = 8;
/// What such files begin with.
pub const MAGIC: &[u8] = b"\x93NUMPY";

/// The rays in the bytes of a file, so many at most.
///
/// # Errors
/// Stopped, or what is wrong with them.
pub fn parse(bytes: &[u8], most: usize, cancel: &Cancel) -> Result<Vec<Ray>, RayFileError> {
    let (header, data) = split(bytes)?;
    let width = header.number.width();
    let row = COLUMNS * width;
    let enough = header.rows.checked_mul(row as u64).is_some_and(|need| need == data.len() as u64);
    if !enough {
        return Err(format!("its header says {} rays of {row} bytes, but {} bytes follow", header.rows, data.len()).into());
    }
    let rows = data.len() / row;
    let number = |i: usize| header.number.read(&data[i * width..(i + 1) * width]);
    let at = |row: usize, k: usize| number(if header.by_column { k * rows + row } else { row * COLUMNS + k });
    let ray = |row: usize| bytemuck::cast::<[f32; COLUMNS], Ray>(std::array::from_fn(|k| at(row, k)));
    let mut rays = Vec::with_capacity(rows.min(most));
    for i in 0..rows.min(most) {
        if i.is_multiple_of(PER_CHECK) {
            cancel.check()?;
        }
        rays.push(ray(i));
    }
    Ok(rays)
}

/// What a header says.
#[derive(Debug, PartialEq)]
struct Header {
    number: Number,
    /// Whether the first index runs fastest ("Fortran order").
    by_column: bool,
    rows: u64,
}

/// How a number is stored.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Number {
    Little32,
    Big32,
    Little64,
    Big64,
}

impl Number {
    fn named(name: &str) -> Result<Self, String> {
        match name {
            "<f4" => Ok(Self::Little32),
            ">f4" => Ok(Self::Big32),
            "<f8" => Ok(Self::Little64),
            ">f8" => Ok(Self::Big64),
            _ => Err(format!("its numbers are '{name}'; rays are float32 or float64")),
        }
    }

    const fn width(self) -> usize {
        match self {
            Self::Little32 | Self::Big32 => 4,
            Self::Little64 | Self::Big64 => 8,
        }
    }

    /// Reads as many bytes as it is wide.
    fn read(self, bytes: &[u8]) -> f32 {
        let mut word = [0; 8];
        let width = self.width();
        word[..width].copy_from_slice(&bytes[..width]);
        let half = [word[0], word[1], word[2], word[3]];
        match self {
            Self::Little32 => f32::from_le_bytes(half),
            Self::Big32 => f32::from_be_bytes(half),
            Self::Little64 => narrow(f64::from_le_bytes(word)),
            Self::Big64 => narrow(f64::from_be_bytes(word)),
        }
    }
}

/// Parts the header from the data (NumPy's format, versions 1 to 3).
fn split(bytes: &[u8]) -> Result<(Header, &[u8]), String> {
    const CUT: &str = "its header is cut short";
    let rest = bytes.strip_prefix(MAGIC).ok_or("it is not a NumPy array: it does not begin with \\x93NUMPY")?;
    let (length, rest) = match rest {
        [1, _, a, b, rest @ ..] => (usize::from(u16::from_le_bytes([*a, *b])), rest),
        [2 | 3, _, a, b, c, d, rest @ ..] => (u32::from_le_bytes([*a, *b, *c, *d]) as usize, rest),
        [version, _, ..] if !(1..=3).contains(version) => return Err(format!("version {version} of the format is not known")),
        _ => return Err(CUT.to_owned()),
    };
    let (text, data) = rest.split_at_checked(length).ok_or(CUT)?;
    let text = std::str::from_utf8(text).map_err(|_| "its header is no text")?;
    Ok((header(text)?, data))
}

/// Reads the dictionary, `{'descr': '<f4', 'fortran_order': False, 'shape': (3, 8), }`.
fn header(text: &str) -> Result<Header, String> {
    let value = |key: &str| {
        let (_, rest) = text.split_once(&format!("'{key}'")).ok_or_else(|| format!("its header has no '{key}'"))?;
        Ok::<_, String>(rest.trim_start().strip_prefix(':').unwrap_or(rest).trim_start())
    };
    let descr = value("descr")?;
    let name = descr.strip_prefix('\'').and_then(|rest| rest.split_once('\'')).map(|(name, _)| name);
    let number = Number::named(name.ok_or("its rows are records; rays are plain numbers")?)?;
    let by_column = value("fortran_order")?.starts_with("True");
    let shape = value("shape")?.strip_prefix('(').and_then(|rest| rest.split_once(')')).map(|(shape, _)| shape);
    let shape = shape.ok_or("its shape is not a list")?;
    let sides: Vec<&str> = shape.split(',').map(str::trim).filter(|side| !side.is_empty()).collect();
    match sides[..] {
        [rows, "8"] => match rows.parse() {
            Ok(rows) => Ok(Header { number, by_column, rows }),
            Err(_) => Err(format!("its shape is ({shape})")),
        },
        _ => Err(format!("its shape is ({shape}); rays are (N, 8): origin xyz, direction xyz, tmin, tmax")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn rays() -> Vec<Ray> {
        let ray = |i: u8| Ray { tmax: f32::INFINITY, tmin: 0.5, ..Ray::new(Vec3::splat(f32::from(i)), Vec3::new(1.0, 2.0, 3.0)) };
        (0..5).map(ray).collect()
    }

    fn file(descr: &str, by_column: &str, shape: &str, data: &[u8]) -> Vec<u8> {
        let text = format!("{{'descr': '{descr}', 'fortran_order': {by_column}, 'shape': {shape}, }}\n");
        let length = u16::try_from(text.len()).expect("short").to_le_bytes();
        [&b"\x93NUMPY\x01\x00"[..], &length, text.as_bytes(), data].concat()
    }

    fn parse(bytes: &[u8]) -> Result<Vec<Ray>, String> {
        super::parse(bytes, usize::MAX, &Cancel::new()).map_err(|why| why.to_string())
    }

    #[test]
    fn other_widths_and_orders_are_read() {
        assert_eq!(parse(&file("<f4", "False", "(0, 8)", &[])), Ok(Vec::new()));
        let rows: Vec<[f32; COLUMNS]> = rays().into_iter().map(bytemuck::cast).collect();
        let flat = || rows.iter().flatten().copied();
        let wide: Vec<u8> = flat().flat_map(|x| f64::from(x).to_be_bytes()).collect();
        assert_eq!(parse(&file(">f8", "False", "(5, 8)", &wide)), Ok(rays()));
        let columns: Vec<u8> = (0..COLUMNS).flat_map(|k| rows.iter().flat_map(move |row| row[k].to_le_bytes())).collect();
        assert_eq!(parse(&file("<f4", "True", "(5, 8)", &columns)), Ok(rays()));
        let cancel = Cancel::new();
        let three = super::parse(&file("<f4", "True", "(5, 8)", &columns), 3, &cancel);
        assert_eq!(three.as_deref(), Ok(&rays()[..3]), "no more than asked for");
        cancel.cancel();
        assert!(super::parse(&file("<f4", "True", "(5, 8)", &columns), 3, &cancel).is_err());
    }

    #[test]
    fn what_is_wrong_with_a_file_is_said() {
        let why = |bytes: &[u8]| parse(bytes).expect_err("wrong");
        assert!(why(b"solid cube").contains("not a NumPy array"));
        assert!(why(b"").contains("not a NumPy array"));
        assert!(why(b"\x93NUMPY\x01\x00\xff\xff{").contains("cut short"));
        assert!(why(b"\x93NUMPY\x02\x00\xff\xff\xff\xff{").contains("cut short"));
        assert!(why(b"\x93NUMPY\x09\x00\x00\x00").contains("version 9"));
        assert!(why(&file("<i4", "False", "(1, 8)", &[0; 32])).contains("'<i4'"));
        assert!(why(&file("<f4", "False", "(8,)", &[0; 32])).contains("(8,)"));
        assert!(why(&file("<f4", "False", "(2, 7)", &[0; 56])).contains("(2, 7)"));
        assert!(why(&file("<f4", "False", "(2, 8)", &[0; 63])).contains("2 rays of 32 bytes, but 63"));
        assert!(why(&file("<f4", "False", "(18446744073709551615, 8)", &[0; 32])).contains("but 32 bytes follow"));
        assert!(why(&file("<f4", "False", "(-1, 8)", &[])).contains("(-1, 8)"));
    }
}
