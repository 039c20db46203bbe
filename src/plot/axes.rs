//! A panel: two axes, their ticks and labels, and where a pair of values lies between them.

use super::lines::{apart, thinned};
use super::palette::{BLACK, FAINT, GREY};
use super::sheet::{Anchor, Ink, Marker, Point, Sheet};

/// One axis. Logarithmic axes are marked at whole powers of ten, `every` so many.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Axis<'a> {
    pub(crate) from: f64,
    pub(crate) to: f64,
    pub(crate) logarithmic: bool,
    /// Between labelled ticks: powers of ten, or units.
    pub(crate) every: f64,
    pub(crate) label: &'a str,
}

impl<'a> Axis<'a> {
    /// Even steps, labelled at round values, `most` of them or fewer.
    pub(crate) fn linear(from: f64, to: f64, most: f64, label: &'a str) -> Self {
        let to = if to > from { to } else { from + 1.0 };
        let decade = 10f64.powf(((to - from) / most).log10().floor());
        let steps = [1.0, 2.0, 5.0, 10.0].map(|n| n * decade);
        let every = steps.into_iter().find(|step| (to - from) / step <= most * (1.0 + 1e-9));
        Axis { from, to, logarithmic: false, every: every.unwrap_or(10.0 * decade), label }
    }

    /// Powers of ten, labelled at whole ones, `most` of them or fewer.
    pub(crate) fn logarithmic(from: f64, to: f64, most: f64, label: &'a str) -> Self {
        let every = ((to / from).log10() / most).ceil().max(1.0);
        Axis { from, to, logarithmic: true, every, label }
    }

    fn place(&self, value: f64) -> f64 {
        if self.logarithmic { value.log10() } else { value }
    }

    /// 0 at `from`, 1 at `to`; values beyond the ends stay at the ends.
    fn fraction(&self, value: f64) -> f64 {
        let [from, to, at] = [self.from, self.to, value].map(|v| self.place(v));
        let fraction = (at - from) / (to - from);
        if fraction.is_nan() { 1.0 } else { fraction.clamp(0.0, 1.0) }
    }

    /// The value at a fraction of the way from `from` to `to`.
    pub(crate) fn value(&self, fraction: f64) -> f64 {
        let [from, to] = [self.from, self.to].map(|v| self.place(v));
        let place = from + fraction * (to - from);
        if self.logarithmic { 10f64.powf(place) } else { place }
    }

    /// Whether a value lies on the axis, but for rounding.
    pub(crate) fn holds(&self, value: f64) -> bool {
        let [from, to, at] = [self.from, self.to, value].map(|v| self.place(v));
        let slack = 1e-6 * (to - from);
        (from - slack..=to + slack).contains(&at)
    }

    /// The labelled values with their labels.
    fn ticks(&self) -> Vec<(f64, String)> {
        let [from, to] = [self.from, self.to].map(|v| self.place(v));
        let first = (from / self.every - 1e-9).ceil() as i64;
        let last = (to / self.every + 1e-9).floor() as i64;
        let values = (first..=last).map(|i| i as f64 * self.every);
        let tick = |v: f64| match self.logarithmic {
            true => (10f64.powf(v), power(v)),
            false if v.abs() >= 1e4 => (v, raised(&format!("{v:e}"))),
            false => (v, format!("{}", (v * 1e9).round() / 1e9)),
        };
        values.map(tick).collect()
    }
}

/// A number in two digits, four below 10⁴ and above a thousandth.
pub(crate) fn written(value: f64) -> String {
    let size = value.abs().max(f64::MIN_POSITIVE).log10().floor();
    match value.abs() {
        0.0 => "0".into(),
        1e4.. | ..1e-3 => raised(&format!("{value:.1e}")),
        _ => {
            let unit = 10f64.powf((3.0 - size).max(0.0));
            ((value * unit).round() / unit).to_string()
        }
    }
}

/// A number as `2.5e7` in type: 2.5·10⁷.
fn raised(text: &str) -> String {
    let (digits, size) = text.split_once('e').unwrap_or((text, "0"));
    match (digits.trim_end_matches(".0"), power(size.parse().unwrap_or(0.0))) {
        ("1", power) => power,
        (digits, power) => format!("{digits}·{power}"),
    }
}

/// 10 to a whole power, in type: 10⁻³; 1 and 10 as they are.
pub(crate) fn power(exponent: f64) -> String {
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
pub(crate) struct Panel<'a> {
    pub(crate) left: f64,
    pub(crate) top: f64,
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) x: Axis<'a>,
    pub(crate) y: Axis<'a>,
}

/// Height of tick labels.
const TICK_TYPE: u32 = 15;

/// Height of the names of axes.
const LABEL_TYPE: u32 = 16;

