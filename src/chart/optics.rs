//! `optics`: point spread functions of the eye, the veil of the sun, and what computing scatter costs
//! and errs: by the pyramid at each depth, beside ways that others take.

use super::optics_ways::{Way, cie, ways};
use super::{Progress, write_csv};
use crate::error::Result;
use crate::optics::{PSFS, Psf, Scatter};
use crate::plot::palette::{APART, BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION};
use crate::plot::{Anchor, Axis, Marker, Panel, Sheet};
use std::path::Path;

pub(super) fn write(out_dir: &Path, progress: Progress) -> Result<()> {
    let ways = ways(progress)?;
    let curves = curves();
    let of_curve = |(panel, name, values): &Curve| {
        let row = |(x, y): &(f64, f64)| format!("{panel},{name},{x:.6e},{y:.6e},");
        values.iter().map(row).collect::<Vec<_>>()
    };
    let of_way = |way: &Way| {
        let certificate = way.certificate.map_or(String::new(), |bound| format!("{bound:.3e}"));
        format!("cost,{},{:.4},{:.3e},{certificate}", way.name, way.ms_per_megapixel, way.error)
    };
    let rows = curves.iter().flat_map(of_curve).chain(ways.iter().map(of_way));
    write_csv(out_dir, "optics", "panel,series,x,y,certificate", rows)?;
    draw(&curves, &ways).write(out_dir, "optics")
}

/// Angles from 0.1 to 60 degrees.
fn angles() -> impl Iterator<Item = f64> {
    (0..=120).map(|i| 0.1 * 600f64.powf(f64::from(i) / 120.0))
}

/// Panel, name and values of a curve.
type Curve = (&'static str, &'static str, Vec<(f64, f64)>);

/// The functions, and the veil of the sun at noon for ages.
fn curves() -> Vec<Curve> {
    let values = |scatter: Scatter, scale: f64| {
        angles().map(move |t| (t, scale * scatter.psf(t))).collect::<Vec<_>>()
    };
    let functions = PSFS.iter().filter(|(_, psf)| *psf != Psf::None);
    let mut curves: Vec<_> = functions
        .map(|&(name, psf)| ("psf", name, values(Scatter { psf, ..Scatter::default() }, 1.0)))
        .collect();
    // A point of the sun's light, 1.6e9 cd/m2 over 6.8e-5 sr: beyond half a degree the disc is one.
    let light = 1.6e9 * 6.797e-5;
    for (name, age, pigmentation) in [
        ("20 years, dark", 20.0, 0.0),
        ("30 years, brown", 30.0, 0.5),
        ("80 years, blue", 80.0, 1.0),
    ] {
        curves.push(("veil", name, values(Scatter { age, pigmentation, ..cie() }, light)));
    }
    curves
}

fn draw(curves: &[Curve], ways: &[Way]) -> Sheet {
    let mut sheet = Sheet::new(1500.0, 560.0);
    let title = "Light scattered in the eye: how much, and what it costs to compute";
    sheet.bold((750.0, 30.0), title, 22, Anchor::Middle, BLACK);
    let angle = |label| Axis { from: 0.1, to: 60.0, logarithmic: true, every: 1.0, label };
    let panels = [
        ("psf", "Point spread functions", "light per steradian, sr⁻¹", [1e-3, 1e5]),
        ("veil", "Veil of the noon sun", "veil, cd/m²", [1e1, 1e10]),
    ];
    for (i, (kind, title, label, [from, to])) in panels.into_iter().enumerate() {
        let y = Axis { from, to, logarithmic: true, every: 2.0, label };
        let (left, x) = (95.0 + 470.0 * i as f64, angle("degrees from the light"));
        let panel = Panel { left, top: 90.0, width: 250.0, height: 380.0, x, y };
        panel.frame(&mut sheet);
        sheet.bold((left, 76.0), title, 17, Anchor::Start, BLACK);
        let of_kind = curves.iter().filter(|(panel, ..)| *panel == kind);
        let mut ends = Vec::new();
        for ((_, name, values), ink) in of_kind.zip(APART) {
            panel.curve(&mut sheet, values, ink, 2.0, "");
            ends.push((values[values.len() - 1].1, *name, ink));
        }
        panel.name_ends(&mut sheet, &ends, 14);
    }
    costs(&mut sheet, ways);
    sheet
}

/// The third panel: cost against error, with the certificate above the measured error.
fn costs(sheet: &mut Sheet, ways: &[Way]) {
    let x = Axis {
        from: 1.0,
        to: 1000.0,
        logarithmic: true,
        every: 1.0,
        label: "ms a megapixel and plane",
    };
    let y = Axis {
        from: 1e-6,
        to: 1.0,
        logarithmic: true,
        every: 1.0,
        label: "largest relative error",
    };
    let panel = Panel { left: 1035.0, top: 90.0, width: 240.0, height: 380.0, x, y };
    panel.frame(sheet);
    sheet.bold((panel.left, 76.0), "A noon sun, 480 x 270", 17, Anchor::Start, BLACK);
    for way in ways {
        let at = panel.at(way.ms_per_megapixel, way.error);
        if let Some(bound) = way.certificate {
            let (x, y) = panel.at(way.ms_per_megapixel, bound);
            sheet.line((x, y), at, way.ink, 1.0, "2 3");
            sheet.line((x - 9.0, y), (x + 9.0, y), way.ink, 2.4, "");
        }
        sheet.mark(at, way.marker, 6.0, way.ink);
    }
    let (from, to) = (panel.at(1.0, 3e-3), panel.at(1000.0, 3e-3));
    sheet.line(from, to, GREEN, 1.2, "6 4");
    key(sheet);
}

/// The names beside the third panel.
fn key(sheet: &mut Sheet) {
    let names = [
        (BLUE, Marker::Disc, "pyramid, four depths;"),
        (ORANGE, Marker::Square, "bloom of three taps"),
        (VERMILION, Marker::Triangle, "only bright pixels"),
        (PURPLE, Marker::Diamond, "Fourier transform, f32"),
    ];
    for (i, (ink, marker, words)) in names.into_iter().enumerate() {
        let y = 120.0 + 60.0 * i as f64;
        sheet.mark((1300.0, y), marker, 6.0, ink);
        sheet.text((1315.0, y + 5.0), words, 15, Anchor::Start, BLACK);
    }
    sheet.text((1315.0, 145.0), "bars: their certificates", 15, Anchor::Start, GREY);
    sheet.line((1290.0, 360.0), (1310.0, 360.0), GREEN, 1.2, "6 4");
    sheet.text((1315.0, 365.0), "the budget, 3 x 10⁻³", 15, Anchor::Start, BLACK);
}
