//! How wrong a frozen-midpoint step can be: two walls that the true p cannot pass.
//!
//! ```text
//! p' = f(p)        held light; f falls, and is convex (self-screened) or concave (rate-limited) in p
//! chord through the range of p:    above a convex f, below a concave one
//! tangent within the range:        below a convex f, above a concave one
//! ```
//!
//! Both are straight lines in p, so the equations p' = chord and p' = tangent have exact solutions,
//! and by the comparison theorem the truth runs between them. They part with the square of the
//! range: the walls' distance falls with the third power of the step, as the error itself does.
//! What a step inherits is never amplified, because f' < 0; it fades by the slope between the
//! solutions. So sums of these bounds hold for a whole run (rounding adds 1e-16 a sub-step).

use super::frozen_midpoint;
use crate::kinetics::{Curvature, Kinetics, mean_decay};
use crate::units::{Seconds, Trolands};

/// The end of a step and the most it can differ from the truth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Enclosed {
    pub p: f64,
    pub error: f64,
    pub substeps: u32,
}

/// Sub-steps beyond which no more are tried; far more than any budget that shows in a picture asks
/// for.
pub(crate) const MOST_SUBSTEPS: u32 = 65536;

/// `advance` with a proven bound of its error, for a start that is itself exact.
pub fn enclosed(
    kinetics: &Kinetics,
    p: f64,
    light: Trolands,
    dt: Seconds,
    substeps: u32,
) -> Enclosed {
    let substeps = substeps.max(1);
    if kinetics.curvature() == Curvature::Straight {
        return Enclosed { p: super::advance(kinetics, p, light, dt, 1), error: 0.0, substeps };
    }
    let part = Seconds(dt.0 / f64::from(substeps));
    let (mut p, mut error) = (p, 0.0);
    for _ in 0..substeps {
        let next = frozen_midpoint(p, part, |p| kinetics.rates(p, light));
        let walls = walls(kinetics, p, light, part);
        let farther = walls.map(|wall| (wall - next).abs());
        error = kept(kinetics, light, part, error, [p, walls[0], walls[1]]) * error
            + farther[0].max(farther[1]);
        p = next;
    }
    Enclosed { p, error, substeps }
}

/// The most that a step leaves of an `error` that p had before it. Two solutions approach each
/// other at the slope of the law somewhere between them; `passed` are the ends of what ours goes
/// through, and slopes are monotone in p.
fn kept(kinetics: &Kinetics, light: Trolands, dt: Seconds, error: f64, passed: [f64; 3]) -> f64 {
    let lowest = passed.into_iter().fold(1.0, f64::min) - error;
    let highest = passed.into_iter().fold(0.0, f64::max) + error;
    let slopes = [lowest, highest].map(|p| kinetics.slope(p.clamp(0.0, 1.0), light));
    (dt.0 * slopes[0].max(slopes[1])).exp()
}

/// [`enclosed`] with as many sub-steps, doubled from one, as keep the error within `budget`.
pub fn enclosed_within(
    kinetics: &Kinetics,
    p: f64,
    light: Trolands,
    dt: Seconds,
    budget: f64,
) -> Enclosed {
    let mut substeps = 1;
    loop {
        let found = enclosed(kinetics, p, light, dt, substeps);
        if found.error <= budget || substeps >= MOST_SUBSTEPS {
            return found;
        }
        substeps *= 2;
    }
}

/// How many sub-steps keep the error of one step within `budget`.
pub fn substeps_for(kinetics: &Kinetics, p: f64, light: Trolands, dt: Seconds, budget: f64) -> u32 {
    enclosed_within(kinetics, p, light, dt, budget).substeps
}

/// Two values between which p must lie after one step from `p`.
fn walls(kinetics: &Kinetics, p: f64, light: Trolands, dt: Seconds) -> [f64; 2] {
    let f = |p| kinetics.change(p, light);
    let tangent = |at: f64| {
        let slope = kinetics.slope(at, light);
        follow(p, f(at) + slope * (p - at), slope, dt)
    };
    let chord = |to: f64| follow(p, f(p), (f(to) - f(p)) / (to - p), dt);
    let goal = if f(p) < 0.0 { 0.0 } else { 1.0 };
    if p == goal || f(p) == 0.0 {
        return [p, p];
    }
    // The far end of the range: by whichever line bounds p on that side, first from the whole way
    // to 0 or 1.
    let bleaching = goal == 0.0;
    let by_tangent = match kinetics.curvature() {
        Curvature::Convex => bleaching,
        Curvature::Straight | Curvature::Concave => !bleaching,
    };
    let far = if by_tangent { tangent(p) } else { chord(goal) };
    if (far - p).abs() < f64::EPSILON {
        return [p, far];
    }
    [tangent(0.5 * (p + far)), chord(far)]
}

/// The solution of y' = speed + slope (y - p), y(0) = p, kept within 0..1 as p is.
fn follow(p: f64, speed: f64, slope: f64, dt: Seconds) -> f64 {
    (p + dt.0 * speed * mean_decay(-dt.0 * slope)).clamp(0.0, 1.0)
}
