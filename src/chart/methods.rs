//! How each method is drawn, the same in every chart.

use crate::plot::palette::{BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, SKY, VERMILION};
use crate::plot::{Ink, Marker};

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
