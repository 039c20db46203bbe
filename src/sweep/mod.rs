//! A sweep: exposure durations times any lists of values, into a table, a contact sheet and a plot.
//!
//! All durations of a case share one pass through time, and all cases that see the same still share
//! its light. What a case leaves lies in its own folder; the sheet, the table and the plot are
//! always made from those folders. So the same files come out whether one process ran all cases, or
//! many ran one each, or one was killed half-way.

mod contact;
mod eye;
mod folder;
mod light;
mod pass;
mod plot;
mod table;
pub mod typed;

use std::collections::BTreeSet;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::colour::chromaticity;
use crate::config::settings::DisplayFile;
use crate::config::{Case, Config, Sweep};
use crate::display::ToneMap;
use crate::error::{Error, Result};
use crate::eye::Look;
use crate::frames::{area, atomic};
use crate::plot::marks::Marks;
use crate::run::record::Reading;
use crate::run::report::Timing;
use crate::run::writer::Finished;
use crate::run::{self, Existing, Loaded, Scene, Watch};
use crate::units::Seconds;

use eye::CaseEye;
use folder::{Done, Folder, Left, Steady};
use light::Key;
use pass::Span;

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
    let bad_frames: usize = left.iter().map(|case| case.done.bad_frames).sum();
    if bad_frames > 0 {
        watch.warn(&format!(
            "{bad_frames} bad frames were mended or held, counting those of every case"
        ));
    }
    if let Some(past_limit) = left.iter().find_map(|case| case.done.past_limit.as_ref()) {
        watch.warn(past_limit);
    }
    let beyond = left.iter().find_map(|case| case.done.beyond.as_ref());
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

/// A case whose frames have been found.
struct Opened<'a> {
    case: &'a Case,
    scene: Scene,
    spans: Vec<Span>,
}

impl<'a> Opened<'a> {
    fn new(case: &'a Case, sweep: &Sweep) -> Result<Self> {
        let open = || {
            let scene = Scene::open(&case.config)?;
            let spans = pass::spans(&case.config, &scene, &sweep.durations)?;
            Ok(Opened { case, scene, spans })
        };
        open().map_err(|error| case.located(error))
    }

    /// The files that it reads.
    fn inputs(&self) -> Vec<PathBuf> {
        self.scene.files.iter().cloned().chain(run::tables(&self.case.config)).collect()
    }

    fn first_file(&self) -> usize {
        self.spans.first().map_or(0, |span| span.file)
    }

    fn is_still(&self) -> bool {
        self.scene.footage.len() == 1
    }
}

/// The cells of a sweep that are being made.
struct Cells<'a> {
    sweep: &'a Sweep,
    folder: &'a Folder,
    watch: &'a dyn Watch,
    /// The square that a picture of the sheet must fit into, pixels.
    side: usize,
    done: AtomicUsize,
}

impl Cells<'_> {
    /// Runs cases: those that see one light together, one light after the other. Cases that need
    /// only little memory beside their light run side by side.
    fn run(&self, pending: &[Opened]) -> Result<()> {
        if pending.is_empty() {
            return Ok(());
        }
        let notes: BTreeSet<&String> =
            pending.iter().flat_map(|opened| &opened.scene.footage.header().notes).collect();
        notes.into_iter().for_each(|note| self.watch.warn(note));
        let first = Opened::new(&self.sweep.cases[0], self.sweep)?;
        let mut held = (light::key(&first.case.config, &first.scene), self.lit(&first)?);
        // All cases show the same light by the same map, unless their displays differ.
        let survey = CaseEye::new(&first.case.config, &first.scene)?.survey(&held.1)?;
        let cells = pending.len() * self.sweep.durations.len();
        for (key, group) in groups(pending) {
            if held.0 != key {
                drop(held);
                held = (key, self.lit(group[0])?);
            }
            let run = |opened: &&Opened| {
                let display = opened.case.config.display();
                let map = Arc::new(display.follow(None, &survey, Seconds(0.0)));
                self.case(opened, &held.1, &map, cells)
            };
            if !self.sweep.pictures && group[0].is_still() {
                group.par_iter().try_for_each(run)?;
            } else {
                group.iter().try_for_each(run)?;
            }
        }
        Ok(())
    }

    fn lit(&self, opened: &Opened) -> Result<Arc<Loaded>> {
        light::lit(&opened.scene, opened.first_file(), None)
    }

    /// One pass of one case, unless another process was quicker.
    fn case(
        &self,
        opened: &Opened,
        first: &Arc<Loaded>,
        map: &Arc<ToneMap>,
        cells: usize,
    ) -> Result<()> {
        let Opened { case, scene, spans } = opened;
        if self.folder.is_finished(case.number) {
            return Ok(());
        }
        let beside = self.folder.begin(case.number)?;
        let writer =
            run::writer(&case.config, scene, &run::resolved(&case.config.settings), beside.path())?;
        let mut pass = Pass::new(opened, first, self)?;
        let window = scene.footage.window();
        for span in spans {
            if self.watch.interrupted() {
                return Err(Error::Interrupted { resumable: true });
            }
            let Some((cell, look)) = pass.watch(span)? else { continue };
            let small = area::reduced(&window.of(&look.percept), pass.size);
            pass.pictures.extend(writer.picture(&small, map));
            if self.sweep.pictures {
                let cell = finished(case, cell, (span, look), map);
                writer.write(&cell, &mut Timing::default())?;
            }
            self.watch.frames(self.done.fetch_add(1, Ordering::Relaxed) + 1, cells);
        }
        self.folder.finish(case.number, beside, &pass.left(&self.folder.digest))
    }
}

