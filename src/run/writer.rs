//! The last stage of a run: tone-maps, encodes and writes, in order, behind the eye.

use std::borrow::Cow;
use std::fs::{File, OpenOptions};
use std::io::{Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use half::f16;
use rayon::prelude::*;

use crate::display::{Display, ToneMap};
use crate::error::{Error, Result};
use crate::frames::atomic::Syncing;
use crate::frames::{self, About, Compression, Footage};
use crate::light::{Planes, Samples, Window, narrow};
use crate::plot::marks::Marks;
use crate::run::checkpoint::Checkpoint;
use crate::run::report::Timing;
use crate::run::watch::Watch;

/// Samples that one thread turns into halves at a time.
const RUN: usize = 1 << 16;

/// What goes from the eye to the disk.
pub(crate) enum Delivery {
    /// What is seen before the first frame.
    Start(Box<Finished>),
    Frame(Box<Finished>),
    Checkpoint(Box<Checkpoint>),
}

/// One finished frame.
pub(crate) struct Finished {
    /// Its number in four digits, or `start`.
    pub(crate) name: String,
    /// Whether it has pictures.
    pub(crate) pictured: bool,
    /// The frame of the footage that was looked at.
    pub(crate) file: usize,
    pub(crate) seen: Planes,
    pub(crate) map: Option<Arc<ToneMap>>,
    /// Drawn into its display picture.
    pub(crate) marks: Option<Marks>,
    /// Unbleached fractions to be written as `state.####.exr`, or `state.exr` for `None`.
    pub(crate) state: Option<(Option<u32>, Planes, f64)>,
    pub(crate) trace: String,
    pub(crate) probes: String,
}

impl Finished {
    /// Its display picture with its marks.
    fn marked(&self, [width, height]: [usize; 2], rgb: Vec<u8>) -> Vec<u8> {
        match self.marks {
            Some(marks) => marks.draw(width, height, rgb),
            None => rgb,
        }
    }
}

/// Where and how a run's files are written.
pub(crate) struct Writer<'a> {
    pub(crate) folder: &'a Path,
    pub(crate) display: Display,
    /// The percept's RGB and scale -> linear sRGB in cd/m2.
    pub(crate) seen_to_srgb: [[f32; 3]; 3],
    /// Whether `seen` is written at all.
    pub(crate) seen: bool,
    /// Whether as halves, whatever it was computed in: codes of a film hold no more.
    pub(crate) halved: bool,
    /// The display window among the pixels of a percept: all that display pictures show.
    pub(crate) window: Window,
    /// Whose frames pass on with `seen` what else they carry.
    pub(crate) plates: Option<&'a dyn Footage>,
    pub(crate) compression: Compression,
    pub(crate) about: About,
    /// Digest of the configuration, for state files.
    pub(crate) digest: String,
}

/// The two tables of a run, which grow by whole rows.
pub(crate) struct Tables {
    trace: (PathBuf, File),
    probes: (PathBuf, File),
}

impl Tables {
    /// Opens both tables, cut to the lengths of a checkpoint or begun with a comment, which may be
    /// empty, and their headers.
    ///
    /// # Errors
    /// A table cannot be written, or is shorter than the checkpoint says.
    pub(crate) fn open(folder: &Path, comment: &str, lengths: Option<[u64; 2]>) -> Result<Tables> {
        let open = |name: &str, header: &str, length: Option<u64>| {
            let path = folder.join(name);
            let file = match length {
                Some(length) => cut(&path, length)?,
                None => begun(&path, &format!("{comment}{header}"))
                    .map_err(Error::io(&path, "write"))?,
            };
            Ok((path, file))
        };
        Ok(Tables {
            trace: open("trace.csv", super::record::TRACE, lengths.map(|l| l[0]))?,
            probes: open("probes.csv", super::record::PROBES, lengths.map(|l| l[1]))?,
        })
    }

    fn append(&mut self, trace: &str, probes: &str) -> Result<()> {
        for ((path, file), rows) in [(&mut self.trace, trace), (&mut self.probes, probes)] {
            file.write_all(rows.as_bytes()).map_err(Error::io(path, "write"))?;
        }
        Ok(())
    }

    fn lengths(&self) -> Result<[u64; 2]> {
        let length = |(path, file): &(PathBuf, File)| {
            file.sync_data()
                .and_then(|()| file.metadata())
                .map(|m| m.len())
                .map_err(Error::io(path, "write"))
        };
        Ok([length(&self.trace)?, length(&self.probes)?])
    }
}

/// A new table; a link in its place is not followed.
fn begun(path: &Path, header: &str) -> std::io::Result<File> {
    let mut file = File::create_new(path)?;
    file.write_all(header.as_bytes())?;
    Ok(file)
}

