//! The exact first-order step under held light, over a row:
//!
//!     p += expm1(-z) (p - 1/(1 + s)),   z = (h/tau)(1 + s),   s = I/I0

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
}

/// Advances unbleached fractions under the light of one step, td.
pub fn relax(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
    for (p, &light) in p.iter_mut().zip(light) {
        let a = 1.0 + f64::from(light) * form.per_half_bleach;
        *p += (-form.steps_of_tau * a).exp_m1() * (*p - 1.0 / a);
    }
}

/// The steady state of each place's light (paper Eq. 1).
pub fn steady(form: FirstOrderForm, light: &[f32], p: &mut [f64]) {
    for (p, &light) in p.iter_mut().zip(light) {
        *p = 1.0 / (1.0 + f64::from(light) * form.per_half_bleach);
    }
}
