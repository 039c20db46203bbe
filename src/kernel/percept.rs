//! The percept of a row: catches through the pigments by the four levels, as cubics in p, then the picture's RGB.
//!
//!     R_k(p) = p (q0 + q1 p + q2 p^2 + q3 p^3),   q = V M,   seen = A R
//!
//! V turns values at the levels into powers of p. Where all three p are 1 the light itself is returned: RGB as it
//! came in, moments as their catch at p = 1.

use crate::colour::Matrix;
use crate::percept::{LEVELS, Vision, level_weights};

/// A vision's percept in the shape its loop wants.
#[derive(Clone, Debug)]
pub struct PerceptForm {
    /// Weight of each plane in the catch at each level: `[cone][level]`, planes.
    levels: [[Vec<f32>; 4]; 3],
    lms_to_seen: [[f32; 3]; 3],
    /// `[cone]`: cubics whose largest is the peak, lowest power first; empty for the `depleted` reading.
    peaks: [Vec<[f32; 4]>; 3],
    rgb: bool,
}

impl PerceptForm {
    /// The percept of a vision.
    pub fn new(vision: &Vision) -> Self {
        let to_powers = powers_of_levels();
        let power = |k: usize, l: usize| {
            let mut sum = vec![0.0; vision.moment_weights(0).len()];
            for (j, share) in to_powers[l].iter().enumerate() {
                for (total, w) in sum.iter_mut().zip(vision.moment_weights(k * LEVELS.len() + j)) {
                    *total += share * w;
                }
            }
            sum.into_iter().map(|w| w as f32).collect()
        };
        let cubic = |h: &[f64; 4]| to_powers.map(|row| row.iter().zip(h).map(|(v, h)| v * h).sum::<f64>() as f32);
        PerceptForm {
            levels: [0, 1, 2].map(|k| [0, 1, 2, 3].map(|l| power(k, l))),
            lms_to_seen: single(&vision.lms_to_seen),
            peaks: match vision.peaks() {
                None => [const { Vec::new() }; 3],
                Some(peaks) => [0, 1, 2].map(|k| peaks[k].iter().map(cubic).collect()),
            },
            rgb: vision.projection().is_none(),
        }
    }
}

fn single(m: &Matrix) -> [[f32; 3]; 3] {
    m.map(|row| row.map(|v| v as f32))
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

/// The percept of a row. `planes`: the light; `p`: unbleached fractions of L, M, S; `seen`: R, G, B.
pub fn percept(form: &PerceptForm, planes: &[f32], p: &[f64], seen: &mut [f32]) {
    let width = seen.len() / 3;
    for x in 0..width {
        let [pl, pm, ps] = [p[x], p[width + x], p[2 * width + x]];
        let rgb = if pl == 1.0 && pm == 1.0 && ps == 1.0 {
            unbleached(form, planes, width, x)
        } else {
            bleached(form, planes, width, x, [pl as f32, pm as f32, ps as f32])
        };
        for (i, v) in rgb.into_iter().enumerate() {
            seen[i * width + x] = v;
        }
    }
}

/// What an eye with all its pigment sees.
fn unbleached(form: &PerceptForm, planes: &[f32], width: usize, x: usize) -> [f32; 3] {
    if form.rgb {
        return [planes[x], planes[width + x], planes[2 * width + x]];
    }
    let lms = [0, 1, 2].map(|k| planes[(k * LEVELS.len() + 3) * width + x]);
    apply(&form.lms_to_seen, lms)
}

fn bleached(form: &PerceptForm, planes: &[f32], width: usize, x: usize, p: [f32; 3]) -> [f32; 3] {
    let lms = [0, 1, 2].map(|k| {
        let q = form.levels[k].each_ref().map(|weights| {
            let of_cone = if form.rgb { 0..weights.len() } else { k * LEVELS.len()..(k + 1) * LEVELS.len() };
            weights[of_cone.clone()].iter().zip(of_cone).map(|(w, i)| w * planes[i * width + x]).sum::<f32>()
        });
        let per_pigment = horner(q, p[k]);
        if form.peaks[k].is_empty() {
            p[k] * per_pigment
        } else {
            per_pigment / form.peaks[k].iter().map(|h| horner(*h, p[k])).fold(0.0, f32::max)
        }
    });
    apply(&form.lms_to_seen, lms)
}

fn horner(q: [f32; 4], p: f32) -> f32 {
    q[0] + p * (q[1] + p * (q[2] + p * q[3]))
}

fn apply(m: &[[f32; 3]; 3], v: [f32; 3]) -> [f32; 3] {
    m.map(|row| row[0] * v[0] + row[1] * v[1] + row[2] * v[2])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::Observer;
    use crate::light::{Planes, Primaries, Samples};
    use crate::units::Nits;

    #[test]
    fn the_row_agrees_with_the_scalar_percept() {
        let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(100.0)).unwrap();
        let form = PerceptForm::new(&vision);
        let light = [0.7f32, 0.2, 0.05];
        let planes = Planes { width: 1, height: 1, count: 3, samples: Samples::Float(light.to_vec()) };
        let moments = vision.moments(&planes, 0, 0);
        for p in [[0.9, 0.8, 0.7], [1e-6, 1e-5, 0.5], [1.0, 0.3, 1.0], [0.999_999, 1.0, 1.0]] {
            let mut seen = [0.0; 3];
            percept(&form, &light, &p, &mut seen);
            let exact = crate::colour::apply(&vision.lms_to_seen, vision.catch(&moments, p));
            let size = exact.iter().fold(0.0f64, |a, v| a.max(v.abs()));
            for (ours, exact) in seen.iter().zip(exact) {
                assert!((f64::from(*ours) - exact).abs() < 1e-5 * size, "{p:?}: {seen:?} {exact:?}");
            }
        }
    }

    #[test]
    fn an_unbleached_eye_returns_its_input_bit_for_bit() {
        let vision = Vision::of_rgb(Observer::standard(), &Primaries::REC709, Nits(3.7)).unwrap();
        let light = [0.1f32, -3.3e-7, 6.5e4];
        let mut seen = [0.0; 3];
        percept(&PerceptForm::new(&vision), &light, &[1.0; 3], &mut seen);
        assert_eq!(seen, light);
    }
}
