//! The picture of the ladder: a panel for each scene, cost against error of each rung.

use crate::plot::axes::power;
use crate::plot::palette::{BLACK, BLUE, GREEN, GREY, ORANGE, PALE_GREY, PURPLE, VERMILION};
use crate::plot::{Anchor, Axis, Ink, Marker, Panel, Sheet, font};

/// How each rung is drawn.
fn style(name: &str) -> (Ink, Marker) {
    match name {
        "none" => (ORANGE, Marker::Square),
        "steady" => (PURPLE, Marker::Triangle),
        "tracked" => (BLUE, Marker::Disc),
        "full" => (GREY, Marker::Diamond),
        _ => (GREEN, Marker::Ring),
    }
}

/// Errors below this are drawn on the floor.
const FLOOR: f64 = 1e-9;

/// The rung that is the truth: it costs a hundred times the others and stands on a strip of its own.
const TRUTH: &str = "full";

/// Width of a panel, of the strip beside it, and height of both.
const SIZE: [f64; 3] = [330.0, 56.0, 220.0];
/// From one column to the next, and from one row.
const PITCH: [f64; 2] = [500.0, 318.0];

/// The budget of the tracked rung.
pub(super) const BUDGET: f64 = 1e-3;

/// What one rung did on one scene.
pub(super) struct Rung {
    pub(crate) name: &'static str,
    pub(crate) cost_ms: f64,
    /// Largest error of p and of a catch.
    pub(crate) errors: [f64; 2],
    /// CIEDE2000 of the display picture, 95 % and largest.
    pub(crate) differences: [f64; 2],
    pub(crate) bound: Option<f64>,
    pub(crate) chosen: bool,
}

/// The figure: scenes by their titles, with their rungs.
pub(super) fn drawn(found: &[(&str, &[Rung])]) -> Sheet {
    let rows = (found.len() + 1).div_ceil(2);
    let mut sheet = Sheet::new(1000.0, 70.0 + PITCH[1] * rows as f64);
    let title = "No more than a scene needs: cost and error of each rung";
    sheet.bold((500.0, 28.0), title, 20, Anchor::Middle, BLACK);
    let axes = axes(found);
    let place = |i: usize| (76.0 + PITCH[0] * (i % 2) as f64, 80.0 + PITCH[1] * (i / 2) as f64);
    for (i, (title, rungs)) in found.iter().enumerate() {
        scene(&mut sheet, title, rungs, axes, place(i));
    }
    legend(&mut sheet, place(found.len()));
    sheet
}

fn error(rung: &Rung) -> f64 {
    rung.errors[0].max(rung.errors[1])
}

/// Axes that hold all rungs of all scenes but the truth, and no empty decades.
fn axes(found: &[(&str, &[Rung])]) -> [Axis<'static>; 2] {
    let rungs =
        || found.iter().flat_map(|(_, rungs)| rungs.iter()).filter(|rung| rung.name != TRUTH);
    let range = |values: &mut dyn Iterator<Item = f64>| {
        let known = values.filter(|v| *v > 0.0 && v.is_finite());
        let (least, most) =
            known.fold((f64::INFINITY, 0.0), |(a, b): (f64, f64), v| (a.min(v), b.max(v)));
        if most > 0.0 { [least.log10().floor(), most.log10().ceil()] } else { [0.0, 1.0] }
    };
    let costs = range(&mut rungs().map(|rung| rung.cost_ms));
    let errors =
        range(&mut rungs().flat_map(|rung| [error(rung), rung.bound.unwrap_or(0.0), BUDGET]));
    let axis = |[from, to]: [f64; 2], label| {
        let to = if to > from { to } else { from + 1.0 };
        Axis::logarithmic(10f64.powf(from), 10f64.powf(to), 6.0, label)
    };
    let errors = [errors[0].max(FLOOR.log10()), errors[1]];
    [axis(costs, "ms for a megapixel and frame"), axis(errors, "largest error")]
}

