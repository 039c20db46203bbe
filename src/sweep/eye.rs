//! The eye of one case: what it sees of a frame in full, what of the reduced frame, and what its
//! probes read.
//!
//! The probes of a still are followed place by place, in f64: only a moving gaze, a sequence or
//! pictures to be written need the whole retina.

use ndarray::Array3;

use crate::config::{Case, Config};
use crate::error::Result;
use crate::eye::retina::{Advance, Model, Retina};
use crate::eye::{Look, Viewer};
use crate::light::{Planes, Samples};
use crate::observer::{Dynamics, Pupil, Rule};
use crate::run::record::{self, Probe, Reading};
use crate::run::{self, Gaze, Scene};
use crate::sweep::light::Lit;
use crate::sweep::pass::Span;
use crate::sweep::reduced;
use crate::units::{Millimetres, Nits, Seconds, Trolands};

/// An eye that goes through one pass.
pub struct Eye {
    gaze: Gaze,
    probes: Vec<Probe>,
    /// The eye at full size. Without `spread`, its retina is left alone and only its pupil and gaze
    /// serve.
    whole: Viewer,
    small: Viewer,
    model: Model,
    spread: bool,
    /// Unbleached fractions at the probes of a still.
    places: Option<Vec<[f64; 3]>>,
}

/// What was seen at the end of a span.
pub struct Sight {
    /// The percept, if the whole retina is followed.
    pub seen: Option<Planes>,
    /// The percept of the reduced light.
    pub small: Planes,
    pub readings: Vec<Reading>,
    /// What the probes would read under this light for ever.
    pub steady: Vec<Reading>,
    /// What to say if the span is past the step length that the method is stable to.
    pub past_limit: Option<String>,
}

impl Eye {
    /// The eye of a case before its first frame. `parts`: the number of steps that share the budget
    /// of the law.
    pub fn new(
        case: &Case,
        scene: &Scene,
        first: &Lit,
        pictures: bool,
        parts: usize,
    ) -> Result<Eye> {
        let config = &case.config;
        let gaze = Gaze::of(config)?;
        let still = scene.footage.len() == 1 && !matches!(gaze, Gaze::Path(_));
        let (spread, [width, height]) =
            (pictures || !still, [first.planes.width, first.planes.height]);
        let model = shared(config.model()?, parts);
        let start = match config.settings.observer.start.as_str() {
            "rested" | "adapted" => None,
            file => Some(run::retina_of_file(config, file, width, height)?),
        };
        let small = start.as_ref().map(|retina| smaller(retina, &first.small));
        let small = small.unwrap_or_else(|| Retina::rested(first.small.width, first.small.height));
        let scale = first.small.width as f64 / width as f64;
        let mut eye = Eye {
            gaze,
            probes: record::probes(config),
            whole: viewer(config, scene, Retina::rested(1, 1), scene.pixels_per_degree),
            small: viewer(config, scene, small, scene.pixels_per_degree * scale),
            model,
            spread,
            places: None,
        };
        eye.places = still.then(|| eye.starts(config, first, start.as_ref()));
        if spread {
            eye.whole.retina = start.unwrap_or_else(|| Retina::rested(width, height));
        }
        if config.settings.observer.start == "adapted" {
            eye.adapt(first);
        }
        Ok(eye)
    }

    /// Fractions at the probes before the first frame.
    fn starts(&self, config: &Config, first: &Lit, start: Option<&Retina>) -> Vec<[f64; 3]> {
        if config.settings.observer.start == "adapted" {
            let pupil = self.whole.pupil.clone().follow(self.adapting(first, 0.0), Seconds(0.0));
            return self
                .pixels(first, 0.0)
                .map(|pixel| self.steady(first, 0.0, pupil, pixel))
                .collect();
        }
        let at =
            |[x, y]: [usize; 2]| start.map_or([1.0; 3], |retina| retina.at([x as i64, y as i64]));
        self.pixels(first, 0.0).map(at).collect()
    }

    /// Brings both retinas to the steady state of the first frame; the pupil has seen nothing yet.
    fn adapt(&mut self, first: &Lit) {
        let pupil = self.whole.pupil.clone();
        let at_once = Span { file: 0, start: 0.0, end: 0.0, aim: 0.0, cell: None };
        self.look(first, &at_once, Model::Steady);
        self.whole.pupil = pupil;
    }

    /// Looks at a frame for a span.
    pub fn watch(&mut self, lit: &Lit, span: &Span) -> Sight {
        let model = if span.length() == Seconds(0.0) { Model::Unbleached } else { self.model };
        let (look, small, pupil) = self.look(lit, span, model);
        let pixels: Vec<[usize; 2]> = self.pixels(lit, span.aim).collect();
        let (readings, gaze) =
            (self.readings(lit, span, model, pupil, &pixels), self.aim(lit, span.aim));
        let readings = readings.or_else(|| {
            let look = look.as_ref()?;
            Some(
                self.probes
                    .iter()
                    .map(|probe| probe.read(&self.whole, &lit.planes, look, gaze))
                    .collect(),
            )
        });
        let forever = |(probe, &pixel): (&Probe, &[usize; 2])| {
            self.reading(
                lit,
                span.aim,
                pupil,
                probe,
                pixel,
                self.steady(lit, span.aim, pupil, pixel),
            )
        };
        let steady = self.probes.iter().zip(&pixels).map(forever).collect();
        let readings = readings.unwrap_or_default();
        let censuses = look.iter().chain([&small]).map(|look| look.census.greatest);
        let light = censuses.chain(readings.iter().map(|reading| reading.illuminance));
        let greatest =
            light.fold([0.0; 3], |most: [f64; 3], light| [0, 1, 2].map(|k| most[k].max(light[k])));
        let past_limit = model.past_limit(&self.whole.pigments, greatest, span.length());
        let past_limit = past_limit.map(|problem| format!("{} s: {problem}", span.end));
        Sight { seen: look.map(|look| look.seen), small: small.seen, readings, steady, past_limit }
    }

