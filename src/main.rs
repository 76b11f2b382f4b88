//! The `kfgpu` command.

use std::process::ExitCode;

fn main() -> ExitCode {
    kfgpu::cli::main()
}
