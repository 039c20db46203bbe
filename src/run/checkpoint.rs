//! A checkpoint: one file that holds everything the next frame depends on, bit for bit.
//!
//! A line of JSON, then the numbers it counts as little-endian f64: the retina, the tone map, the pupil, the plan. It appears
//! whole or not at all, and is removed when the run is complete.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::check::Check;
use crate::error::{Error, Result};
use crate::frames::atomic::write_whole;
use crate::run::report::Counters;

/// Name of the file in the run's folder.
pub const NAME: &str = "checkpoint.sungaze";

/// Everything the next frame depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Checkpoint {
    /// The resolved configuration; a resumed run must have the same.
    pub config: Value,
    /// Steps that are complete.
    pub done: usize,
    /// Number of the last complete frame.
    pub last_frame: u32,
    pub first_gaze: Option<[f64; 2]>,
    pub retina_size: [usize; 2],
    pub retina_origin: [i64; 2],
    pub beyond: [u64; 3],
    pub counters: Counters,
    pub check: Option<Check>,
    /// Byte lengths of `trace.csv` and `probes.csv`.
    pub lengths: [u64; 2],
    /// How many numbers of each follow.
    counts: [usize; 4],
    #[serde(skip)]
    pub retina: Vec<f64>,
    #[serde(skip)]
    pub map: Vec<f64>,
    #[serde(skip)]
    pub pupil: Vec<f64>,
    #[serde(skip)]
    pub plan: Vec<f64>,
}

/// The parts of a checkpoint that are JSON.
pub struct Header {
    pub config: Value,
    pub done: usize,
    pub last_frame: u32,
    pub first_gaze: Option<[f64; 2]>,
    pub retina_size: [usize; 2],
    pub retina_origin: [i64; 2],
    pub beyond: [f64; 3],
    pub counters: Counters,
    pub check: Option<Check>,
}

impl Checkpoint {
    /// A checkpoint of these parts; lengths are known when it is written.
    pub fn new(header: Header, retina: Vec<f64>, map: Vec<f64>, pupil: Vec<f64>, plan: Vec<f64>) -> Self {
        Checkpoint {
            config: header.config,
            done: header.done,
            last_frame: header.last_frame,
            first_gaze: header.first_gaze,
            retina_size: header.retina_size,
            retina_origin: header.retina_origin,
            beyond: header.beyond.map(f64::to_bits),
            counters: header.counters,
            check: header.check,
            lengths: [0; 2],
            counts: [retina.len(), map.len(), pupil.len(), plan.len()],
            retina,
            map,
            pupil,
            plan,
        }
    }

    /// Writes the checkpoint of a run whose tables have these lengths.
    pub fn write(&self, folder: &Path, lengths: [u64; 2]) -> Result<()> {
        let path = folder.join(NAME);
        let whole = Checkpoint { lengths, ..self.clone_header() };
        let head = serde_json::to_string(&whole).map_err(|e| Error::file(&path, e.to_string()))?;
        write_whole(&path, |out| {
            writeln!(out, "{head}")?;
            for numbers in [&self.retina, &self.map, &self.pupil, &self.plan] {
                for chunk in numbers.chunks(4096) {
                    let bytes: Vec<u8> = chunk.iter().flat_map(|v| v.to_le_bytes()).collect();
                    out.write_all(&bytes)?;
                }
            }
            Ok(())
        })
    }

    fn clone_header(&self) -> Checkpoint {
        Checkpoint {
            config: self.config.clone(),
            counters: self.counters.clone(),
            check: self.check.clone(),
            retina: vec![],
            map: vec![],
            pupil: vec![],
            plan: vec![],
            ..*self
        }
    }

    /// Reads the checkpoint of a folder; `None` if there is none.
    pub fn read(folder: &Path) -> Result<Option<Checkpoint>> {
        let path = folder.join(NAME);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(Error::io(&path, "read")(e)),
        };
        parse(&bytes).map(Some).ok_or_else(|| damaged(&path))
    }

    /// Removes the checkpoint of a complete run.
    pub fn remove(folder: &Path) -> Result<()> {
        let path = folder.join(NAME);
        match std::fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => Err(Error::io(&path, "remove")(e)),
            _ => Ok(()),
        }
    }
}

fn damaged(path: &PathBuf) -> Error {
    Error::file(path, "is not a checkpoint of this version; start afresh with --overwrite")
}

fn parse(bytes: &[u8]) -> Option<Checkpoint> {
    let end = bytes.iter().position(|&b| b == b'\n')?;
    let mut checkpoint: Checkpoint = serde_json::from_slice(&bytes[..end]).ok()?;
    let mut numbers =
        bytes[end + 1..].chunks_exact(8).map(|b| f64::from_le_bytes([b[0], b[1], b[2], b[3], b[4], b[5], b[6], b[7]]));
    let [retina, map, pupil, plan] = checkpoint.counts;
    if bytes.len() - end - 1 != 8 * retina.checked_add(map)?.checked_add(pupil)?.checked_add(plan)? {
        return None;
    }
    checkpoint.retina = numbers.by_ref().take(retina).collect();
    checkpoint.map = numbers.by_ref().take(map).collect();
    checkpoint.pupil = numbers.by_ref().take(pupil).collect();
    checkpoint.plan = numbers.collect();
    Some(checkpoint)
}

/// The first key in which two configurations differ, dotted.
pub fn difference(a: &Value, b: &Value) -> Option<String> {
    let (Value::Object(a), Value::Object(b)) = (a, b) else { return (a != b).then(String::new) };
    let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
    keys.filter_map(|key| {
        let inner = difference(a.get(key).unwrap_or(&Value::Null), b.get(key).unwrap_or(&Value::Null))?;
        Some(if inner.is_empty() { key.clone() } else { format!("{key}.{inner}") })
    })
    .next()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_checkpoint_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let header = Header {
            config: serde_json::json!({ "a": { "b": 1 } }),
            done: 7,
            last_frame: 12,
            first_gaze: Some([0.1, f64::MIN_POSITIVE]),
            retina_size: [1, 1],
            retina_origin: [-3, 4],
            beyond: [0.1 + 0.2, 1.0, 1e-300],
            counters: Counters::default(),
            check: None,
        };
        let written = Checkpoint::new(
            header,
            vec![0.1, 1e-308, 1.0],
            vec![f64::NAN.abs(), -0.0],
            vec![f64::NEG_INFINITY],
            vec![f64::INFINITY, 1e-4],
        );
        written.write(folder.path(), [10, 20]).unwrap();
        let read = Checkpoint::read(folder.path()).unwrap().unwrap();
        assert_eq!(read.lengths, [10, 20]);
        assert_eq!((read.done, read.beyond, read.first_gaze), (7, written.beyond, written.first_gaze));
        let bits = |v: &[f64]| v.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(
            (bits(&read.retina), bits(&read.map), bits(&read.pupil), bits(&read.plan)),
            (bits(&written.retina), bits(&written.map), bits(&written.pupil), bits(&written.plan))
        );
    }

    #[test]
    fn the_differing_key_is_named() {
        let a = serde_json::json!({ "observer": { "age": 30, "eyes": 2 }, "time": {} });
        let b = serde_json::json!({ "observer": { "age": 31, "eyes": 2 }, "time": {} });
        assert_eq!(difference(&a, &b), Some("observer.age".into()));
        assert_eq!(difference(&a, &a), None);
    }
}
