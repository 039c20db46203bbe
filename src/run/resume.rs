//! The start of a run: afresh, or from what an earlier one left, which is first held against the
//! settings, frames and files that are there now. A refusal leaves everything as it was.

use std::path::{Path, PathBuf};

use serde_json::Value;

use super::{Scene, Watching, digest, resolved, video};
use crate::config::Config;
use crate::config::settings::{DisplayFile, SeenKey, StateKey};
use crate::error::{Error, Result};
use crate::page;
use crate::run::checkpoint::{self, Checkpoint};
use crate::run::folder::{self, Existing};
use crate::run::inputs::{self, Input};
use crate::run::manifest::{self, Kind, Manifest};
use crate::run::schedule::Step;
use crate::run::watch::Watch;

/// What a run begins with.
pub(super) enum Start {
    Fresh,
    /// From a checkpoint that the eye has taken up, with tables of these lengths.
    From([u64; 2]),
    /// A complete run of the same settings and files: its report.
    Complete(Value),
}

/// Files that a run makes once.
const ONCE: [&str; 9] = [
    "seen.start.exr",
    "display.start.png",
    "trace.csv",
    "probes.csv",
    "probes.svg",
    "report.json",
    page::REPORT,
    "state.exr",
    checkpoint::NAME,
];

/// Makes a claimed folder ready for a run.
///
/// # Errors
/// The folder holds something and there is no leave to touch it, it is not the program's, it holds
/// an input, or something that the run would go on from has changed.
pub(super) fn start(
    config: &Config,
    scene: &Scene,
    eye: &mut Watching,
    folder: &Path,
    existing: Existing,
    watch: &dyn Watch,
) -> Result<Start> {
    let own = |name: &String| *name == manifest::NAME || manifest::is_temporary(name);
    if manifest::entries(folder)?.iter().all(own) {
        return begin(folder, config, scene);
    }
    let tables = inputs::tables(config);
    let read: Vec<PathBuf> = scene.files.iter().chain(&tables).cloned().collect();
    let earlier = folder::owned(folder, Kind::Run, &read)?;
    if existing == Existing::Refuse {
        return Err(folder::not_empty(folder));
    }
    if existing == Existing::Resume {
        folder::same(folder, &earlier.config, &resolved(&config.settings))?;
        let past = Past { config, scene, folder, tables: &tables };
        if let Some(checkpoint) = Checkpoint::read(folder)? {
            past.holds(&checkpoint)?;
            let lengths = checkpoint.lengths;
            eye.restore(checkpoint)?;
            past.drop_later(eye.done, earlier)?;
            return Ok(Start::From(lengths));
        }
        if let Some(report) = report(folder) {
            match past.news(&report)? {
                None => return Ok(Start::Complete(report)),
                Some(number) => watch.warn(&format!(
                    "frame {number} is new since the run was complete: it begins again"
                )),
            }
        }
    }
    earlier.remove(folder, |_| true)?;
    begin(folder, config, scene)
}

fn report(folder: &Path) -> Option<Value> {
    serde_json::from_str(&std::fs::read_to_string(folder.join("report.json")).ok()?).ok()
}

/// Starts afresh: all that the run will make is named before it is made.
fn begin(folder: &Path, config: &Config, scene: &Scene) -> Result<Start> {
    let manifest = manifest(config, scene);
    manifest.remove(folder, manifest::is_temporary)?;
    manifest.write(folder).map(|()| Start::Fresh)
}

fn manifest(config: &Config, scene: &Scene) -> Manifest {
    let video = config.settings.output.video.as_str();
    let numbers: Vec<u32> = scene.pictured().iter().map(|step| step.number).collect();
    let files = [&ONCE[..], &[video, video::LIST]].concat();
    Manifest::new(Kind::Run, resolved(&config.settings), &files, &numbers)
}

/// What there is now, for an earlier run to be held against.
struct Past<'a> {
    config: &'a Config,
    scene: &'a Scene,
    folder: &'a Path,
    tables: &'a [PathBuf],
}

