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

mod frame;
mod places;

use serde::{Deserialize, Serialize};
use serde_json::{Value, json};

use crate::eye::pigment::{LEAST_KEPT, Model, PigmentStep};
use crate::units::Trolands;

pub(crate) use frame::CheckFrame;
pub use places::places;
pub(crate) use places::room;

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

/// The larger of two errors. What is no number is an error without a limit.
fn worst(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::INFINITY } else { a.max(b) }
}

/// The error that 95 % of the places stay within.
fn percentile(mut errors: Vec<f64>) -> f64 {
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len() * 95 / 100).copied().unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::colour::Primaries;
    use crate::kinetics::{Kinetics, Law};
    use crate::light::Planes;
    use crate::light::Samples;
    use crate::observer::Observer;
    use crate::step;
    use crate::units::Nits;
    use crate::units::{Millimetres, Seconds};
    use crate::vision::Vision;

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
