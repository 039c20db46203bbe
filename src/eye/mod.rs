//! A staring viewer: an observer and a retina in time. One look takes a frame's light to the
//! percept.
//!
//! ```text
//! adapting luminance -> pupil -> per row: cone illuminance -> pigment -> percept
//! ```
//!
//! With a still gaze the whole way is one pass over a row. With a moved gaze it is two: the light's
//! way to the retina (`expose`) and the percept's way back (`perceive`), each with its own
//! resampling.

mod census;
pub mod check;
mod checked;
mod field;
mod fovea;
pub mod plan;
pub mod retina;
mod seeing;
mod sight;
mod tile;

use rayon::prelude::*;

use crate::eye::plan::Plan;
use crate::eye::retina::{Advance, Model, Retina};
use crate::kernel::{self, Room, TILE};
use crate::kinetics::Kinetics;
use crate::light::Survey;
use crate::light::{Planes, Sample, Samples};
use crate::observer::Pupil;
use crate::units::{Millimetres, Nits, Seconds};
use crate::vision::Vision;

pub use census::Census;
use field::Field;
pub use fovea::survey;
use seeing::{Seeing, SeeingScratch};
use sight::Sight;

/// An observer who watches frames of one size.
pub struct Viewer {
    pub vision: Vision,
    pub pigments: [Kinetics; 3],
    pub model: Model,
    pub retina: Retina,
    pub pupil: Pupil,
    /// Scale of the picture, in both directions.
    pub pixels_per_degree: f64,
    /// Light on retina that the picture does not cover.
    pub surround: Nits,
    /// Where the first look was aimed, in pixels.
    pub first_gaze: Option<[f64; 2]>,
    /// What may be left out.
    pub plan: Plan,
    seeing: Seeing,
    /// SampledSpectra from look to look for its room.
    sight: Option<Sight>,
    /// Moments of the light around the picture at 1 cd/m2.
    around: Vec<f64>,
    fields: Vec<f32>,
}

/// What one look found.
#[derive(Clone, Debug)]
pub struct Look {
    /// The percept: three planes in the light's own scale; half if the light was.
    pub seen: Planes,
    pub adapting: Nits,
    pub pupil: Millimetres,
    /// How far the gaze has moved from the first, in pixels.
    pub shift: [f64; 2],
    pub census: Census,
}

impl Viewer {
    /// A viewer of pictures of this size; the retina must have it too.
    pub fn new(
        vision: Vision,
        pigments: [Kinetics; 3],
        model: Model,
        retina: Retina,
        pixels_per_degree: f64,
    ) -> Self {
        let pupil = Pupil::new(vision.observer.pupil, vision.observer.dynamics);
        let (seeing, around) = (Seeing::new(&vision), vision.equal_energy_moments());
        Viewer {
            vision,
            pigments,
            model,
            retina,
            pupil,
            pixels_per_degree,
            surround: Nits(0.0),
            first_gaze: None,
            plan: Plan::new(None),
            seeing,
            sight: None,
            around,
            fields: Vec::new(),
        }
    }

    /// Looks at a frame for a while. `gaze`: where, in pixels; `recycled`: an earlier percept to be
    /// written over.
    pub fn look(
        &mut self,
        planes: &Planes,
        survey: &Survey,
        gaze: [f64; 2],
        duration: Seconds,
        recycled: Option<Planes>,
    ) -> Look {
        let first = *self.first_gaze.get_or_insert(gaze);
        let shift = [gaze[0] - first[0], gaze[1] - first[1]];
        let adapting = self.adapting(planes, survey, gaze);
        let pupil = self.pupil.follow(adapting, duration);
        let mut sight = self.sight.take().unwrap_or_else(|| Sight::new(&self.vision));
        sight.aim(&self.vision, planes, pupil, gaze, self.pixels_per_degree);
        let glance = Glance {
            planes,
            sight,
            pupil,
            shift,
            duration,
            model: self.plan.model(self.model, &self.pigments, duration),
        };
        let half = matches!(planes.samples, Samples::Half(_)) && self.vision.returns_its_light();
        let mut seen = canvas(recycled, planes, half);
        let per_row = self.retina.size()[0].div_ceil(glance.sight.tile());
        let rested =
            || self.retina.fractions().iter().chain(&self.retina.beyond()).all(|&p| p == 1.0);
        self.plan.open(per_row, self.retina.size()[1], rested, &self.vision);
        let census = match &mut seen.samples {
            Samples::Half(seen) => self.rows(&glance, seen),
            Samples::Float(seen) => self.rows(&glance, seen),
        };
        self.plan.note(census.left_out, census.greatest, glance.model, &self.pigments, duration);
        self.sight = Some(glance.sight);
        Look { seen, adapting: adapting.fovea, pupil, shift, census }
    }

