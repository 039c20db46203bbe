//! The percept of a run: catches through the pigments by their levels, then the picture's RGB.
//!
//! ```text
//! RGB:      R_k(p) = p sum_i W_ki(p) light_i              W_ki: a cubic in p for each plane, through four levels
//! moments:  R_k(p) = p (M2 + (1-p) (a(p) (M0 - M2) + b(p) (M1 - M2)))          a, b: cubics in p; three levels
//! seen = A R
//! ```
//!
//! Where all three p are 1 the light itself is returned: RGB as it came in, moments as their catch
//! at p = 1. (p counts as 1 where it is nearer to 1 than to any other f32.) Written out in vectors,
//! of which the last may overlap the one before.

use std::ops::Range;

use pulp::{Simd, WithSimd};

use super::{Strip, TILE, vectorised};
use crate::colour::Matrix;
use crate::percept::{Levels, Vision};

/// A vision's percept in the shape its loop wants.
#[derive(Clone, Debug)]
pub struct PerceptForm {
    reception: Reception,
    lms_to_seen: [[f32; 3]; 3],
    /// `[cone]`: polynomials whose largest is the peak, lowest power first; empty for the
    /// `depleted` reading.
    peaks: [Vec<[f32; 5]>; 3],
}

/// How the planes become catches per pigment.
#[derive(Clone, Debug)]
enum Reception {
    /// `[cone][plane]`: the plane's weight, a cubic in p, lowest power first.
    Rgb([[[f32; 4]; 3]; 3]),
    /// The planes of cone k are its three moments, from plane 3 k on; the cubics that mix them,
    /// lowest power first.
    Moments { outer: [f32; 4], middle: [f32; 4] },
}

impl PerceptForm {
    /// The percept of a vision.
    pub fn new(vision: &Vision) -> Self {
        let levels = vision.levels();
        let single = |m: &Matrix| m.map(|row| row.map(|v| v as f32));
        let of_rgb = |k: usize, plane: usize| {
            let of_level = |j: usize| vision.moment_weight(k * levels.len() + j, plane);
            let values: Vec<f64> = (0..levels.len()).map(of_level).collect();
            let [c0, c1, c2, c3, _] = levels.polynomial(&values).map(|c| c as f32);
            [c0, c1, c2, c3]
        };
        let peak = |values: &Vec<f64>| levels.polynomial(values).map(|c| c as f32);
        PerceptForm {
            reception: match levels {
                Levels::Four => {
                    Reception::Rgb([0, 1, 2].map(|k| [0, 1, 2].map(|plane| of_rgb(k, plane))))
                }
                Levels::Three { outer, middle } => Reception::Moments {
                    outer: outer.map(|c| c as f32),
                    middle: middle.map(|c| c as f32),
                },
            },
            lms_to_seen: single(&vision.lms_to_seen),
            peaks: match vision.peaks() {
                None => [const { Vec::new() }; 3],
                Some(peaks) => [0, 1, 2].map(|k| peaks[k].iter().map(peak).collect()),
            },
        }
    }
}

struct Percept<'a> {
    form: &'a PerceptForm,
    light: Strip<'a>,
    p: [&'a [f64]; 3],
    single: &'a mut [[f32; TILE]; 3],
    seen: [&'a mut [f32]; 3],
}

/// The percept of a tile. `light`: its planes; `p`: unbleached fractions of L, M, S; `single`: room
/// for them in single precision; `seen`: R, G, B.
pub fn percept(
    form: &PerceptForm,
    light: Strip<'_>,
    p: [&[f64]; 3],
    single: &mut [[f32; TILE]; 3],
    seen: [&mut [f32]; 3],
) {
    vectorised(Percept { form, light, p, single, seen });
}

impl WithSimd for Percept<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Percept { form, light, p, single, seen } = self;
        for (single, p) in single.iter_mut().zip(p) {
            for (single, &p) in single.iter_mut().zip(p) {
                *single = p as f32;
            }
        }
        let [r, g, b] = seen;
        let (width, lanes) = (light.width(), S::F32_LANES);
        if width < lanes {
            return look(pulp::Scalar, form, light, 0..width, single, [r, g, b]);
        }
        let whole = width / lanes * lanes;
        look(simd, form, light, 0..whole, single, [&mut *r, &mut *g, &mut *b]);
        if whole < width {
            look(simd, form, light, width - lanes..width, single, [r, g, b]);
        }
    }
}

