//! How lines over the picture are drawn. All widths are in points.

/// One way to draw the edges of boxes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LineStyle {
    /// The colour of the halo.
    pub halo: [u8; 3],
    /// The width where nothing is in front.
    pub width: f32,
    /// The width of the halo under it, from side to side.
    pub halo_width: f32,
    /// Opacity of the halo.
    pub halo_alpha: f32,
    /// The width where the picture's surface is in front, and the line is dashed.
    pub hidden_width: f32,
    /// Opacity there.
    pub hidden_alpha: f32,
    /// Opacity of the halo there.
    pub hidden_halo_alpha: f32,
    /// Whether it is drawn over all others, and its hidden part even if hidden lines are not wanted.
    pub on_top: bool,
}

impl LineStyle {
    /// The edges of boxes, with a dark halo so that they stand out on any surface.
    pub const BOX: Self = Self {
        halo: [0x10, 0x12, 0x15],
        width: 1.5,
        halo_width: 3.0,
        halo_alpha: 0.8,
        hidden_width: 1.0,
        hidden_alpha: 0.3,
        hidden_halo_alpha: 0.0,
        on_top: false,
    };
    /// The edges of the selected box and of what else stands out.
    pub const SELECTED: Self = Self {
        halo: [0; 3],
        width: 2.5,
        halo_width: 5.0,
        halo_alpha: 0.9,
        hidden_width: 1.5,
        hidden_alpha: 0.7,
        hidden_halo_alpha: 0.4,
        on_top: true,
    };
}

/// The lengths of a dash and of the gap after it.
pub const DASH_PT: [f32; 2] = [4.0, 3.0];

/// Opacity of a plane's fill.
pub const PLANE_FILL: f32 = 0.12;

/// The same where the surface is in front of it.
pub const PLANE_FILL_HIDDEN: f32 = 0.04;
