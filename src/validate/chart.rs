//! `validate.svg`: how the error of the steady state falls, the fitted rates on theory's line, and
//! how much of its tolerance every check uses up.

use std::path::Path;

use super::{Check, Field, Group, Validation, Verdict, summary};
use crate::error::Result;

use crate::plot::axes::power;
use crate::plot::palette::{
    BLACK, BLUE, FAINT, GREEN, GREY, ORANGE, PALE_GREEN, PALE_RED, PURPLE, SKY, VERMILION,
};
use crate::plot::{Anchor, Ink, Marker, Sheet};
use crate::plot::{Axis, Panel};

/// Draws what a validation found.
pub fn write(out_dir: &Path, validation: &Validation) -> Result<()> {
    let rows = judged(validation).count();
    let mut sheet = Sheet::new(1000.0, SHARES_TOP + ROW * rows as f64 + 62.0);
    sheet.bold(
        (500.0, 28.0),
        "The steady state is the limit of long exposure",
        20,
        Anchor::Middle,
        BLACK,
    );
    falls(&mut sheet, &validation.fields);
    rates(&mut sheet, &validation.fields);
    shares(&mut sheet, validation);
    sheet.write(out_dir, "validate")
}

/// Inks of the decades of light, 1 to 1e10 td, in turn.
const INKS: [Ink; 6] = [PURPLE, BLUE, SKY, GREEN, ORANGE, VERMILION];

fn ink(light: f64) -> Ink {
    INKS[(light.log10().round() as usize / 2) % INKS.len()]
}

fn is_drawn(field: &&Field) -> bool {
    (field.light.log10().round() as i64) % 2 == 0
}

/// Error against time, on theory's broad line.
fn falls(sheet: &mut Sheet, fields: &[Field]) {
    let x = Axis {
        from: 1e-6,
        to: 1e6,
        logarithmic: true,
        every: 2.0,
        label: "time under steady light (s)",
    };
    let y = Axis { from: 1e-16, to: 1.0, logarithmic: true, every: 2.0, label: "" };
    let panel = Panel { left: 80.0, top: 96.0, width: 400.0, height: 340.0, x, y };
    panel.frame(sheet);
    sheet.upward((26.0, 266.0), "|p − steady p|", 16, BLACK);
    sheet.bold((panel.left, 66.0), "Error of the steady state", 16, Anchor::Start, BLACK);
    let of = "standard L cone, from all and from no pigment";
    sheet.text((panel.left, 86.0), of, 14, Anchor::Start, GREY);
    let drawn = || fields.iter().filter(is_drawn).filter(|field| field.start != 0.5);
    let shown = |points: &[(f64, f64)]| -> Vec<_> {
        points.iter().filter(|p| p.0 >= 1e-6 && p.1 >= 1e-16).map(|p| panel.at(p.0, p.1)).collect()
    };
    for field in drawn() {
        let theory = |time: f64| field.falls[0].error * (-field.rate * time).exp();
        let points: Vec<_> =
            field.falls.iter().map(|fall| (fall.time, theory(fall.time))).collect();
        sheet.polyline(&shown(&points), FAINT, 7.0, "");
    }
    for field in drawn() {
        let points: Vec<_> = field.falls.iter().map(|fall| (fall.time, fall.error)).collect();
        sheet.polyline(&shown(&points), ink(field.light), 2.0, "");
    }
    drawn().filter(|field| field.start == 0.0).for_each(|field| name_light(sheet, &panel, field));
    let (x, y) = (panel.left + 16.0, panel.bottom() - 40.0);
    sheet.line((x, y), (x + 34.0, y), FAINT, 7.0, "");
    sheet.text((x + 42.0, y + 5.0), "theory", 15, Anchor::Start, BLACK);
}

/// Names a light beside its curve, the low ones, which fall alike, together.
fn name_light(sheet: &mut Sheet, panel: &Panel, field: &Field) {
    let (at, words) = match field.light {
        ..=1e3 => return,
        ..1e5 => ((8e5, 3e-9), "1 to 10⁴ td".to_owned()),
        light => ((15.0 / field.rate, 3e-14), format!("{} td", power(light.log10()))),
    };
    sheet.text(panel.at(at.0, at.1), &words, 14, Anchor::End, ink(field.light));
}

