//! A checkpoint: one file that holds everything the next frame depends on, bit for bit.
//!
//! A line that names the format, one struct as postcard writes it, and the SHA-256 of both. It
//! appears whole or not at all, and is removed when the run is complete.

use std::io::Write;
use std::path::Path;

use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::error::{Error, Result};
use crate::eye::State;
use crate::frames::atomic::{Sink, write_lasting};
use crate::run::inputs::Input;
use crate::run::report::{Counters, Timing};

/// Name of the file in the run's folder.
pub(crate) const NAME: &str = "checkpoint.sungaze";

/// The first line of the file.
const FORMAT: &[u8] = b"sungaze checkpoint\n";

/// Everything the next frame depends on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Checkpoint {
    /// Of the program.
    pub(crate) version: String,
    /// Names the resolved configuration.
    pub(crate) config: String,
    /// Steps that are complete.
    pub(crate) done: usize,
    /// Names the numbers, files and times of those steps.
    pub(crate) steps: String,
    /// What was read for them.
    pub(crate) inputs: Vec<Input>,
    pub(crate) counters: Counters,
    pub(crate) timing: Timing,
    /// Byte lengths of `trace.csv` and `probes.csv`.
    pub(crate) lengths: [u64; 2],
    /// Levels of the tone map.
    pub(crate) map: Vec<f64>,
    pub(crate) eye: State,
}

impl Checkpoint {
    /// Writes the checkpoint into a run's folder.
    ///
    /// # Errors
    /// It cannot be written.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        write_lasting(&folder.join(NAME), |sink| {
            let mut out = Digesting { sink, digest: Sha256::new() };
            out.write_all(FORMAT)?;
            postcard::to_io(self, &mut out).map_err(std::io::Error::other)?;
            let digest = out.digest.finalize();
            out.sink.write_all(&digest)
        })
    }

    /// Reads the checkpoint of a folder; `None` if there is none.
    ///
    /// # Errors
    /// The file cannot be read, is damaged, or was left by another version.
    pub(crate) fn read(folder: &Path) -> Result<Option<Checkpoint>> {
        let path = folder.join(NAME);
        let bytes = match std::fs::read(&path) {
            Ok(bytes) => bytes,
            Err(e) if e.kind() == std::io::ErrorKind::NotFound => return Ok(None),
            Err(e) => return Err(Error::io(&path, "read")(e)),
        };
        let damaged = || {
            Error::file(&path, "is not a checkpoint of this version; start again with --overwrite")
        };
        parse(&bytes).map(Some).ok_or_else(damaged)
    }

    /// Removes the checkpoint of a complete run.
    pub(crate) fn remove(folder: &Path) -> Result<()> {
        let path = folder.join(NAME);
        match std::fs::remove_file(&path) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                Err(Error::io(&path, "remove")(e))
            }
            _ => Ok(()),
        }
    }
}

fn parse(bytes: &[u8]) -> Option<Checkpoint> {
    let (content, digest) = bytes.split_last_chunk::<32>()?;
    if Sha256::digest(content)[..] != digest[..] {
        return None;
    }
    let (checkpoint, rest) = postcard::take_from_bytes(content.strip_prefix(FORMAT)?).ok()?;
    let checkpoint: Checkpoint = checkpoint;
    (rest.is_empty() && checkpoint.version == env!("CARGO_PKG_VERSION")).then_some(checkpoint)
}

/// A file and the digest of what was written to it.
struct Digesting<'a> {
    sink: &'a mut dyn Sink,
    digest: Sha256,
}

impl Write for Digesting<'_> {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.sink.write_all(bytes)?;
        self.digest.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> std::io::Result<()> {
        self.sink.flush()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Primaries;
    use crate::eye::{Eye, Light};
    use crate::units::{Degrees, Nits};

    fn checkpoint() -> Checkpoint {
        let light = Light::rgb(Primaries::REC709, Nits(100.0));
        let eye = Eye::new(light, [3, 2], Degrees(1.0)).unwrap();
        let input = Input { frame: Some(3), name: "a".into(), bytes: 7, sha256: "0f".into() };
        Checkpoint {
            version: env!("CARGO_PKG_VERSION").into(),
            config: "c".into(),
            done: 7,
            steps: "s".into(),
            inputs: vec![input],
            counters: Counters::default(),
            timing: Timing { wall_s: 0.1 + 0.2, ..Timing::default() },
            lengths: [10, 20],
            map: vec![-0.0, 14.064145733929653, f64::MIN_POSITIVE],
            eye: eye.state(),
        }
    }

    #[test]
    fn a_checkpoint_comes_back_bit_for_bit() {
        let folder = tempfile::tempdir().unwrap();
        assert_eq!(Checkpoint::read(folder.path()).unwrap(), None);
        checkpoint().write(folder.path()).unwrap();
        assert_eq!(Checkpoint::read(folder.path()).unwrap(), Some(checkpoint()));
    }

    #[test]
    fn no_byte_of_a_checkpoint_can_be_changed_cut_off_or_added_unnoticed() {
        let folder = tempfile::tempdir().unwrap();
        checkpoint().write(folder.path()).unwrap();
        let bytes = std::fs::read(folder.path().join(NAME)).unwrap();
        assert!(parse(&bytes).is_some());
        for at in 0..bytes.len() {
            let mut changed = bytes.clone();
            changed[at] ^= 1 << (at % 8);
            assert_eq!(parse(&changed), None, "byte {at}");
            assert_eq!(parse(&bytes[..at]), None, "cut at {at}");
        }
        assert_eq!(parse(&[&bytes[..], &[0]].concat()), None);
        assert_eq!(parse(&[]), None);
    }
}
