//! What a tone map needs to know of a frame's unbleached light, gathered row by row while it is
//! decoded.
//!
//! A fixation takes in about a degree, so the histogram is one of means over cells of a degree
//! (Ward et al. 1997); the range is that of single pixels, since a cell would dilute the sun.
//! Luminances in cd/m2.

use pulp::{Arch, Simd, WithSimd};

/// The luminances of one frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Survey {
    /// Mean luminance of each foveal cell.
    pub(crate) cells: Vec<f32>,
    /// The darkest pixel that gives light at all; 0 where none does.
    pub least: f32,
    /// The brightest pixel; 0 where none gives light.
    pub(crate) greatest: f32,
    /// Mean of all pixels.
    pub(crate) mean: f64,
    /// Mean of the outermost pixels, one in sixteen of the height on each side.
    pub(crate) edge: f64,
    /// Column and row of the first of the brightest pixels.
    pub(crate) brightest: (usize, usize),
}

/// Pixels that are looked at side by side.
const LANES: usize = 16;

/// The sum of a run without its negative light, in a fixed order.
#[inline(always)]
fn sum(run: &[f32]) -> f64 {
    let (lots, rest) = run.as_chunks::<8>();
    let mut lanes = [0.0f64; 8];
    for lot in lots {
        lanes.iter_mut().zip(lot).for_each(|(sum, v)| *sum += f64::from(v.max(0.0)));
    }
    let [a, b, c, d, e, f, g, h] = lanes;
    let whole = ((a + e) + (c + g)) + ((b + f) + (d + h));
    rest.iter().fold(whole, |sum, v| sum + f64::from(v.max(0.0)))
}

/// The least light of a run that is any, infinite if there is none, and the greatest, at least 0.
#[inline(always)]
fn extremes(run: &[f32]) -> [f32; 2] {
    let (lots, rest) = run.as_chunks::<LANES>();
    let mut last = [0.0; LANES];
    last[..rest.len()].copy_from_slice(rest);
    let [mut least, mut greatest] = [[f32::INFINITY; LANES], [0.0f32; LANES]];
    for lot in lots.iter().chain([&last]) {
        for ((least, greatest), &v) in least.iter_mut().zip(&mut greatest).zip(lot) {
            let light = if v > 0.0 { v } else { f32::INFINITY };
            *least = if light < *least { light } else { *least };
            *greatest = if v > *greatest { v } else { *greatest };
        }
    }
    let least = least.into_iter().fold(f32::INFINITY, f32::min);
    [least, greatest.into_iter().fold(0.0, f32::max)]
}

/// Where a run first has a value.
#[inline(always)]
fn first(run: &[f32], value: f32) -> Option<usize> {
    let mut lots = run.chunks(LANES);
    let has = |lot: &[f32]| lot.iter().fold(false, |any, v| any | (*v == value));
    let lot = lots.position(has)? * LANES;
    run[lot..].iter().position(|v| *v == value).map(|i| lot + i)
}

/// How a picture is cut into foveal cells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Cells {
    width: usize,
    height: usize,
    columns: usize,
    rows: usize,
}

/// What one row adds to a survey.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct SurveyRow {
    sum: f64,
    least: f32,
    greatest: f32,
    column: usize,
    /// Sum of the pixels within the margin on the left and on the right.
    margins: f64,
    cells: Vec<f64>,
}

/// What a row of luminances adds, for whatever the processor has.
struct RowOf<'a> {
    cells: &'a Cells,
    luminance: &'a [f32],
}

impl WithSimd for RowOf<'_> {
    type Output = SurveyRow;

    #[inline(always)]
    fn with_simd<S: Simd>(self, _: S) -> SurveyRow {
        let RowOf { cells: of @ Cells { columns, width, .. }, luminance } = self;
        let mut cells = vec![0.0; *columns];
        for (i, cell) in cells.iter_mut().enumerate() {
            let [start, end] = [i, i + 1].map(|i| Cells::start(i, *columns, *width));
            *cell = sum(&luminance[start..end]);
        }
        let [least, greatest] = extremes(luminance);
        let column = first(luminance, greatest).unwrap_or(0);
        let margin = of.margin().min(luminance.len() / 2);
        let margins = sum(&luminance[..margin]) + sum(&luminance[luminance.len() - margin..]);
        SurveyRow { sum: cells.iter().sum(), least, greatest, column, margins, cells }
    }
}

impl Cells {
    /// Fewer cells than this make a poor histogram; the cells of a narrow field are made smaller
    /// than a degree.
    const ENOUGH: f64 = 1000.0;

    /// Cells of one degree or less, never under one pixel, all of one size within a pixel.
    pub(crate) fn new(width: usize, height: usize, pixels_per_degree: f64) -> Self {
        let side =
            pixels_per_degree.min((width as f64 * height as f64 / Self::ENOUGH).sqrt()).max(1.0);
        let along =
            |pixels: usize| ((pixels as f64 / side).round() as usize).clamp(1, pixels.max(1));
        Cells { width, height, columns: along(width), rows: along(height) }
    }

    /// The first pixel of cell `i` of `count` along a side of `pixels`.
    fn start(i: usize, count: usize, pixels: usize) -> usize {
        (i * pixels).div_ceil(count)
    }

    /// What a row of luminances adds. Negative light counts as none.
    pub(crate) fn row(&self, luminance: &[f32]) -> SurveyRow {
        Arch::new().dispatch(RowOf { cells: self, luminance })
    }

    /// Width of the outermost pixels on each side: one in sixteen of the height.
    fn margin(&self) -> usize {
        (self.height / 16).max(1)
    }

