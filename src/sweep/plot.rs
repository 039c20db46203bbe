//! `sweep.svg`: bleached fraction and chromaticity of every probe against duration, a row of two
//! panels for each case. Dashed: the steady state under the same light.

use std::path::Path;

use crate::config::Sweep;
use crate::error::Result;
use crate::frames::atomic;
use crate::plot::palette::{BLACK, BLUE, GREEN, GREY, PURPLE, VERMILION};
use crate::plot::{Anchor, Ink, Marker, Point, Sheet};
use crate::plot::{Axis, Panel};
use crate::run::plot::{inside, note_breaks};
use crate::sweep::contact::{self, MOST_CASES};
use crate::sweep::folder::{Left, Steady};

const WIDTH: f64 = 1200.0;
/// From one row of panels to the next.
const PITCH: f64 = 276.0;
/// Above the first row.
const HEAD: f64 = 74.0;

/// One probe of one case.
struct Course {
    title: String,
    /// Duration, bleached L, M, S, chromaticity x, y.
    points: Vec<(f64, [f64; 5])>,
    steady: [f64; 5],
}

/// Name, colour and mark of each curve; the first three share a panel, and so do the last two.
const CURVES: [(&str, Ink, Marker); 5] = [
    ("L", VERMILION, Marker::Disc),
    ("M", GREEN, Marker::Square),
    ("S", BLUE, Marker::Triangle),
    ("x", BLACK, Marker::Disc),
    ("y", PURPLE, Marker::Square),
];

/// Draws the plot of a sweep.
pub fn write(path: &Path, sweep: &Sweep, left: &[Left]) -> Result<()> {
    let shown = sweep.cases.iter().zip(left).take(MOST_CASES);
    let courses: Vec<Course> = shown
        .flat_map(|(case, left)| {
            courses(&contact::caption(&sweep.keys, case), sweep.keys.is_empty(), left)
        })
        .collect();
    let mut sheet = Sheet::new(WIDTH, HEAD + PITCH * courses.len() as f64);
    legend(&mut sheet);
    for (row, course) in courses.iter().enumerate() {
        draw(&mut sheet, course, sweep, HEAD + PITCH * row as f64);
    }
    atomic::write_text(path, &sheet.svg())
}

/// The probes of a case, in the order of its rows.
fn courses(caption: &str, alone: bool, left: &Left) -> Vec<Course> {
    let probes = left.done.steady.len();
    let rows: Vec<(String, f64, [f64; 5])> = left.rows.lines().skip(1).filter_map(row).collect();
    let course = |(i, steady): (usize, &Steady)| {
        let of_probe = || rows.iter().skip(i).step_by(probes);
        let name = of_probe().next().map(|row| row.0.as_str()).unwrap_or_default();
        let title = if alone { name.to_owned() } else { format!("{caption},  {name}") };
        let [l, m, s] = steady.bleached;
        let [x, y] = steady.chromaticity;
        Course {
            title,
            points: of_probe().map(|row| (row.1, row.2)).collect(),
            steady: [l, m, s, x, y],
        }
    };
    left.done.steady.iter().enumerate().map(course).collect()
}

/// Probe, duration and curves of a row of the table: case, duration, ..., probe, then eleven
/// numbers.
fn row(line: &str) -> Option<(String, f64, [f64; 5])> {
    let mut fields = line.rsplitn(12, ',');
    let numbers: Vec<f64> =
        fields.by_ref().take(11).map_while(|field| field.parse().ok()).collect();
    let &[y, x, _, _, _, s, m, l, ..] = &numbers[..] else { return None };
    let head = fields.next()?;
    let duration = head.split(',').nth(1)?.parse().ok()?;
    Some((head.rsplit(',').next()?.to_owned(), duration, [1.0 - l, 1.0 - m, 1.0 - s, x, y]))
}

