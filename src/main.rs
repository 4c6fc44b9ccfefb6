//! Boxwood.
fn main() {}
