//! The eye's optics: light that the eye scatters on its way to the retina.
//!
//! ```text
//! r = s (1 - c) + K s,   c = K 1                                       beyond the picture is as bright as the place
//! r = s (1 - eta) + K s + L (eta - c),   eta = the share that is scattered         beyond it is the light L
//! ```
//!
//! s is the picture, r the light on the retina, in the same units; K a point spread function
//! (`psf`) without its core. What the eye spreads over less than the core stays in its place, for
//! a picture is looked at by another eye, which blurs it again. With nothing known beyond the
//! picture no light leaves it or comes in: a uniform picture is as it was, the sum of a picture
//! too, and the veil of a light is the same whatever the crop.
//!
//! Scatter is the same for every wavelength (sources contradict each other; the CIE equations are
//! for white light), so it may be done to planes of RGB, to projections of spectra or to bands.
//!
//! K is a sum of Gaussians on the levels of a pyramid. Its kernel is within a share of the sum that
//! a certificate by enumeration proves, and all its weights are positive: the error of r is at most
//! `Optics::bound` of r, at every place of every picture.

mod around;
mod certificate;
mod gaussians;
mod level;
mod levels;
pub(crate) mod psf;
mod pyramid;
mod rows;
mod shape;
mod whole;

use serde::{Deserialize, Serialize};

use crate::light::Planes;

pub(crate) use around::{Extent, VeilAround};
pub(crate) use levels::{DEPTHS, Depth};
pub(crate) use psf::PSFS;
pub use psf::Psf;

use gaussians::Gaussians;
use pyramid::Pyramid;

/// The scatter of a person's eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scatter {
    pub psf: Psf,
    /// Years.
    pub age: f64,
    /// Of the eye: 0 very dark, 0.5 brown, 1 blue-green, 1.2 light blue.
    pub pigmentation: f64,
    /// A person's scattered light over the norm's; individuals have 0.6 to 1.6, a cataract up to
    /// 10.
    pub straylight: f64,
    /// What the eye spreads over less than this stays in its place, degrees.
    pub core_deg: f64,
}

impl Default for Scatter {
    /// None; of the norm at 30 years, with brown eyes, outside of a core of 0.05 degrees, if it
    /// gets a function.
    fn default() -> Self {
        Scatter { psf: Psf::None, age: 30.0, pigmentation: 0.5, straylight: 1.0, core_deg: 0.05 }
    }
}

/// What is drawn of the veil.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Draw {
    /// The percept is of the light on the retina, veil and all: what an eye without scatter would
    /// have to look at.
    #[default]
    Veiled,
    /// The veil bleaches but is not drawn: for compositors with a bloom of their own.
    Clear,
}

impl Scatter {
    /// The point spread function at an angle in degrees, sr^-1: light at a place over the light of
    /// the source.
    pub(crate) fn psf(&self, degrees: f64) -> f64 {
        self.psf.formula(self.age, self.pigmentation).at(degrees)
    }

    /// The sum of Gaussians for pictures of this scale and diagonal, pixels.
    fn gaussians(&self, degrees: f64, diagonal: f64) -> Gaussians {
        let formula = self.psf.formula(self.age, self.pigmentation);
        Gaussians::new(&formula, self.core_deg, degrees, diagonal).times(self.straylight)
    }

    /// The share of the light that goes over the hemisphere outside of the core, in pictures of
    /// this scale.
    fn scattered(&self, degrees: f64) -> f64 {
        self.gaussians(degrees, 180.0 / degrees).over_the_hemisphere(degrees)
    }
}

/// The most of a place's light that may be scattered.
const MOST: f64 = 0.95;

/// Rounding of single floats on the way up and down the pyramid, of positive sums.
const ROUNDING: f64 = 2e-6;

/// The stage: scatter in pictures of one size and scale.
#[derive(Clone, Debug)]
pub struct Optics {
    sum: Gaussians,
    depth: Depth,
    size: [usize; 2],
    pyramid: Pyramid,
    kept: Vec<f32>,
    /// The share of the light that is not scattered.
    straight: f64,
    bound: f64,
}

impl Optics {
    /// The stage for pictures of this size in pixels and scale in degrees a pixel, `count` planes
    /// each. It works at the coarsest of `DEPTHS` whose certificate keeps within the budget, a
    /// share of the light on the retina, or at the finest. `None` where nothing is scattered.
    ///
    /// # Errors
    /// Where more than 95 % of a place's light would be scattered: what may be asked of `straylight` is told.
    pub fn new(
        scatter: &Scatter,
        size: [usize; 2],
        degrees: f64,
        count: usize,
        budget: f64,
    ) -> Result<Option<Optics>, String> {
        let mut last = None;
        for depth in DEPTHS {
            last = Optics::at_depth(scatter, size, degrees, count, depth)?;
            if last.as_ref().is_none_or(|optics| optics.bound <= budget) {
                break;
            }
        }
        Ok(last)
    }

