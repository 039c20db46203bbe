//! What one case of a sweep reads at the end of a span: its probes, now and for ever.

use std::sync::Arc;

use crate::config::Config;
use crate::error::Result;
use crate::eye::Look;
use crate::light::Survey;
use crate::run::record::{Probe, Reading};
use crate::run::{Loaded, Moment, Scene, Watching, resolved};
use crate::sweep::pass::Span;
use crate::units::{Seconds, Trolands};

/// An eye that goes through one pass.
pub(super) struct CaseEye(Watching);

/// What was seen at the end of a span.
pub(super) struct Seen {
    pub(crate) look: Look,
    pub(crate) readings: Vec<Reading>,
    /// What the probes would read under this light for ever.
    pub(crate) steady: Vec<Reading>,
    /// What to say if the span is past the step length that the method is stable to.
    pub(crate) past_limit: Option<String>,
}

impl CaseEye {
    /// The eye of a case before its first frame.
    pub(super) fn new(config: &Config, scene: &Scene) -> Result<CaseEye> {
        Ok(CaseEye(Watching::new(config, scene, resolved(&config.settings))?))
    }

    /// Luminances of a frame as it is seen: with its veil, where that is drawn.
    pub(super) fn survey(mut self, loaded: &Loaded) -> Result<Arc<Survey>> {
        let aim = Moment { time: 0.0, frame: 0 };
        Ok(self.0.glance(loaded, aim)?.0.survey)
    }

    /// Looks at a frame for a span.
    pub(super) fn watch(&mut self, loaded: &Loaded, span: &Span) -> Result<Seen> {
        let duration = span.length();
        let (look, readings) = if duration == Seconds(0.0) {
            self.0.glance(loaded, span.aim())?
        } else {
            self.0.look(loaded, span.aim(), duration, None)
        };
        let steady = self.0.probes.iter().map(|probe| self.for_ever(loaded, &look, probe));
        let steady = steady.collect();
        let (eye, greatest) = (&self.0.eye, look.stats.greatest);
        let past = (duration > Seconds(0.0))
            .then(|| eye.model().past_limit(eye.pigments(), greatest, duration));
        let past_limit = past.flatten().map(|problem| format!("{} s: {problem}", span.end));
        Ok(Seen { look, readings, steady, past_limit })
    }

    /// What to say if the sampled check has found more than the budget.
    pub(super) fn beyond(&self, config: &Config) -> Option<String> {
        self.0.beyond(config.settings.numerics.budget)
    }

    /// What a probe would read if this light lasted.
    fn for_ever(&self, loaded: &Loaded, look: &Look, probe: &Probe) -> Reading {
        let (eye, planes) = (&self.0.eye, &loaded.frame.planes);
        let pixel = probe.pixel(planes, self.0.window, look.gaze);
        let light = eye.illuminance_at(planes, look, pixel);
        let p = [0, 1, 2].map(|k| eye.pigments()[k].steady(Trolands(light[k])));
        probe.reading(eye, planes, look, pixel, p)
    }
}
