//! The last stage of a run: tone-maps, encodes and writes, in order, behind the eye.

use std::fs::{File, OpenOptions};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, SyncSender};
use std::time::{Duration, Instant};

use crate::display::{Display, ToneMap};
use crate::error::{Error, Result};
use crate::frames::{self, About, Compression};
use crate::light::Planes;
use crate::run::checkpoint::Checkpoint;
use crate::run::watch::Watch;

/// What goes from the eye to the disk.
pub enum Delivery {
    Frame(Box<Finished>),
    Checkpoint(Box<Checkpoint>),
}

/// One finished frame.
pub struct Finished {
    pub number: u32,
    pub seen: Planes,
    pub map: Option<Arc<ToneMap>>,
    /// Unbleached fractions to be written as `state.####.exr`, or `state.exr` for `None`.
    pub state: Option<(Option<u32>, Planes, f64)>,
    pub trace: String,
    pub probes: String,
}

/// Where and how a run's files are written.
pub struct Writer<'a> {
    pub folder: &'a Path,
    pub display: Display,
    /// The percept's RGB and scale -> linear sRGB in cd/m2.
    pub seen_to_srgb: [[f32; 3]; 3],
    /// Whether `seen` is written at all.
    pub seen: bool,
    pub compression: Compression,
    pub about: About,
    /// Digest of the configuration, for state files.
    pub digest: String,
}

/// Time spent by the writer.
#[derive(Clone, Copy, Debug, Default)]
pub struct Spent {
    pub display: Duration,
    pub encode: Duration,
}

/// The two tables of a run, which grow by whole rows.
pub struct Tables {
    trace: (PathBuf, File),
    probes: (PathBuf, File),
}

impl Tables {
    /// Opens both tables, cut to the lengths of a checkpoint or begun with their headers.
    pub fn open(folder: &Path, lengths: Option<[u64; 2]>) -> Result<Tables> {
        let open = |name: &str, header: &str, length: Option<u64>| -> Result<(PathBuf, File)> {
            let path = folder.join(name);
            let opened = OpenOptions::new().create(true).write(true).truncate(false).open(&path);
            let mut file = opened.map_err(Error::io(&path, "write"))?;
            let begin = |file: &mut File| -> std::io::Result<()> {
                use std::io::Seek;
                file.set_len(length.unwrap_or(0))?;
                file.seek(std::io::SeekFrom::End(0))?;
                if length.is_none() { file.write_all(header.as_bytes()) } else { Ok(()) }
            };
            begin(&mut file).map_err(Error::io(&path, "write"))?;
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

impl Writer<'_> {
    /// Writes everything that arrives, in order, until the eye hangs up. Percepts go back to be
    /// written over.
    pub fn write_all(
        &self,
        mut tables: Tables,
        from_eye: &Receiver<Delivery>,
        give_back: &SyncSender<Planes>,
        watch: &dyn Watch,
        (mut done, total): (usize, usize),
    ) -> Result<Spent> {
        let mut spent = Spent::default();
        for delivery in from_eye {
            match delivery {
                Delivery::Frame(frame) => {
                    self.write(&frame, &mut spent)?;
                    tables.append(&frame.trace, &frame.probes)?;
                    // A full queue only means that the planes are dropped here.
                    let _ = give_back.try_send(frame.seen);
                    done += 1;
                    watch.frames(done, total);
                }
                Delivery::Checkpoint(checkpoint) => {
                    checkpoint.write(self.folder, tables.lengths()?)?
                }
            }
        }
        Ok(spent)
    }

    /// Writes one frame's pictures and state.
    pub fn write(&self, frame: &Finished, spent: &mut Spent) -> Result<()> {
        let begun = Instant::now();
        let picture = frame.map.as_ref().map(|map| self.picture(&frame.seen, map));
        spent.display += begun.elapsed();
        let begun = Instant::now();
        if self.seen {
            let path = self.folder.join(format!("seen.{:04}.exr", frame.number));
            frames::write_exr(&path, &["R", "G", "B"], &frame.seen, self.compression, &self.about)?;
        }
        if let Some(rgb) = picture {
            let path = self.folder.join(format!("display.{:04}.png", frame.number));
            frames::write_png(&path, frame.seen.width, frame.seen.height, &rgb)?;
        }
        if let Some((number, planes, time)) = &frame.state {
            let name = number.map_or("state.exr".into(), |n| format!("state.{n:04}.exr"));
            let note = serde_json::json!({ "time_s": time, "config": self.digest }).to_string();
            frames::write_state(&self.folder.join(name), planes, &note)?;
        }
        spent.encode += begun.elapsed();
        Ok(())
    }

    /// The percept as sRGB bytes.
    pub fn picture(&self, seen: &Planes, map: &ToneMap) -> Vec<u8> {
        let mut bytes = vec![0; 3 * seen.width * seen.height];
        self.display.picture(seen, &self.seen_to_srgb, map, &mut bytes);
        bytes
    }
}