/// Fitted rates of every start, on the line (1 + I/I0)/tau.
fn rates(sheet: &mut Sheet, fields: &[Field]) {
    let x = Axis { from: 1.0, to: 1e10, logarithmic: true, every: 2.0, label: "light (td)" };
    let y =
        Axis { from: 1e-3, to: 1e4, logarithmic: true, every: 1.0, label: "rate of fall (1/s)" };
    let panel = Panel { left: 584.0, top: 96.0, width: 386.0, height: 340.0, x, y };
    panel.frame(sheet);
    sheet.bold((panel.left, 86.0), "Fitted rate, on (1 + I/I₀)/τ", 16, Anchor::Start, BLACK);
    let line: Vec<_> =
        fields.iter().filter(|f| f.start == 1.0).map(|f| panel.at(f.light, f.rate)).collect();
    sheet.polyline(&line, GREY, 2.0, "");
    let markers = [(1.0, Marker::Disc, 5.0), (0.0, Marker::Ring, 8.0), (0.5, Marker::Cross, 4.0)];
    for (i, (start, marker, size)) in markers.into_iter().enumerate() {
        for field in fields.iter().filter(|f| f.start == start) {
            sheet.mark(panel.at(field.light, field.fitted), marker, size, BLUE);
        }
        let y = 120.0 + 24.0 * i as f64;
        sheet.mark((606.0, y), marker, size, BLUE);
        sheet.text((622.0, y + 5.0), &format!("from p = {start}"), 15, Anchor::Start, BLACK);
    }
}

/// Where the shares begin, and the height of a group of them.
const SHARES_TOP: f64 = 556.0;
const ROW: f64 = 40.0;

/// The groups with a check that is judged.
fn judged(validation: &Validation) -> impl Iterator<Item = &Group> {
    validation.groups.iter().filter(|group| group.checks.iter().any(|c| c.share().is_some()))
}

/// Every check as a point: its difference as a share of its tolerance; what passes lies left of
/// one.
fn shares(sheet: &mut Sheet, validation: &Validation) {
    let (left, top) = (410.0, SHARES_TOP);
    let x = Axis {
        from: 1e-6,
        to: 1e2,
        logarithmic: true,
        every: 1.0,
        label: "difference as a share of the tolerance",
    };
    let judged: Vec<_> = judged(validation).collect();
    let height = ROW * judged.len() as f64;
    let y = Axis { from: 0.1, to: 1.0, logarithmic: false, every: 2.0, label: "" };
    let panel = Panel { left, top, width: 560.0, height, x, y };
    let pass = panel.at(1.0, 1.0).0;
    sheet.block((left, top), pass - left, height, PALE_GREEN);
    sheet.block((pass, top), panel.right() - pass, height, PALE_RED);
    panel.frame(sheet);
    sheet.bold((20.0, top - 16.0), &summary(validation), 16, Anchor::Start, BLACK);
    sheet.text((pass - 8.0, top - 14.0), "pass", 15, Anchor::End, GREEN);
    sheet.text((pass + 8.0, top - 14.0), "fail", 15, Anchor::Start, VERMILION);
    for (i, group) in judged.iter().enumerate() {
        let y = top + ROW * (i as f64 + 0.5);
        sheet.text((left - 12.0, y + 5.0), &short(group.title), 14, Anchor::End, BLACK);
        for (j, check) in group.checks.iter().enumerate() {
            let jitter = 9.0 * ((j * 7 % 5) as f64 - 2.0) / 2.0;
            mark(sheet, &panel, y + jitter, check);
        }
    }
}

/// A heading without what follows its colon, where there is no room for it.
fn short(title: &str) -> String {
    title.replace("The steady state as the limit of long exposure:", "Steady state as a limit:")
}

fn mark(sheet: &mut Sheet, panel: &Panel, y: f64, check: &Check) {
    let Some(share) = check.share() else { return };
    let ink = if check.verdict == Verdict::Pass { GREEN } else { VERMILION };
    sheet.mark((panel.at(share.max(1e-6), 1.0).0, y), Marker::Disc, 4.0, ink);
}
