//! The stages of a look, in their order.
//!
//! With a still gaze the whole way is one pass over each row, tile by tile. With a moved gaze it is
//! two: the light's way to the retina ([`Eye::expose`]) and the percept's way back
//! ([`Eye::perceive`]), each with its own resampling.

use rayon::prelude::*;

use super::beyond::Around;
use super::check::CheckFrame;
use super::field::Field;
use super::illuminance::IlluminanceOperator;
use super::percept::PerceptScratch;
use super::pigment::{Model, PigmentStep};
use super::plan::{Plan, Rule};
use super::{Eye, Look, LookStats, Stimulus, Surround};
use crate::eye::check::Check;
use crate::kernel::{self, TILE, TileScratch};
use crate::light::{PlaneTile, Planes, Sample, Samples};
use crate::units::{Millimetres, Nits, Seconds};

/// What the rows of one look share.
struct LookContext<'a> {
    /// Light on the retina.
    retinal: &'a Planes,
    /// Light that is seen, if it is not the same.
    shown: Option<&'a Planes>,
    /// Whether the percept is of halves, as the frame is.
    half: bool,
    /// How far the gaze has moved from the first, in pixels.
    shift: [f64; 2],
    step: PigmentStep,
    rule: Rule,
    /// Cone illuminance around the picture, td.
    around: Around<'a, f32>,
}

impl LookContext<'_> {
    /// The greatest cone illuminance around the picture, td.
    fn greatest_around(&self) -> [f32; 3] {
        match self.around {
            Around::Alike(td) => td,
            Around::Grid(td) => td.greatest(),
        }
    }
}

impl Eye {
    /// Looks at a frame for a while. `gaze`: where, in pixels. Frame and places to check must be of
    /// the eye's size and number of planes.
    pub fn look_at(&mut self, stimulus: Stimulus<'_>, gaze: [f64; 2], duration: Seconds) -> Look {
        if self.adapts_first && self.first_gaze.is_none() {
            self.adapt_to(stimulus, gaze, duration);
        }
        let first = *self.first_gaze.get_or_insert(gaze);
        self.uniform = self.exact_field(stimulus).map(<[f64]>::to_vec);
        let is_field = self.uniform.is_some();
        let shift = if is_field { [0.0; 2] } else { [gaze[0] - first[0], gaze[1] - first[1]] };
        let mut check = self.begun_check(stimulus.checked);
        if self.surround == Surround::Edge {
            self.surround = Surround::Uniform(Nits(stimulus.survey.edge));
        }

        // The stages.
        // A look of no length moves nothing, whatever the model.
        let model = match self.plan.model(self.model, &self.pigments, duration) {
            _ if duration.0 == 0.0 => Model::Unbleached,
            _ if is_field => self.model,
            planned => planned,
        };
        let step = PigmentStep::new(self.pigments, model, duration);
        // What a field scatters is the field.
        let mut optics = if is_field { None } else { self.scatter(stimulus, !step.is_idle()) };
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
            step: if is_field { step.idle() } else { step },
            rule: self.plan.rule(&self.pigments, duration),
            around: match &optics {
                Some(optics) => Around::Grid(optics.light_around()),
                None => Around::Alike(self.surround_illuminance(pupil).map(|td| td as f32)),
            },
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
        let to_srgb = self.vision.seen_to_srgb.map(|row| row.map(|v| v as f32));
        let adapting = adapting.fovea;
        let look = Look { percept, to_srgb, survey, gaze, shift, duration, adapting, pupil, stats };
        if let Some(check) = &mut check {
            self.follow(check, stimulus, &look);
        }
        self.check = check;
        look
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

    /// One pass over each row, tile by tile: light, illuminance, pigment, catch, percept.
    fn look_still<T: Sample>(
        &mut self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
        percept: &mut [T],
    ) -> LookStats {
        let Eye { vision, retina, percept: stage, plan, .. } = self;
        let (retinal, step) = (context.retinal, &context.step);
        let (moves, returns_light) = (!step.is_idle(), vision.returns_its_light());
        let row = |scratch: &mut TileScratch, y: usize, p: &mut [f64], out: &mut [T], ledger| {
            let TileScratch { light: room, td, lms, rgb } = scratch;
            let mut stats = LookStats::EMPTY;
            let bounds: &mut [f64] = ledger;
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
                let rgb = if unbleached && returns_light {
                    rgb_planes(light)
                } else {
                    let scratch = PerceptScratch { p: td, lms, rgb };
                    stage.see(light, p.map(|p| &*p), scratch)
                };
                stats = stats.and(LookStats::of_percept(write_percept(rgb, out, from)));
            }
            stats
        };
        retina
            .par_rows_mut()
            .zip(percept.par_chunks_exact_mut(3 * retinal.width))
            .zip(plan.ledger.rows_mut())
            .enumerate()
            .map_init(TileScratch::new, |scratch, (y, ((p, out), ledger))| {
                row(scratch, y, p, out, ledger)
            })
            .reduce(|| LookStats::EMPTY, LookStats::and)
    }

