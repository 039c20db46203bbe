//! `contact.png`: the display pictures of all cells on one sheet, durations across, cases down.
//!
//! A sheet is as wide as a page of print needs, whatever it holds. One case alone is laid out in
//! several rows of larger pictures, each with its duration below.

use std::path::Path;

use crate::config::{Case, Sweep};
use crate::error::Result;
use crate::plot::palette::BLACK;
use crate::plot::raster::Canvas;
use crate::plot::{Anchor, Sheet};
use crate::sweep::folder::Left;

/// Width of a sheet, pixels: two for each unit of type.
const WIDTH: usize = 2400;
/// Between pictures, and around the sheet, pixels.
const GAP: usize = 16;
/// More pictures than this side by side could not be told apart on a page.
const MOST_ACROSS: usize = 12;
/// Cases beyond these are in the table only.
pub const MOST_CASES: usize = 100;

/// How many pictures stand side by side. A few of one case are laid out in even rows.
fn columns(cases: usize, durations: usize) -> usize {
    match durations {
        0..=4 => durations,
        5..=16 if cases == 1 => {
            let square = (durations as f64).sqrt().ceil() as usize;
            let even = (square..=2 * square).find(|columns| durations.is_multiple_of(*columns));
            even.unwrap_or(square)
        }
        _ => durations.div_ceil(durations.div_ceil(MOST_ACROSS)),
    }
}

/// The square that a picture of a sweep's sheet must fit into, pixels.
pub fn side(sweep: &Sweep) -> usize {
    let columns = columns(sweep.cases.len(), sweep.durations.len());
    (WIDTH - (columns + 1) * GAP) / columns
}

/// Where everything stands on a sheet, pixels.
struct Layout {
    columns: usize,
    /// Rows of pictures that one case takes.
    rows: usize,
    /// Width of a column.
    across: usize,
    width: usize,
    /// Height of a line of words.
    line: usize,
    /// Durations stand below each picture instead of above each column.
    below: bool,
    /// Cases have a caption.
    captions: bool,
}

impl Layout {
    fn new(sweep: &Sweep, side: usize, left: &[Left]) -> Self {
        let columns = columns(sweep.cases.len(), sweep.durations.len());
        let rows = sweep.durations.len().div_ceil(columns);
        let across = left
            .iter()
            .map(|case| case.done.size[0] * enlarged(case, side))
            .max()
            .unwrap_or(1)
            .max(120);
        let width = columns * across + (columns + 1) * GAP;
        let captions = !sweep.keys.is_empty();
        let line = (width / 44).clamp(26, 60) & !1;
        Layout { columns, rows, across, width, line, below: rows > 1 || !captions, captions }
    }

    /// Left edge of a column.
    fn x(&self, column: usize) -> usize {
        GAP + column * (self.across + GAP)
    }

    /// From the top of one row of pictures to the next.
    fn pitch(&self, height: usize) -> usize {
        height + if self.below { self.line + GAP / 2 } else { GAP }
    }

    /// Height of type, units.
    fn size(&self) -> u32 {
        (self.line as f64 / 2.0 / 1.5).round() as u32
    }
}

/// How many times each pixel of a small picture is repeated.
fn enlarged(case: &Left, side: usize) -> usize {
    (side / case.done.size[0].max(case.done.size[1])).max(1)
}

/// Writes the sheet.
pub fn write(path: &Path, sweep: &Sweep, left: &[Left]) -> Result<()> {
    let (shown, side) = (&left[..left.len().min(MOST_CASES)], side(sweep));
    let layout = Layout::new(sweep, side, shown);
    let (mut words, mut places, mut y) = (Words(Vec::new()), Vec::new(), GAP);
    if !layout.below {
        sweep
            .durations
            .iter()
            .enumerate()
            .for_each(|(i, &duration)| words.centred(&layout, i, y, duration));
        y += layout.line;
    }
    for (case, left) in sweep.cases.iter().zip(shown) {
        if layout.captions {
            words.caption(&layout, y, &caption(&sweep.keys, case));
            y += layout.line;
        }
        let height = left.done.size[1] * enlarged(left, side);
        for (cell, &duration) in sweep.durations.iter().enumerate() {
            let (row, column) = (cell / layout.columns, cell % layout.columns);
            let top = y + row * layout.pitch(height);
            places.push((left, cell, [layout.x(column), top]));
            if layout.below {
                words.centred(&layout, column, top + height, duration);
            }
        }
        y += layout.rows * layout.pitch(height);
    }
    if shown.len() < left.len() {
        words.caption(&layout, y, &format!("the first {} of {} cases", shown.len(), left.len()));
        y += layout.line;
    }
    let height = (y + GAP / 2).next_multiple_of(2);
    let mut sheet = words.drawn(&layout, height);
    for (left, cell, at) in places {
        paste(&mut sheet, left, enlarged(left, side), layout.across, cell, at);
    }
    sheet.write(path)
}

