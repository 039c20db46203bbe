//! Marks of a look on its picture: a cross at the gaze, and the time.

use super::palette::{BLACK, WHITE};
use super::raster::Canvas;
use super::sheet::{Anchor, Point, Sheet};

/// Where was looked, and when.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Marks {
    /// In pixels, centres at integers.
    pub(crate) gaze: [f64; 2],
    /// Of the frame's end, s.
    pub(crate) time: f64,
}

/// Directions of the cross's arms.
const ARMS: [Point; 4] = [(1.0, 0.0), (0.0, 1.0), (-1.0, 0.0), (0.0, -1.0)];

impl Marks {
    /// Draws the marks, white with a black edge, on a picture of 8-bit sRGB.
    pub(crate) fn draw(&self, width: usize, height: usize, rgb: Vec<u8>) -> Vec<u8> {
        let mut canvas = Canvas::over(width, height, rgb);
        let mut sheet = Sheet::new(width as f64, height as f64);
        self.cross(&mut sheet);
        self.clock(&mut sheet);
        canvas.draw(&sheet);
        canvas.rgb
    }

    /// Four arms around the gaze; what is looked at stays visible between them.
    fn cross(&self, sheet: &mut Sheet) {
        let [x, y] = self.gaze.map(|at| at + 0.5);
        let reach = (sheet.height / 24.0).clamp(4.0, 40.0);
        let line = (reach / 8.0).max(1.0);
        for (ink, edge) in [(BLACK, line), (WHITE, 0.0)] {
            for (dx, dy) in ARMS {
                let at = |r: f64| (x + r * dx, y + r * dy);
                let (from, to) = (at(0.4 * reach - 0.5 * edge), at(reach + 0.5 * edge));
                sheet.line(from, to, ink, line + edge, "");
            }
        }
    }

    /// The time at the bottom left.
    fn clock(&self, sheet: &mut Sheet) {
        let size = (sheet.height / 18.0).clamp(9.0, 60.0);
        let (x, y, edge) = (0.5 * size, sheet.height - 0.5 * size, (size / 16.0).max(1.0));
        let words = seconds(self.time);
        let mut write = |x: f64, y: f64, ink| {
            sheet.text((x, y), &words, size as u32, Anchor::Start, ink);
        };
        for (dx, dy) in [(-1.0, -1.0), (1.0, -1.0), (-1.0, 1.0), (1.0, 1.0)] {
            write(x + edge * dx, y + edge * dy, BLACK);
        }
        write(x, y, WHITE);
    }
}

/// A time to three digits or more.
fn seconds(time: f64) -> String {
    let decimals = if time < 1.0 { 3 } else { 2 };
    format!("{time:.decimals$} s")
}

#[cfg(test)]
mod tests {
    use super::*;

    const SIZE: [usize; 2] = [160, 120];

    /// The pixels that marks change on grey.
    fn changed(marks: Marks) -> Vec<[usize; 2]> {
        let grey = vec![128; 3 * SIZE[0] * SIZE[1]];
        let drawn = marks.draw(SIZE[0], SIZE[1], grey);
        let touched = |i: &usize| drawn[3 * i..][..3] != [128; 3];
        let pixels = (0..SIZE[0] * SIZE[1]).filter(touched);
        pixels.map(|i| [i % SIZE[0], i / SIZE[0]]).collect()
    }

    #[test]
    fn the_cross_stands_at_the_gaze_and_leaves_what_is_looked_at_free() {
        for gaze in [[80.0, 40.0], [20.0, 60.0], [150.0, 20.0]] {
            let all = changed(Marks { gaze, time: 1.0 });
            let cross: Vec<_> = all.into_iter().filter(|at| at[1] < 100).collect();
            let mean = [0, 1]
                .map(|i| cross.iter().map(|at| at[i] as f64).sum::<f64>() / cross.len() as f64);
            assert!((0..2).all(|i| (mean[i] - gaze[i]).abs() < 0.05), "{mean:?} of {gaze:?}");
            let far = |at: &&[usize; 2]| (0..2).any(|i| (at[i] as f64 - gaze[i]).abs() > 7.0);
            assert!(cross.len() > 30 && cross.iter().find(far).is_none());
            assert!(!cross.contains(&gaze.map(|at| at as usize)), "what is looked at is free");
        }
    }

    #[test]
    fn the_clock_stands_at_the_bottom_left_and_shows_the_time() {
        let of = |time: f64| changed(Marks { gaze: [80.0, 40.0], time });
        let clock = |time: f64| of(time).into_iter().filter(|at| at[1] > 60).collect::<Vec<_>>();
        assert!(clock(12.5).iter().all(|at| at[0] < 50 && at[1] > 100), "{:?}", clock(12.5));
        assert_ne!(clock(12.5), clock(12.6));
        assert_eq!(
            [0.0, 0.0417, 3.0, 59.999].map(seconds),
            ["0.000 s", "0.042 s", "3.00 s", "60.00 s"]
        );
    }

    #[test]
    fn a_gaze_beyond_the_picture_leaves_only_the_time() {
        let all = changed(Marks { gaze: [-400.0, 1e9], time: 1.0 });
        assert!(!all.is_empty() && all.iter().all(|at| at[0] < 50 && at[1] > 100));
        assert!(Marks { gaze: [0.0; 2], time: 1.0 }.draw(1, 1, vec![9; 3]).len() == 3);
    }
}
