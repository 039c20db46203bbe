//! The certificate: a bound on the relative error of the pyramid's kernel, by enumeration.
//!
//! Every Gaussian's kernel in the pyramid is a product A(x, x') A(y, y') that repeats with period
//! 2^level. So its distance from the Gaussian, e(d) = max over phases of |A - g|, is a finite table
//! of one dimension, and in two
//!
//! ```text
//! |K - S| <= sum_j w_j (e_j(dx) g_j(dy) + g_j(dx) e_j(dy) + e_j(dx) e_j(dy)) + quartic r^4
//! ```
//!
//! The certificate is the largest ratio of this sum to S over all offsets in the picture.

use super::gaussians::{Gaussians, Node, sampled};
use super::levels::{BINOMIAL, Depth, HALF, Placed};

/// Levels above this one have this one's table, stretched: the kernels converge like 4^(-level).
const SETTLED: usize = 5;

/// Offsets up to this are all looked at, wider ones in steps of [`RATIO`].
const DENSE: usize = 32;
const RATIO: f64 = 1.08;

/// Samples of one dimension that begin at a whole number.
struct Run {
    start: i64,
    values: Vec<f64>,
}

impl Run {
    fn at(&self, i: i64) -> f64 {
        usize::try_from(i - self.start)
            .ok()
            .and_then(|i| self.values.get(i))
            .copied()
            .unwrap_or(0.0)
    }

    fn end(&self) -> i64 {
        self.start + self.values.len() as i64
    }

    fn over(start: i64, end: i64, value: impl Fn(i64) -> f64) -> Run {
        Run { start, values: (start..end).map(value).collect() }
    }

    fn reduced(&self) -> Run {
        let value = |i: i64| {
            (-HALF..=HALF).map(|k| BINOMIAL[k.unsigned_abs() as usize] * self.at(2 * i + k)).sum()
        };
        Run::over((self.start - HALF).div_euclid(2), (self.end() + HALF).div_euclid(2) + 1, value)
    }

    fn expanded(&self) -> Run {
        let taps = |f: i64| (-HALF..=HALF).filter(move |k| (f - k) % 2 == 0);
        let value = |f: i64| {
            taps(f).map(|k| 2.0 * BINOMIAL[k.unsigned_abs() as usize] * self.at((f - k) / 2)).sum()
        };
        Run::over(2 * self.start - HALF, 2 * self.end() + HALF, value)
    }

    /// Through taps that are given from the middle on.
    fn blurred(&self, taps: &[f64]) -> Run {
        let radius = taps.len() as i64 - 1;
        let value = |i: i64| {
            (-radius..=radius).map(|k| taps[k.unsigned_abs() as usize] * self.at(i + k)).sum()
        };
        Run::over(self.start - radius, self.end() + radius, value)
    }
}

/// The largest |A - g| over phases for every distance in pixels, as far as the kernel reaches.
fn table(placed: &Placed, sigma: f64) -> Vec<f64> {
    let mut errors: Vec<f64> = Vec::new();
    for phase in 0..1i64 << placed.level {
        let mut run = Run { start: phase, values: vec![1.0] };
        (0..placed.level).for_each(|_| run = run.reduced());
        run = run.blurred(&placed.taps);
        (0..placed.level).for_each(|_| run = run.expanded());
        for at in run.start..run.end() {
            let distance = (at - phase).unsigned_abs() as usize;
            errors.resize(errors.len().max(distance + 1), 0.0);
            errors[distance] =
                errors[distance].max((run.at(at) - sampled(sigma, distance as f64)).abs());
        }
    }
    errors
}

/// Errors and values of one node at the offsets that are looked at.
struct Profile {
    weight: f64,
    errors: Vec<f64>,
    values: Vec<f64>,
}

impl Profile {
    fn new(node: &Node, depth: &Depth, offsets: &[usize]) -> Profile {
        let level = depth.level(node.sigma);
        let stretch = (1u64 << (level - level.min(SETTLED))) as f64;
        let sigma = node.sigma / stretch;
        let table = table(&Placed::new(sigma, level.min(SETTLED), depth.reach), sigma);
        let error = |from: usize, to: usize| {
            let (from, to) =
                ((from as f64 / stretch) as usize, (to as f64 / stretch).ceil() as usize);
            let within = table[from.min(table.len())..to.min(table.len())]
                .iter()
                .copied()
                .fold(0.0, f64::max);
            let beyond =
                if to > table.len() { sampled(sigma, from.max(table.len()) as f64) } else { 0.0 };
            within.max(beyond) / stretch
        };
        Profile {
            weight: node.weight,
            errors: offsets.windows(2).map(|pair| error(pair[0], pair[1])).collect(),
            values: offsets.iter().map(|d| sampled(sigma, *d as f64 / stretch) / stretch).collect(),
        }
    }
}

/// Offsets to look at in a picture, with an end.
fn offsets(longest: usize) -> Vec<usize> {
    let mut offsets: Vec<usize> = (0..=DENSE.min(longest)).collect();
    while let Some(&last) = offsets.last().filter(|last| **last < longest) {
        offsets.push((RATIO * last as f64).ceil() as usize);
    }
    offsets
}

/// The largest relative error of the kernel at this depth, at any offset in a picture of this size.
pub(super) fn certificate(sum: &Gaussians, depth: &Depth, [width, height]: [usize; 2]) -> f64 {
    let offsets = offsets(width.max(height));
    let profiles: Vec<Profile> =
        sum.nodes.iter().map(|node| Profile::new(node, depth, &offsets)).collect();
    let mut worst = 0.0f64;
    for i in 0..offsets.len() - 1 {
        for j in 0..=i {
            worst = worst.max(relative(sum, &profiles, &offsets, [i, j]));
        }
    }
    worst
}

fn relative(sum: &Gaussians, profiles: &[Profile], offsets: &[usize], [i, j]: [usize; 2]) -> f64 {
    let r2 = (offsets[i].pow(2) + offsets[j].pow(2)) as f64;
    let (mut error, mut value) = (sum.quartic * r2 * r2, sum.constant + sum.quadratic * r2);
    for Profile { weight, errors, values } in profiles {
        let ([ex, ey], [gx, gy]) = ([errors[i], errors[j]], [values[i], values[j]]);
        error += weight * (ex * gy + gx * ey + ex * ey);
        value += weight * gx * gy;
    }
    error / value
}