fn scene(
    sheet: &mut Sheet,
    title: &str,
    rungs: &[Rung],
    [x, y]: [Axis<'static>; 2],
    at: (f64, f64),
) {
    let panel = Panel { left: at.0, top: at.1, width: SIZE[0], height: SIZE[2], x, y };
    sheet.block((panel.right(), panel.top), SIZE[1], panel.height, PALE_GREY);
    panel.frame(sheet);
    sheet.bold((panel.left, panel.top - 10.0), title, 15, Anchor::Start, BLACK);
    let budget = panel.at(x.to, BUDGET).1;
    sheet.line((panel.left, budget), (panel.right(), budget), VERMILION, 1.2, "6 4");
    for rung in rungs.iter().filter(|rung| rung.name != TRUTH) {
        draw(sheet, &panel, rung);
    }
    for truth in rungs.iter().filter(|rung| rung.name == TRUTH) {
        let (ink, marker) = style(TRUTH);
        let middle = panel.right() + 0.5 * SIZE[1];
        sheet.mark((middle, panel.bottom()), marker, 6.0, ink);
        sheet.upward(
            (middle + 5.0, panel.top + 0.5 * panel.height),
            &cost(truth.cost_ms),
            14,
            BLACK,
        );
    }
    name(sheet, &panel, rungs);
}

/// Milliseconds in two digits.
fn cost(ms: f64) -> String {
    let size = ms.max(1e-9).log10().floor();
    match ms {
        1e4.. => format!("full: {:.1}·{} ms", ms / 10f64.powf(size), power(size)),
        _ => format!("full: {ms:.0} ms"),
    }
}

fn draw(sheet: &mut Sheet, panel: &Panel, rung: &Rung) {
    let (ink, marker) = style(rung.name);
    let at = panel.at(rung.cost_ms, error(rung).max(panel.y.from));
    if let Some(bound) = rung.bound.filter(|bound| *bound > panel.y.from) {
        let (x, y) = panel.at(rung.cost_ms, bound);
        sheet.line((x, y), at, ink, 1.0, "2 3");
        sheet.line((x - 9.0, y), (x + 9.0, y), ink, 2.4, "");
    }
    sheet.mark(at, marker, if rung.name == "auto" { 11.0 } else { 5.5 }, ink);
}

/// Names beside the marks, to the side where there is room.
fn name(sheet: &mut Sheet, panel: &Panel, rungs: &[Rung]) {
    let shown = rungs.iter().filter(|rung| rung.name != TRUTH && rung.name != "auto");
    for rung in shown {
        let (x, y) = panel.at(rung.cost_ms, error(rung).max(panel.y.from));
        let width = font::width(rung.name, 14.0, false);
        let is_right = x + 16.0 + width < panel.right();
        let (x, anchor) =
            if is_right { (x + 15.0, Anchor::Start) } else { (x - 15.0, Anchor::End) };
        sheet.text((x, (y - 4.0).max(panel.top + 13.0)), rung.name, 14, anchor, style(rung.name).0);
    }
}

fn legend(sheet: &mut Sheet, (x, top): (f64, f64)) {
    let words = [
        ("none", "none: nothing bleaches"),
        ("steady", "steady: frame by frame (paper Eq. 1)"),
        ("tracked", "tracked: the exact step, by kernels"),
        ("full", "full: every nanometre, 16 sub-steps (the truth)"),
        ("auto", "auto: what the plan chose"),
    ];
    let row = |i: usize| top + 8.0 + 28.0 * i as f64;
    for (i, (name, words)) in words.into_iter().enumerate() {
        let (ink, marker) = style(name);
        sheet.mark((x, row(i)), marker, if name == "auto" { 11.0 } else { 5.5 }, ink);
        sheet.text((x + 24.0, row(i) + 5.0), words, 15, Anchor::Start, BLACK);
    }
    sheet.line((x - 10.0, row(5)), (x + 10.0, row(5)), BLACK, 2.4, "");
    let bound = "the most it can err, where that is promised";
    sheet.text((x + 24.0, row(5) + 5.0), bound, 15, Anchor::Start, BLACK);
    sheet.line((x - 12.0, row(6)), (x + 12.0, row(6)), VERMILION, 1.2, "6 4");
    sheet.text((x + 24.0, row(6) + 5.0), "the budget, 10⁻³", 15, Anchor::Start, BLACK);
    let error = "errors of p or of a catch, whichever is larger";
    sheet.text((x + 24.0, row(7) + 5.0), error, 15, Anchor::Start, BLACK);
}
