//! The limits and orders of every method, measured on the code itself.

use crate::kinetics::Kinetics;
use crate::step::{Drive, METHODS, Method, dormand_prince};
use crate::units::{Seconds, Trolands};

const TAU: f64 = 120.0;
const HALF_BLEACH: f64 = 2e4;

/// The largest h lambda that is tried, and that for methods whose work grows with it.
const LARGEST: [f64; 2] = [1e6, 1e3];

/// What was measured of one method; infinite where no limit was found.
pub(super) struct Measured {
    pub(crate) method: &'static Method,
    pub(crate) order: f64,
    pub(crate) stable_to: f64,
    pub(crate) bounded_to: f64,
}

pub(super) fn measure() -> Vec<Measured> {
    let truth = smooth(accurate, 2000);
    let each = METHODS.iter().map(|method| Measured {
        method,
        order: order(method, truth),
        stable_to: limit(method, |x| {
            amplification(method, x).abs() > 1.0 + 1e-9 + 10.0 * method.tolerance
        }),
        bounded_to: limit(method, |x| leaves_bounds(method, x)),
    });
    each.collect()
}

fn eye() -> Kinetics {
    Kinetics::first_order(Trolands(HALF_BLEACH), Seconds(TAU))
}

/// p after one step of h lambda = x under light s I0.
pub(super) fn held(method: &Method, x: f64, s: f64, p: f64) -> f64 {
    (method.step)(&eye(), p, Drive::Held(Trolands(s * HALF_BLEACH)), Seconds(x * TAU / (1.0 + s)))
}

/// R(-x) as the code has it: what is left of a unit of pigment under the brightest light.
pub(super) fn amplification(method: &Method, x: f64) -> f64 {
    held(method, x, 1e9, 1.0) - held(method, x, 1e9, 0.0)
}

fn leaves_bounds(method: &Method, x: f64) -> bool {
    let slack = 1e-12 + 10.0 * method.tolerance;
    let outside = |p: f64| !(-slack..=1.0 + slack).contains(&p);
    [0.0, 1.0, 1e9]
        .iter()
        .any(|&s| outside(held(method, x, s, 0.0)) || outside(held(method, x, s, 1.0)))
}

/// The x at which `fails` first turns true: a coarse search, then bisection.
fn limit(method: &Method, fails: impl Fn(f64) -> bool) -> f64 {
    let largest = LARGEST[usize::from(method.tolerance > 0.0)];
    let coarse = (0..=400).map(|i| 1e-2 * (largest / 1e-2).powf(f64::from(i) / 400.0));
    let mut sound = 0.0;
    for x in coarse {
        if fails(x) {
            return (0..60).fold([sound, x], |[low, high], _| {
                let middle = 0.5 * (low + high);
                if fails(middle) { [low, middle] } else { [middle, high] }
            })[1];
        }
        sound = x;
    }
    f64::INFINITY
}

/// p after 2 s of lambda(t) = 1 + sin(2 t)/2, in `steps` steps.
fn smooth(step: impl Fn(f64, Drive, Seconds) -> f64, steps: u32) -> f64 {
    let h = 2.0 / f64::from(steps);
    let [mean, amplitude] = [HALF_BLEACH * (TAU - 1.0), HALF_BLEACH * 0.5 * TAU].map(Trolands);
    let drive =
        |n: u32| Drive::Sine { mean, amplitude, phase: 2.0 * h * f64::from(n), turn: 2.0 * h };
    (0..steps).fold(1.0, |p, n| step(p, drive(n), Seconds(h)))
}

/// A step of the method of highest order; in 2000 steps it errs by rounding only.
fn accurate(p: f64, drive: Drive, dt: Seconds) -> f64 {
    Method::named("radau-iia-5").map_or(f64::NAN, |method| (method.step)(&eye(), p, drive, dt))
}

/// How the error falls as steps are halved: of an adaptive method, that of its formula with the
/// tolerance lifted.
fn order(method: &Method, truth: f64) -> f64 {
    let coarse = if method.order > 3 { 48 } else { 96 };
    let step = |p, drive, dt| match method.tolerance {
        0.0 => (method.step)(&eye(), p, drive, dt),
        _ => dormand_prince(&eye(), p, drive, dt, f64::MAX).p,
    };
    let error = |steps| (smooth(step, steps) - truth).abs();
    (error(coarse) / error(2 * coarse)).log2()
}
