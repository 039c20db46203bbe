//! The exact first-order step under held light, over a run of places:
//!
//! ```text
//! a = 1 + I/I0,   z = (h/tau) a,   p1 = 1/a + e^-z (p - 1/a)
//! z <= 1/8:       p1 = p + (h/tau) phi(z) (1 - a p),   phi(z) = (1 - e^-z)/z
//! ```
//!
//! The second form needs no division and does not cancel where little happens. Which one a place takes depends on
//! its own light only; the greatest light of a tile decides whether the first is computed at all. In the dark p = 1
//! stays 1 bit for bit, infinite light leaves 0.

use pulp::{Simd, WithSimd};

use super::decay::{SHORT, decay, mean_decay_short};
use super::extremes::greatest_of;
use super::{TILE, vectorised};
use crate::kinetics::Kinetics;
use crate::units::Seconds;

/// The constants of one cone class for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrderForm {
    per_half_bleach: f64,
    steps_of_tau: f64,
}

impl FirstOrderForm {
    /// For a pigment and a step.
    pub fn new(pigment: &Kinetics, dt: Seconds) -> Self {
        FirstOrderForm { per_half_bleach: 1.0 / pigment.half_bleach.0, steps_of_tau: dt.0 / pigment.tau.0 }
    }

    #[inline(always)]
    fn rate(self, light: f32) -> f64 {
        1.0 + f64::from(light) * self.per_half_bleach
    }

    #[inline(always)]
    fn short_step(self, a: f64, z: f64, p: f64) -> f64 {
        p + self.steps_of_tau * mean_decay_short(z) * (1.0 - a * p)
    }
}

struct Relax<'a> {
    form: FirstOrderForm,
    light: &'a [f32],
    p: &'a mut [f64],
}

/// Advances unbleached fractions under the light of one step, td.
pub fn relax(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
    vectorised(Relax { form, light, p });
}

impl WithSimd for Relax<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let form = self.form;
        for (light, p) in self.light.chunks(TILE).zip(self.p.chunks_mut(TILE)) {
            if form.steps_of_tau * form.rate(greatest_of(light)) <= SHORT {
                relax_short(form, light, p);
            } else {
                relax_any(form, light, p);
            }
        }
    }
}

#[inline(always)]
fn relax_short(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
    for (p, &light) in p.iter_mut().zip(light) {
        let a = form.rate(light);
        *p = form.short_step(a, form.steps_of_tau * a, *p);
    }
}

#[inline(always)]
fn relax_any(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
    for (p, &light) in p.iter_mut().zip(light) {
        let a = form.rate(light);
        let z = form.steps_of_tau * a;
        let rest = 1.0 / a;
        let long = rest + decay(z) * (*p - rest);
        let short = form.short_step(a, z, *p);
        *p = if z <= SHORT { short } else { long };
    }
}

struct Steady<'a> {
    form: FirstOrderForm,
    light: &'a [f32],
    p: &'a mut [f64],
}

/// The steady state of each place's light (paper Eq. 1).
pub fn steady(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
    vectorised(Steady { form, light, p });
}

impl WithSimd for Steady<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for (p, &light) in self.p.iter_mut().zip(self.light) {
            *p = 1.0 / self.form.rate(light);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step;
    use crate::units::Trolands;

    fn pigment() -> Kinetics {
        Kinetics::first_order(Trolands(2e4), Seconds(120.0))
    }

    /// Lights from nothing to the sun beside each other, and one that is infinite.
    fn lights() -> Vec<f32> {
        let mut lights: Vec<f32> = (0..999).map(|i| 10f32.powf(i as f32 * 0.012)).collect();
        lights[17] = 0.0;
        lights.push(f32::INFINITY);
        lights
    }

    #[test]
    fn a_run_agrees_with_the_scalar_step_from_the_dark_to_infinite_light() {
        for dt in [1e-3, 1.0 / 24.0, 1.0, 60.0, 1e4] {
            for start in [1.0, 0.5, 1e-3, 1e-9] {
                let mut p = vec![start; 1000];
                relax(FirstOrderForm::new(&pigment(), Seconds(dt)), &lights(), &mut p);
                for (p, light) in p.iter().zip(lights()) {
                    let light = Trolands(light.into());
                    let exact = step::relax(start, pigment().rates(start, light), Seconds(dt));
                    assert!((p - exact).abs() < 1e-15, "{light} {dt} {start}: {p} {exact}");
                    assert!((0.0..=1.0).contains(p));
                }
            }
        }
    }

    #[test]
    fn little_pigment_keeps_its_digits_where_the_scalar_form_loses_them() {
        // 1e10 td for 0.1 s leaves 1/a = 2e-6 of the pigment: all of it from regeneration.
        let mut p = [1.0];
        relax(FirstOrderForm::new(&pigment(), Seconds(0.1)), &[1e10], &mut p);
        assert!((p[0] * (1.0 + 1e10 / 2e4) - 1.0).abs() < 4e-16);
    }

    #[test]
    fn where_a_run_is_cut_changes_no_bit() {
        let form = FirstOrderForm::new(&pigment(), Seconds(1.0 / 24.0));
        let light = lights();
        let (mut whole, mut cut) = (vec![0.7; 1000], vec![0.7; 1000]);
        relax(form, &light, &mut whole);
        for (light, p) in light.chunks(7).zip(cut.chunks_mut(7)) {
            relax(form, light, p);
        }
        assert_eq!(whole, cut);
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let form = FirstOrderForm::new(&pigment(), Seconds(1.0 / 24.0));
        let light = lights();
        let (mut best, mut plain) = (vec![0.7; 1000], vec![0.7; 1000]);
        relax(form, &light, &mut best);
        Relax { form, light: &light, p: &mut plain }.with_simd(pulp::Scalar);
        assert_eq!(best, plain);
    }

    #[test]
    fn a_rested_eye_in_the_dark_stays_at_one_however_long() {
        for dt in [1e-3, 1.0, 1e5] {
            let mut p = [1.0; 300];
            relax(FirstOrderForm::new(&pigment(), Seconds(dt)), &[0.0; 300], &mut p);
            assert_eq!(p, [1.0; 300]);
        }
    }
}
