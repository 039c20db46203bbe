//! The middle stage of a run: the eye, with everything it carries from frame to frame.

use std::sync::Arc;
use std::time::{Duration, Instant};

use ndarray::Array3;
use serde_json::Value;

use crate::config::Config;
use crate::config::settings::{DisplayFile, StateKey};
use crate::display::{Display, ToneMap};
use crate::error::{Error, Result};
use crate::eye::check::Check;
use crate::eye::plan::Plan;
use crate::eye::retina::{Model, Retina};
use crate::eye::{Look, Viewer};
use crate::frames;
use crate::light::{Planes, Samples};
use crate::run::checkpoint::{self, Checkpoint, Head};
use crate::run::gaze::Gaze;
use crate::run::reader::Loaded;
use crate::run::record::{self, Probe, Reading};
use crate::run::report::Counters;
use crate::run::scene::Scene;
use crate::run::schedule::Step;
use crate::run::writer::Finished;
use crate::units::{Nits, Seconds};

/// The eye between the two other stages, with everything it carries from frame to frame.
pub(super) struct Eye {
    pub viewer: Viewer,
    pub gaze: Gaze,
    pub probes: Vec<Probe>,
    pub display: Option<Display>,
    pub map: Option<Arc<ToneMap>>,
    pub counters: Counters,
    pub check: Option<Check>,
    pub state: StateKey,
    pub config: Value,
    pub done: usize,
    pub busy: Duration,
}

impl Eye {
    pub fn new(config: &Config, scene: &Scene, resolved: Value) -> Result<Eye> {
        let header = scene.footage.header();
        let retina = match config.settings.observer.start.as_str() {
            "rested" | "adapted" => Retina::rested(header.width, header.height),
            file => retina_of_file(config, file, header.width, header.height).map_err(|e| {
                config.wrong(
                    "observer.start",
                    format!("{e}; accepted: rested, adapted, or a state file"),
                )
            })?,
        };
        let pixels_per_degree = scene.pixels_per_degree;
        let mut viewer = Viewer::new(
            scene.vision.clone(),
            config.pigments(),
            config.model()?,
            retina,
            pixels_per_degree,
        );
        viewer.plan = config.plan();
        viewer.surround = Nits(config.settings.gaze.surround_cd_m2);
        Ok(Eye {
            viewer,
            gaze: Gaze::of(config)?,
            probes: record::probes(config),
            display: (config.settings.output.display == DisplayFile::Png)
                .then(|| scene.display(config)),
            map: None,
            counters: Counters { held_frames: scene.held.clone(), ..Counters::default() },
            check: None,
            state: config.settings.output.state,
            config: resolved,
            done: 0,
            busy: Duration::ZERO,
        })
    }

    /// Takes up what [`Eye::checkpoint`] gave.
    pub fn restore(&mut self, checkpoint: &Checkpoint) -> Result<()> {
        let Checkpoint { head, numbers: [retina, beyond, map, pupil, plan] } = checkpoint.clone();
        let damaged = || Error::file(checkpoint::NAME, "holds a retina of another size");
        let beyond = beyond.try_into().map_err(|_| damaged())?;
        self.viewer.retina = Retina::restored(retina, head.retina_size, head.retina_origin, beyond)
            .ok_or_else(damaged)?;
        self.viewer.first_gaze = head.first_gaze;
        self.viewer.pupil.restore(&pupil);
        self.viewer.plan.restore(&plan);
        self.map = self.display.as_ref().and_then(|display| display.restore(map)).map(Arc::new);
        (self.counters, self.done, self.check) = (head.counters, head.done, head.check);
        Ok(())
    }

    /// Everything that the next frame depends on.
    pub fn checkpoint(&self, steps: &[Step]) -> Checkpoint {
        let Viewer { retina, pupil, plan, first_gaze, .. } = &self.viewer;
        let head = Head {
            config: self.config.clone(),
            done: self.done,
            last_frame: steps[self.done - 1].number,
            first_gaze: *first_gaze,
            retina_size: retina.size(),
            retina_origin: retina.origin(),
            counters: self.counters.clone(),
            check: self.check.clone(),
            lengths: [0; 2],
            counts: [0; 5],
        };
        let map = self.map.as_ref().map_or(Vec::new(), |map| map.levels().to_vec());
        let (retina, beyond) = (retina.fractions().to_vec(), retina.beyond().to_vec());
        Checkpoint { head, numbers: [retina, beyond, map, pupil.to_numbers(), plan.to_numbers()] }
    }

