//! How pigment comes and goes: every law as two rates that are never negative.
//!
//! ```text
//! p' = rho (1 - p) - beta p          p: unbleached fraction, rho: regeneration, beta: bleaching, 1/s
//!
//! first order     rho = 1/tau                        beta = s/tau             s = I/I0, I in trolands
//! self-screened   rho = 1/tau                        beta = c (s/tau) g(p)/p  g(p) = (1 - 10^(-D p))/(D ln 10)
//! rate-limited    rho = (1 + Km)/(tau (1 - p + Km))  beta = s/tau
//! ```
//!
//! First order: Rushton & Henry 1968; Hollins & Alpern 1973; Gutierrez et al. 2005, Eq. 1 is its
//! steady state. Self-screened: pigment bleaches by the quanta it absorbs; c = 0.5/g(0.5) keeps I0
//! the half-bleach light. Rate-limited: Lamb & Pugh 2004; Mahroo & Lamb 2004; the rate at full
//! bleach is set to 1/tau.
//!
//! In every law p' falls as p grows, so two histories never part: their difference only shrinks.

use crate::constants::{self, ConstantSet};
use crate::units::{Seconds, Trolands};
use std::f64::consts::LN_10;

/// How fast pigment is regenerated and bleached, 1/s. Never negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rates {
    pub regenerate: f64,
    pub bleach: f64,
}

impl Rates {
    /// lambda, the rate at which pigment approaches [`Rates::rest`], 1/s.
    pub(crate) fn sum(self) -> f64 {
        self.regenerate + self.bleach
    }

    /// Where pigment would settle if these rates lasted; 0 under infinite light.
    pub(crate) fn rest(self) -> f64 {
        self.regenerate / self.sum()
    }

    /// dp/dt, 1/s.
    pub(crate) fn change(self, p: f64) -> f64 {
        self.regenerate * (1.0 - p) - self.bleach * p
    }
}

/// What the rates depend on beside the light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Law {
    FirstOrder,
    /// `density`: peak axial optical density D; `norm`: the factor c of the bleaching rate.
    SelfScreened {
        density: f64,
        norm: f64,
    },
    /// `km`: the half-saturation of regeneration, as a fraction of all pigment; positive.
    RateLimited {
        km: f64,
    },
}

impl Law {
    /// Every law by its name in configurations and tables, without its constants.
    pub const NAMES: [(&str, Law); 3] = [
        ("first-order", Law::FirstOrder),
        ("self-screened", Law::SelfScreened { density: 0.0, norm: 0.0 }),
        ("rate-limited", Law::RateLimited { km: 0.0 }),
    ];

    /// This law with constants: each takes those that it knows of a peak optical density and Km.
    pub fn with(self, density: f64, km: f64) -> Law {
        match self {
            Law::FirstOrder => self,
            Law::SelfScreened { .. } => Law::self_screened(density),
            Law::RateLimited { .. } => Law::RateLimited { km },
        }
    }

    /// Self-screening whose half-bleach light is that of the first-order law.
    pub fn self_screened(density: f64) -> Law {
        Law::SelfScreened { density, norm: 1.0 / mean_decay(0.5 * density * LN_10) }
    }

    /// The name in configurations and tables.
    pub(crate) fn name(self) -> &'static str {
        match self {
            Law::FirstOrder => "first-order",
            Law::SelfScreened { .. } => "self-screened",
            Law::RateLimited { .. } => "rate-limited",
        }
    }

    /// dp/dt in one line, for tables. I: cone illuminance, td.
    pub(crate) fn formula(self) -> &'static str {
        match self {
            Law::FirstOrder => "tau dp/dt = 1 - p - (I/I0) p",
            Law::SelfScreened { .. } => {
                "tau dp/dt = 1 - p - 0.5 (I/I0) (1 - 10^(-D p))/(1 - 10^(-D/2))"
            }
            Law::RateLimited { .. } => "tau dp/dt = (1 + Km) (1 - p)/(1 - p + Km) - (I/I0) p",
        }
    }
}

/// The kinetics of one cone class (or of the rods).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Kinetics {
    pub law: Law,
    /// I0 = Q/tau: steady light that leaves half of the pigment under the first-order law.
    pub half_bleach: Trolands,
    /// Time constant of regeneration.
    pub tau: Seconds,
}

/// How dp/dt bends over p from 0 to 1, under any light.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Curvature {
    Straight,
    Convex,
    Concave,
}

