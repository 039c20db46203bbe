//! Raster: a sheet as pixels, by `zeno`'s masks.

use std::path::Path;

use zeno::{Cap, Command, Fill, Join, Mask, Origin, PathBuilder, Style, Transform};

use crate::error::Result;
use crate::frames;

use super::font;
use super::sheet::{Anchor, Ink, Item, Point, Sheet, Stroke, Words};

/// A picture in the making: 8-bit sRGB, rows from the top.
pub(crate) struct Canvas {
    pub(crate) width: usize,
    pub(crate) height: usize,
    pub(crate) rgb: Vec<u8>,
    /// Pixels to the unit.
    scale: f32,
}

impl Canvas {
    /// White, so many pixels wide and high.
    pub(crate) fn white(width: usize, height: usize, scale: f64) -> Self {
        Canvas { width, height, rgb: vec![255; 3 * width * height], scale: scale as f32 }
    }

    /// A picture of 8-bit sRGB, a unit to the pixel.
    pub(crate) fn over(width: usize, height: usize, rgb: Vec<u8>) -> Self {
        Canvas { width, height, rgb, scale: 1.0 }
    }

    /// A sheet, so many pixels to the unit.
    pub(crate) fn of(sheet: &Sheet, scale: f64) -> Self {
        let [width, height] =
            [sheet.width, sheet.height].map(|units| (units * scale).ceil() as usize);
        let mut canvas = Canvas::white(width, height, scale);
        canvas.draw(sheet);
        canvas
    }

    /// Lays a sheet's items on what is there, the sheet's corner in the canvas's.
    pub(crate) fn draw(&mut self, sheet: &Sheet) {
        for item in &sheet.items {
            match item {
                Item::Words(words) => self.words(words),
                Item::Path { points, closed, fill, stroke } => {
                    self.shape(&path(points, *closed), *fill, stroke.as_ref());
                }
                Item::Circle { at, r, fill, stroke } => {
                    let mut path = Vec::new();
                    path.add_circle([at.0 as f32, at.1 as f32], *r as f32);
                    self.shape(&path, *fill, stroke.as_ref());
                }
            }
        }
    }

    /// Puts a picture of 8-bit sRGB down with its top left corner at a pixel; what has no room is left out.
    pub(crate) fn paste(&mut self, [x, y]: [usize; 2], width: usize, rgb: &[u8]) {
        let fits = 3 * width.min(self.width.saturating_sub(x));
        for (row, from) in
            rgb.chunks_exact(3 * width.max(1)).enumerate().take(self.height.saturating_sub(y))
        {
            let to = 3 * ((y + row) * self.width + x);
            self.rgb[to..to + fits].copy_from_slice(&from[..fits]);
        }
    }

    /// Writes the picture as PNG, whole or not at all.
    ///
    /// # Errors
    /// A file that cannot be written.
    pub(crate) fn write(&self, path: &Path) -> Result<()> {
        frames::write_png(path, self.width, self.height, &self.rgb)
    }

    fn words(&mut self, words: &Words) {
        let width = font::width(&words.words, words.size, words.bold);
        let left = match words.anchor {
            Anchor::Start => 0.0,
            Anchor::Middle => -0.5 * width,
            Anchor::End => -width,
        };
        let (along, down) = if words.upward { (0.0, -1.0) } else { (1.0, 0.0) };
        let begin = [words.at.0 + left * along, words.at.1 + left * down];
        let [x, y] = begin.map(|units| units as f32 * self.scale);
        let [along, down] = [along, down].map(|share| share as f32 * self.scale);
        let place = Transform::new(along, down, -down, along, x, y);
        let outlines = font::outlines(&words.words, words.size, words.bold);
        self.ink(&outlines, Fill::NonZero.into(), place, words.ink);
    }

    fn shape(&mut self, path: &[Command], fill: Option<Ink>, stroke: Option<&Stroke>) {
        let place = Transform::scale(self.scale, self.scale);
        if let Some(ink) = fill {
            self.ink(path, Fill::NonZero.into(), place, ink);
        }
        if let Some(Stroke { ink, width, dashes }) = stroke {
            let dashes: Vec<f32> = dashes.iter().map(|length| *length as f32).collect();
            let mut pen = zeno::Stroke::new(*width as f32);
            pen.join(Join::Round).cap(Cap::Butt).dash(&dashes, 0.0);
            self.ink(path, pen.into(), place, *ink);
        }
    }

    fn ink(&mut self, path: &[Command], style: Style, place: Transform, ink: Ink) {
        let (mask, at) =
            Mask::new(path).style(style).transform(Some(place)).origin(Origin::TopLeft).render();
        let colour = [ink.0, ink.1, ink.2];
        for (row, covered) in mask.chunks_exact((at.width as usize).max(1)).enumerate() {
            let Some(y) = inside(at.top, row, self.height) else { continue };
            for (column, &alpha) in covered.iter().enumerate().filter(|(_, alpha)| **alpha > 0) {
                let Some(x) = inside(at.left, column, self.width) else { continue };
                let pixel = &mut self.rgb[3 * (y * self.width + x)..][..3];
                pixel
                    .iter_mut()
                    .zip(colour)
                    .for_each(|(under, over)| *under = mixed(*under, over, alpha));
            }
        }
    }
}

