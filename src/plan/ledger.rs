//! What each tile of the retina may have lost unseen.

/// The bounds of all tiles, row by row; infinite once a tile is tracked.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Ledger {
    bounds: Vec<f64>,
    per_row: usize,
}

impl Ledger {
    /// Bounds that were kept, `per_row` tiles a row.
    pub fn new(bounds: Vec<f64>, per_row: usize) -> Self {
        Ledger { bounds, per_row }
    }

    /// All bounds, row by row.
    pub fn bounds(&self) -> &[f64] {
        &self.bounds
    }

    /// Tiles in a row of the retina.
    pub fn per_row(&self) -> usize {
        self.per_row
    }

    /// The rows, to be carried over a step.
    pub fn rows_mut(&mut self) -> rayon::slice::ChunksExactMut<'_, f64> {
        use rayon::prelude::*;
        self.bounds.par_chunks_exact_mut(self.per_row.max(1))
    }

    /// Room for the tiles of a retina that has grown. `first`: tiles and rows before the old ones; `size`: tiles in
    /// a row and rows now; `fresh`: the bound of what is new. The last tile of a row may have grown itself.
    pub fn grow(&mut self, first: [usize; 2], size: [usize; 2], fresh: f64) {
        let [per_row, rows] = size;
        let mut bounds = vec![fresh; per_row * rows];
        for (y, old) in self.bounds.chunks_exact(self.per_row.max(1)).enumerate() {
            let row = &mut bounds[(first[1] + y) * per_row + first[0]..][..old.len()];
            row.copy_from_slice(old);
            if let Some(last) = row.last_mut() {
                *last = last.max(fresh);
            }
        }
        *self = Ledger { bounds, per_row };
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grown_ledger_keeps_every_bound_at_its_tile() {
        let mut ledger = Ledger::new(vec![1.0, 2.0, 3.0, 4.0], 2);
        ledger.grow([1, 1], [4, 3], 0.0);
        assert_eq!(ledger.bounds(), [0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 0.0, 0.0, 3.0, 4.0, 0.0]);
        ledger.grow([0, 0], [4, 3], f64::INFINITY);
        assert_eq!(ledger.bounds()[4..8], [0.0, 1.0, 2.0, f64::INFINITY]);
    }
}
