//! Colours and marks that stay apart for every kind of colour vision (Okabe & Ito 2008), also in
//! grey.

use super::draw::{Ink, Marker};

pub(crate) const BLACK: Ink = Ink(0x00, 0x00, 0x00);
pub(crate) const ORANGE: Ink = Ink(0xe6, 0x9f, 0x00);
pub(crate) const SKY: Ink = Ink(0x56, 0xb4, 0xe9);
pub(crate) const GREEN: Ink = Ink(0x00, 0x9e, 0x73);
pub(crate) const BLUE: Ink = Ink(0x00, 0x72, 0xb2);
pub(crate) const VERMILION: Ink = Ink(0xd5, 0x5e, 0x00);
pub(crate) const PURPLE: Ink = Ink(0xcc, 0x79, 0xa7);
pub(crate) const GREY: Ink = Ink(0x8a, 0x8a, 0x8a);
pub(crate) const FAINT: Ink = Ink(0xdd, 0xdd, 0xdd);
pub(crate) const PALE_GREEN: Ink = Ink(0xe9, 0xf5, 0xf0);
pub(crate) const PALE_GREY: Ink = Ink(0xf2, 0xf2, 0xf2);
pub(crate) const PALE_RED: Ink = Ink(0xfb, 0xec, 0xe2);
pub(crate) const WHITE: Ink = Ink(0xff, 0xff, 0xff);

/// How each method is drawn: explicit ones warm, implicit ones cool, exponential ones dark.
pub(crate) fn of_method(name: &str) -> (Ink, Marker) {
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