    /// The places of the sampled check: `None`: to be chosen on the first frame; none where a model
    /// was asked for that is not meant to be true.
    pub fn places_to_check(&self) -> Option<Vec<[usize; 2]>> {
        match (&self.check, self.viewer.model) {
            (Some(check), _) => Some(check.places.clone()),
            (None, Model::Tracked { .. }) => None,
            _ => Some(Vec::new()),
        }
    }

    /// The steady state of the first frame, before the first look.
    fn adapt(&mut self, loaded: &Loaded, gaze: [f64; 2], duration: Seconds) {
        let (pupil, model) = (self.viewer.pupil.clone(), self.viewer.model);
        let plan = std::mem::replace(&mut self.viewer.plan, Plan::new(None));
        self.viewer.model = Model::Steady;
        self.viewer.look(&loaded.frame.planes, &loaded.survey, gaze, duration, None);
        (self.viewer.pupil, self.viewer.model, self.viewer.plan) = (pupil, model, plan);
    }

    /// Looks at one frame and hands over what is to be written of it. `recycled`: a percept to be
    /// written over.
    pub fn see(
        &mut self,
        loaded: &Loaded,
        step: &Step,
        adapt: bool,
        last: bool,
        recycled: Option<Planes>,
    ) -> Finished {
        let begun = Instant::now();
        let planes = &loaded.frame.planes;
        let size = [planes.width, planes.height];
        let gaze = self.gaze.pixel(step.end(), &loaded.survey, size, self.viewer.first_gaze);
        let duration = Seconds(step.duration);
        if adapt {
            self.adapt(loaded, gaze, duration);
        }
        let mut check = self.check.take().unwrap_or_else(|| self.viewer.check(&loaded.places));
        let look = self.viewer.look(planes, &loaded.survey, gaze, duration, recycled);
        self.viewer.compare(&mut check, planes, loaded.kept.as_deref(), &look, gaze, duration);
        self.check = Some(check);
        self.meet(&look, step);
        let readings: Vec<Reading> =
            self.probes.iter().map(|probe| probe.read(&self.viewer, planes, &look, gaze)).collect();
        if let Some(display) = &self.display {
            let map = display.follow(self.map.as_deref(), &loaded.survey, duration);
            self.map = Some(Arc::new(map));
        }
        let finished = Finished {
            number: step.number,
            trace: record::trace_row(&self.viewer, planes, &look, gaze, step),
            probes: record::probe_rows(&readings, step),
            map: self.map.clone(),
            state: self.state_file(step, size, last),
            seen: look.seen,
        };
        self.done += 1;
        self.busy += begun.elapsed();
        finished
    }

    fn state_file(
        &self,
        step: &Step,
        size: [usize; 2],
        last: bool,
    ) -> Option<(Option<u32>, Planes, f64)> {
        let number = match self.state {
            StateKey::Every => Some(step.number),
            StateKey::Last if last => None,
            _ => return None,
        };
        let view = self.viewer.retina.first_view(size[0], size[1]);
        let samples = Samples::Float(view.iter().map(|&p| p as f32).collect());
        Some((number, Planes { width: size[0], height: size[1], count: 3, samples }, step.end()))
    }

    fn meet(&mut self, look: &Look, step: &Step) {
        let [width, height] = self.viewer.retina.size();
        self.counters.meet(step.end(), &look.census, width * height);
        if self.counters.method_past_limit.is_none() {
            let Viewer { model, pigments, .. } = &self.viewer;
            let past = model.past_limit(pigments, look.census.greatest, Seconds(step.duration));
            self.counters.method_past_limit =
                past.map(|problem| format!("frame {}: {problem}", step.number));
        }
    }
}

/// The retina of a state file, which must be of the frames' size.
pub(crate) fn retina_of_file(
    config: &Config,
    file: &str,
    width: usize,
    height: usize,
) -> Result<Retina> {
    let path = config.path(file);
    let planes = frames::read_state(&path, config.settings.input.max_pixels)?;
    if (planes.width, planes.height) != (width, height) {
        let problem = format!(
            "is a state of {} x {} places; the frames have {width} x {height}",
            planes.width, planes.height
        );
        return Err(Error::file(&path, problem));
    }
    let p = Array3::from_shape_fn((height, 3, width), |(y, k, x)| planes.at(x, y, k));
    if p.iter().any(|v| !(0.0..=1.0).contains(v)) {
        return Err(Error::file(&path, "holds unbleached fractions outside 0 to 1"));
    }
    Ok(Retina::from_fractions(p, [1.0; 3]))
}
