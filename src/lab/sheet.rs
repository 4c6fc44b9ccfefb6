//! Tables as files: columns with their units, and rows, as CSV.

use std::fmt::Write;

/// A table that can be taken away.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Sheet {
    /// The names of the columns, with units.
    pub columns: Vec<&'static str>,
    /// A field for each column in each.
    pub rows: Vec<Vec<Field>>,
}

/// What stands in a row under a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Field {
    /// Words.
    Text(String),
    /// A figure, as exactly as it is known.
    Number(f64),
    /// A count.
    Count(u64),
    /// It is not known.
    Missing,
}

impl From<&str> for Field {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<String> for Field {
    fn from(text: String) -> Self {
        Self::Text(text)
    }
}

impl From<f64> for Field {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Field {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl<T: Into<Self>> From<Option<T>> for Field {
    fn from(value: Option<T>) -> Self {
        value.map_or(Self::Missing, Into::into)
    }
}

impl Sheet {
    /// A table without rows.
    pub fn new(columns: &[&'static str]) -> Self {
        Self { columns: columns.to_vec(), rows: Vec::new() }
    }

    /// Adds a row.
    pub fn row<const N: usize>(&mut self, fields: [Field; N]) {
        self.rows.push(fields.into());
    }

    /// As comma-separated values (RFC 4180), the names of the columns first. What is missing or not finite is empty.
    pub fn csv(&self) -> String {
        let mut out = self.csv_head();
        self.csv_rows(&mut out);
        out
    }

    /// The first line of that: the names of the columns.
    pub fn csv_head(&self) -> String {
        self.columns.iter().map(|name| quoted(name)).collect::<Vec<_>>().join(",") + "\r\n"
    }

    /// The lines after it, added to those that are there: of a table that is written in parts.
    pub fn csv_rows(&self, out: &mut String) {
        for row in &self.rows {
            for (k, field) in row.iter().enumerate() {
                if k > 0 {
                    out.push(',');
                }
                match field {
                    Field::Text(text) => out.push_str(&quoted(text)),
                    // Writing to a string does not fail.
                    Field::Number(number) if number.is_finite() => drop(write!(out, "{number}")),
                    Field::Count(count) => drop(write!(out, "{count}")),
                    Field::Number(_) | Field::Missing => {}
                }
            }
            out.push_str("\r\n");
        }
    }
}

/// A field in quotes where something in it would be taken for the end of it.
fn quoted(text: &str) -> String {
    if text.contains(['"', ',', '\n', '\r']) { format!("\"{}\"", text.replace('"', "\"\"")) } else { text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn fields_that_hold_commas_quotes_or_lines_are_quoted() {
        let mut sheet = Sheet::new(&["structure", "build (s)", "why, if not"]);
        sheet.row(["bvh".into(), 0.25.into(), Field::Missing]);
        sheet.row(["a \"b\"".into(), f64::NAN.into(), "too large,\nsays it".into()]);
        sheet.row(["".into(), 3u64.into(), None::<f64>.into()]);
        let csv = "structure,build (s),\"why, if not\"\r\nbvh,0.25,\r\n\"a \"\"b\"\"\",,\"too large,\nsays it\"\r\n,3,\r\n";
        assert_eq!(sheet.csv(), csv);
    }

    #[test]
    fn figures_are_written_as_exactly_as_they_are_known() {
        let mut sheet = Sheet::new(&["x"]);
        let figures = [1.0 / 3.0, 1e-9, 123_456_789.0, -0.5];
        figures.iter().for_each(|x| sheet.row([Field::Number(*x)]));
        let read: Vec<f64> = sheet.csv().lines().skip(1).map(|line| line.parse().expect("a number")).collect();
        assert_eq!(read, figures);
    }
}