impl Panel<'_> {
    /// Where a pair of values lies on the sheet.
    pub(crate) fn at(&self, x: f64, y: f64) -> Point {
        let down = 1.0 - self.y.fraction(y);
        (self.left + self.width * self.x.fraction(x), self.top + self.height * down)
    }

    pub(crate) fn right(&self) -> f64 {
        self.left + self.width
    }

    pub(crate) fn bottom(&self) -> f64 {
        self.top + self.height
    }

    /// Draws grid, frame, ticks and labels.
    pub(crate) fn frame(&self, sheet: &mut Sheet) {
        self.framed(sheet, [true, true]);
    }

    /// Draws grid and frame, with ticks and labels of x and of y where asked for.
    pub(crate) fn framed(&self, sheet: &mut Sheet, labelled: [bool; 2]) {
        self.ticks_of_x(sheet, labelled[0]);
        self.ticks_of_y(sheet, labelled[1]);
        let (right, bottom) = (self.right(), self.bottom());
        let corners =
            [(self.left, self.top), (right, self.top), (right, bottom), (self.left, bottom)];
        for i in 0..4 {
            sheet.line(corners[i], corners[(i + 1) % 4], BLACK, 1.0, "");
        }
    }

    fn ticks_of_x(&self, sheet: &mut Sheet, labelled: bool) {
        let bottom = self.bottom();
        for (value, label) in self.x.ticks() {
            let x = self.at(value, self.y.from).0;
            sheet.line((x, self.top), (x, bottom), FAINT, 0.8, "");
            sheet.line((x, bottom), (x, bottom + 5.0), BLACK, 1.0, "");
            if labelled {
                sheet.text((x, bottom + 20.0), &label, TICK_TYPE, Anchor::Middle, BLACK);
            }
        }
        if labelled && !self.x.label.is_empty() {
            let at = (self.left + 0.5 * self.width, bottom + 42.0);
            sheet.text(at, self.x.label, LABEL_TYPE, Anchor::Middle, BLACK);
        }
    }

    fn ticks_of_y(&self, sheet: &mut Sheet, labelled: bool) {
        for (value, label) in self.y.ticks() {
            let y = self.at(self.x.from, value).1;
            sheet.line((self.left, y), (self.right(), y), FAINT, 0.8, "");
            sheet.line((self.left - 5.0, y), (self.left, y), BLACK, 1.0, "");
            if labelled {
                sheet.text((self.left - 8.0, y + 5.0), &label, TICK_TYPE, Anchor::End, BLACK);
            }
        }
        if labelled && !self.y.label.is_empty() {
            let at = (self.left - 50.0, self.top + 0.5 * self.height);
            sheet.upward(at, self.y.label, LABEL_TYPE, BLACK);
        }
    }

    /// Draws a curve through pairs of values, in pieces where it leaves the panel or has no value;
    /// a piece of one pair is a dot.
    pub(crate) fn curve(
        &self,
        sheet: &mut Sheet,
        values: &[(f64, f64)],
        ink: Ink,
        width: f64,
        dash: &str,
    ) {
        for piece in values.split(|&(x, y)| !self.x.holds(x) || !self.y.holds(y)) {
            let all: Vec<Point> = piece.iter().map(|&(x, y)| self.at(x, y)).collect();
            let points = thinned(&all);
            match points[..] {
                [] => {}
                [alone] => sheet.mark(alone, Marker::Disc, 1.4 * width, ink),
                _ => sheet.polyline(&points, ink, width, dash),
            }
        }
    }

    /// Names curves beside the panel's right edge, each at the height of a value where there is
    /// room, apart where there is not.
    pub(crate) fn name_ends(&self, sheet: &mut Sheet, names: &[(f64, &str, Ink)], size: u32) {
        let wanted: Vec<f64> = names.iter().map(|(y, ..)| self.at(self.x.to, *y).1).collect();
        let room = [self.top, self.bottom()];
        let placed = apart(&wanted, 1.05 * f64::from(size), room);
        for ((wanted, placed), (_, name, ink)) in wanted.iter().zip(placed).zip(names) {
            let (edge, words) = (self.right() + 1.0, self.right() + 12.0);
            sheet.line((edge, *wanted), (words - 2.0, placed), GREY, 0.7, "");
            let at = (words, placed + 0.35 * f64::from(size));
            sheet.text(at, name, size, Anchor::Start, *ink);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_shortly_and_large_ticks_as_powers() {
        let few = [0.0, 12.34567, 0.25, 2.04e4, 9.99e7, 3e-5].map(written);
        assert_eq!(few, ["0", "12.35", "0.25", "2·10⁴", "10⁸", "3·10⁻⁵"]);
        let ticks = Axis::linear(0.0, 7e5, 4.0, "").ticks();
        let labels: Vec<&str> = ticks.iter().map(|tick| tick.1.as_str()).collect();
        assert_eq!(labels, ["0", "2·10⁵", "4·10⁵", "6·10⁵"]);
    }

    #[test]
    fn round_values_are_labelled_and_no_more_than_asked_for() {
        let labels = |axis: Axis| axis.ticks().into_iter().map(|tick| tick.1).collect::<Vec<_>>();
        assert_eq!(labels(Axis::linear(0.0, 4.0, 4.0, "")), ["0", "1", "2", "3", "4"]);
        assert_eq!(labels(Axis::linear(0.0, 630.0, 4.0, "")), ["0", "200", "400", "600"]);
        assert_eq!(labels(Axis::linear(0.2, 0.75, 4.0, "")), ["0.2", "0.4", "0.6"]);
        assert_eq!(labels(Axis::logarithmic(1e-3, 1e3, 4.0, "")), ["10⁻²", "1", "10²"]);
        assert_eq!(labels(Axis::logarithmic(0.03, 20.0, 5.0, "")), ["10⁻¹", "1", "10"]);
    }

    #[test]
    fn a_fraction_of_an_axis_and_its_value_are_each_others_inverse() {
        for axis in [Axis::linear(-2.0, 7.0, 5.0, ""), Axis::logarithmic(1e-3, 50.0, 5.0, "")] {
            for fraction in [0.0, 0.3, 1.0] {
                approx::assert_relative_eq!(
                    axis.fraction(axis.value(fraction)),
                    fraction,
                    epsilon = 1e-12
                );
            }
        }
    }
}
