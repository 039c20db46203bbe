//! A case: its frames, and its way through time.

use std::path::PathBuf;
use std::sync::Arc;

use crate::colour::chromaticity;
use crate::config::{Case, Sweep};
use crate::error::Result;
use crate::eye::Look;
use crate::frames::area;
use crate::run::record::Reading;
use crate::run::{self, Loaded, Scene};

use super::eye::CaseEye;
use super::folder::{Done, Left, Steady};
use super::pass::{self, Span};
use super::{light, table};

/// A case whose frames have been found.
pub(super) struct Opened<'a> {
    pub(super) case: &'a Case,
    pub(super) scene: Scene,
    pub(super) spans: Vec<Span>,
}

impl<'a> Opened<'a> {
    pub(super) fn new(case: &'a Case, sweep: &Sweep) -> Result<Self> {
        let open = || {
            let scene = Scene::open(&case.config)?;
            let spans = pass::spans(&case.config, &scene, &sweep.durations)?;
            Ok(Opened { case, scene, spans })
        };
        open().map_err(|error| case.located(error))
    }

    /// The files that it reads.
    pub(super) fn inputs(&self) -> Vec<PathBuf> {
        self.scene.files.iter().cloned().chain(run::tables(&self.case.config)).collect()
    }

    pub(super) fn first_file(&self) -> usize {
        self.spans.first().map_or(0, |span| span.file)
    }

    pub(super) fn is_still(&self) -> bool {
        self.scene.footage.len() == 1
    }
}

/// A case on its way through time.
pub(super) struct Pass<'a> {
    opened: &'a Opened<'a>,
    durations: &'a [f64],
    eye: CaseEye,
    /// The file that is looked at, and its light.
    file: usize,
    light: Arc<Loaded>,
    /// Of the pictures for the sheet.
    pub(super) size: [usize; 2],
    rows: String,
    pub(super) pictures: Vec<u8>,
    steady: Vec<Reading>,
    bad_frames: usize,
    past_limit: Option<String>,
}

impl<'a> Pass<'a> {
    pub(super) fn new(
        opened: &'a Opened<'a>,
        first: &Arc<Loaded>,
        sweep: &'a Sweep,
        side: usize,
    ) -> Result<Pass<'a>> {
        let mended = usize::from(first.frame.tally.non_finite() > 0);
        Ok(Pass {
            opened,
            durations: &sweep.durations,
            eye: CaseEye::new(&opened.case.config, &opened.scene)?,
            file: opened.first_file(),
            light: first.clone(),
            size: area::size(opened.scene.footage.window().size, side),
            rows: table::header(&sweep.keys),
            pictures: Vec::new(),
            steady: Vec::new(),
            bad_frames: opened.scene.held.len() + mended,
            past_limit: None,
        })
    }

    /// Looks on for a span; the cell that it ends, if any, and its look.
    pub(super) fn watch(&mut self, span: &Span) -> Result<Option<(usize, Look)>> {
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
    pub(super) fn left(self, digest: &str) -> Left {
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