/// A case on its way through time.
struct Pass<'a> {
    opened: &'a Opened<'a>,
    durations: &'a [f64],
    eye: CaseEye,
    /// The file that is looked at, and its light.
    file: usize,
    light: Arc<Loaded>,
    /// Of the pictures for the sheet.
    size: [usize; 2],
    rows: String,
    pictures: Vec<u8>,
    steady: Vec<Reading>,
    bad_frames: usize,
    past_limit: Option<String>,
}

impl<'a> Pass<'a> {
    fn new(opened: &'a Opened<'a>, first: &Arc<Loaded>, cells: &Cells<'a>) -> Result<Pass<'a>> {
        let mended = usize::from(first.frame.tally.non_finite() > 0);
        Ok(Pass {
            opened,
            durations: &cells.sweep.durations,
            eye: CaseEye::new(&opened.case.config, &opened.scene)?,
            file: opened.first_file(),
            light: first.clone(),
            size: area::size(opened.scene.footage.window().size, cells.side),
            rows: table::header(&cells.sweep.keys),
            pictures: Vec::new(),
            steady: Vec::new(),
            bad_frames: opened.scene.held.len() + mended,
            past_limit: None,
        })
    }

    /// Looks on for a span; the cell that it ends, if any, and its look.
    fn watch(&mut self, span: &Span) -> Result<Option<(usize, Look)>> {
        let Opened { case, scene, .. } = self.opened;
        if span.file != self.file {
            let places = self.light.places.to_vec();
            (self.file, self.light) = (span.file, light::lit(scene, span.file, Some(places))?);
            self.bad_frames += usize::from(self.light.frame.tally.non_finite() > 0);
        }
        let seen = self.eye.watch(&self.light, span)?;
        self.past_limit = self.past_limit.take().or(seen.past_limit);
        let Some(cell) = span.cell else { return Ok(None) };
        let (number, duration) = (case.number, self.durations[cell]);
        let at = table::Cell { case: number, duration, values: &case.values };
        self.rows += &table::rows(&at, &seen.readings, &seen.steady, &case.config.pigments());
        self.steady = seen.steady;
        Ok(Some((cell, seen.look)))
    }

    /// What it leaves in its folder.
    fn left(self, digest: &str) -> Left {
        let case = self.opened.case;
        let beyond = self.eye.beyond(&case.config);
        let steady = self.steady.iter().map(|reading| Steady {
            bleached: reading.p.map(|p| 1.0 - p),
            chromaticity: chromaticity(reading.xyz),
        });
        let done = Done {
            digest: digest.to_owned(),
            rows: run::digest(self.rows.as_bytes()),
            bad_frames: self.bad_frames,
            size: self.size,
            beyond: beyond.map(|words| format!("case {}: {words}", case.number)),
            past_limit: self.past_limit.map(|words| format!("case {}, {words}", case.number)),
            steady: steady.collect(),
        };
        Left { done, rows: self.rows, pictures: self.pictures }
    }
}

/// The pictures of a cell, numbered from 1 in the order of durations.
fn finished(case: &Case, cell: usize, (span, look): (&Span, Look), map: &Arc<ToneMap>) -> Finished {
    let output = &case.config.settings.output;
    let shown = output.display == DisplayFile::Png;
    let marks = Marks { gaze: look.gaze, time: span.end };
    Finished {
        name: format!("{:04}", cell + 1),
        pictured: true,
        file: span.file,
        seen: look.percept,
        map: shown.then(|| map.clone()),
        marks: output.marks.then_some(marks),
        state: None,
        trace: String::new(),
        probes: String::new(),
    }
}

/// Cases by the light that they see, in order of their first case.
fn groups<'a, 'b>(opened: &'b [Opened<'a>]) -> Vec<(Key, Vec<&'b Opened<'a>>)> {
    let mut groups: Vec<(Key, Vec<&Opened>)> = Vec::new();
    for one in opened {
        let key = light::key(&one.case.config, &one.scene);
        match groups.iter_mut().find(|group| group.0 == key) {
            Some(group) => group.1.push(one),
            None => groups.push((key, vec![one])),
        }
    }
    groups
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
