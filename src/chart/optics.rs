//! `optics`: point spread functions of the eye, the veil of the sun, and what computing scatter costs
//! and errs: by the pyramid at each depth, beside ways that others take.

use super::machine::{RUNS, median, nanoseconds};
use super::transform::Convolution;
use super::{Progress, write_csv};
use crate::error::{Error, Result};
use crate::light::{Planes, Samples};
use crate::optics::{DEPTHS, Depth, Optics, PSFS, Psf, Scatter};
use crate::plot::palette::{APART, BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, VERMILION};
use crate::plot::{Anchor, Axis, Ink, Marker, Panel, Sheet};
use std::path::Path;

/// A picture of a noon sun over a dark wall, and its width in degrees.
const SIZE: [usize; 2] = [480, 270];
const ACROSS: f64 = 40.0;

/// Every so many pixels on both axes the error is measured.
const STRIDE: usize = 15;

/// A wider pyramid whose Gaussians have three taps: the bloom of games.
const BLOOM: Depth = Depth { low: 1.0, reach: 0.5 };

/// One way to compute scatter.
struct Way {
    name: String,
    ink: Ink,
    marker: Marker,
    ms_per_megapixel: f64,
    error: f64,
    certificate: Option<f64>,
}

pub(super) fn write(out_dir: &Path, progress: Progress) -> Result<()> {
    progress("optics: direct summation");
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

fn cie() -> Scatter {
    Scatter { psf: Psf::Cie, ..Scatter::default() }
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

/// A sun of 1.6e9 cd/m2 in a sky over land, a wall of 25 cd/m2 in it.
fn noon() -> Planes {
    let [width, height] = SIZE;
    let degrees = ACROSS / width as f64;
    let light = |i: usize| {
        let [x, y] = [i % width, i / width].map(|v| v as f64 * degrees);
        let r = (x - 25.0).hypot(y - 6.0);
        match (r, (6.0..12.0).contains(&x) && y > 8.0, y > 15.0) {
            (r, ..) if r < 0.2665 => 1.6e9,
            (_, true, _) => 25.0,
            (_, _, true) => 900.0,
            (r, ..) => 5e3 + 2e4 * (-r / 2.0).exp() + 1e4 * (-r / 10.0).exp(),
        }
    };
    let samples = Samples::Float((0..width * height).map(|i| light(i) as f32).collect());
    Planes { width, height, count: 1, samples }
}

/// r = s (1 - c) + K s at every pixel from a table of the kernel, of the light of some pixels only.
fn direct(kernel: &[f64], from: &[(usize, f64)], at: usize) -> f64 {
    let width = SIZE[0];
    let share = |(i, light): &(usize, f64)| {
        light * kernel[(i / width).abs_diff(at / width) * width + (i % width).abs_diff(at % width)]
    };
    from.iter().map(share).sum()
}

fn places() -> impl Iterator<Item = usize> {
    let rows = (STRIDE / 2..SIZE[1]).step_by(STRIDE);
    rows.flat_map(|y| (STRIDE / 2..SIZE[0]).step_by(STRIDE).map(move |x| y * SIZE[0] + x))
}

fn optics(depth: Depth) -> Result<Optics> {
    let optics = Optics::at_depth(&cie(), SIZE, ACROSS / SIZE[0] as f64, 1, depth);
    optics.map_err(Error::light)?.ok_or_else(|| Error::light("nothing is scattered"))
}

/// Every way on the same picture.
fn ways(progress: Progress) -> Result<Vec<Way>> {
    let s = noon();
    let finest = optics(DEPTHS[DEPTHS.len() - 1])?;
    let [width, height] = SIZE;
    let pixels = width * height;
    let kernel: Vec<f64> =
        (0..pixels).map(|i| finest.share((i % width) as f64, (i / width) as f64)).collect();
    let light: Vec<(usize, f64)> =
        (0..pixels).map(|i| (i, s.at(i % width, i / width, 0))).collect();
    let ones: Vec<(usize, f64)> = (0..pixels).map(|i| (i, 1.0)).collect();
    let kept: Vec<f64> = places().map(|at| 1.0 - direct(&kernel, &ones, at)).collect();
    let truth: Vec<f64> = places()
        .zip(&kept)
        .map(|(at, kept)| light[at].1 * kept + direct(&kernel, &light, at))
        .collect();
    let error = |found: &dyn Fn(usize, f64) -> f64| {
        let all = places().zip(&kept).zip(&truth);
        all.map(|((at, kept), truth)| (found(at, *kept) / truth - 1.0).abs()).fold(0.0, f64::max)
    };
    let ms = |work: &mut dyn FnMut()| {
        let runs = (0..RUNS).map(|_| nanoseconds(&mut *work)).collect();
        median(runs) * 1e-6 / (pixels as f64 * 1e-6)
    };
    let mut ways = Vec::new();
    let names = DEPTHS.iter().map(|depth| (format!("pyramid from {} px", depth.low), *depth));
    for (name, depth) in names.chain([("bloom of three taps".to_owned(), BLOOM)]) {
        progress(&format!("optics: {name}"));
        let (mut optics, mut out) = (optics(depth)?, Planes::float(0, 0, 0));
        let ms_per_megapixel = ms(&mut || optics.exchange(&s, None, &mut out));
        let error = error(&|at, _| out.at(at % width, at / width, 0));
        let certificate = (depth != BLOOM).then(|| optics.bound());
        let (ink, marker) =
            if depth == BLOOM { (ORANGE, Marker::Square) } else { (BLUE, Marker::Disc) };
        ways.push(Way { name, ink, marker, ms_per_megapixel, error, certificate });
    }
    progress("optics: other ways");
    let bright: Vec<(usize, f64)> = light.iter().copied().filter(|(_, v)| *v > 5e5).collect();
    let mut sum = 0.0;
    ways.push(Way {
        name: format!("only the {} bright pixels", bright.len()),
        ink: VERMILION,
        marker: Marker::Triangle,
        ms_per_megapixel: ms(&mut || {
            sum += (0..pixels).map(|at| direct(&kernel, &bright, at)).sum::<f64>()
        }),
        error: error(&|at, kept| {
            let own = light[at].1 * if light[at].1 > 5e5 { kept } else { 1.0 };
            own + direct(&kernel, &bright, at)
        }),
        certificate: None,
    });
    std::hint::black_box(sum);
    let convolution = Convolution::new(SIZE, |x, y| kernel[y * width + x]);
    let single: Vec<f32> = light.iter().map(|(_, v)| *v as f32).collect();
    let mut veil = convolution.of(&single);
    let ms_per_megapixel = ms(&mut || veil = convolution.of(&single));
    let error = error(&|at, kept| light[at].1 * kept + f64::from(veil[at]));
    let name = "Fourier transform, single precision".to_owned();
    let (ink, marker) = (PURPLE, Marker::Diamond);
    ways.push(Way { name, ink, marker, ms_per_megapixel, error, certificate: None });
    Ok(ways)
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
