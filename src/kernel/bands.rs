//! Weighted sums over the bands of a spectral row: a small matrix times every place's spectrum.
//!
//! Written out in vectors, because a sum over thirty runs that lie a row apart is read from memory
//! as fast as it is asked for, and no faster. Bands are added in their order; products and sums are
//! not contracted.

use pulp::{Simd, WithSimd};

use super::{prefetch, vectorised};
use crate::light::PlaneTile;

/// Sums that are carried at once where there are 32 registers: they, the light and a product.
const GROUP: usize = 12;

/// Sums that are carried at once, over two vectors of light, where there are sixteen registers or
/// few sums are left.
const PART: usize = 6;

/// How far ahead a run is asked for, in samples.
const AHEAD: usize = 96;

/// The weights of some sums over bands.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BandSums {
    rows: usize,
    groups: Vec<Group>,
}

/// Weights of [`GROUP`] sums; zeros fill the last group.
#[derive(Clone, Debug, Default, PartialEq)]
struct Group {
    /// The first band that has a weight.
    first: usize,
    /// From there on, band after band, to the last that has one.
    weights: Vec<[f32; GROUP]>,
}

impl Group {
    fn set(&mut self, row: usize, band: usize, weight: f32) {
        if self.weights.is_empty() {
            self.first = band;
        }
        if band < self.first {
            let before = self.first - band;
            self.weights.splice(0..0, std::iter::repeat_n([0.0; GROUP], before));
            self.first = band;
        }
        let count = self.weights.len().max(band - self.first + 1);
        self.weights.resize(count, [0.0; GROUP]);
        self.weights[band - self.first][row] = weight;
    }

    fn covers(&self, band: usize) -> bool {
        (self.first..self.first + self.weights.len()).contains(&band)
    }

    fn weight(&self, row: usize, band: usize) -> f32 {
        let of_band = band.checked_sub(self.first).and_then(|i| self.weights.get(i));
        of_band.map_or(0.0, |weights| weights[row])
    }
}

impl BandSums {
    /// So many sums, all of them zero.
    pub(crate) fn new(rows: usize) -> Self {
        BandSums { rows, groups: vec![Group::default(); rows.div_ceil(GROUP)] }
    }

    /// Gives a sum its weights, one a band.
    pub(crate) fn set(&mut self, row: usize, weights: impl Iterator<Item = f32>) {
        weights.enumerate().for_each(|(band, weight)| self.put(row, band, weight));
    }

    /// Gives a sum its weight in a band.
    pub(crate) fn put(&mut self, row: usize, band: usize, weight: f32) {
        let group = &mut self.groups[row / GROUP];
        if weight != 0.0 || group.covers(band) {
            group.set(row % GROUP, band, weight);
        }
    }

    /// The sums that a band has a weight in, and it.
    pub(crate) fn of_band(&self, band: usize) -> impl Iterator<Item = (usize, f32)> + '_ {
        let groups = self.groups.iter().enumerate().filter(move |(_, group)| group.covers(band));
        groups.flat_map(move |(i, group)| {
            (0..GROUP).map(move |row| (GROUP * i + row, group.weight(row, band)))
        })
    }

    /// The weight of a sum in a band.
    pub(crate) fn weight(&self, row: usize, band: usize) -> f32 {
        self.groups[row / GROUP].weight(row % GROUP, band)
    }

    /// How many sums.
    pub(crate) fn rows(&self) -> usize {
        self.rows
    }

    /// The sums of a run, each a run of `out`.
    pub(crate) fn project(&self, light: PlaneTile<'_>, out: &mut [f32]) {
        vectorised(Project { sums: self, light, out });
    }
}

struct Project<'a> {
    sums: &'a BandSums,
    light: PlaneTile<'a>,
    out: &'a mut [f32],
}

