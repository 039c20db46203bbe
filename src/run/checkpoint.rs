//! A checkpoint: one file that holds everything the next frame depends on, bit for bit.
//!
//! A line of JSON, then the state of the eye and of the display in the postcard format. It appears whole or not at all,
//! and is removed when the run is complete.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::eye::State;
use crate::frames::atomic::write_whole;
use crate::run::report::Counters;

/// Name of the file in the run's folder.
pub const NAME: &str = "checkpoint.sungaze";

/// Everything the next frame depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub head: Head,
    /// The eye's own.
    pub state: State,
    /// Levels of the display's tone map.
    pub map: Vec<f64>,
}

/// The part of a checkpoint that is JSON.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Head {
    /// The resolved configuration; a resumed run must have the same.
    pub config: Value,
    /// Steps that are complete.
    pub done: usize,
    /// Number of the last complete frame.
    pub last_frame: u32,
    pub counters: Counters,
    /// Byte lengths of `trace.csv` and `probes.csv`; known when the checkpoint is written.
    pub lengths: [u64; 2],
}

impl Checkpoint {
    /// Writes the checkpoint of a run whose tables have these lengths.
    pub fn write(&self, folder: &Path, lengths: [u64; 2]) -> Result<()> {
        let path = folder.join(NAME);
        let head = Head { lengths, ..self.head.clone() };
        let head = serde_json::to_string(&head).map_err(|e| Error::file(&path, e.to_string()))?;
        let state = postcard::to_stdvec(&(&self.state, &self.map))
            .map_err(|e| Error::file(&path, e.to_string()))?;
        write_whole(&path, |out| {
            writeln!(out, "{head}")?;
            out.write_all(&state)
        })
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
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                Err(Error::io(&path, "remove")(e))
            }
            _ => Ok(()),
        }
    }
}

fn damaged(path: &PathBuf) -> Error {
    Error::file(path, "is not a checkpoint of this version; start afresh with --overwrite")
}

fn parse(bytes: &[u8]) -> Option<Checkpoint> {
    let end = bytes.iter().position(|&b| b == b'\n')?;
    let head: Head = serde_json::from_slice(&bytes[..end]).ok()?;
    let ((state, map), rest) = postcard::take_from_bytes(&bytes[end + 1..]).ok()?;
    rest.is_empty().then_some(Checkpoint { head, state, map })
}

/// The first key in which two configurations differ, dotted.
pub fn difference(a: &Value, b: &Value) -> Option<String> {
    let (Value::Object(a), Value::Object(b)) = (a, b) else { return (a != b).then(String::new) };
    let keys = a.keys().chain(b.keys().filter(|key| !a.contains_key(*key)));
    keys.filter_map(|key| {
        let inner =
            difference(a.get(key).unwrap_or(&Value::Null), b.get(key).unwrap_or(&Value::Null))?;
        Some(if inner.is_empty() { key.clone() } else { format!("{key}.{inner}") })
    })
    .next()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Primaries;
    use crate::eye::{Eye, Gaze, Light};
    use crate::units::{Degrees, Nits, Seconds};
    use ndarray::Array3;

    #[test]
    fn a_checkpoint_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let light = Light::rgb(Primaries::REC709, Nits(1e5));
        let mut eye = Eye::new(light, [3, 2], Degrees(1.0)).unwrap();
        let frame = Array3::<f32>::ones((2, 3, 3));
        eye.look(frame.view(), Gaze([0.3, 0.7]), Seconds(1.0 / 3.0)).unwrap();
        let head = Head {
            config: serde_json::json!({ "a": { "b": 14.064145733929653 } }),
            done: 7,
            last_frame: 12,
            counters: Counters::default(),
            lengths: [0; 2],
        };
        let written = Checkpoint { head, state: eye.state(), map: vec![-0.0, 0.1 + 0.2] };
        written.write(folder.path(), [10, 20]).unwrap();
        let read = Checkpoint::read(folder.path()).unwrap().unwrap();
        let head = Head { lengths: [10, 20], ..written.head.clone() };
        assert_eq!(read, Checkpoint { head, ..written });
    }

    #[test]
    fn a_damaged_checkpoint_is_refused() {
        let folder = tempfile::tempdir().unwrap();
        for damage in ["", "{}", "{}\n12345678", "no JSON\n"] {
            std::fs::write(folder.path().join(NAME), damage).unwrap();
            assert!(Checkpoint::read(folder.path()).is_err(), "{damage:?}");
        }
    }

    #[test]
    fn the_differing_key_is_named() {
        let a = serde_json::json!({ "observer": { "age": 30, "eyes": 2 }, "time": {} });
        let b = serde_json::json!({ "observer": { "age": 31, "eyes": 2 }, "time": {} });
        assert_eq!(difference(&a, &b), Some("observer.age".into()));
        assert_eq!(difference(&a, &a), None);
    }
}
