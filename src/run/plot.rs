//! `probes.svg`: what the probes' pigments and percepts did in time, a row of three panels for each
//! probe: bleached fractions, luminance and chromaticity of the percept. Between the ends of frames
//! pigment is drawn as the law has it ([`crate::plot::moment`]), from t = 0.

use std::path::Path;

use crate::error::Result;
use crate::frames::atomic;
use crate::plot::moment::{Cones, Moment, course, luminance_axis, note_breaks};
use crate::plot::palette::{BLACK, BLUE, GREEN, PURPLE, VERMILION};
use crate::plot::{Anchor, Axis, Ink, Panel, Sheet};
use crate::run::record::Reading;
use crate::units::Trolands;

const WIDTH: f64 = 1000.0;
/// From one probe's row to the next.
const PITCH: f64 = 268.0;
/// Left edges of the three panels, and their size.
const LEFTS: [f64; 3] = [72.0, 406.0, 740.0];
const SIZE: [f64; 2] = [220.0, 190.0];

/// A curve of a panel: name, colour, dashes, and what it shows of a moment.
type Curve = (&'static str, Ink, &'static str, fn(&Moment) -> f64);

const CURVES: [&[Curve]; 3] = [
    &[
        ("L", VERMILION, "", |at| at.bleached(0)),
        ("M", GREEN, "9 4", |at| at.bleached(1)),
        ("S", BLUE, "2 3", |at| at.bleached(2)),
    ],
    &[("Y", BLACK, "", |at| at.xyz[1])],
    &[("x", BLACK, "", |at| at.chromaticity(0)), ("y", PURPLE, "9 4", |at| at.chromaticity(1))],
];

/// Draws every probe against time. `history`: the readings at the end of each frame by its time, s;
/// a first entry at 0 s tells the start, else the start is all pigment where the law agrees.
///
/// # Errors
/// A file that cannot be written.
pub(crate) fn write(path: &Path, history: &[(f64, Vec<Reading>)], cones: &Cones) -> Result<()> {
    atomic::write_text(path, &drawn(history, cones).svg())
}

fn drawn(history: &[(f64, Vec<Reading>)], cones: &Cones) -> Sheet {
    let names: Vec<&str> =
        history.first().map_or(Vec::new(), |row| row.1.iter().map(|r| r.probe.as_str()).collect());
    let of_probe = |probe: usize| -> Vec<Moment> {
        history.iter().filter_map(|(time, all)| Some(moment(*time, all.get(probe)?))).collect()
    };
    let rows: Vec<Vec<Moment>> = (0..names.len()).map(of_probe).collect();
    let x = time_axis(&rows, cones);
    let courses: Vec<_> = rows.iter().map(|rows| course(rows, cones, &x)).collect();
    let y = [
        Axis::linear(0.0, 1.0, 5.0, "bleached fraction"),
        luminance_axis(courses.iter().flatten().map(|at| at.xyz[1])),
        Axis::linear(0.0, 0.8, 5.0, "chromaticity of the percept"),
    ];
    let mut sheet = Sheet::new(WIDTH, PITCH * names.len().max(1) as f64 + 20.0);
    for (i, (course, name)) in courses.iter().zip(names).enumerate() {
        let top = 42.0 + PITCH * i as f64;
        sheet.bold((LEFTS[0], top - 14.0), name, 17, Anchor::Start, BLACK);
        for ((left, y), curves) in LEFTS.into_iter().zip(y).zip(CURVES) {
            let panel = Panel { left, top, width: SIZE[0], height: SIZE[1], x, y };
            draw(&mut sheet, &panel, curves, course);
        }
    }
    sheet
}

fn moment(time: f64, reading: &Reading) -> Moment {
    Moment { time, light: reading.illuminance, p: reading.p, xyz: reading.xyz }
}

