//! The percept of a run: catches through the pigments by the four levels, as cubics in p, then the picture's RGB.
//!
//! ```text
//! R_k(p) = p (q0 + q1 p + q2 p^2 + q3 p^3),   q = V M,   seen = A R
//! ```
//!
//! V turns values at the levels into powers of p. Where all three p are 1 the light itself is returned: RGB as it
//! came in, moments as their catch at p = 1. (p counts as 1 where it is nearer to 1 than to any other f32.)

use pulp::{Simd, WithSimd};

use super::{Strip, TILE, vectorised};
use crate::colour::Matrix;
use crate::percept::{LEVELS, Vision, level_weights};

/// A vision's percept in the shape its loop wants.
#[derive(Clone, Debug)]
pub struct PerceptForm {
    reception: Reception,
    lms_to_seen: [[f32; 3]; 3],
    /// `[cone]`: cubics whose largest is the peak, lowest power first; empty for the `depleted` reading.
    peaks: [Vec<[f32; 4]>; 3],
}

/// How the planes become the coefficients of the cubics: `[power][plane]`.
#[derive(Clone, Debug)]
enum Reception {
    /// Each cone's own weights of the three planes.
    Rgb([[[f32; 3]; 4]; 3]),
    /// The planes of cone k are its four moments, from plane 4 k on.
    Moments([[f32; 4]; 4]),
}

impl PerceptForm {
    /// The percept of a vision.
    pub fn new(vision: &Vision) -> Self {
        let to_powers = powers_of_levels();
        let single = |m: &Matrix| m.map(|row| row.map(|v| v as f32));
        let of_rgb = |k: usize, l: usize, plane: usize| {
            let shares = to_powers[l].iter().enumerate();
            shares.map(|(j, share)| share * vision.moment_weights(k * LEVELS.len() + j)[plane]).sum::<f64>() as f32
        };
        let cubic = |h: &[f64; 4]| to_powers.map(|row| row.iter().zip(h).map(|(v, h)| v * h).sum::<f64>() as f32);
        PerceptForm {
            reception: if vision.returns_its_light() {
                Reception::Rgb([0, 1, 2].map(|k| [0, 1, 2, 3].map(|l| [0, 1, 2].map(|plane| of_rgb(k, l, plane)))))
            } else {
                Reception::Moments(to_powers.map(|row| row.map(|v| v as f32)))
            },
            lms_to_seen: single(&vision.lms_to_seen),
            peaks: match vision.peaks() {
                None => [const { Vec::new() }; 3],
                Some(peaks) => [0, 1, 2].map(|k| peaks[k].iter().map(cubic).collect()),
            },
        }
    }
}

/// `[power][level]`: values at [`LEVELS`] -> coefficients of the cubic through them.
fn powers_of_levels() -> [[f64; 4]; 4] {
    // Thirds of the cubic's third difference would lose digits; the four samples below are exact in binary.
    let at = [0.0, 1.0, 2.0, -1.0].map(level_weights);
    let mut rows = [[0.0; 4]; 4];
    for j in 0..4 {
        let [f0, f1, f2, fm] = [at[0][j], at[1][j], at[2][j], at[3][j]];
        let even = (f1 + fm) / 2.0 - f0;
        let odd = (f1 - fm) / 2.0;
        let third = ((f2 - f0 - 4.0 * even) / 2.0 - odd) / 3.0;
        rows[0][j] = f0;
        rows[1][j] = odd - third;
        rows[2][j] = even;
        rows[3][j] = third;
    }
    rows
}

struct Percept<'a> {
    form: &'a PerceptForm,
    light: Strip<'a>,
    p: [&'a [f64]; 3],
    seen: [&'a mut [f32]; 3],
}

/// The percept of a tile. `light`: its planes; `p`: unbleached fractions of L, M, S; `seen`: R, G, B.
pub fn percept(form: &PerceptForm, light: Strip<'_>, p: [&[f64]; 3], seen: [&mut [f32]; 3]) {
    vectorised(Percept { form, light, p, seen });
}

impl WithSimd for Percept<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Percept { form, light, p, seen } = self;
        let n = light.width();
        let (mut single, mut lms) = ([[0.0f32; TILE]; 3], [[0.0f32; TILE]; 3]);
        for (single, p) in single.iter_mut().zip(p) {
            for (single, &p) in single.iter_mut().zip(p) {
                *single = p as f32;
            }
        }
        for k in 0..3 {
            let (p, catch) = (&single[k][..n], &mut lms[k][..n]);
            match &form.reception {
                Reception::Rgb(weights) => {
                    let planes = [light.plane(0), light.plane(1), light.plane(2)];
                    per_pigment(&weights[k], planes, p, catch);
                    finish_catch(&form.peaks[k], p, catch);
                }
                Reception::Moments(weights) => {
                    let at = k * LEVELS.len();
                    let planes = [light.plane(at), light.plane(at + 1), light.plane(at + 2), light.plane(at + 3)];
                    per_pigment(weights, planes, p, catch);
                    finish_catch(&form.peaks[k], p, catch);
                    choose(p, planes[3], catch);
                }
            }
        }
        for (i, (row, seen)) in form.lms_to_seen.iter().zip(seen).enumerate() {
            apply(row, &lms, &mut seen[..n]);
            if let Reception::Rgb(_) = form.reception {
                keep_where_unbleached(&single, light.plane(i), &mut seen[..n]);
            }
        }
    }
}

