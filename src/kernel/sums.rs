//! Linear forms of the planes of a run.

use pulp::{Simd, WithSimd};

use super::decay::decay;
use super::{Strip, TILE, vectorised};

struct Combine<'a> {
    light: Strip<'a>,
    weights: &'a [f32],
    out: &'a mut [f32],
    /// Light below zero counts as none.
    floored: bool,
}

/// A linear form of the planes, one weight a plane, added in their order; planes of weight zero are passed over.
pub fn combine(light: Strip<'_>, weights: &[f32], out: &mut [f32]) {
    vectorised(Combine { light, weights, out, floored: false });
}

/// Cone illuminance of a run, td: a linear form of the planes for each cone, never negative.
pub fn illuminance(light: Strip<'_>, weights: &[Vec<f32>; 3], out: [&mut [f32]; 3]) {
    for (weights, out) in weights.iter().zip(out) {
        vectorised(Combine { light, weights, out, floored: true });
    }
}

impl WithSimd for Combine<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Combine { light, weights, out, floored } = self;
        out.fill(0.0);
        for (i, &weight) in weights.iter().enumerate() {
            if weight != 0.0 {
                for (sum, v) in out.iter_mut().zip(light.plane(i)) {
                    *sum += weight * v;
                }
            }
        }
        if floored {
            for sum in out.iter_mut() {
                *sum = if *sum > 0.0 { *sum } else { 0.0 };
            }
        }
    }
}

struct Weaken<'a> {
    rates: &'a [f64],
    squares: &'a [f64],
    out: &'a mut [f32],
    sums: &'a [[f32; TILE]],
}

/// Cone illuminance under a weight that changes from place to place: sum_j e^(-rate_j r^2) sum_j, never negative.
/// `squares`: r^2 of each place; `sums`: one run for each rate.
pub fn weaken(rates: &[f64], squares: &[f64], sums: &[[f32; TILE]], out: &mut [f32]) {
    vectorised(Weaken { rates, squares, out, sums });
}

impl WithSimd for Weaken<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let mut total = [0.0f64; TILE];
        for (&rate, sum) in self.rates.iter().zip(self.sums) {
            for ((total, &square), &v) in total.iter_mut().zip(self.squares).zip(sum) {
                *total += decay(rate * square) * f64::from(v);
            }
        }
        for (out, &total) in self.out.iter_mut().zip(&total) {
            *out = if total > 0.0 { total as f32 } else { 0.0 };
        }
    }
}
