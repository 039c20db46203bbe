//! A plan in words and numbers: every reduction there is, what it can cost of p or of a catch at
//! most, what it costs in time, whether it was taken and why.

use serde_json::{Value, json};

use super::{Plan, PlanStats, growth};
use crate::eye::pigment::{LEAST_KEPT, Model};
use crate::kinetics::{Kinetics, Law};
use crate::observer::directional;
use crate::vision::Vision;

/// Largest relative error of a catch from light, weights and percept in single precision.
const SINGLE_BOUND: f64 = 1e-5;

/// The least budget that can be kept for light as a vision receives it, whatever is modelled:
/// levels and single precision take as much.
pub(crate) fn least_budget(vision: &Vision) -> f64 {
    vision.levels_bound() + directional::LEVEL_BOUND + SINGLE_BOUND
}

/// One reduction of the full model.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    pub what: &'static str,
    /// The most that it costs of p, or of a catch relative to what the light's parts catch; not
    /// taken, what it would cost. `None`: unknown.
    pub(crate) bound: Option<f64>,
    pub chosen: bool,
    pub why: String,
}

impl Plan {
    /// The terms for the report. `bound_total`: the sum of those that were chosen; `null`: nothing
    /// is promised, because a model or a method was asked for by name.
    pub(crate) fn report(&self, asked: Model, pigments: &[Kinetics; 3]) -> Value {
        let term = |term: &Term| {
            json!({
                "what": term.what,
                "bound": term.bound,
                "chosen": term.chosen,
                "why": term.why,
            })
        };
        json!({
            "model": self.name(asked),
            "budget": self.budget,
            "terms": self.terms(asked, pigments).iter().map(term).collect::<Vec<_>>(),
            "bound_total": self.bound(asked, pigments),
            "tiles": self.ledger.bounds().len(),
            "tiles_tracked": self.tiles_tracked(),
        })
    }

    /// The largest error that is promised; `None` if nothing is.
    pub fn bound(&self, asked: Model, pigments: &[Kinetics; 3]) -> Option<f64> {
        self.terms(asked, pigments).iter().filter(|term| term.chosen).map(|term| term.bound).sum()
    }

    /// What ignoring all bleaching would cost at most; `None` if that has no bound.
    pub fn bound_of_none(&self, pigments: &[Kinetics; 3]) -> Option<f64> {
        relative(self.stats.everywhere, pigments)
    }

    fn tiles_tracked(&self) -> usize {
        self.ledger.bounds().iter().filter(|bound| bound.is_infinite()).count()
    }

    /// Every reduction, chosen or not.
    pub fn terms(&self, asked: Model, pigments: &[Kinetics; 3]) -> Vec<Term> {
        let mut terms = match (self.budget, asked) {
            (Some(budget), Model::Tracked { .. }) => self.choices(budget, pigments).to_vec(),
            (_, Model::Tracked { .. }) => Vec::new(),
            _ => vec![Term {
                what: "the model that was asked for",
                bound: None,
                chosen: true,
                why: format!("numerics.model = {:?}", asked.name()),
            }],
        };
        if let Model::Tracked { .. } = asked {
            terms.push(self.following(asked, pigments));
        }
        terms.extend(self.seeing(pigments));
        terms
    }

    /// What a free plan may leave out.
    fn choices(&self, budget: f64, pigments: &[Kinetics; 3]) -> [Term; 3] {
        let allowed = percent(super::UNTOUCHED * budget / growth(pigments));
        let PlanStats { untouched, stepped, everywhere, .. } = self.stats;
        [
            Term {
                what: "no bleaching anywhere",
                bound: relative(if stepped { everywhere } else { untouched }, pigments),
                chosen: !stepped,
                why: if stepped {
                    let most = percent(everywhere);
                    format!("up to {most} may have bleached; {allowed} may be left out")
                } else {
                    format!("nowhere can more than {} have bleached", percent(untouched))
                },
            },
            Term {
                what: "no bleaching where little light falls",
                bound: relative(untouched, pigments),
                chosen: stepped && untouched > 0.0,
                why: format!(
                    "a tile is left alone until {allowed} can have bleached: {} of {} still are",
                    self.ledger.bounds().len() - self.tiles_tracked(),
                    self.ledger.bounds().len()
                ),
            },
            self.settling(budget),
        ]
    }

    /// The steady state in place of the way there.
    fn settling(&self, budget: f64) -> Term {
        let PlanStats { settled, forgotten, remembered, .. } = self.stats;
        let (left, most) = (percent(remembered), percent(super::STEADY * budget));
        Term {
            what: "steady state in place of the way there",
            bound: Some(if settled { forgotten } else { remembered }),
            chosen: settled,
            why: if settled {
                format!("where a frame leaves less than {most} of what was before it")
            } else {
                format!("a frame leaves up to {left} of what was before it; {most} would do")
            },
        }
    }

    /// What following pigment in time costs.
    fn following(&self, asked: Model, pigments: &[Kinetics; 3]) -> Term {
        let Model::Tracked { method, substeps, budget } = asked else {
            unreachable!("only tracked pigment is followed")
        };
        let linear = pigments.iter().all(|p| p.law == Law::FirstOrder);
        let (what, bound) = match (method.exact_when_held, substeps) {
            (true, _) if linear => ("the exact step", Some(0.0)),
            (true, 0) => (
                "the exact step, its rates frozen over sub-steps",
                (budget >= LEAST_KEPT).then_some(budget),
            ),
            _ => ("the steps that were asked for", None),
        };
        let chosen = self.stats.followed || !self.is_free();
        Term {
            what,
            bound,
            chosen,
            why: match chosen {
                true => format!("{} of {} tiles", self.tiles_tracked(), self.ledger.bounds().len()),
                false => "no place needs it".into(),
            },
        }
    }

    /// What the shape of the sums of light and percept costs.
    ///
    /// An error e of ln I moves ln p by at most e (1 + ln 1/p): with u = ln p, w = du/d ln I obeys
    /// |w|' <= -u' + (1 - |w|)/(p tau), and -u integrates to ln 1/p.
    fn seeing(&self, pigments: &[Kinetics; 3]) -> [Term; 3] {
        let per_log_light = growth(pigments) * (1.0 - self.stats.least.ln());
        let stepped = self.stats.stepped || !self.is_free();
        let term = |what, bound: Option<f64>, chosen, why: &str| Term {
            what,
            bound: bound.filter(|bound| bound.is_finite()),
            chosen,
            why: if chosen { why.into() } else { "the light is returned as it came".into() },
        };
        let levels = directional::LEVEL_BOUND;
        [
            term(
                "pigment read at a few levels of p",
                Some(self.levels),
                stepped,
                "a few sums instead of every nanometre",
            ),
            term(
                "Stiles-Crawford weight by levels",
                Some(per_log_light * levels),
                stepped,
                "the light is projected once for any pupil",
            ),
            term(
                "single precision of light and percept",
                Some(SINGLE_BOUND),
                stepped || self.projected,
                "the files hold no more",
            ),
        ]
    }
}

/// Three digits of a share.
fn percent(share: f64) -> String {
    let digits = 10f64.powi(2 - (100.0 * share).max(1e-9).log10().floor() as i32);
    format!("{} %", (100.0 * share * digits).round() / digits)
}

/// What is missing of a catch, relative to what is left. Once such a place is tracked that may grow
/// a little.
fn relative(untouched: f64, pigments: &[Kinetics; 3]) -> Option<f64> {
    let left = 1.0 - untouched;
    (left > 0.0).then(|| growth(pigments) * untouched / left)
}