    fn rows<T: Sample>(&mut self, glance: &Glance<'_>, seen: &mut [T]) -> Census {
        let still = glance.shift == [0.0, 0.0]
            && self.retina.origin() == [0, 0]
            && self.retina.size() == [glance.planes.width, glance.planes.height];
        if !matches!(glance.model, Model::Unbleached) {
            // Places that join the retina live through this frame with the others.
            self.grow(glance);
            self.advance_beyond(glance);
        }
        if still {
            return self.look_still(glance, seen);
        }
        self.expose(glance).and(self.perceive(glance, seen))
    }

    fn advance(&self, glance: &Glance<'_>) -> Advance {
        Advance::new(self.pigments, glance.model, glance.duration)
    }

    /// One pass over each row, tile by tile: light, pigment, percept.
    fn look_still<T: Sample>(&mut self, glance: &Glance<'_>, seen: &mut [T]) -> Census {
        let advance = self.advance(glance);
        let rule = self.plan.rule(&self.pigments, glance.duration);
        let Viewer { vision, retina, seeing, plan, .. } = self;
        let (planes, sight) = (glance.planes, &glance.sight);
        let moves = !matches!(advance.model, Model::Unbleached);
        let returns_light = vision.returns_its_light();
        retina
            .par_rows_mut()
            .zip(seen.par_chunks_exact_mut(3 * planes.width))
            .zip(plan.ledger.rows_mut())
            .enumerate()
            .map_init(Room::new, |Room { light: room, td, lms, rgb }, (y, ((p, seen), ledger))| {
                let mut census = Census::EMPTY;
                for ((from, width), left_out) in sight.tiles(planes.width).zip(ledger) {
                    ask_for(p, seen, from, width);
                    let light = sight.light(planes.row(y), from, width, room);
                    let mut p = thirds(p).map(|p| &mut p[from..from + width]);
                    if moves {
                        let greatest = sight.illuminance(
                            light,
                            [from, y],
                            td.each_mut().map(|td| &mut td[..width]),
                        );
                        let td = td.each_ref().map(|td| &td[..width]);
                        let p = p.each_mut().map(|p| &mut **p);
                        census =
                            census.and(tile::moved(&advance, &rule, left_out, td, greatest, p));
                    }
                    let whole = left_out.is_finite()
                        && (moves || p.iter().all(|p| kernel::least(p) == 1.0));
                    if whole && returns_light {
                        let planes = [light.plane(0), light.plane(1), light.plane(2)];
                        census.limited += stored(planes, seen, from);
                    } else {
                        let scratch = SeeingScratch { p: td, lms, rgb };
                        let rgb = seeing.see(light, p.map(|p| &*p), scratch);
                        census.limited += stored(rgb, seen, from);
                    }
                }
                census
            })
            .reduce(|| Census::EMPTY, Census::and)
    }

