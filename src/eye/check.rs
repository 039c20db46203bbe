//! The sampled check: a few hundred places of the run at full model beside it, and how far the two
//! are apart.
//!
//! Full model: f64, every band, the definition of catch and illuminance at every nanometre instead
//! of levels, sub-steps that keep a run within 2.5e-5, nothing left out. 192 places are spread over
//! the picture, one in each cell of a grid; 64 are the brightest and the darkest of the first
//! frame. Places are of the retina: when the gaze has moved, each is bleached by what lies between
//! four pixels (of spectral frames, whose bands are not kept everywhere, by their moments), and its
//! catch is of the light at its own pixel of the picture. With n places spread at random and none
//! beyond a bound, fewer than 3/n of all are beyond it, with 95 % confidence.

use std::cmp::Reverse;
use std::collections::BinaryHeap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::eye::pigment::{LEAST_KEPT, Model, PigmentStep};
use crate::kinetics::Kinetics;
use crate::light::Planes;
use crate::observer::pupil;
use crate::spectrum::Curve;
use crate::units::{Millimetres, Seconds, Trolands};
use crate::vision::SampledSpectra;
use crate::vision::Vision;

/// Columns and rows of the grid of spread places.
const GRID: [usize; 2] = [16, 12];

/// How many of the brightest places are taken, and how many of the darkest.
const EXTREMES: usize = 32;

/// Places at full model and how far the run has been from them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Check {
    /// Column and row of each place.
    pub(crate) places: Vec<[usize; 2]>,
    /// Unbleached fractions at full model.
    p: Vec<[f64; 3]>,
    /// The greatest error of p and of a catch at each place so far.
    errors: Vec<[f64; 2]>,
    frames: u32,
}

/// One frame as the check needs it.
pub(crate) struct CheckFrame<'a> {
    pub(crate) vision: &'a Vision,
    pub(crate) pigments: &'a [Kinetics; 3],
    /// What each place's spectrum was, band by band; RGB is read from the planes.
    pub(crate) kept: Option<&'a SampledSpectra>,
    /// The light on the retina.
    pub(crate) planes: &'a Planes,
    /// At a place whose spectrum is kept: the share of it that reaches the retina, and the
    /// projections of the light that the eye scatters there.
    pub(crate) veil: &'a dyn Fn([usize; 2]) -> Option<(f64, Vec<f64>)>,
    pub(crate) pupil: Millimetres,
    pub(crate) gaze: [f64; 2],
    /// How far the gaze has moved from the first, in pixels.
    pub(crate) shift: [f64; 2],
    /// Cone illuminance of a place around the picture, column and row, td.
    pub(crate) around: &'a dyn Fn([i64; 2]) -> [f64; 3],
    pub(crate) pixels_per_degree: f64,
    pub(crate) duration: Seconds,
}

impl Check {
    /// A check of these places, from the fractions that the run starts with.
    pub(crate) fn new(places: Vec<[usize; 2]>, start: impl Fn([usize; 2]) -> [f64; 3]) -> Self {
        let p = places.iter().map(|&at| start(at)).collect();
        let errors = vec![[0.0; 2]; places.len()];
        Check { places, p, errors, frames: 0 }
    }

    /// Whether it is of places inside a picture of this size and has all that it needs of each.
    pub(super) fn is_sound(&self, [width, height]: [usize; 2]) -> bool {
        let count = self.places.len();
        self.places.iter().all(|[x, y]| *x < width && *y < height)
            && (self.p.len(), self.errors.len()) == (count, count)
            && self.p.iter().flatten().all(|p| (0.0..=1.0).contains(p))
            && self.errors.iter().flatten().all(|error| *error >= 0.0)
    }

