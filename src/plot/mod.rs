//! Figures: sheets of axes, lines, marks and words, written as SVG and PNG.
//!
//! An SVG is a list of the same items that the PNG is made of, set in the same typeface, so the two look alike. A
//! figure is for a page 16 cm wide: on a sheet 1000 units across, type of 16 units is then 7 points high.

pub mod axes;
pub mod course;
mod drawn;
pub mod family;
pub mod font;
pub mod gallery;
mod lines;
pub mod marks;
pub mod moment;
pub mod palette;
pub mod raster;
pub mod sheet;
mod svg;

pub use axes::{Axis, Panel};
pub use sheet::{Anchor, Ink, Marker, Sheet};
