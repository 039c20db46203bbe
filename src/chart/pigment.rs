//! `pigment`: how fast light bleaches cones and rods, where that ends, and how they recover.

use super::{Progress, write_csv};
use crate::error::Result;
use crate::kinetics::Kinetics;
use crate::plot::axes::power;
use crate::plot::palette::{BLACK, BLUE, GREEN, ORANGE, PURPLE, SKY, VERMILION};
use crate::plot::{Anchor, Ink, Marker, Sheet};
use crate::plot::{Axis, Panel};
use crate::step::advance;
use crate::units::{Seconds, Trolands};
use std::path::Path;

/// A class of receptors with its constants of the `standard` set.
struct Receptor {
    name: &'static str,
    title: &'static str,
    /// log10 of the half-bleach light, td (scotopic for rods).
    half_bleach_log: f64,
    tau: f64,
    ink: Ink,
}

/// Cones: Rushton & Henry 1968 (S: equal photosensitivity per molecule). Rods: Table 1 of Gutierrez
/// et al. 2005 and Rushton 1972.
const RECEPTORS: [Receptor; 3] = [
    Receptor {
        name: "LM",
        title: "L and M cones",
        half_bleach_log: 4.3,
        tau: 120.0,
        ink: VERMILION,
    },
    Receptor { name: "S", title: "S cones", half_bleach_log: 5.0, tau: 120.0, ink: BLUE },
    Receptor { name: "rod", title: "rods, scotopic", half_bleach_log: 4.4, tau: 400.0, ink: BLACK },
];

/// Lights whose onset is drawn, log10 td, each with its ink.
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

impl Receptor {
    fn kinetics(&self) -> Kinetics {
        Kinetics::first_order(Trolands(10f64.powf(self.half_bleach_log)), Seconds(self.tau))
    }

    /// Bleached fraction after `seconds` of `light`, from `p`.
    fn bleached(&self, p: f64, light: f64, seconds: f64) -> f64 {
        1.0 - advance(&self.kinetics(), p, Trolands(light), Seconds(seconds), 1)
    }
}

fn times(from: f64) -> impl Iterator<Item = f64> {
    (0..=240).map(move |i| from * (LONGEST_S / from).powf(f64::from(i) / 240.0))
}

pub(super) fn write(out_dir: &Path, progress: Progress) -> Result<()> {
    progress("pigment: onset and recovery of cones and rods");
    write_csv(out_dir, "pigment", "receptor,light_td,time_s,bleached,steady", rows().into_iter())?;
    let mut sheet = Sheet::new(1200.0, 1010.0);
    sheet.bold(
        (600.0, 32.0),
        "Bleaching and recovery of photopigment, first-order law",
        22,
        Anchor::Middle,
        BLACK,
    );
    for (i, receptor) in RECEPTORS.iter().enumerate() {
        onset(&mut sheet, receptor, (95.0 + 580.0 * (i % 2) as f64, 95.0 + 465.0 * (i / 2) as f64));
    }
    recovery(&mut sheet, (95.0 + 580.0, 95.0 + 465.0));
    sheet.write(out_dir, "pigment")
}

fn rows() -> Vec<String> {
    let mut rows = Vec::new();
    for receptor in &RECEPTORS {
        let kinetics = receptor.kinetics();
        let mut row = |light: f64, time: f64, bleached: f64| {
            let steady = 1.0 - kinetics.steady(Trolands(light));
            rows.push(format!("{},{light:e},{time:.6e},{bleached:.9},{steady:.9}", receptor.name));
        };
        for (log_light, _) in LIGHTS {
            let light = 10f64.powf(log_light);
            times(EARLIEST_S)
                .for_each(|time| row(light, time, receptor.bleached(1.0, light, time)));
        }
        times(1.0).for_each(|time| row(0.0, time, receptor.bleached(0.0, 0.0, time)));
    }
    rows
}

fn panel(at: (f64, f64), from: f64, every: f64) -> Panel<'static> {
    let x = Axis { from, to: LONGEST_S, logarithmic: true, every, label: "time (s)" };
    let y = Axis { from: 0.0, to: 1.0, logarithmic: false, every: 0.2, label: "bleached fraction" };
    Panel { left: at.0, top: at.1, width: 430.0, height: 330.0, x, y }
}

fn onset(sheet: &mut Sheet, receptor: &Receptor, at: (f64, f64)) {
    let panel = panel(at, EARLIEST_S, 2.0);
    panel.frame(sheet);
    sheet.bold(
        (panel.left, panel.top - 12.0),
        &format!("{}: onset under steady light (td)", receptor.title),
        17,
        Anchor::Start,
        BLACK,
    );
    for (log_light, ink) in LIGHTS {
        let light = 10f64.powf(log_light);
        let points: Vec<_> =
            times(EARLIEST_S).map(|t| panel.at(t, receptor.bleached(1.0, light, t))).collect();
        sheet.polyline(&points, ink, 2.2, "");
        let steady = panel.at(LONGEST_S, 1.0 - receptor.kinetics().steady(Trolands(light)));
        sheet.line((steady.0, steady.1), (steady.0 + 12.0, steady.1), ink, 3.0, "");
        label_onset(sheet, &panel, receptor, log_light, ink);
    }
}

/// Name the light beside its curve: on its rise, or at its end where it stays low.
fn label_onset(sheet: &mut Sheet, panel: &Panel, receptor: &Receptor, log_light: f64, ink: Ink) {
    let light = 10f64.powf(log_light);
    let steady = 1.0 - receptor.kinetics().steady(Trolands(light));
    let words = power(log_light);
    if steady < 0.45 {
        let (x, y) = panel.at(LONGEST_S, steady);
        sheet.text((x - 6.0, y - 7.0), &words, 15, Anchor::End, ink);
    } else {
        let level = 0.62 * steady;
        let crossing = times(EARLIEST_S).find(|&t| receptor.bleached(1.0, light, t) > level);
        let (x, y) = panel.at(crossing.unwrap_or(EARLIEST_S), level);
        sheet.text((x - 8.0, y + 4.0), &words, 15, Anchor::End, ink);
    }
}

fn recovery(sheet: &mut Sheet, at: (f64, f64)) {
    let panel = panel(at, 1.0, 1.0);
    panel.frame(sheet);
    sheet.bold(
        (panel.left, panel.top - 12.0),
        "Recovery in the dark from a full bleach",
        17,
        Anchor::Start,
        BLACK,
    );
    for receptor in [&RECEPTORS[0], &RECEPTORS[2]] {
        let points: Vec<_> =
            times(1.0).map(|t| panel.at(t, receptor.bleached(0.0, 0.0, t))).collect();
        sheet.polyline(&points, receptor.ink, 2.6, "");
    }
    let after_eight_minutes = panel.at(480.0, RECEPTORS[0].bleached(0.0, 0.0, 480.0));
    sheet.mark(after_eight_minutes, Marker::Disc, 5.0, VERMILION);
    sheet.text(panel.at(230.0, 0.05), "98 % back after 8 min", 15, Anchor::End, VERMILION);
    sheet.text(panel.at(75.0, 0.5), "cones, τ = 120 s", 15, Anchor::End, VERMILION);
    sheet.text(panel.at(330.0, 0.5), "rods, τ = 400 s", 15, Anchor::Start, BLACK);
}
