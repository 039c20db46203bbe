//! What lies beyond the picture: the same everywhere, or, in an eye that scatters, a grid of coarse
//! cells that the picture's veil falls on.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::pigment::PigmentStep;
use crate::kernel::{self, Between, TILE};
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
        let next = (column + 1).min(self.extent.size[0] - 1);
        let [left, right] = [column, next].map(|column| self.value(column, (row, v), k));
        left.between(right, u)
    }

    /// The same along a row, from a place on: at most [`TILE`] places.
    fn fill(&self, [x, y]: [f64; 2], k: usize, out: &mut [T]) {
        let (row, [first, last]) = (self.cell(y, 1), [0, self.extent.size[0] - 1]);
        let end = |cell: usize| ((self.place(cell, 0) - x).ceil().max(0.0) as usize).min(out.len());
        let [left, right] = [end(first), end(last)];
        let (before, rest) = out.split_at_mut(left);
        let (lines, after) = rest.split_at_mut(right - left);
        before.fill(self.value(first, row, k));
        after.fill(self.value(last, row, k));
        if lines.is_empty() {
            return;
        }
        let place = x + left as f64;
        let (column, _) = self.cell(place, 0);
        let mut samples = [lines[0]; TILE + 2];
        let behind = column + lines.len().div_ceil(self.extent.cell) + 1;
        let columns = column..behind.min(last) + 1;
        let (count, v) = (columns.len(), row.1);
        let [above, below] = self.rows(row.0, k).map(|row| &row[columns.clone()]);
        kernel::between(above, below, [0.0, v], &mut samples[..count]);
        let offset = place - self.place(column, 0);
        kernel::ramps(&samples, self.extent.cell, offset, lines);
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

    /// The value of a column, `v` of the way down from a row to the next.
    fn value(&self, column: usize, (row, v): (usize, f64), k: usize) -> T {
        let [above, below] = self.rows(row, k);
        above[column].between(below[column], v)
    }

    /// All columns at a place between two rows, counted in cells.
    fn line(&self, row: f64, k: usize, out: &mut [T]) {
        let row = row.clamp(0.0, (self.extent.size[1] - 1) as f64);
        let [above, below] = self.rows(row as usize, k);
        kernel::between(above, below, [0.0, row - row.floor()], out);
    }

    /// A row and the next, of one run of the three.
    fn rows(&self, row: usize, k: usize) -> [&[T]; 2] {
        let [width, height] = self.extent.size;
        [row, (row + 1).min(height - 1)].map(|row| &self.samples[(3 * row + k) * width..][..width])
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
        let (width, cell) = (self.extent.size[0], self.extent.cell as f64);
        let [x, y] = shift.map(|pixels| pixels / cell);
        let (first, u) = (x.floor() as i64, x - x.floor());
        // Cells that see what lies between two others.
        let from = (-first).clamp(0, width as i64);
        let to = (width as i64 - 1 - first).clamp(from, width as i64);
        let (inside, seen) = (from as usize..to as usize, (from + first).max(0) as usize);
        self.samples.par_chunks_exact_mut(width).enumerate().for_each_init(
            || (vec![0.0; width], vec![0.0; width]),
            |(line, td), (row, p)| {
                light.line((row / 3) as f64 + y, row % 3, line);
                td[..inside.start].fill(line[0]);
                td[inside.end..].fill(line[width - 1]);
                if !inside.is_empty() {
                    kernel::between(
                        &line[seen..],
                        &line[seen..],
                        [u, 0.0],
                        &mut td[inside.clone()],
                    );
                }
                step.cone(row % 3, td, p);
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
    use crate::eye::pigment::Model;
    use crate::kinetics::Kinetics;
    use crate::step;
    use crate::units::{Seconds, Trolands};
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn every_cell_sees_the_light_of_its_own_place(x in -120.0..120.0, y in -70.0..70.0, whole in any::<bool>()) {
            let extent = Extent { size: [9, 5], cell: 8, before: [3, 2] };
            let mut light = Grid::alike(extent, [0.0f32; 3]);
            (0..).zip(&mut light.samples).for_each(|(i, v)| *v = 1e5 * (1.1 + (i as f32).sin()));
            let shift = if whole { [8.0 * f64::round(x / 8.0), y] } else { [x, y] };
            let pigments = [Kinetics::first_order(Trolands(2e4), Seconds(120.0)); 3];
            let model = Model::Tracked { method: step::EXACT, substeps: 0, budget: 1e-3 };
            let step = PigmentStep::new(pigments, model, Seconds(3.0));
            let mut grid = Grid::alike(extent, [1.0; 3]);
            grid.advance(&step, &light, shift);
            for (i, p) in grid.samples.iter().enumerate() {
                let (column, row, k) = (i % 9, i / 27, i / 9 % 3);
                let place = [grid.place(column, 0) + shift[0], grid.place(row, 1) + shift[1]];
                let mut expected = [1.0];
                step.cone(k, &[light.at(place, k)], &mut expected);
                prop_assert!((p - expected[0]).abs() < 1e-7, "{column} {row} {k}");
            }
        }

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
