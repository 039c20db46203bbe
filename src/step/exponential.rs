//! Exponential methods: freeze the rates, relax exactly.
//!
//! ```text
//! p(h) = p + (e^(-h lambda) - 1) (p - rho/lambda),     lambda = rho + beta
//! ```
//!
//! Exact for light and rates that do not change over the step (first order, held light). For the
//! other laws the rates are frozen at a predicted half step: order 2, equilibria exact, p always
//! within 0..1, because each step is a convex combination of p and a rest between 0 and 1. Close
//! kin: modified Patankar-Runge-Kutta (Burchard, Deleersnijder & Meister 2003).

use super::Drive;
use crate::kinetics::{Kinetics, Law, Rates, mean_decay};
use crate::units::{Seconds, Trolands};

/// p after `dt` of constant rates. No division by dt; infinite light gives 0. A short step is counted
/// from p, a long one from the rest, so that neither cancels what is left of p.
#[inline]
pub fn relax(p: f64, rates: Rates, dt: Seconds) -> f64 {
    let (x, rest) = (dt.0 * rates.sum(), rates.rest());
    if x < std::f64::consts::LN_2 {
        p + (-x).exp_m1() * (p - rest)
    } else {
        rest + (-x).exp() * (p - rest)
    }
}

/// One step with the rates that `rates` gives for p half-way, predicted with those at the start.
#[inline]
pub fn frozen_midpoint(p: f64, dt: Seconds, rates: impl Fn(f64) -> Rates) -> f64 {
    let halfway = relax(p, rates(p), Seconds(0.5 * dt.0));
    relax(p, rates(halfway), dt)
}

/// p after `dt` of held light: the solution for the first-order law (whatever `substeps`),
/// frozen-midpoint steps for the others (0 sub-steps count as 1).
#[inline]
pub fn advance(kinetics: &Kinetics, p: f64, light: Trolands, dt: Seconds, substeps: u32) -> f64 {
    if kinetics.law == Law::FirstOrder {
        return relax(p, kinetics.rates(p, light), dt);
    }
    let substeps = substeps.max(1);
    let part = Seconds(dt.0 / f64::from(substeps));
    (0..substeps).fold(p, |p, _| frozen_midpoint(p, part, |p| kinetics.rates(p, light)))
}

/// `exact`: the mean light, held. Errs by at most 0.197 h/tau when light is a ramp.
pub(super) fn hold_mean(kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds) -> f64 {
    advance(kinetics, p, drive.mean(), dt, 1)
}

/// The light and the rates of the step's start, held.
pub(super) fn exponential_euler(kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds) -> f64 {
    relax(p, kinetics.rates(p, drive.at(0.0)), dt)
}

/// Two Gauss points and one commutator; the laws that are not linear have their rates frozen at a
/// half step. Where light rises by more than 12/h the commutator makes the regenerated part
/// negative.
pub(super) fn magnus_4(kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds) -> f64 {
    let h = dt.0;
    let halfway = relax(p, kinetics.rates(p, drive.mean()), Seconds(0.5 * h));
    let gauss = 3f64.sqrt() / 6.0;
    let [early, late] = [0.5 - gauss, 0.5 + gauss].map(|c| kinetics.rates(halfway, drive.at(c)));
    let z = 0.5 * h * (early.sum() + late.sum());
    let commutator = h * gauss / 2.0 * (late.sum() - early.sum());
    p * (-z).exp() + h * early.regenerate * (1.0 - commutator) * mean_decay(z)
}

/// Linearise where the step starts, solve the linear equation: Newton's method in disguise, and it
/// overshoots.
pub(super) fn exponential_rosenbrock(
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
) -> f64 {
    let (h, light) = (dt.0, drive.at(0.0));
    let x = -h * kinetics.slope(p, light);
    let risen = Trolands(light.0 + drive.initial_rise().0);
    let drift = kinetics.change(p, risen) - kinetics.change(p, light);
    p + h * (mean_decay(x) * kinetics.change(p, light) + mean_rest(x) * drift)
}

/// (1 - (1 - e^-x)/x)/x, phi_2(-x); by its series where the closed form cancels.
fn mean_rest(x: f64) -> f64 {
    if x < 1e-2 {
        0.5 - x
            * (1.0 / 6.0 - x * (1.0 / 24.0 - x * (1.0 / 120.0 - x * (1.0 / 720.0 - x / 5040.0))))
    } else {
        (1.0 - mean_decay(x)) / x
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_left_after_a_flash_is_exact_relative_to_itself() {
        // 1e16 td for 1 ms: h lambda = 4166.67, p is the steady state, 1/(1 + 5e11).
        let pigment = Kinetics::first_order(Trolands(2e4), Seconds(120.0));
        let p = advance(&pigment, 1.0, Trolands(1e16), Seconds(1e-3), 1);
        assert!((p / (1.0 / (1.0 + 5e11)) - 1.0).abs() < 1e-14, "{p:e}");
    }
}
