//! Short exposures and recovery, against closed forms.
//!
//! ```text
//! I t >> tau I / (1 + I/I0), t << tau:   p = e^(-I t/Q),   Q = I0 tau       (regeneration adds at most t/tau)
//! reciprocity:                           only the product I t counts, then
//! dark:                                  1 - p = e^(-t/tau)
//! ```

use crate::error::Result;
use crate::kinetics::Kinetics;
use crate::step::advance;
use crate::units::{Seconds, Trolands};

use super::limit::worst;
use super::{Check, PAPER, STANDARD, Subject};

/// Q of the standard L cone, td s: 10^4.3 td times 120 s; and of the paper's, 10^3.89 td times 120
/// s.
const Q_STANDARD: f64 = 2_394_314.777_962_655;
const Q_PAPER: f64 = 931_496.539_954_430;

pub(super) fn checks(subject: &Subject) -> Result<Vec<Check>> {
    let standard = subject.pigments(STANDARD)?[0];
    let paper = subject.pigments(PAPER)?[0];
    let mut checks = vec![
        shortest("standard", &standard, Q_STANDARD),
        shortest("paper", &paper, Q_PAPER),
        dose("half of the pigment left after Q ln 2 in 1 ms, standard", &standard, Q_STANDARD),
        dose("half of the pigment left after Q ln 2 in 1 ms, paper", &paper, Q_PAPER),
        reciprocity(&standard),
    ];
    // e^-4, e^-1: 480 s and 120 s of darkness after a full bleach.
    for (seconds, bleached) in [(480.0, 0.018_315_638_888_734), (120.0, 0.367_879_441_171_442)] {
        let name = format!("still bleached after {seconds} s of darkness, standard");
        checks.push(Check::new(
            name,
            "e^(-t/tau)",
            1.0 - after(&standard, 0.0, 0.0, seconds),
            bleached,
            1e-14,
        ));
    }
    Ok(checks)
}

fn after(pigment: &Kinetics, p: f64, light: f64, seconds: f64) -> f64 {
    advance(pigment, p, Trolands(light), Seconds(seconds), 1)
}

/// The largest departure from e^(-I t/Q), as a share of the bound t/tau, over lights and exposures
/// of 1 us to 1 s.
fn shortest(name: &str, pigment: &Kinetics, q: f64) -> Check {
    let exposures =
        (0..=6).flat_map(|i| (3..=10).map(move |decade| (10f64.powi(i - 6), 10f64.powi(decade))));
    let share = exposures.map(|(t, light)| {
        (after(pigment, 1.0, light, t) - (-light * t / q).exp()).abs() / (t / 120.0)
    });
    let name = format!("|p - e^(-It/Q)| over t/tau, worst of 1e3 to 1e10 td, to 1 s, {name}");
    Check::new(name, "p = e^(-It/Q), Q = I0 tau", worst(share, 0.0), 0.0, 1.0)
}

/// p after the dose that leaves half, given in a flash.
fn dose(name: &str, pigment: &Kinetics, q: f64) -> Check {
    let light = q * std::f64::consts::LN_2 / 1e-3;
    Check::new(name, "p = e^(-It/Q), Q = I0 tau", after(pigment, 1.0, light, 1e-3), 0.5, 1e-5)
}

/// The same dose, Q, spread over 1 us to 100 ms.
fn reciprocity(pigment: &Kinetics) -> Check {
    let p = (1..=6).map(|i| after(pigment, 1.0, Q_STANDARD * 10f64.powi(i), 10f64.powi(-i)));
    let name = "p after the dose Q, in 1 us to 100 ms, the farthest from 1/e";
    let e = 0.367_879_441_171_442;
    Check::new(name, "reciprocity of I and t", worst(p, e), e, 6e-4)
}
