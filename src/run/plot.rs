//! `probes.svg`: what the probes' pigments and percepts did in time, a row of two panels for each
//! probe.

use std::path::Path;

use crate::error::Result;
use crate::frames::atomic;
use crate::plot::palette::{BLACK, BLUE, GREEN, PURPLE, VERMILION, WHITE};
use crate::plot::{Anchor, Ink, Point, Sheet};
use crate::plot::{Axis, Panel};
use crate::run::record::Reading;

const WIDTH: f64 = 1200.0;
/// Height of a probe's row.
const ROW: f64 = 360.0;
/// The axis; chromaticities beyond it, which no light has, leave a gap.
const CHROMATICITY: (f64, f64) = (0.0, 0.8);

/// A curve of a panel: name, colour, dashes, and what it shows of a reading.
type Curve = (&'static str, Ink, &'static str, fn(&Reading) -> f64);

const BLEACHED: [Curve; 3] = [
    ("L", VERMILION, "", |r| 1.0 - r.p[0]),
    ("M", GREEN, "9,4", |r| 1.0 - r.p[1]),
    ("S", BLUE, "2,3", |r| 1.0 - r.p[2]),
];
const SEEN: [Curve; 2] =
    [("x", BLACK, "", |r| r.chromaticity()[0]), ("y", PURPLE, "9,4", |r| r.chromaticity()[1])];

/// Draws bleached fractions and chromaticity of every probe against time.
pub fn write(path: &Path, history: &[(f64, Vec<Reading>)]) -> Result<()> {
    atomic::write_text(path, &drawn(history).svg())
}

fn drawn(history: &[(f64, Vec<Reading>)]) -> Sheet {
    let probes = history.first().map_or(0, |(_, readings)| readings.len());
    let height = ROW * probes.max(1) as f64 + 10.0;
    let mut sheet = Sheet::new(WIDTH, height);
    sheet.block((0.0, 0.0), WIDTH, height, WHITE);
    for probe in 0..probes {
        let top = ROW * probe as f64 + 50.0;
        let of_probe: Vec<(f64, &Reading)> =
            history.iter().filter_map(|(t, readings)| Some((*t, readings.get(probe)?))).collect();
        let name = of_probe.first().map_or("", |(_, reading)| reading.probe.as_str());
        sheet.bold((80.0, top - 18.0), name, 18, Anchor::Start, BLACK);
        let x = time_axis(history);
        let bleached =
            Axis { from: 0.0, to: 1.0, logarithmic: false, every: 0.2, label: "bleached fraction" };
        let (from, to) = CHROMATICITY;
        let seen =
            Axis { from, to, logarithmic: false, every: 0.2, label: "chromaticity of the percept" };
        for (left, y, curves) in [(80.0, bleached, &BLEACHED[..]), (670.0, seen, &SEEN[..])] {
            let panel = Panel { left, top, width: 500.0, height: ROW - 110.0, x, y };
            panel.frame(&mut sheet);
            legend(&mut sheet, &panel, curves);
            curves.iter().for_each(|curve| draw(&mut sheet, &panel, curve, &of_probe));
            let values = of_probe
                .iter()
                .flat_map(|(_, reading)| curves.iter().map(|curve| curve.3(reading)));
            note_breaks(&mut sheet, &panel, values);
        }
    }
    sheet
}

/// Logarithmic where the times span more than two decades.
fn time_axis(history: &[(f64, Vec<Reading>)]) -> Axis<'static> {
    let first = history.first().map_or(0.0, |(t, _)| *t);
    let last = history.last().map_or(1.0, |(t, _)| *t);
    if first > 0.0 && last > 100.0 * first {
        return Axis { from: first, to: last, logarithmic: true, every: 1.0, label: "time (s)" };
    }
    let decade = 10f64.powf((last / 2.0).log10().floor());
    let every = [1.0, 2.0, 5.0].map(|n| n * decade).into_iter().find(|step| last / step <= 8.0);
    Axis {
        from: 0.0,
        to: last,
        logarithmic: false,
        every: every.unwrap_or(last),
        label: "time (s)",
    }
}