    /// Moves the places by one frame and compares them with the run's fractions after it.
    pub(crate) fn follow(&mut self, frame: &CheckFrame<'_>, run: impl Fn([usize; 2]) -> [f64; 3]) {
        self.frames += 1;
        let still = frame.shift == [0.0, 0.0];
        let central = frame.weights(0.0);
        let step = PigmentStep::new(*frame.pigments, Model::Unbleached, frame.duration);
        for (i, &at) in self.places.iter().enumerate() {
            let light = frame.light(i, at);
            let td = if still {
                frame.with_veil(frame.illuminance(&light, at, &central), at)
            } else {
                frame.between(at, &central)
            };
            let before = self.p[i];
            let after = [0, 1, 2]
                .map(|k| step.exact(LEAST_KEPT, &frame.pigments[k], before[k], Trolands(td[k])));
            self.p[i] = after;
            let ours = run(at);
            let [mut of_p, mut of_catch] = self.errors[i];
            of_p = (0..3).map(|k| (ours[k] - after[k]).abs()).fold(of_p, worst);
            // Catches by the definition take a power at every nanometre: now and then is enough.
            if self.frames.is_power_of_two() {
                of_catch = worst(of_catch, frame.error_of_catch(&light, at, ours, after));
            }
            self.errors[i] = [of_p, of_catch];
        }
    }

    /// The largest error of p and of a catch.
    pub fn largest(&self) -> [f64; 2] {
        [0, 1].map(|which| self.errors(which).fold(0.0, worst))
    }

    fn errors(&self, which: usize) -> impl Iterator<Item = f64> + '_ {
        self.errors.iter().map(move |errors| errors[which])
    }

    /// For the report.
    pub(crate) fn report(&self) -> Value {
        let [p, catch] = self.largest();
        json!({
            "samples": self.places.len(),
            "frames": self.frames,
            "max_error_p": p,
            "max_error_catch": catch,
            "p95_error_p": percentile(self.errors(0).collect()),
            "p95_error_catch": percentile(self.errors(1).collect()),
        })
    }

    /// A sentence on the places beyond a budget; `None` if there are none.
    pub(crate) fn beyond(&self, budget: f64) -> Option<String> {
        let errors = self.errors(0).zip(self.errors(1)).map(|(a, b)| a.max(b));
        let beyond: Vec<_> =
            self.places.iter().zip(errors).filter(|(_, error)| *error > budget).collect();
        let named: Vec<String> = beyond
            .iter()
            .take(8)
            .map(|([x, y], error)| format!("({x}, {y}) by {error:.1e}"))
            .collect();
        (!beyond.is_empty()).then(|| {
            format!(
                "{} of {} checked places are beyond the budget of {budget:.1e}: {}",
                beyond.len(),
                self.places.len(),
                named.join(", ")
            )
        })
    }
}

