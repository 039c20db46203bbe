//! What each tile of the retina may have lost unseen.

/// The bounds of all tiles, row by row; infinite once a tile is tracked.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
pub(crate) struct Ledger {
    bounds: Vec<f64>,
    per_row: usize,
    /// Of all that no picture has covered.
    beyond: f64,
}

impl Ledger {
    /// Bounds that were kept, `per_row` tiles a row, and that of all that no picture has covered.
    pub(crate) fn new(bounds: Vec<f64>, per_row: usize, beyond: f64) -> Self {
        Ledger { bounds, per_row, beyond }
    }

    /// Every tile has been modelled.
    pub(crate) fn spend(&mut self) {
        self.bounds.fill(f64::INFINITY);
    }

    /// The bound of all that no picture has covered.
    pub(crate) fn beyond(&self) -> f64 {
        self.beyond
    }

    /// The same, to be carried over a step.
    pub(crate) fn beyond_mut(&mut self) -> &mut f64 {
        &mut self.beyond
    }

    /// All bounds, row by row.
    pub(crate) fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// Tiles in a row of the retina.
    pub(crate) fn per_row(&self) -> usize {
        self.per_row
    }

    /// The rows, to be carried over a step.
    pub(crate) fn rows_mut(&mut self) -> rayon::slice::ChunksExactMut<'_, f64> {
        use rayon::prelude::*;
        self.bounds.par_chunks_exact_mut(self.per_row.max(1))
    }

    /// Room for the tiles of a retina that has grown. `first`: tiles and rows before the old ones;
    /// `size`: tiles in a row and rows now. What is new was beyond. The last tile of a row may have
    /// grown itself.
    pub(crate) fn grow(&mut self, first: [usize; 2], size: [usize; 2]) {
        let ([per_row, rows], beyond) = (size, self.beyond);
        let mut bounds = vec![beyond; per_row * rows];
        for (y, old) in self.bounds.chunks_exact(self.per_row.max(1)).enumerate() {
            let row = &mut bounds[(first[1] + y) * per_row + first[0]..][..old.len()];
            row.copy_from_slice(old);
            if let Some(last) = row.last_mut() {
                *last = last.max(beyond);
            }
        }
        *self = Ledger { bounds, per_row, beyond };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grown_ledger_keeps_every_bound_at_its_tile() {
        let mut ledger = Ledger::new(vec![1.0, 2.0, 3.0, 4.0], 2, 0.0);
        ledger.grow([1, 1], [4, 3]);
        assert_eq!(ledger.bounds(), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 3.0, 4.0, 0.0]);
        *ledger.beyond_mut() = f64::INFINITY;
        ledger.grow([0, 0], [4, 3]);
        assert_eq!(ledger.bounds()[4..8], [0.0, 1.0, 2.0, f64::INFINITY]);
    }
}
