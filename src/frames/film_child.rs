//! `ffmpeg` as a child process that writes decoded frames into a pipe.

use std::fs::File;
use std::io::{Read, Seek, SeekFrom};
use std::path::{Path, PathBuf};
use std::process::{Child, ChildStdout, Command, Stdio};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

use crate::error::{Error, Result};
use crate::frames::film_call::{command, complaint, not_started};
use crate::frames::film_yuv::Layout;

/// The frames of a film as bytes, in order. A frame that was passed is reached by starting anew.
pub(super) struct Decoder {
    path: PathBuf,
    layout: Layout,
    frames: usize,
    /// Complaints that the film gave rise to when it was probed: they do no harm.
    known: Vec<String>,
    running: Option<Running>,
    /// The number of the frame in `bytes`.
    holds: Option<usize>,
    bytes: Vec<u8>,
}

/// An ffmpeg at work, and the thread that takes its frames.
struct Running {
    child: Child,
    pump: Option<JoinHandle<Pump>>,
    /// Frames, or what ffmpeg complained of; hung up at the end of the film.
    arriving: Receiver<Result<Vec<u8>, String>>,
    /// Rooms for the next frames.
    spent: SyncSender<Vec<u8>>,
    /// The frame that comes next.
    next: usize,
}

impl Running {
    /// What ffmpeg, which has closed its pipe, complained of at last.
    fn last_words(mut self) -> Option<String> {
        let _ = self.child.wait();
        self.pump.take()?.join().ok()?.complaint()
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}

/// Takes frames out of the pipe as soon as they are there, so that ffmpeg goes on decoding while
/// the last one is looked at.
struct Pump {
    pipe: ChildStdout,
    complaints: File,
    /// Bytes of complaints that were read.
    heard: u64,
    known: Vec<String>,
    /// Bytes of a frame.
    length: usize,
}

/// How many frames may wait.
const AHEAD: usize = 1;

impl Pump {
    /// Sends frames until there are no more, or ffmpeg complains, or nobody wants them.
    fn run(mut self, to: &SyncSender<Result<Vec<u8>, String>>, spent: &Receiver<Vec<u8>>) -> Pump {
        loop {
            let mut bytes = spent.try_recv().unwrap_or_default();
            bytes.resize(self.length, 0);
            if self.pipe.read_exact(&mut bytes).is_err() {
                return self;
            }
            let complaint = self.complaint();
            let last = complaint.is_some();
            if to.send(complaint.map_or(Ok(bytes), Err)).is_err() || last {
                return self;
            }
        }
    }

    /// What ffmpeg has complained of since it was last asked, the known complaints apart.
    fn complaint(&mut self) -> Option<String> {
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
        lines.find(|line| !self.known.contains(line))
    }
}

impl Decoder {
    /// `known`: what ffprobe complained of.
    pub(crate) fn new(path: &Path, layout: &Layout, frames: usize, known: Vec<String>) -> Decoder {
        let (path, layout) = (path.to_owned(), layout.clone());
        Decoder { path, layout, frames, known, running: None, holds: None, bytes: Vec::new() }
    }

    /// The bytes of a frame, counted from 0. A frame that ffmpeg complains of and conceals is as bad
    /// as one that is not there; it decodes a few frames ahead, so the number may be too small.
    pub(crate) fn frame(&mut self, index: usize) -> Result<&[u8]> {
        if self.holds != Some(index) {
            self.holds = None;
            if self.running.as_ref().is_none_or(|running| running.next > index) {
                self.running = None;
                self.running = Some(self.start()?);
            }
            while let Some(running) = &mut self.running
                && running.next <= index
            {
                match running.arriving.recv() {
                    Ok(Ok(frame)) => {
                        let spent = std::mem::replace(&mut self.bytes, frame);
                        // Where there is no place for it, it is let go.
                        let _ = running.spent.try_send(spent);
                        running.next += 1;
                    }
                    Ok(Err(complaint)) => return Err(self.ended(Some(complaint))),
                    Err(_) => return Err(self.ended(None)),
                }
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
        let child = self.command().stdout(Stdio::piped()).stderr(heard).spawn();
        let mut child = child.map_err(|error| not_started(&self.path, error))?;
        let Some(pipe) = child.stdout.take() else {
            return Err(Error::file(&self.path, "ffmpeg gave no pipe to read from"));
        };
        let (complaints, known) = (complaints.into_file(), self.known.clone());
        let pump = Pump { pipe, complaints, heard: 0, known, length: self.layout.bytes() };
        let (to, arriving) = sync_channel(AHEAD);
        let (spent, rooms) = sync_channel(AHEAD + 1);
        let pump = std::thread::Builder::new().spawn(move || pump.run(&to, &rooms));
        let pump = pump.map_err(fail())?;
        Ok(Running { child, pump: Some(pump), arriving, spent, next: 0 })
    }

    /// The call of ffmpeg that writes all frames to its standard output.
    fn command(&self) -> Command {
        let mut command = command("ffmpeg", &self.path);
        command.args(["-map", "0:v:0", "-fps_mode", "passthrough", "-f", "rawvideo"]);
        if self.layout.repacked {
            // Otherwise ffmpeg takes planes for codes of limited range, and converts full ones.
            command.args(["-vf", "scale=in_range=limited:out_range=limited"]);
        }
        command.args(["-pix_fmt", &self.layout.pix_fmt, "-"]);
        command
    }

    /// Why the film ended before the frame that was asked for. `said`: a complaint that was heard.
    fn ended(&mut self, said: Option<String>) -> Error {
        let (running, frames) = (self.running.take(), self.frames);
        let frame = running.as_ref().map_or(0, |running| running.next) + 1;
        let why = said.or_else(|| running?.last_words());
        let why = why.map(|why| format!(": {why}")).unwrap_or_default();
        let problem = format!("is damaged or cut short at frame {frame} of {frames}{why}");
        Error::file(&self.path, problem)
    }
}
