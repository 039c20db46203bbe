//! Reading a run between its samples, by straight lines: along a row, then from row to row.

use pulp::{Simd, WithSimd};

use super::vectorised;

/// A number between two others; exactly theirs where they are equal.
pub(crate) trait Between: Copy {
    /// The number at `t`, 0 to 1, of the way to `other`.
    fn between(self, other: Self, t: f64) -> Self;
}

impl Between for f32 {
    #[inline(always)]
    fn between(self, other: f32, t: f64) -> f32 {
        self + t as f32 * (other - self)
    }
}

impl Between for f64 {
    #[inline(always)]
    fn between(self, other: f64, t: f64) -> f64 {
        self + t * (other - self)
    }
}

/// What lies between the samples of two rows: every place at the share `u` of the way to the next
/// sample, and `v` of the way from the row `above` to that `below`. Rows are as long as `out`, and
/// one sample longer where `u` is not 0.
pub(crate) fn between<T: Between>(above: &[T], below: &[T], [u, v]: [f64; 2], out: &mut [T]) {
    let length = out.len();
    let (above, below) = (&above[..length + usize::from(u > 0.0)], below);
    match (u > 0.0, v > 0.0) {
        (false, false) => out.copy_from_slice(above),
        (false, true) => vectorised(Run { from: above, to: &below[..length], t: v, out }),
        (true, false) => vectorised(Run { from: above, to: &above[1..], t: u, out }),
        (true, true) => vectorised(Rows { above, below: &below[..=length], u, v, out }),
    }
}

/// Straight lines through samples that lie `apart` places from each other. The first place of `out`
/// is `offset` places behind the first sample, less than `apart`; the last is not behind the last.
pub(crate) fn ramps<T: Between>(samples: &[T], apart: usize, offset: f64, out: &mut [T]) {
    vectorised(Ramps { samples, apart, offset, out });
}

/// Each of a run's numbers on its way to that of another run.
struct Run<'a, T> {
    from: &'a [T],
    to: &'a [T],
    t: f64,
    out: &'a mut [T],
}

impl<T: Between> WithSimd for Run<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        for ((out, &from), &to) in self.out.iter_mut().zip(self.from).zip(self.to) {
            *out = from.between(to, self.t);
        }
    }
}

struct Rows<'a, T> {
    above: &'a [T],
    below: &'a [T],
    u: f64,
    v: f64,
    out: &'a mut [T],
}

impl<T: Between> WithSimd for Rows<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Rows { above, below, u, v, out } = self;
        let above = above.iter().zip(&above[1..]);
        let below = below.iter().zip(&below[1..]);
        for ((out, (a, b)), (c, d)) in out.iter_mut().zip(above).zip(below) {
            *out = a.between(*b, u).between(c.between(*d, u), v);
        }
    }
}

struct Ramps<'a, T> {
    samples: &'a [T],
    apart: usize,
    offset: f64,
    out: &'a mut [T],
}

impl<T: Between> WithSimd for Ramps<'_, T> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) {
        let Ramps { samples, apart, offset, out } = self;
        let step = 1.0 / apart as f64;
        let before = ((apart as f64 - offset).ceil() as usize).min(out.len());
        let (head, rest) = out.split_at_mut(before);
        ramp(samples, offset, step, head);
        let offset = offset + before as f64 - apart as f64;
        for (out, samples) in rest.chunks_mut(apart).zip(samples[1..].windows(2)) {
            ramp(samples, offset, step, out);
        }
    }
}

/// The line between the first two samples.
#[inline(always)]
fn ramp<T: Between>(samples: &[T], offset: f64, step: f64, out: &mut [T]) {
    let (from, to) = (samples[0], samples[1]);
    for (i, out) in (0i32..).zip(out) {
        *out = from.between(to, ((offset + f64::from(i)) * step).min(1.0));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let numbers =
            |scale: f64| (0..100).map(|i| (scale * f64::from(i)).sin()).collect::<Vec<f64>>();
        let (above, below) = (numbers(0.3), numbers(0.7));
        let (mut best, mut plain) = (vec![0.0; 99], vec![0.0; 99]);
        let [u, v] = [0.3, 0.6];
        between(&above, &below, [u, v], &mut best);
        let out = &mut plain;
        Rows { above: &above, below: &below, u, v, out }.with_simd(pulp::Scalar);
        assert_eq!(best, plain);
        between(&above, &below, [0.0, v], &mut best);
        Run { from: &above, to: &below, t: v, out: &mut plain }.with_simd(pulp::Scalar);
        assert_eq!(best, plain);
        ramps(&above, 16, 2.7, &mut best);
        let out = &mut plain;
        Ramps { samples: &above, apart: 16, offset: 2.7, out }.with_simd(pulp::Scalar);
        assert_eq!(best, plain);
        let t: f64 = (2.7 + 50.0) / 16.0;
        let expected = above[3].between(above[4], t - 3.0);
        assert!((best[50] - expected).abs() < 1e-14);
    }
}
