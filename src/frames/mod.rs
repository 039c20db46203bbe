//! Files in and out. The only room that names `exr`, `image` and `png`, and the only one below the
//! program that touches the disk.
//!
//! * Which files: `sequence`, with `pattern` and `range`.
//! * Footage from files, any format: `footage`; one format each: `exr_*`, `radiance`, `displayed`,
//!   `envi*`.
//! * What channels mean: `names`, `channels`. What is wrong with samples: `census`.
//! * Files out: `written`, its blocks encoded by the crate `exr-blocks`; whole or not at all:
//!   [`atomic`].
//! * What a file holds, for people: `inspect*`, `exr_description`.

pub mod atomic;
pub mod builtin;
mod census;
mod channels;
mod displayed;
mod envi;
mod envi_header;
mod exr_chunks;
mod exr_description;
mod exr_file;
mod exr_picture;
mod exr_rows;
mod exr_sampling;
mod footage;
mod inspect;
mod inspect_text;
mod names;
mod pattern;
mod plate;
mod plate_channels;
mod plate_header;
mod png_bytes;
mod radiance;
mod range;
mod sequence;
mod shown;
mod state;
mod written;

pub use exr_description::{Channel, ExrDescription};
pub use exr_picture::read_exr;
pub use footage::open;
pub use inspect::{Inspection, LuminanceWeights, inspect};
pub use plate::Plate;
pub use png_bytes::decode_png;
pub use sequence::{Missing, Sequence};
pub use state::{read_state, write_state};
pub use written::{About, Compression, encode_png, write_exr, write_percept, write_png};

use crate::colour::Primaries;
use crate::error::Error;
use crate::light::{Frame, Planes};
use crate::spectrum::Bands;
use crate::units::Nits;
use crate::vision::Projection;

/// What the samples of a frame mean.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Linear RGB in these primaries.
    Rgb(Primaries),
    /// Spectral radiance, W m^-2 sr^-1 nm^-1 after the configured scale, in these bands.
    Spectral(Bands),
}

/// What is known of footage before its pixels are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    pub width: usize,
    pub height: usize,
    pub kind: Kind,
    /// Luminance of (1, 1, 1), where the file tells (`whiteLuminance`).
    pub white: Option<Nits>,
    /// Where the file tells (`framesPerSecond`).
    pub frames_per_second: Option<f64>,
    /// What the reader passed over or assumed, one sentence each.
    pub notes: Vec<String>,
}

/// A set of frames that can be read in any order, by any thread.
pub trait Footage: Send + Sync {
    /// Size and meaning, the same for every frame.
    fn header(&self) -> &Header;
    /// How many different frames there are.
    fn len(&self) -> usize;
    /// Never true: footage without a frame is refused when it is opened.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }
    /// Decodes frame `index`. Spectral frames are projected block by block; RGB frames keep their
    /// samples. `recycled` may hold the planes of an earlier frame to be written over.
    fn read(
        &self,
        index: usize,
        projection: Option<&Projection>,
        recycled: Option<Planes>,
    ) -> Result<Frame, Error>;
    /// What else frame `index` carries, to be written with its percept; `None` where that is
    /// nothing.
    ///
    /// # Errors
    ///
    /// [`Error::File`] for a frame that can no longer be read.
    fn plate(&self, index: usize) -> Result<Option<Plate>, Error> {
        let _ = index;
        Ok(None)
    }
}

/// What to do with samples that are NaN or infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum NonFinite {
    /// Refuse the frame, naming the first such pixel.
    #[default]
    Error,
    /// Inf to the frame's largest finite value, NaN to 0; counted.
    Clamp,
}

/// What to do with negative samples. (Light on the retina is never negative, whatever is chosen
/// here.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Negative {
    #[default]
    Keep,
    Clamp,
}

/// What a spectral sample is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quantity {
    /// Radiance per nm.
    #[default]
    Density,
    /// Radiance of the whole band; divided by the band's width on the way in.
    BandIntegral,
}

/// What to take a file for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Wanted {
    #[default]
    Auto,
    Rgb,
    Spectral,
}

/// How the channels of a spectral file whose names are not recognised map to wavelengths.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum ChannelNames {
    /// Recognised names only.
    #[default]
    Recognised,
    /// A pattern with `{nm}`, such as `S0_{nm}nm`.
    Wavelength(String),
    /// A pattern with `{index}`, and the range that the indexed bands share evenly, nm.
    Index { pattern: String, from: f64, to: f64 },
    /// Each channel by name: `(name, centre_nm, width_nm)`.
    Listed(Vec<(String, f64, f64)>),
}

/// How files are to be read.
#[derive(Clone, Debug, PartialEq)]
pub struct ReadOptions {
    pub wanted: Wanted,
    /// EXR layer or part; empty for the main one.
    pub layer: String,
    /// Spectral: factor to W m^-2 sr^-1 nm^-1.
    pub scale: f64,
    pub quantity: Quantity,
    pub channels: ChannelNames,
    pub non_finite: NonFinite,
    pub negative: Negative,
    /// Declared sizes above this are refused before anything is allocated.
    pub max_pixels: u64,
    /// RGB: whether the luminance of (1, 1, 1) is what each file tells (`whiteLuminance`), and not
    /// what a configuration tells.
    pub own_white: bool,
}

impl Default for ReadOptions {
    fn default() -> Self {
        ReadOptions {
            wanted: Wanted::Auto,
            layer: String::new(),
            scale: 1.0,
            quantity: Quantity::Density,
            channels: ChannelNames::Recognised,
            non_finite: NonFinite::Error,
            negative: Negative::Keep,
            max_pixels: 268_435_456,
            own_white: true,
        }
    }
}
