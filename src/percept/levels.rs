//! The levels of p through which a narrowed pigment is interpolated, and what that costs.

use std::f64::consts::LN_10;

use crate::eye::{Narrowing, Observer};
use crate::spectrum::Curve;

/// The levels of p through which a narrowed pigment is interpolated.
pub const LEVELS: [f64; 4] = [0.0, 0.25, 0.75, 1.0];

/// Largest relative error of a catch from the four levels, any light, any p, density up to 0.5 (numerics 5.3).
pub const LEVEL_BOUND: f64 = 1.9e-4;

/// The same for any peak density. With x = D ln 10 and H = (1 - e^(-x p))/p, the fourth derivative of H is at most
/// x^5/5 and H at least 1 - e^-x; max |p (p - 1/4) (p - 3/4) (p - 1)| = 1/64, at p = 1/2.
pub fn level_bound(density: f64) -> f64 {
    let x = density * LN_10;
    if density <= 0.5 { LEVEL_BOUND } else { x.powi(5) / (5.0 * 24.0 * 64.0 * -(-x).exp_m1()) }
}

/// Lagrange weights of [`LEVELS`] at p; they sum to 1.
pub fn level_weights(p: f64) -> [f64; 4] {
    let [a, b, c, d] = [p, p - 0.25, p - 0.75, p - 1.0];
    [
        b * c * d / (-0.25 * 0.75),
        a * c * d / (0.25 * 0.5 * 0.75),
        a * b * d / (-0.75 * 0.5 * 0.25),
        a * b * c / (0.75 * 0.25),
    ]
}

/// Rows of the basis: H_k at the four levels for each cone, then s_k times each Stiles-Crawford share.
pub(super) fn weighting_curves(observer: &Observer) -> Vec<Curve> {
    let eye = &observer.fundamentals;
    let catches = (0..3).flat_map(|k| LEVELS.map(|p| eye.per_pigment(k, p)));
    let shares = observer.directional.shares();
    let trolands = (0..3).flat_map(|k| shares.iter().map(move |share| eye.unbleached(k).times(share)));
    catches.chain(trolands).collect()
}

/// H at the levels, relative to the peak at p = 1, for every wavelength that is the peak at some p. (The S cone has
/// two maxima, at 443 and 447 nm, whose order changes at p = 0.4: one smooth function would miss that by 7e-4.)
pub(super) fn peaks(observer: &Observer) -> Option<[Vec<[f64; 4]>; 3]> {
    let of_cone = |k: usize| {
        let levels = LEVELS.map(|p| observer.fundamentals.per_pigment(k, p));
        let unbleached = observer.fundamentals.unbleached(k).peak();
        let peak = |i: usize| observer.fundamentals.per_pigment(k, i as f64 / 64.0).peak_and_width().0 as usize;
        let mut wavelengths: Vec<usize> = (0..=64).map(peak).collect();
        wavelengths.dedup();
        wavelengths.into_iter().map(|nm| [0, 1, 2, 3].map(|j| levels[j].at(nm) / unbleached)).collect()
    };
    (observer.narrowing == Narrowing::Narrowed).then(|| [0, 1, 2].map(of_cone))
}

pub(super) fn mix(weights: &[f64; 4], levels: &[f64]) -> f64 {
    weights.iter().zip(levels).map(|(w, m)| w * m).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bound_of_any_density_covers_what_interpolation_costs() {
        let h = |x: f64, p: f64| if x * p == 0.0 { x } else { -(-x * p).exp_m1() / p };
        for density in [0.3, 0.5, 0.7, 1.0] {
            let mut worst: f64 = 0.0;
            for (a, p) in (1..=50).flat_map(|a| (1..100).map(move |p| (f64::from(a) / 50.0, f64::from(p) / 100.0))) {
                let x = density * LN_10 * a;
                worst = worst.max((mix(&level_weights(p), &LEVELS.map(|level| h(x, level))) / h(x, p) - 1.0).abs());
            }
            assert!(worst <= level_bound(density), "{density}: {worst:e} {:e}", level_bound(density));
        }
    }

    #[test]
    fn level_weights_sum_to_one_and_pick_their_level() {
        for p in [0.0, 0.1, 0.5, 0.9, 1.0] {
            assert!((level_weights(p).iter().sum::<f64>() - 1.0).abs() < 1e-14);
        }
        for (j, level) in LEVELS.into_iter().enumerate() {
            let weights = level_weights(level);
            assert!((0..4).all(|i| weights[i] == if i == j { 1.0 } else { 0.0 }), "{level}: {weights:?}");
        }
    }
}
