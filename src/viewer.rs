//! A staring viewer: an observer and a retina in time. One look takes a frame's light to the percept.
//!
//!     adapting luminance -> pupil -> per row: cone illuminance -> pigment -> percept
//!
//! With a still gaze the whole way is one pass over a row. With a moved gaze it is two: the light's way to the
//! retina ([`Viewer::expose`]) and the percept's way back ([`Viewer::perceive`]), each with its own resampling.

use rayon::prelude::*;

use crate::display::{Cells, Survey};
use crate::eye::{Adapting, Pupil};
use crate::kernel::{self, PerceptForm};
use crate::kinetics::Kinetics;
use crate::light::{Planes, Sample, Samples};
use crate::percept::Vision;
use crate::retina::{Advance, Model, Retina};
use crate::units::{Degrees, Millimetres, Nits, Seconds};

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
    form: PerceptForm,
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

/// What was met at the places of the retina that the look covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Census {
    /// Greatest cone illuminance, td.
    pub greatest: [f64; 3],
    /// Least unbleached fraction.
    pub least: [f64; 3],
    /// Places that have lost more than half of their S pigment.
    pub s_past_half: u64,
    /// Percept samples that a half float could not hold.
    pub limited: u64,
}

impl Census {
    const EMPTY: Census = Census { greatest: [0.0; 3], least: [1.0; 3], s_past_half: 0, limited: 0 };

    fn and(self, other: Census) -> Census {
        Census {
            greatest: [0, 1, 2].map(|k| self.greatest[k].max(other.greatest[k])),
            least: [0, 1, 2].map(|k| self.least[k].min(other.least[k])),
            s_past_half: self.s_past_half + other.s_past_half,
            limited: self.limited + other.limited,
        }
    }
}

impl Viewer {
    /// A viewer of pictures of this size; the retina must have it too.
    pub fn new(vision: Vision, pigments: [Kinetics; 3], model: Model, retina: Retina, pixels_per_degree: f64) -> Self {
        let pupil = Pupil::new(vision.observer.pupil, vision.observer.dynamics);
        let form = PerceptForm::new(&vision);
        Viewer {
            vision,
            pigments,
            model,
            retina,
            pupil,
            pixels_per_degree,
            surround: Nits(0.0),
            first_gaze: None,
            form,
            fields: Vec::new(),
        }
    }

    /// What the pupil responds to: the mean over the fovea around the gaze (pixels) and over the picture.
    pub fn adapting(&self, planes: &Planes, survey: &Survey, gaze: [f64; 2]) -> Adapting {
        let area = (planes.width * planes.height) as f64 / self.pixels_per_degree.powi(2);
        let fovea = self.foveal_mean(planes, gaze);
        Adapting { fovea: Nits(fovea), picture: Nits(survey.mean), area_deg2: area }
    }

    /// Mean luminance of the pixels whose centres lie in the fovea; the nearest pixel if none does.
    fn foveal_mean(&self, planes: &Planes, gaze: [f64; 2]) -> f64 {
        let weights = &self.vision.luminance;
        let luminance = |x: usize, y: usize| {
            let sum: f64 =
                weights.iter().enumerate().filter(|(_, w)| **w != 0.0).map(|(i, w)| w * planes.at(x, y, i)).sum();
            sum.max(0.0)
        };
        let (mut sum, mut count) = (0.0, 0u32);
        for [x, y] in self.fovea(planes.width, planes.height, gaze) {
            sum += luminance(x, y);
            count += 1;
        }
        if count > 0 {
            return sum / f64::from(count);
        }
        let nearest = |v: f64, n: usize| (v.round().max(0.0) as usize).min(n - 1);
        luminance(nearest(gaze[0], planes.width), nearest(gaze[1], planes.height))
    }

    /// The pixels of a picture whose centres lie within the fovea around a gaze.
    pub fn fovea(&self, width: usize, height: usize, gaze: [f64; 2]) -> impl Iterator<Item = [usize; 2]> {
        let Degrees(across) = self.vision.observer.fovea;
        let radius = across / 2.0 * self.pixels_per_degree;
        let span = move |centre: f64, n: usize| {
            let from = (centre - radius).ceil().max(0.0) as usize;
            let to = (centre + radius).floor().min(n as f64 - 1.0);
            from..(to.max(-1.0) + 1.0) as usize
        };
        let inside = move |x: usize, y: usize| {
            let (dx, dy) = (x as f64 - gaze[0], y as f64 - gaze[1]);
            dx * dx + dy * dy <= radius * radius
        };
        span(gaze[1], height)
            .flat_map(move |y| span(gaze[0], width).map(move |x| [x, y]))
            .filter(move |&[x, y]| inside(x, y))
    }

