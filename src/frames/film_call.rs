//! A call of `ffmpeg` or `ffprobe`, and what they complain of.

use std::ffi::OsString;
use std::io::{self, ErrorKind};
use std::path::Path;
use std::process::{Command, Stdio};

use crate::error::Error;

/// A call of ffmpeg or ffprobe that opens a file and nothing else, quietly.
pub(super) fn command(program: &str, path: &Path) -> Command {
    let mut file = OsString::from("file:");
    file.push(path);
    let mut command = Command::new(program);
    command.args(["-v", "error", "-protocol_whitelist", "file,pipe"]);
    if program == "ffmpeg" {
        // An error in the stream ends it; frames are neither turned nor made up.
        command.args(["-nostdin", "-xerror", "-noautorotate"]);
        command.args(["-err_detect", "explode"]);
    }
    command.arg("-i").arg(file).stdin(Stdio::null());
    // Ctrl-C is for us: a frame in hand is finished.
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    command
}

/// What to do where there is no ffmpeg.
pub(super) fn not_started(path: &Path, error: io::Error) -> Error {
    if error.kind() != ErrorKind::NotFound {
        return Error::file(path, format!("ffmpeg cannot be started: {error}"));
    }
    let name = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let stem = path.file_stem().unwrap_or_default().to_string_lossy().into_owned();
    let problem = format!(
        "films are decoded by ffmpeg and ffprobe, which are not on PATH. Install them (apt install \
         ffmpeg, brew install ffmpeg, winget install ffmpeg), or make frames of the film where \
         they are: ffmpeg -i {name} -fps_mode passthrough {stem}.%04d.png"
    );
    Error::file(path, problem)
}

/// A complaint of ffmpeg without the addresses in it, which are never twice the same.
pub(super) fn complaint(line: &str) -> String {
    let words = line.split_whitespace().filter(|word| !word.starts_with("0x") && *word != "@");
    words.collect::<Vec<_>>().join(" ")
}
