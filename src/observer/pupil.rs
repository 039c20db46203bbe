//! The pupil: its diameter from the adapting luminance, and how fast it follows.
//!
//! The paper prints both classical formulas (its Eq. 3 and 4) with a unit shift of the wrong sign;
//! the published forms, for cd/m2, are the defaults here and the printed ones stay available by
//! name. Moon & Spencer 1944 (JOSA 34, 319); de Groot & Gebhard 1952 (JOSA 42, 492); Watson &
//! Yellott 2012 (Journal of Vision 12(10):12).

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use crate::units::{Millimetres, Nits, Seconds};

/// Smallest diameter that a formula may give, mm.
pub(crate) const SMALLEST: Millimetres = Millimetres(2.0);
/// Largest diameter that a formula may give, mm.
pub(crate) const LARGEST: Millimetres = Millimetres(8.0);

/// How the settled diameter follows from light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Rule {
    /// d = 4.9 - 3 tanh(0.4 log10 La).
    MoonSpencer,
    /// Paper Eq. 3: d = 4.9 - 3 tanh(0.4 (log10 La + 1)).
    MoonSpencerAsPrinted,
    /// log10 d = 0.8558 - 4.01e-4 (log10 La + 7.6)^3.
    DeGrootGebhard,
    /// Paper Eq. 4: ... (log10 La + 8.6)^3.
    DeGrootGebhardAsPrinted,
    /// The unified formula, from the flux of a field of 60 degrees: the picture where it covers
    /// that, the surround in the rest; for an age and one or two eyes.
    WatsonYellott { age: f64, eyes: u8 },
    /// A diameter.
    Fixed(Millimetres),
}

/// What a pupil responds to in one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Adapting {
    /// Mean over the fovea, cd/m2 (the paper's La).
    pub fovea: Nits,
    /// Mean over the whole picture, cd/m2.
    pub picture: Nits,
    /// Area of the picture, square degrees.
    pub area_deg2: f64,
    /// Luminance of what lies around the picture, cd/m2.
    pub surround: Nits,
}

/// The adapting field of the unified formula, square degrees: 60 degrees across.
const ADAPTING_FIELD_DEG2: f64 = 2827.0;

impl Rule {
    /// The settled diameter.
    pub fn diameter(self, light: Adapting) -> Millimetres {
        let log = light.fovea.0.max(0.0).log10();
        let d = match self {
            Rule::Fixed(d) => return d,
            Rule::MoonSpencer => 4.9 - 3.0 * (0.4 * log).tanh(),
            Rule::MoonSpencerAsPrinted => 4.9 - 3.0 * (0.4 * (log + 1.0)).tanh(),
            Rule::DeGrootGebhard => de_groot_gebhard(log + 7.6),
            Rule::DeGrootGebhardAsPrinted => de_groot_gebhard(log + 8.6),
            Rule::WatsonYellott { age, eyes } => watson_yellott(light, age, eyes),
        };
        Millimetres(d.clamp(SMALLEST.0, LARGEST.0))
    }
}

fn de_groot_gebhard(shifted_log: f64) -> f64 {
    10f64.powf(0.8558 - 4.01e-4 * shifted_log.powi(3))
}

fn watson_yellott(light: Adapting, age: f64, eyes: u8) -> f64 {
    let monocular = if eyes == 1 { 0.1 } else { 1.0 };
    let inside = light.area_deg2.min(ADAPTING_FIELD_DEG2);
    let seen = light.picture.0.max(0.0) * inside;
    let around = light.surround.0.max(0.0) * (ADAPTING_FIELD_DEG2 - inside);
    let flux = (seen + around) * monocular;
    let f = (flux / 846.0).powf(0.41);
    let d = 7.75 - 5.75 * f / (f + 2.0);
    d + (age - 28.58) * (0.021323 - 0.0095623 * d)
}

/// Area of a pupil, mm2 (paper Eq. 2).
pub(crate) fn area(diameter: Millimetres) -> f64 {
    std::f64::consts::PI * diameter.0 * diameter.0 / 4.0
}

/// How a pupil follows its rule: a delay, then a first-order filter on the diameter. Zeros: at
/// once.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(crate) struct Dynamics {
    pub(crate) delay: Seconds,
    pub(crate) closing: Seconds,
    pub(crate) opening: Seconds,
}

/// A pupil in time: settled on the first frame; a frame is seen through the diameter at its end.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(crate) struct Pupil {
    rule: Rule,
    dynamics: Dynamics,
    now: f64,
    diameter: Option<f64>,
    /// Settled diameters with the times from which they hold at the filter, s.
    targets: VecDeque<(f64, f64)>,
}