impl CheckFrame<'_> {
    fn light(&self, i: usize, [x, y]: [usize; 2]) -> Vec<f64> {
        match self.kept {
            Some(kept) => {
                let share = (self.veil)([x, y]).map_or(1.0, |(share, _)| share);
                kept.spectrum(i).into_iter().map(|v| share * v).collect()
            }
            None => (0..self.planes.count).map(|plane| self.planes.at(x, y, plane)).collect(),
        }
    }

    /// Cone illuminance of a pixel by the definition, td. `central`: the weights where the distance
    /// from the gaze does not matter.
    fn illuminance(&self, light: &[f64], at: [usize; 2], central: &[Vec<f64>; 3]) -> [f64; 3] {
        illuminance(self.distance(at).map(|r| self.weights(r)).as_ref().unwrap_or(central), light)
    }

    /// Cone illuminance with that of the light which the eye scatters to a place whose spectrum is
    /// kept: of its projections, for its spectrum is nowhere.
    fn with_veil(&self, td: [f64; 3], at: [usize; 2]) -> [f64; 3] {
        let veil = self.kept.and_then(|_| (self.veil)(at));
        let r = Millimetres(self.distance(at).unwrap_or(0.0));
        let weights = || self.vision.illuminance_weights(self.pupil, r);
        let of_veil = veil.map(|(_, veil)| self.vision.illuminance(&veil, &weights()));
        of_veil.map_or(td, |of_veil| [0, 1, 2].map(|k| td[k] + of_veil[k]))
    }

    /// Cone illuminance of a place of the retina that sees between four pixels, td.
    fn between(&self, place: [usize; 2], central: &[Vec<f64>; 3]) -> [f64; 3] {
        let at = [0, 1].map(|i| place[i] as f64 + self.shift[i]);
        let share = |t: f64, far: usize| if far == 1 { t } else { 1.0 - t };
        let mut sum = [0.0; 3];
        for [x, y] in [[0, 0], [1, 0], [0, 1], [1, 1]] {
            let weight = share(at[0] - at[0].floor(), x) * share(at[1] - at[1].floor(), y);
            let td = self.of_pixel(
                [at[0].floor() as i64 + x as i64, at[1].floor() as i64 + y as i64],
                central,
            );
            sum = [0, 1, 2].map(|k| sum[k] + if weight > 0.0 { weight * td[k] } else { 0.0 });
        }
        sum
    }

    /// Cone illuminance of a pixel, or of what lies around the picture, td.
    fn of_pixel(&self, [x, y]: [i64; 2], central: &[Vec<f64>; 3]) -> [f64; 3] {
        if x < 0 || y < 0 || x >= self.planes.width as i64 || y >= self.planes.height as i64 {
            return (self.around)([x, y]);
        }
        let at = [x as usize, y as usize];
        if self.kept.is_some() {
            let moments = self.vision.moments(self.planes, at[0], at[1]);
            let r = Millimetres(self.distance(at).unwrap_or(0.0));
            return self
                .vision
                .illuminance(&moments, &self.vision.illuminance_weights(self.pupil, r));
        }
        let light: Vec<f64> =
            (0..self.planes.count).map(|plane| self.planes.at(at[0], at[1], plane)).collect();
        self.illuminance(&light, at, central)
    }

    /// Distance of a place from the pupil's centre, where the reading of the Stiles-Crawford weight
    /// asks for it.
    fn distance(&self, [x, y]: [usize; 2]) -> Option<f64> {
        let scale = self.vision.observer.directional.mm_per_degree()? / self.pixels_per_degree;
        Some(scale * (x as f64 - self.gaze[0]).hypot(y as f64 - self.gaze[1]))
    }

    /// Weights of each stored plane in each cone's illuminance, from the definition.
    fn weights(&self, r: f64) -> [Vec<f64>; 3] {
        let observer = &self.vision.observer;
        let eta = observer.directional.exact(self.pupil, Millimetres(r));
        [0, 1, 2].map(|k| {
            let seen = eta.times(observer.fundamentals.unbleached(k));
            let scale =
                observer.lumens_per_watt * observer.cone_troland()[k] * pupil::area(self.pupil);
            self.vision.basis().iter().map(|light| scale * light.times(&seen).integral()).collect()
        })
    }

    /// The largest error of a catch: by levels at the run's p, against the definition at the true
    /// one, relative to what the light's parts catch, each taken as light.
    fn error_of_catch(
        &self,
        light: &[f64],
        [x, y]: [usize; 2],
        ours: [f64; 3],
        p: [f64; 3],
    ) -> f64 {
        let (mut radiance, mut parts) = (Curve::sampled(|_| 0.0), Curve::sampled(|_| 0.0));
        for (value, basis) in light.iter().zip(self.vision.basis()) {
            radiance.0.iter_mut().zip(&basis.0).for_each(|(sum, b)| *sum += value * b);
            parts.0.iter_mut().zip(&basis.0).for_each(|(sum, b)| *sum += (value * b).abs());
        }
        let [exact, size] =
            [radiance, parts].map(|radiance| self.vision.observer.catch(&radiance, p));
        let veil = self.kept.and_then(|_| (self.veil)([x, y]));
        let veil = veil.map_or([0.0; 3], |(_, veil)| self.vision.catch(&veil, p));
        let exact = [0, 1, 2].map(|k| exact[k] + veil[k]);
        let size = [0, 1, 2].map(|k| size[k] + veil[k].abs());
        let seen = self.vision.catch(&self.vision.moments(self.planes, x, y), ours);
        (0..3)
            .filter(|&k| size[k] > 0.0)
            .map(|k| (seen[k] - exact[k]).abs() / size[k])
            .fold(0.0, worst)
    }
}