/// A table that goes on after its first `length` bytes.
fn cut(path: &Path, length: u64) -> Result<File> {
    let there = std::fs::symlink_metadata(path).map_err(Error::io(path, "read"))?;
    if !there.is_file() || there.len() < length {
        let problem = format!(
            "has lost rows since the checkpoint: it had {length} bytes then and has {} now; start \
             again with --overwrite",
            there.len()
        );
        return Err(Error::file(path, problem));
    }
    let continued = || {
        let mut file = OpenOptions::new().write(true).open(path)?;
        file.set_len(length)?;
        file.seek(std::io::SeekFrom::End(0))?;
        Ok(file)
    };
    continued().map_err(Error::io(path, "write"))
}

impl Writer<'_> {
    /// Writes everything that arrives, in order, until the eye hangs up. Percepts go back to be
    /// written over.
    pub(crate) fn write_all(
        &self,
        mut tables: Tables,
        from_eye: &Receiver<Delivery>,
        give_back: &SyncSender<Planes>,
        watch: &dyn Watch,
        (mut done, total): (usize, usize),
    ) -> Result<Timing> {
        let mut spent = Timing::default();
        // What a checkpoint or the report counts on must survive a power cut.
        let mut syncing = Syncing::begin()?;
        for delivery in from_eye {
            match delivery {
                Delivery::Start(frame) => syncing.extend(self.write(&frame, &mut spent)?),
                Delivery::Frame(frame) => {
                    syncing.extend(self.write(&frame, &mut spent)?);
                    tables.append(&frame.trace, &frame.probes)?;
                    // A full queue only means that the planes are dropped here.
                    let _ = give_back.try_send(frame.seen);
                    done += 1;
                    watch.frames(done, total);
                }
                Delivery::Checkpoint(mut checkpoint) => {
                    std::mem::replace(&mut syncing, Syncing::begin()?).end(self.folder)?;
                    checkpoint.lengths = tables.lengths()?;
                    checkpoint.timing.add(&spent);
                    checkpoint.write(self.folder)?
                }
            }
        }
        syncing.end(self.folder)?;
        tables.lengths()?;
        Ok(spent)
    }

    /// Writes one frame's pictures and state, and says which files those are. The two pictures are
    /// made side by side: a PNG takes one thread.
    pub(crate) fn write(&self, frame: &Finished, spent: &mut Timing) -> Result<Vec<PathBuf>> {
        let begun = Instant::now();
        let (seen, display) = rayon::join(|| self.write_seen(frame), || self.write_display(frame));
        let (seen, (display, mapped)) = (seen?, display?);
        let state = self.write_state(frame)?;
        spent.display_s += mapped.as_secs_f64();
        spent.encode_s += (begun.elapsed() - mapped).as_secs_f64();
        Ok([seen, display, state].into_iter().flatten().collect())
    }

    fn write_seen(&self, frame: &Finished) -> Result<Option<PathBuf>> {
        if !(self.seen && frame.pictured) {
            return Ok(None);
        }
        let path = self.folder.join(format!("seen.{}.exr", frame.name));
        let plate = self.plates.map_or(Ok(None), |footage| footage.plate(frame.file))?;
        let (seen, about) = (self.in_file(&frame.seen), &self.about);
        frames::write_percept(&path, &seen, self.compression, about, plate.as_ref())?;
        Ok(Some(path))
    }

    /// The display picture, and how long its tone map took.
    fn write_display(&self, frame: &Finished) -> Result<(Option<PathBuf>, Duration)> {
        let Some(map) = frame.map.as_ref().filter(|_| frame.pictured) else {
            return Ok((None, Duration::ZERO));
        };
        let (begun, size) = (Instant::now(), self.window.size);
        let rgb = frame.marked(size, self.picture(&self.window.of(&frame.seen), map));
        let mapped = begun.elapsed();
        let path = self.folder.join(format!("display.{}.png", frame.name));
        frames::write_png(&path, size[0], size[1], &rgb)?;
        Ok((Some(path), mapped))
    }

    fn write_state(&self, frame: &Finished) -> Result<Option<PathBuf>> {
        let Some((number, planes, time)) = &frame.state else { return Ok(None) };
        let name = number.map_or("state.exr".into(), |n| format!("state.{n:04}.exr"));
        let path = self.folder.join(name);
        let note = serde_json::json!({ "time_s": time, "config": self.digest }).to_string();
        frames::write_state(&path, planes, &note)?;
        Ok(Some(path))
    }

    /// The percept as its file holds it.
    fn in_file<'a>(&self, seen: &'a Planes) -> Cow<'a, Planes> {
        let Samples::Float(floats) = &seen.samples else { return Cow::Borrowed(seen) };
        if !self.halved {
            return Cow::Borrowed(seen);
        }
        let mut halves = vec![f16::ZERO; floats.len()];
        let runs = halves.par_chunks_mut(RUN).zip(floats.par_chunks(RUN));
        runs.for_each(|(halves, floats)| {
            narrow(floats, halves);
        });
        Cow::Owned(Planes { samples: Samples::Half(halves), ..*seen })
    }

    /// The percept as sRGB bytes.
    pub(crate) fn picture(&self, seen: &Planes, map: &ToneMap) -> Vec<u8> {
        let mut bytes = vec![0; 3 * seen.width * seen.height];
        self.display.picture(seen, &self.seen_to_srgb, map, &mut bytes);
        bytes
    }
}
