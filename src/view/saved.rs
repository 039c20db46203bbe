//! A saved viewing: a folder `view.0001` with `view.0001.toml` and `gaze.csv`, which `sungaze run` replays to the very pictures that
//! were shown, bit for bit.

use std::path::{Path, PathBuf};

use super::live::{Live, Moment};
use crate::config::Config;
use crate::error::{Error, Result};
use crate::frames::atomic;

/// The path of a saved viewing.
const PATH: &str = "gaze.csv";
/// The most viewings in one folder.
const MOST: usize = 9999;

/// Saves a path as it has been lived so far, in a folder of its own within `out`. Nothing that is there is touched.
///
/// # Errors
/// The system's refusals; nothing has been lived yet.
pub fn save(live: &Live, out: &Path) -> Result<String> {
    if live.path().is_empty() {
        return Err(Error::config("save", "path", "nothing has been looked at yet"));
    }
    let text = live.viewing(PATH)?;
    std::fs::create_dir_all(out).map_err(Error::io(out, "create"))?;
    let name = free_name(out)?;
    let folder = out.join(&name);
    atomic::write_text(&folder.join(PATH), &rows(live.path()))?;
    atomic::write_text(&configuration(out, &name), &text)?;
    Ok(name)
}

/// Where the configuration of a viewing is. It has the viewing's name, as what is run of it will.
fn configuration(out: &Path, name: &str) -> PathBuf {
    out.join(name).join(format!("{name}.toml"))
}

/// Makes the next folder.
fn free_name(out: &Path) -> Result<String> {
    for number in 1..=MOST {
        let name = format!("view.{number:04}");
        match std::fs::create_dir(out.join(&name)) {
            Err(refused) if refused.kind() == std::io::ErrorKind::AlreadyExists => {}
            made => return made.map(|()| name).map_err(Error::io(out, "write into")),
        }
    }
    Err(Error::file(out, format!("holds {MOST} viewings already")))
}

/// Rows of `time_s,x,y`: every number comes back as it was.
fn rows(path: &[Moment]) -> String {
    let row = |Moment { end, gaze: [x, y], .. }: &Moment| format!("{end},{x},{y}\n");
    std::iter::once("time_s,x,y\n".to_owned()).chain(path.iter().map(row)).collect()
}

/// The names of the viewings in a folder.
pub(crate) fn names(out: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(out).into_iter().flatten().flatten();
    let named = entries.map(|entry| entry.file_name().to_string_lossy().into_owned());
    let mut names: Vec<String> = named.filter(|name| is_viewing(out, name)).collect();
    names.sort();
    names
}

fn is_viewing(out: &Path, name: &str) -> bool {
    let number = name.strip_prefix("view.").unwrap_or_default();
    number.len() == 4
        && number.bytes().all(|b| b.is_ascii_digit())
        && configuration(out, name).is_file()
}

/// The configuration of a viewing, by its name.
///
/// # Errors
/// A name of nothing that was saved; a file that is no configuration.
pub(crate) fn open(out: &Path, name: &str) -> Result<Config> {
    if !is_viewing(out, name) {
        return Err(Error::config("open", name, "is no saved viewing"));
    }
    Config::load(Some(&configuration(out, name)), &[])
}
