//! The levels of p through which a narrowed pigment is read, and what that costs.
//!
//! With x = D ln 10 a(lambda), a wavelength's catch per pigment is H(x, p) = (1 - e^(-x p))/p. It
//! is read as a sum over the levels 0, 1/2 and 1, with weights that are the same for every
//! wavelength:
//!
//! ```text
//! H(x, p) ~ H(x, 1) + (1 - p) (a(p) (H(x, 0) - H(x, 1)) + b(p) (H(x, 1/2) - H(x, 1)))
//! ```
//!
//! p = 1 is exact, hence so is an unbleached eye. a and b are quadratics in p, so that the weight
//! of an RGB plane is a cubic. Made for these functions, they are nearer than Lagrange's cubics on
//! the four levels 0, 1/4, 3/4, 1: 1.4e-4 instead of 1.9e-4 at a density of 0.5.

use std::f64::consts::LN_10;

use crate::observer::{Narrowing, Observer};
use crate::spectrum::Curve;

/// The levels.
pub(crate) const LEVELS: [f64; 3] = [0.0, 0.5, 1.0];

/// Where a and b are exact: at these p for light at these shares of the densest pigment's x. Two
/// digits of what spreads the error evenly at densities 0.1 to 0.5, by search.
const EXACT_P: [f64; 3] = [0.07, 0.27, 0.71];
const EXACT_X: [f64; 2] = [0.48, 0.93];

/// Largest relative error of a catch per pigment from the levels: any light, any p, peak density up
/// to this. With X = D ln 10, thin pigments err by x (x - 0.48 X) (x - 0.93 X)/6 times
/// p (p - 1/2) (p - 1)/4 of H, at most 8.2e-5 X^3; the factor here is measured over all densities.
pub fn level_bound(density: f64) -> f64 {
    let density = density.max(THINNEST);
    9.2e-5 * (density * LN_10).powi(3) * (2.0 * density).max(1.0)
}

/// How the levels are mixed at any p: a and b, lowest power first.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Levels {
    pub(crate) outer: [f64; 3],
    pub(crate) middle: [f64; 3],
}

impl Levels {
    /// Weights for pigments whose peak density is at most this.
    pub(crate) fn of(density: f64) -> Self {
        let densest = density.max(THINNEST) * LN_10;
        let exact = |p: f64| exact_weights(EXACT_X.map(|x| x * densest), p).map(|w| w / (1.0 - p));
        let exact = EXACT_P.map(exact);
        Levels {
            outer: quadratic_through(EXACT_P, exact.map(|w| w[0])),
            middle: quadratic_through(EXACT_P, exact.map(|w| w[1])),
        }
    }

    /// The weights of the levels at p; they sum to 1.
    pub(crate) fn weights(&self, p: f64) -> [f64; 3] {
        let [w0, w1] = [self.outer, self.middle].map(|c| (1.0 - p) * polynomial(&c, p));
        [w0, w1, 1.0 - w0 - w1]
    }

    /// The value at p of what has these values at the levels.
    pub(crate) fn mix(&self, p: f64, values: &[f64]) -> f64 {
        self.weights(p).iter().zip(values).map(|(w, v)| w * v).sum()
    }

    /// The same as a polynomial in p, lowest power first.
    pub(crate) fn polynomial(&self, values: [f64; 3]) -> [f64; 4] {
        let [outer, middle] = [values[0] - values[2], values[1] - values[2]];
        let mut powers = [values[2], 0.0, 0.0, 0.0];
        for (i, (a, b)) in self.outer.iter().zip(self.middle).enumerate() {
            let c = a * outer + b * middle;
            powers[i] += c;
            powers[i + 1] -= c;
        }
        powers
    }
}

/// Below this density the equations for the weights are ill-conditioned; it is used instead.
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

/// The quadratic through three points, lowest power first (Newton's divided differences).
fn quadratic_through([x0, x1, x2]: [f64; 3], [y0, y1, y2]: [f64; 3]) -> [f64; 3] {
    let (first, next) = ((y1 - y0) / (x1 - x0), (y2 - y1) / (x2 - x1));
    let second = (next - first) / (x2 - x0);
    [y0 - x0 * (first - x1 * second), first - (x0 + x1) * second, second]
}

fn polynomial(powers: &[f64; 3], p: f64) -> f64 {
    powers[0] + p * (powers[1] + p * powers[2])
}

