//! The real program, driven as a shell would: what it prints, what it leaves, how it ends.

mod failures;
mod files;
mod light;
mod quality;
mod reports;
mod support;
