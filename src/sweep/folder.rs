//! The sweep's folder: its manifest says which sweep it is, `case.0000` holds what one case left.
//!
//! A case is made in a folder of its own beside, and renamed when it is whole: `case.json`, in it, names the sweep
//! and the case's rows by digests. So any number of processes may work in one folder, at once or one after the
//! other, stop at any moment and begin again: finished cases are kept, and the others are done anew.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Deserializer, Serialize};
use serde_json::{Value, json};

use crate::config::{Config, Sweep};
use crate::error::{Error, Result};
use crate::frames::{self, atomic};
use crate::page;
use crate::run::manifest::{self, Kind, Manifest};
use crate::run::{self, Claim, Existing};

/// What is made of all cases.
pub(super) const TABLE: &str = "sweep.csv";
pub(super) const TYPED: &str = "sweep.json";
pub(super) const CONTACT: &str = "contact.png";
pub(super) const PLOT: &str = "sweep.svg";

/// What is made once of all cases.
const OF_ALL: [&str; 5] = [TABLE, TYPED, CONTACT, PLOT, page::REPORT];
/// What is made once of a case.
const OF_CASE: [&str; 4] = [manifest::NAME, "cells.csv", "cells.png", "case.json"];

/// A folder that holds one sweep, and the claim on it.
pub(super) struct Folder {
    pub(crate) path: PathBuf,
    /// Names the sweep.
    pub(crate) digest: String,
    _claim: Claim,
}

/// All that a finished case leaves for the sheet, the table and the plot: `case.json`, and beside it
/// rows and pictures.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Left {
    /// The sweep's, of which it is a case.
    pub(crate) digest: String,
    /// Names the rows.
    #[serde(rename = "rows")]
    pub(crate) rows_digest: String,
    /// Frames with samples that had to be mended, and numbers without a file.
    pub(crate) bad_frames: usize,
    /// Width and height of the sheet's pictures.
    pub(crate) size: [usize; 2],
    /// What to say if the sampled check found more than the budget.
    pub(crate) beyond: Option<String>,
    /// What to say of the first span past the limit of its method.
    pub(crate) past_limit: Option<String>,
    pub(crate) steady: Vec<Steady>,
    /// `cells.csv`: rows of the table, with its header.
    #[serde(skip)]
    pub(crate) rows: String,
    /// `cells.png`: the sheet's pictures, one below the other, 8-bit RGB.
    #[serde(skip)]
    pub(crate) pictures: Vec<u8>,
}

/// What a probe of a case would come to under its last light.
#[derive(Clone, Debug, Serialize, Deserialize)]
pub(super) struct Steady {
    #[serde(deserialize_with = "numbers")]
    pub(crate) bleached: [f64; 3],
    /// NaN where the percept is black.
    #[serde(deserialize_with = "numbers")]
    pub(crate) chromaticity: [f64; 2],
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

impl Folder {
    /// Makes a folder ready: empty, or holding the same sweep. With [`Existing::Overwrite`], what an earlier sweep
    /// left is removed: all of it, or one case. `inputs`: the files that the sweep reads.
    ///
    /// # Errors
    /// The folder is not the program's, holds an input or another sweep, or another process holds it.
    pub(super) fn prepare(
        path: &Path,
        existing: Existing,
        manifest: Manifest,
        inputs: &[PathBuf],
        only: Option<usize>,
    ) -> Result<Self> {
        let alone = existing == Existing::Overwrite && only.is_none();
        let claim = Claim::new(path, !alone)?;
        let digest = run::digest(manifest.config.to_string().as_bytes());
        let folder = Folder { path: path.to_owned(), digest, _claim: claim };
        let own = |name: &String| name == manifest::NAME || manifest::is_temporary(name);
        if !manifest::entries(path)?.iter().all(own) {
            let earlier = run::owned(path, Kind::Sweep, inputs)?;
            match only {
                _ if alone => folder.clear(&earlier)?,
                Some(case) if existing == Existing::Overwrite => clear(&folder.case(case))?,
                _ => run::same(path, &earlier.config, &manifest.config)?,
            }
        }
        folder.tidy()?;
        if Manifest::read(path)?.as_ref() != Some(&manifest) {
            manifest.write(path)?;
        }
        Ok(folder)
    }

    fn clear(&self, manifest: &Manifest) -> Result<()> {
        let entries = manifest::entries(&self.path)?;
        let cases = entries.iter().filter(|name| case_number(name).is_some());
        cases.map(|name| self.path.join(name)).try_for_each(|case| clear(&case))?;
        manifest.remove(&self.path, |_| true)
    }

    /// Removes what processes that were killed left beside, if no other process is at work.
    fn tidy(&self) -> Result<()> {
        let left: Vec<String> = manifest::entries(&self.path)?;
        let mut left = left.iter().filter(|name| manifest::is_temporary(name)).peekable();
        if left.peek().is_none() || !self._claim.try_hold(false) {
            return Ok(());
        }
        left.try_for_each(|name| manifest::discard(&self.path.join(name)))?;
        self._claim.try_hold(true);
        Ok(())
    }

    /// The folder of one case.
    pub(super) fn case(&self, number: usize) -> PathBuf {
        self.path.join(format!("case.{number:04}"))
    }