/// The larger of two errors. What is no number is an error without a limit.
fn worst(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}

fn illuminance(weights: &[Vec<f64>; 3], light: &[f64]) -> [f64; 3] {
    weights
        .each_ref()
        .map(|weights| weights.iter().zip(light).map(|(w, v)| w * v).sum::<f64>().max(0.0))
}

/// The error that 95 % of the places stay within.
fn percentile(mut errors: Vec<f64>) -> f64 {
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() * 95 / 100).copied().unwrap_or(0.0)
}

/// Keeps the [`EXTREMES`] least of what is shown to it.
fn keep<T: Ord>(least: &mut BinaryHeap<T>, value: T) {
    if least.len() < EXTREMES {
        least.push(value);
    } else if let Some(mut last) = least.peek_mut()
        && value < *last
    {
        *last = value;
    }
}

/// Where the [`EXTREMES`] least and as many greatest of some values stand.
fn extremes(values: impl Iterator<Item = f32>) -> Vec<usize> {
    let (mut least, mut greatest) = (BinaryHeap::new(), BinaryHeap::new());
    for (i, value) in values.enumerate() {
        // As integers in the order of `f32::total_cmp`.
        let bits = value.to_bits() as i32;
        let ranked = (bits ^ (((bits >> 31) as u32) >> 1) as i32, i);
        keep(&mut least, ranked);
        keep(&mut greatest, Reverse(ranked));
    }
    let least = least.into_iter().map(|(_, i)| i);
    least.chain(greatest.into_iter().map(|Reverse((_, i))| i)).collect()
}

/// The places to check: one in each cell of a grid, and the extremes of a frame's luminance.
pub fn places(vision: &Vision, planes: &Planes) -> Vec<[usize; 2]> {
    let [width, height] = [planes.width, planes.height];
    let jittered = (0..GRID[0] * GRID[1]).map(|i| {
        let cell = [i % GRID[0], i / GRID[0]];
        let within = [jitter(2 * i as u64), jitter(2 * i as u64 + 1)];
        let along = |axis: usize, n: usize| {
            let at = (cell[axis] as f64 + within[axis]) / GRID[axis] as f64 * n as f64;
            (at as usize).min(n - 1)
        };
        [along(0, width), along(1, height)]
    });
    let mut places: Vec<[usize; 2]> = jittered.collect();
    let light = (0..width * height).map(|i| luminance(vision, planes, [i % width, i / width]));
    if width * height > EXTREMES {
        places.extend(extremes(light).into_iter().map(|i| [i % width, i / width]));
    }
    places.sort_by_key(|&[x, y]| [y, x]);
    places.dedup();
    places
}

fn luminance(vision: &Vision, planes: &Planes, [x, y]: [usize; 2]) -> f32 {
    let terms = vision.luminance.iter().enumerate().filter(|(_, w)| **w != 0.0);
    terms.map(|(i, w)| w * planes.at(x, y, i)).sum::<f64>() as f32
}

/// A number from 0 to 1 that looks like chance and is always the same (splitmix64).
fn jitter(i: u64) -> f64 {
    let mut z = (i + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15);
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    (z ^ (z >> 31)) as f64 / u64::MAX as f64
}

