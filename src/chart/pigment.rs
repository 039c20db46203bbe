//! `pigment`: how fast light bleaches cones and rods, where that ends, and how they recover, with the
//! constants and the law of an observer.

use super::{Progress, write_csv};
use crate::config::Config;
use crate::constants::RODS;
use crate::error::Result;
use crate::kinetics::Kinetics;
use crate::plot::axes::power;
use crate::plot::course::{Held, moments};
use crate::plot::palette::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION};
use crate::plot::{Anchor, Axis, Ink, Marker, Panel, Sheet};
use crate::units::{Seconds, Trolands};
use std::path::Path;

/// A class of receptors, or several with the same kinetics.
struct Receptor {
    /// In the table: `L`, `LM`, .., `rod`.
    name: String,
    kinetics: Kinetics,
    ink: Ink,
}

/// Lights whose onset is drawn, log10 td (scotopic for rods), each with its ink.
const LIGHTS: [(f64, Ink); 7] = [
    (3.0, PURPLE),
    (4.0, BLUE),
    (5.0, SKY),
    (6.0, GREEN),
    (7.0, ORANGE),
    (8.0, VERMILION),
    (10.0, BLACK),
];

const EARLIEST_S: f64 = 1e-5;
const LONGEST_S: f64 = 3000.0;
/// Times of a curve.
const SAMPLES: usize = 240;

/// Cones of an observer, those with equal kinetics together, then rods (first order).
fn receptors(pigments: [Kinetics; 3]) -> Vec<Receptor> {
    let mut all: Vec<Receptor> = Vec::new();
    for ((name, ink), kinetics) in
        [("L", VERMILION), ("M", GREEN), ("S", BLUE)].into_iter().zip(pigments)
    {
        match all.iter_mut().find(|other| other.kinetics == kinetics) {
            Some(same) => same.name += name,
            None => all.push(Receptor { name: name.to_owned(), kinetics, ink }),
        }
    }
    let (half_bleach_log, tau) = RODS;
    let rods = Kinetics::first_order(Trolands(10f64.powf(half_bleach_log)), Seconds(tau));
    all.push(Receptor { name: "rod".to_owned(), kinetics: rods, ink: BLACK });
    all
}

impl Receptor {
    fn title(&self) -> String {
        match self.name.as_str() {
            "rod" => "Rods (scotopic td)".to_owned(),
            cones => {
                let letters: Vec<String> = cones.chars().map(String::from).collect();
                format!("{} cones", letters.join(" and "))
            }
        }
    }

    fn constants(&self) -> String {
        let (log, tau) = (self.kinetics.half_bleach.0.log10(), self.kinetics.tau.0);
        format!("{}, half-bleach log td {:.2}, τ {tau} s", self.kinetics.law.name(), log)
    }

    /// Bleached fractions at times, from `p` under `light` td.
    fn course(&self, p: f64, light: f64, times: &[f64]) -> Vec<f64> {
        let held = Held { from: 0.0, to: LONGEST_S, p, light };
        held.fractions(&self.kinetics, times).into_iter().map(|p| 1.0 - p).collect()
    }

    fn steady(&self, light: f64) -> f64 {
        1.0 - self.kinetics.steady(Trolands(light))
    }
}

fn time_axis(from: f64, most: f64) -> Axis<'static> {
    Axis::logarithmic(from, LONGEST_S, most, "time (s)")
}

fn times(from: f64) -> Vec<f64> {
    moments(&time_axis(from, 1.0), 0.0, LONGEST_S, SAMPLES)
}

pub(super) fn write(out_dir: &Path, observer: &Config, progress: Progress) -> Result<()> {
    progress("pigment: onset and recovery of cones and rods");
    let receptors = receptors(observer.pigments());
    let header = "receptor,light_td,time_s,bleached,steady";
    write_csv(out_dir, "pigment", header, receptors.iter().flat_map(rows))?;
    drawn(&receptors).write(out_dir, "pigment")
}

fn rows(of: &Receptor) -> Vec<String> {
    let curve = |p: f64, light: f64, times: Vec<f64>| {
        let bleached = of.course(p, light, &times);
        let row = |(time, bleached): (&f64, f64)| {
            let (name, steady) = (&of.name, of.steady(light));
            format!("{name},{light:e},{time:.6e},{bleached:.9},{steady:.9}")
        };
        times.iter().zip(bleached).map(row).collect::<Vec<_>>()
    };
    let onsets = LIGHTS.iter().flat_map(|(log, _)| curve(1.0, 10f64.powf(*log), times(EARLIEST_S)));
    onsets.chain(curve(0.0, 0.0, times(1.0))).collect()
}

/// From one row of panels to the next, and from one column.
const PITCH: [f64; 2] = [500.0, 322.0];

fn drawn(receptors: &[Receptor]) -> Sheet {
    let rows = (receptors.len() + 1).div_ceil(2);
    let mut sheet = Sheet::new(1000.0, 54.0 + PITCH[1] * rows as f64);
    let title = "Bleaching under steady light (td) and recovery of photopigment";
    sheet.bold((500.0, 28.0), title, 20, Anchor::Middle, BLACK);
    let place = |i: usize| (72.0 + PITCH[0] * (i % 2) as f64, 90.0 + PITCH[1] * (i / 2) as f64);
    for (i, receptor) in receptors.iter().enumerate() {
        onset(&mut sheet, receptor, place(i));
    }
    recovery(&mut sheet, receptors, place(receptors.len()));
    sheet
}

