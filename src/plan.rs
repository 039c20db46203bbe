//! No more than a scene needs: which places are modelled at all, and what leaving the others out can cost.
//!
//! ```text
//! B' <= (c s - B)/tau        every law, from B = 0: no regeneration is slower than first order
//! 0 <= 1 - R(p)/R(1) <= B    so what is left out of p is left out of no catch more (numerics 5)
//! ```
//!
//! A tile whose bound stays below half the budget is left untouched and its pixels are returned as they came. The
//! first frame that could pass that bound is tracked from p = 1, for good: what was left out before only shrinks,
//! because every law contracts (relative to p it can grow, under self-screening, by [`Kinetics::growth`]). Where a
//! frame lasts so long that nothing of the state before it remains, its steady state is taken. A quarter of the
//! budget each goes to that and to the sub-steps of the nonlinear laws.
//! The bounds run along with the frames: a file is read once.

use serde_json::{Value, json};

use crate::eye::directional;
use crate::kinetics::{Kinetics, Law};
use crate::percept::level_bound;
use crate::retina::Model;
use crate::units::{Seconds, Trolands};

/// Share of the budget for the bleaching of places that are left untouched.
const UNTOUCHED: f64 = 0.5;

/// Shares of the budget for the steady state, and for the sub-steps of nonlinear laws.
pub const STEADY: f64 = 0.25;
pub const SUBSTEPS: f64 = 0.25;

/// Largest relative error of a catch from light, weights and percept in single precision.
const SINGLE_BOUND: f64 = 1e-5;

/// The greatest change of p for a change of ln I: 1/e (numerics 5.5).
const PER_LOG_LIGHT: f64 = 0.3679;

/// What is modelled of a scene, decided while its frames go by.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Largest error of p and of a catch; `None`: what was asked for is done everywhere.
    budget: Option<f64>,
    /// For each tile the most that may have bleached unseen; infinite once the tile is tracked.
    pub(crate) ledger: Vec<f64>,
    /// The greatest peak density of a pigment, on which the levels' error depends.
    density: f64,
    met: Met,
}

/// What was left out so far, at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Met {
    untouched: f64,
    steady: f64,
    /// Whether some tile was stepped, and whether by following rather than by its steady state.
    stepped: bool,
    followed: bool,
}

/// The bound of a tile, carried over one step.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    per_half_bleach: [f64; 3],
    share: [f64; 3],
    allowed: f64,
}

impl Rule {
    /// What may have bleached unseen after a step whose light is at most `greatest`, td; infinity once that is too
    /// much to be left out.
    pub fn after(&self, bound: f64, greatest: [f32; 3]) -> f64 {
        if bound.is_infinite() {
            return bound;
        }
        let of_cone = |k: usize| {
            let most = f64::from(greatest[k]) * self.per_half_bleach[k];
            bound + self.share[k] * (most - bound)
        };
        let after = (0..3).map(of_cone).fold(0.0, f64::max);
        if after < self.allowed { after } else { f64::INFINITY }
    }
}

impl Plan {
    /// A plan that keeps a budget, or one that does everywhere what is asked for.
    pub fn new(budget: Option<f64>) -> Self {
        Plan { budget, ledger: Vec::new(), density: 0.0, met: Met::default() }
    }

    /// Whether it is free to choose.
    pub fn is_free(&self) -> bool {
        self.budget.is_some()
    }

    /// Opens the ledger. `rested`: whether every pigment is whole; of an eye that is not, nothing may be left out.
    pub(crate) fn open(&mut self, tiles: usize, rested: impl FnOnce() -> bool, density: [f64; 3]) {
        self.density = density.into_iter().fold(0.0, f64::max);
        if self.ledger.len() != tiles {
            let known = self.ledger.is_empty() && rested();
            self.ledger = vec![if known { 0.0 } else { f64::INFINITY }; tiles];
        }
    }

