//! A sweep: exposure durations times any lists of values, into a table, a contact sheet and a plot.
//!
//! All durations of a case share one pass through time, and all cases that see the same still share
//! its light. What a case leaves lies in its own folder; the sheet, the table and the plot are
//! always made from those folders. So the same files come out whether one process ran all cases, or
//! many ran one each, or one was killed half-way.

mod case;
mod cells;
mod contact;
mod folder;
mod light;
mod pass;
mod plot;
mod table;
pub mod typed;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicUsize;

use crate::config::{Case, Config, Sweep};
use crate::error::{Error, Result};
use crate::frames::atomic;
use crate::run::{self, Existing, Watch};

use case::Opened;
use cells::Cells;
use folder::{Folder, Left};

/// Which part of a sweep to do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// Every case that is not finished, then the files made of all.
    All,
    /// One case.
    Index(usize),
    /// The files made of all cases, which must be finished.
    Merge,
}

/// What a sweep left.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// Cases that were run now.
    pub ran: usize,
    /// Cases that were finished already.
    pub kept: usize,
    /// Some frames were bad and a policy let the sweep go on (exit code 3).
    pub went_on: bool,
    /// `sweep.csv`, unless only one case was run.
    pub table: Option<PathBuf>,
}

/// Runs a sweep, or a part of it, into a folder.
pub fn sweep(
    config: &Config,
    path: &Path,
    existing: Existing,
    part: Part,
    watch: &dyn Watch,
) -> Result<Outcome> {
    let sweep = config.sweep()?;
    let asked = asked(&sweep, part)?;
    let opened = asked.iter().map(|case| Opened::new(case, &sweep)).collect::<Result<Vec<_>>>()?;
    let only = (part != Part::All).then(|| asked.first().map_or(usize::MAX, |case| case.number));
    let inputs: BTreeSet<PathBuf> = opened.iter().flat_map(Opened::inputs).collect();
    let inputs: Vec<PathBuf> = inputs.into_iter().collect();
    let manifest = folder::manifest(config, &sweep);
    let folder = Folder::prepare(path, existing, manifest, &inputs, only)?;
    let (kept, pending): (Vec<_>, Vec<_>) =
        opened.into_iter().partition(|opened| folder.is_finished(opened.case.number));
    let cells = Cells {
        sweep: &sweep,
        folder: &folder,
        watch,
        side: contact::side(&sweep),
        done: AtomicUsize::new(0),
    };
    cells.run(&pending)?;
    let numbers =
        if let Part::Index(number) = part { number..number + 1 } else { 0..sweep.cases.len() };
    let left = finished_cases(&folder, numbers)?;
    let table =
        if let Part::Index(_) = part { None } else { Some(gather(&sweep, &folder, &left)?) };
    let went_on = warned(&left, watch);
    Ok(Outcome { ran: pending.len(), kept: kept.len(), went_on, table })
}

/// Tells what was wrong in some cases; whether it makes the sweep one that went on all the same.
fn warned(left: &[Left], watch: &dyn Watch) -> bool {
    let bad_frames: usize = left.iter().map(|case| case.bad_frames).sum();
    if bad_frames > 0 {
        watch.warn(&format!(
            "{bad_frames} bad frames were mended or held, counting those of every case"
        ));
    }
    if let Some(past_limit) = left.iter().find_map(|case| case.past_limit.as_ref()) {
        watch.warn(past_limit);
    }
    let beyond = left.iter().find_map(|case| case.beyond.as_ref());
    if let Some(beyond) = beyond {
        watch.warn(beyond);
    }
    bad_frames > 0 || beyond.is_some()
}

/// The cases that a part of a sweep runs.
fn asked(sweep: &Sweep, part: Part) -> Result<Vec<&Case>> {
    match part {
        Part::All => Ok(sweep.cases.iter().collect()),
        Part::Merge => Ok(Vec::new()),
        Part::Index(number) => sweep.cases.get(number).map(|case| vec![case]).ok_or_else(|| {
            let last = sweep.cases.len() - 1;
            Error::config(
                "--index",
                number.to_string(),
                format!("the sweep has the cases 0 to {last}"),
            )
        }),
    }
}

/// What cases left; all of them must be finished.
fn finished_cases(folder: &Folder, numbers: Range<usize>) -> Result<Vec<Left>> {
    let missing: Vec<String> = numbers
        .clone()
        .filter(|&number| !folder.is_finished(number))
        .map(|number| number.to_string())
        .collect();
    if !missing.is_empty() {
        let (count, first) = (missing.len(), &missing[..missing.len().min(10)]);
        let problem = format!(
            "{count} of {} cases are not finished: run --index {}",
            numbers.len(),
            first.join(", ")
        );
        return Err(Error::file(&folder.path, problem));
    }
    numbers.map(|number| folder.left(number)).collect()
}

/// Makes the table, the sheet and the plot of all cases; returns where the table is.
fn gather(sweep: &Sweep, folder: &Folder, left: &[Left]) -> Result<PathBuf> {
    let mut all = table::header(&sweep.keys);
    for case in left {
        all.extend(case.rows.split_inclusive('\n').skip(1));
    }
    let table = folder.path.join(folder::TABLE);
    let comment = sweep.cases.first().map(|case| run::report::law_line(&case.config));
    atomic::write_text(&table, &(comment.unwrap_or_default() + &all))?;
    let typed = typed::rows(&table)?;
    atomic::write_text(&folder.path.join(folder::TYPED), &format!("{typed:#}\n"))?;
    contact::write(&folder.path.join(folder::CONTACT), sweep, left)?;
    plot::write(&folder.path.join(folder::PLOT), sweep, left)?;
    folder.write_page(sweep)?;
    Ok(table)
}
