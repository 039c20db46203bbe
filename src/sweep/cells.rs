//! The cells of a sweep, case by case.

use std::collections::BTreeSet;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;

use crate::config::settings::DisplayFile;
use crate::config::{Case, Sweep};
use crate::display::ToneMap;
use crate::error::{Error, Result};
use crate::eye::Look;
use crate::frames::area;
use crate::plot::marks::Marks;
use crate::run::report::Timing;
use crate::run::writer::Finished;
use crate::run::{self, Loaded, Watch};
use crate::units::Seconds;

use super::case::{Opened, Pass};
use super::folder::Folder;
use super::light::{self, Key};
use super::pass::Span;

/// The cells of a sweep that are being made.
pub(super) struct Cells<'a> {
    pub(super) sweep: &'a Sweep,
    pub(super) folder: &'a Folder,
    pub(super) watch: &'a dyn Watch,
    /// The square that a picture of the sheet must fit into, pixels.
    pub(super) side: usize,
    pub(super) done: AtomicUsize,
}

impl Cells<'_> {
    /// Runs cases: those that see one light together, one light after the other. Cases that need
    /// only little memory beside their light run side by side.
    pub(super) fn run(&self, pending: &[Opened]) -> Result<()> {
        if pending.is_empty() {
            return Ok(());
        }
        let notes: BTreeSet<&String> =
            pending.iter().flat_map(|opened| &opened.scene.footage.header().notes).collect();
        notes.into_iter().for_each(|note| self.watch.warn(note));
        let first = Opened::new(&self.sweep.cases[0], self.sweep)?;
        let mut held = (light::key(&first.case.config, &first.scene), self.lit(&first)?);
        // All cases show the same light by the same map, unless their displays differ.
        let survey = first.survey(&held.1)?;
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
        let mut pass = Pass::new(opened, first, self.sweep, self.side)?;
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
