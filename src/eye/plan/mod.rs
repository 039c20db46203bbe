//! No more than a scene needs: which places are modelled at all, and what leaving the others out
//! can cost.
//!
//! ```text
//! B' <= (c s - B)/tau        every law, from B = 0: no regeneration is slower than first order
//! 0 <= 1 - R(p)/R(1) <= B    so what is left out of p is left out of no catch more
//! ```
//!
//! A tile whose bound stays below a quarter of the budget is left untouched and its pixels are
//! returned as they came. The first frame that could pass that bound is tracked from p = 1, for
//! good: what was left out before only shrinks, because every law contracts (relative to p it can
//! grow, under self-screening, by `Kinetics::growth`). Where a frame lasts so long that nothing of
//! the state before it remains, its steady state is taken. An eighth of the budget each goes to that
//! and to the sub-steps of the nonlinear laws; the rest is for the levels of p and of the
//! Stiles-Crawford weight. The bounds run along with the frames: a file is read once.

mod ledger;
pub(super) mod rule;
mod terms;

use serde::{Deserialize, Serialize};

use crate::eye::pigment::Model;
use crate::eye::stats::LookStats;
use crate::kinetics::Kinetics;
use crate::units::{Seconds, Trolands};
use crate::vision::Vision;

use ledger::Ledger;
use rule::Rule;
pub(crate) use terms::least_budget;

/// The budget where none is asked for: the largest error of p and of a catch.
pub(crate) const BUDGET: f64 = 1e-3;

/// Share of the budget for the bleaching of places that are left untouched.
const UNTOUCHED: f64 = 0.25;

/// Shares of the budget for the steady state, and for the sub-steps of nonlinear laws.
pub(crate) const STEADY: f64 = 0.125;
pub const SUBSTEPS: f64 = 0.125;

/// What is modelled of a scene, decided while its frames go by.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Plan {
    /// Largest error of p and of a catch; `None`: what was asked for is done everywhere.
    budget: Option<f64>,
    /// For each tile the most that may have bleached unseen.
    pub(super) ledger: Ledger,
    /// Largest error of a catch from the levels of p.
    levels: f64,
    /// Whether frames come as sums over bands, so that what is seen is their light only to single
    /// precision.
    projected: bool,
    stats: PlanStats,
}

/// What was left out so far, and what could have been.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
struct PlanStats {
    /// The most that has bleached unseen in a tile that was left untouched.
    untouched: f64,
    /// Whether any place was stepped, and whether by its steady state or by following.
    stepped: bool,
    settled: bool,
    followed: bool,
    /// The most that a steady state that was taken is wrong by, relative to p.
    forgotten: f64,
    /// The least fraction that any place has come to.
    least: f64,
    /// What would have bleached unseen if every tile had been left untouched: by now, and at the
    /// most.
    unseen: f64,
    everywhere: f64,
    /// The most that a steady state would have been wrong by, had it been taken everywhere.
    remembered: f64,
}

impl PlanStats {
    const NONE: PlanStats = PlanStats {
        untouched: 0.0,
        stepped: false,
        settled: false,
        followed: false,
        forgotten: 0.0,
        least: 1.0,
        unseen: 0.0,
        everywhere: 0.0,
        remembered: 0.0,
    };
}

impl Plan {
    /// A plan that keeps a budget, or one that does everywhere what is asked for.
    pub(crate) fn new(budget: Option<f64>) -> Self {
        Plan {
            budget,
            ledger: Ledger::default(),
            levels: 0.0,
            projected: false,
            stats: PlanStats::NONE,
        }
    }

    /// Whether it is free to choose.
    pub(crate) fn is_free(&self) -> bool {
        self.budget.is_some()
    }

    /// Opens the ledger of `rows` rows of `per_row` tiles. `rested`: whether every pigment is
    /// unbleached; of an eye that is not, nothing may be left out. Where rows are cut into other
    /// tiles than before, each has the bound of the worst.
    pub(super) fn open(
        &mut self,
        per_row: usize,
        rows: usize,
        rested: impl FnOnce() -> bool,
        vision: &Vision,
    ) {
        if self.ledger.bounds().is_empty() {
            self.levels = vision.levels_bound();
        }
        self.projected = !vision.returns_its_light();
        let ledger = &self.ledger;
        if ledger.bounds().is_empty() {
            let bound = if rested() { 0.0 } else { f64::INFINITY };
            self.stats.everywhere = if bound == 0.0 { 0.0 } else { 1.0 };
            self.ledger = Ledger::new(vec![bound; per_row * rows], per_row, bound);
        } else if ledger.per_row() != per_row {
            let worst = ledger.bounds().iter().copied().fold(0.0, f64::max);
            self.ledger = Ledger::new(vec![worst; per_row * rows], per_row, ledger.beyond());
        }
    }

