//! `.sungaze`: a folder's manifest. It says who made the folder and names every file that they write there; nothing
//! that it does not name is ever removed.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::error::{Error, Result};
use crate::frames::atomic;

/// Name of the file.
pub(crate) const NAME: &str = ".sungaze";

/// What a folder holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(crate) enum Kind {
    Run,
    Sweep,
    /// One case of a sweep.
    Case,
}

/// What a folder holds, from which settings, under which names.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Manifest {
    pub(crate) kind: Kind,
    /// Of the program.
    version: String,
    /// The resolved configuration.
    pub(crate) config: Value,
    /// Files that are made once.
    pub(crate) files: BTreeSet<String>,
    /// Numbers of the frames that have pictures: first and last of each run of them.
    frames: Vec<[u32; 2]>,
}

impl Manifest {
    /// A manifest of these files, written by this version of the program.
    pub(crate) fn new(kind: Kind, config: Value, files: &[&str], numbers: &[u32]) -> Manifest {
        let files = files.iter().map(|name| (*name).to_owned()).collect();
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Manifest { kind, version, config, files, frames: runs(numbers) }
    }

    /// The manifest of a folder; `None` if there is none. A link is none: it may lead anywhere.
    ///
    /// # Errors
    /// A manifest that cannot be read or understood.
    pub(crate) fn read(folder: &Path) -> Result<Option<Manifest>> {
        let path = folder.join(NAME);
        match std::fs::symlink_metadata(&path) {
            Ok(there) if there.is_file() => {}
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => {
                return Err(Error::io(&path, "read")(e));
            }
            _ => return Ok(None),
        }
        let text = std::fs::read_to_string(&path).map_err(Error::io(&path, "read"))?;
        let read = serde_json::from_str(&text);
        read.map(Some)
            .map_err(|_| Error::file(&path, "is no manifest that this version has written"))
    }

    /// Writes the manifest; it survives a power cut.
    pub(crate) fn write(&self, folder: &Path) -> Result<()> {
        let path = folder.join(NAME);
        let text = serde_json::to_string(self).map_err(|e| Error::file(&path, e.to_string()))?;
        atomic::write_lasting(&path, |sink| writeln!(sink, "{text}"))
    }

    /// Whether a name is one of those that it names, or of a file that a killed process was still writing.
    fn names(&self, name: &str) -> bool {
        let among = |n: u32| self.frames.iter().any(|&[first, last]| (first..=last).contains(&n));
        self.files.contains(name) || frame_number(name).is_some_and(among) || is_temporary(name)
    }

    /// Removes the files that it names and that `which` picks. Other people's files stay.
    pub(crate) fn remove(&self, folder: &Path, which: impl Fn(&str) -> bool) -> Result<()> {
        for name in entries(folder)? {
            if self.names(&name) && which(&name) {
                discard(&folder.join(&name))?;
            }
        }
        Ok(())
    }

    /// With the names of an earlier manifest as well.
    pub(crate) fn with_names_of(mut self, earlier: Manifest) -> Manifest {
        self.files.extend(earlier.files);
        self.frames.extend(earlier.frames);
        self.frames.sort_unstable();
        self.frames.dedup_by(|next, before| {
            let joins = next[0] <= before[1].saturating_add(1);
            before[1] = if joins { before[1].max(next[1]) } else { before[1] };
            joins
        });
        self
    }
}

/// The names in a folder.
pub(crate) fn entries(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder).map_err(Error::io(folder, "read"))?;
    let name = |entry: std::io::Result<std::fs::DirEntry>| {
        let entry = entry.map_err(Error::io(folder, "read"))?;
        Ok(entry.file_name().to_string_lossy().into_owned())
    };
    entries.map(name).collect()
}

/// Removes a file, a link (not what it leads to), or the unfinished folder of a killed process.
pub(crate) fn discard(path: &Path) -> Result<()> {
    let there = std::fs::symlink_metadata(path);
    let removed = match there {
        Ok(there) if !there.is_dir() => std::fs::remove_file(path),
        Ok(_) if path.file_name().is_some_and(|name| is_temporary(&name.to_string_lossy())) => {
            std::fs::remove_dir_all(path)
        }
        // A folder under a name of ours is somebody else's.
        _ => return Ok(()),
    };
    match removed {
        Err(refused) if refused.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io(path, "remove")(refused))
        }
        _ => Ok(()),
    }
}