/// Room for the spectra of the places, to be filled while a frame is decoded.
pub(crate) fn room(vision: &Vision, places: &[[usize; 2]]) -> Option<Arc<SampledSpectra>> {
    vision.projection().map(|_| Arc::new(SampledSpectra::new(places)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Primaries;
    use crate::kinetics::Law;
    use crate::light::Samples;
    use crate::observer::Observer;
    use crate::step;
    use crate::units::Nits;

    fn frame<'a>(
        vision: &'a Vision,
        pigments: &'a [Kinetics; 3],
        planes: &'a Planes,
        duration: Seconds,
    ) -> CheckFrame<'a> {
        CheckFrame {
            vision,
            pigments,
            kept: None,
            veil: &|_| None,
            planes,
            pupil: Millimetres(3.0),
            gaze: [0.0; 2],
            shift: [0.0; 2],
            around: &|_| [0.0; 3],
            pixels_per_degree: 1.0,
            duration,
        }
    }

    #[test]
    fn extremes_are_those_of_a_sorted_list() {
        let values: Vec<f32> =
            (0..5000).map(|i| ((i * 7919) % 997) as f32 - 400.0).chain([-0.0, 0.0]).collect();
        let mut ranked: Vec<usize> = (0..values.len()).collect();
        ranked.sort_by(|&a, &b| values[a].total_cmp(&values[b]).then(a.cmp(&b)));
        let mut expected: Vec<usize> =
            [&ranked[..EXTREMES], &ranked[ranked.len() - EXTREMES..]].concat();
        let mut found = extremes(values.iter().copied());
        expected.sort_unstable();
        found.sort_unstable();
        assert_eq!(found, expected);
    }

    #[test]
    fn long_steps_of_a_law_without_a_closed_form_are_no_error_of_the_run() {
        let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(1.0)).unwrap();
        let law = Law::RateLimited { km: 0.2 };
        let pigments = [Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) }; 3];
        let planes =
            Planes { width: 1, height: 1, count: 3, samples: Samples::Float(vec![1e4; 3]) };
        for duration in [10.0, 100.0, 1000.0].map(Seconds) {
            let frame = frame(&vision, &pigments, &planes, duration);
            let mut check = Check::new(vec![[0, 0]], |_| [1.0; 3]);
            let td = frame.illuminance(&[1e4; 3], [0, 0], &frame.weights(0.0));
            let truth = [0, 1, 2]
                .map(|k| step::enclosed(&pigments[k], 1.0, Trolands(td[k]), duration, 1 << 14).p);
            check.follow(&frame, |_| truth);
            assert!(check.largest()[0] < LEAST_KEPT, "{duration}: {:e}", check.largest()[0]);
        }
    }

    /// BT.2020: monochromatic lights, whose RGB spectra have large negative parts.
    const BT2020: Primaries = Primaries {
        red: [0.708, 0.292],
        green: [0.170, 0.797],
        blue: [0.131, 0.046],
        white: [0.3127, 0.3290],
    };

    #[test]
    fn the_bound_of_the_levels_holds_for_every_mixture_of_any_primaries_and_for_light_out_of_them()
    {
        let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
        for primaries in [Primaries::REC709, BT2020] {
            let vision = Vision::of_rgb(Observer::standard(), &primaries, Nits(1.0)).unwrap();
            let bound = vision.levels_bound() + 1e-6;
            for i in 1..400 {
                let value =
                    |digit: i32| [1.0, 0.0, 0.3, 0.02, 1e-5, -1e-4, -0.05, 0.7][digit as usize];
                let light = [i % 8, i / 8 % 8, i / 64].map(value);
                let samples = Samples::Float(light.map(|v| v as f32).into());
                let planes = Planes { width: 1, height: 1, count: 3, samples };
                let frame = frame(&vision, &pigments, &planes, Seconds(1.0));
                let light = [0, 1, 2].map(|plane| planes.at(0, 0, plane));
                for p in [0.02, 0.5, 0.9] {
                    let error = frame.error_of_catch(&light, [0, 0], [p; 3], [p; 3]);
                    assert!(error <= bound, "{light:?} at {p}: {error:e} of {bound:e}");
                }
            }
        }
    }
}
