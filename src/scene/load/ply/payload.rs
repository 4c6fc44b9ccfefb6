//! What follows the header: scalars, one after the other, as text or binary.

use super::header::{Element, Field, ScalarType, Shape, size};
use crate::geometry::num;
use crate::scene::load::pace::Pace;
use crate::scene::load::text::{Line, Lines, float, number, shown};
use crate::scene::{LoadCx, Reason};

/// Where scalars come from, in the order of the header.
pub(super) trait Payload {
    /// Fails early, and before anything is allocated, if the bytes cannot hold the element.
    fn enough_for(&self, element: &Element) -> Result<(), Reason>;

    /// Goes to the `index`-th of an element.
    fn begin(&mut self, element: &Element, index: usize) -> Result<(), Reason>;

    /// The next scalar. Every kind fits into 64 bits of float exactly.
    fn scalar(&mut self, kind: &ScalarType) -> Result<f64, Reason>;

    /// The length of a list whose items are of `item`, which the bytes that are left can hold.
    fn length(&mut self, count: &ScalarType, item: &ScalarType) -> Result<usize, Reason>;

    /// The bytes that are left, where they are binary and little endian.
    fn little_endian(&self) -> Option<&[u8]> {
        None
    }

    /// Passes over so many of [`Self::little_endian`].
    fn pass(&mut self, _: usize) {}

    /// What is wrong here.
    fn error(&self, what: String) -> Reason;

    /// Passes over a property.
    fn skip(&mut self, field: &Field) -> Result<(), Reason> {
        match &field.shape {
            Shape::One(kind) => self.scalar(kind).map(drop),
            Shape::List { count, item } => {
                let length = self.length(count, item)?;
                (0..length).try_for_each(|_| self.scalar(item).map(drop))
            }
        }
    }

    /// A float as a number of items.
    fn as_length(&self, length: f64) -> Result<usize, Reason> {
        let whole = length >= 0.0 && length.fract() == 0.0 && length <= f64::from(u32::MAX);
        if !whole {
            return Err(self.error(format!("a list cannot have {length} items")));
        }
        Ok(num::floor_index(length, usize::MAX))
    }
}

/// Text: one element a line.
pub(super) struct Text<'a> {
    lines: Lines<'a>,
    line: Line<'a>,
    words: Vec<&'a [u8]>,
    /// Words of the line that were read.
    read: usize,
    size: usize,
}

impl<'a> Text<'a> {
    /// The text after the header, whose first line is number `first` of the file.
    pub fn new(body: &'a [u8], first: usize, cx: &'a LoadCx) -> Self {
        let line = Line { number: first, bytes: b"" };
        Self { lines: Lines::new(body, first, cx), line, words: Vec::new(), read: 0, size: body.len() }
    }
}

impl Payload for Text<'_> {
    fn enough_for(&self, element: &Element) -> Result<(), Reason> {
        // A property takes a digit and a blank at least.
        match element.count.checked_mul(2 * element.fields.len()) {
            Some(least) if least <= self.size + 1 => Ok(()),
            _ => Err(ends_early(element, None)),
        }
    }

    fn begin(&mut self, element: &Element, index: usize) -> Result<(), Reason> {
        loop {
            self.line = self.lines.next()?.ok_or_else(|| ends_early(element, Some(index)))?;
            self.words.clear();
            self.words.extend(self.line.words());
            self.read = 0;
            if !self.words.is_empty() {
                return Ok(());
            }
        }
    }

    fn scalar(&mut self, kind: &ScalarType) -> Result<f64, Reason> {
        let word = self.words.get(self.read).ok_or_else(|| self.line.error("it has fewer values than the header says"))?;
        self.read += 1;
        let value = match kind {
            ScalarType::Float => float(word).map(f64::from),
            _ => number(word),
        };
        value.ok_or_else(|| self.line.error(format_args!("{} is no number", shown(word))))
    }

    fn length(&mut self, count: &ScalarType, _: &ScalarType) -> Result<usize, Reason> {
        let length = self.scalar(count)?;
        let length = self.as_length(length)?;
        let left = self.words.len() - self.read;
        if length > left {
            return Err(self.error(format!("a list says it has {length} items, but the line has {left}")));
        }
        Ok(length)
    }

    fn error(&self, what: String) -> Reason {
        self.line.error(what)
    }
}

