//! Gallery: pages of pictures in rows and columns, with headings, labels and captions.

use super::font;
use super::palette::{BLACK, GREY};
use super::raster::Canvas;
use super::sheet::{Anchor, Ink, Sheet};

/// Width of a page, pixels: 16 cm of print at 150 pixels to the centimetre.
const WIDTH: usize = 2400;
/// Height of a page that pictures are made to fit while they can be [`SMALLEST`], pixels.
const HEIGHT: usize = 6400;
const SMALLEST: usize = 160;
/// Width of a column that leaves room for its words, pixels.
const NARROWEST: usize = 120;
/// Between pictures, and around the page, pixels.
const GAP: usize = 16;
/// Room for the words beside a row, pixels.
const LABEL: usize = 380;
/// Size of type, and height of a line of it, pixels.
const TYPE: u32 = 34;
const LINE: usize = 50;
/// More pictures than this side by side could not be told apart on a page.
pub(crate) const MOST_ACROSS: usize = 12;
/// Rows of pictures on a page.
const MOST_ROWS: usize = 40;

/// A picture: width and height, and its rows from the top, 8-bit sRGB.
#[derive(Clone, Copy)]
pub(crate) struct Picture<'a> {
    pub(crate) size: [usize; 2],
    pub(crate) rgb: &'a [u8],
}

/// A row of pictures: words to its left, the pictures, and words below each.
pub(crate) struct Row<'a> {
    pub(crate) label: String,
    pub(crate) pictures: Vec<Picture<'a>>,
    pub(crate) captions: Vec<String>,
}

/// Rows under common headings, one for each column.
pub(crate) struct Block<'a> {
    pub(crate) title: String,
    pub(crate) headings: Vec<String>,
    pub(crate) rows: Vec<Row<'a>>,
}

/// The square that pictures must fit into for so many columns and rows in all, pixels.
pub(crate) fn side(columns: usize, rows: usize, is_labelled: bool) -> usize {
    let label = if is_labelled { LABEL } else { 0 };
    let across = (WIDTH - label - (columns + 1) * GAP) / columns;
    let high = HEIGHT / rows.clamp(1, MOST_ROWS);
    across.min(high.saturating_sub(GAP).max(SMALLEST))
}

/// Blocks on pages of at most [`MOST_ROWS`] rows; a block that does not fit goes on under its
/// headings.
pub(crate) fn pages(blocks: Vec<Block<'_>>) -> Vec<Vec<Block<'_>>> {
    let mut pages: Vec<Vec<Block<'_>>> = vec![Vec::new()];
    let mut room = MOST_ROWS;
    for Block { title, headings, mut rows } in blocks {
        if rows.len() > room && room < MOST_ROWS && rows.len() <= MOST_ROWS {
            pages.push(Vec::new());
            room = MOST_ROWS;
        }
        while !rows.is_empty() {
            if room == 0 {
                pages.push(Vec::new());
                room = MOST_ROWS;
            }
            let rest = rows.split_off(rows.len().min(room));
            room -= rows.len();
            let part = Block { title: title.clone(), headings: headings.clone(), rows };
            pages.last_mut().unwrap_or_else(|| unreachable!("there is a page")).push(part);
            rows = rest;
        }
    }
    pages
}

/// Where things stand on a page.
struct Layout {
    label: usize,
    /// Width of a column.
    across: usize,
    columns: usize,
    /// The square that pictures are shown in.
    side: usize,
}

impl Layout {
    fn new(page: &[Block], side: usize) -> Self {
        let rows = || page.iter().flat_map(|block| &block.rows);
        let labels = rows().filter(|row| !row.pictures.is_empty()).map(|row| &row.label);
        let longest =
            labels.map(|label| font::width(label, f64::from(TYPE), false)).fold(0.0, f64::max);
        let label = if longest > 0.0 { LABEL.min(longest as usize + 2 * GAP) } else { 0 };
        let widths = rows().flat_map(|row| &row.pictures).map(|picture| picture.shown(side)[0]);
        let across = widths.max().unwrap_or(1).max(NARROWEST);
        let columns = rows().map(|row| row.pictures.len()).max().unwrap_or(1);
        Layout { label, across, columns, side }
    }

    fn x(&self, column: usize) -> usize {
        self.label + GAP + column * (self.across + GAP)
    }

    fn width(&self) -> usize {
        self.x(self.columns)
    }
}

impl Picture<'_> {
    /// Width and height as it is shown: a small picture has each pixel repeated.
    fn shown(&self, side: usize) -> [usize; 2] {
        let [w, h] = self.size;
        let times = (side / w.max(h).max(1)).max(1);
        [w * times, h * times]
    }

    fn enlarged(&self, side: usize) -> Vec<u8> {
        let times = self.shown(side)[0] / self.size[0].max(1);
        let wide = self.rgb.chunks_exact(3 * self.size[0].max(1)).map(|row| -> Vec<u8> {
            row.as_chunks::<3>().0.iter().flat_map(|pixel| pixel.repeat(times)).collect()
        });
        wide.flat_map(|row| row.repeat(times)).collect()
    }
}

/// What is put on a page: pictures and words at places.
struct Page<'a> {
    pictures: Vec<(Picture<'a>, [usize; 2])>,
    words: Vec<(String, [usize; 2], Anchor, Ink)>,
    y: usize,
}

