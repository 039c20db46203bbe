//! Weighted sums over the bands of a spectral row: a small matrix times every place's spectrum.
//!
//! Written out in vectors, because a sum over thirty runs that lie a row apart is read from memory as fast as it is
//! asked for, and no faster. Bands are added in their order; products and sums are not contracted.

use pulp::{Simd, WithSimd};

use super::{Strip, ask_for, vectorised};

/// Sums that are carried at once: five and the light, twice, fill the registers of the smaller processors.
const GROUP: usize = 5;

/// How far ahead a run is asked for, in samples.
const AHEAD: usize = 96;

/// The weights of some sums over bands.
#[derive(Clone, Debug, PartialEq)]
pub struct BandSums {
    rows: usize,
    /// Group after group: the weights of its sums in each band, in order of bands; zeros fill the last group.
    groups: Vec<Vec<[f32; GROUP]>>,
}

impl BandSums {
    /// Sums whose weights are the given rows, one weight a band.
    pub fn new(rows: &[Vec<f32>]) -> Self {
        let bands = rows.first().map_or(0, Vec::len);
        let group = |rows: &[Vec<f32>]| {
            let of_band = |band: usize| std::array::from_fn(|i| rows.get(i).map_or(0.0, |row| row[band]));
            (0..bands).map(of_band).collect()
        };
        BandSums { rows: rows.len(), groups: rows.chunks(GROUP).map(group).collect() }
    }

    /// How many sums.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// The sums of a run, each a run of `out`.
    pub fn project(&self, light: Strip<'_>, out: &mut [f32]) {
        vectorised(Project { sums: self, light, out });
    }
}

struct Project<'a> {
    sums: &'a BandSums,
    light: Strip<'a>,
    out: &'a mut [f32],
}

impl WithSimd for Project<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Project { sums, light, out } = self;
        let width = light.width();
        let pair = 2 * S::F32_LANES;
        // The last pair overlaps the one before: each place is summed alike wherever it stands in a vector.
        let last = width.saturating_sub(pair);
        let starts = (0..last).step_by(pair).chain((width >= pair).then_some(last));
        for at in starts {
            for (g, group) in sums.groups.iter().enumerate() {
                let totals = pair_of_vectors(simd, group, light, at, g == 0);
                for (row, total) in (g * GROUP..sums.rows).zip(totals) {
                    let out = &mut out[row * width + at..][..pair];
                    let (vectors, _) = S::as_mut_simd_f32s(out);
                    vectors.copy_from_slice(&total);
                }
            }
        }
        for at in 0..if width < pair { width } else { 0 } {
            for (g, group) in sums.groups.iter().enumerate() {
                for row in g * GROUP..sums.rows.min((g + 1) * GROUP) {
                    out[row * width + at] = one_place(group, light, at, row - g * GROUP);
                }
            }
        }
    }
}

#[inline(always)]
fn pair_of_vectors<S: Simd>(
    simd: S,
    group: &[[f32; GROUP]],
    light: Strip<'_>,
    at: usize,
    first: bool,
) -> [[S::f32s; 2]; GROUP] {
    let mut totals = [[simd.splat_f32s(0.0); 2]; GROUP];
    for (band, weights) in group.iter().enumerate() {
        let run = &light.plane(band)[at..][..2 * S::F32_LANES];
        if first {
            ask_for(run.as_ptr().wrapping_add(AHEAD));
            ask_for(run.as_ptr().wrapping_add(AHEAD + S::F32_LANES));
        }
        let (vectors, _) = S::as_simd_f32s(run);
        for i in 0..GROUP {
            let weight = simd.splat_f32s(weights[i]);
            for half in 0..2 {
                totals[i][half] = simd.add_f32s(totals[i][half], simd.mul_f32s(weight, vectors[half]));
            }
        }
    }
    totals
}

#[inline(always)]
fn one_place(group: &[[f32; GROUP]], light: Strip<'_>, at: usize, i: usize) -> f32 {
    let mut total = 0.0;
    for (band, weights) in group.iter().enumerate() {
        total += weights[i] * light.plane(band)[at];
    }
    total
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_place_gets_the_sum_of_its_own_bands_and_the_same_bits_on_every_processor() {
        let (bands, width) = (31, 77);
        let light: Vec<f32> = (0..bands * width).map(|i| ((i * 37) % 101) as f32 * 0.37).collect();
        let rows: Vec<Vec<f32>> =
            (0..7).map(|r| (0..bands).map(|b| ((r * 13 + b * 7) % 17) as f32 - 8.0).collect()).collect();
        let sums = BandSums::new(&rows);
        let (mut best, mut plain) = (vec![0.0; 7 * width], vec![0.0; 7 * width]);
        sums.project(Strip::whole(&light, width), &mut best);
        Project { sums: &sums, light: Strip::whole(&light, width), out: &mut plain }.with_simd(pulp::Scalar);
        assert_eq!(best, plain);
        for (row, weights) in rows.iter().enumerate() {
            for x in 0..width {
                let sum = weights.iter().enumerate().fold(0.0, |sum, (b, w)| sum + w * light[b * width + x]);
                assert_eq!(best[row * width + x], sum);
            }
        }
    }
}
