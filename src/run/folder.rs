//! The folder that a run or a sweep writes into: who holds it, and whose it is.

use std::fs::{File, TryLockError};
use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::run::manifest::{self, Kind, Manifest};

/// What to do with a folder that is not empty.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Existing {
    /// Refuse it.
    #[default]
    Refuse,
    /// Go on where an earlier run of the same configuration stopped.
    Resume,
    /// Remove what an earlier run left, and start afresh.
    Overwrite,
}

/// A lock on a folder, given up when dropped or when the process is killed. It is the folder itself
/// that is locked: no file is made, and no link followed.
pub(crate) struct Claim {
    folder: File,
}

impl Claim {
    /// Makes the folder and claims it, for this process alone or (`shared`) together with others
    /// that share it.
    ///
    /// # Errors
    /// The folder cannot be made, or another process holds it.
    pub(crate) fn new(folder: &Path, shared: bool) -> Result<Claim> {
        let refused =
            |problem: &str| Err(Error::config("--out", folder.display().to_string(), problem));
        if folder.exists() && !folder.is_dir() {
            return refused("is a file; accepted: a folder, or a new name");
        }
        std::fs::create_dir_all(folder).map_err(Error::io(folder, "create"))?;
        let claim = Claim { folder: File::open(folder).map_err(Error::io(folder, "open"))? };
        if claim.try_hold(shared) {
            return Ok(claim);
        }
        refused("another run is writing into it; wait for that, or give another folder")
    }

    /// Whether the claim could be had. A file system without locks leaves everybody to themselves.
    pub(crate) fn try_hold(&self, shared: bool) -> bool {
        let tried = if shared { self.folder.try_lock_shared() } else { self.folder.try_lock() };
        !matches!(tried, Err(TryLockError::WouldBlock))
    }
}

/// The manifest of a folder whose files may be removed.
///
/// # Errors
/// The folder is not such a one of the program's, or holds an input.
pub(crate) fn owned(folder: &Path, kind: Kind, inputs: &[PathBuf]) -> Result<Manifest> {
    let refused =
        |problem: String| Err(Error::config("--out", folder.display().to_string(), problem));
    if let Some(input) = manifest::input_within(folder, inputs) {
        let problem = format!("holds {}, which is read: give another folder", input.display());
        return refused(problem);
    }
    match Manifest::read(folder)? {
        Some(manifest) if manifest.kind == kind => Ok(manifest),
        Some(_) => {
            refused("holds a sweep or a run, the other of the two: give another folder".into())
        }
        None => {
            let entries = manifest::entries(folder)?;
            refused(format!(
                "holds {} and nothing that says that this program made it: give another folder, or \
                 empty it yourself",
                entries.iter().min().map_or("files", String::as_str)
            ))
        }
    }
}

/// The refusal of a folder that holds something.
pub fn not_empty(folder: &Path) -> Error {
    let problem = "is not empty: give --resume to go on with a run, --overwrite to replace it, or \
                   another folder";
    Error::config("--out", folder.display().to_string(), problem)
}

/// Refuses other settings than an earlier run's, naming the first key that differs.
pub(crate) fn same(folder: &Path, earlier: &Value, now: &Value) -> Result<()> {
    let Some(key) = difference(earlier, now) else { return Ok(()) };
    let at = |config: &Value| {
        let value = key.split('.').try_fold(config, |v, part| v.get(part));
        value.map_or("nothing".into(), Value::to_string)
    };
    let problem = format!(
        "{}: the earlier run had {}, this one has {}; resume with the same settings, or --overwrite",
        folder.display(),
        at(earlier),
        at(now)
    );
    Err(Error::config("--resume", &key, problem))
}

/// The first key in which two configurations differ, dotted.
fn difference(a: &Value, b: &Value) -> Option<String> {
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
    fn the_differing_key_is_named() {
        let a = serde_json::json!({ "observer": { "age": 30, "eyes": 2 }, "time": {} });
        let b = serde_json::json!({ "observer": { "age": 31, "eyes": 2 }, "time": {} });
        assert_eq!(difference(&a, &b), Some("observer.age".into()));
        assert_eq!(difference(&a, &a), None);
    }
}
