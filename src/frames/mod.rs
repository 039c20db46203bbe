//! Files in and out. The only room that names `exr`, `png` and `zune-jpeg`, and the only one below the
//! program that touches the disk.
//!
//! * Which files: `sequence`, with `pattern` and `range`.
//! * A picture file and its format: `picture`, `format`, `options`; one format each: `exr_*`, `radiance`,
//!   `*_picture`, `envi*`, `film*`, listed in `FORMATS`. Footage of many files: `footage`.
//! * Fewer pixels: `reduced`, by the means of `area`.
//! * Codes made for a display to light: `displayed`, `transfer`.
//! * What channels mean: `names`, `channels`. What is wrong with samples: `census`.
//! * Scenes without a file: `builtin`, `uniform`.
//! * Files out: `written`, its blocks encoded by the crate `exr-blocks`; whole or not at all:
//!   [`atomic`].
//! * What a file holds, for people: `inspect*`, `exr_description`.

pub(crate) mod area;
pub mod atomic;
pub(crate) mod builtin;
mod census;
mod channels;
mod displayed;
mod envi;
mod envi_header;
mod envi_pair;
mod exr_chunks;
mod exr_description;
mod exr_file;
mod exr_footage;
mod exr_layer;
mod exr_picture;
mod exr_rows;
mod exr_sampling;
mod film;
mod film_call;
mod film_child;
mod film_layouts;
mod film_matrix;
mod film_probe;
mod film_yuv;
mod footage;
mod format;
mod inspect;
mod inspect_text;
mod jpeg_picture;
pub(crate) mod memory;
mod names;
mod options;
mod pattern;
mod picture;
mod plate;
mod plate_channels;
mod plate_header;
mod png_bytes;
mod png_picture;
mod radiance;
mod range;
mod reduced;
mod rgbe;
mod sequence;
mod state;
mod transfer;
mod turn;
pub(crate) mod uniform;
mod visible;
mod written;

pub(crate) use exr_description::Channel;
pub use exr_footage::read_exr;
pub(crate) use film_matrix::Matrix;
pub use format::Footage;
pub use inspect::Inspection;
pub(crate) use inspect::LuminanceWeights;
pub use options::{ChannelNames, Negative, NonFinite, Overscan, Quantity, ReadOptions, Wanted};
pub use picture::{Header, Kind, View, ViewProjection};
pub use plate::write_percept;
pub use png_bytes::decode_png;
pub(crate) use range::parse as parse_range;
pub(crate) use reduced::no_wider;
pub use sequence::{Missing, Sequence};
pub(crate) use state::{read_state, write_state};
pub use transfer::Transfer;
#[cfg(feature = "view")]
pub(crate) use written::encode_png;
pub use written::{About, Compression, write_exr, write_png};

use std::path::{Path, PathBuf};

use crate::error::Result;

/// The formats that are read. To add one: a file with a reader and its `FORMAT`, and two lines here.
static FORMATS: [&format::Format; 6] = [
    &exr_footage::FORMAT,
    &radiance::FORMAT,
    &png_picture::FORMAT,
    &jpeg_picture::FORMAT,
    &envi::FORMAT,
    &film::FORMAT,
];

/// Opens footage of one file for each frame. The first file's header tells its size and meaning.
///
/// # Errors
///
/// [`Error::File`](crate::error::Error::File) for a first file that is of no known format or damaged.
pub fn open(paths: &[PathBuf], options: &ReadOptions) -> Result<Box<dyn Footage>> {
    footage::open(&FORMATS, paths, options)
}

/// Describes a file. Samples that are no numbers are counted, whatever the options say of them.
pub fn inspect(
    path: &Path,
    options: &ReadOptions,
    weights: LuminanceWeights,
) -> Result<Inspection> {
    inspect::inspect(footage::format(&FORMATS, path)?, path, options, weights)
}
