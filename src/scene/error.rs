//! Why a model could not be opened, in words a user can act on.

use std::fmt;
use std::path::PathBuf;

use crate::task::{Cancelled, OverBudget};

/// A model that could not be opened.
#[derive(Debug, thiserror::Error)]
#[error("Can't open {model}: {}", told(model, reason))]
pub struct LoadError {
    /// The model as the user named it.
    pub model: String,
    /// What, where and why.
    #[source]
    pub reason: Reason,
}

/// The reason; a file that is the model itself is not named twice.
fn told(model: &str, reason: &Reason) -> String {
    match reason {
        Reason::Io { path, error } if path.as_os_str() == model => error.to_string(),
        _ => reason.to_string(),
    }
}

/// What is wrong with the model, and where.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum Reason {
    /// The file, or one it cannot do without, could not be read.
    #[error("{}: {error}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system says.
        error: std::io::Error,
    },
    /// No loader knows the format.
    #[error("the format '{0}' is not known. Use .gltf, .glb, .obj, .ply or .stl")]
    UnknownFormat(String),
    /// There is no such generator, or its options are wrong.
    #[error("{0}")]
    Builtin(String),
    /// The content breaks the rules of its format.
    #[error("{place}: {what}")]
    Malformed {
        /// Where: a line, a byte offset, an element of the file.
        place: String,
        /// What is wrong there.
        what: String,
    },
    /// The content needs an extension that Boxwood cannot read.
    #[error("{place} needs {extension}, which Boxwood can't read. {remedy}")]
    Unsupported {
        /// What of the model: `mesh 3`, or `it`.
        place: String,
        /// The extension's registered name.
        extension: String,
        /// What the user can do.
        remedy: &'static str,
    },
    /// There is nothing to trace.
    #[error("it holds no triangles{}", .0.as_deref().map(|why| format!(" ({why})")).unwrap_or_default())]
    NoTriangles(Option<String>),
    /// It has more triangles or vertices than 32 bits can count.
    #[error("it has {0} {1}, more than the {max} that Boxwood can index", max = crate::geometry::num::MAX_INDEX)]
    TooLarge(u64, &'static str),
    /// It does not fit the memory budget.
    #[error(transparent)]
    Memory(#[from] OverBudget),
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl Reason {
    /// A [`Reason::Malformed`] from anything that can be shown.
    pub fn malformed(place: impl fmt::Display, what: impl fmt::Display) -> Self {
        Self::Malformed { place: place.to_string(), what: what.to_string() }
    }

    /// This reason for the model that the user named.
    pub fn of(self, model: impl Into<String>) -> LoadError {
        LoadError { model: model.into(), reason: self }
    }
}

impl LoadError {
    /// Whether the user stopped it, which is no failure.
    pub fn is_cancelled(&self) -> bool {
        matches!(self.reason, Reason::Cancelled(_))
    }
}
