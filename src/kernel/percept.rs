//! The percept of a run of places: its catches in the picture's own RGB.
//!
//! ```text
//! percept = A catch           and the light itself where all three p are 1, if it is RGB
//! ```
//!
//! p counts as 1 where it is nearer to 1 than to any other f32.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::{TILE, vectorised};
use crate::light::PlaneTile;

/// The percept of an observer in the shape its loop wants.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PerceptForm {
    /// A: catches -> the picture's RGB.
    pub(crate) lms_to_percept: [[f32; 3]; 3],
    /// Whether planes are RGB, which is returned where nothing has bleached.
    pub(crate) returns_light: bool,
}

struct Percept<'a> {
    form: &'a PerceptForm,
    light: PlaneTile<'a>,
    p: &'a [[f32; TILE]; 3],
    lms: [&'a [f32]; 3],
    percept: [&'a mut [f32]; 3],
}

/// The percept of a tile. `light`: its planes; `p`: unbleached fractions; `lms`: its catches;
/// `percept`: R, G, B.
pub(crate) fn percept(
    form: &PerceptForm,
    light: PlaneTile<'_>,
    p: &[[f32; TILE]; 3],
    lms: [&[f32]; 3],
    percept: [&mut [f32]; 3],
) {
    vectorised(Percept { form, light, p, lms, percept });
}

impl WithSimd for Percept<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Percept { form, light, p, lms, percept: [r, g, b] } = self;
        let (width, lanes) = (light.width(), S::F32_LANES);
        if width < lanes {
            return seen(pulp::Scalar, form, light, 0..width, p, lms, [r, g, b]);
        }
        let whole = width / lanes * lanes;
        seen(simd, form, light, 0..whole, p, lms, [&mut *r, &mut *g, &mut *b]);
        if whole < width {
            seen(simd, form, light, width - lanes..width, p, lms, [r, g, b]);
        }
    }
}

/// The percept of a range of whole vectors.
#[inline(always)]
fn seen<S: Simd>(
    simd: S,
    form: &PerceptForm,
    light: PlaneTile<'_>,
    range: Range<usize>,
    p: &[[f32; TILE]; 3],
    lms: [&[f32]; 3],
    percept: [&mut [f32]; 3],
) {
    let [l, m, s] = lms.map(|lms| S::as_simd_f32s(&lms[range.clone()]).0);
    let [pl, pm, ps] = p.each_ref().map(|p| S::as_simd_f32s(&p[range.clone()]).0);
    let one = simd.splat_f32s(1.0);
    for (i, (row, out)) in form.lms_to_percept.iter().zip(percept).enumerate() {
        let out = S::as_mut_simd_f32s(&mut out[range.clone()]).0;
        let light = S::as_simd_f32s(&light.plane(i)[range.clone()]).0;
        for x in 0..out.len() {
            let sum = row_times(simd, row, [l[x], m[x], s[x]]);
            out[x] = if form.returns_light {
                let lm = simd.and_m32s(simd.equal_f32s(pl[x], one), simd.equal_f32s(pm[x], one));
                let unbleached = simd.and_m32s(lm, simd.equal_f32s(ps[x], one));
                simd.select_f32s(unbleached, light[x], sum)
            } else {
                sum
            };
        }
    }
}

#[inline(always)]
fn row_times<S: Simd>(simd: S, row: &[f32; 3], lms: [S::f32s; 3]) -> S::f32s {
    let mut sum = simd.mul_f32s(simd.splat_f32s(row[0]), lms[0]);
    for k in 1..3 {
        sum = simd.add_f32s(sum, simd.mul_f32s(simd.splat_f32s(row[k]), lms[k]));
    }
    sum
}