impl Kinetics {
    /// Kinetics of the L, M and S pigments of the standard set of constants.
    pub fn standard() -> [Kinetics; 3] {
        let ConstantSet { half_bleach_log_td, tau_s, .. } = constants::STANDARD;
        [0, 1, 2].map(|k| {
            let half_bleach = Trolands(10f64.powf(half_bleach_log_td[k]));
            Kinetics::first_order(half_bleach, Seconds(tau_s[k]))
        })
    }

    /// The first-order law.
    pub fn first_order(half_bleach: Trolands, tau: Seconds) -> Self {
        Kinetics { law: Law::FirstOrder, half_bleach, tau }
    }

    /// s/tau, the bleaching rate of unscreened pigment, 1/s. The reciprocal does not depend on the
    /// place, so that a loop over places divides once.
    fn unscreened(&self, light: Trolands) -> f64 {
        light.0 * (1.0 / (self.half_bleach.0 * self.tau.0))
    }

    /// The two rates at `p` unbleached under `light`.
    pub fn rates(&self, p: f64, light: Trolands) -> Rates {
        let (rest, bleach) = (1.0 / self.tau.0, self.unscreened(light));
        match self.law {
            Law::FirstOrder => Rates { regenerate: rest, bleach },
            Law::SelfScreened { density, norm } => {
                Rates { regenerate: rest, bleach: norm * bleach * mean_decay(density * LN_10 * p) }
            }
            Law::RateLimited { km } => {
                Rates { regenerate: rest * (1.0 + km) / (1.0 - p + km), bleach }
            }
        }
    }

    /// The most by which a relative error of p can grow, however long: pigment that is screened by
    /// what lies before it bleaches faster, the less there is. 1 for the other laws.
    pub(crate) fn growth(&self) -> f64 {
        let [none, whole] = [0.0, 1.0].map(|p| self.rates(p, self.half_bleach).bleach);
        none / whole
    }

    /// Time in the dark from `p` to `target` unbleached; 0 if it is there already. With B = 1 - p:
    ///
    /// ```text
    /// tau ln(B0/B)                                         regeneration at 1/tau
    /// tau (B0 - B + Km ln(B0/B))/(1 + Km)                  rate-limited
    /// ```
    pub(crate) fn recovery(&self, p: f64, target: f64) -> Seconds {
        if p >= target {
            return Seconds(0.0);
        }
        let (before, after) = (1.0 - p, 1.0 - target);
        let folds = (before / after).ln();
        Seconds(match self.law {
            Law::FirstOrder | Law::SelfScreened { .. } => self.tau.0 * folds,
            Law::RateLimited { km } => self.tau.0 * (before - after + km * folds) / (1.0 + km),
        })
    }

    /// dp/dt, 1/s.
    pub fn change(&self, p: f64, light: Trolands) -> f64 {
        self.rates(p, light).change(p)
    }

    /// d(dp/dt)/dp, 1/s: how fast neighbouring histories approach each other. Always negative.
    pub(crate) fn slope(&self, p: f64, light: Trolands) -> f64 {
        let (rest, bleach) = (1.0 / self.tau.0, self.unscreened(light));
        match self.law {
            Law::FirstOrder => -(rest + bleach),
            Law::SelfScreened { density, norm } => {
                -(rest + norm * bleach * (-density * LN_10 * p).exp())
            }
            Law::RateLimited { km } => -(rest * km * (1.0 + km) / (1.0 - p + km).powi(2) + bleach),
        }
    }

    /// The sign of the second derivative of dp/dt by p, on which an enclosure rests.
    pub(crate) fn curvature(&self) -> Curvature {
        match self.law {
            Law::FirstOrder => Curvature::Straight,
            Law::SelfScreened { .. } => Curvature::Convex,
            Law::RateLimited { .. } => Curvature::Concave,
        }
    }

    /// The least and the greatest of -[`Kinetics::slope`] over all p from 0 to 1, 1/s. The greatest
    /// times the step is the `h lambda` that a method's limits speak of.
    pub(crate) fn contraction(&self, light: Trolands) -> [f64; 2] {
        let ends = [-self.slope(0.0, light), -self.slope(1.0, light)];
        [ends[0].min(ends[1]), ends[0].max(ends[1])]
    }

    /// The unbleached fraction under `light` that lasts (first order: Eq. 1 of the paper, as 1 -
    /// B).
    pub fn steady(&self, light: Trolands) -> f64 {
        let s = light.0 / self.half_bleach.0;
        match self.law {
            Law::FirstOrder => 1.0 / (1.0 + s),
            Law::SelfScreened { density, norm } => steady_screened(density * LN_10, norm * s),
            // The lesser root of s p^2 - (1 + Km)(1 + s) p + (1 + Km) = 0, in the form that does
            // not cancel.
            Law::RateLimited { km } => {
                let excess = 4.0 * s * km / (1.0 + km);
                2.0 / (1.0 + s + ((1.0 - s) * (1.0 - s) + excess).sqrt())
            }
        }
    }

