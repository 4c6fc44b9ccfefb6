//! What can go wrong, as the shell sees it: one line on standard error and an exit code.

use std::io;
use std::process::ExitCode;

use crate::accel::BuildError;
use crate::scene::LoadError;
use crate::task::{Cancelled, OverBudget};

/// Why a command did not do what it should.
#[derive(Debug)]
pub enum Failure {
    /// The model, a ray file or an argument is wrong: exit code 2.
    Input(String),
    /// Anything else: exit code 1.
    Other(anyhow::Error),
    /// Ctrl-C: exit code 130.
    Cancelled,
    /// Whoever read standard output has gone, as `head` does: no error at all.
    Closed,
}

impl Failure {
    /// What clap has to say, in one line.
    pub fn of_arguments(error: &clap::Error) -> Self {
        let text = error.render().to_string();
        let what = text.lines().map(str::trim).take_while(|line| !line.starts_with("Usage:") && !line.starts_with("For more"));
        let what = what.filter(|line| !line.is_empty()).collect::<Vec<_>>().join(" ");
        Self::Input(format!("{}. See 'boxwood --help'", what.trim_start_matches("error: ")))
    }

    /// An input file that could not be used, and why.
    pub fn of_input(path: &std::path::Path, why: impl std::fmt::Display) -> Self {
        Self::Input(format!("Can't read {}: {why}", path.display()))
    }

    /// A file that could not be written.
    pub fn of_output(path: &std::path::Path, error: &io::Error) -> Self {
        match error.kind() {
            io::ErrorKind::BrokenPipe => Self::Closed,
            _ => Self::Other(anyhow::anyhow!("Can't write {}: {error}", path.display())),
        }
    }

    /// Says it, and gives the exit code.
    pub fn report(self) -> ExitCode {
        let (text, code) = match self {
            Self::Input(text) => (text, 2),
            Self::Other(error) => (format!("{error:#}"), 1),
            Self::Cancelled => ("stopped".to_owned(), 130),
            Self::Closed => return ExitCode::SUCCESS,
        };
        super::output::warn(&text);
        ExitCode::from(code)
    }
}

impl From<LoadError> for Failure {
    fn from(error: LoadError) -> Self {
        if error.is_cancelled() { Self::Cancelled } else { Self::Input(error.to_string()) }
    }
}

impl From<BuildError> for Failure {
    fn from(error: BuildError) -> Self {
        match error {
            BuildError::Cancelled(_) => Self::Cancelled,
            error => Self::Other(error.into()),
        }
    }
}

impl From<Cancelled> for Failure {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

impl From<OverBudget> for Failure {
    fn from(error: OverBudget) -> Self {
        Self::Other(anyhow::Error::from(error).context("Out of memory"))
    }
}
