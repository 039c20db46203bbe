//! How files are to be read.

use serde::{Deserialize, Serialize};

use crate::colour::Primaries;
use crate::frames::film_matrix::Matrix;
use crate::frames::transfer::Transfer;

/// What to do with samples that are NaN or infinite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum NonFinite {
    /// Refuse the frame, naming the first such pixel.
    #[default]
    Error,
    /// Inf to the frame's largest finite value, NaN to 0; counted.
    Clamp,
}

/// What to do with negative samples. (Light on the retina is never negative, whatever is chosen
/// here.)
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Negative {
    #[default]
    Keep,
    Clamp,
}

/// What a spectral sample is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Quantity {
    /// Radiance per nm.
    #[default]
    Density,
    /// Radiance of the whole band; divided by the band's width on the way in.
    BandIntegral,
}

/// What to take a file for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
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

/// How many pixels beyond its display window are read of a picture that has them (OpenEXR).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overscan {
    #[default]
    None,
    /// All that the first frame has.
    OfFirst,
    /// So many on the left, at the top, on the right and at the bottom.
    Margins([usize; 4]),
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
    /// RGB: whether the luminance of (1, 1, 1) is what each file tells (`whiteLuminance`), and not
    /// what a configuration tells.
    pub own_white: bool,
    /// RGB: its primaries, where the file's own word is not taken.
    pub primaries: Option<Primaries>,
    /// RGB that was made for a display: its curve, where the file's own word is not taken.
    pub transfer: Option<Transfer>,
    /// The peak of the display that such RGB is shown on, cd/m2.
    pub peak_cd_m2: Option<f64>,
    /// A film's matrix of YUV, where its own word is not taken.
    pub matrix: Option<Matrix>,
    /// Whether a film's codes have full range, where its own word is not taken.
    pub full_range: Option<bool>,
    pub overscan: Overscan,
    pub non_finite: NonFinite,
    pub negative: Negative,
    /// Declared sizes above this are refused before anything is allocated.
    pub max_pixels: u64,
}

impl Default for ReadOptions {
    fn default() -> Self {
        ReadOptions {
            wanted: Wanted::Auto,
            layer: String::new(),
            scale: 1.0,
            quantity: Quantity::Density,
            channels: ChannelNames::Recognised,
            own_white: true,
            primaries: None,
            transfer: None,
            peak_cd_m2: None,
            matrix: None,
            full_range: None,
            overscan: Overscan::None,
            non_finite: NonFinite::Error,
            negative: Negative::Keep,
            max_pixels: 268_435_456,
        }
    }
}
