//! Everything that measures: which rays are traced, how they are timed so that the comparison is
//! fair, what is counted, and the rows that tables, JSON and reports are made of.

mod building;
mod counting;
mod estimate;
mod facts;
pub mod format;
mod measure;
mod rays;
mod report;
mod sample;
pub mod statistics;
mod timing;
mod volumes;

pub use building::{BuiltRow, build_timed};
pub use facts::{MachineFacts, SceneFacts};
pub use measure::{Contestant, Fairness, MeasureOptions, measure};
pub use rays::{RayKind, RaySet};
pub use report::{BuiltFacts, Report, StructureRow};
pub use timing::{Timing, is_tie};
pub use volumes::{VolumeRow, VolumeTree, measure_volumes};
