//! A picture file: what its header says, and the checks that every format shares.

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::frames::census::{Census, Mending, verdict};
use crate::frames::memory;
use crate::frames::options::ReadOptions;
use crate::frames::transfer::Transfer;
use crate::light::{Frame, Planes, Sample, Samples};
use crate::spectrum::Bands;
use crate::units::Nits;

/// What the samples of a frame mean.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// Linear RGB in these primaries.
    Rgb(Primaries),
    /// Spectral radiance, W m^-2 sr^-1 nm^-1 after the configured scale, in these bands.
    Spectral(Bands),
}

/// What is known of a frame before its pixels are read.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    pub width: usize,
    pub height: usize,
    pub kind: Kind,
    /// Luminance of (1, 1, 1), where the file tells (`whiteLuminance`).
    pub white: Option<Nits>,
    /// The curve by which codes that were made for a display became light.
    pub transfer: Option<Transfer>,
    /// Where the file tells (`framesPerSecond`).
    pub frames_per_second: Option<f64>,
    /// Where the file tells (Radiance's VIEW).
    pub view: Option<View>,
    /// What the reader passed over or assumed, one sentence each.
    pub notes: Vec<String>,
}

impl Header {
    /// A header that tells only size and kind.
    pub(crate) fn new(width: usize, height: usize, kind: Kind) -> Header {
        let notes = Vec::new();
        let (white, transfer, frames_per_second, view) = (None, None, None, None);
        Header { width, height, kind, white, transfer, frames_per_second, view, notes }
    }
}

/// How columns of a picture stand for directions.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum ViewProjection {
    /// Every pixel is as many degrees wide.
    #[default]
    Angular,
    /// A flat picture seen from in front of its middle; narrower than 180 degrees.
    Perspective,
}

/// The part of the world that a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct View {
    pub horizontal_fov_deg: f64,
    pub projection: ViewProjection,
}

impl View {
    /// The view, if there is such a one.
    pub fn possible(self) -> Option<View> {
        let widest = match self.projection {
            ViewProjection::Angular => self.horizontal_fov_deg <= 360.0,
            ViewProjection::Perspective => self.horizontal_fov_deg < 180.0,
        };
        (self.horizontal_fov_deg > 0.0 && widest).then_some(self)
    }

    /// Pixels per degree in the middle of a picture `width` pixels wide.
    pub fn pixels_per_degree(self, width: usize) -> f64 {
        match self.projection {
            ViewProjection::Angular => width as f64 / self.horizontal_fov_deg,
            ViewProjection::Perspective => {
                let half_width = (self.horizontal_fov_deg / 2.0).to_radians().tan();
                width as f64 / 2.0 / half_width * 1f64.to_radians()
            }
        }
    }
}

/// The densest compression that is believed, bytes of pixels for each byte of the file. Measured on
/// black frames of 3840 x 2160: PXR24 packs 1250 bytes of floats into one, ZIP 940, PIZ 400.
pub(super) const DENSEST: u64 = 4096;

/// A pixel of a decoded picture: three halves.
const LEAST_PIXEL_BYTES: u64 = 6;

/// Refuses declared sizes that are beyond `max_pixels`, or that no compression fits into the file.
pub(super) fn believable(
    path: &Path,
    (width, height): (usize, usize),
    pixel_bytes: usize,
    densest: u64,
    max_pixels: u64,
) -> Result<()> {
    let pixels = (width as u64).checked_mul(height as u64);
    let Some(pixels) = pixels.filter(|pixels| (1..=max_pixels).contains(pixels)) else {
        let problem =
            format!("declares {width} x {height} pixels; 1 to max_pixels = {max_pixels} are read");
        return Err(Error::file(path, problem));
    };
    let bytes = std::fs::metadata(path).map_err(Error::io(path, "read"))?.len();
    let declared = pixels.saturating_mul(pixel_bytes as u64);
    if declared / densest > bytes {
        let problem = format!("declares {declared} bytes of pixels in a file of {bytes} bytes");
        return Err(Error::file(path, problem));
    }
    let what = format!("a picture of {width} x {height} pixels");
    memory::must_hold(&what, pixels.saturating_mul(LEAST_PIXEL_BYTES))
        .map_err(|problem| Error::file(path, problem))
}

/// Counts and mends the three planes of a picture that was decoded whole.
pub(super) fn examined(
    path: &Path,
    mut planes: Vec<f32>,
    (width, height): (usize, usize),
    options: &ReadOptions,
) -> Result<Frame> {
    let mending = Mending::first(options);
    let mut census = Census::default();
    for (i, row) in planes.chunks_exact_mut(width).enumerate() {
        census.admit(row, i % 3, (0, i / 3), mending);
    }
    let channel = |plane: usize| ["R", "G", "B"][plane].to_owned();
    let again = verdict(&census, options.non_finite, channel);
    if again.map_err(|problem| Error::file(path, problem))? {
        mending.second(&census).mend(&mut planes);
    }
    let planes = Planes { width, height, count: 3, samples: Samples::Float(planes) };
    Ok(Frame { planes, tally: census.tally })
}

/// Planes to decode into: recycled ones where they fit, dark where nothing will be written.
pub(super) fn canvas<T: Sample>(recycled: Option<Planes>, length: usize, covered: bool) -> Vec<T> {
    let fitting = recycled
        .and_then(|planes| T::taken(planes.samples))
        .filter(|samples| samples.len() == length);
    let Some(mut samples) = fitting else { return vec![T::default(); length] };
    if !covered {
        samples.fill(T::default());
    }
    samples
}
