//! Timed builds.

use std::sync::Arc;
use std::time::Instant;

use crate::accel::params::ParamValues;
use crate::accel::registry::Entry;
use crate::accel::{Accel, BuildCx, BuildError};
use crate::geometry::tri::TestKind;
use crate::scene::Geometry;
use crate::task::Phase;

/// A structure and how long it took to build.
#[derive(Clone)]
pub struct BuiltRow {
    /// The structure.
    pub accel: Arc<dyn Accel>,
    /// Wall-clock seconds of the build.
    pub build_secs: f64,
    /// The same by phase, where the build has any.
    pub phases: Vec<Phase>,
}

/// Builds a structure and takes the time.
///
/// # Errors
/// Cancelled, or it would not fit.
pub fn build_timed(
    entry: &Entry,
    geometry: &Arc<Geometry>,
    test: TestKind,
    params: &ParamValues,
    cx: &BuildCx,
) -> Result<BuiltRow, BuildError> {
    // The same progress may have heard of earlier work.
    let earlier = cx.progress.finish().len();
    let start = Instant::now();
    let accel = entry.build(geometry, test, params, cx)?;
    let build_secs = start.elapsed().as_secs_f64();
    let phases = cx.progress.finish().split_off(earlier);
    Ok(BuiltRow { accel: Arc::from(accel), build_secs, phases })
}
