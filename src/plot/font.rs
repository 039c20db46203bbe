//! Font: outlines and widths of the typeface that the PNGs are set in, DejaVu Sans, regular and bold.
//!
//! `data/fonts` holds the Latin, Greek and Cyrillic letters, figures and signs of DejaVu 2.37, without hinting.

use std::sync::LazyLock;

use ttf_parser::{Face, GlyphId, OutlineBuilder};
use zeno::{Command, PathBuilder, Vector};

static REGULAR: LazyLock<Option<Face>> =
    LazyLock::new(|| face(include_bytes!("../../data/fonts/DejaVuSans.ttf")));
static BOLD: LazyLock<Option<Face>> =
    LazyLock::new(|| face(include_bytes!("../../data/fonts/DejaVuSans-Bold.ttf")));

fn face(bytes: &'static [u8]) -> Option<Face<'static>> {
    Face::parse(bytes, 0).ok()
}

fn of(bold: bool) -> Option<&'static Face<'static>> {
    if bold { BOLD.as_ref() } else { REGULAR.as_ref() }
}

/// Glyph of a character; the empty box for one that the typeface lacks.
fn glyph(face: &Face, c: char) -> GlyphId {
    face.glyph_index(c).unwrap_or(GlyphId(0))
}

/// Width of words set in `size` units to the em.
pub(crate) fn width(words: &str, size: f64, bold: bool) -> f64 {
    let Some(face) = of(bold) else { return 0.0 };
    let advances =
        words.chars().map(|c| f64::from(face.glyph_hor_advance(glyph(face, c)).unwrap_or(0)));
    advances.sum::<f64>() * size / f64::from(face.units_per_em())
}

/// Words as they are where they have room, else cut and with an ellipsis.
pub(crate) fn fitted(words: &str, size: f64, room: f64) -> String {
    if width(words, size, false) <= room {
        return words.to_owned();
    }
    let chars: Vec<char> = words.chars().collect();
    let cut = |n: usize| chars[..n].iter().chain(&['…']).collect::<String>();
    let fits = |words: &String| width(words, size, false) <= room;
    (0..chars.len()).rev().map(cut).find(fits).unwrap_or_default()
}

/// Outlines of words whose baseline begins at (0, 0), `size` units to the em, y downward.
pub(crate) fn outlines(words: &str, size: f64, bold: bool) -> Vec<Command> {
    let mut pen = Pen { path: Vec::new(), x: 0.0, scale: 0.0 };
    let Some(face) = of(bold) else { return pen.path };
    pen.scale = size as f32 / f32::from(face.units_per_em());
    for c in words.chars() {
        let glyph = glyph(face, c);
        face.outline_glyph(glyph, &mut pen);
        pen.x += pen.scale * f32::from(face.glyph_hor_advance(glyph).unwrap_or(0));
    }
    pen.path
}

/// Takes outlines in the typeface's own units, y upward.
struct Pen {
    path: Vec<Command>,
    x: f32,
    scale: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> Vector {
        Vector::new(self.x + self.scale * x, -self.scale * y)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.move_to(to);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        let to = self.at(x, y);
        self.path.line_to(to);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let (by, to) = (self.at(x1, y1), self.at(x, y));
        self.path.quad_to(by, to);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let (from, by, to) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.path.curve_to(from, by, to);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_sign_of_our_figures_has_a_glyph_in_both_weights() {
        let signs = "AZaz09 .,:;()[]+-=<>|/′”“…·−×⁰¹²³⁴⁵⁶⁷⁸⁹⁻₀ₗₘₛλτηρβΔ°µ≤≥≈→äéß";
        for bold in [false, true] {
            let face = of(bold).unwrap();
            let missing: String =
                signs.chars().filter(|c| face.glyph_index(*c).is_none()).collect();
            assert_eq!(missing, "");
        }
    }

    #[test]
    fn words_without_room_end_in_an_ellipsis() {
        assert_eq!(fitted("standard", 16.0, 100.0), "standard");
        let cut = fitted("smith-pokorny-van-norren", 16.0, 100.0);
        assert!(cut.ends_with('…') && cut.starts_with("smith-po"), "{cut}");
        assert!(width(&cut, 16.0, false) <= 100.0 && width(&cut, 16.0, false) > 80.0);
        assert_eq!(fitted("no room", 16.0, 1.0), "");
    }

    #[test]
    fn widths_are_those_of_the_typeface() {
        // DejaVu Sans 2.37: advances of 0 and H are 1303 and 1540 of 2048.
        assert!((width("0H", 2048.0, false) - (1303.0 + 1540.0)).abs() < 1e-9);
        assert!(width("H", 16.0, true) > width("H", 16.0, false));
    }
}
