//! The colours of the dark and of the light look.

use eframe::egui::{Color32, Theme, Ui};

use super::Marker;

/// How a family of structures is marked: a colour and a shape, since a colour alone does not reach
/// everyone. For marks, never for text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Mark {
    /// Its colour.
    pub color: Color32,
    /// Its shape.
    pub marker: Marker,
}

/// The colours of one look.
///
/// Text has a contrast of at least 4.5:1, marks of 3:1 on the panels and 3.2:1 on the background; the
/// marks' colours stay apart under three simulated dichromacies.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// Bounding volume hierarchies.
    pub bvh: Mark,
    /// k-d trees.
    pub kd: Mark,
    /// Grids.
    pub grid: Mark,
    /// Octrees.
    pub octree: Mark,
    /// BSP trees.
    pub bsp: Mark,
    /// Brute force and the rasteriser.
    pub brute: Mark,
    /// Text.
    pub text: Color32,
    /// Text of less weight.
    pub dim: Color32,
    /// Links, and other text that can be clicked.
    pub accent_text: Color32,
    /// Verdicts that warn.
    pub warn: Color32,
    /// Verdicts that fail.
    pub fail: Color32,
    /// Behind pictures and plots.
    pub background: Color32,
    /// Behind text and controls.
    pub panel: Color32,
    /// Every other row of a table.
    pub stripe: Color32,
    /// Separators and outlines.
    pub line: Color32,
    /// Buttons and fields.
    pub control: Color32,
    /// The same under the pointer.
    pub control_hovered: Color32,
    /// Behind what is selected or pressed.
    pub selection: Color32,
    /// Triangles in the raster preview, before shading.
    pub preview: Color32,
}

impl Palette {
    /// The colours of a theme.
    pub const fn of(theme: Theme) -> &'static Self {
        match theme {
            Theme::Dark => &DARK,
            Theme::Light => &LIGHT,
        }
    }

    /// The colours of the look that `ui` has now.
    pub fn in_ui(ui: &Ui) -> &'static Self {
        Self::of(if ui.visuals().dark_mode { Theme::Dark } else { Theme::Light })
    }

    /// The families' marks, in the order in which they are listed.
    pub const fn marks(&self) -> [Mark; 6] {
        [self.bvh, self.kd, self.grid, self.octree, self.bsp, self.brute]
    }
}

const fn mark(rgb: u32, marker: Marker) -> Mark {
    Mark { color: hex(rgb), marker }
}

const fn hex(rgb: u32) -> Color32 {
    let [_, r, g, b] = rgb.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

const DARK: Palette = Palette {
    bvh: mark(0x2F_78_B7, Marker::Circle),
    kd: mark(0xB0_65_2F, Marker::Diamond),
    grid: mark(0x6E_CF_88, Marker::Square),
    octree: mark(0xF5_A3_F5, Marker::Triangle),
    bsp: mark(0xF8_F1_69, Marker::Cross),
    brute: mark(0x8B_92_9B, Marker::Ring),
    text: hex(0xE6_E8_EB),
    dim: hex(0x9A_A1_AA),
    accent_text: hex(0x7F_B8_EA),
    warn: hex(0xF2_B1_34),
    fail: hex(0xFF_6B_4A),
    background: hex(0x1B_1E_23),
    panel: hex(0x20_24_2A),
    stripe: hex(0x25_29_30),
    line: hex(0x36_3B_44),
    control: hex(0x2D_32_3A),
    control_hovered: hex(0x38_3E_48),
    selection: hex(0x2B_4C_6B),
    preview: hex(0xB8_BC_C2),
};

const LIGHT: Palette = Palette {
    bvh: mark(0x22_85_C4, Marker::Circle),
    kd: mark(0x97_58_0E, Marker::Diamond),
    grid: mark(0x0B_4A_29, Marker::Square),
    octree: mark(0x7A_16_79, Marker::Triangle),
    bsp: mark(0x9E_8A_1D, Marker::Cross),
    brute: mark(0x6B_72_80, Marker::Ring),
    text: hex(0x1B_1E_23),
    dim: hex(0x5E_64_6C),
    accent_text: hex(0x0A_5A_94),
    warn: hex(0x8A_5A_00),
    fail: hex(0xC1_30_1C),
    background: hex(0xF7_F8_FA),
    panel: hex(0xF0_F2_F5),
    stripe: hex(0xE8_EA_EE),
    line: hex(0xCD_D2_D9),
    control: hex(0xE0_E4_E9),
    control_hovered: hex(0xD3_D8_DF),
    selection: hex(0xBC_DA_F2),
    preview: hex(0xA6_AB_B3),
};

#[cfg(test)]
mod tests {
    use super::*;

    /// WCAG 2.2, relative luminance.
    fn luminance(c: Color32) -> f32 {
        let linear = |v: u8| {
            let v = f32::from(v) / 255.0;
            if v <= 0.04045 { v / 12.92 } else { ((v + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(c.r()) + 0.7152 * linear(c.g()) + 0.0722 * linear(c.b())
    }

    fn contrast(a: Color32, b: Color32) -> f32 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    #[test]
    fn text_can_be_read_on_everything_it_stands_on() {
        for theme in [Theme::Dark, Theme::Light] {
            let p = Palette::of(theme);
            for (name, text) in [("text", p.text), ("dim", p.dim), ("link", p.accent_text), ("warn", p.warn), ("fail", p.fail)] {
                for under in [p.background, p.panel, p.stripe] {
                    assert!(contrast(text, under) >= 4.5, "{theme:?} {name}: {}", contrast(text, under));
                }
            }
            for under in [p.control, p.control_hovered, p.selection] {
                assert!(contrast(p.text, under) >= 4.5, "{theme:?}: {}", contrast(p.text, under));
            }
        }
    }

    #[test]
    fn marks_stand_out_and_no_two_are_alike() {
        for theme in [Theme::Dark, Theme::Light] {
            let p = Palette::of(theme);
            for (i, mark) in p.marks().iter().enumerate() {
                let (on_background, on_panel) = (contrast(mark.color, p.background), contrast(mark.color, p.panel));
                assert!(on_background >= 3.2 && on_panel >= 3.0, "{theme:?} {mark:?}: {on_background} {on_panel}");
                assert!(p.marks()[..i].iter().all(|m| m.color != mark.color && m.marker != mark.marker));
            }
        }
    }
}
