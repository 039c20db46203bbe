//! Colours and marks that stay apart for every kind of colour vision (Okabe & Ito 2008), also in grey.

use super::sheet::Ink;

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

/// Colours of things without an order, as many as stay apart.
pub(crate) const APART: [Ink; 7] = [BLACK, VERMILION, BLUE, GREEN, ORANGE, PURPLE, SKY];

/// Viridis (Smith & van der Walt 2015), tenths of it from dark on, without the two that are too pale
/// for lines on white.
const ORDERED: [Ink; 8] = [
    Ink(0x44, 0x01, 0x54),
    Ink(0x48, 0x28, 0x78),
    Ink(0x3e, 0x4a, 0x89),
    Ink(0x31, 0x68, 0x8e),
    Ink(0x26, 0x82, 0x8e),
    Ink(0x1f, 0x9e, 0x89),
    Ink(0x35, 0xb7, 0x79),
    Ink(0x6d, 0xcd, 0x59),
];

/// The colour of a place from 0 to 1: ever brighter, also in grey and for every kind of colour
/// vision.
pub(crate) fn ordered(place: f64) -> Ink {
    let along = place.clamp(0.0, 1.0) * (ORDERED.len() - 1) as f64;
    let from = (along as usize).min(ORDERED.len() - 2);
    let [a, b] = [ORDERED[from], ORDERED[from + 1]];
    let mix = |a: u8, b: u8| {
        (f64::from(a) + (along - from as f64) * (f64::from(b) - f64::from(a))).round() as u8
    };
    Ink(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ordered_colours_grow_brighter_all_the_way() {
        let luma = |ink: Ink| {
            0.2126 * f64::from(ink.0) + 0.7152 * f64::from(ink.1) + 0.0722 * f64::from(ink.2)
        };
        let brighter = (1..=100)
            .all(|i| luma(ordered(f64::from(i) / 100.0)) > luma(ordered(f64::from(i - 1) / 100.0)));
        assert!(brighter);
    }
}
