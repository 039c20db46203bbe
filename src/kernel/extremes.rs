//! The greatest light and the least pigment of a run, in lanes that the processor compares at once.

use pulp::{Simd, WithSimd};

use super::vectorised;

const LANES: usize = 16;

struct Greatest<'a>(&'a [f32]);
struct Least<'a, T>(&'a [T], T);

/// The greatest of a run of illuminances; 0 for none.
pub(crate) fn greatest(run: &[f32]) -> f32 {
    vectorised(Greatest(run))
}

/// The least of a run of fractions; infinity for none.
pub(crate) fn least(run: &[f64]) -> f64 {
    vectorised(Least(run, f64::INFINITY))
}

impl WithSimd for Greatest<'_> {
    type Output = f32;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> f32 {
        greatest_of(self.0)
    }
}

#[inline(always)]
pub(super) fn greatest_of(run: &[f32]) -> f32 {
    let mut lanes = [0.0f32; LANES];
    let (whole, rest) = run.as_chunks::<LANES>();
    for chunk in whole {
        for i in 0..LANES {
            lanes[i] = if chunk[i] > lanes[i] { chunk[i] } else { lanes[i] };
        }
    }
    let mut greatest = 0.0;
    for &v in lanes.iter().chain(rest) {
        greatest = if v > greatest { v } else { greatest };
    }
    greatest
}

impl<T: Copy + PartialOrd> WithSimd for Least<'_, T> {
    type Output = T;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> T {
        let Least(run, most) = self;
        let mut lanes = [most; LANES];
        let (whole, rest) = run.as_chunks::<LANES>();
        for chunk in whole {
            for i in 0..LANES {
                lanes[i] = if chunk[i] < lanes[i] { chunk[i] } else { lanes[i] };
            }
        }
        let mut least = most;
        for &v in lanes.iter().chain(rest) {
            least = if v < least { v } else { least };
        }
        least
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn extremes_are_found_wherever_they_lie() {
        for n in [1, 15, 16, 17, 100] {
            for at in [0, n / 2, n - 1] {
                let light: Vec<f32> =
                    (0..n).map(|i| if i == at { 7.0 } else { i as f32 / n as f32 }).collect();
                let pigment: Vec<f64> =
                    (0..n).map(|i| if i == at { 0.1 } else { 0.5 + i as f64 }).collect();
                assert_eq!((greatest(&light), least(&pigment)), (7.0, 0.1));
            }
        }
        assert_eq!((greatest(&[]), least(&[])), (0.0, f64::INFINITY));
    }
}
