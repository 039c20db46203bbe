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
    pub fn at(&self, place: [f64; 2], k: usize) -> T {
        match self {
            Around::Alike(values) => values[k],
            Around::Grid(grid) => grid.at(place, k),
        }
    }

    /// The `k`th of the three along a row from a place on.
    pub fn fill(&self, [x, y]: [f64; 2], k: usize, out: &mut [T]) {
        match self {
            Around::Alike(values) => out.fill(values[k]),
            Around::Grid(grid) => {
                let places = out.iter_mut().enumerate();
                places.for_each(|(i, out)| *out = grid.at([x + i as f64, y], k));
            }
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
    pub fn alike(extent: Extent, values: [T; 3]) -> Self {
        let [width, height] = extent.size;
        let row = values.into_iter().flat_map(|value| std::iter::repeat_n(value, width));
        let row: Vec<T> = row.collect();
        Grid { extent, samples: row.repeat(height) }
    }

    /// Where the cells lie.
    pub fn extent(&self) -> Extent {
        self.extent
    }

    /// All values, row by row.
    pub fn samples(&self) -> &[T] {
        &self.samples
    }

    /// Rows of three runs, to be written over.
    pub fn rows_mut(&mut self) -> std::slice::ChunksExactMut<'_, T> {
        self.samples.chunks_exact_mut(3 * self.extent.size[0])
    }

    /// The `k`th of the three at a place, in pixels of the picture.
    pub fn at(&self, place: [f64; 2], k: usize) -> T {
        let Extent { size, cell, before } = self.extent;
        let at = [0, 1].map(|i| {
            let cells = place[i] / cell as f64 + before[i] as f64;
            cells.clamp(0.0, (size[i] - 1) as f64)
        });
        let first = at.map(|v| v as usize);
        let share = [0, 1].map(|i| at[i] - first[i] as f64);
        let next = [0, 1].map(|i| (first[i] + 1).min(size[i] - 1));
        let value = |x: usize, y: usize| self.samples[(3 * y + k) * size[0] + x];
        let row = |y: usize| value(first[0], y).between(value(next[0], y), share[0]);
        row(first[1]).between(row(next[1]), share[1])
    }
}

impl Grid<f64> {
    /// Whether it is of these cells, and its fractions are within 0..1.
    pub fn is_of(&self, extent: Extent) -> bool {
        let count = 3 * extent.size[0] * extent.size[1];
        let mut fractions = self.samples.iter();
        self.extent == extent
            && self.samples.len() == count
            && fractions.all(|p| (0.0..=1.0).contains(p))
    }

    /// Moves the pigment of every cell by the light, td, that it sees when the gaze has moved by
    /// `shift` pixels.
    pub fn advance(&mut self, step: &PigmentStep, light: &Grid<f32>, shift: [f64; 2]) {
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
    pub fn greatest(&self) -> [f32; 3] {
        let mut greatest = [0.0f32; 3];
        for (i, run) in self.samples.chunks_exact(self.extent.size[0]).enumerate() {
            greatest[i % 3] = greatest[i % 3].max(kernel::greatest(run));
        }
        greatest
    }
}
