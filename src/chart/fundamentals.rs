//! `fundamentals`: Figs. 1 to 3 of the paper beside an observer, whose fundamentals are the table.

use std::path::Path;

use crate::config::Config;
use crate::error::Result;
use crate::observer::directional::eta;
use crate::observer::{Field, Fundamentals, Reading, Set, Steepness};
use crate::spectrum::Curve;

use super::{Progress, write_csv};
use crate::plot::palette::{BLACK, BLUE, FAINT, GREEN, GREY, VERMILION};
use crate::plot::{Anchor, Ink, Sheet};
use crate::plot::{Axis, Panel};

/// Inks of the L, M and S cones.
const CONE_INKS: [Ink; 3] = [VERMILION, GREEN, BLUE];

/// p of the paper's Fig. 1, mm^-2.
const PAPERS_P: [(f64, Ink); 2] = [(0.06, VERMILION), (0.09, BLUE)];

pub(super) fn write(out_dir: &Path, observer: &Config, progress: Progress) -> Result<()> {
    let (eye, name) = (observer.observer().fundamentals, name(observer));
    progress(&format!("fundamentals: the paper's Figs. 1 to 3 and {name}"));
    table(out_dir, &eye)?;
    let mut sheet = Sheet::new(1000.0, 866.0);
    sheet.bold(
        (500.0, 28.0),
        "The paper's Figs. 1 to 3, and what is used here",
        20,
        Anchor::Middle,
        BLACK,
    );
    weight(&mut sheet);
    steepness(&mut sheet);
    whole(&mut sheet, &eye, &name);
    bleached(&mut sheet, &eye);
    sheet.write(out_dir, "fundamentals")
}

/// Which fundamentals an observer has.
fn name(observer: &Config) -> String {
    let o = &observer.settings.observer;
    match o.fundamentals {
        Set::Cie2006 => format!("CIE 2006, {}°, {} years", o.field_deg, o.age),
        Set::Smj1993 => "SMJ 1993, 10°".into(),
    }
}

/// Every nm: sensitivities (energy, unit peak), whole and with half of the pigment gone.
fn table(out_dir: &Path, eye: &Fundamentals) -> Result<()> {
    let half = [0, 1, 2].map(|k| eye.depleted(k, 0.5));
    let row = |nm: usize| {
        let curves = (0..3).map(|k| eye.unbleached(k)).chain(&half);
        curves.fold(nm.to_string(), |row, curve| format!("{row},{:.6e}", curve.at(nm)))
    };
    let header = "wavelength_nm,L,M,S,L_half,M_half,S_half";
    write_csv(out_dir, "fundamentals", header, (Curve::FROM..=Curve::TO).map(row))
}

fn panel(left: f64, top: f64, x: Axis<'static>, y: Axis<'static>) -> Panel<'static> {
    Panel { left, top, width: 390.0, height: 290.0, x, y }
}

