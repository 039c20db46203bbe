//! `ffmpeg` as a child process that writes decoded frames into a pipe.

use std::ffi::OsString;
use std::fs::File;
use std::io::{self, ErrorKind, Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};

use crate::error::{Error, Result};
use crate::frames::film_yuv::Layout;

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

/// The frames of a film as bytes, in order. A frame that was passed is reached by starting anew.
pub(super) struct Decoder {
    path: PathBuf,
    /// ffmpeg's name for the layout of the bytes.
    pix_fmt: String,
    /// Whether that is not the stream's own.
    repacked: bool,
    frames: usize,
    /// Complaints that the film gave rise to when it was probed: they do no harm.
    known: Vec<String>,
    running: Option<Running>,
    /// The number of the frame in `bytes`.
    holds: Option<usize>,
    bytes: Vec<u8>,
}

struct Running {
    child: Child,
    pipe: ChildStdout,
    complaints: File,
    /// Bytes of complaints that were read.
    heard: u64,
    /// The frame that comes next.
    next: usize,
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// A complaint of ffmpeg without the addresses in it, which are never twice the same.
pub(super) fn complaint(line: &str) -> String {
    let words = line.split_whitespace().filter(|word| !word.starts_with("0x") && *word != "@");
    words.collect::<Vec<_>>().join(" ")
}

impl Running {
    /// What ffmpeg has complained of since it was last asked, the known complaints apart.
    fn complaint(&mut self, known: &[String]) -> Option<String> {
        let length = self.complaints.metadata().ok()?.len();
        if length == self.heard {
            return None;
        }
        let mut said = Vec::new();
        let mut file = &self.complaints;
        file.seek(SeekFrom::Start(self.heard)).ok()?;
        file.take(length - self.heard).read_to_end(&mut said).ok()?;
        self.heard = length;
        let said = String::from_utf8_lossy(&said).into_owned();
        let mut lines = said.lines().map(complaint).filter(|line| !line.is_empty());
        lines.find(|line| !known.contains(line))
    }
}

impl Decoder {
    /// `known`: what ffprobe complained of.
    pub fn new(path: &Path, layout: &Layout, frames: usize, known: Vec<String>) -> Decoder {
        Decoder {
            path: path.to_owned(),
            pix_fmt: layout.pix_fmt.clone(),
            repacked: layout.repacked,
            frames,
            known,
            running: None,
            holds: None,
            bytes: vec![0; layout.bytes()],
        }
    }

    /// The bytes of a frame, counted from 0. A frame that ffmpeg complains of and conceals is as bad
    /// as one that is not there; it decodes a few frames ahead, so the number may be too small.
    pub fn frame(&mut self, index: usize) -> Result<&[u8]> {
        if self.holds != Some(index) {
            self.holds = None;
            if self.running.as_ref().is_none_or(|running| running.next > index) {
                self.running = None;
                self.running = Some(self.start()?);
            }
            while let Some(running) = &mut self.running
                && running.next <= index
            {
                let read = running.pipe.read_exact(&mut self.bytes);
                if read.is_err() {
                    let _ = running.child.wait();
                }
                let complaint = running.complaint(&self.known);
                if read.is_err() || complaint.is_some() {
                    return Err(self.ended(complaint));
                }
                running.next += 1;
            }
            self.holds = Some(index);
        }
        Ok(&self.bytes)
    }

    fn start(&self) -> Result<Running> {
        // ffmpeg appends by a handle of its own, so that reading does not move its place.
        let fail = || Error::io(&self.path, "decode");
        let complaints = tempfile::NamedTempFile::new().map_err(fail())?;
        let heard = File::options().append(true).open(complaints.path()).map_err(fail())?;
        let mut command = command("ffmpeg", &self.path);
        command.args(["-map", "0:v:0", "-fps_mode", "passthrough", "-f", "rawvideo"]);
        if self.repacked {
            // Otherwise ffmpeg takes planes for codes of limited range, and converts full ones.
            command.args(["-vf", "scale=in_range=limited:out_range=limited"]);
        }
        command.args(["-pix_fmt", &self.pix_fmt, "-"]);
        let child = command.stdout(Stdio::piped()).stderr(heard).spawn();
        let mut child = child.map_err(|error| not_started(&self.path, error))?;
        let Some(pipe) = child.stdout.take() else {
            return Err(Error::file(&self.path, "ffmpeg gave no pipe to read from"));
        };
        Ok(Running { child, pipe, complaints: complaints.into_file(), heard: 0, next: 0 })
    }

    /// Why the film ended before the frame that was asked for.
    fn ended(&mut self, why: Option<String>) -> Error {
        let frame = self.running.take().map_or(0, |running| running.next) + 1;
        let why = why.map(|why| format!(": {why}")).unwrap_or_default();
        let frames = self.frames;
        let problem = format!("is damaged or cut short at frame {frame} of {frames}{why}");
        Error::file(&self.path, problem)
    }
}
