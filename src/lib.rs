//! Boxwood: see, race and measure the structures that make ray tracing fast.
//!
//! The layers, each using only those before it (`tests/layering.rs` holds them to it):
//!
//! ```text
//! task, sys → simd → geometry → scene → accel → render → lab → job → {cli, viewer} → main
//! ```

pub mod accel;
#[cfg(feature = "cli")]
pub mod cli;
pub mod geometry;
pub mod job;
pub mod lab;
pub mod render;
pub mod scene;
pub mod simd;
pub mod sys;
pub mod task;
#[cfg(feature = "viewer")]
pub mod viewer;

#[cfg(doctest)]
#[doc = include_str!("../README.md")]
struct Readme;
