//! The levels of p through which a narrowed pigment is read, and what that costs.
//!
//! With x = D ln 10 a(lambda), a wavelength's catch per pigment is H(x, p) = (1 - e^(-x p))/p. It
//! is read as a sum over levels p_j, with weights w_j(p) that are the same for every wavelength:
//!
//! ```text
//! four levels    0, 1/4, 3/4, 1    w_j: Lagrange's cubics (numerics 5.3)
//! three levels   0, 1/2, 1         w_j: exact at x = 0, 0.5 X and 0.91 X, the densest pigment's X
//! ```
//!
//! Lagrange's weights are right for any function of p. Three levels cost a quarter less and are
//! nearer all the same, because these functions are known: 1.3e-4 instead of 1.9e-4 at a density of
//! 0.5. Where a level is one more sum over thirty bands it counts; light of three planes takes the
//! four.

use std::f64::consts::LN_10;

use crate::observer::{Narrowing, Observer};
use crate::spectrum::Curve;

/// Largest relative error of a catch from the levels, any light, any p, density up to 0.5 (numerics
/// 5.3).
pub const LEVEL_BOUND: f64 = 1.9e-4;

/// The same for any peak density. With x = D ln 10, the fourth derivative of H by p is at most
/// x^5/5 and H at least 1 - e^-x; max |p (p - 1/4) (p - 3/4) (p - 1)| = 1/64, at p = 1/2. Three
/// levels stay below that of four.
pub fn level_bound(density: f64) -> f64 {
    let x = density * LN_10;
    if density <= 0.5 { LEVEL_BOUND } else { x.powi(5) / (5.0 * 24.0 * 64.0 * -(-x).exp_m1()) }
}

/// At which levels of p light is projected, and how they are mixed at any other. The last one is p
/// = 1.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Levels {
    /// 0, 1/4, 3/4, 1 by Lagrange's cubics: for light of a few planes.
    Four,
    /// 0, 1/2, 1: w_0 = (1 - p) `outer`(p), w_1 = (1 - p) `middle`(p), w_2 = 1 - w_0 - w_1; cubics,
    /// lowest power first. For light of many bands.
    Three { outer: [f64; 4], middle: [f64; 4] },
}

impl Levels {
    /// Three levels for pigments whose peak density is at most this.
    pub fn three(density: f64) -> Self {
        let densest = density.max(THINNEST) * LN_10;
        let nodes = [0, 1, 2, 3]
            .map(|i| 0.5 - 0.5 * (f64::from(2 * i + 1) * std::f64::consts::PI / 8.0).cos());
        let exact =
            nodes.map(|p| exact_weights([0.5 * densest, 0.91 * densest], p).map(|w| w / (1.0 - p)));
        Levels::Three {
            outer: cubic_through(nodes, exact.map(|w| w[0])),
            middle: cubic_through(nodes, exact.map(|w| w[1])),
        }
    }

