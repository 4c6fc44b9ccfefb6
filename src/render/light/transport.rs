//! How far light is followed.

/// What ends a path, and what is done about dots that are far too bright.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Transport {
    /// Surfaces that a path meets at most. Light that comes over more is missing.
    pub surfaces: u32,
    /// Surfaces before a path may end by chance (Russian roulette: Arvo and Kirk 1990), which adds noise and takes none of
    /// the light away.
    pub certain: u32,
    /// The most of any colour that light over two and more surfaces adds to a sample. It takes dots away, and light with
    /// them: the picture then converges to a darker one.
    pub clamp: Option<f32>,
}

impl Default for Transport {
    fn default() -> Self {
        Self { surfaces: 12, certain: 3, clamp: None }
    }
}
