//! The program `lightproof`.

use std::process::ExitCode;

fn main() -> ExitCode {
    lightproof::cli::main()
}