    /// Mean of the outermost pixels from the sums of rows and of their margins.
    fn edge(&self, sums: &[[f64; 2]]) -> f64 {
        let (rows, columns) =
            (self.margin().min(self.height / 2), self.margin().min(self.width / 2));
        if rows == 0 || columns == 0 {
            let pixels = (self.width * self.height).max(1) as f64;
            return sums.iter().map(|[row, _]| row).sum::<f64>() / pixels;
        }
        let outer = |y: usize| y < rows || y >= self.height - rows;
        let of_row =
            |(y, [row, margins]): (usize, &[f64; 2])| if outer(y) { *row } else { *margins };
        let pixels = 2 * rows * self.width + (self.height - 2 * rows) * 2 * columns;
        sums.iter().enumerate().map(of_row).sum::<f64>() / pixels as f64
    }

    /// The survey of a frame from all its rows, in order from the top.
    pub(crate) fn gather(&self, rows: impl IntoIterator<Item = SurveyRow>) -> Survey {
        let mut totals = vec![0.0; self.columns * self.rows];
        let (mut sum, mut least, mut greatest, mut brightest) = (0.0, f32::INFINITY, 0.0, (0, 0));
        let mut sums = Vec::with_capacity(self.height);
        for (y, row) in rows.into_iter().take(self.height).enumerate() {
            let first = y * self.rows / self.height * self.columns;
            for (total, part) in totals[first..].iter_mut().zip(&row.cells) {
                *total += part;
            }
            sum += row.sum;
            sums.push([row.sum, row.margins]);
            least = row.least.min(least);
            if row.greatest > greatest {
                (greatest, brightest) = (row.greatest, (row.column, y));
            }
        }
        let cells =
            totals.iter().enumerate().map(|(i, total)| (total / self.pixels(i)) as f32).collect();
        let least = if greatest > 0.0 { least } else { 0.0 };
        Survey {
            cells,
            least,
            greatest,
            mean: sum / (self.width * self.height).max(1) as f64,
            edge: self.edge(&sums),
            brightest,
        }
    }

    /// How many pixels cell `i` has.
    fn pixels(&self, i: usize) -> f64 {
        let side =
            |i, count, pixels| Self::start(i + 1, count, pixels) - Self::start(i, count, pixels);
        (side(i % self.columns, self.columns, self.width)
            * side(i / self.columns, self.rows, self.height)) as f64
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn survey(cells: Cells, picture: &[f32]) -> Survey {
        cells.gather(picture.chunks(cells.width).map(|row| cells.row(row)))
    }

    #[test]
    fn cells_are_a_degree_wide_in_a_wide_field_and_smaller_in_a_narrow_one() {
        assert_eq!(
            Cells::new(1920, 1080, 24.0),
            Cells { width: 1920, height: 1080, columns: 80, rows: 45 }
        );
        let narrow = Cells::new(480, 270, 60.0);
        assert!((900..1100).contains(&(narrow.columns * narrow.rows)));
        assert_eq!(Cells::new(7, 3, 1e-3), Cells { width: 7, height: 3, columns: 7, rows: 3 });
    }

    #[test]
    fn every_pixel_falls_in_the_cell_that_its_row_and_column_say() {
        let cells = Cells { width: 10, height: 7, columns: 4, rows: 3 };
        let pixels: f64 = (0..12).map(|i| cells.pixels(i)).sum();
        assert_eq!(pixels, 70.0);
        let found = survey(cells, &[3.0; 70]);
        assert_eq!(found.cells, vec![3.0; 12]);
        assert_eq!(found.mean, 3.0);
    }

    #[test]
    fn the_mean_of_the_cells_is_the_mean_of_the_picture_where_they_are_of_one_size() {
        let picture: Vec<f32> = (0..96).map(|i| (i * i % 31) as f32).collect();
        let found = survey(Cells { width: 12, height: 8, columns: 3, rows: 4 }, &picture);
        let mean = found.cells.iter().copied().map(f64::from).sum::<f64>() / 12.0;
        approx::assert_relative_eq!(mean, found.mean, max_relative = 1e-6);
    }

    #[test]
    fn the_first_of_the_brightest_pixels_is_named_and_light_below_zero_is_none() {
        let found = survey(Cells::new(3, 2, 1.0), &[-5.0, 0.0, 2.0, f32::MIN, 2.0, 0.5]);
        assert_eq!((found.least, found.greatest, found.brightest), (0.5, 2.0, (2, 0)));
        assert_eq!(found.mean, 4.5 / 6.0);
        let dark = survey(Cells::new(3, 2, 1.0), &[0.0, -1.0, 0.0, 0.0, -0.0, 0.0]);
        assert_eq!((dark.least, dark.greatest, dark.mean), (0.0, 0.0, 0.0));
    }

    #[test]
    fn the_edge_is_the_mean_of_a_sixteenth_of_the_height_all_round() {
        let inside = |x: usize, y: usize| (2..38).contains(&x) && (2..30).contains(&y);
        let pixel = |i: usize| if inside(i % 40, i / 40) { 1e6 } else { 3.0 };
        let picture: Vec<f32> = (0..40 * 32).map(pixel).collect();
        assert_eq!(survey(Cells::new(40, 32, 1.0), &picture).edge, 3.0);
        assert_eq!(survey(Cells::new(1, 1, 1.0), &[7.0]).edge, 7.0);
    }

    #[test]
    fn rows_surveyed_by_many_threads_give_the_same_bits() {
        use rayon::prelude::*;
        let picture: Vec<f32> =
            (0..64 * 50).map(|i| ((i as f32) * 0.37).sin().abs().powi(9) * 1e9).collect();
        let cells = Cells::new(64, 50, 5.0);
        let rows: Vec<SurveyRow> = picture.par_chunks(64).map(|row| cells.row(row)).collect();
        assert_eq!(cells.gather(rows), survey(cells, &picture));
    }
}
