//! Which level of the pyramid a Gaussian is on, and its taps there.
//!
//! A level is half as fine as the one before it: reduced by a binomial filter, and expanded by its
//! transpose. The two filters of a level l have the variance (1 - 4^-l) and the fourth cumulant
//! -(1 - 16^-l)/10, in pixels of the level. So the taps of a Gaussian have the rest of its variance
//! and the opposite cumulant (the Gram-Charlier series):
//!
//! ```text
//! tap(x) = g(x) (1 + k/(24 v^2) He4(x/sqrt v)),   He4(z) = z^4 - 6 z^2 + 3
//! ```

use super::gaussians::{Gaussians, sampled};

/// Taps of the binomial filter, from the middle on.
pub(super) const BINOMIAL: [f64; 4] = [20.0 / 64.0, 15.0 / 64.0, 6.0 / 64.0, 1.0 / 64.0];

/// Radius of the binomial filter.
pub(super) const HALF: i64 = 3;

/// Variance of the binomial filter, pixels^2.
pub(super) const VARIANCE: f64 = 1.5;

/// Fourth cumulant of the binomial filter, pixels^4, without its sign.
const CUMULANT: f64 = 0.75;

/// How finely the pyramid works.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Depth {
    /// Least standard deviation of a Gaussian on its level, in the level's pixels, but for level 0.
    pub(crate) low: f64,
    /// Radius of a Gaussian's taps, in standard deviations.
    pub(crate) reach: f64,
}

/// Depths from the coarsest to the finest. A step of sqrt 2 moves every second Gaussian one level
/// down: there is none between.
pub(crate) const DEPTHS: [Depth; 4] = [
    Depth { low: 1.1, reach: 3.5 },
    Depth { low: 1.556, reach: 4.0 },
    Depth { low: 2.2, reach: 4.5 },
    Depth { low: 3.1, reach: 5.0 },
];

/// The greatest radius of taps at any depth.
pub(super) const LONGEST: usize = 32;

impl Depth {
    /// The level of a Gaussian of `sigma` pixels.
    pub(super) fn level(&self, sigma: f64) -> usize {
        (sigma / self.low).log2().floor().max(0.0) as usize
    }

    /// A sum of Gaussians, each on its level.
    pub(super) fn place(&self, sum: &Gaussians) -> Vec<Placed> {
        let place = |sigma: f64, weight: f64| {
            Placed::new(sigma, self.level(sigma), self.reach).times(weight)
        };
        sum.nodes.iter().map(|node| place(node.sigma, node.weight)).collect()
    }
}

/// A Gaussian on its level: taps of one dimension, from the middle on.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Placed {
    pub(crate) level: usize,
    pub(crate) taps: Vec<f64>,
    /// The share of the light that it spreads.
    pub(crate) weight: f64,
}

impl Placed {
    /// A Gaussian of `sigma` pixels whose taps reach so many standard deviations and sum to 1.
    pub(super) fn new(sigma: f64, level: usize, reach: f64) -> Placed {
        let left = |base: f64| 1.0 - base.powi(-(level as i32));
        let scale = 2f64.powi(level as i32);
        let variance = (sigma / scale).powi(2) - 2.0 * VARIANCE / 3.0 * left(4.0);
        let cumulant = 2.0 * CUMULANT / 15.0 * left(16.0) / (24.0 * variance * variance);
        let tap = |i: usize| {
            let (x, z2) = (i as f64, (i * i) as f64 / variance);
            sampled(variance.sqrt(), x) * (1.0 + cumulant * (z2 * z2 - 6.0 * z2 + 3.0))
        };
        let radius = (reach * variance.sqrt()).ceil() as usize;
        let taps: Vec<f64> = (0..=radius.clamp(1, LONGEST)).map(tap).collect();
        let sum = 2.0 * taps.iter().sum::<f64>() - taps[0];
        Placed { level, taps: taps.into_iter().map(|tap| tap / sum).collect(), weight: 1.0 }
    }

    fn times(self, weight: f64) -> Placed {
        Placed { weight, ..self }
    }
}
