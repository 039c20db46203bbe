//! The sheet of six panels: time per update against error, failures on a rail of their own.

use super::methods::{drawn as methods, key, of_method};
use super::work::{BUDGET, Failure, Point};
use crate::plot::palette::{BLACK, GREY, PALE_GREEN, PALE_RED, VERMILION, WHITE};
use crate::plot::{Anchor, Axis, Ink, Marker, Panel, Sheet};

/// How far published half-bleach constants move p.
const PUBLISHED_SPREAD: f64 = 0.23;

/// Nanoseconds that the spectral part costs per place and cone: by stored levels, and by all bands.
const SPECTRAL_NS: [f64; 2] = [22.0, 280.0];

/// One panel: what it shows of which points.
struct View {
    title: &'static str,
    scene: &'static str,
    law: &'static str,
    relative: bool,
}

const fn view(title: &'static str, scene: &'static str, law: &'static str, relative: bool) -> View {
    View { title, scene, law, relative }
}

const VIEWS: [View; 6] = [
    view("indoor: 300 and 1000 td, 24 fps", "indoor", "first-order", false),
    view("headlamp: 1 s of 10⁷ td, 24 fps", "headlamp", "first-order", false),
    view("sun glance: 6 frames of 10¹⁰ td", "sun-glance", "first-order", false),
    view("sun glance, relative error of p", "sun-glance", "first-order", true),
    view("sun glance, self-screened law", "sun-glance", "self-screened", false),
    view("time-lapse, rate-limited law", "time-lapse", "rate-limited", false),
];

/// From one column to the next, and from one row.
const PITCH: [f64; 2] = [500.0, 318.0];

/// Height of the sheet below the key.
const HEIGHT: f64 = 1076.0;

pub(super) fn drawn(points: &[Point]) -> Sheet {
    let rows = methods().len().div_ceil(6) as f64;
    let mut sheet = Sheet::new(1000.0, 56.0 + 24.0 * rows + HEIGHT);
    let title = "Work against precision: left and low is good";
    sheet.bold((500.0, 28.0), title, 20, Anchor::Middle, BLACK);
    let top = key(&mut sheet, 56.0) + 32.0;
    for (i, view) in VIEWS.iter().enumerate() {
        let at = (76.0 + PITCH[0] * (i % 2) as f64, top + PITCH[1] * (i / 2) as f64);
        draw_view(&mut sheet, view, points, at);
    }
    notes(&mut sheet, top + 3.0 * PITCH[1] - 10.0);
    sheet
}

/// Width of the part of a panel that has an axis, and of the rail for failures beside it.
const WIDTHS: [f64; 2] = [310.0, 84.0];

fn draw_view(sheet: &mut Sheet, view: &View, points: &[Point], at: (f64, f64)) {
    let panel = ground(sheet, view, at);
    let is_shown = |point: &&Point| point.scene == view.scene && point.law.name() == view.law;
    let shown: Vec<&Point> = points.iter().filter(is_shown).collect();
    let fails =
        |name: &str| shown.iter().any(|point| point.method.name == name && point.failure.is_some());
    let failing = methods().into_iter().filter(|name| fails(name)).count();
    let apart = f64::min(11.5, (WIDTHS[1] - 16.0) / failing.max(2) as f64);
    let mut lane = panel.right() + 9.0;
    for name in methods() {
        draw_method(sheet, &panel, view, &shown, lane, name);
        lane += if fails(name) { apart } else { 0.0 };
    }
    ring_the_cheapest(sheet, &panel, view, &shown);
}

/// The panel's axes and rail, its title, and the lines that it is read by.
fn ground(sheet: &mut Sheet, view: &View, at: (f64, f64)) -> Panel<'static> {
    let label = if view.relative { "largest |p/p true − 1|" } else { "largest |p − p true|" };
    let x = Axis { from: 1e-17, to: 1.0, logarithmic: true, every: 4.0, label };
    let y = Axis { from: 1.0, to: 1e4, logarithmic: true, every: 1.0, label: "ns per update" };
    let panel = Panel { left: at.0, top: at.1, width: WIDTHS[0], height: 220.0, x, y };
    let budget = panel.at(BUDGET, 1.0).0;
    sheet.block((panel.left, panel.top), budget - panel.left, panel.height, PALE_GREEN);
    sheet.block((panel.right(), panel.top), WIDTHS[1], panel.height, PALE_RED);
    panel.frame(sheet);
    let rail = (panel.right() + 0.5 * WIDTHS[1], panel.bottom() + 20.0);
    sheet.text(rail, "failed", 15, Anchor::Middle, VERMILION);
    sheet.bold((panel.left - 40.0, panel.top - 12.0), view.title, 16, Anchor::Start, BLACK);
    let spread = panel.at(PUBLISHED_SPREAD, 1.0).0;
    sheet.line((spread, panel.top), (spread, panel.bottom()), GREY, 1.2, "2 3");
    for ns in SPECTRAL_NS {
        let height = panel.at(1.0, ns).1;
        sheet.line((panel.left, height), (panel.right(), height), GREY, 1.2, "6 4");
    }
    if view.scene == "headlamp" && !view.relative {
        draw_orders(sheet, &panel);
    }
    panel
}

