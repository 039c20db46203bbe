//! Sheet: lines, shapes, marks and words at places on a page, to be written as SVG and as PNG.

/// A colour, sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Ink(pub(crate) u8, pub(crate) u8, pub(crate) u8);

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Marker {
    Disc,
    Ring,
    Square,
    Triangle,
    Diamond,
    Cross,
    Star,
}

/// Where words stand relative to their point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Anchor {
    Start,
    Middle,
    End,
}

/// A place on the sheet, units from the top left.
pub(crate) type Point = (f64, f64);

/// A line's colour, width and dashes (lengths on and off in turn, as in SVG; empty for none).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Stroke {
    pub(crate) ink: Ink,
    pub(crate) width: f64,
    pub(crate) dashes: Vec<f64>,
}

/// Words on a sheet; `at` is on their baseline.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Words {
    pub(crate) at: Point,
    pub(crate) words: String,
    /// Height of the type, units to the em.
    pub(crate) size: f64,
    pub(crate) anchor: Anchor,
    pub(crate) bold: bool,
    /// Read upward, turned about their point.
    pub(crate) upward: bool,
    pub(crate) ink: Ink,
}

/// One thing that is drawn.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Item {
    Words(Words),
    Path { points: Vec<Point>, closed: bool, fill: Option<Ink>, stroke: Option<Stroke> },
    Circle { at: Point, r: f64, fill: Option<Ink>, stroke: Option<Stroke> },
}

/// A drawing in the making, on white.
pub(crate) struct Sheet {
    pub(crate) width: f64,
    pub(crate) height: f64,
    pub(crate) items: Vec<Item>,
}

impl Sheet {
    pub(crate) fn new(width: f64, height: f64) -> Self {
        Sheet { width, height, items: Vec::new() }
    }

    /// Words of `size` units to the em.
    pub(crate) fn text(&mut self, at: Point, words: &str, size: u32, anchor: Anchor, ink: Ink) {
        self.set(at, words, size, (anchor, false, false), ink);
    }

    /// Words that stand out.
    pub(crate) fn bold(&mut self, at: Point, words: &str, size: u32, anchor: Anchor, ink: Ink) {
        self.set(at, words, size, (anchor, true, false), ink);
    }

    /// Words that read upward, centred on their point.
    pub(crate) fn upward(&mut self, at: Point, words: &str, size: u32, ink: Ink) {
        self.set(at, words, size, (Anchor::Middle, false, true), ink);
    }

    fn set(&mut self, at: Point, words: &str, size: u32, style: (Anchor, bool, bool), ink: Ink) {
        let ((anchor, bold, upward), words, size) = (style, words.to_owned(), f64::from(size));
        self.items.push(Item::Words(Words { at, words, size, anchor, bold, upward, ink }));
    }

    /// A straight line; `dashes` as in SVG, empty for none.
    pub(crate) fn line(&mut self, from: Point, to: Point, ink: Ink, width: f64, dashes: &str) {
        self.polyline(&[from, to], ink, width, dashes);
    }

    /// A line through many points.
    pub(crate) fn polyline(&mut self, points: &[Point], ink: Ink, width: f64, dashes: &str) {
        let dashes = dashes.split([' ', ',']).filter_map(|length| length.parse().ok()).collect();
        let stroke = Some(Stroke { ink, width, dashes });
        self.items.push(Item::Path { points: points.to_vec(), closed: false, fill: None, stroke });
    }

    /// A filled shape with a fine edge.
    fn polygon(&mut self, points: Vec<Point>, fill: Ink, edge: Ink) {
        let stroke = Some(Stroke { ink: edge, width: 0.6, dashes: Vec::new() });
        self.items.push(Item::Path { points, closed: true, fill: Some(fill), stroke });
    }

    /// A filled rectangle from its top left corner.
    pub(crate) fn block(&mut self, at: Point, width: f64, height: f64, ink: Ink) {
        let (right, bottom) = (at.0 + width, at.1 + height);
        let points = vec![at, (right, at.1), (right, bottom), (at.0, bottom)];
        self.items.push(Item::Path { points, closed: true, fill: Some(ink), stroke: None });
    }

    /// A mark of radius `r`.
    pub(crate) fn mark(&mut self, at: Point, marker: Marker, r: f64, ink: Ink) {
        let corners = |count: usize, radius: &dyn Fn(usize) -> f64, turn: f64| -> Vec<Point> {
            let angle = |i: usize| turn + std::f64::consts::TAU * i as f64 / count as f64;
            (0..count)
                .map(|i| (at.0 + radius(i) * angle(i).sin(), at.1 - radius(i) * angle(i).cos()))
                .collect()
        };
        let white = Ink(255, 255, 255);
        match marker {
            Marker::Disc => self.circle(at, r, Some(ink), white, 0.6),
            Marker::Ring => self.circle(at, r, None, ink, 2.0),
            Marker::Square => {
                self.polygon(corners(4, &|_| 1.25 * r, std::f64::consts::FRAC_PI_4), ink, white)
            }
            Marker::Diamond => self.polygon(corners(4, &|_| 1.3 * r, 0.0), ink, white),
            Marker::Triangle => self.polygon(corners(3, &|_| 1.35 * r, 0.0), ink, white),
            Marker::Star => {
                self.polygon(
                    corners(10, &|i| if i % 2 == 0 { 1.9 * r } else { 0.8 * r }, 0.0),
                    ink,
                    white,
                );
            }
            Marker::Cross => {
                self.line((at.0 - r, at.1 - r), (at.0 + r, at.1 + r), ink, 2.2, "");
                self.line((at.0 - r, at.1 + r), (at.0 + r, at.1 - r), ink, 2.2, "");
            }
        }
    }

    fn circle(&mut self, at: Point, r: f64, fill: Option<Ink>, edge: Ink, width: f64) {
        let stroke = Some(Stroke { ink: edge, width, dashes: Vec::new() });
        self.items.push(Item::Circle { at, r, fill, stroke });
    }
}
