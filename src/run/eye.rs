//! The middle stage of a run: an eye that watches a scene, and what is noted of each look.

use std::sync::Arc;
use std::time::Instant;

use serde_json::Value;

use crate::config::Config;
use crate::config::settings::{DisplayFile, StateKey};
use crate::display::{Display, ToneMap};
use crate::error::{Error, Result};
use crate::eye::pigment::Model;
use crate::eye::{self, Eye, Look, Stimulus};
use crate::light::{Planes, Samples, Window};
use crate::plot::marks::Marks;
use crate::run::checkpoint::{self, Checkpoint};
use crate::run::gaze::{Gaze, Moment};
use crate::run::inputs::{Input, digest_of_steps};
use crate::run::reader::Loaded;
use crate::run::record::{self, Probe, Reading};
use crate::run::report::{Counters, Timing};
use crate::run::scene::Scene;
use crate::run::schedule::Step;
use crate::run::writer::Finished;
use crate::units::Seconds;

/// An eye that watches a scene, with everything that a run carries from frame to frame.
pub(crate) struct Watching {
    pub(crate) eye: Eye,
    gaze: Gaze,
    /// The frames that have pictures, if not all.
    range: Option<Vec<u32>>,
    pub(crate) probes: Vec<Probe>,
    /// The display window among the pixels of a frame.
    pub(crate) window: Window,
    display: Option<Display>,
    /// Whether display pictures show the gaze and the time.
    marks: bool,
    map: Option<Arc<ToneMap>>,
    pub(crate) counters: Counters,
    state: StateKey,
    pub(crate) config: Value,
    pub(crate) done: usize,
    /// Spent so far, but for what the writer spends meanwhile.
    pub(crate) timing: Timing,
    begun: Instant,
    /// What was read so far.
    pub(crate) inputs: Vec<Input>,
}

impl Watching {
    pub(crate) fn new(config: &Config, scene: &Scene, resolved: Value) -> Result<Watching> {
        let shown = config.settings.output.display == DisplayFile::Png;
        let (mut eye, gaze) = (scene.eye(config)?, Gaze::of(config)?);
        if gaze.is_held() {
            eye.hold_gaze();
        }
        Ok(Watching {
            eye,
            gaze,
            range: scene.range.clone(),
            probes: record::probes(config),
            window: scene.footage.window(),
            display: shown.then(|| config.display()),
            marks: config.settings.output.marks,
            map: None,
            counters: Counters { held_frames: scene.held.clone(), ..Counters::default() },
            state: config.settings.output.state,
            config: resolved,
            done: 0,
            timing: Timing::default(),
            begun: Instant::now(),
            inputs: Vec::new(),
        })
    }

    /// Takes note of the next frame, unless its file is the one that was seen last.
    pub(crate) fn note(&mut self, steps: &[Step], loaded: &Loaded) {
        let step = &steps[self.done];
        if self.done > 0 && steps[self.done - 1].file == step.file {
            return;
        }
        self.counters.count(step.number, loaded.frame.tally);
        self.inputs.extend(loaded.input.clone());
        self.timing.decode_s += loaded.took_s;
    }

    /// Takes up what [`Watching::checkpoint`] gave.
    ///
    /// # Errors
    /// The checkpoint is of another eye or display.
    pub(crate) fn restore(&mut self, checkpoint: Checkpoint) -> Result<()> {
        let damaged = |problem: String| Error::file(checkpoint::NAME, problem);
        let Checkpoint { done, inputs, counters, timing, map, eye, .. } = checkpoint;
        self.eye.restore(eye).map_err(|e| damaged(e.to_string()))?;
        if let (Some(display), false) = (&self.display, map.is_empty()) {
            let map = display.restore(map).ok_or_else(|| damaged("holds no tone map".into()))?;
            self.map = Some(Arc::new(map));
        }
        (self.counters, self.done, self.inputs) = (counters, done, inputs);
        self.timing = timing;
        Ok(())
    }

    /// Everything that the next frame depends on.
    pub(crate) fn checkpoint(&self, steps: &[Step]) -> Checkpoint {
        Checkpoint {
            version: env!("CARGO_PKG_VERSION").into(),
            config: super::digest(self.config.to_string().as_bytes()),
            done: self.done,
            steps: digest_of_steps(&steps[..self.done]),
            inputs: self.inputs.clone(),
            counters: self.counters.clone(),
            timing: self.spent(),
            lengths: [0; 2],
            map: self.map.as_ref().map_or(Vec::new(), |map| map.levels().to_vec()),
            eye: self.eye.state(),
        }
    }

    /// The time spent until now.
    pub(crate) fn spent(&self) -> Timing {
        let wall_s = self.timing.wall_s + self.begun.elapsed().as_secs_f64();
        Timing { wall_s, ..self.timing }
    }

    /// The places of the sampled check: `None`: to be chosen on the first frame; none where a model
    /// was asked for that is not meant to be true.
    pub(crate) fn places_to_check(&self) -> Option<Vec<[usize; 2]>> {
        match (self.eye.check(), self.eye.model()) {
            (Some(check), _) => Some(check.places.clone()),
            (None, Model::Tracked { .. }) => None,
            _ => Some(Vec::new()),
        }
    }