    /// The light's way to the retina: cone illuminance of the picture, resampled to the places,
    /// moves their pigment.
    fn expose(&mut self, glance: &Glance<'_>) -> Census {
        if matches!(glance.model, Model::Unbleached) {
            return Census::EMPTY;
        }
        let (planes, shift) = (glance.planes, glance.shift);
        let surround = self.surround_illuminance(glance.pupil);
        let met = self.illuminate(glance).and(Census { greatest: surround, ..Census::EMPTY });
        let tile = glance.sight.tile();
        let advance = self.advance(glance);
        let rule = self.plan.rule(&self.pigments, glance.duration);
        let around = surround.map(|v| v as f32);
        let field =
            Field { samples: &self.fields, width: planes.width, height: planes.height, around };
        let ([x0, y0], [places, _]) = (self.retina.origin(), self.retina.size());
        let rows = self.retina.par_rows_mut().zip(self.plan.ledger.rows_mut()).enumerate();
        let moved = rows.map_init(Room::new, |Room { td, .. }, (row, (p, ledger))| {
            let mut census = Census::EMPTY;
            for ((from, width), left_out) in kernel::tiles(tile, places).zip(ledger) {
                let at =
                    [(x0 + from as i64) as f64 + shift[0], (y0 + row as i64) as f64 + shift[1]];
                field.resample(at, td.each_mut().map(|td| &mut td[..width]));
                let td = td.each_ref().map(|td| &td[..width]);
                let p = thirds(p).map(|p| &mut p[from..from + width]);
                census = census.and(tile::moved(
                    &advance,
                    &rule,
                    left_out,
                    td,
                    td.map(kernel::greatest),
                    p,
                ));
            }
            census
        });
        met.and(moved.reduce(|| Census::EMPTY, Census::and))
    }

    /// Makes room for places that the picture covers for the first time. They go on with
    /// the bound of all that lies beyond.
    fn grow(&mut self, glance: &Glance<'_>) {
        let (planes, shift, tile) = (glance.planes, glance.shift, glance.sight.tile());
        let edge = |i: usize, n: usize| {
            [(-shift[i]).floor() as i64, (n as f64 - 1.0 - shift[i]).ceil() as i64]
        };
        let ([left, right], [top, bottom]) = (edge(0, planes.width), edge(1, planes.height));
        let before = self.retina.size();
        let first = self.retina.cover([left, top], [right, bottom], tile);
        let [width, height] = self.retina.size();
        if [width, height] != before {
            self.plan.ledger.grow(first, [width.div_ceil(tile), height]);
        }
    }

    /// Moves what no picture has covered, unless it may be left untouched.
    fn advance_beyond(&mut self, glance: &Glance<'_>) {
        let surround = self.surround_illuminance(glance.pupil);
        let rule = self.plan.rule(&self.pigments, glance.duration);
        let bound = self.plan.ledger.beyond_mut();
        *bound = rule.after(*bound, surround.map(|td| td as f32));
        if bound.is_infinite() {
            self.retina.advance_beyond(&self.advance(glance), surround);
        }
    }

    /// Cone illuminance of the whole picture.
    fn illuminate(&mut self, glance: &Glance<'_>) -> Census {
        let planes = glance.planes;
        self.fields.resize(3 * planes.width * planes.height, 0.0);
        let rows = self.fields.par_chunks_exact_mut(3 * planes.width).enumerate().map_init(
            Room::new,
            |room, (y, td)| {
                for (from, width) in glance.sight.tiles(planes.width) {
                    let light = glance.sight.light(planes.row(y), from, width, &mut room.light);
                    glance.sight.illuminance(
                        light,
                        [from, y],
                        thirds(td).map(|td| &mut td[from..from + width]),
                    );
                }
                Census::of_light(thirds(td).map(|td| kernel::greatest(td)))
            },
        );
        rows.reduce(|| Census::EMPTY, Census::and)
    }

    /// The percept's way back: p is read at the picture's points, and the picture's own light is
    /// seen through it.
    fn perceive<T: Sample>(&self, glance: &Glance<'_>, seen: &mut [T]) -> Census {
        let (planes, shift, pigment) = (glance.planes, glance.shift, self.pigment());
        let [x0, y0] = self.retina.origin();
        seen.par_chunks_exact_mut(3 * planes.width)
            .enumerate()
            .map_init(Room::new, |Room { light: room, td, lms, rgb }, (y, seen)| {
                let mut p = [[0.0; TILE]; 3];
                let mut census = Census::EMPTY;
                for (from, width) in glance.sight.tiles(planes.width) {
                    let light = glance.sight.light(planes.row(y), from, width, room);
                    let at = [from as f64 - shift[0] - x0 as f64, y as f64 - shift[1] - y0 as f64];
                    pigment.resample(at, p.each_mut().map(|p| &mut p[..width]));
                    let p = p.each_ref().map(|p| &p[..width]);
                    let scratch = SeeingScratch { p: td, lms, rgb };
                    census.limited += stored(self.seeing.see(light, p, scratch), seen, from);
                }
                census
            })
            .reduce(|| Census::EMPTY, Census::and)
    }

