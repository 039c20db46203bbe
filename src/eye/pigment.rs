//! The pigment stage: unbleached fractions moved by cone illuminance over one look.

use crate::eye::plan::rule::Rule;
use crate::eye::stats::LookStats;
use crate::kernel::{self, FirstOrderForm};
use crate::kinetics::{Kinetics, Law};
use crate::step::{self, Enclosed, Method};
use crate::units::{Seconds, Trolands};

/// How pigment follows light.
#[derive(Clone, Copy)]
pub enum Model {
    /// It does not: the eye stays as it started.
    Unbleached,
    /// At once (paper Eq. 1, frame by frame).
    Steady,
    /// By a method of the table. `substeps` 0: as many as keep the relative error of the
    /// whole run within `budget`.
    Tracked { method: &'static Method, substeps: u32, budget: f64 },
}

impl Model {
    /// What to say if a step takes the method past its limit under the greatest cone illuminances,
    /// td.
    pub(crate) fn past_limit(
        &self,
        pigments: &[Kinetics; 3],
        greatest: [f64; 3],
        dt: Seconds,
    ) -> Option<String> {
        let Model::Tracked { method, substeps, .. } = self else { return None };
        let past = pigments
            .iter()
            .zip(greatest)
            .filter_map(|(pigment, td)| method.past_limit(pigment, Trolands(td), dt, *substeps));
        let worst = past.max_by(|a, b| a.h_lambda.total_cmp(&b.h_lambda))?;
        Some(format!("{worst} of method {:?}: its pigment is not to be trusted", method.name))
    }

    /// The name in `trace.csv` and `report.json`.
    pub(crate) fn name(&self) -> &'static str {
        match self {
            Model::Unbleached => "none",
            Model::Steady => "steady",
            Model::Tracked { .. } => "tracked",
        }
    }
}

/// One step of the pigments, the same at every place but for the light.
#[derive(Clone, Copy)]
pub(crate) struct PigmentStep {
    pigments: [Kinetics; 3],
    model: Model,
    duration: Seconds,
    forms: [FirstOrderForm; 3],
}

impl PigmentStep {
    /// A step of some length by a model.
    pub(crate) fn new(pigments: [Kinetics; 3], model: Model, duration: Seconds) -> Self {
        let forms = pigments.each_ref().map(|pigment| FirstOrderForm::new(pigment, duration));
        PigmentStep { pigments, model, duration, forms }
    }

    /// Whether it leaves pigment as it is.
    pub(crate) fn is_idle(&self) -> bool {
        matches!(self.model, Model::Unbleached)
    }

    /// The same step of an eye that does not bleach.
    pub(crate) fn idle(self) -> Self {
        PigmentStep { model: Model::Unbleached, ..self }
    }

    /// Moves a row's L, M, S pigment by one light, td, in double precision.
    pub(crate) fn held(&self, td: [f64; 3], p: [&mut [f64]; 3]) -> LookStats {
        let mut stats = LookStats { greatest: td, stepped: true, ..LookStats::EMPTY };
        for (k, row) in p.into_iter().enumerate() {
            let (mut from, mut to) = (f64::NAN, f64::NAN);
            for p in row.iter_mut() {
                if *p != from {
                    (from, to) = (*p, self.place(&self.pigments[k], *p, td[k]));
                }
                *p = to;
            }
            stats.least[k] = kernel::least(row);
            stats.s_past_half = row.iter().filter(|&&p| k == 2 && p < 0.5).count() as u64;
        }
        stats
    }

    /// Moves a tile's L, M, S pigment by its light, td, as far as the rule asks for. `bound`: what
    /// the tile may have lost unseen; `greatest`: of its light.
    pub(crate) fn tile(
        &self,
        rule: &Rule,
        bound: &mut f64,
        td: [&[f32]; 3],
        greatest: [f32; 3],
        p: [&mut [f64]; 3],
    ) -> LookStats {
        let stats = LookStats::of_light(greatest);
        *bound = rule.after(*bound, greatest);
        if bound.is_finite() {
            return LookStats { untouched: *bound, ..stats };
        }
        let mut least = [1.0; 3];
        for k in 0..3 {
            least[k] = self.cone(k, td[k], p[k]);
        }
        let below_half = || p[2].iter().filter(|&&p| p < 0.5).count() as u64;
        let s_past_half = if least[2] < 0.5 { below_half() } else { 0 };
        LookStats { least, s_past_half, stepped: true, ..stats }
    }