    /// Looks at a frame over a span of time, and reads the probes. `aim`: the moment for which the
    /// gaze is asked.
    pub(crate) fn look(
        &mut self,
        loaded: &Loaded,
        aim: Moment,
        duration: Seconds,
        recycled: Option<Planes>,
    ) -> (Look, Vec<Reading>) {
        let planes = &loaded.frame.planes;
        let brightest = || eye::brightest(self.eye.vision(), planes, &loaded.survey);
        let gaze = self.gaze.pixel(aim, brightest, self.window, self.eye.first_gaze());
        if let Some(spare) = recycled {
            self.eye.recycle(spare);
        }
        let stimulus = Stimulus {
            planes,
            survey: &loaded.survey,
            checked: &loaded.places,
            spectra: loaded.kept.as_deref(),
            uniform: loaded.uniform.as_deref(),
        };
        let look = self.eye.look_at(stimulus, gaze, duration);
        let readings = self.probes.iter().map(|probe| {
            let pixel = probe.pixel(planes, self.window, look.gaze);
            probe.read(&self.eye, planes, &look, pixel)
        });
        let readings = readings.collect();
        (look, readings)
    }

    /// Looks at one frame and hands over what is to be written of it. `recycled`: a percept to be
    /// written over.
    pub(crate) fn see(
        &mut self,
        loaded: &Loaded,
        step: &Step,
        last: bool,
        recycled: Option<Planes>,
    ) -> Finished {
        let begun = Instant::now();
        let planes = &loaded.frame.planes;
        let size = [planes.width, planes.height];
        let duration = Seconds(step.duration());
        let aim = Moment { time: step.middle(), frame: step.number };
        let (look, readings) = self.look(loaded, aim, duration, recycled);
        self.meet(&look, step);
        let pictured = self.is_pictured(step);
        if let Some(display) = &self.display {
            let map = display.follow(self.map.as_deref(), &look.survey, duration);
            self.map = Some(Arc::new(map));
        }
        let finished = Finished {
            name: format!("{:04}", step.number),
            pictured,
            file: step.file,
            trace: record::trace_row(&self.eye, planes, self.window, &look, step),
            probes: record::probe_rows(&readings, step),
            map: self.map.clone(),
            marks: self.marks(&look, step.end),
            state: self.state_file(step, size, last, pictured),
            seen: look.percept,
        };
        self.done += 1;
        self.timing.simulate_s += begun.elapsed().as_secs_f64();
        finished
    }

    /// What is drawn into the display picture.
    fn marks(&self, look: &Look, time: f64) -> Option<Marks> {
        self.marks.then(|| Marks { gaze: self.window.in_window(look.gaze), time })
    }

    fn is_pictured(&self, step: &Step) -> bool {
        self.range.as_ref().is_none_or(|range| range.binary_search(&step.number).is_ok())
    }

    /// A look of no length, at what is seen before more has bleached; it leaves no trace.
    pub(crate) fn glance(&mut self, loaded: &Loaded, aim: Moment) -> Result<(Look, Vec<Reading>)> {
        let state = self.eye.state();
        let seen = self.look(loaded, aim, Seconds(0.0), None);
        self.eye.restore(state)?;
        Ok(seen)
    }

    /// What is seen before the first frame has bleached anything.
    pub(crate) fn at_the_start(&mut self, loaded: &Loaded, step: &Step) -> Result<Finished> {
        let begun = Instant::now();
        let aim = Moment { time: step.start, frame: step.number };
        let (look, _) = self.glance(loaded, aim)?;
        let map = self.display.as_ref();
        let map = map.map(|display| Arc::new(display.follow(None, &look.survey, Seconds(0.0))));
        self.timing.simulate_s += begun.elapsed().as_secs_f64();
        Ok(Finished {
            name: "start".into(),
            pictured: self.is_pictured(step),
            file: step.file,
            trace: String::new(),
            probes: String::new(),
            map,
            marks: self.marks(&look, step.start),
            state: None,
            seen: look.percept,
        })
    }

    fn state_file(
        &self,
        step: &Step,
        size: [usize; 2],
        last: bool,
        pictured: bool,
    ) -> Option<(Option<u32>, Planes, f64)> {
        let number = match self.state {
            StateKey::Every if pictured => Some(step.number),
            StateKey::Last if last => None,
            _ => return None,
        };
        let view = self.eye.retina().first_view(size[0], size[1]);
        let samples = Samples::Float(view.iter().map(|&p| p as f32).collect());
        Some((number, Planes { width: size[0], height: size[1], count: 3, samples }, step.end))
    }

    /// What to say if the sampled check of a planned run has found more than the budget.
    pub(crate) fn beyond(&self, budget: f64) -> Option<String> {
        self.eye.check().filter(|_| self.eye.plan().is_free())?.beyond(budget)
    }

    /// Takes note of what a look met.
    fn meet(&mut self, look: &Look, step: &Step) {
        let [width, height] = self.eye.retina().size();
        self.counters.meet(step.end, &look.stats, width * height);
        if self.counters.method_past_limit.is_none() {
            let (model, pigments) = (self.eye.model(), self.eye.pigments());
            let past = model.past_limit(pigments, look.stats.greatest, look.duration);
            self.counters.method_past_limit =
                past.map(|problem| format!("frame {}: {problem}", step.number));
        }
    }
}
