//! The program: parses its arguments and hands over to a command or to the window.

fn main() -> std::process::ExitCode {
    boxwood::cli::run()
}
