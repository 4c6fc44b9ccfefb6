//! Text of a figure: in lines, since SVG breaks none, and legends of colours.

use std::fmt::Write;

use crate::viewer::legends::Heat;
use crate::viewer::theme;

/// The width of a letter, as a share of the size of text, with some room: the reader's font is not known.
const LETTER: f32 = 0.58;
/// The least width of a legend.
const NARROWEST: f32 = 52.0 * theme::GRID;
/// The height that a row of legends takes.
const LEGEND: f32 = 13.0 * theme::GRID;
/// The least gap between two texts of legends that stand beside each other.
const APART: f32 = 4.0 * theme::GRID;
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

/// The least width of a page with those legends.
pub fn page_of(legends: &[Heat]) -> f32 {
    if legends.is_empty() { 0.0 } else { widest(legends) + 2.0 * theme::GUTTER }
}

/// The height of legends in a page of that width.
pub fn legends_height(legends: &[Heat], width: f32) -> f32 {
    legends.len().div_ceil(in_a_row(legends, width)) as f32 * LEGEND
}

/// How wide legends are: no name is longer, and the ends below the bar do not meet.
fn widest(legends: &[Heat]) -> f32 {
    let long = |text: &str| about(text.chars().count(), theme::CAPTION);
    let needed = legends.iter().map(|Heat { name, ends: [least, most], .. }| long(name).max(long(least) + APART + long(most)));
    needed.fold(NARROWEST, f32::max)
}

/// Legends that stand beside each other, at least one.
fn in_a_row(legends: &[Heat], width: f32) -> usize {
    // Behind the last there is no gap.
    let room = width - 2.0 * theme::GUTTER + APART;
    crate::geometry::num::floor_index(f64::from(room / (widest(legends) + APART)), usize::MAX).max(1)
}

/// Writes legends in rows, from `top` on.
pub fn legends(out: &mut String, legends: &[Heat], width: f32, top: f32) {
    let (columns, wide) = (in_a_row(legends, width), widest(legends));
    for (i, heat) in legends.iter().enumerate() {
        let at = [theme::GUTTER + (i % columns) as f32 * (wide + APART), top + (i / columns) as f32 * LEGEND];
        legend(out, i, heat, (at, wide));
    }
}

fn legend(out: &mut String, number: usize, heat: &Heat, ([x, y], width): ([f32; 2], f32)) {
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
    use crate::render::Range;
    use crate::render::colormap::viridis;

    /// The texts of legends in a page of that width: where each begins and ends, and its base line.
    fn texts(all: &[Heat], width: f32) -> Vec<([f32; 2], f32)> {
        let mut out = String::new();
        legends(&mut out, all, width, 0.0);
        let text = |line: &str| {
            let of = |name: &str| line.split(&format!(" {name}=\"")).nth(1).and_then(|rest| rest.split('"').next());
            let [x, y] = ["x", "y"].map(|name| of(name).and_then(|number| number.parse::<f32>().ok()).expect("a number"));
            let words = line.split('>').nth(1).and_then(|rest| rest.split('<').next()).expect("words");
            let long = about(words.chars().count(), theme::CAPTION);
            (if of("text-anchor") == Some("end") { [x - long, x] } else { [x, x + long] }, y)
        };
        out.lines().filter(|line| line.starts_with("<text ")).map(text).collect()
    }

    #[test]
    fn legends_keep_clear_of_each_other_and_of_the_sides() {
        let heat = |name: &str, ends: [&str; 2]| Heat {
            ends: ends.map(str::to_owned),
            ..Heat::new(name.to_owned(), Range { min: 0.0, max: 1.0 }, viridis)
        };
        let short = heat("Stack depth", ["0.00", "12.0"]);
        let long_name = heat("Nodes visited a bounce ray, by tile, A less D", ["0.00", "12.0"]);
        let long_ends = heat("Nodes", ["12.0 more in k-d tree, SAH", "12.0 more in BVH, 8 wide"]);
        for all in [vec![long_name, short], vec![heat("Nodes", ["0.00", "1.00"]), long_ends], Vec::new()] {
            let mut rows = Vec::new();
            for width in [0.0_f32, 400.0, 760.0, 1500.0].map(|width| width.max(page_of(&all))) {
                let texts = texts(&all, width);
                assert_eq!(texts.len(), 3 * all.len());
                for (i, ([from, to], base)) in texts.iter().enumerate() {
                    assert!(*from >= theme::GUTTER && *to <= width - theme::GUTTER + 0.01, "{from} to {to} of {width}");
                    assert!(*base < legends_height(&all, width));
                    for ([start, end], _) in texts[i + 1..].iter().filter(|(_, other)| other == base) {
                        assert!(end + theme::GUTTER <= *from || to + theme::GUTTER <= *start, "{texts:?} of {width}");
                    }
                }
                rows.push(legends_height(&all, width) / LEGEND);
            }
            let expected: [f32; 4] = if all.is_empty() { [0.0; 4] } else { [2.0, 2.0, 1.0, 1.0] };
            assert_eq!(rows, expected);
        }
    }

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
