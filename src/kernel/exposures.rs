//! The exact step in double precision over arrays in which every value has a light, a duration and
//! constants of its own:
//!
//! ```text
//! a = 1 + I/I0,   z = (t/tau) a,   p(t) = 1/a + e^-z (p0 - 1/a)
//! e^-z > 0.7:     p(t) = p0 + (e^-z - 1) (p0 - 1/a)
//! ```
//!
//! The laws that have no closed form take as many frozen-midpoint steps as prove their error.

use pulp::{Simd, WithSimd};

use super::decay::{LONGEST, parts};
use super::pigment::either;
use super::vectorised;
use crate::kinetics::{Kinetics, Law};
use crate::step::enclosed_within;
use crate::units::{Seconds, Trolands};

/// The most by which [`unbleached`] may be off under a law that has no closed form.
pub(crate) const ENCLOSED: f64 = 1e-6;

/// Pigments under steady light: runs of one length.
#[derive(Clone, Copy, Debug)]
pub struct Exposures<'a> {
    /// Unbleached fractions at the start, 0..1.
    pub start: &'a [f64],
    /// Light, td; finite and not negative.
    pub light: &'a [f64],
    /// Durations, s; not negative. An infinite one leaves the steady state.
    pub seconds: &'a [f64],
    /// Half-bleach light I0, td; positive.
    pub half_bleach: &'a [f64],
    /// Time constants of regeneration, s; positive.
    pub tau: &'a [f64],
}

/// Unbleached fractions after each exposure: to 1e-15 under the first-order law, proven to be within
/// `ENCLOSED` under the others.
pub fn unbleached(law: Law, of: Exposures<'_>, out: &mut [f64]) {
    match law {
        Law::FirstOrder => vectorised(FirstOrder { of, out }),
        _ => each(law, of, out, |kinetics, p, light, dt| {
            if dt.0.is_infinite() {
                kinetics.steady(light)
            } else {
                enclosed_within(&kinetics, p, light, dt, ENCLOSED).p
            }
        }),
    }
}

/// Unbleached fractions that last under each light.
pub fn steady_each(law: Law, of: Exposures<'_>, out: &mut [f64]) {
    each(law, of, out, |kinetics, _, light, _| kinetics.steady(light));
}

fn each(
    law: Law,
    of: Exposures<'_>,
    out: &mut [f64],
    end: impl Fn(Kinetics, f64, Trolands, Seconds) -> f64,
) {
    for (i, out) in out.iter_mut().enumerate() {
        let (half_bleach, tau) = (Trolands(of.half_bleach[i]), Seconds(of.tau[i]));
        let kinetics = Kinetics { law, half_bleach, tau };
        *out = end(kinetics, of.start[i], Trolands(of.light[i]), Seconds(of.seconds[i]));
    }
}

struct FirstOrder<'a> {
    of: Exposures<'a>,
    out: &'a mut [f64],
}

impl WithSimd for FirstOrder<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Exposures { start, light, seconds, half_bleach, tau } = self.of;
        let constants = half_bleach.iter().zip(tau);
        let exposures = start.iter().zip(light).zip(seconds).zip(constants);
        for (out, (((p, light), seconds), (half_bleach, tau))) in self.out.iter_mut().zip(exposures)
        {
            *out = relaxed(*p, 1.0 + light / half_bleach, seconds / tau);
        }
    }
}

#[inline(always)]
fn relaxed(p: f64, rate: f64, steps_of_tau: f64) -> f64 {
    let (z, rest) = (steps_of_tau * rate, 1.0 / rate);
    let (power, q) = parts(z);
    let slow = power == 1.0;
    let weight = power * q + either(slow, 0.0, power);
    let weight = either(z < LONGEST, weight, 0.0);
    either(slow, p, rest) + weight * (p - rest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step::advance;

    fn of_one<'a>(one: &'a [[f64; 1]; 5]) -> Exposures<'a> {
        let [start, light, seconds, half_bleach, tau] = one;
        Exposures { start, light, seconds, half_bleach, tau }
    }

    #[test]
    fn every_exposure_ends_where_the_scalar_step_ends() {
        let constants = [1e-3, 2e4, 1e9].map(|half_bleach| [half_bleach, 120.0]);
        for [half_bleach, tau] in constants {
            let kinetics = Kinetics::first_order(Trolands(half_bleach), Seconds(tau));
            for (i, light) in [0.0, 1e-6, 1.0, 3e2, 2e4, 1e7, 1e12].into_iter().enumerate() {
                for (j, dt) in [0.0, 1e-9, 1e-3, 0.4, 20.0, 83.2, 1e4].into_iter().enumerate() {
                    let start = ((3 * i + 5 * j) % 11) as f64 / 10.0;
                    let start = start.min(1.0);
                    let mut p = [f64::NAN];
                    let one = [[start], [light], [dt], [half_bleach], [tau]];
                    unbleached(Law::FirstOrder, of_one(&one), &mut p);
                    let expected = advance(&kinetics, start, Trolands(light), Seconds(dt), 1);
                    assert!((p[0] - expected).abs() < 1e-15, "{light} td, {dt} s: {p:?}");
                }
            }
        }
    }

    #[test]
    fn for_ever_is_the_steady_state_under_every_law() {
        let laws = [Law::FirstOrder, Law::self_screened(0.5), Law::RateLimited { km: 0.2 }];
        for law in laws {
            let one = [[1.0], [7e3], [f64::INFINITY], [2e4], [120.0]];
            let (mut ended, mut lasting) = ([f64::NAN], [f64::NAN]);
            unbleached(law, of_one(&one), &mut ended);
            steady_each(law, of_one(&one), &mut lasting);
            assert!((ended[0] - lasting[0]).abs() < 1e-15, "{law:?}: {ended:?} {lasting:?}");
        }
    }
}