impl Past<'_> {
    /// Refuses a checkpoint whose frames, files or results are not there as they were.
    fn holds(&self, checkpoint: &Checkpoint) -> Result<()> {
        let Checkpoint { config, done, steps, inputs: read, .. } = checkpoint;
        if *config != digest(resolved(&self.config.settings).to_string().as_bytes()) {
            return Err(self.refused(format!("{} is of another run", checkpoint::NAME)));
        }
        self.unchanged(read)?;
        if self.scene.steps.len() <= *done {
            return Err(self.refused("the frames still to come are not there any more".into()));
        }
        let done = self.scene.steps.get(..*done).filter(|done| !done.is_empty());
        let same = done.filter(|done| inputs::digest_of_steps(done) == *steps);
        let Some(done) = same else {
            let problem = match self.newcomer(read, done.unwrap_or_default()) {
                Some(number) => format!("frame {number} is new among those already done"),
                None => "the frames already done are not those of the sequence any more".into(),
            };
            return Err(self.refused(problem));
        };
        self.outputs(done, &[])
    }

    /// What a run leaves when it is complete.
    fn last_files(&self) -> Vec<&'static str> {
        let output = &self.config.settings.output;
        let made = [
            (true, "trace.csv"),
            (true, "probes.csv"),
            (true, "probes.svg"),
            (output.page, page::REPORT),
            (output.state == StateKey::Last, "state.exr"),
        ];
        made.into_iter().filter(|made| made.0).map(|made| made.1).collect()
    }

    /// Drops what came after the checkpoint, and names what will come.
    fn drop_later(&self, done: usize, earlier: Manifest) -> Result<()> {
        let done = &self.scene.steps[..done];
        let is_done = |n| done.binary_search_by_key(&n, |step| step.number).is_ok();
        earlier.remove(self.folder, |name| {
            let number = manifest::frame_number(name);
            manifest::is_temporary(name) || number.is_some_and(|number| !is_done(number))
        })?;
        manifest(self.config, self.scene).with_names_of(earlier).write(self.folder)
    }

    /// The first frame that has come since a run was complete.
    fn news(&self, report: &Value) -> Result<Option<u32>> {
        let read: Vec<Input> = serde_json::from_value(report["inputs"].clone()).unwrap_or_default();
        self.unchanged(&read)?;
        let steps = &self.scene.steps;
        let news = self.newcomer(&read, steps);
        if news.is_none() {
            self.outputs(steps, &self.last_files())?;
        }
        Ok(news)
    }

    fn unchanged(&self, read: &[Input]) -> Result<()> {
        inputs::unchanged(read, self.tables, &self.scene.steps, &self.scene.files)
    }

    fn newcomer(&self, read: &[Input], steps: &[Step]) -> Option<u32> {
        let several = self.scene.files.len() > 1;
        several.then(|| inputs::newcomer(read, steps, &self.scene.held))?
    }

    /// Refuses a folder that has lost pictures of frames that are done, or `others`.
    fn outputs(&self, done: &[Step], others: &[&str]) -> Result<()> {
        let output = &self.config.settings.output;
        let kinds = [
            (output.seen == SeenKey::Exr, "seen", "exr"),
            (output.display == DisplayFile::Png, "display", "png"),
            (output.state == StateKey::Every, "state", "exr"),
        ];
        let kinds = kinds.iter().filter(|kind| kind.0);
        let range = self.scene.range.as_ref();
        let pictured =
            |step: &&Step| range.is_none_or(|range| range.binary_search(&step.number).is_ok());
        let names = kinds.flat_map(|(_, head, tail)| {
            let done = done.iter().filter(pictured);
            done.map(move |step| format!("{head}.{:04}.{tail}", step.number))
        });
        let start = [
            (output.seen == SeenKey::Exr, "seen.start.exr"),
            (output.display == DisplayFile::Png, "display.start.png"),
        ];
        let is_pictured = done.first().is_some_and(|first| pictured(&first));
        let start = start.into_iter().filter(|start| start.0 && is_pictured).map(|start| start.1);
        let others = start.chain(others.iter().copied()).map(str::to_owned);
        match names.chain(others).find(|name| !self.folder.join(name).is_file()) {
            None => Ok(()),
            Some(name) => Err(self.refused(format!("{name} has been removed since"))),
        }
    }

    fn refused(&self, problem: String) -> Error {
        let problem = format!("{problem}: put it back, or start again with --overwrite");
        Error::config("--resume", self.folder.display().to_string(), problem)
    }
}