/// The percept of a range of whole vectors.
#[inline(always)]
fn look<S: Simd>(
    simd: S,
    form: &PerceptForm,
    light: Strip<'_>,
    range: Range<usize>,
    p: &[[f32; TILE]; 3],
    seen: [&mut [f32]; 3],
) {
    let [l, m, s] = p;
    let p = [
        vectors::<S>(&l[range.clone()]),
        vectors::<S>(&m[range.clone()]),
        vectors::<S>(&s[range.clone()]),
    ];
    let [r, g, b] = seen;
    let mut seen = [
        S::as_mut_simd_f32s(&mut r[range.clone()]).0,
        S::as_mut_simd_f32s(&mut g[range.clone()]).0,
        S::as_mut_simd_f32s(&mut b[range.clone()]).0,
    ];
    match &form.reception {
        Reception::Rgb(weights) => {
            let mut planes: [&[S::f32s]; 3] = [&[]; 3];
            for (i, plane) in planes.iter_mut().enumerate() {
                *plane = vectors::<S>(&light.plane(i)[range.clone()]);
            }
            for x in 0..p[0].len() {
                let (p, light) =
                    ([p[0][x], p[1][x], p[2][x]], [planes[0][x], planes[1][x], planes[2][x]]);
                let rgb = seen_of_rgb(simd, form, weights, p, light);
                for i in 0..3 {
                    seen[i][x] = rgb[i];
                }
            }
        }
        Reception::Moments { outer, middle } => {
            let mut planes: [&[S::f32s]; 9] = [&[]; 9];
            for (i, plane) in planes.iter_mut().enumerate() {
                *plane = vectors::<S>(&light.plane(i)[range.clone()]);
            }
            for x in 0..p[0].len() {
                let mut catch = [simd.splat_f32s(0.0); 3];
                for k in 0..3 {
                    let m = [planes[3 * k][x], planes[3 * k + 1][x], planes[3 * k + 2][x]];
                    let sum = mixed(simd, [outer, middle], p[k][x], m);
                    catch[k] = finished(simd, &form.peaks[k], p[k][x], sum, m[2]);
                }
                for (row, seen) in form.lms_to_seen.iter().zip(&mut seen) {
                    seen[x] = row_times(simd, row, catch);
                }
            }
        }
    }
}

#[inline(always)]
fn vectors<S: Simd>(run: &[f32]) -> &[S::f32s] {
    S::as_simd_f32s(run).0
}

#[inline(always)]
fn seen_of_rgb<S: Simd>(
    simd: S,
    form: &PerceptForm,
    weights: &[[[f32; 4]; 3]; 3],
    p: [S::f32s; 3],
    light: [S::f32s; 3],
) -> [S::f32s; 3] {
    let mut catch = [simd.splat_f32s(0.0); 3];
    for k in 0..3 {
        let mut sum = simd.mul_f32s(polynomial(simd, &weights[k][0], p[k]), light[0]);
        for i in 1..3 {
            sum =
                simd.add_f32s(sum, simd.mul_f32s(polynomial(simd, &weights[k][i], p[k]), light[i]));
        }
        catch[k] = finished(simd, &form.peaks[k], p[k], sum, sum);
    }
    let one = simd.splat_f32s(1.0);
    let lm = simd.and_m32s(simd.equal_f32s(p[0], one), simd.equal_f32s(p[1], one));
    let unbleached = simd.and_m32s(lm, simd.equal_f32s(p[2], one));
    let mut seen = light;
    for i in 0..3 {
        seen[i] =
            simd.select_f32s(unbleached, light[i], row_times(simd, &form.lms_to_seen[i], catch));
    }
    seen
}

