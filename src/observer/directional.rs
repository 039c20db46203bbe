//! Stiles-Crawford effect of the first kind: light that enters near the pupil's edge counts less.
//!
//! ```text
//! eta(lambda, r) = 10^(-p(lambda) r^2)                              (Stiles & Crawford 1933; paper Eq. 5)
//! pupil mean:  eta = (1 - 10^(-p R^2)) / (p R^2 ln 10)
//! ```
//!
//! r, R: mm in the plane of the pupil; p: mm^-2. The weight depends on wavelength only through p,
//! so it is a function of p interpolated through a few fixed levels of p ([`Directional::levels`]):
//! the light is projected once, whatever the pupil does later. How many levels is chosen so that no
//! pupil errs by more than [`LEVEL_BOUND`]; a test measures it.

use std::f64::consts::{LN_10, PI};

use serde::{Deserialize, Serialize};

use crate::spectrum::{Curve, STILES_CRAWFORD};
use crate::units::Millimetres;

use super::fundamentals::lens_density;
use super::pupil::{LARGEST, SMALLEST};

/// Largest relative error of eta from its levels, over all wavelengths and pupils.
pub(crate) const LEVEL_BOUND: f64 = 1e-5;

/// Density of lens that a ray at the pupil's margin does not cross, per unit of lens density,
/// mm^-2: derived for a lens of 3.6 mm with radii of 10 and 6 mm.
const LENS_CORRECTION: f64 = 0.037;

/// Where the effect is taken to act.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reading {
    /// An extended source fills the pupil: its mean over the pupil.
    Pupil,
    /// The paper's: r is the picture's distance from the gaze point, at this scale, up to the
    /// pupil's edge.
    Paper { mm_per_degree: f64 },
    /// No effect.
    Off,
}

/// Where p(lambda) comes from.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(
    rename_all = "kebab-case",
    expecting = "\"measured\", \"lens-corrected\" or a number in mm^-2"
)]
pub enum Steepness {
    /// Berendschot et al. 2001.
    Measured,
    /// The measured curve plus what a marginal ray is spared by the lens (after Mellerio 1971), that
    /// of the tabulated observer at every age.
    /// Counts the lens twice with fundamentals that are measured at the cornea.
    LensCorrected,
    /// The same at every wavelength, mm^-2.
    #[serde(untagged)]
    Constant(f64),
}

/// The weight of one observer.
#[derive(Clone, Debug, PartialEq)]
pub struct Directional {
    reading: Reading,
    steepness: Curve,
    levels: Vec<f64>,
    shares: Vec<Curve>,
}

impl Directional {
    /// Builds the levels for a reading and a steepness.
    pub fn new(reading: Reading, steepness: Steepness) -> Self {
        let p = steepness.curve();
        if reading == Reading::Off {
            return Directional {
                reading,
                steepness: p,
                levels: vec![0.0],
                shares: vec![Curve::sampled(|_| 1.0)],
            };
        }
        let (low, high) = p.0.iter().fold((f64::MAX, f64::MIN), |(a, b), &v| (a.min(v), b.max(v)));
        let count = (1..=MOST_LEVELS)
            .find(|&n| worst_error(reading, low, high, n) < LEVEL_BOUND)
            .unwrap_or(MOST_LEVELS);
        let levels = nodes(low, high, count);
        let shares = (0..count)
            .map(|j| Curve(p.0.iter().map(|&v| lagrange(&levels, v)[j]).collect()))
            .collect();
        Directional { reading, steepness: p, levels, shares }
    }

    /// The fixed levels of p, mm^-2.
    pub(crate) fn levels(&self) -> &[f64] {
        &self.levels
    }

    /// How much each level counts at each wavelength; they sum to 1.
    pub(crate) fn shares(&self) -> &[Curve] {
        &self.shares
    }

    /// Millimetres on the pupil's plane per degree of distance from the gaze; `None` where place
    /// does not matter.
    pub fn mm_per_degree(&self) -> Option<f64> {
        match self.reading {
            Reading::Paper { mm_per_degree } => Some(mm_per_degree),
            Reading::Pupil | Reading::Off => None,
        }
    }

    /// eta of each level for a pupil, at `r` from its centre (which only the paper's reading uses).
    /// Zeros follow where there are fewer than [`MOST_LEVELS`].
    pub(crate) fn weights(&self, pupil: Millimetres, r: Millimetres) -> [f64; MOST_LEVELS] {
        std::array::from_fn(|j| {
            self.levels.get(j).map_or(0.0, |&p| eta(self.reading, p, pupil.0, r.0))
        })
    }

    /// eta at every wavelength, from p(lambda) itself (paper Eq. 5, or its mean over the pupil).
    pub(crate) fn exact(&self, pupil: Millimetres, r: Millimetres) -> Curve {
        Curve(self.steepness.0.iter().map(|&p| eta(self.reading, p, pupil.0, r.0)).collect())
    }
}

