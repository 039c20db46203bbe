//! The retina: the unbleached fraction of three pigments at every place, moved by light.
//!
//! Places are counted in pixels of the picture at the first gaze. When the gaze has moved by
//! `shift` pixels, the place r sees the picture at r + shift. **Light is resampled to the places, p
//! is read at the picture's points; the state itself is never resampled**, which would blur it by
//! sqrt(n f (1 - f)) pixels after n frames. Places that no picture has covered yet have all seen
//! the same surround; they are kept as one, and become places of their own when the gaze first
//! brings the picture to them.
//!
//! Places off the picture are moved in every look too. Many steps under one light are one step of
//! their summed time, so they could wait; but while the gaze glides their light is never the same
//! twice: the pupil follows what the fovea sees, and the veil falls elsewhere on them. Nor is it
//! their pigment that costs: of 960 x 540 with scatter and a retina grown to three pictures, a look
//! takes 14 ms of processor time more than with a gaze that is held, 4 of them for the steps.

use ndarray::{Array3, ArrayView3, s};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::beyond::{Around, Grid};
use crate::eye::pigment::PigmentStep;
use crate::kernel::TILE;
use crate::optics::Extent;

/// Pigment at every place. Rows of three runs, L, M and S: shape (height, 3, width).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Retina {
    p: Vec<f64>,
    /// Columns and rows that are kept.
    size: [usize; 2],
    /// The first column and row that are kept, in places.
    origin: [i64; 2],
    /// Pigment wherever no picture has been.
    beyond: [f64; 3],
    /// The same cell by cell, in an eye that scatters light there.
    around: Option<Grid<f64>>,
}

impl Retina {
    /// Every pigment unbleached.
    pub fn rested(width: usize, height: usize) -> Self {
        Retina::uniform([width, height], [1.0; 3])
    }

    fn uniform(size: [usize; 2], beyond: [f64; 3]) -> Self {
        let mut p = Vec::with_capacity(3 * size[0] * size[1]);
        for k in (0..size[1]).flat_map(|_| 0..3) {
            p.resize(p.len() + size[0], beyond[k]);
        }
        Retina { p, size, origin: [0, 0], beyond, around: None }
    }

    /// A retina of given fractions, shape (height, 3, width), in standard layout; values outside
    /// 0..1 are limited.
    pub(crate) fn from_fractions(p: ArrayView3<f64>, beyond: [f64; 3]) -> Self {
        let (height, _, width) = p.dim();
        let p = p.iter().map(|v| v.clamp(0.0, 1.0)).collect();
        Retina { p, size: [width, height], origin: [0, 0], beyond, around: None }
    }

    /// Columns and rows that are kept.
    pub fn size(&self) -> [usize; 2] {
        self.size
    }

    /// The first column and row that are kept.
    pub fn origin(&self) -> [i64; 2] {
        self.origin
    }

    /// The same with cells of its own for what lies beyond the picture, if `extent` tells where.
    pub(super) fn with_cells(self, extent: Option<Extent>) -> Self {
        let around = extent.map(|extent| Grid::alike(extent, self.beyond));
        Retina { around, ..self }
    }

    /// The same without them.
    pub(super) fn forget_cells(&mut self) {
        self.around = None;
    }

    /// Whether what lies beyond the picture has these cells.
    pub(super) fn has_cells(&self, extent: Option<Extent>) -> bool {
        match (&self.around, extent) {
            (Some(around), Some(extent)) => around.is_of(extent),
            (around, extent) => around.is_none() && extent.is_none(),
        }
    }

    /// Where the cells beyond the picture lie.
    pub(super) fn extent(&self) -> Option<Extent> {
        self.around.as_ref().map(Grid::extent)
    }