/// Catch per pigment of three moments.
#[inline(always)]
fn mixed<S: Simd>(
    simd: S,
    [outer, middle]: [&[f32; 4]; 2],
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
    peaks: &[[f32; 5]],
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

#[inline(always)]
fn row_times<S: Simd>(simd: S, row: &[f32; 3], lms: [S::f32s; 3]) -> S::f32s {
    let mut sum = simd.mul_f32s(simd.splat_f32s(row[0]), lms[0]);
    for k in 1..3 {
        sum = simd.add_f32s(sum, simd.mul_f32s(simd.splat_f32s(row[k]), lms[k]));
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::{Narrowing, Observer};
    use crate::light::{Planes, Primaries, Samples};
    use crate::spectrum::Bands;
    use crate::units::Nits;

    const FRACTIONS: [[f64; 3]; 5] = [
        [0.9, 0.8, 0.7],
        [1e-6, 1e-5, 0.5],
        [1.0, 0.3, 1.0],
        [0.999_999, 1.0, 1.0],
        [1.0, 1.0, 1.0],
    ];

    fn seen(form: &PerceptForm, planes: &[f32], p: [f64; 3]) -> [f32; 3] {
        let mut seen = [0.0; 3];
        let [r, g, b] = &mut seen;
        let out = [r, g, b].map(std::slice::from_mut);
        percept(
            form,
            Strip::whole(planes, 1),
            p.each_ref().map(std::slice::from_ref),
            &mut [[0.0; TILE]; 3],
            out,
        );
        seen
    }

    fn agrees(vision: &Vision, light: &[f32]) {
        let form = PerceptForm::new(vision);
        let planes = Planes {
            width: 1,
            height: 1,
            count: light.len(),
            samples: Samples::Float(light.to_vec()),
        };
        let moments = vision.moments(&planes, 0, 0);
        for p in FRACTIONS {
            let ours = seen(&form, light, p);
            let exact = crate::colour::apply(&vision.lms_to_seen, vision.catch(&moments, p));
            let size = exact.iter().fold(0.0f64, |a, v| a.max(v.abs()));
            for (ours, exact) in ours.iter().zip(exact) {
                assert!(
                    (f64::from(*ours) - exact).abs() < 1e-5 * size,
                    "{p:?}: {ours:?} {exact:?}"
                );
            }
        }
    }

    fn narrowing_observer() -> Observer {
        let mut observer = Observer::standard();
        observer.narrowing = Narrowing::Narrowed;
        observer
    }

    #[test]
    fn the_run_agrees_with_the_scalar_percept_of_rgb() {
        for observer in [Observer::standard(), narrowing_observer()] {
            agrees(
                &Vision::of_rgb(observer, &Primaries::REC709, Nits(100.0)).unwrap(),
                &[0.7, 0.2, 0.05],
            );
        }
    }

    #[test]
    fn the_run_agrees_with_the_scalar_percept_of_bands() {
        let bands = Bands::uniform(395.0, 705.0, 31).unwrap();
        let light: Vec<f32> = (0..31).map(|i| 0.01 * (1.0 + (i as f32 * 0.4).sin())).collect();
        for observer in [Observer::standard(), narrowing_observer()] {
            let vision = Vision::of_bands(observer, &bands);
            let projection = vision.projection().unwrap();
            let mut moments = vec![0.0; projection.rows];
            projection.project(&light, &mut moments);
            agrees(&vision, &moments);
        }
    }

    #[test]
    fn an_unbleached_eye_returns_its_input_bit_for_bit() {
        let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(3.7)).unwrap();
        let light = [0.1f32, -3.3e-7, 6.5e4];
        assert_eq!(seen(&PerceptForm::new(&vision), &light, [1.0; 3]), light);
    }

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(100.0)).unwrap();
        let form = PerceptForm::new(&vision);
        let light: Vec<f32> = (0..3 * 201).map(|i| (i as f32 * 0.7).sin().abs() * 1e3).collect();
        let p: Vec<f64> = (0..3 * 201).map(|i| (i as f64 * 0.3).sin().abs()).collect();
        let run = |scalar: bool| {
            let mut seen = vec![0.0f32; 3 * 201];
            let (r, rest) = seen.split_at_mut(201);
            let (g, b) = rest.split_at_mut(201);
            let p = [0, 1, 2].map(|k| &p[k * 201..][..201]);
            let mut single = [[0.0; TILE]; 3];
            let light = Strip::whole(&light, 201);
            let work = Percept { form: &form, light, p, single: &mut single, seen: [r, g, b] };
            if scalar {
                work.with_simd(pulp::Scalar)
            } else {
                vectorised(work)
            }
            seen
        };
        assert_eq!(run(true), run(false));
    }
}