    /// How pigment is to be moved over one frame.
    pub(crate) fn model(&self, asked: Model, pigments: &[Kinetics; 3], dt: Seconds) -> Model {
        let (Some(budget), Model::Tracked { method, .. }) = (self.budget, asked) else { return asked };
        let lasts = method.name == "exact" && remembered(pigments, dt) <= STEADY * budget;
        if lasts { Model::Steady } else { asked }
    }

    /// The rule for one frame.
    pub(crate) fn rule(&self, pigments: &[Kinetics; 3], dt: Seconds) -> Rule {
        Rule {
            per_half_bleach: pigments.each_ref().map(|p| ROUNDED_UP * rate_at_rest(p) / p.half_bleach.0),
            share: pigments.each_ref().map(|p| -(-dt.0 / p.tau.0).exp_m1()),
            allowed: self.budget.map_or(0.0, |budget| UNTOUCHED * budget / growth(pigments)),
        }
    }

    /// Takes note of a frame: the greatest bound of its untouched tiles, and whether any tile was stepped.
    pub(crate) fn note(&mut self, untouched: f64, stepped: bool, by: Model, pigments: &[Kinetics; 3], dt: Seconds) {
        self.met.untouched = self.met.untouched.max(untouched);
        self.met.stepped |= stepped;
        if stepped {
            match by {
                Model::Steady => self.met.steady = self.met.steady.max(remembered(pigments, dt)),
                _ => self.met.followed = true,
            }
        }
    }

    /// What was done so far: `none` where every place was left untouched.
    pub fn name(&self, asked: Model) -> &'static str {
        match (self.budget, self.met) {
            (None, _) => asked.name(),
            (_, Met { stepped: false, .. }) => Model::Unbleached.name(),
            (_, Met { followed: false, .. }) => Model::Steady.name(),
            _ => asked.name(),
        }
    }

    /// The terms of the bound, for the report: what, and how much of p or of a catch it can cost at most. `null`:
    /// nothing is promised, because a model or a method was asked for by name.
    pub fn report(&self, asked: Model, pigments: &[Kinetics; 3]) -> Value {
        let terms = self.terms(asked, pigments);
        let total: Option<f64> = terms.iter().map(|(_, bound)| *bound).sum();
        let term = |(what, bound): &(&str, Option<f64>)| json!({ "what": what, "bound": bound });
        let tracked = self.ledger.iter().filter(|bound| bound.is_infinite()).count();
        json!({
            "model": self.name(asked),
            "budget": self.budget,
            "terms": terms.iter().map(term).collect::<Vec<_>>(),
            "bound_total": total,
            "tiles": self.ledger.len(),
            "tiles_tracked": tracked,
        })
    }

    /// The largest error that is promised; `None` if nothing is.
    pub fn bound(&self, asked: Model, pigments: &[Kinetics; 3]) -> Option<f64> {
        self.terms(asked, pigments).into_iter().map(|(_, bound)| bound).sum()
    }

    fn terms(&self, asked: Model, pigments: &[Kinetics; 3]) -> Vec<(&'static str, Option<f64>)> {
        let mut terms = Vec::new();
        if self.is_free() {
            // Of a catch: relative to what is left. Once such a place is tracked its relative error may grow a little.
            let left = 1.0 - self.met.untouched;
            let untouched = (left > 0.0).then(|| growth(pigments) * self.met.untouched / left);
            terms.push(("bleaching of places left untouched", untouched));
        } else if !matches!(asked, Model::Tracked { .. }) {
            terms.push(("the model that was asked for", None));
        }
        if self.met.steady > 0.0 {
            terms.push(("steady state in place of the way there", Some(self.met.steady)));
        }
        let linear = pigments.iter().all(|p| p.law == Law::FirstOrder);
        match asked {
            Model::Tracked { method, substeps, budget } if self.met.followed || !self.is_free() => {
                if method.name != "exact" || (substeps > 0 && !linear) {
                    terms.push(("the steps that were asked for", None));
                } else if !linear {
                    terms.push(("rates frozen over sub-steps", Some(budget)));
                }
            }
            _ => {}
        }
        if self.met.stepped || !self.is_free() {
            terms.push(("pigment read at four levels", Some(level_bound(self.density))));
            terms.push(("Stiles-Crawford weight by levels", Some(PER_LOG_LIGHT * directional::LEVEL_BOUND)));
            terms.push(("single precision of light and percept", Some(SINGLE_BOUND)));
        }
        terms
    }

    /// Everything that the next frame depends on, for a checkpoint.
    pub fn to_numbers(&self) -> Vec<f64> {
        let Met { untouched, steady, stepped, followed } = self.met;
        let met = [untouched, steady, f64::from(u8::from(stepped)), f64::from(u8::from(followed))];
        met.into_iter().chain(self.ledger.iter().copied()).collect()
    }

    /// Takes up what [`Plan::to_numbers`] gave.
    pub fn restore(&mut self, numbers: &[f64]) {
        if let [untouched, steady, stepped, followed, ledger @ ..] = numbers {
            let (untouched, steady) = (*untouched, *steady);
            self.met = Met { untouched, steady, stepped: *stepped > 0.0, followed: *followed > 0.0 };
            self.ledger = ledger.to_vec();
        }
    }
}