impl Pupil {
    /// A pupil that has seen no light yet.
    pub(crate) fn new(rule: Rule, dynamics: Dynamics) -> Self {
        Pupil { rule, dynamics, now: 0.0, diameter: None, targets: VecDeque::new() }
    }

    /// Follows one frame of light and returns the diameter at its end.
    pub(crate) fn follow(&mut self, light: Adapting, duration: Seconds) -> Millimetres {
        let target = self.rule.diameter(light).0;
        let end = self.now + duration.0;
        if self.diameter.is_none() {
            self.diameter = Some(target);
            self.targets.push_back((f64::NEG_INFINITY, target));
        } else {
            self.targets.push_back((self.now + self.dynamics.delay.0, target));
        }
        while self.now < end {
            self.drop_past_targets();
            let until = self.targets.get(1).map_or(end, |next| next.0.min(end));
            self.relax(until - self.now);
            self.now = until;
        }
        Millimetres(self.diameter.unwrap_or(target))
    }

    /// Forgets targets that a later one has replaced.
    fn drop_past_targets(&mut self) {
        while self.targets.get(1).is_some_and(|next| next.0 <= self.now) {
            self.targets.pop_front();
        }
    }

    fn relax(&mut self, dt: f64) {
        let (Some(d), Some(&(_, target))) = (self.diameter, self.targets.front()) else { return };
        let constant = if target < d { self.dynamics.closing.0 } else { self.dynamics.opening.0 };
        let share = if constant == 0.0 { 1.0 } else { -(-dt / constant).exp_m1() };
        self.diameter = Some(d + share * (target - d));
    }

    /// Whether another pupil follows the same rule, from a sound diameter and time.
    pub(crate) fn fits(&self, other: &Pupil) -> bool {
        let sound = |(from, d): &(f64, f64)| !from.is_nan() && d.is_finite();
        (self.rule, self.dynamics) == (other.rule, other.dynamics)
            && other.now.is_finite()
            && other.diameter.is_none_or(f64::is_finite)
            && other.targets.iter().all(sound)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn uniform(nits: f64) -> Adapting {
        Adapting { fovea: Nits(nits), picture: Nits(nits), area_deg2: 100.0, surround: Nits(nits) }
    }

    #[test]
    fn moon_spencer_gives_4_9_mm_at_its_centre() {
        assert_eq!(Rule::MoonSpencer.diameter(uniform(1.0)).0, 4.9);
        assert_eq!(Rule::MoonSpencerAsPrinted.diameter(uniform(0.1)).0, 4.9);
    }

    #[test]
    fn every_rule_stays_between_two_and_eight_millimetres_and_closes_with_light() {
        let rules = [
            Rule::MoonSpencer,
            Rule::MoonSpencerAsPrinted,
            Rule::DeGrootGebhard,
            Rule::DeGrootGebhardAsPrinted,
            Rule::WatsonYellott { age: 30.0, eyes: 2 },
            Rule::WatsonYellott { age: 70.0, eyes: 1 },
        ];
        for rule in rules {
            let mut last = 8.0;
            for nits in std::iter::once(0.0).chain((-8..10).map(|e| 10f64.powi(e))) {
                let d = rule.diameter(uniform(nits)).0;
                assert!((2.0..=8.0).contains(&d) && d <= last, "{rule:?} at {nits}: {d}");
                last = d;
            }
        }
    }

    #[test]
    fn a_pupil_without_dynamics_is_its_rule() {
        let mut pupil = Pupil::new(Rule::MoonSpencer, Dynamics::default());
        for nits in [1.0, 1e4, 3.0] {
            assert_eq!(
                pupil.follow(uniform(nits), Seconds(0.1)),
                Rule::MoonSpencer.diameter(uniform(nits))
            );
        }
    }

    #[test]
    fn a_pupil_waits_then_closes_exponentially_whatever_the_frame_rate() {
        let dynamics =
            Dynamics { delay: Seconds(0.22), closing: Seconds(0.3), opening: Seconds(0.9) };
        let closed_form = |t: f64| {
            let (from, to) = (4.9, Rule::MoonSpencer.diameter(uniform(1e4)).0);
            to + (from - to) * (-(t - 0.22f64).max(0.0) / 0.3).exp()
        };
        for frames in [1usize, 7, 48] {
            let mut pupil = Pupil::new(Rule::MoonSpencer, dynamics);
            pupil.follow(uniform(1.0), Seconds(1.0));
            let h = 1.0 / frames as f64;
            for n in 1..=frames {
                let d = pupil.follow(uniform(1e4), Seconds(h)).0;
                assert!((d - closed_form(n as f64 * h)).abs() < 1e-12, "frame {n} of {frames}");
            }
        }
    }
}
