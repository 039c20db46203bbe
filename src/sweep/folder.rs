//! The sweep's folder: `sweep.json` says which sweep it is, `case.0000` what one case left.
//!
//! A case is finished when its `case.json` is there, which is written last and names the sweep and
//! the case's rows by digests. So any number of processes may work in one folder, stop at any
//! moment and begin again: finished cases are kept, and a half-done one is done anew. Half-written
//! files never appear (see [`atomic`]).

use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Value, json};

use crate::config::{Config, Sweep};
use crate::error::{Error, Result};
use crate::frames::{self, atomic};
use crate::page;
use crate::run::{self, Existing};

/// Which sweep a folder holds.
const SETTINGS: &str = "sweep.json";
/// What is made of all cases.
pub const TABLE: &str = "sweep.csv";
pub const CONTACT: &str = "contact.png";
pub const PLOT: &str = "sweep.svg";

/// A folder that holds one sweep.
pub struct Folder {
    pub path: PathBuf,
    /// Names the sweep.
    pub digest: String,
}

/// `case.json`: what the sheet and the plot need beside the pictures and rows.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Done {
    /// The sweep's, of which it is a case.
    pub digest: String,
    /// Names the rows that it left in `cells.csv`.
    pub rows: String,
    /// Frames with samples that had to be mended, and numbers without a file.
    pub bad_frames: usize,
    /// Width and height of the sheet's pictures.
    pub size: [usize; 2],
    /// What to say of the first span past the limit of its method.
    pub past_limit: Option<String>,
    pub steady: Vec<Steady>,
}

/// What a probe of a case would come to under its last light.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub struct Steady {
    #[serde(deserialize_with = "numbers")]
    pub bleached: [f64; 3],
    /// NaN where the percept is black.
    #[serde(deserialize_with = "numbers")]
    pub chromaticity: [f64; 2],
}

/// Numbers as JSON holds them, which writes those that are not finite as null.
fn numbers<'de, D: Deserializer<'de>, const N: usize>(
    from: D,
) -> std::result::Result<[f64; N], D::Error>
where
    [Option<f64>; N]: Deserialize<'de>,
{
    Ok(<[Option<f64>; N]>::deserialize(from)?.map(|number| number.unwrap_or(f64::NAN)))
}

/// All that a finished case left for the sheet, the table and the plot.
pub struct Left {
    pub done: Done,
    /// Rows of the table, with its header.
    pub rows: String,
    /// The sheet's pictures, one below the other, 8-bit RGB.
    pub pictures: Vec<u8>,
}

impl Folder {
    /// Makes a folder ready: empty, or holding the same sweep. With [`Existing::Overwrite`], what
    /// an earlier sweep left is removed: all of it, or one case.
    pub fn prepare(
        path: &Path,
        existing: Existing,
        config: &Config,
        sweep: &Sweep,
        only: Option<usize>,
    ) -> Result<Self> {
        std::fs::create_dir_all(path).map_err(Error::io(path, "create"))?;
        let settings = settings(config, sweep);
        let text = format!("{settings:#}\n");
        let folder = Folder { path: path.to_owned(), digest: run::digest(text.as_bytes()) };
        match (existing, only) {
            (Existing::Overwrite, Some(case)) => clear(&folder.case(case))?,
            (Existing::Overwrite, None) => folder.clear()?,
            _ => folder.held_to(&settings)?,
        }
        let there = std::fs::read_to_string(path.join(SETTINGS)).is_ok_and(|there| there == text);
        if !there {
            atomic::write_text(&path.join(SETTINGS), &text)?;
        }
        Ok(folder)
    }

    /// Refuses a folder that holds another sweep, or anything else.
    fn held_to(&self, settings: &Value) -> Result<()> {
        if let Ok(text) = std::fs::read_to_string(self.path.join(SETTINGS)) {
            let earlier = serde_json::from_str(&text).unwrap_or(Value::Null);
            return run::same(&self.path, &earlier, settings);
        }
        let foreign = names(&self.path)?
            .into_iter()
            .find(|name| !is_ours(name) && case_number(name).is_none());
        foreign.map_or(Ok(()), |name| {
            let problem =
                format!("holds {name:?} and no sweep: give another folder, or --overwrite to use it all the same");
            Err(Error::config("--out", self.path.display().to_string(), problem))
        })
    }

    fn clear(&self) -> Result<()> {
        for name in names(&self.path)? {
            if case_number(&name).is_some() {
                clear(&self.path.join(&name))?;
            } else if is_ours(&name) {
                remove(&self.path.join(&name))?;
            }
        }
        Ok(())
    }

    /// The folder of one case.
    pub fn case(&self, number: usize) -> PathBuf {
        self.path.join(format!("case.{number:04}"))
    }

    /// Whether a case of this very sweep is finished and its rows are whole.
    pub fn is_finished(&self, number: usize) -> bool {
        self.done(number).is_some()
    }

    fn done(&self, number: usize) -> Option<Done> {
        let text = std::fs::read_to_string(self.case(number).join("case.json")).ok()?;
        let done: Done =
            serde_json::from_str(&text).ok().filter(|done: &Done| done.digest == self.digest)?;
        let rows = std::fs::read(self.case(number).join("cells.csv")).ok()?;
        (run::digest(&rows) == done.rows).then_some(done)
    }