/// Samples of the panel's curves, over its right end.
fn legend(sheet: &mut Sheet, panel: &Panel, curves: &[Curve]) {
    for (i, (name, ink, dashes, _)) in curves.iter().enumerate() {
        let left = panel.right() - 75.0 * (curves.len() - i) as f64 + 15.0;
        let y = panel.top - 23.0;
        sheet.line((left, y), (left + 36.0, y), *ink, 2.4, dashes);
        sheet.text((left + 43.0, y + 5.0), name, 16, Anchor::Start, BLACK);
    }
}

/// Whether a value has its place in a panel, but for rounding.
pub(crate) fn inside(panel: &Panel, value: f64) -> bool {
    let slack = 1e-6 * (panel.y.to - panel.y.from);
    (panel.y.from - slack..=panel.y.to + slack).contains(&value)
}

/// Says below a panel why its lines break, if they do. Black alone has no chromaticity.
pub(crate) fn note_breaks(sheet: &mut Sheet, panel: &Panel, values: impl Iterator<Item = f64>) {
    let (black, outside): (Vec<f64>, Vec<f64>) =
        values.filter(|&v| !inside(panel, v)).partition(|v| v.is_nan());
    let words = match (black.is_empty(), outside.is_empty()) {
        (true, true) => return,
        (true, false) => "outside the panel where the line breaks",
        (false, true) => "black where the line breaks",
        (false, false) => "outside the panel or black where the line breaks",
    };
    sheet.text((panel.right(), panel.bottom() + 60.0), words, 14, Anchor::End, BLACK);
}

/// Draws a curve, in pieces where it leaves the panel.
fn draw(
    sheet: &mut Sheet,
    panel: &Panel,
    (_, ink, dashes, value): &Curve,
    readings: &[(f64, &Reading)],
) {
    for piece in readings.split(|(_, reading)| !inside(panel, value(reading))) {
        let points: Vec<Point> =
            piece.iter().map(|(t, reading)| panel.at(*t, value(reading))).collect();
        sheet.polyline(&points, *ink, 2.4, dashes);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn reading(p: f64) -> Reading {
        Reading { probe: "sun".into(), illuminance: [0.0; 3], p: [p; 3], xyz: [1.0, p - 0.5, 0.2] }
    }

    fn history(times: &[f64]) -> Vec<(f64, Vec<Reading>)> {
        times.iter().map(|&t| (t, vec![reading(1.0 / (1.0 + t)), reading(0.7)])).collect()
    }

    #[test]
    fn long_times_are_shown_in_log_and_short_ones_from_nought() {
        assert!(time_axis(&history(&[0.1, 1.0, 60.0])).logarithmic);
        let even = time_axis(&history(&[1.0, 2.0, 60.0]));
        assert!(!even.logarithmic && even.from == 0.0 && even.to / even.every <= 8.0);
    }

    #[test]
    fn every_probe_has_its_name_and_no_curve_holds_a_number_that_is_none() {
        for times in [&[][..], &[0.04], &[0.04, 1.0, 3.0]] {
            let svg = drawn(&history(times)).svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            assert_eq!(svg.matches(">sun<").count(), if times.is_empty() { 0 } else { 2 });
        }
    }

    #[test]
    fn a_panel_says_why_its_line_breaks_and_only_then() {
        let told = |xyz: [[f64; 3]; 3]| {
            let one =
                |(i, xyz): (usize, [f64; 3])| (i as f64, vec![Reading { xyz, ..reading(0.5) }]);
            drawn(&xyz.into_iter().enumerate().map(one).collect::<Vec<_>>()).svg()
        };
        let (white, black, beyond) = ([1.0; 3], [0.0; 3], [-6.6, 1.0, 6.6]);
        assert!(!told([white; 3]).contains("where the line breaks"));
        assert!(told([white, black, white]).contains(">black where the line breaks<"));
        assert!(told([white, beyond, white]).contains(">outside the panel where the line breaks<"));
        assert!(
            told([black, beyond, white])
                .contains(">outside the panel or black where the line breaks<")
        );
    }
}
