//! The command line: one file for each command, and beside them what several share.
//!
//! Standard output carries results only: a table, or with `--json` one object. Progress, warnings
//! and errors go to standard error. The exit code is 0, or as [`Failure`] says.

mod args;
mod bar;
mod check;
mod compare;
mod context;
mod converge;
mod failure;
mod hits;
mod needs;
mod npy;
mod outcome;
mod output;
#[cfg(feature = "peers")]
mod peers;
#[cfg(not(feature = "peers"))]
#[path = "no_peers.rs"]
mod peers;
mod quality;
mod rays;
mod render;
mod report;
mod scaling;
mod scenes;
mod stability;
mod stats;
mod structures;
mod table;
mod trace;
mod view;
mod volumes;

pub use failure::Failure;

use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::task::Cancel;

/// See, race and measure the structures that make ray tracing fast.
///
/// Without a command, opens MODEL in a window.
#[derive(Debug, Parser)]
#[command(name = "boxwood", version, args_conflicts_with_subcommands = true)]
struct Cli {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten)]
    view: view::Args,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the built-in scenes.
    Scenes(scenes::Args),
    /// Build structures and show their figures.
    Stats(stats::Args),
    /// Build structures and time them on the same rays, in turns.
    Compare(compare::Args),
    /// Time builds and rays over a model in growing numbers of triangles.
    Scaling(scaling::Args),
    /// Measure image error against run time: how fast pictures of each structure and sampler converge.
    Converge(converge::Args),
    /// Time structures beside those of other libraries: Embree, tinybvh, obvhs, parry3d, bvh.
    Peers(peers::Args),
    /// Check every structure and triangle test on scenes that break ray tracers, against exact arithmetic.
    Stability(stability::Args),
    /// Check a model: slivers, copies, open edges, and where structures err on it, against exact arithmetic.
    Check(check::Args),
    /// Compare bounding volumes around the nodes of one tree: tightness against cost.
    Volumes(volumes::Args),
    /// Say what a model uses and what is left out for it, and what that saves.
    Needs(needs::Args),
    /// Measure everything on a model, and put it on one page.
    Report(report::Args),
    /// Render a picture to a PNG or EXR file.
    Render(render::Args),
    /// Write the rays of a view to a NumPy file.
    Rays(rays::Args),
    /// Trace the rays of a NumPy file and write what they hit.
    Trace(trace::Args),
}

/// Reads the arguments, does what they say, and reports what went wrong.
pub fn run() -> ExitCode {
    let outcome = match Cli::try_parse() {
        Ok(cli) => dispatch(cli),
        // Help and version are errors to clap, but not to the user.
        Err(error) if !error.use_stderr() => output::print(&error.render().to_string()),
        Err(error) => Err(Failure::of_arguments(&error)),
    };
    outcome.map_or_else(|failure| failure.report(), |()| ExitCode::SUCCESS)
}

fn dispatch(cli: Cli) -> Result<(), Failure> {
    let Some(command) = cli.command else { return view::run(cli.view) };
    let cancel = Cancel::new();
    let raised = cancel.clone();
    ctrlc::set_handler(move || raised.cancel()).map_err(|e| Failure::Other(anyhow::anyhow!("can't listen for Ctrl-C: {e}")))?;
    match command {
        Command::Scenes(args) => scenes::run(&args),
        Command::Stats(args) => stats::run(&args, cancel),
        Command::Compare(args) => compare::run(&args, cancel),
        Command::Scaling(args) => scaling::run(&args, cancel),
        Command::Converge(args) => converge::run(&args, cancel),
        Command::Peers(args) => peers::run(&args, cancel),
        Command::Stability(args) => stability::run(&args, cancel),
        Command::Check(args) => check::run(&args, cancel),
        Command::Volumes(args) => volumes::run(&args, cancel),
        Command::Needs(args) => needs::run(&args, cancel),
        Command::Report(args) => report::run(&args, cancel),
        Command::Render(args) => render::run(&args, cancel),
        Command::Rays(args) => rays::run(&args, cancel),
        Command::Trace(args) => trace::run(&args, cancel),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::CommandFactory;

    #[test]
    fn the_arguments_are_well_formed() {
        Cli::command().debug_assert();
    }
}