fn panel(
    sheet: &mut Sheet,
    at: (f64, f64),
    x: Axis<'static>,
    title: &str,
    under: &str,
) -> Panel<'static> {
    let y = Axis::linear(0.0, 1.0, 5.0, "bleached fraction");
    let panel = Panel { left: at.0, top: at.1, width: 390.0, height: 225.0, x, y };
    panel.frame(sheet);
    sheet.bold((panel.left, panel.top - 26.0), title, 16, Anchor::Start, BLACK);
    sheet.text((panel.left, panel.top - 8.0), under, 14, Anchor::Start, GREY);
    panel
}

fn onset(sheet: &mut Sheet, receptor: &Receptor, at: (f64, f64)) {
    let panel =
        panel(sheet, at, time_axis(EARLIEST_S, 5.0), &receptor.title(), &receptor.constants());
    let times = times(EARLIEST_S);
    for (log_light, ink) in LIGHTS {
        let bleached = receptor.course(1.0, 10f64.powf(log_light), &times);
        let curve: Vec<(f64, f64)> = times.iter().copied().zip(bleached).collect();
        panel.curve(sheet, &curve, ink, 2.0, "");
        let rest = panel.at(LONGEST_S, receptor.steady(10f64.powf(log_light)));
        sheet.line((rest.0, rest.1), (rest.0 + 10.0, rest.1), ink, 3.0, "");
        name_light(sheet, &panel, &curve, log_light, ink);
    }
}

/// Names a light beside its curve: on its rise, or at its end where it stays low.
fn name_light(sheet: &mut Sheet, panel: &Panel, curve: &[(f64, f64)], log_light: f64, ink: Ink) {
    let end = curve.last().map_or(0.0, |last| last.1);
    let rise = curve.iter().find(|(_, bleached)| *bleached > 0.62 * end);
    let (place, above) = match rise.filter(|_| end >= 0.45) {
        Some(&(time, bleached)) => (panel.at(time, bleached), -4.0),
        None => (panel.at(LONGEST_S, end), 3.0),
    };
    let at = (place.0 - 7.0, place.1 - above);
    sheet.text(at, &power(log_light), 14, Anchor::End, ink);
}

/// The course in the dark of every class that differs there.
fn recovery(sheet: &mut Sheet, receptors: &[Receptor], at: (f64, f64)) {
    let under = "from a full bleach, in the dark";
    let panel = panel(sheet, at, time_axis(1.0, 5.0), "Recovery", under);
    let times = times(1.0);
    let mut drawn: Vec<(String, Ink, Vec<f64>)> = Vec::new();
    for receptor in receptors {
        let bleached = receptor.course(0.0, 0.0, &times);
        match drawn.iter_mut().find(|(name, _, other)| *other == bleached && *name != "rod") {
            Some((name, ..)) => name.push_str(&receptor.name),
            None => drawn.push((receptor.name.clone(), receptor.ink, bleached)),
        }
    }
    for (i, (name, ink, bleached)) in drawn.into_iter().enumerate() {
        let curve: Vec<(f64, f64)> = times.iter().copied().zip(bleached).collect();
        panel.curve(sheet, &curve, ink, 2.4, "");
        let half = time_to_half(&curve);
        let [x, y] = [100.0, panel.bottom() - 24.0 * (i + 1) as f64];
        let words = format!("{}: half in {half:.0} s", if name == "rod" { "rods" } else { &name });
        sheet.mark(panel.at(half, 0.5), Marker::Disc, 4.0, ink);
        sheet.text((panel.left + x - 88.0, y), &words, 15, Anchor::Start, ink);
    }
}

/// When half is back, between two samples by the logarithm of time.
fn time_to_half(curve: &[(f64, f64)]) -> f64 {
    let falls = curve.windows(2).find(|pair| pair[1].1 < 0.5);
    falls.map_or(LONGEST_S, |pair| {
        let share = (pair[0].1 - 0.5) / (pair[0].1 - pair[1].1);
        pair[0].0 * (pair[1].0 / pair[0].0).powf(share)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::kinetics::Law;

    #[test]
    fn cones_of_equal_kinetics_share_a_panel_and_others_have_their_own() {
        let names = |pigments| -> Vec<String> {
            receptors(pigments).into_iter().map(|receptor| receptor.name).collect()
        };
        let [l, m, s] = Kinetics::standard();
        assert_eq!(names([l, m, s]), ["LM", "S", "rod"]);
        assert_eq!(names([l, l, l]), ["LMS", "rod"]);
        let slower = Kinetics { tau: Seconds(150.0), ..m };
        assert_eq!(names([l, slower, s]), ["L", "M", "S", "rod"]);
    }

    #[test]
    fn half_is_back_after_the_logarithm_of_two_of_the_time_constant() {
        let receptor = &receptors(Kinetics::standard())[0];
        let times = times(1.0);
        let bleached = receptor.course(0.0, 0.0, &times);
        let curve: Vec<(f64, f64)> = times.into_iter().zip(bleached).collect();
        approx::assert_relative_eq!(time_to_half(&curve), 120.0 * 2f64.ln(), max_relative = 1e-3);
    }

    #[test]
    fn every_law_comes_to_rest_at_its_steady_state() {
        for law in Law::NAMES.map(|(_, law)| law.with(0.5, 0.2)) {
            let kinetics = Kinetics { law, ..Kinetics::standard()[0] };
            let receptor = Receptor { name: "L".to_owned(), kinetics, ink: BLACK };
            for light in [1e4, 1e6] {
                let course = receptor.course(1.0, light, &times(EARLIEST_S));
                let last = course[course.len() - 1];
                assert!((last - receptor.steady(light)).abs() < 1e-5, "{law:?} {light}: {last}");
            }
        }
    }
}
