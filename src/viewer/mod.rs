//! The window.

pub mod format;
pub mod gpu;
pub mod theme;