    /// Cone illuminance of the light around the picture, an equal-energy spectrum, td.
    fn surround_illuminance(&self, pupil: Millimetres) -> [f64; 3] {
        let weights = self.vision.illuminance_weights(pupil, Millimetres(f64::INFINITY));
        self.vision.illuminance(&self.around, &weights).map(|td| td * self.surround.0)
    }

    /// Cone illuminance of one point of a picture, td.
    pub fn illuminance_at(
        &self,
        planes: &Planes,
        pupil: Millimetres,
        gaze: [f64; 2],
        [x, y]: [usize; 2],
    ) -> [f64; 3] {
        let scale = self.vision.observer.directional.mm_per_degree().unwrap_or(0.0)
            / self.pixels_per_degree;
        let r = Millimetres(scale * (x as f64 - gaze[0]).hypot(y as f64 - gaze[1]));
        self.vision.illuminance(
            &self.vision.moments(planes, x, y),
            &self.vision.illuminance_weights(pupil, r),
        )
    }

    /// Unbleached fractions at one point of a picture.
    pub fn fractions_at(&self, shift: [f64; 2], [x, y]: [usize; 2]) -> [f64; 3] {
        let [x0, y0] = self.retina.origin();
        let [mut l, mut m, mut s] = [[0.0]; 3];
        let at = [x as f64 - shift[0] - x0 as f64, y as f64 - shift[1] - y0 as f64];
        self.pigment().resample(at, [&mut l, &mut m, &mut s]);
        [l[0], m[0], s[0]]
    }

    /// The retina's pigment, to be read between its places.
    fn pigment(&self) -> Field<'_, f64> {
        let [width, height] = self.retina.size();
        Field { samples: self.retina.fractions(), width, height, around: self.retina.beyond() }
    }
}

/// One look at one frame: what its rows share.
struct Glance<'a> {
    planes: &'a Planes,
    sight: Sight,
    pupil: Millimetres,
    /// How far the gaze has moved from the first, in pixels.
    shift: [f64; 2],
    duration: Seconds,
    /// How pigment is moved over this frame.
    model: Model,
}

/// The three runs of a row: L, M, S or R, G, B.
fn thirds<T>(row: &mut [T]) -> [&mut [T]; 3] {
    let width = row.len() / 3;
    let (first, rest) = row.split_at_mut(width);
    let (second, third) = rest.split_at_mut(width);
    [first, second, third]
}

/// Asks for what a tile will want from memory and nobody has asked for yet: where its percept goes,
/// and at the end of a row the first pigment of the next.
#[inline(always)]
fn ask_for<T>(p: &[f64], seen: &[T], from: usize, width: usize) {
    let row = p.len() / 3;
    for first in [0, row, 2 * row] {
        kernel::ask_for_run(&seen[first + from..][..width], 0);
        if from + width == row {
            kernel::ask_for_run(&p[first..][..TILE.min(row)], p.len());
        }
    }
}

/// Stores a tile of the percept; returns how many samples had to be limited.
fn stored<T: Sample>(rgb: [&[f32]; 3], row: &mut [T], from: usize) -> u64 {
    let planes = rgb.into_iter().zip(thirds(row));
    planes.map(|(rgb, out)| T::store(rgb, &mut out[from..from + rgb.len()])).sum()
}

/// Planes for a percept: recycled ones where they fit.
fn canvas(recycled: Option<Planes>, like: &Planes, half: bool) -> Planes {
    let fits = |old: &Planes| {
        (old.width, old.height, old.count) == (like.width, like.height, 3)
            && matches!(old.samples, Samples::Half(_)) == half
    };
    recycled.filter(fits).unwrap_or_else(|| {
        if half {
            Planes::half(like.width, like.height, 3)
        } else {
            Planes::float(like.width, like.height, 3)
        }
    })
}
