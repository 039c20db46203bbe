//! The veil beyond the picture: what the picture's light sends to places around it.
//!
//! ```text
//! r = L (1 - c) + K s,   L = the light beyond the picture, c = K 1 from the picture's places
//! ```
//!
//! The veil is smooth away from its sources, so coarse cells do: the picture's light is taken from a
//! level of its pyramid that has at most [`CELLS`] cells across, and spread over a canvas as wide
//! as three pictures by a pyramid of its own. At the border r goes on where the picture's own veil
//! ends. Within about two cells of the border it is as coarse as they are; no certificate holds
//! there, for what shines beyond a picture is not known either.

use super::gaussians::{Gaussians, Node};
use super::pyramid::{Pyramid, ones};
use super::shape::MARGIN;
use super::{DEPTHS, Optics};
use crate::light::{Planes, Samples};

/// Most cells along the longer side of the picture.
const CELLS: usize = 96;

/// The narrowest Gaussian that leaves its cell, in cells.
const LEAVES: f64 = 0.25;

/// Where the cells of a canvas lie: cell `i` of an axis at pixel `cell (i - before[axis])` of the
/// picture.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Extent {
    /// Columns and rows of cells.
    pub(crate) size: [usize; 2],
    /// Pixels from cell to cell.
    pub(crate) cell: usize,
    /// Cells before the picture's first pixel.
    pub(crate) before: [usize; 2],
}

impl Extent {
    /// The canvas around pictures of this size whose pyramid has so many levels.
    pub(super) fn around(size: [usize; 2], levels: usize) -> Extent {
        let few = |level: &usize| size[0].max(size[1]).div_ceil(1 << level) <= CELLS;
        let level = (0..levels).find(few).unwrap_or(levels - 1);
        let cells = size.map(|n| n.div_ceil(1 << level));
        let before = cells.map(|n| n.max(MARGIN));
        let size = [0, 1].map(|i| cells[i] + 2 * before[i]);
        Extent { size, cell: 1 << level, before }
    }
}

/// The canvas around pictures of one size.
#[derive(Clone, Debug)]
pub(crate) struct VeilAround {
    extent: Extent,
    level: usize,
    pyramid: Pyramid,
    /// The share of the light beyond that a place still has: 1 - c, cell by cell.
    kept: Vec<f32>,
    light: Planes,
}

impl VeilAround {
    /// The canvas around the pictures of a stage.
    pub(super) fn new(optics: &Optics) -> VeilAround {
        let extent = optics.extent_around();
        let (size, level) = (extent.size, extent.cell.trailing_zeros() as usize);
        let sum = coarser(&optics.sum, extent.cell as f64);
        let of = |count| Pyramid::new(&sum, &DEPTHS[0], size, count);
        let mut alone = VeilAround {
            extent,
            level,
            pyramid: of(1),
            kept: Vec::new(),
            light: Planes::float(size[0], size[1], 1),
        };
        let mut picture = Pyramid::new(&optics.sum, &optics.depth, optics.size, 1);
        picture.climb(&ones(optics.size[0], optics.size[1]));
        let mut covered = vec![0.0; size[0] * size[1]];
        alone.spread(&picture, &mut covered);
        let kept = covered.into_iter().map(|c| (1.0 - c).max(0.0)).collect();
        let count = optics.pyramid.count();
        let light = Planes::float(size[0], size[1], count);
        VeilAround { pyramid: of(count), kept, light, ..alone }
    }

    /// Whether it is for so many planes.
    pub(super) fn is_for(&self, count: usize) -> bool {
        self.light.count == count
    }

    /// The light of every cell, as if none were the picture's own. `beyond`: the light around the
    /// picture, plane by plane.
    pub(super) fn follow(&mut self, picture: &Pyramid, beyond: &[f32], out: &mut Planes) {
        let ([width, height], count) = (self.extent.size, picture.count());
        let samples = out.floats(width, height, count);
        self.spread(picture, samples);
        let rows = samples.chunks_exact_mut(count * width).zip(self.kept.chunks_exact(width));
        for (row, kept) in rows {
            for (row, beyond) in row.chunks_exact_mut(width).zip(beyond) {
                row.iter_mut().zip(kept).for_each(|(r, kept)| *r += beyond * kept);
            }
        }
    }

    /// The veil of a picture's light on every cell.
    fn spread(&mut self, picture: &Pyramid, out: &mut [f32]) {
        let Extent { size: [width, _], before, .. } = self.extent;
        let (shape, light) = picture.light(self.level);
        let Samples::Float(canvas) = &mut self.light.samples else { return };
        let first = before.map(|n| n - MARGIN);
        let rows = canvas.chunks_exact_mut(width * shape.count).skip(first[1]);
        for (row, light) in rows.zip(light.chunks_exact(shape.stride)) {
            for (row, light) in row.chunks_exact_mut(width).zip(light.chunks_exact(shape.plane)) {
                let run = shape.width + 2 * MARGIN;
                row[first[0]..][..run].copy_from_slice(&light[..run]);
            }
        }
        self.pyramid.veil(&self.light, out);
    }
}

/// The sum of Gaussians in cells of so many pixels. What stays in its cell is left out.
fn coarser(sum: &Gaussians, cell: f64) -> Gaussians {
    let nodes = sum.nodes.iter().map(|n| Node { sigma: n.sigma / cell, ..*n });
    Gaussians {
        nodes: nodes.filter(|n| n.sigma >= LEAVES).collect(),
        constant: sum.constant * cell.powi(2),
        quadratic: sum.quadratic * cell.powi(4),
        quartic: sum.quartic * cell.powi(6),
    }
}
