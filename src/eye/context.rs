//! What the rows of one look share, and the small steps that every row takes.

use rayon::prelude::*;

use super::beyond::Around;
use super::illuminance::IlluminanceOperator;
use super::pigment::PigmentStep;
use super::plan::rule::Rule;
use super::stats::LookStats;
use crate::kernel::{self, TileScratch};
use crate::light::{Planes, Sample, Samples};

/// What the rows of one look share.
pub(super) struct LookContext<'a> {
    /// Light on the retina.
    pub(crate) retinal: &'a Planes,
    /// Light that is seen, if it is not the same.
    pub(crate) shown: Option<&'a Planes>,
    /// Whether the percept is of halves, as the frame is.
    pub(crate) half: bool,
    /// How far the gaze has moved from the first, in pixels.
    pub(crate) shift: [f64; 2],
    pub(crate) step: PigmentStep,
    pub(crate) rule: Rule,
    /// Cone illuminance around the picture, td.
    pub(crate) around: Around<'a, f32>,
}

impl LookContext<'_> {
    /// The greatest cone illuminance around the picture, td.
    pub(super) fn greatest_around(&self) -> [f32; 3] {
        match self.around {
            Around::Alike(td) => td,
            Around::Grid(td) => td.greatest(),
        }
    }
}

/// Cone illuminance of a whole frame: rows of L, M and S, td.
pub(super) fn illuminate(
    planes: &Planes,
    operator: &IlluminanceOperator,
    td: &mut [f32],
) -> LookStats {
    let rows = td.par_chunks_exact_mut(3 * planes.width).enumerate();
    let of_row = rows.map_init(TileScratch::new, |scratch, (y, td)| {
        for (from, width) in operator.tiles(planes.width) {
            let light = operator.light(planes.row(y), from, width, &mut scratch.light);
            let out = thirds(td).map(|td| &mut td[from..from + width]);
            operator.illuminance(light, [from, y], out);
        }
        LookStats::of_light(thirds(td).map(|td| kernel::greatest(td)))
    });
    of_row.reduce(|| LookStats::EMPTY, LookStats::and)
}

/// The three runs of a row: L, M, S or R, G, B.
pub(super) fn thirds<T>(row: &mut [T]) -> [&mut [T]; 3] {
    let width = row.len() / 3;
    let (first, rest) = row.split_at_mut(width);
    let (second, third) = rest.split_at_mut(width);
    [first, second, third]
}

/// Stores a tile of the percept; returns how many samples had to be limited.
pub(super) fn write_percept<T: Sample>(rgb: [&[f32]; 3], row: &mut [T], from: usize) -> u64 {
    let planes = rgb.into_iter().zip(thirds(row));
    planes.map(|(rgb, out)| T::store(rgb, &mut out[from..from + rgb.len()])).sum()
}

/// Planes for a percept: recycled ones where they fit.
pub(super) fn canvas(recycled: Option<Planes>, like: &Planes, half: bool) -> Planes {
    let fits = |old: &Planes| {
        (old.width, old.height, old.count) == (like.width, like.height, 3)
            && matches!(old.samples, Samples::Half(_)) == half
    };
    let new = if half { Planes::half } else { Planes::float };
    recycled.filter(fits).unwrap_or_else(|| new(like.width, like.height, 3))
}