/// The cubic of each place: its catch per pigment.
#[inline(always)]
fn per_pigment<const N: usize>(weights: &[[f32; N]; 4], planes: [&[f32]; N], p: &[f32], out: &mut [f32]) {
    let planes = planes.map(|plane| &plane[..out.len()]);
    let p = &p[..out.len()];
    for x in 0..out.len() {
        let mut q = [0.0f32; 4];
        for l in 0..4 {
            q[l] = weights[l][0] * planes[0][x];
            for i in 1..N {
                q[l] += weights[l][i] * planes[i][x];
            }
        }
        out[x] = q[0] + p[x] * (q[1] + p[x] * (q[2] + p[x] * q[3]));
    }
}

/// Catch per pigment -> catch: times p, or for the `narrowed` reading over its own peak.
#[inline(always)]
fn finish_catch(peaks: &[[f32; 4]], p: &[f32], catch: &mut [f32]) {
    if peaks.is_empty() {
        for (catch, p) in catch.iter_mut().zip(p) {
            *catch *= p;
        }
        return;
    }
    let mut greatest = [0.0f32; TILE];
    for h in peaks {
        for (greatest, p) in greatest.iter_mut().zip(p) {
            let peak = h[0] + p * (h[1] + p * (h[2] + p * h[3]));
            *greatest = if peak > *greatest { peak } else { *greatest };
        }
    }
    for (catch, peak) in catch.iter_mut().zip(&greatest) {
        *catch /= peak;
    }
}

/// The catch of a whole pigment is a level itself.
#[inline(always)]
fn choose(p: &[f32], whole: &[f32], catch: &mut [f32]) {
    for ((catch, &p), &whole) in catch.iter_mut().zip(p).zip(whole) {
        *catch = either(p == 1.0, whole, *catch);
    }
}

/// One of two numbers, by their bits: a choice of places in memory would not vectorise.
#[inline(always)]
fn either(first: bool, a: f32, b: f32) -> f32 {
    let mask = 0u32.wrapping_sub(u32::from(first));
    f32::from_bits((a.to_bits() & mask) | (b.to_bits() & !mask))
}

#[inline(always)]
fn apply(row: &[f32; 3], lms: &[[f32; TILE]; 3], out: &mut [f32]) {
    for (((out, l), m), s) in out.iter_mut().zip(&lms[0]).zip(&lms[1]).zip(&lms[2]) {
        *out = row[0] * l + row[1] * m + row[2] * s;
    }
}

#[inline(always)]
fn keep_where_unbleached(p: &[[f32; TILE]; 3], light: &[f32], seen: &mut [f32]) {
    for ((((seen, &light), &l), &m), &s) in seen.iter_mut().zip(light).zip(&p[0]).zip(&p[1]).zip(&p[2]) {
        let unbleached = (l == 1.0) & (m == 1.0) & (s == 1.0);
        *seen = either(unbleached, light, *seen);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::{Narrowing, Observer};
    use crate::light::{Planes, Primaries, Samples};
    use crate::spectrum::Bands;
    use crate::units::Nits;

    const FRACTIONS: [[f64; 3]; 5] =
        [[0.9, 0.8, 0.7], [1e-6, 1e-5, 0.5], [1.0, 0.3, 1.0], [0.999_999, 1.0, 1.0], [1.0, 1.0, 1.0]];

    fn seen(form: &PerceptForm, planes: &[f32], p: [f64; 3]) -> [f32; 3] {
        let mut seen = [0.0; 3];
        let [r, g, b] = &mut seen;
        let out = [r, g, b].map(std::slice::from_mut);
        percept(form, Strip::whole(planes, 1), p.each_ref().map(std::slice::from_ref), out);
        seen
    }

    fn agrees(vision: &Vision, light: &[f32]) {
        let form = PerceptForm::new(vision);
        let planes = Planes { width: 1, height: 1, count: light.len(), samples: Samples::Float(light.to_vec()) };
        let moments = vision.moments(&planes, 0, 0);
        for p in FRACTIONS {
            let ours = seen(&form, light, p);
            let exact = crate::colour::apply(&vision.lms_to_seen, vision.catch(&moments, p));
            let size = exact.iter().fold(0.0f64, |a, v| a.max(v.abs()));
            for (ours, exact) in ours.iter().zip(exact) {
                assert!((f64::from(*ours) - exact).abs() < 1e-5 * size, "{p:?}: {ours:?} {exact:?}");
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
            agrees(&Vision::of_rgb(observer, &Primaries::REC709, Nits(100.0)).unwrap(), &[0.7, 0.2, 0.05]);
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
            let work = Percept { form: &form, light: Strip::whole(&light, 201), p, seen: [r, g, b] };
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