/// Rows of the basis: H_k at the levels for each cone, then s_k times each Stiles-Crawford share.
pub(super) fn weighting_curves(observer: &Observer) -> Vec<Curve> {
    let eye = &observer.fundamentals;
    let catches = (0..3).flat_map(|k| LEVELS.map(|p| eye.per_pigment(k, p)));
    let shares = observer.directional.shares();
    let trolands =
        (0..3).flat_map(|k| shares.iter().map(move |share| eye.unbleached(k).times(share)));
    catches.chain(trolands).collect()
}

/// H at the levels, relative to the peak at p = 1, for every wavelength that is the peak at some p.
/// (The S cone has two maxima, at 443 and 447 nm, whose order changes at p = 0.4: one smooth
/// function would miss that by 7e-4.)
pub(super) fn peaks(observer: &Observer) -> Option<[Vec<[f64; 3]>; 3]> {
    let of_cone = |k: usize| {
        let curves = LEVELS.map(|p| observer.fundamentals.per_pigment(k, p));
        let unbleached = observer.fundamentals.unbleached(k).peak();
        let peak = |i: usize| {
            observer.fundamentals.per_pigment(k, i as f64 / 64.0).peak_and_width().0 as usize
        };
        let mut wavelengths: Vec<usize> = (0..=64).map(peak).collect();
        wavelengths.dedup();
        wavelengths
            .into_iter()
            .map(|nm| curves.each_ref().map(|curve| curve.at(nm) / unbleached))
            .collect()
    };
    (observer.narrowing == Narrowing::Narrowed).then(|| [0, 1, 2].map(of_cone))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn h(x: f64, p: f64) -> f64 {
        if x * p == 0.0 { x } else { -(-x * p).exp_m1() / p }
    }

    /// The largest relative error over all wavelengths of a pigment and p.
    fn worst(levels: &Levels, density: f64) -> f64 {
        let of_one = |a: i32| {
            let x = density * LN_10 * f64::from(a) / 200.0;
            let values = LEVELS.map(|p| h(x, p));
            let errors = (0..=200)
                .map(|p| f64::from(p) / 200.0)
                .map(|p| (levels.mix(p, &values) / h(x, p) - 1.0).abs());
            errors.fold(0.0, f64::max)
        };
        (1..=200).map(of_one).fold(0.0, f64::max)
    }

    #[test]
    fn the_bound_of_any_density_covers_what_the_levels_cost_it_and_every_thinner_one() {
        for density in (1..=60).map(|i| 0.02 * f64::from(i)).chain([0.001, 0.01, 2.0, 3.0]) {
            let (levels, bound) = (Levels::of(density), level_bound(density));
            for share in [1.0, 0.9, 0.5] {
                let worst = worst(&levels, share * density);
                assert!(worst <= bound, "{share} of {density}: {worst:e} {bound:e}");
            }
        }
    }

    #[test]
    fn the_levels_cost_what_their_bound_says_and_less_than_four_of_lagrange() {
        // Lagrange's cubics on 0, 1/4, 3/4 and 1: 6.6e-5 at density 0.38, 1.9e-4 at 0.5.
        for (density, expected) in [(0.38, 5.68e-5), (0.5, 1.376e-4)] {
            let worst = worst(&Levels::of(density), density);
            assert!((worst / expected - 1.0).abs() < 5e-3, "{worst:e}");
            assert!(worst > 0.9 * level_bound(density), "{worst:e}");
        }
    }

    #[test]
    fn level_weights_sum_to_one_and_the_whole_pigment_picks_its_level() {
        let levels = Levels::of(0.4);
        for p in [0.0, 0.1, 0.5, 0.9, 1.0] {
            assert!((levels.weights(p).iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
        assert_eq!(levels.weights(1.0), [0.0, 0.0, 1.0]);
    }

    #[test]
    fn the_polynomial_is_the_mix() {
        let (values, levels) = ([0.9, 0.7, 0.65], Levels::of(0.4));
        let powers = levels.polynomial(values);
        for p in [0.0, 0.2, 0.5, 0.99, 1.0] {
            let value = powers.iter().rev().fold(0.0, |sum, c| sum * p + c);
            assert!((value - levels.mix(p, &values)).abs() < 1e-14, "{p}");
        }
    }
}