/// One panel: its frame, its curves with their names, and why they break.
fn draw(sheet: &mut Sheet, panel: &Panel, curves: &[Curve], course: &[Moment]) {
    panel.frame(sheet);
    let mut names = Vec::new();
    for (name, ink, dashes, value) in curves {
        let values: Vec<(f64, f64)> = course.iter().map(|at| (at.time, value(at))).collect();
        panel.curve(sheet, &values, *ink, 2.2, dashes);
        match values.iter().rfind(|(_, value)| panel.y.holds(*value)) {
            Some((time, last)) if *time >= panel.x.to => names.push((*last, *name, *ink)),
            Some((time, last)) => {
                let (x, y) = panel.at(*time, *last);
                sheet.text((x + 6.0, y + 5.0), name, 15, Anchor::Start, *ink);
            }
            None => {}
        }
    }
    panel.name_ends(sheet, &names, 15);
    let known = course.iter().filter(|at| at.xyz[1].is_finite());
    note_breaks(sheet, panel, known.flat_map(|at| curves.iter().map(|curve| curve.3(at))));
}

/// Evenly spaced frames and few decades are shown on an even axis; other times in powers of ten,
/// from before the first of them and before a hundredth has bleached.
fn time_axis(rows: &[Vec<Moment>], cones: &Cones) -> Axis<'static> {
    let ends = || rows.iter().flatten().filter(|at| at.time > 0.0);
    let first = ends().map(|at| at.time).fold(f64::INFINITY, f64::min);
    let last = ends().map(|at| at.time).fold(0.0, f64::max);
    if last <= 100.0 * first || rows.first().is_some_and(|rows| is_even(rows)) {
        return Axis::linear(0.0, last, 4.0, "time (s)");
    }
    let rate = |at: &Moment, k: usize| cones.kinetics[k].contraction(Trolands(at.light[k]))[1];
    let at_first = ends().filter(|at| at.time == first);
    let fastest = at_first.flat_map(|at| (0..3).map(|k| rate(at, k))).fold(0.0, f64::max);
    let from = (0.01 / fastest).clamp(1e-4 * first, first);
    Axis::logarithmic(10f64.powf(from.log10().floor()), last, 5.0, "time (s)")
}

