//! What a run reads beside its settings: each file's name, size and digest, as they were when it
//! was read. A run that goes on is held to them.

use std::collections::HashSet;
use std::io::Read;
use std::path::{Path, PathBuf};

use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use sha2::{Digest, Sha256};

use crate::config::Config;
use crate::error::{Error, Result};
use crate::run::schedule::Step;

/// A file as it was read.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub(crate) struct Input {
    /// Number of the first frame that shows it; `None` for a table or a state file.
    pub(crate) frame: Option<u32>,
    pub(crate) name: String,
    pub(crate) bytes: u64,
    /// Hexadecimal.
    pub(crate) sha256: String,
}

impl Input {
    /// Reads a file for its size and digest.
    ///
    /// # Errors
    /// The file cannot be read.
    pub(crate) fn of(path: &Path, frame: Option<u32>) -> Result<Input> {
        let mut file = std::fs::File::open(path).map_err(Error::io(path, "read"))?;
        let (mut digest, mut bytes) = (Sha256::new(), 0);
        let mut chunk = vec![0; 1 << 20];
        loop {
            let read = file.read(&mut chunk).map_err(Error::io(path, "read"))?;
            if read == 0 {
                break;
            }
            digest.update(&chunk[..read]);
            bytes += read as u64;
        }
        let name = path.display().to_string();
        Ok(Input { frame, name, bytes, sha256: hexadecimal(&digest.finalize()) })
    }

    /// What is different in a file now.
    fn change(&self, path: &Path) -> Option<String> {
        match Input::of(path, self.frame) {
            Err(error) => Some(error.to_string()),
            Ok(now) if now.bytes != self.bytes => {
                let (before, after) = (self.bytes, now.bytes);
                Some(format!("{}: had {before} bytes and has {after} now", path.display()))
            }
            Ok(now) if now.sha256 != self.sha256 => {
                Some(format!("{}: its content has changed", path.display()))
            }
            Ok(_) => None,
        }
    }
}

/// Bytes as hexadecimal digits.
fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Names the times, numbers and files of steps.
pub(crate) fn digest_of_steps(steps: &[Step]) -> String {
    let mut digest = Sha256::new();
    for step in steps {
        digest.update(step.number.to_le_bytes());
        digest.update((step.file as u64).to_le_bytes());
        digest.update(step.start.to_le_bytes());
        digest.update(step.end.to_le_bytes());
    }
    hexadecimal(&digest.finalize())
}

/// The tables and state files that a configuration names.
pub(crate) fn tables(config: &Config) -> Vec<PathBuf> {
    let settings = &config.settings;
    let start =
        Some(&settings.observer.start).filter(|s| !["rested", "adapted"].contains(&s.as_str()));
    let spectrum = Some(&settings.input.spectrum)
        .into_iter()
        .flatten()
        .filter(|s| !["equal-energy", "d65"].contains(&s.as_str()));
    let tables = settings.gaze.path.iter().chain(start).chain(&settings.input.history);
    tables.chain(spectrum).map(|name| config.path(name)).collect()
}

/// The same as they are now.
///
/// # Errors
/// One of them cannot be read.
pub(crate) fn of_tables(config: &Config) -> Result<Vec<Input>> {
    tables(config).iter().map(|path| Input::of(path, None)).collect()
}

/// Holds the files that a run has read against what is there now. `files`: of the frames.
///
/// # Errors
/// A frame is gone, new among those done, or changed; so is a table. The message names it.
pub(crate) fn unchanged(
    read: &[Input],
    tables: &[PathBuf],
    steps: &[Step],
    files: &[PathBuf],
) -> Result<()> {
    let path_of = |number: u32| {
        let at = steps.binary_search_by_key(&number, |step| step.number).ok()?;
        // A film is one file for all frames.
        files.get(steps[at].file).or(files.first().filter(|_| files.len() == 1))
    };
    let mut of_tables = tables.iter();
    let pairs: Vec<(&Input, Option<&PathBuf>)> = read
        .iter()
        .map(|input| (input, input.frame.map_or_else(|| of_tables.next(), path_of)))
        .collect();
    let change = |&(input, path): &(&Input, Option<&PathBuf>)| match path {
        Some(path) => input.change(path),
        None => Some(format!("{}: is not there any more", input.name)),
    };
    match pairs.par_iter().find_map_first(|pair| Some((pair.0, change(pair)?))) {
        None => Ok(()),
        Some((input, problem)) => {
            let what = input.frame.map_or("an input".into(), |number| format!("frame {number}"));
            let problem = format!(
                "{problem}; the run has read it as it was: put it back, or start again with --overwrite"
            );
            Err(Error::config("--resume", what, problem))
        }
    }
}

/// The first of the steps already done whose file the run has not read: it is new among them.
pub(crate) fn newcomer(read: &[Input], done: &[Step], held: &[u32]) -> Option<u32> {
    let known: HashSet<u32> = read.iter().filter_map(|input| input.frame).collect();
    let is_new = |number: &u32| !known.contains(number) && held.binary_search(number).is_err();
    done.iter().map(|step| step.number).find(is_new)
}