/// A page, its pictures in squares of `side`.
pub(crate) fn drawn(page: &[Block], side: usize) -> Canvas {
    let layout = Layout::new(page, side);
    let mut placed = Page { pictures: Vec::new(), words: Vec::new(), y: GAP };
    page.iter().for_each(|block| placed.block(block, &layout));
    let mut canvas = Canvas::white(layout.width(), placed.y, 1.0);
    let mut sheet = Sheet::new(layout.width() as f64, placed.y as f64);
    for (picture, [x, y]) in &placed.pictures {
        let size = picture.shown(side);
        let at = [x + (layout.across - size[0]) / 2, *y];
        canvas.paste(at, size[0], &picture.enlarged(side));
        edge(&mut sheet, at, size);
    }
    for (words, [x, y], anchor, ink) in &placed.words {
        sheet.text((*x as f64, *y as f64), words, TYPE, *anchor, *ink);
    }
    canvas.draw(&sheet);
    canvas
}

impl<'a> Page<'a> {
    fn block(&mut self, block: &Block<'a>, layout: &Layout) {
        if !block.title.is_empty() {
            self.line(fitted(&block.title, layout.width()), GAP, Anchor::Start, GREY);
            self.y += LINE;
        }
        self.across(&block.headings, layout);
        block.rows.iter().for_each(|row| self.row(row, layout));
        self.y += GAP;
    }

    fn row(&mut self, row: &Row<'a>, layout: &Layout) {
        let heights = row.pictures.iter().map(|picture| picture.shown(layout.side)[1]);
        let height = heights.max().unwrap_or(LINE);
        let room = if row.pictures.is_empty() { layout.width() } else { layout.label };
        let middle = self.y + height / 2 + TYPE as usize / 3;
        self.words.push((fitted(&row.label, room), [GAP, middle], Anchor::Start, BLACK));
        for (column, picture) in row.pictures.iter().enumerate() {
            self.pictures.push((*picture, [layout.x(column), self.y]));
        }
        self.y += height + GAP;
        self.across(&row.captions, layout);
    }

    /// A line of words, one in the middle of each column.
    fn across(&mut self, words: &[String], layout: &Layout) {
        for (column, words) in words.iter().enumerate() {
            let middle = layout.x(column) + layout.across / 2;
            self.line(fitted(words, layout.across), middle, Anchor::Middle, BLACK);
        }
        self.y += if words.is_empty() { 0 } else { LINE };
    }

    fn line(&mut self, words: String, x: usize, anchor: Anchor, ink: Ink) {
        self.words.push((words, [x, self.y + TYPE as usize], anchor, ink));
    }
}

/// A fine line around a picture, so that white ones have an end.
fn edge(sheet: &mut Sheet, at: [usize; 2], size: [usize; 2]) {
    let [left, top] = at.map(|pixels| pixels as f64 - 0.5);
    let [right, bottom] = [left + size[0] as f64 + 1.0, top + size[1] as f64 + 1.0];
    let corners = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
    sheet.polyline(&corners, GREY, 1.0, "");
}

/// Words that have room in so many pixels.
fn fitted(words: &str, room: usize) -> String {
    font::fitted(words, f64::from(TYPE), room.saturating_sub(GAP) as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const RED: [u8; 12] = [200, 0, 0, 200, 0, 0, 200, 0, 0, 200, 0, 0];

    fn block(rows: usize, columns: usize) -> Block<'static> {
        let row = |i: usize| Row {
            label: format!("row {i}"),
            pictures: vec![Picture { size: [2, 2], rgb: &RED }; columns],
            captions: Vec::new(),
        };
        let headings = (0..columns).map(|column| format!("{column} s")).collect();
        Block { title: "a key".into(), headings, rows: (0..rows).map(row).collect() }
    }

    #[test]
    fn forty_rows_make_a_page_and_blocks_stay_whole_where_they_can() {
        let rows = |blocks: Vec<Block>| -> Vec<Vec<usize>> {
            pages(blocks).iter().map(|page| page.iter().map(|b| b.rows.len()).collect()).collect()
        };
        assert_eq!(rows(vec![block(75, 3)]), [[40], [35]]);
        assert_eq!(rows(vec![block(18, 4), block(18, 4), block(18, 4)]), [vec![18, 18], vec![18]]);
        assert_eq!(rows(vec![block(40, 1)]), [[40]]);
    }

    #[test]
    fn no_page_is_wider_than_print_or_taller_than_its_rows() {
        for (rows, columns) in [(1, 1), (75, 3), (40, 12), (400, 7)] {
            let side = side(columns, rows, true);
            for page in pages(vec![block(rows, columns)]) {
                let canvas = drawn(&page, side);
                assert!(
                    canvas.width <= WIDTH && canvas.height <= 7600,
                    "{} x {}",
                    canvas.width,
                    canvas.height
                );
            }
        }
    }

    #[test]
    fn a_picture_stands_in_its_column_beside_its_label() {
        let mut block = block(2, 2);
        block.rows[1].label = "words that are too long to stand beside a row of pictures".into();
        let canvas = drawn(&[block], 160);
        let at = |x: usize, y: usize| &canvas.rgb[3 * (y * canvas.width + x)..][..3];
        let top = GAP + 2 * LINE;
        for (column, row) in [(0, 0), (1, 0), (0, 1), (1, 1)] {
            let [x, y] = [LABEL + GAP + column * (160 + GAP), top + row * (160 + GAP)];
            assert_eq!([at(x + 1, y + 1), at(x + 158, y + 158)], [&RED[..3]; 2]);
            assert_eq!(at(x - 6, y + 80), [255; 3]);
        }
        let label = (GAP..LABEL).any(|x| at(x, top + 80)[0] < 128);
        assert!(label, "words stand beside the first row");
    }
}