/// Whether frames are equally long, as those of a film are.
fn is_even(rows: &[Moment]) -> bool {
    let lengths = || rows.windows(2).map(|pair| pair[1].time - pair[0].time);
    let longest = lengths().fold(0.0, f64::max);
    rows.len() > 2 && lengths().all(|length| length >= 0.99 * longest)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinetics::{Kinetics, Law};
    use crate::plot::sheet::{Item, Point};
    use crate::units::Millimetres;
    use crate::units::Seconds;

    const EYE: Cones = Cones {
        kinetics: [Kinetics {
            law: Law::FirstOrder,
            half_bleach: Trolands(2e4),
            tau: Seconds(120.0),
        }; 3],
        lms_to_xyz: [[1.94, -1.35, 0.36], [0.69, 0.35, 0.0], [0.0, 0.0, 1.93]],
    };

    fn reading(light: f64, p: f64, luminance: f64) -> Reading {
        let xyz = [0.9, 1.0, 0.5].map(|share| share * luminance);
        let (pupil, lost) = (Millimetres(3.0), [0.0; 3]);
        Reading { probe: "sun".into(), illuminance: [light; 3], p: [p; 3], xyz, pupil, lost }
    }

    fn after(p: f64, light: f64, seconds: f64) -> f64 {
        let rest = 1.0 / (1.0 + light / 2e4);
        rest + (p - rest) * (-seconds * (1.0 + light / 2e4) / 120.0).exp()
    }

    /// 30 s of 1e6 td, then 570 s of darkness.
    fn recovery() -> Vec<(f64, Vec<Reading>)> {
        let bleached = after(1.0, 1e6, 30.0);
        let back = after(bleached, 0.0, 570.0);
        vec![(30.0, vec![reading(1e6, bleached, 40.0)]), (600.0, vec![reading(0.0, back, 0.0)])]
    }

    /// The points of the first path of an ink, in the values of the panel's axes.
    fn points(sheet: &Sheet, panel: &Panel, ink: Ink) -> Vec<(f64, f64)> {
        let path = sheet.items.iter().find_map(|item| match item {
            Item::Path { points, stroke: Some(stroke), .. } if stroke.ink == ink => Some(points),
            _ => None,
        });
        let value = |&(x, y): &Point| {
            let across = (x - panel.left) / panel.width;
            (panel.x.value(across), panel.y.value((panel.bottom() - y) / panel.height))
        };
        path.expect("a path of that ink").iter().map(value).collect()
    }

    #[test]
    fn a_recovery_of_two_frames_is_drawn_as_the_exponential_that_it_is() {
        let sheet = drawn(&recovery(), &EYE);
        let x = Axis::linear(0.0, 600.0, 4.0, "");
        let y = Axis::linear(0.0, 1.0, 5.0, "");
        let panel = Panel { left: LEFTS[0], top: 42.0, width: SIZE[0], height: SIZE[1], x, y };
        let path = points(&sheet, &panel, VERMILION);
        assert_eq!(path[0], (0.0, 0.0));
        assert_eq!(path.last().map(|at| at.0), Some(600.0));
        let bleached = |time: f64| {
            let at_30 = after(1.0, 1e6, 30.0);
            1.0 - if time <= 30.0 { after(1.0, 1e6, time) } else { after(at_30, 0.0, time - 30.0) }
        };
        for &(time, drawn) in &path {
            let law = bleached(time);
            assert!((drawn - law).abs() < 1e-6, "{drawn} and not {law} at {time} s");
        }
        // Half-way along each chord, too; the fast rise is steep, so across it.
        for pair in path.windows(2).filter(|pair| pair[0].0 >= 30.0) {
            let (time, drawn) = (0.5 * (pair[0].0 + pair[1].0), 0.5 * (pair[0].1 + pair[1].1));
            assert!((drawn - bleached(time)).abs() < 1e-3, "{drawn} at {time} s");
        }
    }

    #[test]
    fn films_have_an_even_axis_and_times_of_many_decades_powers_of_ten() {
        let frames = |times: &[f64]| -> Axis {
            let row = |&t: &f64| moment(t, &reading(1e3, after(1.0, 1e3, t), 1.0));
            time_axis(&[times.iter().map(row).collect()], &EYE)
        };
        let film: Vec<f64> = (1..=240).map(|i| f64::from(i) / 24.0).collect();
        assert!(!frames(&film).logarithmic && frames(&film).to == 10.0);
        assert!(!frames(&[1.0, 2.0, 60.0]).logarithmic);
        let long = frames(&[0.1, 1.0, 60.0]);
        assert!(long.logarithmic && long.from <= 0.1 && long.to == 60.0);
    }

    #[test]
    fn every_probe_has_its_name_and_no_curve_holds_a_number_that_is_none() {
        for times in [&[][..], &[0.04], &[0.04, 1.0, 30.0]] {
            let both = |&t: &f64| (t, vec![reading(1e5, 0.4, 3.0), reading(0.0, 1.0, 0.0)]);
            let svg = drawn(&times.iter().map(both).collect::<Vec<_>>(), &EYE).svg();
            assert!(!svg.contains("NaN") && !svg.contains("inf"));
            assert_eq!(svg.matches(">sun<").count(), if times.is_empty() { 0 } else { 2 });
        }
    }

    #[test]
    fn a_flash_between_darkness_is_a_dot() {
        let flash = |i: usize| reading([0.0, 1e5][i % 2], 0.5, [0.0, 30.0][i % 2]);
        let history: Vec<_> = (0..9).map(|i| (1.0 + i as f64, vec![flash(i)])).collect();
        let dots = |ink: Ink| {
            let is =
                |item: &&Item| matches!(item, Item::Circle { fill: Some(of), .. } if *of == ink);
            drawn(&history, &EYE).items.iter().filter(is).count()
        };
        assert_eq!(dots(PURPLE), 4);
    }

    #[test]
    fn a_panel_says_why_its_line_breaks_and_only_then() {
        let told = |xyz: [[f64; 3]; 3]| {
            let one = |(i, xyz): (usize, [f64; 3])| {
                (1.0 + i as f64, vec![Reading { xyz, ..reading(0.0, 0.5, 1.0) }])
            };
            drawn(&xyz.into_iter().enumerate().map(one).collect::<Vec<_>>(), &EYE).svg()
        };
        let (white, black, beyond) = ([1.0; 3], [0.0; 3], [-6.6, 1.0, 6.6]);
        assert!(!told([white; 3]).contains("breaks:"));
        assert!(told([white, black, white]).contains(">breaks: black<"));
        assert!(told([white, beyond, white]).contains(">breaks: outside the panel<"));
        assert!(told([black, beyond, white]).contains(">breaks: outside or black<"));
    }
}