    /// Moves a run of one cone class's pigment by a run of its light, td. Returns the least of it.
    pub(crate) fn cone(&self, cone: usize, light: &[f32], p: &mut [f64]) -> f64 {
        let (pigment, form) = (&self.pigments[cone], self.forms[cone]);
        match (pigment.law, self.model) {
            (_, Model::Unbleached) => {}
            (Law::FirstOrder, Model::Steady) => kernel::steady(form, light, p),
            (Law::FirstOrder, Model::Tracked { method, .. }) if method.exact_when_held => {
                return kernel::relax(form, light, p);
            }
            _ => p
                .iter_mut()
                .zip(light)
                .for_each(|(p, &td)| *p = self.place(pigment, *p, f64::from(td))),
        }
        kernel::least(p)
    }

    /// Moves one pigment at one place: the scalar path of every law and method.
    fn place(&self, pigment: &Kinetics, p: f64, td: f64) -> f64 {
        let light = Trolands(td);
        match self.model {
            Model::Unbleached => p,
            Model::Steady => pigment.steady(light),
            Model::Tracked { method, substeps: 0, budget } if method.exact_when_held => {
                self.exact(budget, pigment, p, light)
            }
            Model::Tracked { method, substeps, .. } => {
                method.hold(pigment, p, light, self.duration, substeps.max(1))
            }
        }
    }

    /// The exact step of any law, within `budget` where as many sub-steps as are tried can keep it.
    pub(crate) fn exact(&self, budget: f64, pigment: &Kinetics, p: f64, light: Trolands) -> f64 {
        let most = || step::enclosed(pigment, p, light, self.duration, step::MOST_SUBSTEPS);
        self.within(budget, pigment, p, light).unwrap_or_else(most).p
    }

    /// The exact step of any law, its sub-steps as many as keep the relative error of p, over the
    /// whole run, within `budget`; `None` if that are more than are tried.
    ///
    /// With u = ln 1/p1 and k the least share of the distance that the step forgets, a step may err
    /// by `budget`/2 (1 - k) p1/(1 + u)^2. Then the relative error stays below
    /// `budget`/2 (2 - 1/(1 + u)), whatever the steps and the light.
    ///
    /// Proof: split a step's error into the part proportional to bleaching, whose sum is bounded
    /// by the integral of du/(1 + u)^2 <= 1, and the part damped by regeneration, k < 1.
    /// Self-screened pigment bleaches faster than its error by a `growth` that the budget is
    /// divided by.
    fn within(&self, budget: f64, pigment: &Kinetics, p: f64, light: Trolands) -> Option<Enclosed> {
        let forgets = -(-self.duration.0 * pigment.contraction(light)[0]).exp_m1();
        let share = 0.5 * budget / pigment.growth() * forgets;
        let doubled = (0..)
            .map(|doublings| 1 << doublings)
            .take_while(|&substeps| substeps <= step::MOST_SUBSTEPS);
        let mut found =
            doubled.map(|substeps| step::enclosed(pigment, p, light, self.duration, substeps));
        found.find(|found| found.error <= share * found.p / (1.0 - found.p.ln()).powi(2))
    }
}

/// The least budget of a law without a closed form that `MOST_SUBSTEPS` sub-steps are known to
/// keep, whatever the light and the step.
pub(crate) const LEAST_KEPT: f64 = 2.5e-5;

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_light_and_no_step_asks_for_more_substeps_than_are_tried() {
        let laws = Law::NAMES[1..].iter();
        let laws = laws.flat_map(|(_, law)| [law.with(0.3, 0.05), law.with(0.5, 0.2)]);
        let grid = |from: i32, to: i32| (from..=to).map(|log| 10f64.powf(f64::from(log) / 4.0));
        for law in laws {
            let pigment = Kinetics { law, half_bleach: Trolands(2e4), tau: Seconds(120.0) };
            for (td, dt) in grid(-4, 44).flat_map(|td| grid(-12, 16).map(move |dt| (td, dt))) {
                let step = PigmentStep::new([pigment; 3], Model::Steady, Seconds(dt));
                for p in [1.0, 0.9, 0.3, 1e-2, 1e-4, 1e-8] {
                    let found = step.within(LEAST_KEPT, &pigment, p, Trolands(td));
                    assert!(found.is_some(), "{law:?}: {td} td for {dt} s from {p}");
                }
            }
        }
    }
}
