//! Text of a figure: in lines, since SVG breaks none, and legends of colours.

use std::fmt::Write;

use crate::viewer::legends::Heat;
use crate::viewer::theme;

/// The width of a letter, as a share of the size of text, with some room: the reader's font is not known.
const LETTER: f32 = 0.58;
/// What a legend takes, with the gap after it.
const LEGEND: [f32; 2] = [54.0 * theme::GRID, 13.0 * theme::GRID];
/// Colours of which a legend is made.
const STOPS: u32 = 16;

/// The lines of a text that are no wider than so many pixels, as far as words allow.
pub fn wrapped(text: &str, width: f32, size: f32) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    // Between the digits of a number stands another kind of space.
    for word in text.split(' ').filter(|word| !word.is_empty()) {
        match lines.last_mut() {
            Some(line) if about(line.chars().count() + 1 + word.chars().count(), size) <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

/// About how wide so many letters are.
pub fn about(letters: usize, size: f32) -> f32 {
    letters as f32 * size * LETTER
}

/// Writes a line, by the left end of its base line.
pub fn line(out: &mut String, [x, y]: [f32; 2], size: f32, text: &str) {
    anchored(out, ([x, y], "start"), size, text);
}

fn anchored(out: &mut String, ([x, y], anchor): ([f32; 2], &str), size: f32, text: &str) {
    let text = escaped(text);
    let _ = writeln!(
        out,
        "<text x=\"{x}\" y=\"{y}\" font-family=\"sans-serif\" font-size=\"{size}\" text-anchor=\"{anchor}\">{text}</text>"
    );
}

/// The height of legends in a page of that width.
pub fn legends_height(n: usize, width: f32) -> f32 {
    n.div_ceil(in_a_row(width)) as f32 * LEGEND[1]
}

/// Legends that stand beside each other, at least one.
fn in_a_row(width: f32) -> usize {
    crate::geometry::num::floor_index(f64::from((width - theme::GUTTER) / LEGEND[0]), usize::MAX).max(1)
}

/// Writes legends in rows, from `top` on.
pub fn legends(out: &mut String, legends: &[Heat], width: f32, top: f32) {
    let columns = in_a_row(width);
    for (i, heat) in legends.iter().enumerate() {
        let at = [theme::GUTTER + (i % columns) as f32 * LEGEND[0], top + (i / columns) as f32 * LEGEND[1]];
        legend(out, i, heat, at);
    }
}

fn legend(out: &mut String, number: usize, heat: &Heat, [x, y]: [f32; 2]) {
    let width = LEGEND[0] - theme::GUTTER;
    let _ = writeln!(out, "<linearGradient id=\"colours{number}\">");
    for stop in 0..=STOPS {
        let t = stop as f32 / STOPS as f32;
        let [r, g, b] = (heat.colors)(t).map(|c| (c * 255.0 + 0.5) as u8);
        let _ = writeln!(out, "<stop offset=\"{t}\" stop-color=\"#{r:02x}{g:02x}{b:02x}\"/>");
    }
    let (bar, high) = (y + 5.0 * theme::GRID, 2.0 * theme::GRID);
    let _ = writeln!(
        out,
        "</linearGradient>\n<rect x=\"{x}\" y=\"{bar}\" width=\"{width}\" height=\"{high}\" fill=\"url(#colours{number})\"/>"
    );
    line(out, [x, bar - theme::GRID], theme::CAPTION, &heat.name);
    let below = bar + high + 3.0 * theme::GRID;
    let [least, most] = &heat.ends;
    line(out, [x, below], theme::CAPTION, least);
    anchored(out, ([x + width, below], "end"), theme::CAPTION, most);
}

/// Text between tags.
pub fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_broken_between_words_and_not_within_numbers() {
        let text = "k-d tree: 1\u{2009}000 nodes, 3 tests a ray";
        assert_eq!(wrapped(text, 1e4, 11.0), [text]);
        let lines = wrapped(text, 100.0, 11.0);
        assert!(lines.len() > 1 && lines.join(" ") == text, "{lines:?}");
        assert!(lines.iter().all(|line| about(line.chars().count(), 11.0) <= 100.0), "{lines:?}");
        assert_eq!(wrapped("two words", 1.0, 11.0), ["two", "words"], "a word is not broken");
        assert!(wrapped("", 100.0, 11.0).is_empty());
    }
}
