//! What a surface looks like.

/// A material, as far as the shaded mode needs it.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// What the file calls it; may be empty.
    pub name: String,
    /// Linear colour and opacity.
    pub base_color: [f32; 4],
    /// Whether the back is shaded like the front. Rays hit both sides in any case.
    pub double_sided: bool,
}

impl Default for Material {
    /// A light grey.
    fn default() -> Self {
        Self { name: String::new(), base_color: [0.7, 0.7, 0.7, 1.0], double_sided: true }
    }
}