/// Words of a sheet: where, what, whether centred.
struct Words(Vec<([f64; 2], String, bool)>);

impl Words {
    fn centred(&mut self, layout: &Layout, column: usize, y: usize, duration: f64) {
        let x = layout.x(column) as f64 + 0.5 * layout.across as f64;
        self.0.push(([x, y as f64], seconds(duration), true));
    }

    /// A line from the left edge; what has no room is cut off.
    fn caption(&mut self, layout: &Layout, y: usize, words: &str) {
        let room =
            (1.8 * (layout.width - 2 * GAP) as f64 / 2.0 / f64::from(layout.size())) as usize;
        let cut = if words.chars().count() > room {
            words.chars().take(room.saturating_sub(1)).chain(['…']).collect()
        } else {
            words.to_owned()
        };
        self.0.push(([GAP as f64, y as f64], cut, false));
    }

    /// A white picture with these words, two pixels to the unit.
    fn drawn(&self, layout: &Layout, height: usize) -> Canvas {
        let mut sheet = Sheet::new(layout.width as f64 / 2.0, height as f64 / 2.0);
        for ([x, y], words, centred) in &self.0 {
            let at = (x / 2.0, (y + 0.72 * layout.line as f64) / 2.0);
            let anchor = if *centred { Anchor::Middle } else { Anchor::Start };
            sheet.text(at, words, layout.size(), anchor, BLACK);
        }
        Canvas::of(&sheet, 2.0)
    }
}

/// Puts a cell's picture into its column of the sheet.
fn paste(
    sheet: &mut Canvas,
    left: &Left,
    times: usize,
    across: usize,
    cell: usize,
    [x, y]: [usize; 2],
) {
    let [w, h] = left.done.size;
    let rows = left.pictures.chunks_exact(3 * w).skip(cell * h).take(h);
    let wide = rows
        .map(|row| row.chunks_exact(3).flat_map(|pixel| pixel.repeat(times)).collect::<Vec<u8>>());
    let picture: Vec<u8> = wide.flat_map(|row| row.repeat(times)).collect();
    sheet.paste([x + (across - w * times) / 2, y], w * times, &picture);
}

/// What sets a case apart: the last words of its keys with their values.
pub fn caption(keys: &[String], case: &Case) -> String {
    let short = |key: &str| key.rsplit('.').next().unwrap_or(key).to_owned();
    let pairs: Vec<String> = keys
        .iter()
        .zip(&case.values)
        .map(|(key, value)| format!("{} = {value}", short(key)))
        .collect();
    format!("{}:  {}", case.number, pairs.join(",  "))
}

/// A duration in three digits.
pub fn seconds(duration: f64) -> String {
    if duration >= 1e5 {
        return format!("{duration:.0e} s");
    }
    let digits = (2.0 - duration.log10().floor()).clamp(0.0, 9.0) as usize;
    let text = if duration == 0.0 { "0".into() } else { format!("{duration:.digits$}") };
    let text =
        if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    format!("{text} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn durations_read_as_a_person_writes_them() {
        let written = [0.0, 0.3, 1.0, 30.0, 0.031_622_776, 316.227, 1000.0, 1e6, 0.01].map(seconds);
        assert_eq!(
            written,
            ["0 s", "0.3 s", "1 s", "30 s", "0.0316 s", "316 s", "1000 s", "1e6 s", "0.01 s"]
        );
    }

    #[test]
    fn one_case_is_laid_out_in_even_rows_and_many_in_one_row_each() {
        assert_eq!(
            [1, 3, 6, 8, 16, 64].map(|durations| columns(1, durations)),
            [1, 3, 3, 4, 4, 11]
        );
        assert_eq!([1, 6, 12, 13, 64].map(|durations| columns(5, durations)), [1, 6, 12, 7, 11]);
    }
}