    /// The light's way to the retina: cone illuminance of the picture, resampled to the places,
    /// moves their pigment.
    fn expose(&mut self, context: &LookContext<'_>, operator: &IlluminanceOperator) -> LookStats {
        if context.step.is_idle() {
            return LookStats::EMPTY;
        }
        let ([width, height], shift, around) = (self.size, context.shift, context.around);
        self.fields.resize(3 * width * height, 0.0);
        let stats = illuminate(context.retinal, operator, &mut self.fields);
        let stats = stats.and(LookStats::of_light(context.greatest_around()));
        let field = Field { samples: &self.fields, width, height, around };
        let ([x0, y0], [places, _]) = (self.retina.origin(), self.retina.size());
        let rows = self.retina.par_rows_mut().zip(self.plan.ledger.rows_mut()).enumerate();
        let moved =
            rows.map_init(TileScratch::new, |TileScratch { td, .. }, (row, (p, ledger))| {
                let mut stats = LookStats::EMPTY;
                for ((from, width), bound) in kernel::tiles(operator.tile(), places).zip(ledger) {
                    let at =
                        [(x0 + from as i64) as f64 + shift[0], (y0 + row as i64) as f64 + shift[1]];
                    field.resample(at, td.each_mut().map(|td| &mut td[..width]));
                    let td = td.each_ref().map(|td| &td[..width]);
                    let p = thirds(p).map(|p| &mut p[from..from + width]);
                    let greatest = td.map(kernel::greatest);
                    stats = stats.and(context.step.tile(&context.rule, bound, td, greatest, p));
                }
                stats
            });
        stats.and(moved.reduce(|| LookStats::EMPTY, LookStats::and))
    }

    /// Makes places of their own of those that the picture covers for the first time. They go on
    /// with the bound of all that lies beyond.
    fn grow(&mut self, shift: [f64; 2], tile: usize) {
        let edge = |i: usize| {
            let end = (self.size[i] as f64 - 1.0 - shift[i]).ceil() as i64;
            [(-shift[i]).floor() as i64, end]
        };
        let ([left, right], [top, bottom]) = (edge(0), edge(1));
        let before = self.retina.size();
        let first = self.retina.cover([left, top], [right, bottom], tile);
        let [width, height] = self.retina.size();
        if [width, height] != before {
            self.plan.ledger.grow(first, [width.div_ceil(tile), height]);
        }
    }

    /// Moves what no picture has covered, unless it may be left untouched.
    fn advance_beyond(&mut self, context: &LookContext<'_>) {
        let bound = self.plan.ledger.beyond_mut();
        *bound = context.rule.after(*bound, context.greatest_around());
        if bound.is_infinite() {
            self.retina.advance_beyond(&context.step, context.around, context.shift);
        }
    }

    /// The percept's way back: p is read at the picture's points, and the picture's own light is
    /// seen through it.
    fn perceive<T: Sample>(
        &self,
        context: &LookContext<'_>,
        operator: &IlluminanceOperator,
        percept: &mut [T],
    ) -> LookStats {
        let (shift, pigment) = (context.shift, self.pigment());
        let planes = context.shown.unwrap_or(context.retinal);
        let [x0, y0] = self.retina.origin();
        let rows = percept.par_chunks_exact_mut(3 * planes.width).enumerate();
        let of_row = rows.map_init(TileScratch::new, |scratch, (y, out)| {
            let TileScratch { light: room, td, lms, rgb } = scratch;
            let mut p = [[0.0; TILE]; 3];
            let mut limited = 0;
            for (from, width) in operator.tiles(planes.width) {
                let light = operator.light(planes.row(y), from, width, room);
                let at = [from as f64 - shift[0] - x0 as f64, y as f64 - shift[1] - y0 as f64];
                pigment.resample(at, p.each_mut().map(|p| &mut p[..width]));
                let p = p.each_ref().map(|p| &p[..width]);
                let scratch = PerceptScratch { p: td, lms, rgb };
                limited += write_percept(self.percept.see(light, p, scratch), out, from);
            }
            LookStats::of_percept(limited)
        });
        of_row.reduce(|| LookStats::EMPTY, LookStats::and)
    }

    /// Luminance of what lies beyond the picture; none before the first look tells.
    pub(super) fn surround_luminance(&self) -> Nits {
        match self.surround {
            Surround::Edge => Nits(0.0),
            Surround::Uniform(nits) => nits,
        }
    }

    /// Cone illuminance of the light around the picture, an equal-energy spectrum, td.
    fn surround_illuminance(&self, pupil: Millimetres) -> [f64; 3] {
        let weights = self.vision.illuminance_weights(pupil, Millimetres(f64::INFINITY));
        self.vision.illuminance(&self.around, &weights).map(|td| td * self.surround_luminance().0)
    }