    /// Looks at a frame for a while. `gaze`: where, in pixels.
    pub fn look(&mut self, planes: &Planes, survey: &Survey, gaze: [f64; 2], duration: Seconds) -> Look {
        let first = *self.first_gaze.get_or_insert(gaze);
        let shift = [gaze[0] - first[0], gaze[1] - first[1]];
        let adapting = self.adapting(planes, survey, gaze);
        let pupil = self.pupil.follow(adapting, duration);
        let (seen, census) = match &planes.samples {
            Samples::Half(_) if self.vision.projection().is_none() => {
                let (rows, census) = self.rows(planes, pupil, gaze, shift, duration);
                (Samples::Half(rows), census)
            }
            _ => {
                let (rows, census) = self.rows(planes, pupil, gaze, shift, duration);
                (Samples::Float(rows), census)
            }
        };
        let seen = Planes { width: planes.width, height: planes.height, count: 3, samples: seen };
        Look { seen, adapting: adapting.fovea, pupil, shift, census }
    }

    fn rows<T: Sample + Default>(
        &mut self,
        planes: &Planes,
        pupil: Millimetres,
        gaze: [f64; 2],
        shift: [f64; 2],
        duration: Seconds,
    ) -> (Vec<T>, Census) {
        let mut seen = vec![T::default(); 3 * planes.width * planes.height];
        let still = shift == [0.0, 0.0]
            && self.retina.origin() == [0, 0]
            && self.retina.size() == [planes.width, planes.height];
        let census = if still {
            self.look_still(planes, pupil, gaze, duration, &mut seen)
        } else {
            let exposed = self.expose(planes, pupil, gaze, shift, duration);
            exposed.and(self.perceive(planes, shift, &mut seen))
        };
        (seen, census)
    }

    /// One pass over each row: light, pigment, percept.
    fn look_still<T: Sample>(
        &mut self,
        planes: &Planes,
        pupil: Millimetres,
        gaze: [f64; 2],
        duration: Seconds,
        seen: &mut [T],
    ) -> Census {
        let Viewer { vision, pigments, model, retina, form, pixels_per_degree, .. } = self;
        let advance = Advance { pigments, model: *model, duration };
        let sight = Sight { vision, pupil, gaze, pixels_per_degree: *pixels_per_degree };
        let weights = sight.weights_at(Millimetres(0.0));
        let width = planes.width;
        let scratch = || (vec![0.0; width * planes.count], vec![0.0; 3 * width], vec![0.0; 3 * width]);
        retina
            .par_rows_mut()
            .zip(seen.par_chunks_exact_mut(3 * width))
            .enumerate()
            .map_init(scratch, |(light, td, rgb), (y, (p, seen))| {
                let row = planes.row(y);
                let light = row.as_f32(light);
                if !matches!(advance.model, Model::Unbleached) {
                    sight.illuminance(light, &weights, y, td);
                    advance.row(td, p);
                }
                kernel::percept(form, light, p, rgb);
                census_of(td, p).and(Census { limited: T::store(rgb, seen), ..Census::EMPTY })
            })
            .reduce(|| Census::EMPTY, Census::and)
    }

