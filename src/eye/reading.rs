//! What can be read of an eye after a look: light and pigment at a place, and the check beside it.

use super::beyond::Around;
use super::check::{Check, CheckFrame};
use super::field::Field;
use super::scattered::OpticsStage;
use super::{Eye, Look, Stimulus};
use crate::light::Planes;
use crate::units::{Millimetres, Nits};

impl Eye {
    /// Luminance of what lies beyond the picture; none before the first look tells.
    pub(super) fn surround_luminance(&self) -> Nits {
        self.surround.known().unwrap_or_default()
    }

    /// Cone illuminance of the light around the picture, an equal-energy spectrum, td.
    fn surround_illuminance(&self, pupil: Millimetres) -> [f64; 3] {
        let weights = self.vision.illuminance_weights(pupil, Millimetres(f64::INFINITY));
        self.vision.illuminance(&self.around, &weights).map(|td| td * self.surround_luminance().0)
    }

    /// Cone illuminance beyond the picture, td: of the surround, or of it and the veil.
    pub(super) fn around<'a>(
        &self,
        optics: Option<&'a OpticsStage>,
        pupil: Millimetres,
    ) -> Around<'a, f32> {
        match optics.and_then(OpticsStage::light_around) {
            Some(td) => Around::Grid(td),
            None => Around::Alike(self.surround_illuminance(pupil).map(|td| td as f32)),
        }
    }

    /// Cone illuminance of a place beyond the picture of a frame that was looked at, td.
    fn illuminance_around(&self, pupil: Millimetres, [x, y]: [i64; 2]) -> [f64; 3] {
        match self.optics.as_ref().and_then(OpticsStage::light_around) {
            Some(td) => [0, 1, 2].map(|k| f64::from(td.at([x as f64, y as f64], k))),
            None => self.surround_illuminance(pupil),
        }
    }

    /// Cone illuminance of one pixel of a frame that was looked at, td.
    pub(crate) fn illuminance_at(
        &self,
        planes: &Planes,
        look: &Look,
        [x, y]: [usize; 2],
    ) -> [f64; 3] {
        let per_degree = self.vision.observer.directional.mm_per_degree().unwrap_or(0.0);
        let scale = per_degree / self.pixels_per_degree;
        let r = Millimetres(scale * (x as f64 - look.gaze[0]).hypot(y as f64 - look.gaze[1]));
        let weights = self.vision.illuminance_weights(look.pupil, r);
        let of_place = || self.vision.moments(self.on_the_retina(planes), x, y);
        let moments = self.uniform.clone().unwrap_or_else(of_place);
        self.vision.illuminance(&moments, &weights)
    }

    /// Unbleached fractions at one pixel of a frame that was looked at.
    pub fn fractions_at(&self, look: &Look, [x, y]: [usize; 2]) -> [f64; 3] {
        let [x0, y0] = self.retina.origin();
        let [mut l, mut m, mut s] = [[0.0]; 3];
        let at = [x as f64 - look.shift[0] - x0 as f64, y as f64 - look.shift[1] - y0 as f64];
        self.pigment().resample(at, [&mut l, &mut m, &mut s]);
        [l[0], m[0], s[0]]
    }

    /// The retina's pigment, to be read between its places.
    pub(super) fn pigment(&self) -> Field<'_, f64> {
        let [width, height] = self.retina.size();
        Field { samples: self.retina.fractions(), width, height, around: self.retina.around() }
    }

    /// The check before a look; a new one starts with the retina's fractions.
    pub(super) fn begun_check(&mut self, places: &[[usize; 2]]) -> Option<Check> {
        let retina = &self.retina;
        let begin = || Check::new(places.to_vec(), |[x, y]| retina.at([x as i64, y as i64]));
        self.check.take().or_else(|| (!places.is_empty()).then(begin))
    }

    /// Moves the check by a look.
    pub(super) fn followed(&self, mut check: Check, stimulus: Stimulus<'_>, look: &Look) -> Check {
        let veil = |at| self.veil(stimulus.planes, at);
        let frame = CheckFrame {
            vision: &self.vision,
            pigments: &self.pigments,
            kept: stimulus.spectra,
            planes: self.on_the_retina(stimulus.planes),
            veil: &veil,
            pupil: look.pupil,
            gaze: look.gaze,
            shift: look.shift,
            around: &|at| self.illuminance_around(look.pupil, at),
            pixels_per_degree: self.pixels_per_degree,
            duration: look.duration,
        };
        check.follow(&frame, |[x, y]| self.retina.at([x as i64, y as i64]));
        check
    }
}
