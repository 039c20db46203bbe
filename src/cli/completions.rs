//! `sungaze completions`.

use std::process::ExitCode;

use clap::Command;
use clap_complete::Shell;
use sungaze::error::Result;

/// Writes a shell's completion script to stdout.
pub(crate) fn command(shell: Shell, program: &mut Command) -> Result<ExitCode> {
    let mut script = Vec::new();
    clap_complete::generate(shell, program, "sungaze", &mut script);
    super::say::result(String::from_utf8_lossy(&script).trim_end())?;
    Ok(ExitCode::SUCCESS)
}
