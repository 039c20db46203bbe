//! The light of one place over one step.
//!
//! A frame holds its light; ramps and sines are for charts and tests, where what happens between
//! frames is known.

use crate::units::Trolands;

/// Light over a step; `fraction` runs from 0 at its start to 1 at its end.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Drive {
    Held(Trolands),
    /// Linear between the two ends.
    Ramp {
        from: Trolands,
        to: Trolands,
    },
    /// mean + amplitude sin(phase + turn * fraction), angles in radians.
    Sine {
        mean: Trolands,
        amplitude: Trolands,
        phase: f64,
        turn: f64,
    },
}

impl Drive {
    /// The light at `fraction` of the step.
    pub(crate) fn at(self, fraction: f64) -> Trolands {
        match self {
            Drive::Held(light) => light,
            Drive::Ramp { from, to } => Trolands(from.0 + (to.0 - from.0) * fraction),
            Drive::Sine { mean, amplitude, phase, turn } => {
                Trolands(mean.0 + amplitude.0 * (phase + turn * fraction).sin())
            }
        }
    }

    /// The mean over the step: the light that, held, gives the same dose.
    pub fn mean(self) -> Trolands {
        match self {
            Drive::Held(light) => light,
            Drive::Ramp { from, to } => Trolands(0.5 * (from.0 + to.0)),
            Drive::Sine { mean, amplitude, phase, turn } => {
                let half = 0.5 * turn;
                let sinc = if half == 0.0 { 1.0 } else { half.sin() / half };
                Trolands(mean.0 + amplitude.0 * (phase + half).sin() * sinc)
            }
        }
    }

    /// How much light would be gained over the step at the speed it has at its start.
    pub(crate) fn initial_rise(self) -> Trolands {
        match self {
            Drive::Held(_) => Trolands(0.0),
            Drive::Ramp { from, to } => Trolands(to.0 - from.0),
            Drive::Sine { amplitude, phase, turn, .. } => {
                Trolands(amplitude.0 * turn * phase.cos())
            }
        }
    }

    /// The part of the step from fraction `from` to fraction `to`, as a step of its own.
    pub(crate) fn part(self, from: f64, to: f64) -> Drive {
        match self {
            Drive::Held(light) => Drive::Held(light),
            Drive::Ramp { .. } => Drive::Ramp { from: self.at(from), to: self.at(to) },
            Drive::Sine { mean, amplitude, phase, turn } => Drive::Sine {
                mean,
                amplitude,
                phase: phase + turn * from,
                turn: turn * (to - from),
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_mean_of_a_whole_is_the_mean_of_its_parts() {
        let sine =
            Drive::Sine { mean: Trolands(5.0), amplitude: Trolands(2.0), phase: 0.3, turn: 1.7 };
        let ramp = Drive::Ramp { from: Trolands(1.0), to: Trolands(9.0) };
        for drive in [sine, ramp, Drive::Held(Trolands(3.0))] {
            let parts =
                0.25 * drive.part(0.0, 0.25).mean().0 + 0.75 * drive.part(0.25, 1.0).mean().0;
            assert!((parts - drive.mean().0).abs() < 1e-14);
        }
    }
}
