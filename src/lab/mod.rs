//! Everything that measures: which rays are traced, how they are timed so that the comparison is
//! fair, what is counted, and the rows that tables, JSON and reports are made of.

mod boxed;
mod brute_check;
mod building;
pub mod converge;
mod costs;
mod counting;
mod differing;
mod division;
mod estimate;
#[cfg(feature = "plots")]
pub mod everything;
mod facts;
pub mod film;
pub mod findings;
mod fitting;
pub mod follow;
pub mod format;
mod image_error;
pub mod least_squares;
mod lines;
mod measure;
mod mesh_check;
mod model_check;
pub mod needs;
#[cfg(feature = "peers")]
pub mod peers;
#[cfg(feature = "plots")]
pub mod plot;
pub mod prediction;
mod quality;
mod raster;
pub mod ray_file;
mod rays;
mod report;
mod sah_curve;
mod sample;
pub mod scaling;
mod sheet;
pub mod stability;
pub mod statistics;
mod tally;
mod ties;
pub mod tile_times;
mod timing;
pub mod tradeoffs;
mod turns;
mod uncut;
mod visits;
mod volumes;

pub use brute_check::{BruteCheck, PixelRect, UnlikePixel, check_by_brute_force};
pub use building::{BuiltRow, build_timed};
pub use costs::{Costs, FitOptions, fit_costs};
pub use differing::{Differing, differing};
pub use division::{Alternative, Division, Side};
pub use facts::{MachineFacts, SceneFacts};
pub use fitting::{FitError, FitRow, Fitting, can_fit, fit_volumes, fitted_kinds};
pub use image_error::{ImageErrors, Metric, rms_difference};
pub use lines::line;
pub use measure::{Contestant, Fairness, MeasureOptions, measure};
pub use mesh_check::{Finding, MeshCheck, SLIVER, Sliver, check as check_mesh};
pub use model_check::{CheckError, Checked, ModelCheck, check_model};
pub use quality::{Quality, QualityOptions};
pub use raster::{RasterRow, measure_with_raster};
pub use rays::{PixelOrder, RayKind, RaySet, leaving};
pub use report::{BuiltFacts, CostRow, Report, StructureRow, built};
pub use sah_curve::{Chosen, SahCurves, of_node as sah_curves};
pub use sheet::{Field, Sheet};
pub use ties::rounding_explains;
pub use timing::{Timing, is_tie};
pub use uncut::{Enough, UncutLines};
pub use visits::Visits;
pub use volumes::{VolumeRow, VolumeTree, measure_volumes};