fn linear(from: f64, to: f64, every: f64, label: &'static str) -> Axis<'static> {
    Axis { from, to, logarithmic: false, every, label }
}

fn title(sheet: &mut Sheet, panel: &Panel, words: &str) {
    sheet.bold((panel.left, panel.top - 34.0), words, 16, Anchor::Start, BLACK);
}

/// An entry of a legend: a sample of the line and words.
fn legend(sheet: &mut Sheet, at: (f64, f64), ink: Ink, width: f64, dashes: &str, words: &str) {
    sheet.line((at.0, at.1 - 5.0), (at.0 + 26.0, at.1 - 5.0), ink, width, dashes);
    sheet.text((at.0 + 32.0, at.1), words, 14, Anchor::Start, BLACK);
}

/// Fig. 1: eta = 10^(-p r^2) for the paper's two constants, and the pupil's mean that is the
/// default.
fn weight(sheet: &mut Sheet) {
    let panel = panel(
        72.0,
        102.0,
        linear(-4.0, 4.0, 1.0, "r, distance from the pupil's centre (mm)"),
        linear(0.0, 1.0, 0.2, "relative efficiency η"),
    );
    panel.frame(sheet);
    title(sheet, &panel, "Fig. 1: Stiles-Crawford effect");
    let paper = Reading::Paper { mm_per_degree: 0.29 };
    let steps = || (-80..=80).map(|i| f64::from(i) / 20.0);
    let middle = panel.at(0.0, 0.0).0;
    sheet.line((middle, panel.top), (middle, panel.bottom()), BLACK, 1.0, "");
    for (p, ink) in PAPERS_P {
        let at_point: Vec<_> = steps().map(|r| panel.at(r, eta(paper, p, 8.0, r.abs()))).collect();
        let mean: Vec<_> =
            steps().map(|r| panel.at(r, eta(Reading::Pupil, p, 2.0 * r.abs(), 0.0))).collect();
        sheet.polyline(&at_point, ink, 2.4, "");
        sheet.polyline(&mean, ink, 1.8, "9 6");
    }
    for (i, (p, ink)) in PAPERS_P.into_iter().enumerate() {
        let (x, y) = panel.at(0.0, 0.12 - 0.07 * i as f64);
        sheet.text((x + 10.0, y), &format!("p = {p} mm⁻²"), 15, Anchor::Start, ink);
    }
    legend(sheet, (panel.left, panel.top - 10.0), GREY, 2.4, "", "a ray at r (paper)");
    legend(
        sheet,
        (panel.left + 182.0, panel.top - 10.0),
        GREY,
        1.8,
        "9 6",
        "a pupil's mean (default)",
    );
}

/// Fig. 2: p(lambda) as measured, and corrected for the lens.
fn steepness(sheet: &mut Sheet) {
    let panel = panel(
        572.0,
        102.0,
        linear(400.0, 700.0, 50.0, "wavelength (nm)"),
        linear(0.0, 0.14, 0.02, "p (mm⁻²)"),
    );
    panel.frame(sheet);
    title(sheet, &panel, "Fig. 2: how steep, by wavelength");
    for (p, ink) in PAPERS_P {
        let (from, to) = (panel.at(400.0, p), panel.at(700.0, p));
        sheet.line(from, to, ink, 1.2, "2 4");
    }
    let curves = [
        (Steepness::Measured, VERMILION, "measured (default)"),
        (Steepness::LensCorrected, BLUE, "corrected for the lens (preset paper)"),
    ];
    for (i, (steepness, ink, words)) in curves.into_iter().enumerate() {
        sheet.polyline(&visible(&panel, &steepness.curve(), 1.0), ink, 2.4, "");
        legend(sheet, (650.0, 126.0 + 21.0 * i as f64), ink, 2.4, "", words);
    }
    legend(sheet, (650.0, 168.0), GREY, 1.2, "2 4", "Fig. 1's constants 0.06 and 0.09");
}

/// A curve from 400 to 700 nm, times a number.
fn visible(panel: &Panel, curve: &Curve, factor: f64) -> Vec<(f64, f64)> {
    (400..=700).map(|nm| panel.at(nm as f64, factor * curve.at(nm))).collect()
}

fn cones_panel(sheet: &mut Sheet, left: f64, words: &str) -> Panel<'static> {
    let panel = panel(
        left,
        510.0,
        linear(400.0, 700.0, 50.0, "wavelength (nm)"),
        linear(0.0, 1.0, 0.2, "sensitivity (energy)"),
    );
    panel.frame(sheet);
    title(sheet, &panel, words);
    panel
}

/// Fig. 3, top: the paper's fundamentals and the observer's.
fn whole(sheet: &mut Sheet, eye: &Fundamentals, name: &str) {
    let panel = cones_panel(sheet, 72.0, "Fig. 3, top: unbleached cones");
    let (set, field) = (Set::Smj1993, Field::TenDegrees);
    let paper = Fundamentals::new(set, field, set.optical_density(field));
    for (k, ink) in CONE_INKS.into_iter().enumerate() {
        let (own, smj) = (eye.unbleached(k), paper.unbleached(k));
        let peak = panel.at(own.peak_and_width().0, 0.0).0;
        sheet.line((peak, panel.top), (peak, panel.bottom()), GREY, 1.0, "");
        sheet.polyline(&visible(&panel, own, 1.0), ink, 2.4, "");
        sheet.polyline(&visible(&panel, smj, 1.0), BLACK, 1.4, "5 6");
    }
    legend(sheet, (panel.left, panel.top - 10.0), GREY, 2.4, "", name);
    legend(sheet, (panel.left + 224.0, panel.top - 10.0), BLACK, 1.4, "5 6", "SMJ 1993 (paper)");
}

/// Fig. 3, bottom: half of the observer's pigment gone, in both readings of "narrowing".
fn bleached(sheet: &mut Sheet, eye: &Fundamentals) {
    let panel = cones_panel(sheet, 572.0, "Fig. 3, bottom: these cones, half bleached");
    for (k, ink) in CONE_INKS.into_iter().enumerate() {
        let half = eye.depleted(k, 0.5);
        let peak = panel.at(half.peak_and_width().0, 0.0).0;
        sheet.line((peak, panel.top), (peak, panel.bottom()), FAINT, 1.0, "");
        sheet.polyline(&visible(&panel, eye.unbleached(k), 1.0), ink, 1.2, "2 4");
        sheet.polyline(&visible(&panel, &half, 1.0 / half.peak()), ink, 2.4, "");
        sheet.polyline(&visible(&panel, &half, 1.0), ink, 1.8, "9 6");
    }
    legend(sheet, (panel.left, panel.top - 10.0), GREY, 1.2, "2 4", "whole");
    legend(sheet, (panel.left + 88.0, panel.top - 10.0), GREY, 2.4, "", "narrowed (paper)");
    legend(sheet, (panel.left + 250.0, panel.top - 10.0), GREY, 1.8, "9 6", "depleted (default)");
}
