//! A panel: two axes, their ticks and labels, and where a value lies between them.

use super::palette::{BLACK, FAINT};
use super::sheet::{Anchor, Point, Sheet};

/// One axis. Logarithmic axes are marked at whole powers of ten, `every` so many.
#[derive(Clone, Copy, Debug)]
pub struct Axis<'a> {
    pub from: f64,
    pub to: f64,
    pub logarithmic: bool,
    /// Between labelled ticks: powers of ten, or units.
    pub every: f64,
    pub label: &'a str,
}

impl Axis<'_> {
    /// 0 at `from`, 1 at `to`; values beyond the ends stay at the ends.
    fn fraction(&self, value: f64) -> f64 {
        let place = |v: f64| if self.logarithmic { v.log10() } else { v };
        let fraction = (place(value) - place(self.from)) / (place(self.to) - place(self.from));
        if fraction.is_nan() { 1.0 } else { fraction.clamp(0.0, 1.0) }
    }

    /// The labelled values with their labels.
    fn ticks(&self) -> Vec<(f64, String)> {
        let (from, to) = if self.logarithmic {
            (self.from.log10(), self.to.log10())
        } else {
            (self.from, self.to)
        };
        let first = (from / self.every - 1e-9).ceil() as i64;
        let last = (to / self.every + 1e-9).floor() as i64;
        let values = (first..=last).map(|i| i as f64 * self.every);
        values
            .map(|v| {
                if self.logarithmic {
                    (10f64.powf(v), power(v))
                } else {
                    (v, format!("{}", (v * 1e9).round() / 1e9))
                }
            })
            .collect()
    }
}

/// 10 to a whole power, in type: 10⁻³; 1 and 10 as they are.
pub fn power(exponent: f64) -> String {
    const DIGITS: [char; 10] = ['⁰', '¹', '²', '³', '⁴', '⁵', '⁶', '⁷', '⁸', '⁹'];
    match exponent as i64 {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        e => {
            let digits = e.unsigned_abs().to_string();
            let raised: String = digits.bytes().map(|b| DIGITS[usize::from(b - b'0')]).collect();
            format!("10{}{raised}", if e < 0 { "⁻" } else { "" })
        }
    }
}

/// A rectangle of the sheet with axes.
#[derive(Clone, Copy, Debug)]
pub struct Panel<'a> {
    pub left: f64,
    pub top: f64,
    pub width: f64,
    pub height: f64,
    pub x: Axis<'a>,
    pub y: Axis<'a>,
}

/// Height of tick labels.
const TICK_TYPE: u32 = 15;

/// Height of the names of axes.
const LABEL_TYPE: u32 = 16;

impl Panel<'_> {
    /// Where a pair of values lies on the sheet.
    pub fn at(&self, x: f64, y: f64) -> Point {
        (
            self.left + self.width * self.x.fraction(x),
            self.top + self.height * (1.0 - self.y.fraction(y)),
        )
    }

    pub fn right(&self) -> f64 {
        self.left + self.width
    }

    pub fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Draw grid, frame, ticks and labels.
    pub fn frame(&self, sheet: &mut Sheet) {
        let (right, bottom) = (self.right(), self.bottom());
        for (value, label) in self.x.ticks() {
            let x = self.at(value, self.y.from).0;
            sheet.line((x, self.top), (x, bottom), FAINT, 0.8, "");
            sheet.line((x, bottom), (x, bottom + 5.0), BLACK, 1.0, "");
            sheet.text((x, bottom + 20.0), &label, TICK_TYPE, Anchor::Middle, BLACK);
        }
        for (value, label) in self.y.ticks() {
            let y = self.at(self.x.from, value).1;
            sheet.line((self.left, y), (right, y), FAINT, 0.8, "");
            sheet.line((self.left - 5.0, y), (self.left, y), BLACK, 1.0, "");
            sheet.text((self.left - 8.0, y + 5.0), &label, TICK_TYPE, Anchor::End, BLACK);
        }
        let corners =
            [(self.left, self.top), (right, self.top), (right, bottom), (self.left, bottom)];
        for i in 0..4 {
            sheet.line(corners[i], corners[(i + 1) % 4], BLACK, 1.0, "");
        }
        sheet.text(
            (0.5 * (self.left + right), bottom + 42.0),
            self.x.label,
            LABEL_TYPE,
            Anchor::Middle,
            BLACK,
        );
        sheet.upward(
            (self.left - 50.0, 0.5 * (self.top + bottom)),
            self.y.label,
            LABEL_TYPE,
            BLACK,
        );
    }
}