/// The slopes that theory gives to methods of order 1, 2, 4 and 5: four times the work, 4^-order
/// the error.
fn draw_orders(sheet: &mut Sheet, panel: &Panel) {
    let (error, ns) = (1e-8, 1.5);
    for order in [1, 2, 4, 5] {
        let end = panel.at(error * 4f64.powi(-order), 4.0 * ns);
        sheet.line(panel.at(error, ns), end, GREY, 1.2, "");
        sheet.text((end.0, end.1 - 4.0), &order.to_string(), 13, Anchor::Middle, GREY);
    }
    sheet.text(
        (panel.at(error, ns).0 + 6.0, panel.at(error, ns).1 - 2.0),
        "order",
        13,
        Anchor::Start,
        GREY,
    );
}

fn error(view: &View, point: &Point) -> f64 {
    (if view.relative { point.max_rel_error } else { point.max_abs_error }).max(1e-17)
}

fn draw_method(
    sheet: &mut Sheet,
    panel: &Panel,
    view: &View,
    shown: &[&Point],
    lane: f64,
    name: &str,
) {
    let (ink, marker) = of_method(name);
    let of_it = shown.iter().copied().filter(|point| point.method.name == name);
    let (failed, sound): (Vec<&Point>, Vec<&Point>) =
        of_it.partition(|point| point.failure.is_some());
    let places: Vec<_> =
        sound.iter().map(|point| panel.at(error(view, point), point.ns_per_update)).collect();
    if name == "exact" && places.len() == 1 {
        sheet.line((places[0].0, panel.top), (places[0].0, panel.bottom()), ink, 1.4, "5,4");
    }
    if places.len() > 1 {
        sheet.polyline(&places, ink, 1.6, "");
    }
    let size = if marker == Marker::Star { 6.0 } else { 4.2 };
    places.iter().for_each(|&place| sheet.mark(place, marker, size, ink));
    let failures: Vec<_> =
        failed.iter().filter_map(|point| Some((point.ns_per_update, point.failure?))).collect();
    draw_failures(sheet, panel, lane, &failures, ink);
}

/// A lane of the rail: a dot for every amount of work, lettered where the way of failing changes.
fn draw_failures(sheet: &mut Sheet, panel: &Panel, x: f64, failures: &[(f64, Failure)], ink: Ink) {
    let heights: Vec<f64> = failures.iter().map(|(ns, _)| panel.at(1.0, *ns).1).collect();
    let places: Vec<_> = heights.iter().map(|&y| (x, y)).collect();
    if places.len() > 1 {
        sheet.polyline(&places, ink, 1.2, "");
    }
    for (i, (_, failure)) in failures.iter().enumerate() {
        if i == 0 || failures[i - 1].1 != *failure {
            sheet.bold((x, heights[i] + 15.0), failure.letter(), 15, Anchor::Middle, ink);
        }
        sheet.mark(places[i], Marker::Disc, 2.4, ink);
    }
}

fn ring_the_cheapest(sheet: &mut Sheet, panel: &Panel, view: &View, shown: &[&Point]) {
    let methods = methods();
    let drawn =
        shown.iter().filter(|point| methods.contains(&point.method.name) && point.keeps_budget());
    let Some(best) = drawn.min_by(|a, b| a.ns_per_update.total_cmp(&b.ns_per_update)) else {
        return;
    };
    let place = panel.at(error(view, best), best.ns_per_update);
    sheet.mark(place, Marker::Ring, 12.0, BLACK);
    let words = format!("{}, {:.0} ns", best.method.name, best.ns_per_update);
    sheet.block((panel.left + 1.0, panel.top + 1.0), 8.0 + 7.6 * words.len() as f64, 22.0, WHITE);
    sheet.text((panel.left + 6.0, panel.top + 17.0), &words, 14, Anchor::Start, BLACK);
}

fn notes(sheet: &mut Sheet, top: f64) {
    let notes = [
        "Green: an error below 0.001; ringed: the cheapest that keeps this budget, of p and of a catch. Along a line: 1, 2, 4, 8, 16",
        "sub-steps, or tolerances 10⁻² to 10⁻¹⁰. Failed: B blow-up, N negative pigment, R ringing, F frozen. Dotted: how far",
        "published half-bleach constants move p (0.23). Dashed: the spectral part, 22 ns with stored levels, 280 ns with all bands.",
    ];
    for (i, note) in notes.iter().enumerate() {
        sheet.text((20.0, top + 22.0 * i as f64), note, 14, Anchor::Start, BLACK);
    }
}
