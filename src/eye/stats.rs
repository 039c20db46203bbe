//! Extremes that a look met: what the trace, the warnings and the plan ask for.

/// What was met at the places of the retina that one look covered.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LookStats {
    /// Greatest cone illuminance, td.
    pub(crate) greatest: [f64; 3],
    /// Least unbleached fraction.
    pub least: [f64; 3],
    /// Places that have lost more than half of their S pigment.
    pub(crate) s_past_half: u64,
    /// Percept samples that a half float could not hold.
    pub(crate) limited: u64,
    /// The most that may have bleached unseen in a tile that was left untouched.
    pub(crate) untouched: f64,
    /// Whether the pigment of any place was moved.
    pub(crate) stepped: bool,
}

impl LookStats {
    /// Nothing met.
    pub(super) const EMPTY: LookStats = LookStats {
        greatest: [0.0; 3],
        least: [1.0; 3],
        s_past_half: 0,
        limited: 0,
        untouched: 0.0,
        stepped: false,
    };

    /// Statistics of a run of light, td.
    pub(super) fn of_light(greatest: [f32; 3]) -> Self {
        LookStats { greatest: greatest.map(f64::from), ..LookStats::EMPTY }
    }

    /// Statistics of a run of percept samples.
    pub(super) fn of_percept(limited: u64) -> Self {
        LookStats { limited, ..LookStats::EMPTY }
    }

    /// The statistics of both.
    pub(super) fn and(self, other: LookStats) -> LookStats {
        LookStats {
            greatest: [0, 1, 2].map(|k| self.greatest[k].max(other.greatest[k])),
            least: [0, 1, 2].map(|k| self.least[k].min(other.least[k])),
            s_past_half: self.s_past_half + other.s_past_half,
            limited: self.limited + other.limited,
            untouched: self.untouched.max(other.untouched),
            stepped: self.stepped | other.stepped,
        }
    }
}
