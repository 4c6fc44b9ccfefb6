//! The colours of structures in plots: those of the light window.

use plotters::style::RGBColor;

use crate::accel::registry::{self, Family};

/// The family of a structure, if there is one of that id.
pub(super) fn family_of(id: &str) -> Option<Family> {
    registry::find(id).map(|entry| entry.family)
}

/// The colour of each of several structures, by their ids in the order in which they are drawn: members of a family have one
/// colour, the second darker and the third lighter.
pub(super) fn colors_of(ids: &[&str]) -> Vec<RGBColor> {
    let color = |(i, id): (usize, &&str)| {
        let mut family: Vec<&str> = Vec::new();
        for other in ids[..=i].iter().filter(|other| family_of(other) == family_of(id)) {
            if !family.contains(other) {
                family.push(other);
            }
        }
        shaded(color_of(id), family.iter().position(|other| other == id).unwrap_or(0))
    };
    ids.iter().enumerate().map(color).collect()
}

/// Members of a family have one colour, the second darker and the third lighter.
fn shaded(color: RGBColor, which: usize) -> RGBColor {
    let toward = |end: u16, share: u16| move |c: u8| ((u16::from(c) * (4 - share) + end * share) / 4) as u8;
    let mix = |end, share| RGBColor(toward(end, share)(color.0), toward(end, share)(color.1), toward(end, share)(color.2));
    match which {
        0 => color,
        1 => mix(0, 2),
        2 => mix(255, 2),
        n => mix(if n.is_multiple_of(2) { 255 } else { 0 }, 1),
    }
}

/// The colours of the light window.
fn color_of(id: &str) -> RGBColor {
    match family_of(id) {
        Some(Family::Bvh) => RGBColor(0x22, 0x85, 0xC4),
        Some(Family::KdTree) => RGBColor(0x97, 0x58, 0x0E),
        Some(Family::Grid) => RGBColor(0x0B, 0x4A, 0x29),
        Some(Family::Octree) => RGBColor(0x7A, 0x16, 0x79),
        Some(Family::Bsp) => RGBColor(0xA0, 0x8C, 0x1E),
        Some(Family::Brute) | None => RGBColor(0x6B, 0x72, 0x80),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_structure_has_one_colour_and_its_family_others_near_it() {
        let colors = colors_of(&["bvh", "wide", "bvh", "kdtree", "nobody", "nobody"]);
        assert!(colors[0] == colors[2] && colors[0] != colors[1] && colors[0] != colors[3]);
        assert!(colors[4] == colors[5] && colors[1] == shaded(colors[0], 1));
    }
}