    /// The stage at a given depth.
    ///
    /// # Errors
    /// Those of [`Optics::new`].
    pub(crate) fn at_depth(
        scatter: &Scatter,
        size: [usize; 2],
        degrees: f64,
        count: usize,
        depth: Depth,
    ) -> Result<Option<Optics>, String> {
        if scatter.psf == Psf::None || scatter.straylight == 0.0 {
            return Ok(None);
        }
        let sum = scatter.gaussians(degrees, (size[0] as f64).hypot(size[1] as f64));
        let coverage = Pyramid::new(&sum, &depth, size, 1).of_ones();
        let most = f64::from(coverage.iter().copied().fold(0.0, f32::max));
        if most > MOST {
            let accepted = scatter.straylight * MOST / most;
            let found = scatter.straylight;
            return Err(format!(
                "found {found}, which scatters {:.0} % of a place's light; accepted: 0 to {:.2} with this function and core",
                100.0 * most,
                (100.0 * accepted).floor() / 100.0
            ));
        }
        let kept = coverage.into_iter().map(|c| 1.0 - c).collect();
        let straight = 1.0 - scatter.scattered(degrees);
        let certificate = certificate::certificate(&sum, &depth, size);
        let bound = certificate * (most / (1.0 - most)).max(1.0) + ROUNDING;
        let pyramid = Pyramid::new(&sum, &depth, size, count);
        Ok(Some(Optics { sum, depth, size, pyramid, kept, straight, bound }))
    }

    /// The light on the retina of a picture, whose planes may be of halves or of floats. `beyond`:
    /// the light around the picture, plane by plane; `None`: as bright as the place. `out` is
    /// written over.
    pub fn exchange(&mut self, s: &Planes, beyond: Option<&[f32]>, out: &mut Planes) {
        self.exchange_met(s, beyond, out, |_, _| ());
    }

    /// The same; `met` is shown each row of the light on the retina, all planes, as soon as it is
    /// done, on any thread.
    pub(crate) fn exchange_met(
        &mut self,
        s: &Planes,
        beyond: Option<&[f32]>,
        out: &mut Planes,
        met: impl Fn(usize, &[f32]) + Sync,
    ) {
        if self.pyramid.count() != s.count {
            self.pyramid = Pyramid::new(&self.sum, &self.depth, self.size, s.count);
        }
        let straight = self.straight as f32;
        let beyond: Vec<_> =
            (0..s.count).map(|i| beyond.map(|light| (straight, light[i]))).collect();
        let samples = out.floats(s.width, s.height, s.count);
        self.pyramid.exchange(s, &self.kept, &beyond, samples, met);
    }

    /// The light on the retina beyond the picture that was exchanged last, on the canvas of
    /// [`Optics::extent_around`]. `beyond`: the light there, plane by plane; `around` keeps the
    /// canvas from call to call. `out` is written over.
    pub(crate) fn veil_around(
        &self,
        beyond: &[f32],
        around: &mut Option<VeilAround>,
        out: &mut Planes,
    ) {
        let old = around.take().filter(|around| around.is_for(self.pyramid.count()));
        let around = around.insert(old.unwrap_or_else(|| VeilAround::new(self)));
        around.follow(&self.pyramid, beyond, out);
    }

    /// Where the cells of the canvas around a picture lie.
    pub(crate) fn extent_around(&self) -> Extent {
        Extent::around(self.size, self.pyramid.height())
    }

    /// Largest relative error of the light on the retina at any place of any picture without
    /// negative light, against the sum of Gaussians that stands for the function.
    pub(crate) fn bound(&self) -> f64 {
        self.bound
    }

    /// The share of a place's light that goes to one so many pixels away in x and y: the sum of
    /// Gaussians that the pyramid stands for.
    pub(crate) fn share(&self, x: f64, y: f64) -> f64 {
        self.sum.at(x, y)
    }

    /// The share of its light that a place keeps or gets back from beyond the picture, row by row:
    /// 1 - c.
    pub(crate) fn kept(&self) -> &[f32] {
        &self.kept
    }

    /// Gaussians, and levels of the pyramid.
    pub(crate) fn extent(&self) -> (usize, usize) {
        (self.sum.nodes.len(), self.pyramid.height())
    }
}

#[cfg(test)]
mod double;
#[cfg(test)]
mod published;
#[cfg(test)]
mod tests;
