//! No more than a scene needs: which places are modelled at all, and what leaving the others out
//! can cost.
//!
//! ```text
//! B' <= (c s - B)/tau        every law, from B = 0: no regeneration is slower than first order
//! 0 <= 1 - R(p)/R(1) <= B    so what is left out of p is left out of no catch more (numerics 5)
//! ```
//!
//! A tile whose bound stays below half the budget is left untouched and its pixels are returned as
//! they came. The first frame that could pass that bound is tracked from p = 1, for good: what was
//! left out before only shrinks, because every law contracts (relative to p it can grow, under
//! self-screening, by [`Kinetics::growth`]). Where a frame lasts so long that nothing of the state
//! before it remains, its steady state is taken. A quarter of the budget each goes to that and to
//! the sub-steps of the nonlinear laws. The bounds run along with the frames: a file is read once.

mod ledger;
mod terms;

use crate::eye::retina::Model;
use crate::kinetics::{Kinetics, Law};
use crate::units::{Seconds, Trolands};
use crate::vision::Vision;

pub(crate) use ledger::Ledger;
pub use terms::Term;

/// Share of the budget for the bleaching of places that are left untouched.
const UNTOUCHED: f64 = 0.5;

/// Shares of the budget for the steady state, and for the sub-steps of nonlinear laws.
pub const STEADY: f64 = 0.25;
pub const SUBSTEPS: f64 = 0.25;

/// What is modelled of a scene, decided while its frames go by.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// Largest error of p and of a catch; `None`: what was asked for is done everywhere.
    budget: Option<f64>,
    /// For each tile the most that may have bleached unseen.
    pub(crate) ledger: Ledger,
    /// The greatest peak density of a pigment, on which the levels' error depends.
    density: f64,
    /// Whether frames come as sums over bands, so that what is seen is their light only to single
    /// precision.
    projected: bool,
    met: Met,
}

/// What was left out so far, and what could have been.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct Met {
    left_out: LeftOut,
    /// What would have bleached unseen if every tile had been left untouched: by now, and at the
    /// most.
    unseen: f64,
    everywhere: f64,
    /// The most that a steady state would have been wrong by, had it been taken everywhere.
    remembered: f64,
}

/// What was left out of some places over some time, at most.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LeftOut {
    /// Bleached unseen in a tile that was left untouched.
    pub untouched: f64,
    /// Wrong, relative to p, where a steady state was taken because the step outlasts what pigment
    /// remembers.
    pub outlasted: f64,
    /// Whether any place was stepped, and whether by its steady state or by following.
    pub stepped: bool,
    pub settled: bool,
    pub followed: bool,
}

impl LeftOut {
    /// What was left out of both.
    pub fn and(self, other: LeftOut) -> LeftOut {
        LeftOut {
            untouched: self.untouched.max(other.untouched),
            outlasted: self.outlasted.max(other.outlasted),
            stepped: self.stepped | other.stepped,
            settled: self.settled | other.settled,
            followed: self.followed | other.followed,
        }
    }
}

/// What a plan allows over one step.
#[derive(Clone, Copy, Debug)]
pub struct Rule {
    per_half_bleach: [f64; 3],
    share: [f64; 3],
    allowed: f64,
    lasting: [Lasting; 3],
}

/// From which light on a step outlasts what a pigment remembers. Relative to p, with y = (h/tau) (1
/// + s):
///
/// ```text
/// |p1 - p_inf|/p_inf <= (1 + s) e^-y = (tau/h) y e^-y,   which falls from y = 1 on
/// ```
#[derive(Clone, Copy, Debug)]
struct Lasting {
    steps_of_tau: f64,
    half_bleach: f64,
    /// The least light, td; infinite where a step never does.
    from: f64,
}

impl Lasting {
    /// For a pigment and a step that may leave so much.
    fn new(pigment: &Kinetics, dt: Seconds, most: f64) -> Self {
        let steps_of_tau = dt.0 / pigment.tau.0;
        // y = ln(y/e) settles quickly where y is large, and only there does it matter.
        let share = most * steps_of_tau;
        let y = (0..60).fold(1.0, |y: f64, _| (y / share).ln().max(1.0));
        let from = ROUNDED_UP * (y / steps_of_tau - 1.0).max(0.0) * pigment.half_bleach.0;
        let known = pigment.law == Law::FirstOrder && share > 0.0;
        Lasting {
            steps_of_tau,
            half_bleach: pigment.half_bleach.0,
            from: if known { from } else { f64::INFINITY },
        }
    }

    /// What the steady state of such light, td, or brighter may be wrong by.
    fn bound(self, least: f64) -> f64 {
        let y = (self.steps_of_tau * (1.0 + least / self.half_bleach)).max(1.0);
        y * (-y).exp() / self.steps_of_tau
    }
}

impl Rule {
    /// What may have bleached unseen after a step whose light is at most `greatest`, td; infinity
    /// once that is too much to be left out.
    pub fn after(&self, bound: f64, greatest: [f32; 3]) -> f64 {
        if bound.is_infinite() {
            return bound;
        }
        let after = self.bleached(bound, greatest.map(f64::from));
        if after < self.allowed { after } else { f64::INFINITY }
    }

    fn bleached(&self, bound: f64, greatest: [f64; 3]) -> f64 {
        let of_cone =
            |k: usize| bound + self.share[k] * (greatest[k] * self.per_half_bleach[k] - bound);
        (0..3).map(of_cone).fold(0.0, f64::max)
    }

