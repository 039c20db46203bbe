//! Ink on a sheet: panels with axes, marks, lines and words, written as SVG and as PNG by `kuva`.
//!
//! `kuva` lays out one kind of plot at a time; a chart with letters on a rail or a map with ticks
//! of theory is none of its kinds. So this module places its primitives itself, and uses its SVG
//! and PNG writers and its typeface.

use crate::error::{Error, Result};
use kuva::backend::raster::RasterBackend;
use kuva::backend::svg::SvgBackend;
use kuva::render::color::Color;
use kuva::render::render::{PathData, Primitive, Scene, TextAnchor};
use std::path::Path;

/// A colour, sRGB.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ink(pub u8, pub u8, pub u8);

impl From<Ink> for Color {
    fn from(ink: Ink) -> Color {
        Color::Rgb(ink.0, ink.1, ink.2)
    }
}

/// The shape of a mark.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Marker {
    Disc,
    Ring,
    Square,
    Triangle,
    Diamond,
    Cross,
    Star,
}

/// Where a word stands relative to its point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Anchor {
    Start,
    Middle,
    End,
}

/// A place on the sheet, units from the top left.
pub type Point = (f64, f64);

/// A drawing in the making. At 1200 units across, type of 16 reads well on a page.
pub struct Sheet(Scene);

impl Sheet {
    pub fn new(width: f64, height: f64) -> Self {
        Sheet(Scene::new(width, height))
    }

    /// Words; `size` is the height of the line.
    pub fn text(&mut self, at: Point, words: &str, size: u32, anchor: Anchor, ink: Ink) {
        self.set(at, words, size, (anchor, None, false), ink);
    }

    /// Words that stand out (in the SVG; the PNG has one weight).
    pub fn bold(&mut self, at: Point, words: &str, size: u32, anchor: Anchor, ink: Ink) {
        self.set(at, words, size, (anchor, None, true), ink);
    }

    /// Words that read upward, centred on their point.
    pub fn upward(&mut self, at: Point, words: &str, size: u32, ink: Ink) {
        self.set(at, words, size, (Anchor::Middle, Some(-90.0), false), ink);
    }

    fn set(
        &mut self,
        at: Point,
        words: &str,
        size: u32,
        style: (Anchor, Option<f64>, bool),
        ink: Ink,
    ) {
        let (anchor, rotate, bold) = style;
        let anchor = match anchor {
            Anchor::Start => TextAnchor::Start,
            Anchor::Middle => TextAnchor::Middle,
            Anchor::End => TextAnchor::End,
        };
        let (x, y, content, color) = (at.0, at.1, words.to_owned(), Some(ink.into()));
        self.0.add(Primitive::Text { x, y, content, size, anchor, rotate, bold, color });
    }

    /// A straight line; `dashes` as in SVG, empty for none.
    pub fn line(&mut self, from: Point, to: Point, ink: Ink, width: f64, dashes: &str) {
        let stroke_dasharray = (!dashes.is_empty()).then(|| dashes.to_owned());
        let (stroke, stroke_width) = (ink.into(), width);
        self.0.add(Primitive::Line {
            x1: from.0,
            y1: from.1,
            x2: to.0,
            y2: to.1,
            stroke,
            stroke_width,
            stroke_dasharray,
        });
    }

    /// A line through many points.
    pub fn polyline(&mut self, points: &[Point], ink: Ink, width: f64, dashes: &str) {
        let stroke_dasharray = (!dashes.is_empty()).then(|| dashes.to_owned());
        let d = outline(points);
        let (fill, stroke, opacity) = (None, ink.into(), None);
        self.0.add(Primitive::Path(Box::new(PathData {
            d,
            fill,
            stroke,
            stroke_width: width,
            opacity,
            stroke_dasharray,
        })));
    }

    /// A line through many points, in dashes of `on` units that are `off` units apart. (The PNG
    /// writer draws the dashes of straight lines only.)
    pub fn dashed(&mut self, points: &[Point], ink: Ink, width: f64, on: f64, off: f64) {
        let (mut walked, mut dash) = (0.0, Vec::new());
        for pair in points.windows(2) {
            let (from, to) = (pair[0], pair[1]);
            let length = (to.0 - from.0).hypot(to.1 - from.1);
            let parts = length.ceil().max(1.0) as usize;
            for share in (0..parts).map(|i| i as f64 / parts as f64) {
                let at = (from.0 + share * (to.0 - from.0), from.1 + share * (to.1 - from.1));
                if (walked + share * length) % (on + off) < on {
                    dash.push(at);
                } else if !dash.is_empty() {
                    self.polyline(&std::mem::take(&mut dash), ink, width, "");
                }
            }
            walked += length;
        }
        self.polyline(&dash, ink, width, "");
    }

    /// A filled shape.
    fn polygon(&mut self, points: &[Point], fill: Ink, edge: Ink) {
        let d = outline(points) + "Z";
        let (fill, stroke, opacity) = (Some(fill.into()), edge.into(), None);
        let path = PathData { d, fill, stroke, stroke_width: 0.6, opacity, stroke_dasharray: None };
        self.0.add(Primitive::Path(Box::new(path)));
    }

    /// A filled rectangle from its top left corner.
    pub fn block(&mut self, at: Point, width: f64, height: f64, ink: Ink) {
        let (x, y, fill) = (at.0, at.1, ink.into());
        self.0.add(Primitive::Rect {
            x,
            y,
            width,
            height,
            fill,
            stroke: None,
            stroke_width: None,
            opacity: None,
        });
    }

    /// A mark of radius `r`.
    pub fn mark(&mut self, at: Point, marker: Marker, r: f64, ink: Ink) {
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
                self.polygon(&corners(4, &|_| 1.25 * r, std::f64::consts::FRAC_PI_4), ink, white)
            }
            Marker::Diamond => self.polygon(&corners(4, &|_| 1.3 * r, 0.0), ink, white),
            Marker::Triangle => self.polygon(&corners(3, &|_| 1.35 * r, 0.0), ink, white),
            Marker::Star => {
                self.polygon(
                    &corners(10, &|i| if i % 2 == 0 { 1.9 * r } else { 0.8 * r }, 0.0),
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
        let (cx, cy, fill) = (at.0, at.1, fill.map_or(Color::None, Color::from));
        let (fill_opacity, stroke, stroke_width) = (None, Some(edge.into()), Some(width));
        self.0.add(Primitive::Circle { cx, cy, r, fill, fill_opacity, stroke, stroke_width });
    }

    /// The drawing as SVG.
    pub fn svg(&self) -> String {
        SvgBackend::default().render_scene(&self.0)
    }

    /// Write `<name>.svg` and `<name>.png`, the latter with two pixels to the unit.
    pub fn write(&self, out_dir: &Path, name: &str) -> Result<()> {
        let put = |extension: &str, bytes: &[u8]| {
            let path = out_dir.join(format!("{name}.{extension}"));
            std::fs::write(&path, bytes).map_err(Error::io(&path, "write"))
        };
        put("svg", self.svg().as_bytes())?;
        put("png", &self.png().map_err(|problem| Error::file(out_dir.join(name), problem))?)
    }

    /// The drawing as PNG, two pixels to the unit.
    pub fn png(&self) -> std::result::Result<Vec<u8>, String> {
        RasterBackend::new().with_scale(2.0).render_scene(&self.0)
    }
}

fn outline(points: &[Point]) -> String {
    let step = |(i, p): (usize, &Point)| {
        format!("{}{:.2},{:.2} ", if i == 0 { 'M' } else { 'L' }, p.0, p.1)
    };
    points.iter().enumerate().map(step).collect()
}