fn legend(sheet: &mut Sheet) {
    sheet.text((90.0, 24.0), "bleached fraction of the pigment in", 16, Anchor::Start, BLACK);
    sheet.text((690.0, 24.0), "chromaticity of the percept", 16, Anchor::Start, BLACK);
    for (i, (name, ink, marker)) in CURVES.into_iter().enumerate() {
        let x = if i < 3 { 382.0 + 66.0 * i as f64 } else { 922.0 + 58.0 * (i - 3) as f64 };
        sheet.line((x, 18.0), (x + 28.0, 18.0), ink, 2.0, "");
        sheet.mark((x + 14.0, 18.0), marker, 3.5, ink);
        sheet.text((x + 34.0, 24.0), name, 16, Anchor::Start, ink);
    }
    sheet.line((1042.0, 18.0), (1072.0, 18.0), GREY, 1.4, "6 4");
    sheet.text((1078.0, 24.0), "steady state", 16, Anchor::Start, BLACK);
}

fn draw(sheet: &mut Sheet, course: &Course, sweep: &Sweep, top: f64) {
    sheet.text((90.0, top - 10.0), &course.title, 16, Anchor::Start, BLACK);
    let x = time_axis(&sweep.durations);
    let [low, high] = limits(course);
    let unit = Axis { from: 0.0, to: 1.0, logarithmic: false, every: 0.25, label: "bleached" };
    let colour = Axis {
        from: low,
        to: high,
        logarithmic: false,
        every: if high - low > 1.0 { 0.4 } else { 0.2 },
        label: "x, y",
    };
    let panels = [(90.0, unit, 0..3), (690.0, colour, 3..5)];
    for (left, y, curves) in panels {
        let panel = Panel { left, top, width: 480.0, height: 190.0, x, y };
        panel.frame(sheet);
        for curve in curves.clone() {
            draw_curve(sheet, &panel, course, curve);
        }
        let values =
            course.points.iter().flat_map(|(_, values)| values[curves.clone()].iter().copied());
        note_breaks(sheet, &panel, values);
    }
}

fn draw_curve(sheet: &mut Sheet, panel: &Panel, course: &Course, curve: usize) {
    let (_, ink, marker) = CURVES[curve];
    let steady = course.steady[curve];
    if inside(panel, steady) {
        sheet.line(panel.at(panel.x.from, steady), panel.at(panel.x.to, steady), ink, 1.4, "6 4");
    }
    let place = |&(time, values): &(f64, [f64; 5])| panel.at(time.max(panel.x.from), values[curve]);
    let r = if course.points.len() > 40 { 2.0 } else { 3.5 };
    for piece in course.points.split(|(_, values)| !inside(panel, values[curve])) {
        let piece: Vec<Point> = piece.iter().map(place).collect();
        sheet.polyline(&piece, ink, 2.0, "");
        piece.into_iter().for_each(|at| sheet.mark(at, marker, r, ink));
    }
}

/// Whole powers of ten around the durations; the start stands at the left edge.
fn time_axis(durations: &[f64]) -> Axis<'static> {
    let least = durations.iter().copied().find(|&d| d > 0.0).unwrap_or(1.0).log10();
    let last = durations.last().copied().filter(|&d| d > 0.0).unwrap_or(1.0).log10();
    let begins_at_zero = durations.first() == Some(&0.0);
    let from = if begins_at_zero {
        (least - 1e-9).floor() - f64::from(least.fract() == 0.0)
    } else {
        (least + 1e-9).floor()
    };
    let to = (last - 1e-9).ceil().max(from + 1.0);
    let label = if begins_at_zero { "duration (s), left edge: the start" } else { "duration (s)" };
    Axis {
        from: 10f64.powf(from),
        to: 10f64.powf(to),
        logarithmic: true,
        every: ((to - from) / 8.0).ceil(),
        label,
    }
}

/// Steps that hold the chromaticities of a course; colours far outside the lights that exist leave
/// the panel.
fn limits(course: &Course) -> [f64; 2] {
    let seen = course.points.iter().flat_map(|point| &point.1[3..]).chain(&course.steady[3..]);
    let (low, high) = seen
        .filter(|v| v.is_finite())
        .fold((0.2, 0.6), |(a, b): (f64, f64), &v| (a.min(v), b.max(v)));
    let step = if high.min(1.2) - low.max(-0.4) > 1.0 { 0.4 } else { 0.2 };
    [(low.max(-0.4) / step).floor() * step, (high.min(1.2) / step).ceil() * step]
}