/// A place of a mask on the canvas, if it lies there.
fn inside(from: i32, step: usize, size: usize) -> Option<usize> {
    usize::try_from(i64::from(from) + step as i64).ok().filter(|at| *at < size)
}

/// A colour over another that it covers by `alpha` of 255.
fn mixed(under: u8, over: u8, alpha: u8) -> u8 {
    let [under, over, alpha] = [under, over, alpha].map(u32::from);
    ((under * (255 - alpha) + over * alpha + 127) / 255) as u8
}

fn path(points: &[Point], closed: bool) -> Vec<Command> {
    let mut path = Vec::with_capacity(points.len() + 1);
    for (i, &(x, y)) in points.iter().enumerate() {
        let at = [x as f32, y as f32];
        if i == 0 {
            path.move_to(at)
        } else {
            path.line_to(at)
        };
    }
    if closed {
        path.close();
    }
    path
}

#[cfg(test)]
mod tests {
    use super::super::palette::BLACK;
    use super::super::sheet::Marker;
    use super::*;

    fn at(canvas: &Canvas, x: usize, y: usize) -> [u8; 3] {
        let pixel = 3 * (y * canvas.width + x);
        [0, 1, 2].map(|i| canvas.rgb[pixel + i])
    }

    #[test]
    fn a_block_a_line_and_a_mark_cover_the_pixels_that_they_say() {
        let (red, mut sheet) = (Ink(200, 0, 0), Sheet::new(40.0, 20.0));
        sheet.block((2.0, 3.0), 4.0, 5.0, red);
        sheet.line((20.0, 10.0), (30.0, 10.0), BLACK, 2.0, "");
        sheet.mark((35.0, 5.0), Marker::Disc, 3.0, red);
        let canvas = Canvas::of(&sheet, 2.0);
        assert_eq!((canvas.width, canvas.height), (80, 40));
        let corners = [(4, 6), (11, 15), (3, 6), (12, 15), (4, 5), (11, 16)];
        assert_eq!(
            corners.map(|(x, y)| at(&canvas, x, y)),
            [[200, 0, 0], [200, 0, 0], [255; 3], [255; 3], [255; 3], [255; 3]]
        );
        assert_eq!([18, 21].map(|y| at(&canvas, 50, y)), [[0; 3]; 2]);
        assert_eq!([(50, 17), (50, 22), (39, 20)].map(|(x, y)| at(&canvas, x, y)), [[255; 3]; 3]);
        assert_eq!(at(&canvas, 70, 10), [200, 0, 0]);
    }

    #[test]
    fn dashes_leave_gaps_along_curves_too() {
        let mut sheet = Sheet::new(40.0, 10.0);
        sheet.polyline(&[(0.0, 5.0), (7.0, 5.0), (40.0, 5.0)], BLACK, 2.0, "10 5");
        let canvas = Canvas::of(&sheet, 1.0);
        assert_eq!(
            [5, 12, 20, 27].map(|x| at(&canvas, x, 5)),
            [[0; 3], [255; 3], [0; 3], [255; 3]]
        );
    }

    #[test]
    fn what_lies_outside_is_left_out() {
        let mut sheet = Sheet::new(10.0, 10.0);
        sheet.block((-5.0, -5.0), 7.0, 30.0, BLACK);
        sheet.text((8.0, 8.0), "beyond the edge", 16, Anchor::Start, BLACK);
        let mut canvas = Canvas::of(&sheet, 1.0);
        canvas.paste([8, 9], 4, &[9; 3 * 4 * 2]);
        assert_eq!(
            [(1, 9), (8, 9), (9, 9)].map(|(x, y)| at(&canvas, x, y)),
            [[0; 3], [9; 3], [9; 3]]
        );
    }

    /// H has two stems and a bar between them, whichever way it reads.
    #[test]
    fn words_stand_where_their_anchor_says() {
        let mut sheet = Sheet::new(100.0, 100.0);
        sheet.text((50.0, 50.0), "H", 40, Anchor::Middle, BLACK);
        let canvas = Canvas::of(&sheet, 1.0);
        // Advance 1540, stems at 201 to 402 and 1138 to 1339, bar 881 to 713 high, of 2048.
        let left = 50.0 - 0.5 * 40.0 * 1540.0 / 2048.0;
        let stem = |units: f64| (left + 40.0 * units / 2048.0).floor() as usize;
        assert_eq!([stem(300.0), stem(1240.0)].map(|x| at(&canvas, x, 40)), [[0; 3]; 2]);
        assert_eq!([25, 34, 45].map(|y| at(&canvas, 50, y)), [[255; 3], [0; 3], [255; 3]]);
        let mut sheet = Sheet::new(100.0, 100.0);
        sheet.upward((50.0, 50.0), "H", 40, BLACK);
        let canvas = Canvas::of(&sheet, 1.0);
        assert_eq!([stem(300.0), stem(1240.0)].map(|x| at(&canvas, 40, 99 - x)), [[0; 3]; 2]);
        assert_eq!([25, 34, 45].map(|x| at(&canvas, x, 50)), [[255; 3], [0; 3], [255; 3]]);
    }
}
