//! Linear forms of the planes of a run.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::decay::decay;
use super::extremes::greatest_of;
use super::{TILE, greatest, vectorised};
use crate::light::PlaneTile;

struct Combine<'a> {
    light: PlaneTile<'a>,
    weights: &'a [f32],
    out: &'a mut [f32],
    /// Light below zero counts as none.
    floored: bool,
}

/// A linear form of the planes, one weight a plane, added in their order; planes of weight zero are
/// passed over.
pub(crate) fn combine(light: PlaneTile<'_>, weights: &[f32], out: &mut [f32]) {
    vectorised(Combine { light, weights, out, floored: false });
}

/// Cone illuminance of a run, td: a linear form of the planes for each cone, never negative.
/// Returns the greatest.
pub(crate) fn illuminance(
    light: PlaneTile<'_>,
    weights: &[Vec<f32>; 3],
    out: [&mut [f32]; 3],
) -> [f32; 3] {
    if let [[r0, g0, b0], [r1, g1, b1], [r2, g2, b2]] = weights.each_ref().map(Vec::as_slice) {
        let weights = [[*r0, *g0, *b0], [*r1, *g1, *b1], [*r2, *g2, *b2]];
        return vectorised(OfRgb { light, weights, out });
    }
    let mut most = [0.0; 3];
    for ((weights, out), most) in weights.iter().zip(out).zip(&mut most) {
        vectorised(Combine { light, weights, out: &mut *out, floored: true });
        *most = greatest(out);
    }
    most
}

/// Illuminance that is there already but for its floor: no light is negative. Returns the greatest
/// of each cone.
pub(crate) fn floored(sums: [&[f32]; 3], out: [&mut [f32]; 3]) -> [f32; 3] {
    vectorised(Floored { sums, out })
}

struct Floored<'a> {
    sums: [&'a [f32]; 3],
    out: [&'a mut [f32]; 3],
}

impl WithSimd for Floored<'_> {
    type Output = [f32; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> [f32; 3] {
        let mut most = [0.0; 3];
        for ((sums, out), most) in self.sums.iter().zip(self.out).zip(&mut most) {
            for (out, &sum) in out.iter_mut().zip(*sums) {
                *out = if sum > 0.0 { sum } else { 0.0 };
            }
            *most = greatest_of(out);
        }
        most
    }
}

/// The illuminance of RGB light, all cones at once.
struct OfRgb<'a> {
    light: PlaneTile<'a>,
    weights: [[f32; 3]; 3],
    out: [&'a mut [f32]; 3],
}

impl WithSimd for OfRgb<'_> {
    type Output = [f32; 3];

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> [f32; 3] {
        let OfRgb { light, weights, out } = self;
        let (width, lanes) = (light.width(), S::F32_LANES);
        let whole = width / lanes * lanes;
        let mut most = [0.0; 3];
        for ((weights, out), most) in weights.iter().zip(out).zip(&mut most) {
            if width < lanes {
                *most = of_rgb(pulp::Scalar, light, 0..width, weights, out);
                continue;
            }
            *most = of_rgb(simd, light, 0..whole, weights, out);
            if whole < width {
                // The last vector may overlap the one before.
                *most = most.max(of_rgb(simd, light, width - lanes..width, weights, out));
            }
        }
        most
    }
}

/// One cone's illuminance over a range of whole vectors; returns the greatest.
#[inline(always)]
fn of_rgb<S: Simd>(
    simd: S,
    light: PlaneTile<'_>,
    range: Range<usize>,
    weights: &[f32; 3],
    out: &mut [f32],
) -> f32 {
    let plane = [light.plane(0), light.plane(1), light.plane(2)];
    let [r, g, b] = [
        S::as_simd_f32s(&plane[0][range.clone()]).0,
        S::as_simd_f32s(&plane[1][range.clone()]).0,
        S::as_simd_f32s(&plane[2][range.clone()]).0,
    ];
    let [wr, wg, wb] =
        [simd.splat_f32s(weights[0]), simd.splat_f32s(weights[1]), simd.splat_f32s(weights[2])];
    let zero = simd.splat_f32s(0.0);
    let mut most = zero;
    for (((out, &r), &g), &b) in
        S::as_mut_simd_f32s(&mut out[range]).0.iter_mut().zip(r).zip(g).zip(b)
    {
        let sum = simd.add_f32s(simd.mul_f32s(wr, r), simd.mul_f32s(wg, g));
        let sum = simd.add_f32s(sum, simd.mul_f32s(wb, b));
        *out = simd.select_f32s(simd.greater_than_f32s(sum, zero), sum, zero);
        most = simd.max_f32s(most, *out);
    }
    simd.reduce_max_f32s(most)
}

impl WithSimd for Combine<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Combine { light, weights, out, floored } = self;
        let mut terms = weights.iter().enumerate().filter(|(_, weight)| **weight != 0.0);
        let mut begun = false;
        loop {
            let (mut group, mut count): ([(f32, &[f32]); GROUP], usize) = ([(0.0, &[]); GROUP], 0);
            for (term, (i, &weight)) in group.iter_mut().zip(&mut terms) {
                *term = (weight, light.plane(i));
                count += 1;
            }
            let last = count < GROUP;
            let whole = out.len() / S::F32_LANES * S::F32_LANES;
            let sums = Sums { terms: &group[..count], begun, floored: last && floored };
            sums.add(simd, 0, &mut out[..whole]);
            sums.add(pulp::Scalar, whole, &mut out[whole..]);
            if last {
                return;
            }
            begun = true;
        }
    }
}

/// Planes that are added at once.
const GROUP: usize = 4;

struct Sums<'a> {
    terms: &'a [(f32, &'a [f32])],
    /// Whether there is a sum already to add to.
    begun: bool,
    floored: bool,
}

impl Sums<'_> {
    /// Adds the terms over a range of whole vectors that begins at `from`.
    #[inline(always)]
    fn add<S: Simd>(&self, simd: S, from: usize, out: &mut [f32]) {
        let zero = simd.splat_f32s(0.0);
        let length = out.len();
        for (x, out) in S::as_mut_simd_f32s(out).0.iter_mut().enumerate() {
            let mut sum = if self.begun { *out } else { zero };
            for &(weight, plane) in self.terms {
                let plane = S::as_simd_f32s(&plane[from..from + length]).0;
                sum = simd.add_f32s(sum, simd.mul_f32s(simd.splat_f32s(weight), plane[x]));
            }
            let floored = self.floored;
            *out = if floored {
                simd.select_f32s(simd.greater_than_f32s(sum, zero), sum, zero)
            } else {
                sum
            };
        }
    }
}

struct Weaken<'a> {
    rates: &'a [f64],
    squares: &'a [f64],
    out: &'a mut [f32],
    sums: &'a [[f32; TILE]],
}

/// Cone illuminance under a weight that changes from place to place: sum_j e^(-rate_j r^2) sum_j,
/// never negative. `squares`: r^2 of each place; `sums`: one run for each rate.
pub(crate) fn weaken(rates: &[f64], squares: &[f64], sums: &[[f32; TILE]], out: &mut [f32]) {
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