    /// The light's way to the retina: cone illuminance of the picture, resampled to the places, moves their pigment.
    fn expose(&mut self, planes: &Planes, pupil: Millimetres, gaze: [f64; 2], shift: [f64; 2], dt: Seconds) -> Census {
        if matches!(self.model, Model::Unbleached) {
            return Census::EMPTY;
        }
        let surround = self.surround_illuminance(pupil);
        self.fields.resize(3 * planes.width * planes.height, 0.0);
        let sight = Sight { vision: &self.vision, pupil, gaze, pixels_per_degree: self.pixels_per_degree };
        let weights = sight.weights_at(Millimetres(0.0));
        let scratch = || vec![0.0; planes.width * planes.count];
        self.fields.par_chunks_exact_mut(3 * planes.width).enumerate().for_each_init(scratch, |light, (y, td)| {
            sight.illuminance(planes.row(y).as_f32(light), &weights, y, td);
        });
        let edge = |i: usize, n: usize| [(-shift[i]).floor() as i64, (n as f64 - 1.0 - shift[i]).ceil() as i64];
        let ([left, right], [top, bottom]) = (edge(0, planes.width), edge(1, planes.height));
        self.retina.cover([left, top], [right, bottom]);
        let advance = Advance { pigments: &self.pigments, model: self.model, duration: dt };
        self.retina.advance_beyond(&advance, surround);
        let field = Field {
            samples: &self.fields,
            width: planes.width,
            height: planes.height,
            around: surround.map(|v| v as f32),
        };
        let ([x0, y0], [width, _]) = (self.retina.origin(), self.retina.size());
        self.retina
            .par_rows_mut()
            .enumerate()
            .map_init(
                || vec![0.0; 3 * width],
                |td, (row, p)| {
                    field.resample([x0 as f64 + shift[0], (y0 + row as i64) as f64 + shift[1]], td);
                    advance.row(td, p);
                    census_of(td, p)
                },
            )
            .reduce(|| Census::EMPTY, Census::and)
    }

    /// The percept's way back: p is read at the picture's points, and the picture's own light is seen through it.
    fn perceive<T: Sample>(&self, planes: &Planes, shift: [f64; 2], seen: &mut [T]) -> Census {
        let ([x0, y0], [width, height]) = (self.retina.origin(), self.retina.size());
        let pigment = Field { samples: self.retina.fractions(), width, height, around: self.retina.beyond() };
        let scratch =
            || (vec![0.0; planes.width * planes.count], vec![0.0; 3 * planes.width], vec![0.0; 3 * planes.width]);
        seen.par_chunks_exact_mut(3 * planes.width)
            .enumerate()
            .map_init(scratch, |(light, p, rgb), (y, seen)| {
                pigment.resample([-shift[0] - x0 as f64, y as f64 - shift[1] - y0 as f64], p);
                kernel::percept(&self.form, planes.row(y).as_f32(light), p, rgb);
                Census { limited: T::store(rgb, seen), ..Census::EMPTY }
            })
            .reduce(|| Census::EMPTY, Census::and)
    }

    /// Cone illuminance of the light around the picture, an equal-energy spectrum, td.
    fn surround_illuminance(&self, pupil: Millimetres) -> [f64; 3] {
        let moments = self.vision.equal_energy_moments();
        let weights = self.vision.illuminance_weights(pupil, Millimetres(f64::INFINITY));
        self.vision.illuminance(&moments, &weights).map(|td| td * self.surround.0)
    }

    /// Cone illuminance of one point of a picture, td.
    pub fn illuminance_at(&self, planes: &Planes, pupil: Millimetres, gaze: [f64; 2], [x, y]: [usize; 2]) -> [f64; 3] {
        let sight = Sight { vision: &self.vision, pupil, gaze, pixels_per_degree: self.pixels_per_degree };
        let r = sight.distance(x, y).unwrap_or(Millimetres(0.0));
        self.vision.illuminance(&self.vision.moments(planes, x, y), &self.vision.illuminance_weights(pupil, r))
    }

    /// Unbleached fractions at one point of a picture.
    pub fn fractions_at(&self, shift: [f64; 2], [x, y]: [usize; 2]) -> [f64; 3] {
        let ([x0, y0], [width, height]) = (self.retina.origin(), self.retina.size());
        let pigment = Field { samples: self.retina.fractions(), width, height, around: self.retina.beyond() };
        let mut p = [0.0; 3];
        pigment.resample([x as f64 - shift[0] - x0 as f64, y as f64 - shift[1] - y0 as f64], &mut p);
        p
    }
}

/// Luminances of a frame, gathered for the pupil and the display.
pub fn survey(vision: &Vision, planes: &Planes, pixels_per_degree: f64) -> Survey {
    let cells = Cells::new(planes.width, planes.height, pixels_per_degree);
    let weights: Vec<f32> = vision.luminance.iter().map(|&w| w as f32).collect();
    let scratch = || (vec![0.0; planes.width * planes.count], vec![0.0; planes.width]);
    let rows: Vec<_> = (0..planes.height)
        .into_par_iter()
        .map_init(scratch, |(light, luminance), y| {
            kernel::combine(planes.row(y).as_f32(light), &weights, luminance);
            cells.row(luminance)
        })
        .collect();
    cells.gather(rows)
}

