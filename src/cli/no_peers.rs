//! `boxwood peers` in a program that was built without the other libraries: how to get them.

use super::failure::Failure;
use crate::task::Cancel;

#[derive(Debug, clap::Args)]
#[command(disable_help_flag = true)]
pub struct Args {
    #[arg(hide = true, trailing_var_arg = true, allow_hyphen_values = true)]
    _any: Vec<String>,
}

pub fn run(_: &Args, _: Cancel) -> Result<(), Failure> {
    let how = "cargo run --release --features peers -- peers MODEL";
    Err(Failure::Input(format!("the other libraries are not built into this program: {how}")))
}
