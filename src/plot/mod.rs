//! Figures: sheets of axes, lines, marks and words, written as SVG and PNG.
//!
//! An SVG is a list of the same items that the PNG is made of, set in the same typeface, so the two look alike. A
//! figure is for a page 16 cm wide: on a sheet 1000 units across, type of 16 units is then 7 points high.

pub(crate) mod axes;
pub(crate) mod course;
mod drawn;
pub(crate) mod family;
pub(crate) mod font;
pub(crate) mod gallery;
mod lines;
pub(crate) mod marks;
pub(crate) mod moment;
pub(crate) mod palette;
pub(crate) mod raster;
pub(crate) mod sheet;
mod svg;

pub(crate) use axes::{Axis, Panel};
pub(crate) use sheet::{Anchor, Ink, Marker, Sheet};
