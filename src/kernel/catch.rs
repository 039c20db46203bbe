//! The catches of a run of places through what pigment is left, by levels of p.
//!
//! ```text
//! RGB:      R_k(p) = p sum_i W_ki(p) light_i              W_ki: a cubic in p for each plane
//! moments:  R_k(p) = p (M2 + (1-p) (a(p) (M0 - M2) + b(p) (M1 - M2)))      a, b: quadratics in p
//! ```
//!
//! Written out in vectors, of which the last may overlap the one before.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::{TILE, vectorised};
use crate::light::PlaneTile;

/// The catches of an observer in the shape their loop wants.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct CatchForm {
    /// How the planes become catches per pigment.
    pub(crate) planes: PlanesForm,
    /// `[cone]`: polynomials in p, lowest power first, whose largest is the peak that a catch is
    /// divided by; empty where it is not.
    pub(crate) peaks: [Vec<[f32; 4]>; 3],
}

/// How planes become catches per pigment.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum PlanesForm {
    /// `[cone][plane]`: the plane's weight, a cubic in p, lowest power first.
    Rgb([[[f32; 4]; 3]; 3]),
    /// The planes of cone k are its three moments, from plane 3 k on; the quadratics that mix
    /// them, lowest power first.
    Moments { outer: [f32; 3], middle: [f32; 3] },
}

struct Catch<'a> {
    form: &'a CatchForm,
    light: PlaneTile<'a>,
    p: &'a [[f32; TILE]; 3],
    lms: [&'a mut [f32]; 3],
}

/// p of a tile in single precision, as its catch and its percept read it.
pub(crate) fn single(p: [&[f64]; 3], single: &mut [[f32; TILE]; 3]) {
    for (single, p) in single.iter_mut().zip(p) {
        for (single, &p) in single.iter_mut().zip(p) {
            *single = p as f32;
        }
    }
}

/// The catches of a tile. `light`: its planes; `p`: unbleached fractions of L, M, S; `lms`: the
/// catches, a run of the tile's width for each cone.
pub(crate) fn catch(
    form: &CatchForm,
    light: PlaneTile<'_>,
    p: &[[f32; TILE]; 3],
    lms: [&mut [f32]; 3],
) {
    vectorised(Catch { form, light, p, lms });
}

impl WithSimd for Catch<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Catch { form, light, p, lms } = self;
        let (width, lanes) = (light.width(), S::F32_LANES);
        for ((k, p), lms) in (0..3).zip(p).zip(lms) {
            if width < lanes {
                cone(pulp::Scalar, form, k, light, 0..width, p, lms);
                continue;
            }
            let whole = width / lanes * lanes;
            cone(simd, form, k, light, 0..whole, p, lms);
            if whole < width {
                cone(simd, form, k, light, width - lanes..width, p, lms);
            }
        }
    }
}

/// The catches of one cone class over a range of whole vectors.
#[inline(always)]
fn cone<S: Simd>(
    simd: S,
    form: &CatchForm,
    k: usize,
    light: PlaneTile<'_>,
    range: Range<usize>,
    p: &[f32; TILE],
    lms: &mut [f32],
) {
    let plane = |i: usize| vectors::<S>(&light.plane(i)[range.clone()]);
    let (p, lms) =
        (vectors::<S>(&p[range.clone()]), S::as_mut_simd_f32s(&mut lms[range.clone()]).0);
    let peaks = &form.peaks[k];
    match &form.planes {
        PlanesForm::Rgb(weights) => {
            let (weights, [r, g, b]) = (&weights[k], [plane(0), plane(1), plane(2)]);
            for ((((lms, &p), &r), &g), &b) in lms.iter_mut().zip(p).zip(r).zip(g).zip(b) {
                let mut sum = simd.mul_f32s(polynomial(simd, &weights[0], p), r);
                sum = simd.add_f32s(sum, simd.mul_f32s(polynomial(simd, &weights[1], p), g));
                sum = simd.add_f32s(sum, simd.mul_f32s(polynomial(simd, &weights[2], p), b));
                *lms = finished(simd, peaks, p, sum, sum);
            }
        }
        PlanesForm::Moments { outer, middle } => {
            let [m0, m1, m2] = [plane(3 * k), plane(3 * k + 1), plane(3 * k + 2)];
            for ((((lms, &p), &m0), &m1), &m2) in lms.iter_mut().zip(p).zip(m0).zip(m1).zip(m2) {
                let sum = mixed(simd, [outer, middle], p, [m0, m1, m2]);
                *lms = finished(simd, peaks, p, sum, m2);
            }
        }
    }
}

#[inline(always)]
fn vectors<S: Simd>(run: &[f32]) -> &[S::f32s] {
    S::as_simd_f32s(run).0
}

/// Catch per pigment of three moments.
#[inline(always)]
fn mixed<S: Simd>(
    simd: S,
    [outer, middle]: [&[f32; 3]; 2],
    p: S::f32s,
    m: [S::f32s; 3],
) -> S::f32s {
    let outer = simd.mul_f32s(polynomial(simd, outer, p), simd.sub_f32s(m[0], m[2]));
    let middle = simd.mul_f32s(polynomial(simd, middle, p), simd.sub_f32s(m[1], m[2]));
    let bleached = simd.sub_f32s(simd.splat_f32s(1.0), p);
    simd.add_f32s(m[2], simd.mul_f32s(bleached, simd.add_f32s(outer, middle)))
}

/// Catch per pigment -> catch: times p, or for the `narrowed` reading over its own peak. That of a
/// whole pigment is known.
#[inline(always)]
fn finished<S: Simd>(
    simd: S,
    peaks: &[[f32; 4]],
    p: S::f32s,
    per_pigment: S::f32s,
    whole: S::f32s,
) -> S::f32s {
    if peaks.is_empty() {
        return simd.mul_f32s(p, per_pigment);
    }
    let mut greatest = simd.splat_f32s(0.0);
    for peak in peaks {
        greatest = simd.max_f32s(greatest, polynomial(simd, peak, p));
    }
    simd.select_f32s(
        simd.equal_f32s(p, simd.splat_f32s(1.0)),
        whole,
        simd.div_f32s(per_pigment, greatest),
    )
}

/// c0 + c1 p + c2 p^2 + ..
#[inline(always)]
fn polynomial<S: Simd, const N: usize>(simd: S, c: &[f32; N], p: S::f32s) -> S::f32s {
    let mut sum = simd.splat_f32s(c[N - 1]);
    for &c in c.iter().rev().skip(1) {
        sum = simd.add_f32s(simd.mul_f32s(sum, p), simd.splat_f32s(c));
    }
    sum
}
