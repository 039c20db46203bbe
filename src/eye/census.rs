//! What a look met: the extremes that the trace, the warnings and the plan ask for.

use crate::eye::plan::LeftOut;

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
    /// What the plan left out.
    pub left_out: LeftOut,
}

impl Census {
    pub(super) const EMPTY: Census = Census {
        greatest: [0.0; 3],
        least: [1.0; 3],
        s_past_half: 0,
        limited: 0,
        left_out: LeftOut {
            untouched: 0.0,
            outlasted: 0.0,
            stepped: false,
            settled: false,
            followed: false,
        },
    };

    /// What the light of a run of places was, td.
    pub(super) fn of_light(greatest: [f32; 3]) -> Self {
        Census { greatest: greatest.map(f64::from), ..Census::EMPTY }
    }

    pub(super) fn and(self, other: Census) -> Census {
        Census {
            greatest: [0, 1, 2].map(|k| self.greatest[k].max(other.greatest[k])),
            least: [0, 1, 2].map(|k| self.least[k].min(other.least[k])),
            s_past_half: self.s_past_half + other.s_past_half,
            limited: self.limited + other.limited,
            left_out: self.left_out.and(other.left_out),
        }
    }
}