/// Binary data.
pub(super) struct Binary<'a, const BIG: bool> {
    bytes: &'a [u8],
    at: usize,
    pace: Pace<'a>,
    /// The element in hand, for messages.
    here: (String, usize),
}

impl<'a, const BIG: bool> Binary<'a, BIG> {
    /// The bytes after the header.
    pub fn new(bytes: &'a [u8], cx: &'a LoadCx) -> Self {
        Self { bytes, at: 0, pace: Pace::new(cx), here: (String::new(), 0) }
    }

    fn left(&self) -> usize {
        self.bytes.len() - self.at
    }

    fn take<const N: usize>(&mut self) -> Result<[u8; N], Reason> {
        let Some(taken) = self.bytes[self.at..].first_chunk::<N>() else {
            return Err(self.error("the file ends here: it was cut short".to_owned()));
        };
        self.at += N;
        let mut taken = *taken;
        if BIG {
            taken.reverse();
        }
        Ok(taken)
    }
}

impl<const BIG: bool> Payload for Binary<'_, BIG> {
    fn enough_for(&self, element: &Element) -> Result<(), Reason> {
        match element.count.checked_mul(element.least_bytes()) {
            Some(least) if least <= self.left() => Ok(()),
            _ => Err(ends_early(element, None)),
        }
    }

    fn begin(&mut self, element: &Element, index: usize) -> Result<(), Reason> {
        if index == 0 {
            self.here.0.clone_from(&element.name);
        }
        self.here.1 = index;
        self.pace.step(element.least_bytes())?;
        Ok(())
    }

    fn scalar(&mut self, kind: &ScalarType) -> Result<f64, Reason> {
        Ok(match kind {
            ScalarType::Char => f64::from(i8::from_le_bytes(self.take()?)),
            ScalarType::UChar => f64::from(u8::from_le_bytes(self.take()?)),
            ScalarType::Short => f64::from(i16::from_le_bytes(self.take()?)),
            ScalarType::UShort => f64::from(u16::from_le_bytes(self.take()?)),
            ScalarType::Int => f64::from(i32::from_le_bytes(self.take()?)),
            ScalarType::UInt => f64::from(u32::from_le_bytes(self.take()?)),
            ScalarType::Float => f64::from(f32::from_le_bytes(self.take()?)),
            ScalarType::Double => f64::from_le_bytes(self.take()?),
        })
    }

    fn length(&mut self, count: &ScalarType, item: &ScalarType) -> Result<usize, Reason> {
        let length = self.scalar(count)?;
        let length = self.as_length(length)?;
        let bytes = length.saturating_mul(size(item));
        if bytes > self.left() {
            return Err(self.error(format!("a list says it has {length} items, more than the file holds")));
        }
        self.pace.step(bytes)?;
        Ok(length)
    }

    fn little_endian(&self) -> Option<&[u8]> {
        (!BIG).then(|| &self.bytes[self.at..])
    }

    fn pass(&mut self, bytes: usize) {
        self.at = self.bytes.len().min(self.at + bytes);
    }

    fn skip(&mut self, field: &Field) -> Result<(), Reason> {
        match &field.shape {
            Shape::One(kind) => self.scalar(kind).map(drop),
            Shape::List { count, item } => {
                self.at += self.length(count, item)? * size(item);
                Ok(())
            }
        }
    }

    fn error(&self, what: String) -> Reason {
        Reason::malformed(format_args!("{} {}", self.here.0, self.here.1), what)
    }
}

fn ends_early(element: &Element, index: Option<usize>) -> Reason {
    let found = index.map_or(String::new(), |i| format!(" {i} of"));
    Reason::malformed(
        format_args!("element {}", element.name),
        format_args!("the file ends after{found} fewer than the {} that the header says", element.count),
    )
}
