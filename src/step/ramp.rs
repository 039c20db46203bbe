//! The exact step under light that is linear over it: a test oracle, and the method named `ramp`.
//!
//! ```text
//! p(h) = e^-Z p + rho h Psi(Z, d)        Z = h (la + lb)/2,  d = h (lb - la)/2,  |d| <= Z,  la, lb: lambda at the ends
//! Psi = int_0^1 exp(-Z y - d y (1 - y)) dy
//!     = [F(x1) - e^-Z F(x0)]/q                            d > 0, F: Dawson's integral
//!     = sqrt(pi)/(2q) [erfcx(x1) - e^-Z erfcx(x0)]        d < 0
//! q = sqrt |d|,  x1 = (Z + d)/(2q),  x0 = (Z - d)/(2q)
//! ```
//!
//! The closed forms lose digits for small Z, where eight Gauss points are exact to rounding: they
//! change over at Z = 0.7.

use super::special::{dawson, erfcx};
use super::{Drive, relax};
use crate::kinetics::{Kinetics, mean_decay};
use crate::units::Seconds;
use std::f64::consts::PI;

/// Light taken as linear between the ends of the step; the rates of a law that is not linear are
/// frozen half-way.
pub(super) fn ramp(kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds) -> f64 {
    let halfway = relax(p, kinetics.rates(p, drive.mean()), Seconds(0.5 * dt.0));
    let [first, last] = [0.0, 1.0].map(|end| kinetics.rates(halfway, drive.at(end)));
    let z = 0.5 * dt.0 * (first.sum() + last.sum());
    let d = 0.5 * dt.0 * (last.bleach - first.bleach);
    p * (-z).exp() + dt.0 * first.regenerate * psi(z, d)
}

/// Psi(Z, d), to 2e-15.
fn psi(z: f64, d: f64) -> f64 {
    if d.abs() < 1e-17 {
        return mean_decay(z);
    }
    if z < 0.7 {
        return gauss(|y| (-z * y - d * y * (1.0 - y)).exp());
    }
    let q = d.abs().sqrt();
    let (x1, x0) = ((z + d) / (2.0 * q), (z - d) / (2.0 * q));
    if d > 0.0 {
        (dawson(x1) - (-z).exp() * dawson(x0)) / q
    } else {
        PI.sqrt() / (2.0 * q) * (erfcx(x1) - (-z).exp() * erfcx(x0))
    }
}

/// The integral over 0..1 by eight Gauss-Legendre points (Abramowitz & Stegun 1964, table 25.4).
fn gauss(f: impl Fn(f64) -> f64) -> f64 {
    const POINTS: [(f64, f64); 4] = [
        (0.1834346424956498, 0.362683783378362),
        (0.525532409916329, 0.3137066458778873),
        (0.7966664774136267, 0.2223810344533745),
        (0.9602898564975363, 0.1012285362903763),
    ];
    POINTS.iter().map(|&(x, weight)| 0.5 * weight * (f(0.5 - 0.5 * x) + f(0.5 + 0.5 * x))).sum()
}
