//! What is taken away from the window: the report, tables, plots, the figure and the picture, each on its way to a file.

use std::path::PathBuf;
use std::sync::mpsc::Receiver;

use super::sheets::What;
use crate::job::Job;

/// One thing to take away.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Export {
    /// Everything that can be measured on the open model, as a page with its data: quick, or with more of everything.
    Report {
        /// Fewer rays, samples and structures.
        quick: bool,
    },
    /// A table as CSV.
    Table(What),
    /// A plot.
    Plot(What, Form),
    /// The view with its boxes as lines, or all compared ones as they stand, as SVG.
    Figure,
    /// The traced picture alone, or all compared ones as they stand, as PNG.
    Picture,
}

/// How a plot is written.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Form {
    /// Lines and text.
    Svg,
    /// Pixels.
    Png,
}

impl Form {
    /// The ending of its files.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Svg => "svg",
            Self::Png => "png",
        }
    }
}

impl Export {
    /// The ending of its file.
    pub const fn ending(self) -> &'static str {
        match self {
            Self::Report { .. } => "html",
            Self::Table(_) => "csv",
            Self::Plot(_, form) => form.ending(),
            Self::Figure => "svg",
            Self::Picture => "png",
        }
    }

    /// What it is called in messages and names of files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Report { .. } => "report",
            Self::Table(what) | Self::Plot(what, _) => what.name(),
            Self::Figure => "figure",
            Self::Picture => "picture",
        }
    }
}

/// A file on its way: where it is in the end; nothing if that was stopped, or why it isn't there, in words for the user.
pub type Writing = Job<Result<Option<PathBuf>, String>>;

/// Everything of it.
#[derive(Default)]
pub struct Exports {
    /// What was asked for, and what the dialog answers.
    pub(super) asked: Option<(Export, Receiver<Option<PathBuf>>)>,
    /// The file on its way.
    pub(super) writing: Option<(Export, Writing)>,
    /// The report on its way.
    pub report: Option<Writing>,
    /// What was written last, in words.
    pub said: Option<String>,
}

impl Exports {
    /// Whether a file is on its way.
    pub const fn is_writing(&self) -> bool {
        self.writing.is_some()
    }

    /// Another model is open: a report of the one before is not wanted any more.
    pub(super) fn opened(&mut self) {
        (self.report, self.said) = (None, None);
    }
}