    /// The levels.
    pub fn at(&self) -> &'static [f64] {
        match self {
            Levels::Four => &[0.0, 0.25, 0.75, 1.0],
            Levels::Three { .. } => &[0.0, 0.5, 1.0],
        }
    }

    /// How many.
    #[allow(clippy::len_without_is_empty)]
    pub fn len(&self) -> usize {
        self.at().len()
    }

    /// The weights of the levels at p; they sum to 1. Zeros follow where there are fewer than four.
    pub fn weights(&self, p: f64) -> [f64; 4] {
        match self {
            Levels::Four => {
                let [a, b, c, d] = [p, p - 0.25, p - 0.75, p - 1.0];
                [
                    b * c * d / (-0.25 * 0.75),
                    a * c * d / (0.25 * 0.5 * 0.75),
                    a * b * d / (-0.75 * 0.5 * 0.25),
                    a * b * c / (0.75 * 0.25),
                ]
            }
            Levels::Three { outer, middle } => {
                let [w0, w1] = [outer, middle].map(|c| (1.0 - p) * polynomial(c, p));
                [w0, w1, 1.0 - w0 - w1, 0.0]
            }
        }
    }

    /// The value at p of what has these values at the levels.
    pub(crate) fn mix(&self, p: f64, values: &[f64]) -> f64 {
        self.weights(p).iter().zip(values).map(|(w, v)| w * v).sum()
    }

    /// The same as a polynomial in p, lowest power first.
    pub(crate) fn polynomial(&self, values: &[f64]) -> [f64; 5] {
        match self {
            Levels::Four => {
                // A third difference over the levels themselves would lose digits; these are exact
                // in binary.
                let [f0, f1, f2, fm] = [0.0, 1.0, 2.0, -1.0].map(|p| self.mix(p, values));
                let (even, odd) = ((f1 + fm) / 2.0 - f0, (f1 - fm) / 2.0);
                let third = ((f2 - f0 - 4.0 * even) / 2.0 - odd) / 3.0;
                [f0, odd - third, even, third, 0.0]
            }
            Levels::Three { outer, middle } => {
                let mut powers = [values[2], 0.0, 0.0, 0.0, 0.0];
                for i in 0..4 {
                    let c =
                        outer[i] * (values[0] - values[2]) + middle[i] * (values[1] - values[2]);
                    powers[i] += c;
                    powers[i + 1] -= c;
                }
                powers
            }
        }
    }
}

/// Thinner pigments are read as one of this density: their own equations would not be told apart.
const THINNEST: f64 = 0.05;

/// The weights of the levels 0 and 1/2 at p with which 0, 1/2 and 1 give what is thinnest and
/// pigments of these two x exactly: two equations, as all three weights sum to 1.
fn exact_weights(x: [f64; 2], p: f64) -> [f64; 2] {
    let phi = |z: f64| if z == 0.0 { 1.0 } else { -(-z).exp_m1() / z };
    let beside_whole = |x: f64, p: f64| phi(x * p) - phi(x);
    let [[a, b], [c, d]] = x.map(|x| [beside_whole(x, 0.0), beside_whole(x, 0.5)]);
    let [e, f] = x.map(|x| beside_whole(x, p));
    let determinant = a * d - b * c;
    [(e * d - b * f) / determinant, (a * f - e * c) / determinant]
}

/// The cubic through four points, lowest power first (Newton's divided differences).
fn cubic_through(x: [f64; 4], mut y: [f64; 4]) -> [f64; 4] {
    for order in 1..4 {
        for i in (order..4).rev() {
            y[i] = (y[i] - y[i - 1]) / (x[i] - x[i - order]);
        }
    }
    let mut powers = [y[3], 0.0, 0.0, 0.0];
    for i in (0..3).rev() {
        for power in (0..4).rev() {
            let below = if power == 0 { y[i] } else { powers[power - 1] };
            powers[power] = below - x[i] * powers[power];
        }
    }
    powers
}

fn polynomial(powers: &[f64; 4], p: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, c| sum * p + c)
}

/// Rows of the basis: H_k at the levels for each cone, then s_k times each Stiles-Crawford share.
pub(super) fn weighting_curves(observer: &Observer, levels: &Levels) -> Vec<Curve> {
    let eye = &observer.fundamentals;
    let catches = (0..3).flat_map(|k| levels.at().iter().map(move |&p| eye.per_pigment(k, p)));
    let shares = observer.directional.shares();
    let trolands =
        (0..3).flat_map(|k| shares.iter().map(move |share| eye.unbleached(k).times(share)));
    catches.chain(trolands).collect()
}

