//! `stability`: every method against h lambda, coloured by the error of one step, limits measured
//! and in theory.

use super::stability::{Measured, amplification, measure};
use super::{Progress, write_csv};
use crate::error::Result;
use crate::plot::axes::power;
use crate::plot::palette::{BLACK, BLUE, GREY, VERMILION, WHITE};
use crate::plot::{Anchor, Ink, Marker, Sheet};
use crate::plot::{Axis, Panel};
use std::path::Path;

pub(super) fn write(out_dir: &Path, progress: Progress) -> Result<()> {
    progress("stability: limits and orders");
    let measured = measure();
    let header = "method,order_theory,order_measured,stable_to_theory,stable_to_measured,bounded_to_theory,bounded_to_measured";
    write_csv(out_dir, "stability", header, measured.iter().map(row))?;
    draw(&measured).write(out_dir, "stability")
}

fn row(of: &Measured) -> String {
    let number = |x: f64| if x.is_infinite() { "inf".to_owned() } else { format!("{x:.6}") };
    let orders = if of.method.name == "exact" {
        "exact,exact".to_owned()
    } else {
        format!("{},{:.3}", of.method.order, of.order)
    };
    let limits =
        [of.method.stable_to, of.stable_to, of.method.bounded_to, of.bounded_to].map(number);
    format!("{},{orders},{}", of.method.name, limits.join(","))
}

/// Errors at which the colour changes, and the colours from less to more (viridis, reversed to end
/// dark).
const STEPS: [f64; 5] = [1e-8, 1e-4, 1e-3, 1e-2, 1e-1];
const SHADES: [Ink; 6] = [
    Ink(0xf4, 0xf8, 0xf2),
    Ink(0xc8, 0xe6, 0xd4),
    Ink(0x8c, 0xcb, 0xc3),
    Ink(0x52, 0xa3, 0xb4),
    Ink(0x35, 0x6f, 0x9b),
    Ink(0x2c, 0x3b, 0x6e),
];

/// The colour of a step that leaves `amplification` of the distance from rest where e^-x should
/// remain.
fn shade(amplification: f64, x: f64) -> Ink {
    let error = (amplification - (-x).exp()).abs();
    if amplification.abs() > 1.0 + 1e-9 || amplification.is_nan() {
        return VERMILION;
    }
    SHADES[STEPS.iter().filter(|&&step| error > step).count()]
}

const CELLS: u32 = 300;
const ROW: f64 = 31.0;

fn draw(measured: &[Measured]) -> Sheet {
    let height = ROW * measured.len() as f64;
    let mut sheet = Sheet::new(1000.0, height + 316.0);
    sheet.bold(
        (500.0, 30.0),
        "Where methods fail: one step of h λ under held light",
        20,
        Anchor::Middle,
        BLACK,
    );
    let label = "h λ = h (1 + I/I0)/τ";
    let x = Axis { from: 1e-2, to: 1e3, logarithmic: true, every: 1.0, label };
    let y = Axis { from: 0.0, to: 1.0, logarithmic: false, every: 2.0, label: "" };
    let panel = Panel { left: 200.0, top: 106.0, width: 492.0, height, x, y };
    for (i, of) in measured.iter().enumerate() {
        draw_row(&mut sheet, &panel, of, panel.top + ROW * i as f64);
    }
    frame(&mut sheet, &panel);
    columns(&mut sheet, &panel, measured);
    legend(&mut sheet, panel.bottom() + 88.0);
    sheet
}

fn draw_row(sheet: &mut Sheet, panel: &Panel, of: &Measured, top: f64) {
    let width = panel.width / f64::from(CELLS);
    for i in 0..CELLS {
        let x = 1e-2 * 1e5_f64.powf((f64::from(i) + 0.5) / f64::from(CELLS));
        let kept = amplification(of.method, x);
        let left = panel.left + width * f64::from(i);
        sheet.block((left, top + 2.0), width + 0.4, ROW - 4.0, shade(kept, x));
        if kept < -1e-9 {
            sheet.block((left, top + ROW - 9.0), width + 0.4, 5.0, BLACK);
        }
    }
    let (middle, dark) = (top + 0.5 * ROW, BLACK);
    sheet.text((panel.left - 12.0, middle + 6.0), of.method.name, 15, Anchor::End, dark);
    for (theory, found) in
        [(of.method.bounded_to, of.bounded_to), (of.method.stable_to, of.stable_to)]
    {
        if theory.is_finite() {
            let x = panel.at(theory, 0.0).0;
            sheet.line((x, top - 1.0), (x, top + ROW + 1.0), BLACK, 3.0, "");
        }
        if found.is_finite() {
            sheet.mark((panel.at(found, 0.0).0, middle), Marker::Disc, 6.5, BLACK);
            sheet.mark((panel.at(found, 0.0).0, middle), Marker::Disc, 4.5, WHITE);
        }
    }
}

