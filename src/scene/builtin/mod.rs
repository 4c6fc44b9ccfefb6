//! Scenes made in code.

use super::{LoadCx, Reason, Scene};

/// What the name of a built-in scene begins with.
pub const SCHEME: &str = "builtin:";

/// Makes the scene that `spec` names: `NAME` or `NAME?triangles=N`.
pub fn generate(spec: &str, cx: &LoadCx) -> Result<Scene, Reason> {
    let _ = cx;
    Err(Reason::Builtin(format!("there is no built-in scene '{spec}'")))
}