    /// Cone illuminance of a place beyond the picture of a frame that was looked at, td.
    fn illuminance_around(&self, pupil: Millimetres, [x, y]: [i64; 2]) -> [f64; 3] {
        match self.optics.as_ref().and_then(|stage| stage.done_around()) {
            Some(td) => [0, 1, 2].map(|k| f64::from(td.at([x as f64, y as f64], k))),
            None => self.surround_illuminance(pupil),
        }
    }

    /// Cone illuminance of one pixel of a frame that was looked at, td.
    pub fn illuminance_at(&self, planes: &Planes, look: &Look, [x, y]: [usize; 2]) -> [f64; 3] {
        let per_degree = self.vision.observer.directional.mm_per_degree().unwrap_or(0.0);
        let scale = per_degree / self.pixels_per_degree;
        let r = Millimetres(scale * (x as f64 - look.gaze[0]).hypot(y as f64 - look.gaze[1]));
        let weights = self.vision.illuminance_weights(look.pupil, r);
        let of_place = || self.vision.moments(self.on_the_retina(planes), x, y);
        let moments = self.uniform.clone().unwrap_or_else(of_place);
        self.vision.illuminance(&moments, &weights)
    }

    /// Unbleached fractions at one pixel of a frame that was looked at.
    pub fn fractions_at(&self, look: &Look, [x, y]: [usize; 2]) -> [f64; 3] {
        let [x0, y0] = self.retina.origin();
        let [mut l, mut m, mut s] = [[0.0]; 3];
        let at = [x as f64 - look.shift[0] - x0 as f64, y as f64 - look.shift[1] - y0 as f64];
        self.pigment().resample(at, [&mut l, &mut m, &mut s]);
        [l[0], m[0], s[0]]
    }

    /// The retina's pigment, to be read between its places.
    fn pigment(&self) -> Field<'_, f64> {
        let [width, height] = self.retina.size();
        Field { samples: self.retina.fractions(), width, height, around: self.retina.around() }
    }

    /// The check before a look; a new one starts with the retina's fractions.
    fn begun_check(&mut self, places: &[[usize; 2]]) -> Option<Check> {
        let retina = &self.retina;
        let begin = || Check::new(places.to_vec(), |[x, y]| retina.at([x as i64, y as i64]));
        self.check.take().or_else(|| (!places.is_empty()).then(begin))
    }

    /// Moves the check by a look.
    fn follow(&self, check: &mut Check, stimulus: Stimulus<'_>, look: &Look) {
        let veil = |at| self.veil(stimulus.planes, at);
        let frame = CheckFrame {
            vision: &self.vision,
            pigments: &self.pigments,
            kept: stimulus.spectra,
            planes: self.on_the_retina(stimulus.planes),
            veil: &veil,
            pupil: look.pupil,
            gaze: look.gaze,
            shift: look.shift,
            around: &|at| self.illuminance_around(look.pupil, at),
            pixels_per_degree: self.pixels_per_degree,
            duration: look.duration,
        };
        check.follow(&frame, |[x, y]| self.retina.at([x as i64, y as i64]));
    }
}

/// Cone illuminance of a whole frame: rows of L, M and S, td.
pub(super) fn illuminate(
    planes: &Planes,
    operator: &IlluminanceOperator,
    td: &mut [f32],
) -> LookStats {
    let rows = td.par_chunks_exact_mut(3 * planes.width).enumerate();
    let of_row = rows.map_init(TileScratch::new, |scratch, (y, td)| {
        for (from, width) in operator.tiles(planes.width) {
            let light = operator.light(planes.row(y), from, width, &mut scratch.light);
            let out = thirds(td).map(|td| &mut td[from..from + width]);
            operator.illuminance(light, [from, y], out);
        }
        LookStats::of_light(thirds(td).map(|td| kernel::greatest(td)))
    });
    of_row.reduce(|| LookStats::EMPTY, LookStats::and)
}

/// The three runs of a row: L, M, S or R, G, B.
fn thirds<T>(row: &mut [T]) -> [&mut [T]; 3] {
    let width = row.len() / 3;
    let (first, rest) = row.split_at_mut(width);
    let (second, third) = rest.split_at_mut(width);
    [first, second, third]
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

/// Stores a tile of the percept; returns how many samples had to be limited.
fn write_percept<T: Sample>(rgb: [&[f32]; 3], row: &mut [T], from: usize) -> u64 {
    let planes = rgb.into_iter().zip(thirds(row));
    planes.map(|(rgb, out)| T::store(rgb, &mut out[from..from + rgb.len()])).sum()
}

/// Planes for a percept: recycled ones where they fit.
fn canvas(recycled: Option<Planes>, like: &Planes, half: bool) -> Planes {
    let fits = |old: &Planes| {
        (old.width, old.height, old.count) == (like.width, like.height, 3)
            && matches!(old.samples, Samples::Half(_)) == half
    };
    let new = if half { Planes::half } else { Planes::float };
    recycled.filter(fits).unwrap_or_else(|| new(like.width, like.height, 3))
}