impl Steepness {
    /// p(lambda), mm^-2.
    pub(crate) fn curve(self) -> Curve {
        let measured = || Curve::sampled(|nm| STILES_CRAWFORD.interpolated("p", nm));
        match self {
            Steepness::Measured => measured(),
            Steepness::LensCorrected => Curve(
                measured()
                    .0
                    .iter()
                    .zip(&lens_density().0)
                    .map(|(p, lens)| p + LENS_CORRECTION * lens)
                    .collect(),
            ),
            Steepness::Constant(p) => Curve::sampled(|_| p),
        }
    }
}

/// eta for one p: exact, without levels.
pub(crate) fn eta(reading: Reading, p: f64, pupil_mm: f64, r_mm: f64) -> f64 {
    match reading {
        Reading::Off => 1.0,
        Reading::Paper { .. } => {
            let r = r_mm.min(pupil_mm / 2.0);
            10f64.powf(-p * r * r)
        }
        Reading::Pupil => {
            let x = p * (pupil_mm / 2.0).powi(2) * LN_10;
            if x == 0.0 { 1.0 } else { -(-x).exp_m1() / x }
        }
    }
}

/// No steepness asks for more levels.
pub(crate) const MOST_LEVELS: usize = 10;

/// Chebyshev nodes of an interval; its middle if it is a point.
fn nodes(low: f64, high: f64, count: usize) -> Vec<f64> {
    let node = |j: usize| (PI * (2 * j + 1) as f64 / (2 * count) as f64).cos();
    (0..count).map(|j| (low + high) / 2.0 - (high - low) / 2.0 * node(j)).collect()
}

/// Lagrange weights of the nodes at a point.
fn lagrange(nodes: &[f64], at: f64) -> Vec<f64> {
    let weight = |j: usize| {
        nodes
            .iter()
            .enumerate()
            .filter(|&(i, _)| i != j)
            .map(|(_, n)| (at - n) / (nodes[j] - n))
            .product::<f64>()
    };
    (0..nodes.len()).map(weight).collect()
}

fn worst_error(reading: Reading, low: f64, high: f64, count: usize) -> f64 {
    let levels = nodes(low, high, count);
    let steps = |n: usize| (0..=n).map(move |i| i as f64 / n as f64);
    let mut worst: f64 = 0.0;
    for p in steps(64).map(|t| low + (high - low) * t) {
        let shares = lagrange(&levels, p);
        for pupil in steps(12).map(|t| SMALLEST.0 + (LARGEST.0 - SMALLEST.0) * t) {
            let at = |p: f64| eta(reading, p, pupil, pupil / 2.0);
            let sum: f64 = shares.iter().zip(&levels).map(|(s, &level)| s * at(level)).sum();
            worst = worst.max((sum / at(p) - 1.0).abs());
        }
    }
    worst
}

#[cfg(test)]
mod tests {
    use super::*;

    impl Directional {
        /// eta at every wavelength, through the levels.
        fn curve(&self, pupil: Millimetres, r: Millimetres) -> Curve {
            let mut sum = Curve::sampled(|_| 0.0);
            for (share, weight) in self.shares.iter().zip(self.weights(pupil, r)) {
                for (total, s) in sum.0.iter_mut().zip(&share.0) {
                    *total += s * weight;
                }
            }
            sum
        }
    }

    #[test]
    fn levels_reproduce_the_weight_of_every_wavelength_and_pupil_within_the_bound() {
        for reading in [Reading::Pupil, Reading::Paper { mm_per_degree: 0.29 }] {
            for steepness in
                [Steepness::Measured, Steepness::LensCorrected, Steepness::Constant(0.06)]
            {
                let weight = Directional::new(reading, steepness);
                let p = steepness.curve();
                for d in [2.0, 3.3, 5.0, 8.0] {
                    let curve = weight.curve(Millimetres(d), Millimetres(d / 2.0));
                    for (ours, &p) in curve.0.iter().zip(&p.0) {
                        let exact = eta(reading, p, d, d / 2.0);
                        assert!(
                            (ours / exact - 1.0).abs() < LEVEL_BOUND,
                            "{reading:?} {steepness:?} {d} {ours} {exact}"
                        );
                    }
                }
            }
        }
    }

    #[test]
    fn a_constant_steepness_needs_one_level_and_the_effect_can_be_off() {
        assert_eq!(Directional::new(Reading::Pupil, Steepness::Constant(0.06)).levels(), [0.06]);
        let off = Directional::new(Reading::Off, Steepness::Measured);
        assert!(off.curve(Millimetres(8.0), Millimetres(4.0)).0.iter().all(|&v| v == 1.0));
    }

    #[test]
    fn the_papers_weight_stops_falling_at_the_pupils_edge() {
        let at = |r| eta(Reading::Paper { mm_per_degree: 0.29 }, 0.05, 4.0, r);
        assert_eq!(at(2.0), at(50.0));
        assert!(at(1.0) > at(2.0) && at(0.0) == 1.0);
    }
}
