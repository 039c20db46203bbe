//! What one case of a sweep reads at the end of a span: its probes, now and for ever.

use crate::config::Config;
use crate::error::Result;
use crate::eye::Look;
use crate::run::record::{Probe, Reading};
use crate::run::{Loaded, Scene, Watching, resolved};
use crate::sweep::pass::Span;
use crate::units::{Seconds, Trolands};

/// An eye that goes through one pass.
pub struct CaseEye(Watching);

/// What was seen at the end of a span.
pub struct Seen {
    pub look: Look,
    pub readings: Vec<Reading>,
    /// What the probes would read under this light for ever.
    pub steady: Vec<Reading>,
    /// What to say if the span is past the step length that the method is stable to.
    pub past_limit: Option<String>,
}

impl CaseEye {
    /// The eye of a case before its first frame.
    pub fn new(config: &Config, scene: &Scene) -> Result<CaseEye> {
        Ok(CaseEye(Watching::new(config, scene, resolved(&config.settings))?))
    }

    /// Looks at a frame for a span.
    pub fn watch(&mut self, loaded: &Loaded, span: &Span) -> Seen {
        let duration = span.length();
        let (look, readings) = self.0.look(loaded, span.aim, duration, None);
        let steady = self.0.probes.iter().map(|probe| self.for_ever(loaded, &look, probe));
        let steady = steady.collect();
        let (eye, greatest) = (&self.0.eye, look.stats.greatest);
        let past = (duration > Seconds(0.0))
            .then(|| eye.model().past_limit(eye.pigments(), greatest, duration));
        let past_limit = past.flatten().map(|problem| format!("{} s: {problem}", span.end));
        Seen { look, readings, steady, past_limit }
    }

    /// What a probe would read if this light lasted.
    fn for_ever(&self, loaded: &Loaded, look: &Look, probe: &Probe) -> Reading {
        let (eye, planes) = (&self.0.eye, &loaded.frame.planes);
        let pixel = probe.pixel([planes.width, planes.height], look.gaze);
        let illuminance = eye.illuminance_at(planes, look, pixel);
        let p = [0, 1, 2].map(|k| eye.pigments()[k].steady(Trolands(illuminance[k])));
        let vision = eye.vision();
        let catch = vision.catch(&vision.moments(planes, pixel[0], pixel[1]), p);
        Reading { probe: probe.name.clone(), illuminance, p, xyz: vision.xyz(catch) }
    }
}