    /// Pigment wherever there is no place of its own.
    pub(super) fn around(&self) -> Around<'_, f64> {
        self.around.as_ref().map_or(Around::Alike(self.beyond), Around::Grid)
    }

    /// Everything that is kept: rows of L, M, S.
    pub(crate) fn fractions(&self) -> &[f64] {
        &self.p
    }

    /// Whether every pigment is unbleached.
    pub(crate) fn is_rested(&self) -> bool {
        let cells = self.around.iter().flat_map(Grid::samples);
        self.p.iter().chain(&self.beyond).chain(cells).all(|&p| p == 1.0)
    }

    /// Whether it holds what it says: as many fractions as places, each within 0..1.
    pub(super) fn is_sound(&self) -> bool {
        let count = self.size[0].checked_mul(self.size[1]).and_then(|n| n.checked_mul(3));
        let mut all = self.p.iter().chain(&self.beyond);
        count == Some(self.p.len()) && all.all(|p| (0.0..=1.0).contains(p))
    }

    /// The picture's places at the first gaze, shape (height, 3, width).
    pub fn first_view(&self, width: usize, height: usize) -> Array3<f64> {
        let [x, y] = self.origin.map(|o| (-o).max(0) as usize);
        let shape = (self.size[1], 3, self.size[0]);
        let kept = ArrayView3::from_shape(shape, &self.p);
        kept.map_or_else(
            |_| Array3::ones((height, 3, width)),
            |kept| kept.slice(s![y..y + height, .., x..x + width]).to_owned(),
        )
    }

    /// Rows for parallel work, each three runs.
    pub(crate) fn par_rows_mut(&mut self) -> rayon::slice::ChunksExactMut<'_, f64> {
        let per_row = 3 * self.size[0].max(1);
        self.p.par_chunks_exact_mut(per_row)
    }

    /// Fractions at one place of the kept ones.
    pub fn at(&self, place: [i64; 2]) -> [f64; 3] {
        let [x, y] = [0, 1].map(|i| place[i] - self.origin[i]);
        let [width, height] = self.size();
        if x < 0 || y < 0 || x >= width as i64 || y >= height as i64 {
            return [0, 1, 2].map(|k| self.around().at(place.map(|v| v as f64), k));
        }
        [0, 1, 2].map(|k| self.p[(y as usize * 3 + k) * width + x as usize])
    }

    /// Makes places of their own of all that lie in the rectangle `from..=to`; they have seen only
    /// the surround. Where any is missing, the retina grows on that side by half of the rectangle
    /// at least, so that a wandering gaze seldom moves it. Columns are added on the left by whole
    /// tiles of `tile` places, so that none is cut anew. Returns how many tiles and rows were added
    /// before the old ones.
    pub fn cover(&mut self, from: [i64; 2], to: [i64; 2], tile: usize) -> [usize; 2] {
        let last = [0, 1].map(|i| self.origin[i] + self.size[i] as i64 - 1);
        let more = [0, 1].map(|i| (to[i] - from[i] + 2) / 2);
        let grown = |missing: i64, i: usize| if missing > 0 { missing.max(more[i]) } else { 0 };
        let before = [0, 1].map(|i| grown(self.origin[i] - from[i], i) as usize);
        let after = [0, 1].map(|i| grown(to[i] - last[i], i) as usize);
        let tiles = before[0].div_ceil(tile);
        let before = [tiles * tile, before[1]];
        if before != [0, 0] || after != [0, 0] {
            self.grow(before, after);
        }
        [tiles, before[1]]
    }

    fn grow(&mut self, before: [usize; 2], after: [usize; 2]) {
        let size = [0, 1].map(|i| before[i] + self.size[i] + after[i]);
        let mut grown = Retina::uniform(size, self.beyond);
        grown.origin = [0, 1].map(|i| self.origin[i] - before[i] as i64);
        if let Some(around) = self.around.take() {
            grown.join(&around);
            grown.around = Some(around);
        }
        let rows = grown.p.chunks_exact_mut(size[0]).skip(3 * before[1]);
        for (row, old) in rows.zip(self.p.chunks_exact(self.size[0])) {
            row[before[0]..][..self.size[0]].copy_from_slice(old);
        }
        *self = grown;
    }

    /// Gives every place the pigment of the cells that it lies between.
    fn join(&mut self, cells: &Grid<f64>) {
        let [x, y] = self.origin.map(|o| o as f64);
        for (i, row) in self.p.chunks_exact_mut(self.size[0]).enumerate() {
            for (tile, run) in row.chunks_mut(TILE).enumerate() {
                let place = [x + (tile * TILE) as f64, y + (i / 3) as f64];
                Around::Grid(cells).fill(place, i % 3, run);
            }
        }
    }

    /// Moves the places that no picture has covered by the light there, td, when the gaze has moved
    /// by `shift` pixels.
    pub(super) fn advance_beyond(
        &mut self,
        step: &PigmentStep,
        light: Around<'_, f32>,
        shift: [f64; 2],
    ) {
        let surround = match (&mut self.around, light) {
            (Some(cells), Around::Grid(light)) => return cells.advance(step, light, shift),
            (_, Around::Grid(_)) => return,
            (_, Around::Alike(surround)) => surround,
        };
        for (k, td) in surround.into_iter().enumerate() {
            step.cone(k, &[td], std::slice::from_mut(&mut self.beyond[k]));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::eye::pigment::Model;
    use crate::kinetics::Kinetics;
    use crate::step;
    use crate::units::{Seconds, Trolands};

    #[test]
    fn places_that_join_the_retina_have_seen_only_the_surround() {
        let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
        let model = Model::Tracked { method: step::EXACT, substeps: 0, budget: 1e-3 };
        let step = PigmentStep::new(pigments, model, Seconds(10.0));
        let mut retina = Retina::rested(2, 1);
        (0..3).for_each(|k| {
            step.cone(k, &[1e6; 2], &mut retina.p[2 * k..][..2]);
        });
        retina.advance_beyond(&step, Around::Alike([1e4; 3]), [0.0; 2]);
        let (inside, outside) = (retina.at([1, 0]), retina.beyond);
        assert_eq!(retina.cover([-1, 0], [1, 2], 4), [1, 0]);
        assert_eq!(retina.size(), [6, 3]);
        assert_eq!(retina.at([1, 0]), inside);
        assert_eq!(retina.at([-1, 2]), outside);
        assert!(inside[0] < outside[0] && outside[0] < 1.0);
    }

    #[test]
    fn a_gaze_that_wanders_on_moves_the_retina_only_every_half_picture() {
        let mut retina = Retina::rested(64, 40);
        let moves = (1..=64).filter(|&x| {
            let before = retina.origin();
            retina.cover([-x, 0], [63 - x, 39], 8);
            retina.origin() != before
        });
        assert_eq!(moves.count(), 2);
    }
}
