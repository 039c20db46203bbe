//! Reading between samples: light on its way to the retina, pigment on its way back, straight lines
//! both ways.

use std::ops::Range;

use super::beyond::Around;
use crate::kernel::{self, Between, TILE};

/// Three planes, row by row, that can be read between their samples.
pub(super) struct Field<'a, T> {
    pub(crate) samples: &'a [T],
    pub(crate) width: usize,
    pub(crate) height: usize,
    /// What lies outside.
    pub(crate) around: Around<'a, T>,
}

impl<T: Between> Field<'_, T> {
    /// Reads a run of three planes, at most [`TILE`] long, that begins at `from` and goes on in
    /// steps of one sample. Whole steps are exact.
    pub(super) fn resample(&self, from: [f64; 2], out: [&mut [T]; 3]) {
        let at = from.map(|v| v.floor() as i64);
        let share = [0, 1].map(|i| from[i] - from[i].floor());
        let rows = at[1]..=at[1] + i64::from(share[1] > 0.0);
        let outside = *rows.end() < 0 || *rows.start() >= self.height as i64;
        for (k, out) in out.into_iter().enumerate() {
            if outside {
                self.around.fill(from, k, out);
                continue;
            }
            let inside = self.inside(at[0], share[0], out.len());
            self.around.fill(from, k, &mut out[..inside.start]);
            let behind = [from[0] + inside.end as f64, from[1]];
            self.around.fill(behind, k, &mut out[inside.end..]);
            // Places between the picture's edge and what is around it.
            for column in [-1, self.width as i64 - 1] {
                let i = column - at[0];
                if (0..out.len() as i64).contains(&i) && !inside.contains(&(i as usize)) {
                    out[i as usize] = self.sample([column, at[1]], share, k);
                }
            }
            let first = [at[0] + inside.start as i64, at[1]];
            self.run(first, share, k, &mut out[inside]);
        }
    }

    /// Which of `length` places from column `left` on lie between two columns, or on one where
    /// `share` is 0.
    fn inside(&self, left: i64, share: f64, length: usize) -> Range<usize> {
        let last = self.width as i64 - i64::from(share > 0.0);
        let first = (-left).clamp(0, length as i64);
        first as usize..(last - left).clamp(first, length as i64) as usize
    }

    /// A run of one plane whose columns lie inside.
    fn run(&self, [x, y]: [i64; 2], share: [f64; 2], k: usize, out: &mut [T]) {
        let Some(&any) = out.first() else { return };
        let rows = [y, y + 1].map(|y| self.row(x, y, k));
        match (rows, share) {
            ([Some(above), _], [_, 0.0]) => kernel::between(above, above, share, out),
            ([Some(above), Some(below)], _) => kernel::between(above, below, share, out),
            // At the upper or lower edge.
            _ => {
                let mut room = [[any; TILE]; 2];
                let [above, below] = room.each_mut().map(|row| &mut row[..out.len()]);
                self.line([x, y], share[0], k, above);
                self.line([x, y + 1], share[0], k, below);
                kernel::between(above, below, [0.0, share[1]], out);
            }
        }
    }

    /// The samples of one row of one plane from a column on, if there is such a row.
    fn row(&self, x: i64, y: i64, k: usize) -> Option<&[T]> {
        let y = usize::try_from(y).ok().filter(|&y| y < self.height)?;
        self.samples[(y * 3 + k) * self.width..][..self.width].get(x as usize..)
    }

    /// A run of one row of one plane, inside or outside.
    fn line(&self, [x, y]: [i64; 2], u: f64, k: usize, out: &mut [T]) {
        match self.row(x, y, k) {
            Some(row) => kernel::between(row, row, [u, 0.0], out),
            None => self.around.fill([x as f64 + u, y as f64], k, out),
        }
    }

    /// One place of one plane, wherever it lies.
    fn sample(&self, [x, y]: [i64; 2], [u, v]: [f64; 2], k: usize) -> T {
        let row = |y: i64| {
            let here = self.stored(x, y, k);
            if u == 0.0 { here } else { here.between(self.stored(x + 1, y, k), u) }
        };
        if v == 0.0 { row(y) } else { row(y).between(row(y + 1), v) }
    }

    fn stored(&self, x: i64, y: i64, k: usize) -> T {
        if x < 0 || y < 0 || x >= self.width as i64 || y >= self.height as i64 {
            return self.around.at([x as f64, y as f64], k);
        }
        self.samples[(y as usize * 3 + k) * self.width + x as usize]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(field: &Field<'_, f64>, from: [f64; 2]) -> [f64; 3] {
        let (mut a, mut b, mut c) = ([0.0], [0.0], [0.0]);
        field.resample(from, [&mut a, &mut b, &mut c]);
        [a[0], b[0], c[0]]
    }

    #[test]
    fn whole_steps_are_exact_and_outside_lies_what_is_around() {
        let samples: Vec<f64> = (0..12).map(|i| f64::from(i) / 7.0).collect();
        let field = Field {
            samples: &samples,
            width: 2,
            height: 2,
            around: Around::Alike([9.0, 8.0, 7.0]),
        };
        assert_eq!(read(&field, [1.0, 1.0]), [samples[7], samples[9], samples[11]]);
        assert_eq!(read(&field, [-1.0, 0.0]), [9.0, 8.0, 7.0]);
        assert_eq!(read(&field, [0.5, 0.0])[0], samples[0] + 0.5 * (samples[1] - samples[0]));
    }

    #[test]
    fn a_run_is_its_places_wherever_it_begins_and_ends() {
        let samples: Vec<f64> = (0..3 * 40 * 5).map(|i| (f64::from(i) * 0.37).sin()).collect();
        let field = Field {
            samples: &samples,
            width: 40,
            height: 5,
            around: Around::Alike([9.0, 8.0, 7.0]),
        };
        for (x, y) in [-50.0, -3.4, 0.0, 0.6, 25.0, 37.5, 39.0, 39.5, 60.0]
            .into_iter()
            .flat_map(|x| [-2.0, -0.3, 0.0, 2.25, 3.9, 4.0, 4.5, 9.0].map(move |y| (x, y)))
        {
            let mut run = [[0.0; 50]; 3];
            field.resample([x, y], run.each_mut().map(|run| &mut run[..]));
            for i in 0..50 {
                let at = [(x.floor() as i64) + i as i64, y.floor() as i64];
                let place = [0, 1, 2].map(|k| field.sample(at, [x - x.floor(), y - y.floor()], k));
                assert_eq!(run.map(|run| run[i]), place, "{x} {y} {i}");
            }
        }
    }
}