    /// The steady light that leaves half of the pigment.
    pub(crate) fn half_bleach_light(&self) -> Trolands {
        let rates = self.rates(0.5, self.half_bleach);
        Trolands(self.half_bleach.0 * rates.regenerate / rates.bleach)
    }
}

/// (1 - e^-x)/x, the mean of e^-t over 0..x; g(p)/p with x = D p ln 10.
pub(crate) fn mean_decay(x: f64) -> f64 {
    if x.abs() < 1e-8 { 1.0 - 0.5 * x } else { -(-x).exp_m1() / x }
}

/// The root of 1 - p = s g(p), with g(p) = (1 - e^(-a p))/a. The difference falls and is convex in
/// p, so Newton's method from p = 0 climbs to the root without ever passing it.
fn steady_screened(a: f64, s: f64) -> f64 {
    if s.is_infinite() {
        return 0.0;
    }
    let mut p = 0.0;
    for _ in 0..64 {
        let next = p + (1.0 - p - s * p * mean_decay(a * p)) / (1.0 + s * (-a * p).exp());
        if next <= p {
            break;
        }
        p = next;
    }
    p
}

#[cfg(test)]
mod tests {
    use super::*;

    fn laws() -> impl Iterator<Item = Law> {
        Law::NAMES.into_iter().map(|(_, law)| law.with(0.5, 0.2))
    }

    #[test]
    fn every_law_is_listed_by_its_own_name() {
        assert!(Law::NAMES.iter().all(|(name, law)| *name == law.name()));
    }

    fn eye(law: Law) -> Kinetics {
        Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) }
    }

    #[test]
    fn at_the_steady_state_nothing_changes_under_any_law() {
        for law in laws() {
            for light in [0.0, 1.0, 300.0, 2e4, 1e6, 1e10, 1e12] {
                let kinetics = eye(law);
                let p = kinetics.steady(Trolands(light));
                let rates = kinetics.rates(p, Trolands(light));
                assert!(
                    (rates.rest() / p - 1.0).abs() < 1e-14,
                    "{law:?} {light}: {p} against {}",
                    rates.rest()
                );
            }
        }
    }

    #[test]
    fn infinite_light_leaves_nothing() {
        for law in laws() {
            assert_eq!(eye(law).steady(Trolands(f64::INFINITY)), 0.0);
        }
    }

    #[test]
    fn half_of_the_pigment_is_gone_at_the_half_bleach_light() {
        for law in laws() {
            let kinetics = eye(law);
            assert!((kinetics.steady(kinetics.half_bleach_light()) - 0.5).abs() < 1e-15);
        }
        assert!((eye(Law::self_screened(0.5)).half_bleach_light().0 - 2e4).abs() < 1e-8);
        let limited = eye(Law::RateLimited { km: 0.2 }).half_bleach_light().0 / 2e4;
        assert!((limited - 1.2 / 0.7).abs() < 1e-12, "model.md 3: 1.71 I0, found {limited} I0");
    }

    #[test]
    fn the_slope_is_the_derivative_of_the_change() {
        for law in laws() {
            for p in [0.1, 0.5, 0.9] {
                let (kinetics, light, d) = (eye(law), Trolands(1e6), 1e-5);
                let measured =
                    (kinetics.change(p + d, light) - kinetics.change(p - d, light)) / (2.0 * d);
                assert!((measured / kinetics.slope(p, light) - 1.0).abs() < 1e-8);
            }
        }
    }

    #[test]
    fn recovery_takes_as_long_as_the_law_integrated_in_fine_steps() {
        for law in laws() {
            let pigment = Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(90.0) };
            let (mut p, mut time, h) = (0.1, 0.0, 1e-3);
            while p < 0.95 {
                let half = p + 0.5 * h * pigment.change(p, Trolands(0.0));
                p += h * pigment.change(half, Trolands(0.0));
                time += h;
            }
            let ours = pigment.recovery(0.1, 0.95).0;
            assert!((ours / time - 1.0).abs() < 1e-4, "{law:?}: {ours} for {time}");
        }
        let pigment = Kinetics::standard()[0];
        assert_eq!(pigment.recovery(0.96, 0.95), Seconds(0.0));
    }
}
