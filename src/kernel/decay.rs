//! e^-z and its mean over 0..z, in a form that vectorises.
//!
//! ```text
//! mean:   phi(z) = (1 - e^-z)/z                         z in 0..0.006, one polynomial, no division
//! decay:  e^-z = 2^n e^r,   n = round(-z/ln 2),   r = -z - n ln 2        any z >= 0
//! ```
//!
//! Both polynomials interpolate at Chebyshev nodes (degree 4, truncated by 8.4e-17; degree 11, by
//! 2e-17); rounding makes the errors below. ln 2 is taken in two parts (Cody & Waite 1980), the
//! first with bits to spare.

use std::f64::consts::LOG2_E;

/// The largest z of [`mean_decay_short`]. At 24 frames a second and 2e4 td of half-bleach light:
/// 3e5 td.
pub(super) const SHORT: f64 = 0.006;

/// The z from which [`decay`] gives 0: e^-708 is the last that is sure not to be denormal.
pub(crate) const LONGEST: f64 = 708.0;

pub(super) const MEAN: [f64; 5] =
    [1.0, -0.49999999999998596, 0.1666666665917931, -0.04166660426300064, 0.008316686292125782];

/// (e^r - 1 - r)/r^2 for |r| <= ln(2)/2.
const TAIL: [f64; 10] = [
    0.5000000000000001,
    0.16666666666666669,
    0.04166666666662413,
    0.008333333333330062,
    0.0013888888917213717,
    0.00019841269863053618,
    2.4801521295954376e-05,
    2.7557268459997064e-06,
    2.7620088445409746e-07,
    2.510038549551032e-08,
];

const LN_2: [f64; 2] = [0.6931471803691238, 1.9082149292705877e-10];

/// 1.5 * 2^52: added to a small number it leaves the nearest whole number in the low bits.
const ROUNDING: f64 = 6_755_399_441_055_744.0;

/// phi(z) for z from 0 to `SHORT`.
#[inline(always)]
pub(crate) fn mean_decay_short(z: f64) -> f64 {
    polynomial(&MEAN, z)
}

/// e^-z for any z >= 0, infinity too; 0 from `LONGEST` on.
#[inline(always)]
pub(crate) fn decay(z: f64) -> f64 {
    let (power, q) = parts(z);
    if z < LONGEST { power * (1.0 + q) } else { 0.0 }
}

/// 2^n and e^r - 1, of which e^-z is made: `power (1 + q)`. Where 2^n is 1, q is e^-z - 1 to its
/// last digit.
#[inline(always)]
pub(super) fn parts(z: f64) -> (f64, f64) {
    let bounded = if z < LONGEST { z } else { LONGEST };
    let shifted = bounded * -LOG2_E + ROUNDING;
    let n = shifted - ROUNDING;
    let r = (-bounded - n * LN_2[0]) - n * LN_2[1];
    let power = f64::from_bits(shifted.to_bits().wrapping_add(1023) << 52);
    (power, r + r * r * polynomial(&TAIL, r))
}

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f64; N], x: f64) -> f64 {
    let mut sum = coefficients[N - 1];
    for i in (0..N - 1).rev() {
        sum = sum * x + coefficients[i];
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Largest relative error of [`mean_decay_short`] and of [`decay`], from 0 to `LONGEST`.
    const ERROR: f64 = 4e-16;

    #[test]
    fn decay_keeps_its_error_over_its_whole_range() {
        for i in 0..=3_540_000 {
            let z = f64::from(i) * 2e-4;
            let exact = (-z).exp();
            if z < LONGEST {
                assert!((decay(z) / exact - 1.0).abs() < ERROR, "{z}: {} {exact}", decay(z));
            }
        }
        for z in [LONGEST, 745.2, 1e4, 1e300, f64::INFINITY] {
            assert_eq!(decay(z), 0.0);
        }
        for z in [0.0, 1e-300, 1e-17, 1e-9] {
            assert!((decay(z) - (-z).exp()).abs() < 2e-16);
        }
    }

    #[test]
    fn the_mean_of_a_short_decay_keeps_its_error() {
        for i in 1..=1_000_000 {
            let z = SHORT * f64::from(i) * 1e-6;
            let exact = -(-z).exp_m1() / z;
            assert!((mean_decay_short(z) / exact - 1.0).abs() < ERROR, "{z}");
        }
        assert_eq!(mean_decay_short(0.0), 1.0);
    }
}
