//! What every place of a picture sends every other: k0 + k2 r^2, from four sums of the picture.
//!
//! ```text
//! sum_x' (k0 + k2 |x - x'|^2) s(x') = k0 S0 + k2 (|x|^2 S0 - 2 x . S1 + S2)
//! ```
//!
//! It is done on the coarsest level. The binomial filter keeps polynomials up to the fifth degree
//! but for its variance, which r^2 gains on each axis, on the way up and on the way down.

use super::gaussians::Gaussians;
use super::levels::VARIANCE;
use super::shape::{MARGIN, Shape};

/// The kernel on the coarsest level, distances in pixels of the picture.
#[derive(Clone, Copy, Debug)]
pub(super) struct Whole {
    constant: f64,
    quadratic: f64,
    /// Pixels of the picture to one of the level, on each axis.
    scale: f64,
}

impl Whole {
    pub(super) fn new(sum: &Gaussians, level: usize) -> Whole {
        let scale = 2f64.powi(level as i32);
        let gained = 4.0 * VARIANCE * (scale * scale - 1.0) / 3.0;
        Whole { constant: sum.constant - sum.quadratic * gained, quadratic: sum.quadratic, scale }
    }

    /// The polynomials of all planes.
    pub(super) fn over(&self, light: &[f32], shape: &Shape) -> Polynomials {
        let mut sums = vec![[0.0f64; 4]; shape.count];
        for (row, light) in light.chunks_exact(shape.stride).enumerate() {
            for (sums, light) in sums.iter_mut().zip(light.chunks_exact(shape.plane)) {
                for (column, &light) in light.iter().enumerate() {
                    let ([x, y], light) = (self.place(column, row), f64::from(light));
                    let terms = [1.0, x, y, x * x + y * y];
                    sums.iter_mut().zip(terms).for_each(|(sum, term)| *sum += light * term);
                }
            }
        }
        // A reduced picture has a quarter of the sum.
        let back = self.scale * self.scale;
        sums.iter_mut().flatten().for_each(|sum| *sum *= back);
        Polynomials { whole: *self, sums }
    }

    fn place(&self, column: usize, row: usize) -> [f64; 2] {
        [column, row].map(|i| self.scale * (i as f64 - MARGIN as f64))
    }
}

/// What every place gets from the whole picture, plane by plane.
pub(super) struct Polynomials {
    whole: Whole,
    sums: Vec<[f64; 4]>,
}

impl Polynomials {
    /// Adds it to rows of the level; the first is `row`, counted from the margin.
    pub(super) fn add(&self, row: usize, shape: &Shape, out: &mut [f32]) {
        let Whole { constant, quadratic, .. } = self.whole;
        for (i, out) in out.chunks_exact_mut(shape.stride).enumerate() {
            for (&[s0, sx, sy, s2], out) in self.sums.iter().zip(out.chunks_exact_mut(shape.plane))
            {
                for (column, out) in out.iter_mut().enumerate() {
                    let [x, y] = self.whole.place(column, row + i);
                    let square = (x * x + y * y) * s0 - 2.0 * (x * sx + y * sy) + s2;
                    *out += (constant * s0 + quadratic * square) as f32;
                }
            }
        }
    }
}
