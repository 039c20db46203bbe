//! A checkpoint: one file that holds everything the next frame depends on, bit for bit.
//!
//! A line of JSON, then the numbers it counts as little-endian f64. It appears whole or not at all,
//! and is removed when the run is complete.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::eye::check::Check;
use crate::frames::atomic::write_whole;
use crate::run::report::Counters;

/// Name of the file in the run's folder.
pub const NAME: &str = "checkpoint.sungaze";

/// Everything the next frame depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub head: Head,
    /// Of the retina, of what lies beyond it, of the tone map, the pupil and the plan.
    pub numbers: [Vec<f64>; 5],
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
    pub first_gaze: Option<[f64; 2]>,
    pub retina_size: [usize; 2],
    pub retina_origin: [i64; 2],
    pub counters: Counters,
    pub check: Option<Check>,
    /// Byte lengths of `trace.csv` and `probes.csv`; known when the checkpoint is written.
    pub lengths: [u64; 2],
    /// How many numbers of each kind follow; known when the checkpoint is written.
    pub counts: [usize; 5],
}

impl Checkpoint {
    /// Writes the checkpoint of a run whose tables have these lengths.
    pub fn write(&self, folder: &Path, lengths: [u64; 2]) -> Result<()> {
        let path = folder.join(NAME);
        let head =
            Head { lengths, counts: self.numbers.each_ref().map(Vec::len), ..self.head.clone() };
        let head = serde_json::to_string(&head).map_err(|e| Error::file(&path, e.to_string()))?;
        write_whole(&path, |out| {
            writeln!(out, "{head}")?;
            for chunk in self.numbers.iter().flat_map(|numbers| numbers.chunks(4096)) {
                let bytes: Vec<u8> = chunk.iter().flat_map(|v| v.to_le_bytes()).collect();
                out.write_all(&bytes)?;
            }
            Ok(())
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
    let (numbers, rest) = bytes[end + 1..].as_chunks::<8>();
    let told = head.counts.iter().try_fold(0usize, |sum, &count| sum.checked_add(count))?;
    if told != numbers.len() || !rest.is_empty() {
        return None;
    }
    let mut numbers = numbers.iter().map(|&b| f64::from_le_bytes(b));
    let numbers = head.counts.map(|count| numbers.by_ref().take(count).collect());
    Some(Checkpoint { head, numbers })
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

    #[test]
    fn a_checkpoint_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        let head = Head {
            config: serde_json::json!({ "a": { "b": 14.064145733929653 } }),
            done: 7,
            last_frame: 12,
            first_gaze: Some([50.969380913214884, f64::MIN_POSITIVE]),
            retina_size: [1, 1],
            retina_origin: [-3, 4],
            counters: Counters::default(),
            check: None,
            lengths: [0; 2],
            counts: [0; 5],
        };
        let numbers = [
            vec![0.1, 1e-308, 1.0],
            vec![0.1 + 0.2],
            vec![f64::NAN, -0.0],
            vec![],
            vec![f64::INFINITY, 1e-4],
        ];
        let written = Checkpoint { head, numbers };
        written.write(folder.path(), [10, 20]).unwrap();
        let read = Checkpoint::read(folder.path()).unwrap().unwrap();
        assert_eq!(read.head, Head { lengths: [10, 20], counts: [3, 1, 2, 0, 2], ..written.head });
        let bits = |c: [Vec<f64>; 5]| {
            c.map(|numbers| numbers.into_iter().map(f64::to_bits).collect::<Vec<_>>())
        };
        assert_eq!(bits(read.numbers), bits(written.numbers));
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
