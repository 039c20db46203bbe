//! `sungaze completions`.

use clap::Command;
use clap_complete::Shell;

/// Writes a shell's completion script to stdout.
pub fn command(shell: Shell, program: &mut Command) {
    let mut script = Vec::new();
    clap_complete::generate(shell, program, "sungaze", &mut script);
    super::say(String::from_utf8_lossy(&script).trim_end());
}