/// Something that a process was still writing: these names are the program's own.
pub(crate) fn is_temporary(name: &str) -> bool {
    name.starts_with(".sungaze-") && name.contains(".tmp")
}

/// The number in `seen.0001.exr` and its like.
pub(crate) fn frame_number(name: &str) -> Option<u32> {
    let forms = [("seen.", ".exr"), ("display.", ".png"), ("state.", ".exr")];
    forms.iter().find_map(|(head, tail)| {
        let number = name.strip_prefix(head)?.strip_suffix(tail)?;
        number.bytes().all(|b| b.is_ascii_digit()).then(|| number.parse().ok())?
    })
}

/// First and last of each run of rising numbers.
fn runs(numbers: &[u32]) -> Vec<[u32; 2]> {
    let mut runs: Vec<[u32; 2]> = Vec::new();
    for &number in numbers {
        match runs.last_mut() {
            Some([_, last]) if last.checked_add(1) == Some(number) => *last = number,
            _ => runs.push([number, number]),
        }
    }
    runs
}

/// The first of some input files that lies in a folder, at any depth, links followed.
pub(crate) fn input_within<'a>(folder: &Path, inputs: &'a [PathBuf]) -> Option<&'a PathBuf> {
    let folder = folder.canonicalize().ok()?;
    inputs.iter().find(|input| input.canonicalize().is_ok_and(|input| input.starts_with(&folder)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_a_manifest_names_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let manifest = Manifest::new(Kind::Run, Value::Null, &["trace.csv"], &[1, 2, 3, 7]);
        let ours = ["seen.0002.exr", "display.0007.png", "trace.csv", ".sungaze-x.tmp"];
        let theirs =
            ["seen.0004.exr", "seen.backup.exr", "probes.csv", "display.0002.exr", ".sungaze"];
        ours.iter().chain(&theirs).for_each(|name| std::fs::write(at(name), "").unwrap());
        std::fs::create_dir(at("seen.0003.exr")).unwrap();
        manifest.remove(folder.path(), |_| true).unwrap();
        assert!(ours.iter().all(|name| !at(name).exists()));
        assert!(theirs.iter().all(|name| at(name).exists()));
        assert!(at("seen.0003.exr").is_dir(), "a folder of that name is not ours");
    }

    #[test]
    fn names_are_joined() {
        let of = |numbers: &[u32]| Manifest::new(Kind::Run, Value::Null, &[], numbers);
        let joined = of(&[1, 2, 3, 9, 20]).with_names_of(of(&[2, 4, 5, 10]));
        assert_eq!(joined.frames, [[1, 5], [9, 10], [20, 20]]);
    }

    #[cfg(unix)]
    #[test]
    fn a_link_is_removed_and_not_what_it_leads_to_and_a_linked_manifest_is_none() {
        let folder = tempfile::tempdir().unwrap();
        let (victim, out) = (folder.path().join("victim"), folder.path().join("out"));
        std::fs::create_dir(&out).unwrap();
        std::fs::write(&victim, "precious").unwrap();
        std::os::unix::fs::symlink(&victim, out.join("trace.csv")).unwrap();
        let manifest = Manifest::new(Kind::Run, Value::Null, &["trace.csv"], &[]);
        manifest.write(folder.path()).unwrap();
        std::os::unix::fs::symlink(folder.path().join(NAME), out.join(NAME)).unwrap();
        assert_eq!(Manifest::read(&out).unwrap(), None);
        assert_eq!(Manifest::read(folder.path()).unwrap().as_ref(), Some(&manifest));
        manifest.remove(&out, |_| true).unwrap();
        assert!(std::fs::symlink_metadata(out.join("trace.csv")).is_err());
        assert_eq!(std::fs::read_to_string(&victim).unwrap(), "precious");
    }
}