    /// Whether the steady state of cone `k` will do for a run of places, and what it costs then.
    /// `least` is asked for only where the greatest light, td, is enough.
    pub fn outlasts(&self, k: usize, greatest: f32, least: impl FnOnce() -> f32) -> Option<f64> {
        let lasting = &self.lasting[k];
        if f64::from(greatest) < lasting.from {
            return None;
        }
        let least = f64::from(least());
        (least >= lasting.from && lasting.from.is_finite()).then(|| lasting.bound(least))
    }
}

impl Plan {
    /// A plan that keeps a budget, or one that does everywhere what is asked for.
    pub fn new(budget: Option<f64>) -> Self {
        Plan {
            budget,
            ledger: Ledger::default(),
            density: 0.0,
            projected: false,
            met: Met::default(),
        }
    }

    /// Whether it is free to choose.
    pub fn is_free(&self) -> bool {
        self.budget.is_some()
    }

    /// Opens the ledger of `rows` rows of `per_row` tiles. `rested`: whether every pigment is
    /// whole; of an eye that is not, nothing may be left out.
    pub(crate) fn open(
        &mut self,
        per_row: usize,
        rows: usize,
        rested: impl FnOnce() -> bool,
        vision: &Vision,
    ) {
        self.density = vision.observer.fundamentals.density().into_iter().fold(0.0, f64::max);
        self.projected = !vision.returns_its_light();
        if self.ledger.bounds().is_empty() {
            let known = rested();
            self.met.everywhere = if known { 0.0 } else { 1.0 };
            let bound = if known { 0.0 } else { f64::INFINITY };
            self.ledger = Ledger::new(vec![bound; per_row * rows], per_row, bound);
        }
    }

    /// How pigment is to be moved over one frame.
    pub(crate) fn model(&self, asked: Model, pigments: &[Kinetics; 3], dt: Seconds) -> Model {
        let (Some(budget), Model::Tracked { method, .. }) = (self.budget, asked) else {
            return asked;
        };
        let lasts = method.name == "exact" && remembered(pigments, dt) <= STEADY * budget;
        if lasts { Model::Steady } else { asked }
    }

    /// The rule for one frame.
    pub(crate) fn rule(&self, pigments: &[Kinetics; 3], dt: Seconds) -> Rule {
        Rule {
            per_half_bleach: pigments
                .each_ref()
                .map(|p| ROUNDED_UP * rate_at_rest(p) / p.half_bleach.0),
            share: pigments.each_ref().map(|p| -(-dt.0 / p.tau.0).exp_m1()),
            allowed: self.budget.map_or(0.0, |budget| UNTOUCHED * budget / growth(pigments)),
            lasting: pigments
                .each_ref()
                .map(|p| Lasting::new(p, dt, self.budget.map_or(0.0, |b| STEADY * b))),
        }
    }

    /// Takes note of a frame: what was left out, its greatest light, td, and how pigment was moved
    /// where it was.
    pub(crate) fn note(
        &mut self,
        left_out: LeftOut,
        greatest: [f64; 3],
        by: Model,
        pigments: &[Kinetics; 3],
        dt: Seconds,
    ) {
        let (rule, remembered) = (self.rule(pigments, dt), remembered(pigments, dt));
        let lasted = left_out.stepped && self.is_free() && matches!(by, Model::Steady);
        let outlasted = if lasted { remembered } else { left_out.outlasted };
        let unseen = rule.bleached(self.met.unseen, greatest);
        self.met = Met {
            left_out: self.met.left_out.and(LeftOut {
                outlasted,
                settled: lasted | left_out.settled,
                ..left_out
            }),
            unseen,
            everywhere: self.met.everywhere.max(unseen).min(1.0),
            remembered: self.met.remembered.max(remembered),
        };
    }

    /// What was done so far: `none` where every place was left untouched.
    pub fn name(&self, asked: Model) -> &'static str {
        match (self.budget, self.met.left_out) {
            (None, _) => asked.name(),
            (_, LeftOut { stepped: false, .. }) => Model::Unbleached.name(),
            (_, LeftOut { followed: false, .. }) => Model::Steady.name(),
            _ => asked.name(),
        }
    }

    /// Everything that the next frame depends on, for a checkpoint.
    pub fn to_numbers(&self) -> Vec<f64> {
        let Met { left_out, unseen, everywhere, remembered } = self.met;
        let LeftOut { untouched, outlasted, stepped, settled, followed } = left_out;
        let flags = [stepped, settled, followed].map(|flag| f64::from(u8::from(flag)));
        let met =
            [untouched, outlasted, flags[0], flags[1], flags[2], unseen, everywhere, remembered];
        let met = met.into_iter().chain([self.ledger.per_row() as f64, self.ledger.beyond()]);
        met.chain(self.ledger.bounds().iter().copied()).collect()
    }

    /// Takes up what [`Plan::to_numbers`] gave.
    pub fn restore(&mut self, numbers: &[f64]) {
        if let [
            untouched,
            outlasted,
            stepped,
            settled,
            followed,
            unseen,
            everywhere,
            remembered,
            per_row,
            beyond,
            bounds @ ..,
        ] = numbers
        {
            let [stepped, settled, followed] = [stepped, settled, followed].map(|flag| *flag > 0.0);
            let left_out = LeftOut {
                untouched: *untouched,
                outlasted: *outlasted,
                stepped,
                settled,
                followed,
            };
            self.met =
                Met { left_out, unseen: *unseen, everywhere: *everywhere, remembered: *remembered };
            self.ledger = Ledger::new(bounds.to_vec(), *per_row as usize, *beyond);
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