/// Ticks of h lambda below, and above the light that makes it so at 24 frames a second.
fn frame(sheet: &mut Sheet, panel: &Panel) {
    for exponent in -2..=3 {
        let value = 10f64.powi(exponent);
        let x = panel.at(value, 0.0).0;
        sheet.line((x, panel.bottom()), (x, panel.bottom() + 6.0), BLACK, 1.0, "");
        sheet.text(
            (x, panel.bottom() + 24.0),
            &power(f64::from(exponent)),
            16,
            Anchor::Middle,
            BLACK,
        );
    }
    sheet.text(
        (panel.left + 0.5 * panel.width, panel.bottom() + 50.0),
        panel.x.label,
        17,
        Anchor::Middle,
        BLACK,
    );
    for exponent in 6..=10 {
        let lambda_h = (1.0 + 10f64.powi(exponent) / 2e4) / 120.0 / 24.0;
        let x = panel.at(lambda_h, 0.0).0;
        sheet.line((x, panel.top - 6.0), (x, panel.top), BLACK, 1.0, "");
        sheet.text((x, panel.top - 11.0), &power(f64::from(exponent)), 16, Anchor::Middle, BLACK);
    }
    sheet.text(
        (panel.left + 0.5 * panel.width, panel.top - 36.0),
        "light at 24 frames a second (td)",
        17,
        Anchor::Middle,
        BLACK,
    );
}

/// Order and limits in numbers, theory first.
fn columns(sheet: &mut Sheet, panel: &Panel, measured: &[Measured]) {
    let at = [752.0, 842.0, 942.0];
    for (x, (name, under)) in at.iter().zip([
        ("order", "measured"),
        ("stable to", "measured"),
        ("in 0..1 to", "measured"),
    ]) {
        sheet.bold((*x, panel.top - 34.0), name, 16, Anchor::Middle, BLACK);
        sheet.text((*x, panel.top - 14.0), under, 14, Anchor::Middle, GREY);
    }
    let limit = |x: f64| if x.is_infinite() { "any".to_owned() } else { format!("{x:.4}") };
    for (i, of) in measured.iter().enumerate() {
        let y = panel.top + ROW * (i as f64 + 0.5) + 6.0;
        let order =
            if of.method.name == "exact" { "exact".to_owned() } else { format!("{:.2}", of.order) };
        for (x, words) in at.iter().zip([order, limit(of.stable_to), limit(of.bounded_to)]) {
            sheet.text((*x, y), &words, 16, Anchor::Middle, BLACK);
        }
    }
}

fn legend(sheet: &mut Sheet, top: f64) {
    sheet.text((20.0, top + 16.0), "error of the step:", 15, Anchor::Start, BLACK);
    let names = ["< 10⁻⁸", "< 10⁻⁴", "< 10⁻³", "< 10⁻²", "< 0.1", "more"];
    for (i, (ink, name)) in SHADES.iter().zip(names).enumerate() {
        let x = 166.0 + 101.0 * i as f64;
        sheet.block((x, top), 30.0, 22.0, BLACK);
        sheet.block((x + 1.0, top + 1.0), 28.0, 20.0, *ink);
        sheet.text((x + 36.0, top + 16.0), name, 15, Anchor::Start, BLACK);
    }
    sheet.block((782.0, top), 30.0, 22.0, VERMILION);
    sheet.text((818.0, top + 16.0), "blows up: |R| > 1", 15, Anchor::Start, BLACK);
    let below = top + 36.0;
    sheet.block((20.0, below + 8.0), 30.0, 6.0, BLACK);
    sheet.text((58.0, below + 16.0), "R < 0: rings, negative pigment", 15, Anchor::Start, BLACK);
    sheet.line((345.0, below), (345.0, below + 22.0), BLACK, 3.0, "");
    sheet.text((356.0, below + 16.0), "limit in theory", 15, Anchor::Start, BLACK);
    sheet.mark((512.0, below + 11.0), Marker::Disc, 6.5, BLACK);
    sheet.mark((512.0, below + 11.0), Marker::Disc, 4.5, WHITE);
    sheet.text((526.0, below + 16.0), "limit measured on the code", 15, Anchor::Start, BLACK);
    let words =
        "One frame of the sun, 10¹⁰ td, is h λ = 174: far past the limit of every explicit method.";
    sheet.text((20.0, below + 50.0), words, 15, Anchor::Start, BLUE);
}
