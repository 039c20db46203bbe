//! What a look met: the extremes that the trace, the warnings and the plan ask for.

/// What was met at the places of the retina that the look covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Census {
    /// Greatest cone illuminance, td.
    pub greatest: [f64; 3],
    /// Least unbleached fraction.
    pub least: [f64; 3],
    /// Places that have lost more than half of their S pigment.
    pub s_past_half: u64,
    /// Percept samples that a half float could not hold.
    pub limited: u64,
    /// The most that may have bleached unseen in a place that was left untouched.
    pub untouched: f64,
    /// Whether any place was stepped.
    pub stepped: bool,
}

impl Census {
    pub(super) const EMPTY: Census =
        Census { greatest: [0.0; 3], least: [1.0; 3], s_past_half: 0, limited: 0, untouched: 0.0, stepped: false };

    /// What the light of a run of places was, td.
    pub(super) fn of_light(greatest: [f32; 3]) -> Self {
        Census { greatest: greatest.map(f64::from), ..Census::EMPTY }
    }

    /// What a run of places that was stepped has left: the least of each pigment, and all of S.
    pub(super) fn of_pigment(least: [f64; 3], s: &[f64]) -> Self {
        let past_half = |&&p: &&f64| p < 0.5;
        let s_past_half = if least[2] < 0.5 { s.iter().filter(past_half).count() as u64 } else { 0 };
        Census { least, s_past_half, stepped: true, ..Census::EMPTY }
    }

    /// What a run that was left untouched may have lost unseen.
    pub(super) fn of_untouched(untouched: f64) -> Self {
        Census { untouched, ..Census::EMPTY }
    }

    pub(super) fn and(self, other: Census) -> Census {
        Census {
            greatest: [0, 1, 2].map(|k| self.greatest[k].max(other.greatest[k])),
            least: [0, 1, 2].map(|k| self.least[k].min(other.least[k])),
            s_past_half: self.s_past_half + other.s_past_half,
            limited: self.limited + other.limited,
            untouched: self.untouched.max(other.untouched),
            stepped: self.stepped | other.stepped,
        }
    }
}
