//! What an eye takes in: light of a kind, a frame of it, a gaze, and what lies around.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::colour::Primaries;
use crate::error::{Error, Result};
use crate::light::{Planes, Survey};
use crate::observer::Observer;
use crate::spectrum::Bands;
use crate::units::Nits;
use crate::vision::{SampledSpectra, Vision};

/// What the planes of a frame in memory are.
#[derive(Clone, Debug, PartialEq)]
pub enum Light {
    /// Linear RGB in these primaries; (1, 1, 1) of linear sRGB has the luminance `white`.
    Rgb { primaries: Primaries, white: Nits },
    /// Spectral radiance in bands, W m^-2 sr^-1 nm^-1, in rising order of wavelength.
    Bands(Bands),
}

impl Light {
    /// Linear RGB in these primaries; (1, 1, 1) of linear sRGB has the luminance `white`.
    pub fn rgb(primaries: Primaries, white: Nits) -> Self {
        Light::Rgb { primaries, white }
    }

    /// This light as an observer receives it.
    ///
    /// # Errors
    /// The primaries span no gamut.
    pub fn received_by(&self, observer: Observer) -> Result<Vision> {
        match self {
            Light::Bands(bands) => Ok(Vision::of_bands(observer, bands)),
            Light::Rgb { primaries, white } => Vision::of_rgb(observer, primaries, *white)
                .ok_or_else(|| Error::light("the primaries span no gamut")),
        }
    }
}

/// What lies beyond the picture, for the pupil and for the retina under a moving gaze: an
/// equal-energy light.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase", expecting = "\"edge\" or a luminance in cd/m2")]
pub enum Surround {
    /// The mean luminance of the first frame's outermost pixels.
    Edge,
    /// A luminance; 0 is a dark room.
    #[serde(untagged)]
    Uniform(Nits),
}

impl Surround {
    /// The luminance, where it is known before the first frame.
    pub(super) fn known(self) -> Option<Nits> {
        match self {
            Surround::Edge => None,
            Surround::Uniform(nits) => Some(nits),
        }
    }
}

/// Where an eye looks: fractions of the picture's width and height, from the top left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gaze(pub [f64; 2]);

impl Gaze {
    /// The middle of the picture.
    pub const CENTRE: Gaze = Gaze([0.5, 0.5]);

    /// The same in pixels of a picture of this width and height.
    pub(crate) fn pixel(self, size: [usize; 2]) -> [f64; 2] {
        [0, 1].map(|i| self.0[i] * size[i] as f64 - 0.5)
    }
}

/// One frame as an eye takes it in.
#[derive(Clone, Copy, Debug)]
pub struct Stimulus<'a> {
    /// The frame: RGB, bands, or the projections of bands.
    pub planes: &'a Planes,
    /// Its luminances, by [`super::survey`].
    pub survey: &'a Arc<Survey>,
    /// Places to be checked at full model beside the look, the same in every frame: column, row.
    pub checked: &'a [[usize; 2]],
    /// Their spectra, where planes are projections.
    pub spectra: Option<&'a SampledSpectra>,
    /// The moments of every place in double precision, where all have the same light: pigment then
    /// follows it to the last digits, and a gaze moves nothing.
    pub uniform: Option<&'a [f64]>,
}

impl<'a> Stimulus<'a> {
    /// A frame as it is, with nothing to be checked.
    pub fn new(planes: &'a Planes, survey: &'a Arc<Survey>) -> Self {
        Stimulus { planes, survey, checked: &[], spectra: None, uniform: None }
    }
}
