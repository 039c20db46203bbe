//! Dormand & Prince's pair with its step chosen by its own error estimate (Hairer, Norsett & Wanner
//! 1993, II.4).
//!
//! It never blows up, but buys that with evaluations: about h lambda/3.3 steps of six, however
//! little happens.

use super::Drive;
use super::explicit::{DORMAND_PRINCE, slopes};
use crate::kinetics::Kinetics;
use crate::units::Seconds;

/// Where an adaptive integration ended and what it cost.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adaptive {
    pub p: f64,
    /// How often p' was evaluated, rejected steps included.
    pub evaluations: u64,
}

/// The weights of order 5 less those of order 4; the seventh is for the slope at the end.
const ERROR: [f64; 7] = [
    71.0 / 57600.0,
    0.0,
    -71.0 / 16695.0,
    71.0 / 1920.0,
    -17253.0 / 339200.0,
    22.0 / 525.0,
    -1.0 / 40.0,
];

/// The least part of the step that is tried; at that length a part is taken whatever its error.
const SMALLEST: f64 = 1e-12;

/// p after `dt`, each inner step within `tolerance` (1 + |p|).
pub fn dormand_prince(
    kinetics: &Kinetics,
    p: f64,
    drive: Drive,
    dt: Seconds,
    tolerance: f64,
) -> Adaptive {
    let (mut p, mut done, mut part) = (p, 0.0, first_part(kinetics, p, drive, dt, tolerance));
    let mut evaluations = 1;
    while done < 1.0 {
        let end = f64::min(done + part, 1.0);
        let (next, estimate) =
            embedded(kinetics, p, drive.part(done, end), Seconds(dt.0 * (end - done)));
        evaluations += 6;
        let size = estimate.abs() / (tolerance * (1.0 + p.abs().max(next.abs())));
        if size <= 1.0 || part <= SMALLEST {
            (p, done) = (next, end);
        }
        // A part that ended in nonsense is cut as far as one that missed widely.
        let factor = if size.is_finite() { (0.9 * size.powf(-0.2)).clamp(0.2, 5.0) } else { 0.2 };
        part = f64::max(part * factor, SMALLEST);
    }
    Adaptive { p, evaluations }
}

/// One step of the pair: p of order 5 and the estimate of its error.
fn embedded(kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds) -> (f64, f64) {
    let k = slopes(&DORMAND_PRINCE, kinetics, p, drive, dt);
    let next = p + dt.0 * (0..6).fold(0.0, |sum, i| sum + DORMAND_PRINCE.b[i] * k[i]);
    let last = kinetics.change(next, drive.at(1.0));
    (next, dt.0 * (0..6).fold(ERROR[6] * last, |sum, i| sum + ERROR[i] * k[i]))
}

/// A first guess: the part over which an error of order 5 at the speed and slope of the start stays
/// in tolerance.
fn first_part(kinetics: &Kinetics, p: f64, drive: Drive, dt: Seconds, tolerance: f64) -> f64 {
    let speed = dt.0 * kinetics.change(p, drive.at(0.0)).abs();
    let slope = dt.0 * kinetics.slope(p, drive.at(0.0)).abs();
    let speeds_up = slope.max(1.0);
    ((tolerance / (speed + tolerance)).powf(0.2) / speeds_up).clamp(SMALLEST, 1.0)
}
