//! How each method is drawn, the same in every chart.

use crate::plot::palette::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION};
use crate::plot::{Anchor, Ink, Marker, Sheet};

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
        _ => (BLACK, Marker::Star),
    }
}

/// Methods that are drawn; the CSV has all of them.
pub(super) const DRAWN: [&str; 12] = [
    "forward-euler",
    "heun",
    "rk4",
    "dopri5-adaptive",
    "backward-euler",
    "trapezoid",
    "tr-bdf2",
    "lobatto-iiic-2",
    "radau-iia-5",
    "ros2",
    "rodas4",
    "exact",
];

/// Names and marks of the drawn methods, in two rows.
pub(super) fn key(sheet: &mut Sheet, top: f64) {
    for (i, name) in DRAWN.into_iter().enumerate() {
        let at = (60.0 + 158.0 * (i % 6) as f64, top + 24.0 * (i / 6) as f64);
        let (ink, marker) = of_method(name);
        sheet.mark(at, marker, if marker == Marker::Star { 6.0 } else { 4.6 }, ink);
        sheet.text((at.0 + 11.0, at.1 + 5.0), name, 14, Anchor::Start, BLACK);
    }
}
