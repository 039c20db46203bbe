//! A case: its frames, and its way through time.

use std::path::PathBuf;
use std::sync::Arc;

use crate::colour::chromaticity;
use crate::config::{Case, Sweep};
use crate::error::Result;
use crate::eye::Look;
use crate::frames::area;
use crate::light::Survey;
use crate::run::record::{Probe, Reading};
use crate::run::{self, Loaded, Moment, Scene, Watching};
use crate::units::{Seconds, Trolands};

use super::folder::{Left, Steady};
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

    /// Its eye before the first frame.
    fn eye(&self) -> Result<Watching> {
        let config = &self.case.config;
        Watching::new(config, &self.scene, run::resolved(&config.settings))
    }

    /// Luminances of a frame as it is seen: with its veil, where that is drawn.
    pub(super) fn survey(&self, loaded: &Loaded) -> Result<Arc<Survey>> {
        let aim = Moment { time: 0.0, frame: 0 };
        Ok(self.eye()?.glance(loaded, aim)?.0.survey)
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
    eye: Watching,
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
            eye: opened.eye()?,
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
        let duration = span.length();
        let (look, readings) = if duration == Seconds(0.0) {
            self.eye.glance(&self.light, span.aim())?
        } else {
            self.eye.look(&self.light, span.aim(), duration, None)
        };
        self.past_limit = self.past_limit.take().or_else(|| self.past_limit_of(span, &look));
        let Some(cell) = span.cell else { return Ok(None) };
        self.steady = self.eye.probes.iter().map(|probe| self.for_ever(&look, probe)).collect();
        self.rows += &table::rows(case, self.durations[cell], &readings, &self.steady);
        Ok(Some((cell, look)))
    }

    /// What to say if the span is past the step length that the method is stable to.
    fn past_limit_of(&self, span: &Span, look: &Look) -> Option<String> {
        let (eye, duration) = (&self.eye.eye, span.length());
        let past = (duration > Seconds(0.0))
            .then(|| eye.model().past_limit(eye.pigments(), look.stats.greatest, duration));
        past.flatten().map(|problem| format!("{} s: {problem}", span.end))
    }

    /// What a probe would read if this light lasted.
    fn for_ever(&self, look: &Look, probe: &Probe) -> Reading {
        let (eye, planes) = (&self.eye.eye, &self.light.frame.planes);
        let pixel = probe.pixel(planes, self.eye.window, look.gaze);
        let light = eye.illuminance_at(planes, look, pixel);
        let p = [0, 1, 2].map(|k| eye.pigments()[k].steady(Trolands(light[k])));
        probe.reading(eye, planes, look, pixel, p)
    }

    /// What it leaves in its folder.
    pub(super) fn left(self, digest: &str) -> Left {
        let case = self.opened.case;
        let beyond = self.eye.beyond(case.config.settings.numerics.budget);
        let steady = self.steady.iter().map(|reading| Steady {
            bleached: reading.p.map(|p| 1.0 - p),
            chromaticity: chromaticity(reading.xyz),
        });
        Left {
            digest: digest.to_owned(),
            rows_digest: run::digest(self.rows.as_bytes()),
            bad_frames: self.bad_frames,
            size: self.size,
            beyond: beyond.map(|words| format!("case {}: {words}", case.number)),
            past_limit: self.past_limit.map(|words| format!("case {}, {words}", case.number)),
            steady: steady.collect(),
            rows: self.rows,
            pictures: self.pictures,
        }
    }
}