/// Illuminances come in single precision; their bound must not be below them.
const ROUNDED_UP: f64 = 1.0 + 1e-5;

/// c: how fast whole pigment bleaches under one half-bleach light, times tau.
fn rate_at_rest(pigment: &Kinetics) -> f64 {
    pigment.rates(1.0, pigment.half_bleach).bleach * pigment.tau.0
}

/// The most by which a relative error can grow in any class.
fn growth(pigments: &[Kinetics; 3]) -> f64 {
    pigments.iter().map(Kinetics::growth).fold(1.0, f64::max)
}

/// The most that can remain after a step of where pigment was before it, whatever the light.
fn remembered(pigments: &[Kinetics; 3], dt: Seconds) -> f64 {
    let decay = |p: &Kinetics| (-dt.0 * p.contraction(Trolands(0.0))[0]).exp();
    pigments.iter().map(decay).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::step;
    use proptest::prelude::*;

    fn laws() -> impl Strategy<Value = Law> {
        prop_oneof![
            Just(Law::FirstOrder),
            (0.1..0.6).prop_map(Law::self_screened),
            (0.05..1.0).prop_map(|km| Law::RateLimited { km })
        ]
    }

    proptest! {
        #[test]
        fn what_has_bleached_unseen_never_exceeds_its_bound(
            law in laws(),
            steps in prop::collection::vec((0.0..10.0f64, -3.0..2.8f64), 1..40),
        ) {
            let pigment = Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) };
            let plan = Plan::new(Some(1e9));
            let (mut bound, mut p) = (0.0, 1.0);
            for (log_td, log_s) in steps {
                let (td, dt) = (10f64.powf(log_td) as f32, Seconds(10f64.powf(log_s)));
                bound = plan.rule(&[pigment; 3], dt).after(bound, [td; 3]);
                p = step::enclosed_within(&pigment, p, Trolands(td.into()), dt, 1e-7).p;
                prop_assert!(1.0 - p <= bound + 1e-6, "{} {bound}", 1.0 - p);
            }
        }
    }

    #[test]
    fn a_tile_past_its_bound_is_tracked_for_good_and_an_indoor_one_never() {
        let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
        let rule = Plan::new(Some(1e-3)).rule(&pigments, Seconds(1.0 / 24.0));
        let settled = (0..1_000_000).fold(0.0, |bound, _| rule.after(bound, [9.0; 3]));
        assert!(settled > 4.4e-4 && settled < 5e-4);
        let passed = (0..4000).fold(0.0, |bound, _| rule.after(bound, [20.0; 3]));
        assert!(passed.is_infinite() && rule.after(passed, [0.0; 3]).is_infinite());
    }

    #[test]
    fn nothing_is_left_out_unless_the_plan_is_free_to() {
        let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
        assert!(Plan::new(None).rule(&pigments, Seconds(1.0)).after(0.0, [0.0; 3]).is_infinite());
    }
}
