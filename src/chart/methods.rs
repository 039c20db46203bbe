//! How each method is drawn, the same in every chart.

use crate::plot::palette::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION};
use crate::plot::{Anchor, Ink, Marker, Sheet};
use crate::step::METHODS;

/// Explicit methods are warm, implicit ones cool, exponential ones dark.
pub(super) fn of_method(name: &str) -> (Ink, Marker) {
    match name {
        "forward-euler" => (VERMILION, Marker::Disc),
        "heun" => (ORANGE, Marker::Square),
        "rk4" => (ORANGE, Marker::Triangle),
        "dopri5" => (VERMILION, Marker::Cross),
        "dopri5-adaptive" => (VERMILION, Marker::Diamond),
        "backward-euler" => (BLUE, Marker::Disc),
        "trapezoid" => (SKY, Marker::Square),
        "tr-bdf2" => (SKY, Marker::Triangle),
        "lobatto-iiic-2" => (BLUE, Marker::Diamond),
        "radau-iia-5" => (BLUE, Marker::Cross),
        "ros2" => (GREEN, Marker::Disc),
        "rodas4" => (GREEN, Marker::Square),
        "exponential-euler" => (PURPLE, Marker::Disc),
        "magnus-4" => (PURPLE, Marker::Triangle),
        "exponential-rosenbrock" => (PURPLE, Marker::Square),
        "ramp" => (GREY, Marker::Diamond),
        "exact" => (BLACK, Marker::Star),
        _ => (GREY, Marker::Ring),
    }
}

/// Methods that are not drawn: their points lie upon those of others. The CSV has all of them.
const HIDDEN: [&str; 5] =
    ["dopri5", "exponential-euler", "magnus-4", "exponential-rosenbrock", "ramp"];

/// Names of the methods that are drawn.
pub(super) fn drawn() -> Vec<&'static str> {
    METHODS.iter().map(|method| method.name).filter(|name| !HIDDEN.contains(name)).collect()
}

/// Names and marks of the drawn methods, in rows of six; returns where they end.
pub(super) fn key(sheet: &mut Sheet, top: f64) -> f64 {
    let names = drawn();
    let below = top + 24.0 * names.len().div_ceil(6) as f64;
    for (i, name) in names.into_iter().enumerate() {
        let at = (60.0 + 158.0 * (i % 6) as f64, top + 24.0 * (i / 6) as f64);
        let (ink, marker) = of_method(name);
        sheet.mark(at, marker, if marker == Marker::Star { 6.0 } else { 4.6 }, ink);
        sheet.text((at.0 + 11.0, at.1 + 5.0), name, 14, Anchor::Start, BLACK);
    }
    below
}
