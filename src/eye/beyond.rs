//! What lies beyond the picture: the same everywhere, or, in an eye that scatters, a grid of coarse
//! cells that the picture's veil falls on.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::pigment::PigmentStep;
use crate::kernel::{self, Between};
use crate::optics::Extent;

/// Three values wherever there is no sample.
#[derive(Clone, Copy)]
pub(super) enum Around<'a, T> {
    Alike([T; 3]),
    Grid(&'a Grid<T>),
}

impl<T: Between> Around<'_, T> {
    /// The `k`th of the three at a place.
    pub(super) fn at(&self, place: [f64; 2], k: usize) -> T {
        match self {
            Around::Alike(values) => values[k],
            Around::Grid(grid) => grid.at(place, k),
        }
    }

    /// The `k`th of the three along a row from a place on.
    pub(super) fn fill(&self, [x, y]: [f64; 2], k: usize, out: &mut [T]) {
        match self {
            Around::Alike(values) => out.fill(values[k]),
            Around::Grid(grid) => grid.fill([x, y], k, out),
        }
    }
}

/// Three values in each cell, straight lines between them. What lies farther than the outermost
/// cells is as they are.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Grid<T> {
    extent: Extent,
    /// Rows of three runs.
    samples: Vec<T>,
}

impl<T: Between> Grid<T> {
    /// The same in every cell.
    pub(super) fn alike(extent: Extent, values: [T; 3]) -> Self {
        let [width, height] = extent.size;
        let row = values.into_iter().flat_map(|value| std::iter::repeat_n(value, width));
        let row: Vec<T> = row.collect();
        Grid { extent, samples: row.repeat(height) }
    }

    /// Where the cells lie.
    pub(super) fn extent(&self) -> Extent {
        self.extent
    }

    /// All values, row by row.
    pub(super) fn samples(&self) -> &[T] {
        &self.samples
    }

    /// Rows of three runs, to be written over.
    pub(super) fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, T> {
        self.samples.chunks_exact_mut(3 * self.extent.size[0])
    }

    /// The `k`th of the three at a place, in pixels of the picture.
    pub(super) fn at(&self, [x, y]: [f64; 2], k: usize) -> T {
        let ((column, u), (row, v)) = (self.cell(x, 0), self.cell(y, 1));
        self.corners([column, row], k).at(u, v)
    }

    /// The same along a row, from a place on, cell by cell.
    fn fill(&self, [x, y]: [f64; 2], k: usize, out: &mut [T]) {
        let (row, v) = self.cell(y, 1);
        let mut from = 0;
        while from < out.len() {
            let (column, _) = self.cell(x + from as f64, 0);
            let corners = self.corners([column, row], k);
            let end = (self.place(column + 1, 0) - x).ceil() as usize;
            let is_last = column + 1 >= self.extent.size[0];
            let end = if is_last { out.len() } else { end.clamp(from + 1, out.len()) };
            for (i, out) in out[from..end].iter_mut().enumerate() {
                *out = corners.at(self.cells(x + (from + i) as f64, 0) - column as f64, v);
            }
            from = end;
        }
    }

    /// A place along one axis, counted in cells.
    fn cells(&self, place: f64, axis: usize) -> f64 {
        let Extent { size, cell, before } = self.extent;
        (place * (1.0 / cell as f64) + before[axis] as f64).clamp(0.0, (size[axis] - 1) as f64)
    }

    /// The cell of a place along one axis, and how far on it is to the next.
    fn cell(&self, place: f64, axis: usize) -> (usize, f64) {
        let cells = self.cells(place, axis);
        (cells as usize, cells - cells.floor())
    }

    /// The place of a cell along one axis.
    fn place(&self, cell: usize, axis: usize) -> f64 {
        self.extent.cell as f64 * (cell as f64 - self.extent.before[axis] as f64)
    }

    fn corners(&self, [column, row]: [usize; 2], k: usize) -> Corners<T> {
        let [width, height] = self.extent.size;
        let (next, below) = ((column + 1).min(width - 1), (row + 1).min(height - 1));
        let value = |x: usize, y: usize| self.samples[(3 * y + k) * width + x];
        Corners([
            [value(column, row), value(next, row)],
            [value(column, below), value(next, below)],
        ])
    }
}

/// What lies around a cell: two values above, two below.
struct Corners<T>([[T; 2]; 2]);

impl<T: Between> Corners<T> {
    #[inline(always)]
    fn at(&self, u: f64, v: f64) -> T {
        let [above, below] = self.0.map(|[left, right]| left.between(right, u));
        above.between(below, v)
    }
}

impl Grid<f64> {
    /// Whether it is of these cells, and its fractions are within 0..1.
    pub(super) fn is_of(&self, extent: Extent) -> bool {
        let count = 3 * extent.size[0] * extent.size[1];
        let mut fractions = self.samples.iter();
        self.extent == extent
            && self.samples.len() == count
            && fractions.all(|p| (0.0..=1.0).contains(p))
    }

    /// Moves the pigment of every cell by the light, td, that it sees when the gaze has moved by
    /// `shift` pixels.
    pub(super) fn advance(&mut self, step: &PigmentStep, light: &Grid<f32>, shift: [f64; 2]) {
        let Extent { size: [width, _], cell, before } = self.extent;
        let place =
            |i: usize, axis: usize| cell as f64 * (i as f64 - before[axis] as f64) + shift[axis];
        self.samples.par_chunks_exact_mut(width).enumerate().for_each_init(
            || vec![0.0; width],
            |td, (row, p)| {
                let (y, k) = (place(row / 3, 1), row % 3);
                for (x, td) in td.iter_mut().enumerate() {
                    *td = light.at([place(x, 0), y], k);
                }
                step.cone(k, td, p);
            },
        );
    }
}

impl Grid<f32> {
    /// The greatest of each of the three.
    pub(super) fn greatest(&self) -> [f32; 3] {
        let mut greatest = [0.0f32; 3];
        for (i, run) in self.samples.chunks_exact(self.extent.size[0]).enumerate() {
            greatest[i % 3] = greatest[i % 3].max(kernel::greatest(run));
        }
        greatest
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_run_is_its_places(x in -90.0..90.0, y in -50.0..50.0, whole in any::<bool>()) {
            let extent = Extent { size: [9, 5], cell: 8, before: [3, 2] };
            let mut grid = Grid::alike(extent, [0.0; 3]);
            (0..).zip(&mut grid.samples).for_each(|(i, v)| *v = (f64::from(i) * 0.7).sin());
            let x = if whole { f64::round(x) } else { x };
            for k in 0..3 {
                let mut run = [0.0; 70];
                grid.fill([x, y], k, &mut run);
                let places = (0..70).map(|i| grid.at([x + f64::from(i), y], k));
                prop_assert!(run.into_iter().zip(places).all(|(a, b)| (a - b).abs() < 1e-14));
            }
        }
    }
}
