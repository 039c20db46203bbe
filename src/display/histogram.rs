//! Counts of a frame's cells over ln luminance.

use super::ToneMap;
use crate::light::Survey;

/// Number of bins.
pub(super) const BINS: usize = 100;

/// Share of the display's range, in ln, that is given to the world's range evenly, whatever cells
/// it holds: a small lamp is told from the white wall beside it.
const EVEN: f64 = 0.05;

/// Bins on either side that a pass of smoothing takes in.
const REACH: usize = 3;

/// Counts of cells over ln luminance.
#[derive(Clone, Debug)]
pub(super) struct Histogram {
    pub(super) bottom: f64,
    pub(super) bin: f64,
    pub(super) counts: Vec<f64>,
    /// Share of the total below each bin's lower edge, and 1.
    below: Vec<f64>,
}

impl Histogram {
    /// Counts the cells between the least and the greatest pixel. The range is lengthened downward
    /// by one bin, which gets half of what its neighbour holds, so that the darkest things are not
    /// black.
    pub(super) fn new(survey: &Survey, passes: usize) -> Self {
        let (least, top) = ln_range(survey);
        let bin = (top - least) / (BINS - 1) as f64;
        let bottom = least - bin;
        let mut counts = vec![0.0; BINS];
        for ln in ln_cells(survey) {
            // A cell as dark as the least pixel belongs above the edge that it lies on.
            counts[(((ln - bottom) / bin + 1e-9) as usize).min(BINS - 1)] += 1.0;
        }
        (0..passes).for_each(|_| counts = [&counts[..1], &smoothed(&counts[1..])].concat());
        counts[1] /= 2.0;
        counts[0] += counts[1];
        Histogram { bottom, bin, counts: Vec::new(), below: Vec::new() }.with(counts)
    }

    /// The same bins with other counts.
    pub(super) fn with(&self, counts: Vec<f64>) -> Self {
        let total: f64 = counts.iter().sum();
        let sums = counts.iter().scan(0.0, |sum, f| {
            *sum += (1.0 - EVEN) * f / total + EVEN / BINS as f64;
            Some(sum.min(1.0))
        });
        let below = std::iter::once(0.0).chain(sums).collect();
        Histogram { bottom: self.bottom, bin: self.bin, counts, below }
    }

    pub(super) fn total(&self) -> f64 {
        self.counts.iter().sum()
    }

    /// Share of the cells below a ln luminance that is not below the bottom.
    pub(super) fn share_below(&self, ln_world: f64) -> f64 {
        let at = (ln_world - self.bottom) / self.bin;
        let i = at as usize;
        if i >= BINS {
            1.0
        } else {
            self.below[i] + (self.below[i + 1] - self.below[i]) * (at - i as f64)
        }
    }
}

/// Counts spread evenly over their neighbours within [`REACH`]; none is lost at the ends.
fn smoothed(counts: &[f64]) -> Vec<f64> {
    let last = counts.len() as i64 - 1;
    let mut spread = vec![0.0; counts.len()];
    for (i, count) in counts.iter().enumerate() {
        for offset in -(REACH as i64)..=REACH as i64 {
            let at = i as i64 + offset;
            let inside = if at < 0 {
                -1 - at
            } else if at > last {
                2 * last + 1 - at
            } else {
                at
            };
            spread[inside as usize] += count / (2 * REACH + 1) as f64;
        }
    }
    spread
}

/// ln of the least and the greatest pixel, within what a map can hold.
pub(super) fn ln_range(survey: &Survey) -> (f64, f64) {
    let ln = |pixel: f32| f64::from(pixel).clamp(ToneMap::LEAST, ToneMap::GREATEST).ln();
    (ln(survey.least), ln(survey.greatest))
}

/// ln luminance of all cells that give light, within the range of the pixels.
pub(super) fn ln_cells(survey: &Survey) -> impl Iterator<Item = f64> + '_ {
    let (least, greatest) = ln_range(survey);
    survey
        .cells
        .iter()
        .filter(|&&cell| cell > 0.0)
        .map(move |&cell| f64::from(cell).ln().clamp(least, greatest))
}
