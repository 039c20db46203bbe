//! The stages of a look, in their order.
//!
//! With a still gaze the whole way is one pass over each row, tile by tile. With a moved gaze it is
//! two: the light's way to the retina ([`Eye::expose`]) and the percept's way back
//! ([`Eye::perceive`]), each with its own resampling.

use rayon::prelude::*;

use super::context::{LookContext, canvas, thirds, write_percept};
use super::illuminance::IlluminanceOperator;
use super::percept::{PerceptScratch, PerceptStage};
use super::pigment::{Model, PigmentStep};
use super::plan::Plan;
use super::{Eye, Look, LookStats, Stimulus, Surround};
use crate::kernel::{self, TILE, TileScratch};
use crate::light::{PlaneTile, Planes, Sample, Samples};
use crate::units::{Millimetres, Nits, Seconds};

impl Eye {
    /// Looks at a frame for a while. `gaze`: where, in pixels. Frame and places to check must be of
    /// the eye's size and number of planes.
    pub fn look_at(&mut self, stimulus: Stimulus<'_>, gaze: [f64; 2], duration: Seconds) -> Look {
        let shift = self.aim_at(stimulus, gaze, duration);
        let check = self.begun_check(stimulus.checked);
        let model = self.model_for(duration);
        let step = PigmentStep::new(self.pigments, model, duration);

        // The stages.
        let mut optics = self.scatter(stimulus, !step.is_idle());
        let adapting = self.adapting(stimulus.planes, stimulus.survey, gaze);
        let pupil = self.pupil.follow(adapting, duration);
        if let Some(optics) = &mut optics {
            optics.illuminate_around(&self.weights_around(pupil));
        }
        let retinal = optics.as_ref().map_or(stimulus.planes, |optics| optics.retinal());
        let operator = self.aimed(retinal, pupil, gaze);
        let of_field = self.immerse(&step, pupil);
        let context = LookContext {
            retinal,
            shown: optics.as_ref().and_then(|optics| optics.shown(stimulus.planes)),
            half: matches!(stimulus.planes.samples, Samples::Half(_)),
            shift,
            step: if self.uniform.is_some() { step.idle() } else { step },
            rule: self.plan.rule(&self.pigments, duration),
            around: self.around(optics.as_ref(), pupil),
        };
        let (percept, stats) = self.percept_of(&context, &operator);
        if of_field.stepped {
            self.plan.ledger.spend();
        }
        let stats = stats.and(of_field);

        self.illuminance = Some(operator);
        self.plan.note(&stats, model, &self.pigments, duration);
        let survey = stimulus.seen_survey(optics.as_ref());
        self.optics = optics.or(self.optics.take());
        let (to_srgb, adapting) = (self.vision.to_srgb(), adapting.fovea);
        let look = Look { percept, to_srgb, survey, gaze, shift, duration, adapting, pupil, stats };
        self.check = check.map(|check| self.followed(check, stimulus, &look));
        look
    }

    /// Takes note of where is looked, and of what the first look settles: the state to start from
    /// and the light beyond the picture. Returns how far the gaze has moved from the first.
    fn aim_at(&mut self, stimulus: Stimulus<'_>, gaze: [f64; 2], duration: Seconds) -> [f64; 2] {
        if self.adapts_first && self.first_gaze.is_none() {
            self.adapt_to(stimulus, gaze, duration);
        }
        let first = *self.first_gaze.get_or_insert(gaze);
        self.uniform = self.exact_field(stimulus).map(<[f64]>::to_vec);
        if self.surround == Surround::Edge {
            self.surround = Surround::Uniform(Nits(stimulus.survey.edge));
        }
        match self.uniform {
            Some(_) => [0.0; 2],
            None => [gaze[0] - first[0], gaze[1] - first[1]],
        }
    }

    /// How pigment is moved over a look. One of no length moves nothing, whatever the model; of a
    /// field nothing is left out.
    fn model_for(&self, duration: Seconds) -> Model {
        match self.plan.model(self.model, &self.pigments, duration) {
            _ if duration.0 == 0.0 => Model::Unbleached,
            _ if self.uniform.is_some() => self.model,
            planned => planned,
        }
    }