fn census_of(td: &[f32], p: &[f64]) -> Census {
    let width = td.len() / 3;
    let greatest = [0, 1, 2].map(|k| f64::from(td[k * width..][..width].iter().copied().fold(0.0, f32::max)));
    let (least, s_past_half) = Retina::extremes(p);
    Census { greatest, least, s_past_half, limited: 0 }
}

/// How planes become cone illuminance under one pupil and gaze.
struct Sight<'a> {
    vision: &'a Vision,
    pupil: Millimetres,
    gaze: [f64; 2],
    pixels_per_degree: f64,
}

impl Sight<'_> {
    /// Weights of the planes in each cone's illuminance, at a distance from the pupil's centre.
    fn weights_at(&self, r: Millimetres) -> [Vec<f32>; 3] {
        let of_moments = self.vision.illuminance_weights(self.pupil, r);
        let first = self.vision.moment_count() - 3 * of_moments[0].len();
        [0, 1, 2].map(|k| {
            let levels = of_moments[k].iter().enumerate();
            let mut sum: Vec<f64> = vec![0.0; self.vision.moment_weights(0).len()];
            for (j, weight) in levels {
                let planes = self.vision.moment_weights(first + k * of_moments[k].len() + j);
                sum.iter_mut().zip(planes).for_each(|(total, w)| *total += weight * w);
            }
            sum.into_iter().map(|w| w as f32).collect()
        })
    }

    /// Distance on the pupil's plane that the paper's reading gives a pixel; `None` in the others.
    fn distance(&self, x: usize, y: usize) -> Option<Millimetres> {
        let scale = self.vision.observer.directional.mm_per_degree()? / self.pixels_per_degree;
        Some(Millimetres(scale * (x as f64 - self.gaze[0]).hypot(y as f64 - self.gaze[1])))
    }

    /// Cone illuminance of one row.
    fn illuminance(&self, light: &[f32], weights: &[Vec<f32>; 3], y: usize, td: &mut [f32]) {
        if self.distance(0, y).is_none() {
            return kernel::illuminance(light, weights, td);
        }
        let width = td.len() / 3;
        for x in 0..width {
            let r = self.distance(x, y).unwrap_or(Millimetres(0.0));
            for (k, weights) in self.weights_at(r).iter().enumerate() {
                let sum: f32 = weights.iter().enumerate().map(|(i, w)| w * light[i * width + x]).sum();
                td[k * width + x] = sum.max(0.0);
            }
        }
    }
}

/// Three planes, row by row, that can be read between their samples.
struct Field<'a, T> {
    samples: &'a [T],
    width: usize,
    height: usize,
    /// What lies outside.
    around: [T; 3],
}

/// A number between two others; exactly theirs where they are equal.
trait Between: Copy {
    fn between(self, other: Self, t: f64) -> Self;
}

impl Between for f32 {
    fn between(self, other: f32, t: f64) -> f32 {
        self + t as f32 * (other - self)
    }
}

impl Between for f64 {
    fn between(self, other: f64, t: f64) -> f64 {
        self + t * (other - self)
    }
}

impl<T: Between> Field<'_, T> {
    /// Reads a row of three planes that begins at `from` and goes on in steps of one sample. Whole steps are exact.
    fn resample(&self, from: [f64; 2], out: &mut [T]) {
        let width = out.len() / 3;
        let (left, top) = (from[0].floor(), from[1].floor());
        let (u, v) = (from[0] - left, from[1] - top);
        for (k, out) in out.chunks_exact_mut(width).enumerate() {
            for (x, out) in out.iter_mut().enumerate() {
                let (x, y) = (left as i64 + x as i64, top as i64);
                let row = |y: i64| {
                    let here = self.sample(x, y, k);
                    if u == 0.0 { here } else { here.between(self.sample(x + 1, y, k), u) }
                };
                *out = if v == 0.0 { row(y) } else { row(y).between(row(y + 1), v) };
            }
        }
    }

    fn sample(&self, x: i64, y: i64, k: usize) -> T {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return self.around[k];
        }
        self.samples[(y as usize * 3 + k) * self.width + x as usize]
    }
}
