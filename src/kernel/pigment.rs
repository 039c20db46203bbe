//! The exact first-order step under held light, over a run of places:
//!
//! ```text
//! a = 1 + I/I0,   z = (h/tau) a,   p1 = 1/a + e^-z (p - 1/a)
//! e^-z > 0.7:     p1 = p + (e^-z - 1) (p - 1/a)
//! z <= 0.006:     p1 = p + (h/tau) phi(z) (1 - a p),   phi(z) = (1 - e^-z)/z
//! ```
//!
//! Each form cancels nothing where it is taken; the last needs no division. Which one a place takes
//! depends on its own light only; the greatest light of a [`SPAN`] of places decides whether the
//! first two are computed at all. In the dark p = 1 stays 1 bit for bit, infinite light leaves 0.

use pulp::{Simd, WithSimd};

use super::decay::{LONGEST, MEAN, SHORT, mean_decay_short, parts};
use super::{TILE, prefetch, vectorised};
use crate::kinetics::Kinetics;
use crate::units::Seconds;

/// The constants of one cone class for one step.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FirstOrderForm {
    per_half_bleach: f64,
    steps_of_tau: f64,
    /// What one troland adds to z.
    bleach: f64,
    /// Light that is sure to bleach little in a step (z below `SHORT`), td.
    little: f32,
}

impl FirstOrderForm {
    /// For a pigment and a step.
    pub fn new(pigment: &Kinetics, dt: Seconds) -> Self {
        let steps_of_tau = dt.0 / pigment.tau.0;
        let little = (SHORT / steps_of_tau - 1.0) * pigment.half_bleach.0 * (1.0 - 1e-6);
        let per_half_bleach = 1.0 / pigment.half_bleach.0;
        FirstOrderForm {
            per_half_bleach,
            steps_of_tau,
            bleach: steps_of_tau * per_half_bleach,
            little: little as f32,
        }
    }

    #[inline(always)]
    fn rate(self, light: f32) -> f64 {
        1.0 + f64::from(light) * self.per_half_bleach
    }

    #[inline(always)]
    fn bleaches_little(self, light: &[f32; SPAN]) -> bool {
        light.iter().fold(true, |all, &light| all & (light <= self.little))
    }

    #[inline(always)]
    fn relaxed(self, light: f32, p: f64) -> f64 {
        let z = self.steps_of_tau + self.bleach * f64::from(light);
        let little = p + mean_decay_short(z) * (self.steps_of_tau - z * p);
        let rest = 1.0 / self.rate(light);
        let (power, q) = parts(z);
        let slow = power == 1.0;
        let weight = power * q + either(slow, 0.0, power);
        let weight = either(z < LONGEST, weight, 0.0);
        let long = either(slow, p, rest) + weight * (p - rest);
        either(z <= SHORT, little, long)
    }
}

/// One of two numbers, by their bits: a choice of branches would not vectorise.
#[inline(always)]
pub(super) fn either(first: bool, a: f64, b: f64) -> f64 {
    let mask = 0u64.wrapping_sub(u64::from(first));
    f64::from_bits((a.to_bits() & mask) | (b.to_bits() & !mask))
}

struct Relax<'a> {
    form: FirstOrderForm,
    light: &'a [f32],
    p: &'a mut [f64],
}

/// Advances unbleached fractions under the light of one step, td. Returns the least of them.
pub fn relax(form: FirstOrderForm, light: &[f32], p: &mut [f64]) -> f64 {
    vectorised(Relax { form, light, p })
}

impl WithSimd for Relax<'_> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        let ((spans, rest), (light, light_rest)) =
            (self.p.as_chunks_mut::<SPAN>(), self.light.as_chunks::<SPAN>());
        let mut least = simd.splat_f64s(1.0);
        for (p, light) in spans.iter_mut().zip(light) {
            for line in (0..SPAN).step_by(8) {
                prefetch(p.as_ptr().wrapping_add(TILE + line));
            }
            relax_span(simd, self.form, light, p, &mut least);
        }
        if !rest.is_empty() {
            // What is left is filled up with whole pigment in the dark.
            let (mut dark, mut whole) = ([0.0; SPAN], [1.0; SPAN]);
            dark[..rest.len()].copy_from_slice(light_rest);
            whole[..rest.len()].copy_from_slice(rest);
            relax_span(simd, self.form, &dark, &mut whole, &mut least);
            rest.copy_from_slice(&whole[..rest.len()]);
        }
        simd.reduce_min_f64s(least)
    }
}

#[inline(always)]
fn relax_span<S: Simd>(
    simd: S,
    form: FirstOrderForm,
    light: &[f32; SPAN],
    p: &mut [f64; SPAN],
    least: &mut S::f64s,
) {
    if form.bleaches_little(light) {
        relax_little(simd, form, light, p);
    } else {
        relax_any(form, light, p);
    }
    for &p in S::as_simd_f64s(p).0 {
        *least = simd.min_f64s(*least, p);
    }
}

/// How many places decide together whether a form without division does for all of them.
const SPAN: usize = 32;

/// Written out in vectors, four side by side so that none waits for its own sums: most places of
/// most pictures go this way.
#[inline(always)]
fn relax_little<S: Simd>(simd: S, form: FirstOrderForm, light: &[f32; SPAN], p: &mut [f64; SPAN]) {
    let mut wide = [0.0; SPAN];
    for (wide, &light) in wide.iter_mut().zip(light) {
        *wide = f64::from(light);
    }
    let (light, p) = (S::as_simd_f64s(&wide).0, S::as_mut_simd_f64s(p).0);
    let (steps, bleach) = (simd.splat_f64s(form.steps_of_tau), simd.splat_f64s(form.bleach));
    for (p, light) in p.as_chunks_mut::<4>().0.iter_mut().zip(light.as_chunks::<4>().0) {
        let (mut z, mut mean) = ([steps; 4], [simd.splat_f64s(MEAN[MEAN.len() - 1]); 4]);
        for i in 0..4 {
            z[i] = simd.add_f64s(steps, simd.mul_f64s(bleach, light[i]));
        }
        for &c in MEAN.iter().rev().skip(1) {
            for i in 0..4 {
                mean[i] = simd.add_f64s(simd.mul_f64s(mean[i], z[i]), simd.splat_f64s(c));
            }
        }
        for i in 0..4 {
            let change = simd.sub_f64s(steps, simd.mul_f64s(z[i], p[i]));
            p[i] = simd.add_f64s(p[i], simd.mul_f64s(mean[i], change));
        }
    }
}

#[inline(always)]
fn relax_any(form: FirstOrderForm, light: &[f32; SPAN], p: &mut [f64; SPAN]) {
    for (p, &light) in p.iter_mut().zip(light) {
        *p = form.relaxed(light, *p);
    }
}

struct Steady<'a> {
    form: FirstOrderForm,
    light: &'a [f32],
    p: &'a mut [f64],
}

/// The steady state of each place's light (paper Eq. 1).
pub(crate) fn steady(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
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