    /// Whether a case of this very sweep is finished, all of its files are there and its rows are whole.
    pub(super) fn is_finished(&self, number: usize) -> bool {
        self.done(number).is_some()
    }

    /// What a finished case left in `case.json`.
    fn done(&self, number: usize) -> Option<Left> {
        let text = std::fs::read_to_string(self.case(number).join("case.json")).ok()?;
        let done: Left = serde_json::from_str(&text).ok()?;
        let case = self.case(number);
        let rows = std::fs::read(case.join("cells.csv")).ok()?;
        let files = Manifest::read(&case).ok()??.files;
        let whole = files.iter().all(|name| case.join(name).is_file());
        let same = done.digest == self.digest && run::digest(&rows) == done.rows_digest;
        (whole && same).then_some(done)
    }

    /// A folder beside for a case that is begun; it goes away unless the case is finished.
    pub(super) fn begin(&self, number: usize) -> Result<tempfile::TempDir> {
        let prefix = format!(".sungaze-case.{number:04}-");
        let mut builder = tempfile::Builder::new();
        builder.prefix(&prefix).suffix(".tmp");
        #[cfg(unix)]
        builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o777));
        builder.tempdir_in(&self.path).map_err(Error::io(&self.path, "write into"))
    }

    /// Leaves what a case is known by, and gives its folder its name: from then on it is finished. Where another
    /// process has finished the same case meanwhile, its folder stays.
    pub(super) fn finish(
        &self,
        number: usize,
        beside: tempfile::TempDir,
        left: &Left,
    ) -> Result<()> {
        let (path, width) = (beside.path(), left.size[0]);
        atomic::write_text(&path.join("cells.csv"), &left.rows)?;
        let height = left.pictures.len() / (3 * width);
        frames::write_png(&path.join("cells.png"), width, height, &left.pictures)?;
        atomic::write_text(&path.join("case.json"), &format!("{}\n", json!(left)))?;
        let names = manifest::entries(path)?;
        let names: Vec<&str> = names.iter().map(String::as_str).chain(OF_CASE).collect();
        Manifest::new(Kind::Case, Value::Null, &names, &[]).write(path)?;
        atomic::sync_all(
            &manifest::entries(path)?.iter().map(|name| path.join(name)).collect::<Vec<_>>(),
        )?;
        let case = self.case(number);
        if !self.is_finished(number) {
            clear(&case)?;
        }
        match std::fs::rename(path, &case) {
            Err(_) if self.is_finished(number) => return Ok(()),
            Err(_) if case.exists() => {
                let problem = "holds something that no sweep has left: move it away";
                return Err(Error::file(case, problem));
            }
            renamed => renamed.map_err(Error::io(&case, "write"))?,
        }
        // What was renamed is not there to be removed.
        let _ = beside.keep();
        atomic::sync_folder(&self.path);
        Ok(())
    }

    /// Makes the page of all cases.
    pub(super) fn write_page(&self, sweep: &Sweep) -> Result<()> {
        let config = &sweep.cases[0].config;
        if !config.settings.output.page {
            return Ok(());
        }
        let report = json!({ "config": run::resolved(&config.settings), "version": env!("CARGO_PKG_VERSION") });
        let cases = page::of_sweep(&self.path, &sweep.keys)?;
        page::Report { title: &config.name, cases, report: &report }.write(&self.path)
    }

    /// What a finished case left.
    pub(super) fn left(&self, number: usize) -> Result<Left> {
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
        Ok(Left { rows, pictures, ..done })
    }
}

/// The manifest of a sweep. Its settings are everything that the files depend on, read back from text as those of an
/// earlier sweep are.
pub(super) fn manifest(config: &Config, sweep: &Sweep) -> Manifest {
    let mut settings = run::resolved(&config.settings);
    let lists = config.settings.sweep.iter().flat_map(|keys| &keys.vary);
    let vary: Vec<String> = lists.map(|vary| format!("{vary:?}")).collect();
    settings["sweep"] =
        json!({ "durations_s": sweep.durations, "pictures": sweep.pictures, "vary": vary });
    settings["version"] = env!("CARGO_PKG_VERSION").into();
    let settings = serde_json::from_str(&settings.to_string()).unwrap_or(settings);
    // A sheet that goes on has no more pages than there are cases.
    let pages: Vec<String> = (2..=sweep.cases.len()).map(|n| format!("contact.{n}.png")).collect();
    let files: Vec<&str> = OF_ALL.into_iter().chain(pages.iter().map(String::as_str)).collect();
    Manifest::new(Kind::Sweep, settings, &files, &[])
}

fn case_number(name: &str) -> Option<usize> {
    name.strip_prefix("case.")?.parse().ok()
}

/// Removes what a case left. Other people's files stay, and so does a folder that holds them.
fn clear(case: &Path) -> Result<()> {
    let is_folder = std::fs::symlink_metadata(case).is_ok_and(|there| there.is_dir());
    let Some(manifest) = is_folder.then(|| Manifest::read(case)).transpose()?.flatten() else {
        return Ok(());
    };
    manifest.remove(case, |name| name != manifest::NAME)?;
    manifest::discard(&case.join(manifest::NAME))?;
    // A folder that is not empty now holds something of the user's.
    let _ = std::fs::remove_dir(case);
    Ok(())
}
