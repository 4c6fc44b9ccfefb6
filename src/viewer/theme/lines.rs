//! How lines over the picture are drawn. All widths are in points.

/// One way to draw the edges of boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// The width where nothing is in front.
    pub width: f32,
    /// The width where the picture's surface is in front; 0 for not at all.
    pub hidden_width: f32,
    /// Opacity where nothing is in front.
    pub alpha: f32,
    /// Opacity behind the surface, where the line is dashed.
    pub hidden_alpha: f32,
    /// A colour of its own, gamma-encoded; otherwise each box has one.
    pub color: Option<[u8; 3]>,
}

impl LineStyle {
    /// The dark halo under boxes, so that their lines stand out on any surface.
    pub const HALO: Self = Self { width: 3.0, hidden_width: 0.0, alpha: 0.6, hidden_alpha: 0.0, color: Some([0x10, 0x12, 0x15]) };
    /// The edges of boxes.
    pub const BOX: Self = Self { width: 1.5, hidden_width: 1.0, alpha: 1.0, hidden_alpha: 0.3, color: None };
    /// The halo under the selected box.
    pub const SELECTED_HALO: Self = Self { width: 5.0, hidden_width: 3.0, alpha: 0.9, hidden_alpha: 0.4, color: Some([0; 3]) };
    /// The edges of the selected box.
    pub const SELECTED: Self = Self { width: 2.5, hidden_width: 1.5, alpha: 1.0, hidden_alpha: 0.7, color: Some([255; 3]) };
}

/// The lengths of a dash and of the gap after it.
pub const DASH_PT: [f32; 2] = [4.0, 3.0];

/// Above this many boxes the halo is left out: where lines lie that dense it would only darken the
/// picture, and it costs as much as the lines.
pub const HALO_MOST_BOXES: usize = 4000;

/// Opacity of a plane's fill.
pub const PLANE_FILL: f32 = 0.12;

/// The same where the surface is in front of it.
pub const PLANE_FILL_HIDDEN: f32 = 0.04;
