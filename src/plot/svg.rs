//! SVG: a sheet in words that a browser, a vector editor and LaTeX read.

use std::fmt::Write;

use super::sheet::{Anchor, Ink, Item, Point, Sheet, Stroke, Words};

/// The typeface of the PNGs first, then one of the same widths (Verdana), then whatever has no serifs.
const FAMILY: &str = "DejaVu Sans, Verdana, sans-serif";

/// The whole document: as large as the sheet in units, scalable by its view box.
pub(super) fn document(sheet: &Sheet) -> String {
    let (width, height) = (sheet.width, sheet.height);
    let mut text = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"{FAMILY}\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#ffffff\"/>\n"
    );
    for item in &sheet.items {
        text += &match item {
            Item::Words(words) => written(words),
            Item::Path { points, closed, fill, stroke } => {
                format!("<path d=\"{}\"{}/>\n", outline(points, *closed), style(*fill, stroke))
            }
            Item::Circle { at, r, fill, stroke } => {
                let (x, y) = (number(at.0), number(at.1));
                format!(
                    "<circle cx=\"{x}\" cy=\"{y}\" r=\"{}\"{}/>\n",
                    number(*r),
                    style(*fill, stroke)
                )
            }
        };
    }
    text + "</svg>\n"
}

fn written(words: &Words) -> String {
    let (x, y, size) = (number(words.at.0), number(words.at.1), number(words.size));
    let mut text = format!("<text x=\"{x}\" y=\"{y}\" font-size=\"{size}\"");
    match words.anchor {
        Anchor::Start => {}
        Anchor::Middle => text += " text-anchor=\"middle\"",
        Anchor::End => text += " text-anchor=\"end\"",
    }
    if words.bold {
        text += " font-weight=\"bold\"";
    }
    if words.upward {
        text += &format!(" transform=\"rotate(-90 {x} {y})\"");
    }
    format!("{text} fill=\"{}\">{}</text>\n", code(words.ink), escaped(&words.words))
}

fn style(fill: Option<Ink>, stroke: &Option<Stroke>) -> String {
    let mut text = format!(" fill=\"{}\"", fill.map_or("none".into(), code));
    if let Some(Stroke { ink, width, dashes }) = stroke {
        let _ = write!(
            text,
            " stroke=\"{}\" stroke-width=\"{}\" stroke-linejoin=\"round\"",
            code(*ink),
            number(*width)
        );
        if !dashes.is_empty() {
            let dashes: Vec<String> = dashes.iter().map(|length| number(*length)).collect();
            let _ = write!(text, " stroke-dasharray=\"{}\"", dashes.join(" "));
        }
    }
    text
}

fn outline(points: &[Point], closed: bool) -> String {
    let places: Vec<String> =
        points.iter().map(|p| format!("{},{}", number(p.0), number(p.1))).collect();
    format!("M{}{}", places.join("L"), if closed { "Z" } else { "" })
}

/// Hundredths of a unit, as short as they can be written.
fn number(value: f64) -> String {
    ((value * 100.0).round() / 100.0 + 0.0).to_string()
}

fn code(Ink(red, green, blue): Ink) -> String {
    format!("#{red:02x}{green:02x}{blue:02x}")
}

/// Words as character data. Characters that XML 1.0 has no place for become U+FFFD.
fn escaped(words: &str) -> String {
    let mut text = String::with_capacity(words.len());
    for c in words.chars() {
        match c {
            '&' => text += "&amp;",
            '<' => text += "&lt;",
            '>' => text += "&gt;",
            '\t' | '\n' | '\r' => text.push(' '),
            '\0'..='\x1f' | '\u{fffe}' | '\u{ffff}' => text.push('\u{fffd}'),
            c => text.push(c),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_document_names_its_typeface_and_scales_with_its_page() {
        let svg = Sheet::new(300.0, 200.0).svg();
        assert!(
            svg.contains("viewBox=\"0 0 300 200\"")
                && svg.contains("font-family=\"DejaVu Sans, Verdana, sans-serif\"")
        );
    }

    #[test]
    fn words_of_any_kind_leave_the_document_well_formed() {
        let mut sheet = Sheet::new(300.0, 200.0);
        sheet.text((10.0, 20.0), "a<b & \u{7}\u{1b}[31m \"c\"", 16, Anchor::Start, Ink(1, 2, 255));
        assert!(
            sheet.svg().contains("fill=\"#0102ff\">a&lt;b &amp; \u{fffd}\u{fffd}[31m \"c\"</text>"),
            "{}",
            sheet.svg()
        );
    }

    #[test]
    fn places_are_written_to_a_hundredth() {
        let points = [(1.0, 2.5), (7.718, -0.001), (10.0, 1e3)];
        assert_eq!(outline(&points, true), "M1,2.5L7.72,0L10,1000Z");
        assert_eq!(outline(&points[..1], false), "M1,2.5");
    }
}