    /// The moments of a uniform field that every place receives alike.
    fn exact_field<'a>(&self, stimulus: Stimulus<'a>) -> Option<&'a [f64]> {
        let alike = self.vision.observer.directional.mm_per_degree().is_none();
        stimulus.uniform.filter(|_| alike)
    }

    /// Moves every place by the light of a uniform field, in double precision; nothing is left out.
    fn immerse(&mut self, step: &PigmentStep, pupil: Millimetres) -> LookStats {
        let Some(moments) = self.uniform.as_ref().filter(|_| !step.is_idle()) else {
            return LookStats::EMPTY;
        };
        let weights = self.vision.illuminance_weights(pupil, Millimetres(0.0));
        let td = self.vision.illuminance(moments, &weights);
        let rows = self.retina.par_rows_mut();
        rows.map(|row| step.held(td, thirds(row))).reduce(|| LookStats::EMPTY, LookStats::and)
    }

    /// The steady state of a frame, before the first look at it. The pupil is that of the first
    /// look, and nothing is left out.
    fn adapt_to(&mut self, stimulus: Stimulus<'_>, gaze: [f64; 2], duration: Seconds) {
        self.first_gaze = Some(gaze);
        let (pupil, model) = (self.pupil.clone(), self.model);
        let plan = std::mem::replace(&mut self.plan, Plan::new(None));
        self.model = Model::Steady;
        let duration = Seconds(duration.0.max(f64::MIN_POSITIVE));
        let look = self.look_at(Stimulus { checked: &[], ..stimulus }, gaze, duration);
        self.recycle(look.percept);
        (self.pupil, self.model, self.plan) = (pupil, model, plan);
    }

    /// The illuminance operator, aimed at a frame.
    fn aimed(
        &mut self,
        retinal: &Planes,
        pupil: Millimetres,
        gaze: [f64; 2],
    ) -> IlluminanceOperator {
        let mut operator =
            self.illuminance.take().unwrap_or_else(|| IlluminanceOperator::new(&self.vision));
        operator.aim(&self.vision, retinal, pupil, gaze, self.pixels_per_degree);
        operator
    }

    /// Illuminance, pigment, catch and percept of all rows.
    fn percept_of(
        &mut self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
    ) -> (Planes, LookStats) {
        let light = context.shown.unwrap_or(context.retinal);
        let half = context.half && self.vision.returns_its_light();
        let mut percept = canvas(self.spare.take(), light, half);
        let tiles = self.retina.size()[0].div_ceil(operator.tile());
        let (rows, retina) = (self.retina.size()[1], &self.retina);
        self.plan.open(tiles, rows, || retina.is_rested(), &self.vision);
        let stats = match &mut percept.samples {
            Samples::Half(percept) => self.rows(context, operator, percept),
            Samples::Float(percept) => self.rows(context, operator, percept),
        };
        (percept, stats)
    }

    fn rows<T: Sample>(
        &mut self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
        percept: &mut [T],
    ) -> LookStats {
        let still = context.shift == [0.0, 0.0]
            && self.retina.origin() == [0, 0]
            && self.retina.size() == self.size;
        if !context.step.is_idle() {
            // Places that join the retina live through this frame with the others.
            self.grow(context.shift, operator.tile());
            self.advance_beyond(context);
        }
        if still {
            return self.look_still(context, operator, percept);
        }
        self.expose(context, operator).and(self.perceive(context, operator, percept))
    }

    /// One pass over each row.
    fn look_still<T: Sample>(
        &mut self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
        percept: &mut [T],
    ) -> LookStats {
        let Eye { vision, retina, percept: stage, plan, .. } = self;
        let returns_light = vision.returns_its_light();
        let way = WholeWay { context, operator, stage, returns_light };
        retina
            .par_rows_mut()
            .zip(percept.par_chunks_exact_mut(3 * context.retinal.width))
            .zip(plan.ledger.rows_mut())
            .enumerate()
            .map_init(TileScratch::new, |scratch, (y, ((p, out), ledger))| {
                way.row(scratch, y, p, out, ledger)
            })
            .reduce(|| LookStats::EMPTY, LookStats::and)
    }
}

/// All stages of a row, tile by tile: light, illuminance, pigment, catch, percept.
struct WholeWay<'a> {
    context: &'a LookContext<'a>,
    operator: &'a IlluminanceOperator,
    stage: &'a PerceptStage,
    returns_light: bool,
}

impl WholeWay<'_> {
    #[inline(always)]
    fn row<T: Sample>(
        &self,
        scratch: &mut TileScratch,
        y: usize,
        p: &mut [f64],
        out: &mut [T],
        bounds: &mut [f64],
    ) -> LookStats {
        let WholeWay { context, operator, .. } = *self;
        let (retinal, step) = (context.retinal, &context.step);
        let TileScratch { light: room, td, lms, rgb } = scratch;
        let (moves, mut stats) = (!step.is_idle(), LookStats::EMPTY);
        for ((from, width), bound) in operator.tiles(retinal.width).zip(bounds) {
            prefetch_tile(p, out, from, width);
            let mut light = operator.light(retinal.row(y), from, width, room);
            let mut p = thirds(p).map(|p| &mut p[from..from + width]);
            if moves {
                let out = td.each_mut().map(|td| &mut td[..width]);
                let greatest = operator.illuminance(light, [from, y], out);
                let td = td.each_ref().map(|td| &td[..width]);
                let p = p.each_mut().map(|p| &mut **p);
                stats = stats.and(step.tile(&context.rule, bound, td, greatest, p));
            }
            if let Some(shown) = context.shown {
                light = operator.light(shown.row(y), from, width, room);
            }
            let unbleached =
                bound.is_finite() && (moves || p.iter().all(|p| kernel::least(p) == 1.0));
            let rgb = if unbleached && self.returns_light {
                rgb_planes(light)
            } else {
                let scratch = PerceptScratch { p: td, lms, rgb };
                self.stage.see(light, p.map(|p| &*p), scratch)
            };
            stats = stats.and(LookStats::of_percept(write_percept(rgb, out, from)));
        }
        stats
    }
}

fn rgb_planes(light: PlaneTile<'_>) -> [&[f32]; 3] {
    [light.plane(0), light.plane(1), light.plane(2)]
}

/// Prefetch of a tile's output, and at the end of a row of the next row's first pigment tile.
#[inline(always)]
fn prefetch_tile<T>(p: &[f64], percept: &[T], from: usize, width: usize) {
    let row = p.len() / 3;
    for first in [0, row, 2 * row] {
        kernel::prefetch_run(&percept[first + from..][..width], 0);
        if from + width == row {
            kernel::prefetch_run(&p[first..][..TILE.min(row)], p.len());
        }
    }
}
