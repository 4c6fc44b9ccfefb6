//! The header of a PLY file: which elements follow, how many, and with which properties.

pub(super) use ply_rs_bw::ply::{Encoding, ScalarType};

use ply_rs_bw::parser::{ParseError, Parser};
use ply_rs_bw::ply::{DefaultElement, PropertyType};

use crate::geometry::num;
use crate::scene::Reason;

pub(super) struct Header {
    pub encoding: Encoding,
    pub elements: Vec<Element>,
    /// Lines of the header, so that lines of the text after it can be named.
    pub lines: usize,
}

pub(super) struct Element {
    pub name: String,
    /// As the header claims; nothing is sized by it before the payload was found to be long enough.
    pub count: usize,
    pub fields: Vec<Field>,
}

pub(super) struct Field {
    pub name: String,
    pub shape: Shape,
}

pub(super) enum Shape {
    One(ScalarType),
    List { count: ScalarType, item: ScalarType },
}

/// No sane header is longer.
const MAX_HEADER: usize = 1 << 20;
const END: &[u8] = b"end_header";

/// Parts the header from what follows it.
pub(super) fn read(bytes: &[u8]) -> Result<(Header, &[u8]), Reason> {
    if !bytes.starts_with(b"ply") {
        return Err(Reason::malformed("line 1", "a PLY file begins with 'ply'"));
    }
    let reach = &bytes[..bytes.len().min(MAX_HEADER)];
    let ends_at = |i: &usize| matches!(reach[i - 1], b'\n' | b'\r') && reach[*i..].starts_with(END);
    let end = (1..reach.len()).find(ends_at).ok_or_else(|| Reason::malformed("header", "there is no 'end_header'"))? + END.len();
    let body = after_line_end(&bytes[end..], bytes[..end].contains(&b'\n'));
    let text = String::from_utf8_lossy(&bytes[..end]).replace("\r\n", "\n").replace('\r', "\n");
    let parsed = Parser::<DefaultElement>::new().read_ply_header(&mut text.as_bytes()).map_err(|e| explain(&e))?;
    let lines = text.lines().count();
    let elements = parsed.elements.into_values().map(element).collect();
    Ok((Header { encoding: parsed.encoding, elements, lines }, body))
}

/// What follows the end of the line that `rest` begins in. A header that ends its lines with `\r`
/// may be followed by data that begins with a `\n`.
fn after_line_end(rest: &[u8], newlines: bool) -> &[u8] {
    let blanks = rest.iter().take_while(|b| matches!(b, b' ' | b'\t') || (newlines && **b == b'\r')).count();
    let rest = &rest[blanks..];
    rest.get(1..).unwrap_or_default()
}

fn element(def: ply_rs_bw::ply::ElementDef) -> Element {
    let field = |(name, def): (String, ply_rs_bw::ply::PropertyDef)| {
        let shape = match def.data_type {
            PropertyType::Scalar(kind) => Shape::One(kind),
            PropertyType::List(count, item) => Shape::List { count, item },
        };
        Field { name, shape }
    };
    Element { name: def.name, count: def.count, fields: def.properties.into_iter().map(field).collect() }
}

/// The crate's message is several lines long; the first says it.
fn explain(error: &ParseError) -> Reason {
    let text = error.to_string();
    let what = text.lines().next().unwrap_or_default();
    let what = what.split_once(": ").filter(|(line, _)| line.starts_with("Line")).map_or(what, |(_, what)| what);
    let place = error.line().map_or("header".to_owned(), |line| format!("line {line}"));
    Reason::malformed(place, what.trim_end_matches('.'))
}

impl Element {
    /// The fewest bytes that one element takes in a binary file.
    pub fn least_bytes(&self) -> usize {
        let least = |field: &Field| match &field.shape {
            Shape::One(kind) | Shape::List { count: kind, .. } => size(kind),
        };
        self.fields.iter().map(least).sum()
    }

    /// Refuses more than 32 bits can index.
    pub fn check_count(&self, what: &'static str) -> Result<(), Reason> {
        if self.count > num::MAX_INDEX { Err(Reason::TooLarge(self.count as u64, what)) } else { Ok(()) }
    }
}

/// Bytes of one scalar in a binary file.
pub(super) fn size(kind: &ScalarType) -> usize {
    match kind {
        ScalarType::Char | ScalarType::UChar => 1,
        ScalarType::Short | ScalarType::UShort => 2,
        ScalarType::Int | ScalarType::UInt | ScalarType::Float => 4,
        ScalarType::Double => 8,
    }
}