impl WithSimd for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(mut self, simd: S) {
        let width = self.light.width();
        let pair = 2 * S::F32_LANES;
        if width < pair && S::F32_LANES > 1 {
            return self.with_simd(pulp::Scalar);
        }
        if width < pair {
            return (0..self.sums.rows)
                .step_by(PART)
                .for_each(|from| self.add::<S, PART, 1>(simd, from, 0));
        }
        // Pair after pair; the last one overlaps the one before: each place is summed alike
        // wherever it stands in a vector.
        for at in (0..width - pair).step_by(pair) {
            self.pair(simd, at);
        }
        self.pair(simd, width - pair);
    }
}

impl Project<'_> {
    /// All sums of two vectors of places, or of as many as there are.
    #[inline(always)]
    fn pair<S: Simd>(&mut self, simd: S, at: usize) {
        for from in (0..self.sums.rows).step_by(GROUP) {
            let rows = GROUP.min(self.sums.rows - from);
            if S::REGISTER_COUNT >= 32 && rows > PART {
                self.add::<S, GROUP, 1>(simd, from, at);
                self.add::<S, GROUP, 1>(simd, from, at + S::F32_LANES);
            } else {
                for part in (0..rows).step_by(PART) {
                    self.add::<S, PART, 2>(simd, from + part, at);
                }
            }
        }
    }

    /// `ROWS` sums from row `from` on, over `VECTORS` vectors of places.
    #[inline(always)]
    fn add<S: Simd, const ROWS: usize, const VECTORS: usize>(
        &mut self,
        simd: S,
        from: usize,
        at: usize,
    ) {
        let (group, first) = (&self.sums.groups[from / GROUP], from % GROUP);
        let ahead = self.light.ahead(at, AHEAD);
        let places = VECTORS * S::F32_LANES;
        let mut totals = [[simd.splat_f32s(0.0); VECTORS]; ROWS];
        for (band, weights) in (group.first..).zip(&group.weights) {
            let run = &self.light.plane(band)[at..][..places];
            if from == 0 {
                for i in 0..VECTORS {
                    prefetch(run.as_ptr().wrapping_add(ahead + i * S::F32_LANES));
                }
            }
            let light = S::as_simd_f32s(run).0;
            for (totals, &weight) in totals.iter_mut().zip(&weights[first..][..ROWS]) {
                for (total, &light) in totals.iter_mut().zip(light) {
                    *total = simd.add_f32s(*total, simd.mul_f32s(simd.splat_f32s(weight), light));
                }
            }
        }
        let width = self.light.width();
        for (row, totals) in (from..self.sums.rows).zip(totals) {
            let out = &mut self.out[row * width + at..][..places];
            S::as_mut_simd_f32s(out).0.copy_from_slice(&totals);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_gets_the_sum_of_its_own_bands_and_the_same_bits_on_every_processor() {
        let (bands, width) = (31, 77);
        let light: Vec<f32> = (0..bands * width).map(|i| ((i * 37) % 101) as f32 * 0.37).collect();
        let rows: Vec<Vec<f32>> = (0..7)
            .map(|r| (0..bands).map(|b| ((r * 13 + b * 7) % 17) as f32 - 8.0).collect())
            .collect();
        let mut sums = BandSums::new(7);
        rows.iter().enumerate().for_each(|(i, row)| sums.set(i, row.iter().copied()));
        let (mut best, mut plain) = (vec![0.0; 7 * width], vec![0.0; 7 * width]);
        sums.project(PlaneTile::whole(&light, width), &mut best);
        Project { sums: &sums, light: PlaneTile::whole(&light, width), out: &mut plain }
            .with_simd(pulp::Scalar);
        assert_eq!(best, plain);
        for (row, weights) in rows.iter().enumerate() {
            for x in 0..width {
                let sum = weights
                    .iter()
                    .enumerate()
                    .fold(0.0, |sum, (b, w)| sum + w * light[b * width + x]);
                assert_eq!(best[row * width + x], sum);
            }
        }
    }
}