/// H at the levels, relative to the peak at p = 1, for every wavelength that is the peak at some p.
/// (The S cone has two maxima, at 443 and 447 nm, whose order changes at p = 0.4: one smooth
/// function would miss that by 7e-4.)
pub(super) fn peaks(observer: &Observer, levels: &Levels) -> Option<[Vec<Vec<f64>>; 3]> {
    let of_cone = |k: usize| {
        let curves: Vec<Curve> =
            levels.at().iter().map(|&p| observer.fundamentals.per_pigment(k, p)).collect();
        let unbleached = observer.fundamentals.unbleached(k).peak();
        let peak = |i: usize| {
            observer.fundamentals.per_pigment(k, i as f64 / 64.0).peak_and_width().0 as usize
        };
        let mut wavelengths: Vec<usize> = (0..=64).map(peak).collect();
        wavelengths.dedup();
        wavelengths
            .into_iter()
            .map(|nm| curves.iter().map(|curve| curve.at(nm) / unbleached).collect())
            .collect()
    };
    (observer.narrowing == Narrowing::Narrowed).then(|| [0, 1, 2].map(of_cone))
}

#[cfg(test)]
mod tests {
    use super::*;

    const DENSITIES: [f64; 6] = [0.01, 0.3, 0.38, 0.5, 0.7, 1.0];

    fn h(x: f64, p: f64) -> f64 {
        if x * p == 0.0 { x } else { -(-x * p).exp_m1() / p }
    }

    /// The largest relative error over all wavelengths and p.
    fn worst(levels: &Levels, density: f64) -> f64 {
        let absorptances = (1..=200).map(|a| f64::from(a) / 200.0);
        let of_one = |a: f64| {
            let x = density * LN_10 * a;
            let values: Vec<f64> = levels.at().iter().map(|&p| h(x, p)).collect();
            let errors = (0..=200)
                .map(|p| f64::from(p) / 200.0)
                .map(|p| (levels.mix(p, &values) / h(x, p) - 1.0).abs());
            errors.fold(0.0, f64::max)
        };
        absorptances.map(of_one).fold(0.0, f64::max)
    }

    #[test]
    fn the_bound_of_any_density_covers_what_either_set_of_levels_costs() {
        for density in DENSITIES {
            for levels in [Levels::Four, Levels::three(density)] {
                let worst = worst(&levels, density);
                assert!(
                    worst <= level_bound(density),
                    "{levels:?} {density}: {worst:e} {:e}",
                    level_bound(density)
                );
            }
        }
    }

    #[test]
    fn three_levels_are_nearer_than_four_where_pigment_is_dense() {
        // numerics 5.3: no three spectra do better than 1.6e-4 in the mean square at density 0.5;
        // four Lobatto levels 1.9e-4.
        for (density, expected) in [(0.38, 5.7e-5), (0.5, 1.3e-4)] {
            let three = worst(&Levels::three(density), density);
            assert!(
                three < worst(&Levels::Four, density) && (three / expected - 1.0).abs() < 0.02,
                "{three:e}"
            );
        }
        // A thinner pigment read with the weights of a denser one is no worse.
        assert!(worst(&Levels::three(0.5), 0.3) < worst(&Levels::three(0.5), 0.5));
    }

    #[test]
    fn level_weights_sum_to_one_and_pick_their_level() {
        for levels in [Levels::Four, Levels::three(0.4)] {
            for p in [0.0, 0.1, 0.5, 0.9, 1.0] {
                assert!((levels.weights(p).iter().sum::<f64>() - 1.0).abs() < 1e-14);
            }
        }
        for (j, &level) in Levels::Four.at().iter().enumerate() {
            let weights = Levels::Four.weights(level);
            assert!(
                (0..4).all(|i| weights[i] == if i == j { 1.0 } else { 0.0 }),
                "{level}: {weights:?}"
            );
        }
        assert_eq!(Levels::three(0.4).weights(1.0), [0.0, 0.0, 1.0, 0.0]);
    }

    #[test]
    fn the_polynomial_is_the_mix() {
        let values = [0.9, 0.7, 0.65, 0.6];
        for levels in [Levels::Four, Levels::three(0.4)] {
            let powers = levels.polynomial(&values);
            for p in [0.0, 0.2, 0.5, 0.99, 1.0] {
                let value = powers.iter().rev().fold(0.0, |sum, c| sum * p + c);
                assert!((value - levels.mix(p, &values)).abs() < 1e-14, "{levels:?} {p}");
            }
        }
    }
}