    /// Both eyes look; the small one with the pupil of the whole one.
    fn look(&mut self, lit: &Lit, span: &Span, model: Model) -> (Option<Look>, Look, Millimetres) {
        let gaze = self.aim(lit, span.aim);
        (self.whole.model, self.small.model) = (model, model);
        let look = self
            .spread
            .then(|| self.whole.look(&lit.planes, &lit.survey, gaze, span.length(), None));
        let pupil = match &look {
            Some(look) => look.pupil,
            None => {
                let adapting = self.adapting(lit, span.aim);
                self.whole.pupil.follow(adapting, span.length())
            }
        };
        let scale = [
            lit.small.width as f64 / lit.planes.width as f64,
            lit.small.height as f64 / lit.planes.height as f64,
        ];
        let small_gaze = [0, 1].map(|i| (gaze[i] + 0.5) * scale[i] - 0.5);
        self.small.pupil = Pupil::new(Rule::Fixed(pupil), Dynamics::default());
        let small = self.small.look(&lit.small, &lit.survey, small_gaze, span.length(), None);
        (look, small, pupil)
    }

    /// Moves the probes of a still and reads them; `None` if the whole retina must be read.
    fn readings(
        &mut self,
        lit: &Lit,
        span: &Span,
        model: Model,
        pupil: Millimetres,
        pixels: &[[usize; 2]],
    ) -> Option<Vec<Reading>> {
        let mut places = self.places.take()?;
        let advance = Advance::new(self.whole.pigments, model, span.length());
        for (p, &pixel) in places.iter_mut().zip(pixels) {
            let light = self.illuminance(lit, span.aim, pupil, pixel);
            *p = [0, 1, 2].map(|k| advance.place(model, &self.whole.pigments[k], p[k], light[k]));
        }
        let probes = self.probes.iter().zip(pixels).zip(&places);
        let readings =
            probes.map(|((probe, &pixel), &p)| self.reading(lit, span.aim, pupil, probe, pixel, p));
        let readings = Some(readings.collect());
        self.places = Some(places);
        readings
    }

    fn reading(
        &self,
        lit: &Lit,
        time: f64,
        pupil: Millimetres,
        probe: &Probe,
        at: [usize; 2],
        p: [f64; 3],
    ) -> Reading {
        let vision = &self.whole.vision;
        let moments = vision.moments(&lit.planes, at[0], at[1]);
        Reading {
            probe: probe.name.clone(),
            illuminance: self.illuminance(lit, time, pupil, at),
            p,
            xyz: vision.xyz(vision.catch(&moments, p)),
        }
    }

    fn illuminance(&self, lit: &Lit, time: f64, pupil: Millimetres, pixel: [usize; 2]) -> [f64; 3] {
        self.whole.illuminance_at(&lit.planes, pupil, self.aim(lit, time), pixel)
    }

    fn steady(&self, lit: &Lit, time: f64, pupil: Millimetres, pixel: [usize; 2]) -> [f64; 3] {
        let light = self.illuminance(lit, time, pupil, pixel);
        [0, 1, 2].map(|k| self.whole.pigments[k].steady(Trolands(light[k])))
    }

    fn adapting(&self, lit: &Lit, time: f64) -> crate::observer::Adapting {
        self.whole.adapting(&lit.planes, &lit.survey, self.aim(lit, time))
    }

    fn aim(&self, lit: &Lit, time: f64) -> [f64; 2] {
        self.gaze.pixel(
            time,
            &lit.survey,
            [lit.planes.width, lit.planes.height],
            self.whole.first_gaze,
        )
    }

    fn pixels(&self, lit: &Lit, time: f64) -> impl Iterator<Item = [usize; 2]> {
        let (size, gaze) = ([lit.planes.width, lit.planes.height], self.aim(lit, time));
        self.probes.iter().map(move |probe| probe.pixel(size, gaze))
    }
}

fn viewer(config: &Config, scene: &Scene, retina: Retina, pixels_per_degree: f64) -> Viewer {
    let mut viewer = Viewer::new(
        scene.vision.clone(),
        config.pigments(),
        Model::Unbleached,
        retina,
        pixels_per_degree,
    );
    viewer.surround = Nits(config.settings.gaze.surround_cd_m2);
    viewer
}

/// The model with its budget shared by the steps of a pass: their errors add up at most.
fn shared(model: Model, parts: usize) -> Model {
    match model {
        Model::Tracked { method, substeps, budget } => {
            Model::Tracked { method, substeps, budget: budget / parts.max(1) as f64 }
        }
        other => other,
    }
}

/// A retina at the size of the reduced light.
fn smaller(retina: &Retina, small: &Planes) -> Retina {
    let [width, height] = retina.size();
    let samples = Samples::Float(retina.fractions().iter().map(|&p| p as f32).collect());
    let means =
        reduced::reduced(&Planes { width, height, count: 3, samples }, [small.width, small.height]);
    let p = Array3::from_shape_fn((small.height, 3, small.width), |(y, k, x)| means.at(x, y, k));
    Retina::from_fractions(p, [1.0; 3])
}
