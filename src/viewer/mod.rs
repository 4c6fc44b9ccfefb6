//! The window.

pub mod format;
pub mod theme;