    /// Begins a case: its folder is there, without what a stopped process left in it.
    pub fn begin(&self, number: usize) -> Result<PathBuf> {
        let path = self.case(number);
        clear(&path)?;
        std::fs::create_dir_all(&path).map_err(Error::io(&path, "create"))?;
        Ok(path)
    }

    /// Makes the page of all cases.
    pub fn write_page(&self, sweep: &Sweep) -> Result<()> {
        let config = &sweep.cases[0].config;
        if !config.settings.output.page {
            return Ok(());
        }
        let report = json!({ "config": run::resolved(&config.settings), "version": env!("CARGO_PKG_VERSION") });
        let cases = page::of_sweep(&self.path, &sweep.keys)?;
        page::Report { title: &config.name, cases, report: &report }.write(&self.path)
    }

    /// Removes what processes that were stopped in the middle of a file left beside it.
    pub fn tidy(&self) -> Result<()> {
        let names = names(&self.path)?;
        names
            .iter()
            .filter(|name| is_temporary(name))
            .try_for_each(|name| remove(&self.path.join(name)))
    }

    /// Leaves what a case is known by; from then on it is finished.
    pub fn finish(&self, number: usize, left: &Left) -> Result<()> {
        let (path, width) = (self.case(number), left.done.size[0]);
        atomic::write_text(&path.join("cells.csv"), &left.rows)?;
        frames::write_png(
            &path.join("cells.png"),
            width,
            left.pictures.len() / (3 * width),
            &left.pictures,
        )?;
        atomic::write_text(&path.join("case.json"), &format!("{}\n", json!(left.done)))
    }

    /// What a finished case left.
    pub fn left(&self, number: usize) -> Result<Left> {
        let path = self.case(number);
        let damaged = |name: &str| {
            Error::file(path.join(name), "is damaged: remove the case's folder and run it again")
        };
        let done = self.done(number).ok_or_else(|| damaged("case.json"))?;
        let read =
            |name: &str| std::fs::read(path.join(name)).map_err(Error::io(path.join(name), "read"));
        let rows = String::from_utf8(read("cells.csv")?).map_err(|_| damaged("cells.csv"))?;
        let (width, height, pictures) =
            frames::decode_png(&read("cells.png")?).ok_or_else(|| damaged("cells.png"))?;
        if width != done.size[0] || height % done.size[1].max(1) != 0 {
            return Err(damaged("cells.png"));
        }
        Ok(Left { done, rows, pictures })
    }
}

/// Everything that the sweep's files depend on. Read back from text, as an earlier sweep's is.
fn settings(config: &Config, sweep: &Sweep) -> Value {
    let mut settings = run::resolved(&config.settings);
    let lists = config.settings.sweep.iter().flat_map(|keys| &keys.vary);
    let vary: Vec<String> =
        lists.map(|vary| format!("{} = {}", vary.key, toml_list(&vary.values))).collect();
    settings["sweep"] =
        json!({ "durations_s": sweep.durations, "pictures": sweep.pictures, "vary": vary });
    settings["version"] = env!("CARGO_PKG_VERSION").into();
    serde_json::from_str(&settings.to_string()).unwrap_or(settings)
}

fn toml_list(values: &[impl std::fmt::Display]) -> String {
    let values: Vec<String> = values.iter().map(ToString::to_string).collect();
    format!("[{}]", values.join(", "))
}

fn names(folder: &Path) -> Result<Vec<String>> {
    let entries = std::fs::read_dir(folder).map_err(Error::io(folder, "read"))?;
    entries
        .map(|entry| {
            Ok(entry.map_err(Error::io(folder, "read"))?.file_name().to_string_lossy().into_owned())
        })
        .collect()
}

fn case_number(name: &str) -> Option<usize> {
    name.strip_prefix("case.")?.parse().ok()
}

/// Files of the sweep's folder, or of a case's, that a sweep writes.
fn is_ours(name: &str) -> bool {
    let fixed =
        [SETTINGS, TABLE, CONTACT, PLOT, page::REPORT, "cells.csv", "cells.png", "case.json"];
    let begins = |head: &str, tail: &str| name.starts_with(head) && name.ends_with(tail);
    fixed.contains(&name)
        || begins("contact.", ".png")
        || begins("seen.", ".exr")
        || begins("display.", ".png")
        || is_temporary(name)
}

fn is_temporary(name: &str) -> bool {
    name.starts_with(".sungaze-") && name.ends_with(".tmp")
}

/// Removes what a case left. Other people's files stay, and so does a folder that holds them.
fn clear(case: &Path) -> Result<()> {
    if !case.is_dir() {
        return Ok(());
    }
    names(case)?
        .iter()
        .filter(|name| is_ours(name))
        .try_for_each(|name| remove(&case.join(name)))?;
    // A folder that is not empty now holds something of the user's.
    let _ = std::fs::remove_dir(case);
    Ok(())
}

fn remove(path: &Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(refused) if refused.kind() != std::io::ErrorKind::NotFound => {
            Err(Error::io(path, "remove")(refused))
        }
        _ => Ok(()),
    }
}
