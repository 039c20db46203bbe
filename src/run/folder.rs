//! The run's folder: empty, to be gone on with, or to be written over.

use std::path::{Path, PathBuf};

use serde_json::Value;

use crate::error::{Error, Result};
use crate::page;
use crate::run::checkpoint::{self, Checkpoint};

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

/// What was found.
pub enum Prepared {
    Fresh,
    Resume(Box<Checkpoint>),
    /// A complete run of the same configuration: its report.
    Complete(Value),
}

/// Name of the file that a run holds locked while it writes into its folder.
const LOCK: &str = ".sungaze-lock.tmp";

/// A folder that no other run writes into; given up when dropped.
pub struct Claim {
    path: PathBuf,
    _file: std::fs::File,
}

impl Claim {
    /// Makes the folder and claims it. Refused while another run holds it; a killed run holds
    /// nothing.
    pub fn new(folder: &Path) -> Result<Claim> {
        if folder.exists() && !folder.is_dir() {
            return Err(Error::config(
                "--out",
                folder.display().to_string(),
                "is a file; accepted: a folder, or a new name",
            ));
        }
        std::fs::create_dir_all(folder).map_err(Error::io(folder, "create"))?;
        let path = folder.join(LOCK);
        let file = std::fs::File::create(&path).map_err(Error::io(folder, "write into"))?;
        match file.try_lock() {
            Err(std::fs::TryLockError::WouldBlock) => {
                let problem =
                    "another run is writing into it; wait for that, or give another folder";
                Err(Error::config("--out", folder.display().to_string(), problem))
            }
            // A file system without locks leaves everybody to themselves.
            _ => Ok(Claim { path, _file: file }),
        }
    }
}

impl Drop for Claim {
    fn drop(&mut self) {
        // What cannot be removed is swept up by the next run.
        let _ = std::fs::remove_file(&self.path);
    }
}

/// Makes a claimed folder ready for a run of a configuration.
pub fn prepare(folder: &Path, existing: Existing, config: &Value) -> Result<Prepared> {
    let entries = std::fs::read_dir(folder).map_err(Error::io(folder, "read"))?;
    let empty = entries.flatten().all(|entry| entry.file_name() == LOCK);
    match existing {
        _ if empty => Ok(Prepared::Fresh),
        Existing::Refuse => Err(not_empty(folder)),
        Existing::Overwrite => remove(folder, |_| true).map(|()| Prepared::Fresh),
        Existing::Resume => resume(folder, config),
    }
}

/// The refusal of a folder that holds something.
pub fn not_empty(folder: &Path) -> Error {
    let problem = "is not empty: give --resume to go on with a run, --overwrite to replace it, or another folder";
    Error::config("--out", folder.display().to_string(), problem)
}

fn resume(folder: &Path, config: &Value) -> Result<Prepared> {
    if let Some(checkpoint) = Checkpoint::read(folder)? {
        same(folder, &checkpoint.head.config, config)?;
        remove(folder, |name| {
            is_temporary(name) || frame_number(name).is_some_and(|n| n > checkpoint.head.last_frame)
        })?;
        return Ok(Prepared::Resume(Box::new(checkpoint)));
    }
    let path = folder.join("report.json");
    if let Some(report) = std::fs::read_to_string(&path)
        .ok()
        .and_then(|text| serde_json::from_str::<Value>(&text).ok())
    {
        same(folder, &report["config"], config)?;
        return Ok(Prepared::Complete(report));
    }
    remove(folder, |_| true).map(|()| Prepared::Fresh)
}

/// Refuses other settings than an earlier run's, naming the first key that differs.
pub(crate) fn same(folder: &Path, earlier: &Value, now: &Value) -> Result<()> {
    match checkpoint::difference(earlier, now) {
        None => Ok(()),
        Some(key) => {
            let at = |config: &Value| {
                key.split('.')
                    .try_fold(config, |v, part| v.get(part))
                    .map_or("nothing".into(), Value::to_string)
            };
            let problem = format!(
                "{}: the earlier run had {}, this one has {}; resume with the same settings, or --overwrite",
                folder.display(),
                at(earlier),
                at(now)
            );
            Err(Error::config("--resume", &key, problem))
        }
    }
}

/// Removes files that a run writes and that `which` picks by name. Other people's files stay.
fn remove(folder: &Path, which: impl Fn(&str) -> bool) -> Result<()> {
    for entry in std::fs::read_dir(folder).map_err(Error::io(folder, "read"))? {
        let path: PathBuf = entry.map_err(Error::io(folder, "read"))?.path();
        let name = path.file_name().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
        if is_ours(&name) && which(&name) && path.is_file() {
            std::fs::remove_file(&path).map_err(Error::io(&path, "remove"))?;
        }
    }
    Ok(())
}

fn is_ours(name: &str) -> bool {
    let fixed = [
        "trace.csv",
        "probes.csv",
        "probes.svg",
        "report.json",
        page::REPORT,
        "state.exr",
        "video.ffconcat",
        checkpoint::NAME,
    ];
    fixed.contains(&name) || frame_number(name).is_some() || is_temporary(name)
}

/// A file that a killed run was still writing.
fn is_temporary(name: &str) -> bool {
    name.starts_with(".sungaze-") && name.ends_with(".tmp") && name != LOCK
}

/// The number in `seen.0001.exr` and its like.
fn frame_number(name: &str) -> Option<u32> {
    let forms = [("seen.", ".exr"), ("display.", ".png"), ("state.", ".exr")];
    forms.iter().find_map(|(head, tail)| {
        let number = name.strip_prefix(head)?.strip_suffix(tail)?;
        number.bytes().all(|b| b.is_ascii_digit()).then(|| number.parse().ok())?
    })
}
