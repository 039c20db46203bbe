//! Course of pigment within frames: the law itself between the ends that a table tells, not chords.
//!
//! ```text
//! p' = rho (1 - p) - beta p     under light held from the start of a frame to its end
//! ```
//!
//! First-order kinetics have the closed form p(t) = p_s + (p_0 - p_s) exp(-lambda t); the other laws
//! are followed from sample to sample by the step that runs use, which there errs by far less than
//! the width of a line.

use crate::kinetics::Kinetics;
use crate::step;
use crate::units::{Seconds, Trolands};

use super::axes::Axis;

/// One frame of one class of cones: light of `light` td held over `from..=to` s, with `p` of the
/// pigment unbleached at `from`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Held {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) p: f64,
    pub(crate) light: f64,
}

/// Steps between two samples, for the laws that have no closed form.
const SUBSTEPS: u32 = 8;

impl Held {
    /// Unbleached fractions at times of the frame, ascending, s.
    pub(crate) fn fractions(&self, kinetics: &Kinetics, times: &[f64]) -> Vec<f64> {
        let (mut p, mut now) = (self.p, self.from);
        let follow = |&time: &f64| {
            let dt = Seconds((time - now).max(0.0));
            p = step::advance(kinetics, p, Trolands(self.light), dt, SUBSTEPS);
            now = time;
            p
        };
        times.iter().map(follow).collect()
    }

    /// The unbleached fraction at the end.
    pub(crate) fn end(&self, kinetics: &Kinetics) -> f64 {
        let dt = Seconds(self.to - self.from);
        step::advance(kinetics, self.p, Trolands(self.light), dt, 8 * SUBSTEPS)
    }
}

/// Moments of a frame after its start, so close that chords between them look like the curve: even
/// on the axis, `samples` to its whole length, and the frame's end.
pub(crate) fn moments(axis: &Axis, from: f64, to: f64, samples: usize) -> Vec<f64> {
    let on_axis = (0..=samples).map(|i| axis.value(i as f64 / samples as f64));
    on_axis.filter(|&time| time > from && time < to).chain([to]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinetics::Law;

    const SAMPLES: usize = 200;

    #[test]
    fn the_course_of_the_first_order_law_is_its_closed_form() {
        let kinetics = Kinetics::first_order(Trolands(2e4), Seconds(120.0));
        for axis in [Axis::linear(0.0, 600.0, 5.0, ""), Axis::logarithmic(0.1, 600.0, 5.0, "")] {
            for light in [0.0, 3e3, 1e7] {
                let held = Held { from: 30.0, to: 600.0, p: 0.3, light };
                let times = moments(&axis, held.from, held.to, SAMPLES);
                let s = light / 2e4;
                for (time, p) in times.iter().zip(held.fractions(&kinetics, &times)) {
                    let kept = (-(time - 30.0) * (1.0 + s) / 120.0).exp();
                    let exact = 1.0 / (1.0 + s) + (0.3 - 1.0 / (1.0 + s)) * kept;
                    assert!((p - exact).abs() < 1e-12, "{p} {exact} after {time} s of {light} td");
                }
            }
        }
    }

    /// Beside Radau IIA of order 5 in small steps.
    #[test]
    fn the_courses_of_the_other_laws_are_true_to_a_thousandth() {
        let laws = Law::NAMES[1..].iter().map(|(_, law)| law.with(0.5, 0.2));
        let radau = step::Method::named("radau-iia-5").unwrap();
        for law in laws {
            let kinetics = Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) };
            for (light, p) in [(0.0, 0.02), (1e6, 1.0), (2e4, 1.0)] {
                let held = Held { from: 0.0, to: 300.0, p, light };
                let times = moments(&Axis::linear(0.0, 300.0, 5.0, ""), 0.0, 300.0, SAMPLES);
                for (time, p) in times.iter().zip(held.fractions(&kinetics, &times)) {
                    let dt = Seconds(*time);
                    let truth = radau.hold(&kinetics, held.p, Trolands(light), dt, 4000);
                    assert!((p - truth).abs() < 1e-3, "{law:?}: {p} {truth} at {time} s");
                }
            }
        }
    }

    #[test]
    fn moments_end_with_the_frame_and_are_even_on_the_axis() {
        let axis = Axis::logarithmic(1e-2, 1e2, 5.0, "");
        assert_eq!(moments(&axis, 0.0, 1e-3, 4), [1e-3]);
        let times = moments(&axis, 0.0, 20.0, 4);
        assert_eq!(times.len(), 5);
        approx::assert_relative_eq!(times[1] / times[0], 10.0, max_relative = 1e-9);
        assert_eq!(times[4], 20.0);
    }
}