    /// Whether another plan keeps the same budget and has `rows` rows of tiles.
    pub(super) fn fits(&self, other: &Plan, rows: usize) -> bool {
        let ledger = &other.ledger;
        let known = ledger.bounds().iter().all(|bound| *bound >= 0.0) && ledger.beyond() >= 0.0;
        let cut = ledger.bounds().is_empty()
            || ledger.per_row().checked_mul(rows) == Some(ledger.bounds().len());
        self.budget == other.budget && known && cut
    }

    /// How pigment is to be moved over one frame.
    pub(super) fn model(&self, asked: Model, pigments: &[Kinetics; 3], dt: Seconds) -> Model {
        let (Some(budget), Model::Tracked { method, .. }) = (self.budget, asked) else {
            return asked;
        };
        let lasts = method.exact_when_held && remembered(pigments, dt) <= STEADY * budget;
        if lasts { Model::Steady } else { asked }
    }

    /// The rule for one frame.
    pub(super) fn rule(&self, pigments: &[Kinetics; 3], dt: Seconds) -> Rule {
        Rule {
            per_half_bleach: pigments
                .each_ref()
                .map(|p| ROUNDED_UP * rate_at_rest(p) / p.half_bleach.0),
            share: pigments.each_ref().map(|p| -(-dt.0 / p.tau.0).exp_m1()),
            allowed: self.budget.map_or(0.0, |budget| UNTOUCHED * budget / growth(pigments)),
        }
    }

    /// Takes note of a look: what it met and how pigment was moved where it was.
    pub(super) fn note(
        &mut self,
        stats: &LookStats,
        by: Model,
        pigments: &[Kinetics; 3],
        dt: Seconds,
    ) {
        let (rule, remembered) = (self.rule(pigments, dt), remembered(pigments, dt));
        let settled = stats.stepped && self.is_free() && matches!(by, Model::Steady);
        let followed = stats.stepped && matches!(by, Model::Tracked { .. });
        let (so_far, unseen) = (self.stats, rule.bleached(self.stats.unseen, stats.greatest));
        self.stats = PlanStats {
            untouched: so_far.untouched.max(stats.untouched),
            stepped: so_far.stepped | stats.stepped,
            settled: so_far.settled | settled,
            followed: so_far.followed | followed,
            forgotten: so_far.forgotten.max(if settled { remembered } else { 0.0 }),
            least: stats.least.into_iter().fold(so_far.least, f64::min),
            unseen,
            everywhere: so_far.everywhere.max(unseen).min(1.0),
            remembered: so_far.remembered.max(remembered),
        };
    }

    /// What was done so far: `none` where every place was left untouched.
    pub fn name(&self, asked: Model) -> &'static str {
        match (self.budget, self.stats) {
            (None, _) => asked.name(),
            (_, PlanStats { stepped: false, .. }) => Model::Unbleached.name(),
            (_, PlanStats { followed: false, .. }) => Model::Steady.name(),
            _ => asked.name(),
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
    use crate::kinetics::Law;
    use crate::step;
    use proptest::prelude::*;

    fn laws() -> impl Strategy<Value = Law> {
        let names = prop::sample::select(&Law::NAMES[..]);
        (names, 0.1..0.6, 0.05..1.0).prop_map(|((_, law), density, km)| law.with(density, km))
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
        let settled = (0..1_000_000).fold(0.0, |bound, _| rule.after(bound, [4.5; 3]));
        assert!(settled > 2.2e-4 && settled < 2.5e-4);
        let passed = (0..4000).fold(0.0, |bound, _| rule.after(bound, [20.0; 3]));
        assert!(passed.is_infinite() && rule.after(passed, [0.0; 3]).is_infinite());
    }

    #[test]
    fn nothing_is_left_out_unless_the_plan_is_free_to() {
        let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
        assert!(Plan::new(None).rule(&pigments, Seconds(1.0)).after(0.0, [0.0; 3]).is_infinite());
    }
}
