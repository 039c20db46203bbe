//! Reading a run between its samples, by straight lines: along a row, then from row to row.

use pulp::{Simd, WithSimd};

use super::vectorised;

/// A number between two others; exactly theirs where they are equal.
pub trait Between: Copy {
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

struct Run<'a, T> {
    from: &'a [T],
    to: &'a [T],
    t: f64,
    out: &'a mut [T],
}

/// Each of a run's numbers on its way to that of another run: `out` is between `from` and `to`.
pub fn between<T: Between>(from: &[T], to: &[T], t: f64, out: &mut [T]) {
    vectorised(Run { from, to, t, out });
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_instruction_set_gives_the_same_bits() {
        let numbers =
            |scale: f64| (0..99).map(|i| (scale * f64::from(i)).sin()).collect::<Vec<f64>>();
        let (from, to) = (numbers(0.3), numbers(0.7));
        let (mut best, mut plain) = (vec![0.0; 99], vec![0.0; 99]);
        between(&from, &to, 0.3, &mut best);
        Run { from: &from, to: &to, t: 0.3, out: &mut plain }.with_simd(pulp::Scalar);
        assert_eq!(best, plain);
    }
}
