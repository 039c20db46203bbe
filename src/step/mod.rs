//! Ways to advance the unbleached fraction p over one step, and what theory says of each.
//!
//! ```text
//! p' = rho (1 - p) - beta p                    first order: p' = k - lambda p,  lambda = (1 + I/I0)/tau,  k = 1/tau
//! light held:  p1 - p_inf = R(-x) (p0 - p_inf),  x = h lambda           every one-step method, with its own R
//! blows up where |R| > 1, rings where R < 0, keeps p within 0..1 where 0 <= R <= 1
//! ```
//!
//! [`exact`](exponential::advance) is the integrator: R = e^-x. Everything else is here to be
//! measured against it (Hairer & Wanner 1996, IV.3 for R; Hochbruck & Ostermann 2010 for the
//! exponential ones). A method is a pure function and a row of [`METHODS`]; tests and charts go
//! over the table.

mod adaptive;
mod drive;
mod enclosure;
mod explicit;
mod exponential;
mod implicit;
mod ramp;
mod rosenbrock;
pub(crate) mod special;

pub use adaptive::dormand_prince;
pub use drive::Drive;
pub(crate) use enclosure::{Enclosed, MOST_SUBSTEPS};
pub use enclosure::{enclosed, enclosed_within, substeps_for};
pub(crate) use explicit::runge_kutta;
pub use exponential::{advance, frozen_midpoint, relax};
pub use implicit::{Implicit, collocate};
pub use rosenbrock::{Rosenbrock, linearly_implicit};

use crate::kinetics::Kinetics;
use crate::units::{Seconds, Trolands};
use explicit::{DORMAND_PRINCE, FORWARD_EULER, HEUN, RK4};
use implicit::{BACKWARD_EULER, LOBATTO_IIIC_2, RADAU_IIA_5, TR_BDF2, TRAPEZOID};
use rosenbrock::{RODAS4, ROS2};
use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// One way to advance p, and one row of theory.
pub struct Method {
    pub name: &'static str,
    /// Global order on smooth light.
    pub order: u32,
    /// R(-x): what remains of the distance from rest after one step of length x = h lambda under
    /// held light.
    pub damping: fn(f64) -> f64,
    /// The x beyond which |R| > 1.
    pub stable_to: f64,
    /// The x up to which p stays within 0..1 under any held light, from any p.
    pub bounded_to: f64,
    /// Error that the method allows itself per step; 0 for the methods that take one step as it
    /// comes.
    pub tolerance: f64,
    pub source: &'static str,
    /// Whether one step of held light is the solution itself, for laws that have one.
    pub(crate) exact_when_held: bool,
    /// p after one step.
    pub step: fn(&Kinetics, f64, Drive, Seconds) -> f64,
}

impl Method {
    /// The row of that name.
    pub fn named(name: &str) -> Option<&'static Method> {
        METHODS.iter().find(|method| method.name == name)
    }

    /// Where a held step taken in `substeps` equal parts passes the limit of this method: h lambda
    /// of a part and the limit, beyond which p may leave 0..1.
    pub fn past_limit(
        &self,
        kinetics: &Kinetics,
        light: Trolands,
        dt: Seconds,
        substeps: u32,
    ) -> Option<PastLimit> {
        let h_lambda = dt.0 / f64::from(substeps.max(1)) * kinetics.contraction(light)[1];
        (h_lambda > self.bounded_to).then_some(PastLimit { h_lambda, limit: self.bounded_to })
    }

    /// p after one step of held light taken in `substeps` equal parts (0 count as 1).
    pub fn hold(
        &self,
        kinetics: &Kinetics,
        p: f64,
        light: Trolands,
        dt: Seconds,
        substeps: u32,
    ) -> f64 {
        let substeps = substeps.max(1);
        let part = Seconds(dt.0 / f64::from(substeps));
        (0..substeps).fold(p, |p, _| (self.step)(kinetics, p, Drive::Held(light), part))
    }
}

/// A step too long for its method.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PastLimit {
    pub(crate) h_lambda: f64,
    limit: f64,
}

impl std::fmt::Display for PastLimit {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "h lambda = {:.4} is past the limit {:.4}", self.h_lambda, self.limit)
    }
}

/// The tolerance of `dopri5-adaptive` where none is asked for.
const ADAPTIVE_TOLERANCE: f64 = 1e-6;

const ANY: f64 = f64::INFINITY;

fn decay(x: f64) -> f64 {
    (-x).exp()
}

/// The exact step of held light: the integrator.
pub const EXACT: &Method = {
    let mut i = 0;
    while !METHODS[i].exact_when_held {
        i += 1;
    }
    &METHODS[i]
};

