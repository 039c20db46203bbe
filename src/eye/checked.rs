//! A viewer beside its sampled check.

use super::{Look, Viewer};
use crate::eye::check::{Check, Exposure};
use crate::light::Planes;
use crate::units::Seconds;
use crate::vision::SampledSpectra;

impl Viewer {
    /// A check of these places that starts with this viewer's fractions.
    pub fn check(&self, places: &[[usize; 2]]) -> Check {
        Check::new(places.to_vec(), |[x, y]| self.retina.at([x as i64, y as i64]))
    }

    /// Moves a check by the frame that was just looked at. `kept`: the places' spectra, where
    /// frames hold bands.
    pub fn compare(
        &self,
        check: &mut Check,
        planes: &Planes,
        kept: Option<&SampledSpectra>,
        look: &Look,
        gaze: [f64; 2],
        duration: Seconds,
    ) {
        let exposure = Exposure {
            vision: &self.vision,
            pigments: &self.pigments,
            kept,
            planes,
            pupil: look.pupil,
            gaze,
            shift: look.shift,
            around: self.surround_illuminance(look.pupil),
            pixels_per_degree: self.pixels_per_degree,
            duration,
        };
        check.follow(&exposure, |[x, y]| self.retina.at([x as i64, y as i64]));
    }
}