/// Every method that can be named in a configuration.
pub const METHODS: &[Method] = &[
    Method {
        name: "forward-euler",
        order: 1,
        damping: |x| 1.0 - x,
        stable_to: 2.0,
        bounded_to: 1.0,
        tolerance: 0.0,
        source: "Euler 1768",
        exact_when_held: false,
        step: |k, p, drive, dt| runge_kutta(&FORWARD_EULER, k, p, drive, dt),
    },
    Method {
        name: "heun",
        order: 2,
        damping: |x| 1.0 - x + x * x / 2.0,
        stable_to: 2.0,
        bounded_to: 2.0,
        tolerance: 0.0,
        source: "Heun 1900",
        exact_when_held: false,
        step: |k, p, drive, dt| runge_kutta(&HEUN, k, p, drive, dt),
    },
    Method {
        name: "rk4",
        order: 4,
        damping: |x| 1.0 - x * (1.0 - x / 2.0 * (1.0 - x / 3.0 * (1.0 - x / 4.0))),
        stable_to: 2.785293563405282,
        bounded_to: 2.785293563405282,
        tolerance: 0.0,
        source: "Kutta 1901",
        exact_when_held: false,
        step: |k, p, drive, dt| runge_kutta(&RK4, k, p, drive, dt),
    },
    Method {
        name: "dopri5",
        order: 5,
        damping: |x| {
            1.0 - x
                * (1.0
                    - x / 2.0
                        * (1.0 - x / 3.0 * (1.0 - x / 4.0 * (1.0 - x / 5.0 * (1.0 - x / 5.0)))))
        },
        stable_to: 3.306567892634,
        bounded_to: 3.306567892634,
        tolerance: 0.0,
        source: "Dormand & Prince 1980, fixed steps",
        exact_when_held: false,
        step: |k, p, drive, dt| runge_kutta(&DORMAND_PRINCE, k, p, drive, dt),
    },
    Method {
        name: "dopri5-adaptive",
        order: 5,
        damping: decay,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: ADAPTIVE_TOLERANCE,
        source: "Dormand & Prince 1980; step control of Hairer, Norsett & Wanner 1993, II.4",
        exact_when_held: false,
        step: |k, p, drive, dt| dormand_prince(k, p, drive, dt, ADAPTIVE_TOLERANCE).p,
    },
    Method {
        name: "backward-euler",
        order: 1,
        damping: |x| 1.0 / (1.0 + x),
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Curtiss & Hirschfelder 1952",
        exact_when_held: false,
        step: |k, p, drive, dt| collocate(&BACKWARD_EULER, k, p, drive, dt),
    },
    Method {
        name: "trapezoid",
        order: 2,
        damping: |x| (1.0 - x / 2.0) / (1.0 + x / 2.0),
        stable_to: ANY,
        bounded_to: 2.0,
        tolerance: 0.0,
        source: "Crank & Nicolson 1947",
        exact_when_held: false,
        step: |k, p, drive, dt| collocate(&TRAPEZOID, k, p, drive, dt),
    },
    Method {
        name: "tr-bdf2",
        order: 2,
        damping: |x| (1.0 - (SQRT_2 - 1.0) * x) / (1.0 + (1.0 - FRAC_1_SQRT_2) * x).powi(2),
        stable_to: ANY,
        bounded_to: 1.0 + SQRT_2,
        tolerance: 0.0,
        source: "Bank et al. 1985; Hosea & Shampine 1996; Bonaventura & Della Rocca 2017",
        exact_when_held: false,
        step: |k, p, drive, dt| collocate(&TR_BDF2, k, p, drive, dt),
    },
    Method {
        name: "lobatto-iiic-2",
        order: 2,
        damping: |x| 1.0 / (1.0 + x + x * x / 2.0),
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Chipman 1971",
        exact_when_held: false,
        step: |k, p, drive, dt| collocate(&LOBATTO_IIIC_2, k, p, drive, dt),
    },
    Method {
        name: "radau-iia-5",
        order: 5,
        damping: |x| (1.0 - x * (0.4 - 0.05 * x)) / (1.0 + x * (0.6 + x * (0.15 + x / 60.0))),
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Ehle 1969; Hairer & Wanner 1996, IV.5",
        exact_when_held: false,
        step: |k, p, drive, dt| collocate(&RADAU_IIA_5, k, p, drive, dt),
    },
    Method {
        name: "ros2",
        order: 2,
        damping: |x| (1.0 + (1.0 + SQRT_2) * x) / (1.0 + (1.0 + FRAC_1_SQRT_2) * x).powi(2),
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Verwer et al. 1999, gamma = 1 + 1/sqrt 2",
        exact_when_held: false,
        step: |k, p, drive, dt| linearly_implicit(&ROS2, k, p, drive, dt),
    },
    Method {
        name: "rodas4",
        order: 4,
        damping: rosenbrock::rodas4_damping,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Hairer & Wanner 1996, VI.4",
        exact_when_held: false,
        step: |k, p, drive, dt| linearly_implicit(&RODAS4, k, p, drive, dt),
    },
    Method {
        name: "exponential-euler",
        order: 1,
        damping: decay,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Certaine 1960: rates frozen at the start",
        exact_when_held: false,
        step: exponential::exponential_euler,
    },
    Method {
        name: "exact",
        order: 2,
        damping: decay,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "the solution under held light; other laws with rates frozen at half the step",
        exact_when_held: true,
        step: exponential::hold_mean,
    },
    Method {
        name: "magnus-4",
        order: 4,
        damping: decay,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Iserles & Norsett 1999",
        exact_when_held: false,
        step: exponential::magnus_4,
    },
    Method {
        name: "exponential-rosenbrock",
        order: 2,
        damping: decay,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "Pope 1963; Hochbruck, Ostermann & Schweitzer 2009",
        exact_when_held: false,
        step: exponential::exponential_rosenbrock,
    },
    Method {
        name: "ramp",
        order: 2,
        damping: decay,
        stable_to: ANY,
        bounded_to: ANY,
        tolerance: 0.0,
        source: "the solution under light that is linear over the step, by Dawson's integral and erfcx",
        exact_when_held: false,
        step: ramp::ramp,
    },
];
